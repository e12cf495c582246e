//! Meshes with scalars: the legacy VTK format, as text or big-endian binary, of unstructured grids and structured
//! points.
//!
//! Of the attributes the scalars (`SCALARS`, and arrays of one component in `FIELD`) are kept; everything else is
//! passed over.

use super::{number, quoted};
use glam::Vec3;

/// A mesh and its scalars.
#[derive(Debug, Clone, Default)]
pub struct Dataset {
    pub points: Vec<Vec3>,
    pub cells: Cells,
    pub point_scalars: Vec<Scalars>,
    pub cell_scalars: Vec<Scalars>,
}

/// What the points are joined to.
#[derive(Debug, Clone)]
pub enum Cells {
    /// Kind and corners of each.
    Unstructured(Vec<(u8, Vec<u32>)>),
    /// Boxes between so many points in x, y and z, x fastest.
    Structured([usize; 3]),
}

impl Default for Cells {
    fn default() -> Self {
        Self::Unstructured(Vec::new())
    }
}

/// A named number at each point or cell.
#[derive(Debug, Clone, PartialEq)]
pub struct Scalars {
    pub name: String,
    pub values: Vec<f32>,
}

/// The most points and cells that are read.
const MOST: usize = 1 << 20;

impl Dataset {
    /// Reads a file. An error is one line. What the file promises is compared with its length before memory is asked
    /// for.
    pub fn parse(bytes: &[u8]) -> Result<Self, String> {
        let mut input = Input {
            bytes,
            at: 0,
            is_binary: false,
        };
        if !input.line().starts_with("# vtk DataFile Version") {
            return Err(String::from(
                "no legacy VTK file ('# vtk DataFile Version ...'); convert it to one",
            ));
        }
        input.line();
        input.is_binary = match input.word()? {
            "ASCII" => false,
            "BINARY" => true,
            other => return Err(format!("{} where ASCII or BINARY should be", quoted(other))),
        };
        input.expect("DATASET")?;
        let dataset = match input.word()? {
            "UNSTRUCTURED_GRID" => unstructured(&mut input)?,
            "STRUCTURED_POINTS" => structured(&mut input)?,
            other => {
                return Err(format!(
                    "a dataset of kind {}; UNSTRUCTURED_GRID and STRUCTURED_POINTS can be read",
                    quoted(other)
                ));
            }
        };
        if dataset.points.is_empty() {
            return Err(String::from("holds no points"));
        }
        Ok(dataset)
    }

    fn cell_count(&self) -> usize {
        match &self.cells {
            Cells::Unstructured(cells) => cells.len(),
            Cells::Structured(counts) => {
                counts.iter().map(|n| n.saturating_sub(1).max(1)).product()
            }
        }
    }
}

/// What is left of a file.
struct Input<'a> {
    bytes: &'a [u8],
    at: usize,
    is_binary: bool,
}

impl<'a> Input<'a> {
    fn rest(&self) -> &'a [u8] {
        &self.bytes[self.at..]
    }

    /// The rest of the line.
    fn line(&mut self) -> &'a str {
        let rest = self.rest();
        let end = rest.iter().position(|&b| b == b'\n').unwrap_or(rest.len());
        self.at += (end + 1).min(rest.len());
        str::from_utf8(&rest[..end]).unwrap_or("").trim()
    }

    /// The next word; empty at the end of the file.
    fn word_or_end(&mut self) -> Result<&'a str, String> {
        let rest = self.rest();
        let start = rest
            .iter()
            .position(|b| !b.is_ascii_whitespace())
            .unwrap_or(rest.len());
        let word = &rest[start..];
        let end = word
            .iter()
            .position(u8::is_ascii_whitespace)
            .unwrap_or(word.len());
        self.at += start + end;
        str::from_utf8(&word[..end]).map_err(|_| format!("no text at byte {}", self.at))
    }

    fn word(&mut self) -> Result<&'a str, String> {
        match self.word_or_end()? {
            "" => Err(String::from("ends too early; it was cut off")),
            word => Ok(word),
        }
    }

    fn expect(&mut self, keyword: &str) -> Result<(), String> {
        let word = self.word()?;
        if word == keyword {
            return Ok(());
        }
        Err(format!("{} where {keyword} should be", quoted(word)))
    }

    /// How many there are of something.
    fn count(&mut self, what: &str) -> Result<usize, String> {
        let word = self.word()?;
        word.parse()
            .ok()
            .filter(|&n: &usize| n <= 16 * MOST)
            .ok_or_else(|| {
                format!(
                    "{} {what}; from 0 to {} can be read",
                    quoted(word),
                    16 * MOST
                )
            })
    }

    /// So many numbers of a type.
    fn numbers(&mut self, count: usize, kind: &str) -> Result<Vec<f64>, String> {
        let Some((size, decode)) = decoder(kind) else {
            return Err(format!(
                "numbers of type {}, which is not known",
                quoted(kind)
            ));
        };
        let left = self.rest().len();
        if !self.is_binary {
            // A digit and a blank each.
            if count > left.div_ceil(2) {
                return Err(format!(
                    "{count} numbers announced, {left} bytes left; it was cut off"
                ));
            }
            return (0..count).map(|_| number(self.word()?)).collect();
        }
        self.line();
        let left = self.rest().len();
        if count.saturating_mul(size) > left {
            return Err(format!(
                "{count} numbers announced, {left} bytes left; it was cut off"
            ));
        }
        let data = &self.rest()[..count * size];
        self.at += data.len();
        Ok(data.chunks_exact(size).map(decode).collect())
    }
}

/// The number that some bytes say.
type Decode = fn(&[u8]) -> f64;

/// Bytes of a number of a type, and what they say.
fn decoder(kind: &str) -> Option<(usize, Decode)> {
    macro_rules! big_endian {
        ($number:ty) => {{
            let decode: Decode = |bytes| {
                <$number>::from_be_bytes(bytes.try_into().expect("as many bytes as it has")) as f64
            };
            (size_of::<$number>(), decode)
        }};
    }
    Some(match kind {
        "unsigned_char" => big_endian!(u8),
        "char" => big_endian!(i8),
        "unsigned_short" => big_endian!(u16),
        "short" => big_endian!(i16),
        "unsigned_int" => big_endian!(u32),
        "int" | "vtkIdType" => big_endian!(i32),
        "unsigned_long" | "vtktypeuint64" => big_endian!(u64),
        "long" | "vtktypeint64" => big_endian!(i64),
        "float" => big_endian!(f32),
        "double" => big_endian!(f64),
        _ => return None,
    })
}

fn at_most(count: usize, what: &str) -> Result<usize, String> {
    if count <= MOST {
        return Ok(count);
    }
    Err(format!("{count} {what}; at most {MOST} can be drawn"))
}

#[expect(
    clippy::cast_possible_truncation,
    reason = "coordinates and scalars are drawn in f32"
)]
fn narrow(value: f64) -> f32 {
    value as f32
}

/// Whole numbers, as places in a list of `limit`.
fn indices(numbers: &[f64], limit: usize, what: &str) -> Result<Vec<u32>, String> {
    let index = |&x: &f64| {
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "checked to be below the limit"
        )]
        let index = x as u32;
        (x >= 0.0 && x < limit as f64 && x.fract() == 0.0)
            .then_some(index)
            .ok_or_else(|| format!("{what} {x}, there are {limit}"))
    };
    numbers.iter().map(index).collect()
}

fn unstructured(input: &mut Input<'_>) -> Result<Dataset, String> {
    let mut dataset = Dataset::default();
    let mut corners: Vec<Vec<u32>> = Vec::new();
    loop {
        match input.word_or_end()? {
            "POINTS" => {
                let count = at_most(input.count("points")?, "points")?;
                let kind = input.word()?;
                dataset.points = points(&input.numbers(3 * count, kind)?)?;
            }
            "CELLS" => corners = cells(input, dataset.points.len())?,
            "CELL_TYPES" => {
                let count = input.count("cell types")?;
                if count != corners.len() {
                    return Err(format!("{count} cell types for {} cells", corners.len()));
                }
                let kinds = indices(&input.numbers(count, "int")?, 256, "a cell of type")?;
                let kinds = kinds
                    .into_iter()
                    .map(|kind| u8::try_from(kind).expect("below 256"));
                dataset.cells =
                    Cells::Unstructured(kinds.zip(core::mem::take(&mut corners)).collect());
            }
            "" => return Ok(dataset),
            other => attribute(input, other, &mut dataset)?,
        }
    }
}

fn points(numbers: &[f64]) -> Result<Vec<Vec3>, String> {
    let point = |xyz: &[f64]| {
        let p = Vec3::new(narrow(xyz[0]), narrow(xyz[1]), narrow(xyz[2]));
        // Beyond, products of coordinates overflow.
        (p.is_finite() && p.abs().max_element() <= 1e15)
            .then_some(p)
            .ok_or_else(|| format!("a point at ({}, {}, {})", xyz[0], xyz[1], xyz[2]))
    };
    numbers.chunks_exact(3).map(point).collect()
}

/// The corners of each cell. Since version 5 offsets and corners stand apart, before each cell began with its number
/// of corners.
fn cells(input: &mut Input<'_>, points: usize) -> Result<Vec<Vec<u32>>, String> {
    let (first, second) = (input.count("cells")?, input.count("numbers of cells")?);
    let before = input.at;
    if input.word()? == "OFFSETS" {
        let kind = input.word()?;
        let offsets = indices(&input.numbers(first, kind)?, second + 1, "an offset of")?;
        input.expect("CONNECTIVITY")?;
        let kind = input.word()?;
        let corners = indices(&input.numbers(second, kind)?, points, "a cell with point")?;
        let cell = |pair: &[u32]| {
            let slice = corners.get(pair[0] as usize..pair[1] as usize);
            slice
                .map(<[u32]>::to_vec)
                .ok_or_else(|| String::from("offsets of cells that descend"))
        };
        at_most(first, "cells")?;
        return offsets.windows(2).map(cell).collect();
    }
    input.at = before;
    let numbers = input.numbers(second, "int")?;
    let mut rest = &numbers[..];
    let mut cells = Vec::new();
    for _ in 0..at_most(first, "cells")? {
        let corners = match rest.split_first() {
            Some((&n, after)) => {
                let n = indices(&[n], numbers.len(), "a number of corners of")?;
                after.split_at_checked(n[0] as usize)
            }
            None => None,
        };
        let Some((corners, after)) = corners else {
            return Err(format!(
                "{first} cells announced, {} are there",
                cells.len()
            ));
        };
        cells.push(indices(corners, points, "a cell with point")?);
        rest = after;
    }
    Ok(cells)
}

fn structured(input: &mut Input<'_>) -> Result<Dataset, String> {
    let (mut counts, mut origin, mut spacing) = ([0; 3], Vec3::ZERO, Vec3::ONE);
    let mut dataset = Dataset::default();
    loop {
        match input.word_or_end()? {
            "DIMENSIONS" => {
                for count in &mut counts {
                    *count = at_most(
                        input.count("points in a direction")?,
                        "points in a direction",
                    )?;
                }
                dataset.cells = Cells::Structured(counts);
            }
            "ORIGIN" => origin = vector(input)?,
            "SPACING" | "ASPECT_RATIO" => spacing = vector(input)?,
            "" => break,
            other => attribute(input, other, &mut dataset)?,
        }
    }
    let total = counts.iter().try_fold(1_usize, |n, &c| n.checked_mul(c));
    let total = at_most(total.unwrap_or(usize::MAX), "points")?;
    let [nx, ny, _] = counts;
    dataset.points = (0..total)
        .map(|i| {
            let place = [i % nx, i / nx % ny, i / nx / ny].map(|n| n as f32);
            origin + spacing * Vec3::from(place)
        })
        .collect();
    let is_whole = |scalars: &Scalars| scalars.values.len() == total;
    if !dataset.point_scalars.iter().all(is_whole) {
        return Err(format!("scalars of another number than the {total} points"));
    }
    Ok(dataset)
}

fn vector(input: &mut Input<'_>) -> Result<Vec3, String> {
    let numbers = [
        number(input.word()?)?,
        number(input.word()?)?,
        number(input.word()?)?,
    ];
    Ok(points(&numbers)?[0])
}

/// Takes what begins with a keyword behind the mesh.
fn attribute(input: &mut Input<'_>, keyword: &str, dataset: &mut Dataset) -> Result<(), String> {
    match keyword {
        "METADATA" => {
            while !input.line().is_empty() {}
            // The first line is what was left of the keyword's own.
            while !input.line().is_empty() {}
            Ok(())
        }
        "FIELD" => fields(input).map(drop),
        "POINT_DATA" => {
            let (count, expected) = (input.count("points")?, dataset.points.len());
            // Structured points are made later.
            if expected > 0 && count != expected {
                return Err(format!("data of {count} points, there are {expected}"));
            }
            dataset.point_scalars = scalars(input, count)?;
            Ok(())
        }
        "CELL_DATA" => {
            let (count, expected) = (input.count("cells")?, dataset.cell_count());
            if count != expected {
                return Err(format!("data of {count} cells, there are {expected}"));
            }
            dataset.cell_scalars = scalars(input, count)?;
            Ok(())
        }
        other => Err(format!("{} is not known", quoted(other))),
    }
}

/// The attributes of points or cells up to those of the other.
fn scalars(input: &mut Input<'_>, count: usize) -> Result<Vec<Scalars>, String> {
    let mut found = Vec::new();
    loop {
        let before = input.at;
        match input.word_or_end()? {
            "SCALARS" => {
                let (name, kind) = (input.word()?.to_owned(), input.word()?.to_owned());
                let components = input.line().parse().unwrap_or(1);
                input.expect("LOOKUP_TABLE")?;
                input.word()?;
                let values = input.numbers(count.saturating_mul(components), &kind)?;
                found.extend(one_component(&name, components, &values));
            }
            "LOOKUP_TABLE" => {
                input.word()?;
                let entries = input.count("colours")?;
                input.numbers(4 * entries, "unsigned_char")?;
            }
            "VECTORS" | "NORMALS" => {
                input.word()?;
                let kind = input.word()?;
                input.numbers(3 * count, kind)?;
            }
            "FIELD" => found.extend(
                fields(input)?
                    .into_iter()
                    .filter(|s| s.values.len() == count),
            ),
            "METADATA" => attribute(input, "METADATA", &mut Dataset::default())?,
            _ => {
                input.at = before;
                return Ok(found);
            }
        }
    }
}

/// The arrays of one component of a field.
fn fields(input: &mut Input<'_>) -> Result<Vec<Scalars>, String> {
    input.word()?;
    let arrays = input.count("arrays")?;
    let mut found = Vec::new();
    for _ in 0..arrays {
        let mut name = input.word()?;
        if name == "METADATA" {
            attribute(input, name, &mut Dataset::default())?;
            name = input.word()?;
        }
        let (components, tuples) = (input.count("components")?, input.count("tuples")?);
        let kind = input.word()?;
        let values = input.numbers(components.saturating_mul(tuples), kind)?;
        found.extend(one_component(name, components, &values));
    }
    Ok(found)
}

/// Names are URL-encoded in files.
fn one_component(name: &str, components: usize, values: &[f64]) -> Option<Scalars> {
    (components == 1).then(|| Scalars {
        name: name.replace("%20", " "),
        values: values.iter().map(|&x| narrow(x)).collect(),
    })
}

#[cfg(test)]
mod tests;
