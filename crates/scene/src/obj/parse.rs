//! The lines of an OBJ file.

use crate::ImportReport;
use crate::open::one_line;
use glam::{Vec2, Vec3};
use hemicube_raster::color::linear_from_srgb;
use std::borrow::Cow;
use std::collections::HashMap;

/// Stands for a corner without texture coordinate or normal.
pub const NONE: u32 = u32::MAX;

/// What the file holds, faces sorted by object, group and material.
#[derive(Debug, Default)]
pub struct Document {
    pub positions: Vec<Vec3>,
    /// Linear vertex colours; shorter than `positions` if the last ones have none.
    pub colors: Vec<Vec3>,
    pub has_colors: bool,
    pub texcoords: Vec<Vec2>,
    pub normals: Vec<Vec3>,
    pub groups: Vec<Group>,
    /// Names of materials that faces use; `None` where there was no `usemtl`.
    pub materials: Vec<Option<String>>,
    /// What stands after `mtllib`, one entry per line.
    pub libraries: Vec<String>,
}

/// Faces of one object, group and material.
#[derive(Debug)]
pub struct Group {
    pub name: String,
    /// Index into [`Document::materials`].
    pub material: usize,
    pub corners: Vec<Corner>,
    /// For each face the end of its corners and its line.
    pub faces: Vec<(usize, usize)>,
}

/// A corner of a face, counted from 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Corner {
    pub position: u32,
    pub texcoord: u32,
    pub normal: u32,
}

/// Reads a file; what cannot be read is left out with a warning that names the line.
pub fn parse(bytes: &[u8], file_stem: &str, report: &mut ImportReport) -> Document {
    let mut parser = Parser {
        document: Document::default(),
        report,
        file_stem,
        object: String::new(),
        group: String::new(),
        material: None,
        current: None,
        known_groups: HashMap::new(),
        known_materials: HashMap::new(),
        lines_and_points: 0,
        free_form: 0,
    };
    for (number, line) in LogicalLines::new(bytes) {
        parser.line(&line, number);
    }
    for (count, what) in [
        (parser.lines_and_points, "points and lines"),
        (parser.free_form, "free-form elements"),
    ] {
        if count > 0 {
            parser.report.warn(
                "file",
                format!("{count} {what} have no surface that is read; left out"),
            );
        }
    }
    parser.document
}

struct Parser<'a> {
    document: Document,
    report: &'a mut ImportReport,
    file_stem: &'a str,
    object: String,
    group: String,
    material: Option<String>,
    /// The group that the next face belongs to; `None` after a change of object, group or material.
    current: Option<usize>,
    known_groups: HashMap<(String, usize), usize>,
    known_materials: HashMap<Option<String>, usize>,
    lines_and_points: usize,
    free_form: usize,
}

impl Parser<'_> {
    fn line(&mut self, line: &[u8], number: usize) {
        let line = line.trim_ascii();
        let key = line
            .split(u8::is_ascii_whitespace)
            .next()
            .unwrap_or_default();
        let rest = &line[key.len()..];
        match key {
            b"v" => self.vertex(rest, number),
            b"vt" => {
                let [u, v] = self.numbers(rest, 1, number);
                self.document.texcoords.push(Vec2::new(u, v));
            }
            b"vn" => {
                let normal = self.numbers(rest, 3, number);
                self.document.normals.push(Vec3::from(normal));
            }
            b"f" | b"fo" => self.face(rest, number),
            b"o" => (self.object, self.current) = (text(rest), None),
            b"g" => (self.group, self.current) = (text(rest), None),
            b"usemtl" => (self.material, self.current) = (Some(text(rest)), None),
            b"mtllib" => self.document.libraries.push(text(rest)),
            b"l" | b"p" => self.lines_and_points += 1,
            b"curv" | b"curv2" | b"surf" => self.free_form += 1,
            _ => {}
        }
    }

    /// `x y z [w] [r g b]`; the weight w matters to free-form surfaces only.
    fn vertex(&mut self, rest: &[u8], number: usize) {
        let mut values = [f32::NAN; 7];
        let mut count = 0;
        for (value, word) in values.iter_mut().zip(words(rest)) {
            *value = number_of(word);
            count += 1;
        }
        if count < 3 || values[..3].iter().any(|x| !x.is_finite()) {
            // It keeps its place so that the numbers of the others hold.
            values[0] = f32::NAN;
            self.report.warn(
                format!("line {number}"),
                "v needs three finite numbers; faces that use it are left out",
            );
        }
        let document = &mut self.document;
        if let Some(color) = (count >= 6).then(|| Vec3::from_slice(&values[count - 3..count])) {
            document.colors.resize(document.positions.len(), Vec3::ONE);
            let channel = |c: f32| {
                if c.is_nan() {
                    1.0
                } else {
                    linear_from_srgb(c.clamp(0.0, 1.0))
                }
            };
            document.colors.push(color.map(channel));
            document.has_colors = true;
        }
        document
            .positions
            .push(Vec3::new(values[0], values[1], values[2]));
    }

    /// The first numbers of a line; those that are missing or damaged are 0, with a warning if they are needed.
    fn numbers<const N: usize>(&mut self, rest: &[u8], needed: usize, number: usize) -> [f32; N] {
        let mut values = [0.0; N];
        let mut good = 0;
        for (value, word) in values.iter_mut().zip(words(rest)) {
            let read = number_of(word);
            if read.is_finite() {
                (*value, good) = (read, good + 1);
            }
        }
        if good < needed {
            self.report.warn(
                format!("line {number}"),
                "too few finite numbers; taken as 0",
            );
        }
        values
    }

    fn face(&mut self, rest: &[u8], number: usize) {
        let group = self.group();
        let start = self.document.groups[group].corners.len();
        let counts = [
            self.document.positions.len(),
            self.document.texcoords.len(),
            self.document.normals.len(),
        ];
        for word in words(rest) {
            let Some(corner) = corner(word, counts) else {
                let word: String = text(word).chars().take(60).collect();
                let what = format!("'{word}' is no corner of a face; the face is left out");
                self.report.warn(format!("line {number}"), what);
                self.document.groups[group].corners.truncate(start);
                return;
            };
            self.document.groups[group].corners.push(corner);
        }
        let group = &mut self.document.groups[group];
        group.faces.push((group.corners.len(), number));
    }

    /// The group for the object, group and material that hold now.
    fn group(&mut self) -> usize {
        if let Some(current) = self.current {
            return current;
        }
        let name = match (self.object.as_str(), self.group.as_str()) {
            ("", "") => String::from(self.file_stem),
            (name, "") | ("", name) => String::from(name),
            (object, group) if object == group => String::from(object),
            (object, group) => format!("{object}/{group}"),
        };
        let document = &mut self.document;
        let material = *self
            .known_materials
            .entry(self.material.clone())
            .or_insert_with_key(|material| {
                document.materials.push(material.clone());
                document.materials.len() - 1
            });
        let group = *self
            .known_groups
            .entry((name, material))
            .or_insert_with_key(|(name, material)| {
                let group = Group {
                    name: name.clone(),
                    material: *material,
                    corners: Vec::new(),
                    faces: Vec::new(),
                };
                document.groups.push(group);
                document.groups.len() - 1
            });
        self.current = Some(group);
        group
    }
}

/// `v`, `v/vt`, `v//vn` or `v/vt/vn`, counted from 1 or, negative, from the end; `None` if it is none of them.
fn corner(word: &[u8], counts: [usize; 3]) -> Option<Corner> {
    let mut indices = [NONE; 3];
    for (i, part) in word.split(|&b| b == b'/').enumerate() {
        let index = indices.get_mut(i)?;
        if !part.is_empty() {
            *index = index_of(part, counts[i])?;
        }
    }
    let [position, texcoord, normal] = indices;
    (position != NONE).then_some(Corner {
        position,
        texcoord,
        normal,
    })
}

/// An index counted from 0. Positive ones may point further than what has been read so far; the builder looks again.
fn index_of(word: &[u8], count: usize) -> Option<u32> {
    let number: i64 = std::str::from_utf8(word).ok()?.parse().ok()?;
    let index = match number {
        1.. => number - 1,
        0 => return None,
        _ => i64::try_from(count).ok()?.checked_add(number)?,
    };
    u32::try_from(index).ok().filter(|&index| index != NONE)
}

/// The words of a line up to a comment.
pub fn words(line: &[u8]) -> impl Iterator<Item = &[u8]> {
    line.split(u8::is_ascii_whitespace)
        .filter(|word| !word.is_empty())
        .take_while(|word| !word.starts_with(b"#"))
}

/// A number; NaN if it is none.
pub fn number_of(word: &[u8]) -> f32 {
    std::str::from_utf8(word)
        .ok()
        .and_then(|word| word.parse().ok())
        .unwrap_or(f32::NAN)
}

/// A name: the rest of a line, whatever bytes it has. A `#` belongs to it, as in the names of 3ds Max.
pub fn text(rest: &[u8]) -> String {
    one_line(String::from_utf8_lossy(rest).trim())
}

/// Lines with those that end in `\` joined to the next, and the number of the first.
pub struct LogicalLines<'a> {
    rest: &'a [u8],
    number: usize,
}

impl<'a> LogicalLines<'a> {
    /// The lines of a file; a byte order mark is passed over.
    pub fn new(bytes: &'a [u8]) -> Self {
        Self {
            rest: bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes),
            number: 0,
        }
    }

    /// The next line of the file, without its end: LF, CR LF or CR.
    fn physical(&mut self) -> Option<&'a [u8]> {
        if self.rest.is_empty() {
            return None;
        }
        self.number += 1;
        let end = self
            .rest
            .iter()
            .position(|&b| b == b'\n' || b == b'\r')
            .unwrap_or(self.rest.len());
        let (line, rest) = self.rest.split_at(end);
        self.rest = rest
            .strip_prefix(b"\r\n")
            .unwrap_or_else(|| rest.get(1..).unwrap_or_default());
        Some(line)
    }
}

impl<'a> Iterator for LogicalLines<'a> {
    type Item = (usize, Cow<'a, [u8]>);

    fn next(&mut self) -> Option<Self::Item> {
        let first = self.physical()?;
        let number = self.number;
        let Some(mut open) = first.strip_suffix(b"\\") else {
            return Some((number, Cow::Borrowed(first)));
        };
        let mut joined = Vec::new();
        loop {
            joined.extend_from_slice(open);
            joined.push(b' ');
            let Some(line) = self.physical() else { break };
            match line.strip_suffix(b"\\") {
                Some(line) => open = line,
                None => {
                    joined.extend_from_slice(line);
                    break;
                }
            }
        }
        Some((number, Cow::Owned(joined)))
    }
}
