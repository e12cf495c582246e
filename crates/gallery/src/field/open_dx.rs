//! A scalar on a regular grid: the part of the OpenDX format that APBS writes.

use super::{number, quoted};
use glam::{DMat3, DVec3};
use std::io::BufRead;

/// A scalar at the points of a grid.
#[derive(Debug, Clone, PartialEq)]
pub struct Grid {
    counts: [usize; 3],
    grid_from_world: DMat3,
    origin: DVec3,
    /// The third index runs fastest.
    values: Vec<f32>,
    /// Named in a comment, as in `# POTENTIAL (kT/e)`.
    pub unit: Option<String>,
}

/// The most points that are read: 1 GiB of them.
const MOST_POINTS: usize = 1 << 28;

/// The longest line that is read.
const LONGEST_LINE: u64 = 1 << 16;

impl Grid {
    /// Reads a grid line by line; what is kept grows with what has been read, not with what the header promises. An
    /// error is one line.
    pub fn read(mut source: impl BufRead) -> Result<Self, String> {
        let mut header = Header::default();
        let mut number_of_line = 0;
        let mut line = String::new();
        let mut values = Vec::new();
        while values.len() < header.items.unwrap_or(1) && next_line(&mut source, &mut line)? {
            number_of_line += 1;
            let words = line.split_whitespace();
            let taken = match header.items {
                Some(items) => push_values(&mut values, items, words),
                None => header.take(&line),
            };
            taken.map_err(|why| format!("line {number_of_line}: {why}"))?;
        }
        header.finish(values)
    }

    /// The value at a point, trilinear between the eight points of the grid around it; `None` outside of the grid.
    pub fn sample(&self, point: DVec3) -> Option<f32> {
        let place = self.grid_from_world * (point - self.origin);
        let [nx, ny, nz] = self.counts;
        let last = DVec3::new((nx - 1) as f64, (ny - 1) as f64, (nz - 1) as f64);
        let is_inside = place.cmpge(DVec3::ZERO).all() && place.cmple(last).all();
        if !is_inside {
            return None;
        }
        let base = place.floor().min(last - 1.0).max(DVec3::ZERO);
        let t = (place - base).as_vec3();
        let [i, j, k] = base.to_array().map(index);
        let value = |di: usize, dj: usize, dk: usize| {
            let at = |i: usize, n: usize| i.min(n - 1);
            self.values[(at(i + di, nx) * ny + at(j + dj, ny)) * nz + at(k + dk, nz)]
        };
        let mix = |a: f32, b: f32, t: f32| a + (b - a) * t;
        let edge = |di, dj| mix(value(di, dj, 0), value(di, dj, 1), t.z);
        let face = |di| mix(edge(di, 0), edge(di, 1), t.y);
        Some(mix(face(0), face(1), t.x))
    }
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "an index of the grid"
)]
fn index(place: f64) -> usize {
    place as usize
}

/// What stands before the values.
#[derive(Debug, Default)]
struct Header {
    counts: Option<[usize; 3]>,
    origin: Option<DVec3>,
    deltas: Vec<DVec3>,
    items: Option<usize>,
    unit: Option<String>,
}

impl Header {
    /// Takes a line; those that say nothing about the grid are passed over.
    fn take(&mut self, line: &str) -> Result<(), String> {
        let words: Vec<&str> = line.split_whitespace().collect();
        let after = |word: &str| {
            words
                .iter()
                .position(|w| *w == word)
                .map(|i| &words[i + 1..])
        };
        match words.first().copied() {
            Some(first) if first.starts_with('#') => {
                let unit = line
                    .split_once('(')
                    .and_then(|(_, rest)| rest.split_once(')'));
                let is_short = |unit: &&str| unit.len() <= 16 && unit.is_ascii();
                // Not every comment names one.
                if let Some(unit) = unit.map(|(unit, _)| unit).filter(is_short) {
                    self.unit = Some(unit.to_owned());
                }
            }
            Some("object") if words.contains(&"gridpositions") => {
                let counts = after("counts").unwrap_or_default();
                self.counts = Some(checked_counts(counts)?);
            }
            Some("origin") => self.origin = Some(vector(&words[1..])?),
            Some("delta") => self.deltas.push(vector(&words[1..])?),
            Some("object") if words.contains(&"array") => {
                let items = after("items").and_then(|rest| rest.first());
                let items = items.and_then(|word| word.parse().ok());
                self.items = Some(self.checked_items(items)?);
            }
            _ => {}
        }
        Ok(())
    }

    fn checked_items(&self, items: Option<usize>) -> Result<usize, String> {
        let [nx, ny, nz] = self.counts.ok_or(
            "values before the size of the grid ('object 1 class gridpositions counts ...')",
        )?;
        let expected = nx * ny * nz;
        match items {
            Some(items) if items == expected => Ok(items),
            Some(items) => Err(format!(
                "{items} values for a grid of {nx} x {ny} x {nz} points"
            )),
            None => Err(String::from("an array without 'items' and their number")),
        }
    }

    fn finish(self, values: Vec<f32>) -> Result<Grid, String> {
        let missing = |what: &str| {
            format!("no {what}; give a regular grid in OpenDX format, as APBS writes it")
        };
        let counts = self
            .counts
            .ok_or_else(|| missing("line 'object 1 class gridpositions counts'"))?;
        let items = self
            .items
            .ok_or_else(|| missing("line 'object 3 class array'"))?;
        let origin = self.origin.ok_or_else(|| missing("line 'origin'"))?;
        let [x, y, z] = self.deltas[..] else {
            return Err(missing("three lines 'delta'"));
        };
        if values.len() < items {
            return Err(format!(
                "ends after {} of {items} values; it was cut off",
                values.len()
            ));
        }
        let world_from_grid = DMat3::from_cols(x, y, z);
        let volume = world_from_grid.determinant().abs();
        let is_flat = volume <= 1e-12 * x.length() * y.length() * z.length();
        let grid_from_world = world_from_grid.inverse_or_zero();
        if is_flat || volume == 0.0 || !grid_from_world.is_finite() {
            return Err(String::from("the three lines 'delta' do not span space"));
        }
        Ok(Grid {
            counts,
            grid_from_world,
            origin,
            values,
            unit: self.unit,
        })
    }
}

fn checked_counts(words: &[&str]) -> Result<[usize; 3], String> {
    let counts: Vec<usize> = words.iter().map_while(|w| w.parse().ok()).collect();
    let [nx, ny, nz] = counts[..] else {
        return Err(String::from(
            "'counts' is not followed by three whole numbers",
        ));
    };
    let total = nx.checked_mul(ny).and_then(|n| n.checked_mul(nz));
    match total {
        Some(1..=MOST_POINTS) => Ok([nx, ny, nz]),
        _ => Err(format!(
            "a grid of {nx} x {ny} x {nz} points; from 1 to {MOST_POINTS} can be read"
        )),
    }
}

fn vector(words: &[&str]) -> Result<DVec3, String> {
    let [x, y, z] = words else {
        return Err(format!(
            "{} numbers where there should be three",
            words.len()
        ));
    };
    Ok(DVec3::new(number(x)?, number(y)?, number(z)?))
}

fn push_values<'a>(
    values: &mut Vec<f32>,
    items: usize,
    words: impl Iterator<Item = &'a str>,
) -> Result<(), String> {
    for word in words.take(items - values.len()) {
        #[expect(clippy::cast_possible_truncation, reason = "values are kept as f32")]
        let value = number(word)? as f32;
        if !value.is_finite() {
            return Err(format!("{} is beyond 3e38", quoted(word)));
        }
        values.push(value);
    }
    Ok(())
}

/// Reads a line; false at the end of the file.
fn next_line(source: &mut impl BufRead, line: &mut String) -> Result<bool, String> {
    let mut bytes = Vec::new();
    let mut limited = std::io::Read::take(source, LONGEST_LINE);
    let count = limited
        .read_until(b'\n', &mut bytes)
        .map_err(|error| error.to_string())?;
    if count as u64 == LONGEST_LINE {
        return Err(format!(
            "a line longer than {LONGEST_LINE} characters; no OpenDX text"
        ));
    }
    line.clear();
    line.push_str(&String::from_utf8_lossy(&bytes));
    Ok(count > 0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn text(counts: &str, items: usize, values: &str) -> String {
        format!(
            "# POTENTIAL (kT/e)\n#\nobject 1 class gridpositions counts {counts}\norigin 1 2 3\n\
             delta 0.5 0 0\ndelta 0 1 0\ndelta 0 0 2\nobject 2 class gridconnections counts {counts}\n\
             object 3 class array type double rank 0 items {items} data follows\n{values}\nattribute \"dep\"\n"
        )
    }

    #[test]
    fn linear_fields_are_sampled_exactly() {
        let field = |p: DVec3| 2.0 * p.x - p.y + 0.25 * p.z + 1.0;
        let mut values = String::new();
        for i in 0..3 {
            for j in 0..4 {
                for k in 0..5 {
                    let index = DVec3::new(f64::from(i), f64::from(j), f64::from(k));
                    let place = DVec3::new(1.0, 2.0, 3.0) + index * DVec3::new(0.5, 1.0, 2.0);
                    values += &format!("{}{}", field(place), if k % 3 == 2 { "\n" } else { " " });
                }
            }
        }
        let grid = Grid::read(text("3 4 5", 60, &values).as_bytes()).expect("a grid");
        assert_eq!(
            grid.unit.as_deref(),
            Some("kT/e"),
            "the unit of the comment"
        );
        for (x, y, z) in [
            (1.0, 2.0, 3.0),
            (2.0, 5.0, 11.0),
            (1.3, 3.7, 6.1),
            (1.99, 2.01, 10.9),
        ] {
            let p = DVec3::new(x, y, z);
            let found = f64::from(grid.sample(p).expect("inside"));
            assert!((found - field(p)).abs() < 1e-5, "{p}: {found}");
        }
        for outside in [DVec3::ZERO, DVec3::new(2.001, 3.0, 4.0), DVec3::NAN] {
            assert_eq!(grid.sample(outside), None, "{outside}");
        }
    }

    #[test]
    fn a_grid_of_one_point_is_a_grid() {
        let grid = Grid::read(text("1 1 1", 1, "7").as_bytes()).expect("a grid");
        assert_eq!(grid.sample(DVec3::new(1.0, 2.0, 3.0)), Some(7.0), "there");
        assert_eq!(grid.sample(DVec3::new(1.1, 2.0, 3.0)), None, "beside it");
    }

    #[test]
    fn what_is_broken_is_refused_in_one_line() {
        let cut = |text: &str| text.replace("attribute \"dep\"\n", "");
        let huge = "1000000000000 1000000000000 1000000000000";
        for (text, word) in [
            (String::new(), "no line"),
            (cut(&text("2 2 2", 8, "1 2 3 4 5")), "ends after 5 of 8"),
            (text("2 2 2", 9, "1"), "9 values for a grid of 2 x 2 x 2"),
            (text(huge, 8, "1"), "line 3: a grid of"),
            (text("0 2 2", 0, ""), "a grid of 0 x 2 x 2"),
            (
                cut(&text("600 600 700", 252_000_000, "1")),
                "ends after 1 of 252000000",
            ),
            (text("2 2", 4, "1"), "three whole numbers"),
            (
                text("2 2 2", 8, "1 2 3 4 5 6 7 NaN"),
                "'NaN' is no finite number",
            ),
            (text("2 2 2", 8, "1 2 3 4 5 6 7 1e99"), "beyond"),
            (text("2 2 2", 8, "1 2 3 4 5 6 7 x"), "line 10: 'x'"),
            (
                text("2 2 2", 8, "1 2 3 4 5 6 7 8").replace("0 1 0", "1 0 0"),
                "span space",
            ),
            (
                text("2 2 2", 8, "1 2 3 4 5 6 7 8").replace("origin 1", "origin"),
                "numbers",
            ),
            ("x".repeat(1 << 17), "longer than"),
        ] {
            let line = Grid::read(text.as_bytes()).expect_err(word);
            assert!(line.contains(word), "{line}");
            assert!(!line.contains('\n') && line.len() < 160, "{line}");
        }
    }
}
