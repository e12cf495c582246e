//! Points in, values out: comma- or semicolon-separated text.

use glam::Vec3;
use hemicube::raster::Rgb;

/// Columns that are read.
const COLUMNS: [&str; 6] = ["x", "y", "z", "nx", "ny", "nz"];

/// Columns that are added; columns of these names in the input are replaced.
const ADDED: [&str; 4] = [
    "irradiance_r",
    "irradiance_g",
    "irradiance_b",
    "illuminance",
];

/// A table of points.
#[derive(Debug)]
pub struct Points {
    separator: char,
    header: Vec<String>,
    /// Input columns that are passed through.
    kept: Vec<usize>,
    /// One for each point, in the order of the file.
    pub rows: Vec<Row>,
}

/// A point to measure at.
#[derive(Debug)]
pub struct Row {
    fields: Vec<String>,
    /// Where.
    pub point: Vec3,
    /// Unit normal of the side that is measured.
    pub normal: Vec3,
}

/// What is measured at a point.
#[derive(Debug, Clone, Copy)]
pub struct Measured {
    /// lx or W/m² in each band.
    pub irradiance: Rgb,
    /// lx.
    pub illuminance: f32,
}

impl Points {
    /// Reads a table; the error names the line.
    pub fn parse(bytes: &[u8]) -> Result<Self, String> {
        let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
        let text = std::str::from_utf8(bytes).map_err(|e| {
            let line = 1 + bytes[..e.valid_up_to()]
                .iter()
                .filter(|&&b| b == b'\n')
                .count();
            format!("line {line} is not UTF-8; save the file as UTF-8")
        })?;
        let mut lines = text
            .lines()
            .enumerate()
            .map(|(i, line)| (i + 1, line))
            .filter(|(_, line)| !line.trim().is_empty() && !line.trim_start().starts_with('#'))
            .peekable();
        let &(number, first) = lines
            .peek()
            .ok_or("there is no point in it; a line is x,y,z,nx,ny,nz")?;
        let separator = if first.contains(';') { ';' } else { ',' };
        let fields = split(first, separator).map_err(|e| format!("line {number}: {e}"))?;
        let header = if fields
            .iter()
            .all(|field| field.trim().parse::<f32>().is_ok())
        {
            if fields.len() != COLUMNS.len() {
                let count = fields.len();
                return Err(format!(
                    "line {number} has {count} numbers and no header; begin with a line {}",
                    COLUMNS.join(",")
                ));
            }
            COLUMNS.map(String::from).to_vec()
        } else {
            lines.next();
            fields
                .into_iter()
                .map(|field| field.trim().to_owned())
                .collect()
        };
        let columns = find_columns(&header).map_err(|e| format!("line {number}: {e}"))?;
        let rows = lines
            .map(|(number, line)| {
                Row::parse(line, separator, header.len(), columns)
                    .map_err(|e| format!("line {number}: {e}"))
            })
            .collect::<Result<Vec<Row>, String>>()?;
        if rows.is_empty() {
            return Err(String::from("there is no point in it, only a header"));
        }
        let added = |name: &String| ADDED.iter().any(|a| a.eq_ignore_ascii_case(bare(name)));
        let kept = (0..header.len()).filter(|&i| !added(&header[i])).collect();
        Ok(Self {
            separator,
            header,
            kept,
            rows,
        })
    }

    /// The table with the measured values, one for each row.
    pub fn with_values(&self, values: &[Measured]) -> String {
        let separator = self.separator.to_string();
        let line = |fields: &[String], added: &[String]| {
            let kept = self.kept.iter().map(|&i| fields[i].as_str());
            kept.chain(added.iter().map(String::as_str))
                .collect::<Vec<_>>()
                .join(&separator)
                + "\n"
        };
        let mut text = line(&self.header, &ADDED.map(String::from));
        for (row, value) in self.rows.iter().zip(values) {
            let [r, g, b] = value.irradiance.to_array();
            text.push_str(&line(
                &row.fields,
                &[r, g, b, value.illuminance].map(|x| x.to_string()),
            ));
        }
        text
    }
}

impl Row {
    fn parse(
        line: &str,
        separator: char,
        width: usize,
        columns: [usize; 6],
    ) -> Result<Self, String> {
        let fields = split(line, separator)?;
        if fields.len() != width {
            return Err(format!("has {} fields, not {width}", fields.len()));
        }
        let mut numbers = [0.0_f32; 6];
        for ((to, &column), name) in numbers.iter_mut().zip(&columns).zip(COLUMNS) {
            let field = bare(&fields[column]);
            *to = match field.parse::<f32>() {
                Ok(number) if number.is_finite() => number,
                Ok(_) => return Err(format!("{name} '{field}' is not a finite number")),
                Err(_) => return Err(format!("{name} '{field}' is not a number")),
            };
        }
        let [x, y, z, nx, ny, nz] = numbers;
        // In f64 no length under- or overflows.
        let normal = glam::DVec3::new(nx.into(), ny.into(), nz.into())
            .try_normalize()
            .ok_or("its normal nx,ny,nz is zero; give the direction of the measured side")?;
        Ok(Self {
            fields,
            point: Vec3::new(x, y, z),
            normal: normal.as_vec3(),
        })
    }
}

/// Where the columns are that are read.
fn find_columns(header: &[String]) -> Result<[usize; 6], String> {
    let mut found = [0; 6];
    for (to, name) in found.iter_mut().zip(COLUMNS) {
        let mut places = (0..header.len()).filter(|&i| bare(&header[i]).eq_ignore_ascii_case(name));
        let missing = || {
            format!(
                "there is no column {name}; needed are {}",
                COLUMNS.join(",")
            )
        };
        *to = places.next().ok_or_else(missing)?;
        if places.next().is_some() {
            return Err(format!("there are two columns {name}"));
        }
    }
    Ok(found)
}

/// The fields of a line as they stand, quotes included; separators inside quotes do not count.
fn split(line: &str, separator: char) -> Result<Vec<String>, String> {
    let mut fields = vec![String::new()];
    let mut quoted = false;
    for c in line.chars() {
        quoted ^= c == '"';
        if c == separator && !quoted {
            fields.push(String::new());
        } else {
            fields.last_mut().expect("there is always one").push(c);
        }
    }
    if quoted {
        return Err(String::from(
            "a quotation mark is not closed; a field must end on its line",
        ));
    }
    Ok(fields)
}

/// A field without blanks and quotes around it.
fn bare(field: &str) -> &str {
    let field = field.trim();
    field
        .strip_prefix('"')
        .and_then(|f| f.strip_suffix('"'))
        .unwrap_or(field)
        .trim()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn measured(x: f32) -> Measured {
        Measured {
            irradiance: Rgb::splat(x),
            illuminance: x,
        }
    }

    #[test]
    fn columns_are_found_by_name_and_others_passed_through() {
        let text = "\u{feff}# desk\nname;nz;ny;nx;z;y;x;illuminance\r\n\"a;b\";0;2;0;3;2;1;7\n\n";
        let points = Points::parse(text.as_bytes()).expect("a good table");
        assert_eq!(
            points.rows[0].point,
            Vec3::new(1.0, 2.0, 3.0),
            "columns by name"
        );
        assert_eq!(points.rows[0].normal, Vec3::Y, "normals are normalised");
        let out = points.with_values(&[measured(0.1)]);
        let wanted = "name;nz;ny;nx;z;y;x;irradiance_r;irradiance_g;irradiance_b;illuminance\n\"a;b\";0;2;0;3;2;1;0.1;0.1;0.1;0.1\n";
        assert_eq!(out, wanted, "the old illuminance is replaced");
    }

    #[test]
    fn six_numbers_need_no_header() {
        let points = Points::parse(b"0, 1, 2, 0, 0, -3\n").expect("a good table");
        assert_eq!(
            points.rows[0].normal,
            Vec3::NEG_Z,
            "the last three are the normal"
        );
        assert!(
            points
                .with_values(&[measured(1.0)])
                .starts_with("x,y,z,nx,ny,nz,irr"),
            "a header is written"
        );
    }

    #[test]
    fn errors_name_the_line() {
        for (text, wanted) in [
            ("", "no point"),
            ("x,y,z,nx,ny,nz\n", "only a header"),
            ("x,y,z,nx,ny\n1,2,3,4,5", "no column nz"),
            ("x,x,y,z,nx,ny,nz\n", "two columns x"),
            ("x,y,z,nx,ny,nz\n#\n1,2,3,0,0,0", "line 3: its normal"),
            (
                "x,y,z,nx,ny,nz\n1,2,NaN,0,0,1",
                "line 2: z 'NaN' is not a finite",
            ),
            ("x,y,z,nx,ny,nz\n1,2,,0,0,1", "line 2: z '' is not a number"),
            ("x,y,z,nx,ny,nz\n1,2,3,0,0", "line 2: has 5 fields, not 6"),
            ("1,2,3,4,5,6,7", "line 1 has 7 numbers"),
            (
                "x,y,z,nx,ny,nz,n\n1,2,3,0,0,1,\"",
                "line 2: a quotation mark",
            ),
        ] {
            let error = Points::parse(text.as_bytes()).expect_err(text);
            assert!(error.contains(wanted), "'{error}' for '{text}'");
        }
        let error = Points::parse(b"x\n\xff").expect_err("not UTF-8");
        assert!(error.starts_with("line 2"), "{error}");
    }
}
