//! The lines of a `.vs3` file.

use crate::ImportReport;
use glam::DVec3;

/// What a surface is to the others.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// `S`
    Radiating,
    /// `M`
    Mask,
    /// `N`
    Null,
    /// `O`
    Obstruction,
}

/// A surface as its lines state it. Numbers of surfaces count from 1; 0 is none.
#[derive(Debug, Clone)]
pub struct Surface {
    pub line: usize,
    pub kind: Kind,
    pub corners: Corners,
    pub base: usize,
    pub combined_with: usize,
    pub emissivity: f32,
    pub name: String,
}

/// Where a surface is.
#[derive(Debug, Clone)]
pub enum Corners {
    /// Numbers of vertices (`F 3`).
    Vertices(Vec<usize>),
    /// Places (`F 3a`).
    Places(Vec<DVec3>),
}

/// What the file holds.
#[derive(Debug, Default)]
pub struct Document {
    pub title: String,
    pub vertices: Vec<DVec3>,
    /// In the order of their numbers.
    pub surfaces: Vec<Surface>,
    pub enclosure: bool,
    pub eps: Option<f64>,
}

/// A message about a line: `line 12: ...`.
pub type Problem = String;

/// Reads a file.
///
/// # Errors
/// The first thing that is wrong, where, and how to mend it.
pub fn parse(bytes: &[u8], report: &mut ImportReport) -> Result<Document, Problem> {
    let text = String::from_utf8_lossy(bytes);
    let lines: Vec<Line<'_>> = lines(&text);
    let mut parser = Parser {
        document: Document::default(),
        is_3a: format(&lines)?,
        passed_over: Vec::new(),
        report,
    };
    let mut rest = lines.iter();
    while let Some(line) = rest.next() {
        parser.line(line, &mut rest)?;
    }
    if !parser.passed_over.is_empty() {
        let what = format!(
            "passed over, since they set View3D's own method: {}",
            parser.passed_over.join(", ")
        );
        parser.report.warn("control", what);
    }
    Ok(parser.document)
}

/// A line that says something.
struct Line<'a> {
    number: usize,
    /// First letter, upper case.
    key: char,
    /// What stands after the first word.
    rest: &'a str,
    /// The whole of it without its comment.
    whole: &'a str,
}

/// The lines up to the end of the data, without comments.
fn lines(text: &str) -> Vec<Line<'_>> {
    let mut found = Vec::new();
    for (i, line) in text.split('\n').enumerate() {
        let line = line.trim_matches(is_blank);
        let Some(first) = line.chars().next() else {
            continue;
        };
        let key = first.to_ascii_uppercase();
        match key {
            '!' | '/' => continue,
            '*' | 'E' => break,
            _ => {}
        }
        // A title may have exclamation marks.
        let whole = match line.find('!') {
            Some(end) if key != 'T' => &line[..end],
            _ => line,
        };
        let end = whole.find(is_blank).unwrap_or(whole.len());
        found.push(Line {
            number: i + 1,
            key,
            rest: whole[end..].trim_matches(is_blank),
            whole,
        });
    }
    found
}

fn is_blank(c: char) -> bool {
    matches!(c, ' ' | ',' | '\t' | '\r' | '\0' | '\u{feff}')
}

fn words(text: &str) -> impl Iterator<Item = &str> {
    text.split(is_blank).filter(|word| !word.is_empty())
}

/// Whether the geometry is that of `F 3a`; without an `F` it is that of `F 3`.
fn format(lines: &[Line<'_>]) -> Result<bool, Problem> {
    let Some(line) = lines.iter().rev().find(|line| line.key == 'F') else {
        return Ok(false);
    };
    match words(line.rest).next().unwrap_or_default().to_ascii_lowercase().as_str() {
        "3" => Ok(false),
        "3a" => Ok(true),
        "2" => Err(line.problem(
            "F 2 is the two-dimensional geometry of View2D, which is not read; write the surfaces as F 3",
        )),
        other => Err(line.problem(&format!("{} is no geometry; use F 3 or F 3a", shown(&format!("F {other}"))))),
    }
}

impl Line<'_> {
    fn problem(&self, what: &str) -> Problem {
        format!("line {}: {what}", self.number)
    }
}

struct Parser<'a> {
    document: Document,
    is_3a: bool,
    /// Control words without a meaning here.
    passed_over: Vec<String>,
    report: &'a mut ImportReport,
}

impl Parser<'_> {
    fn line<'l>(
        &mut self,
        line: &Line<'_>,
        following: &mut (impl Iterator<Item = &'l Line<'l>> + Clone),
    ) -> Result<(), Problem> {
        let kind = match line.key {
            'T' => {
                line.rest.clone_into(&mut self.document.title);
                return Ok(());
            }
            'F' => return Ok(()),
            'C' => return self.control(line),
            'V' => return self.vertex(line),
            'X' => {
                let place = format!("line {}", line.number);
                self.report.warn(place, "X is passed over, as View3D does");
                return Ok(());
            }
            'S' => Kind::Radiating,
            'M' => Kind::Mask,
            'N' => Kind::Null,
            'O' => Kind::Obstruction,
            _ => {
                let word = words(line.whole).next().unwrap_or_default();
                return Err(line.problem(&format!(
                    "{} begins no entry (T, C, F, V, S, M, N, O, E); begin comments with !",
                    shown(word)
                )));
            }
        };
        let surface = if self.is_3a {
            self.placed_surface(line, kind, following)?
        } else {
            self.surface(line, kind)?
        };
        self.document.surfaces.push(surface);
        Ok(())
    }

    /// `name = value` pairs.
    fn control(&mut self, line: &Line<'_>) -> Result<(), Problem> {
        let mut words = line
            .rest
            .split(|c| is_blank(c) || c == '=')
            .filter(|word| !word.is_empty());
        while let Some(word) = words.next() {
            let name = word.to_ascii_lowercase();
            if ["epsu", "epso"].contains(&name.as_str()) {
                // Older files have an accuracy for each kind of integration.
                words.next();
                self.passed_over.push(word.to_owned());
                continue;
            }
            let known = [
                "eps", "maxu", "maxo", "mino", "row", "col", "encl", "emit", "out", "list", "prjd",
                "maxv",
            ];
            if !known.contains(&name.as_str()) {
                let what = format!("{} is no control word of View3D; passed over", shown(word));
                self.report.warn(format!("line {}", line.number), what);
                // Its value, if it has one, is a number.
                let mut rest = words.clone();
                if rest
                    .next()
                    .is_some_and(|value| value.parse::<f64>().is_ok())
                {
                    words = rest;
                }
                continue;
            }
            let value = words.next().unwrap_or_default();
            let Some(number) = value.parse::<f64>().ok().filter(|x| x.is_finite()) else {
                let what = format!("{name}={} is not a number; write {name}=1", shown(value));
                return Err(line.problem(&what));
            };
            self.setting(&name, word, number, line);
        }
        Ok(())
    }

    fn setting(&mut self, name: &str, word: &str, value: f64, line: &Line<'_>) {
        let mut note = |what: &str| {
            let place = format!("line {}, {word}={value}", line.number);
            self.report.warn(place, what);
        };
        match name {
            "encl" => self.document.enclosure = value != 0.0,
            "eps" => self.document.eps = Some(value).filter(|eps| *eps > 0.0),
            "emit" if value != 0.0 => note(
                "exchange factors with reflections (script-F) are not computed; factors are those of black surfaces",
            ),
            "row" | "col" if value != 0.0 => note("all factors are computed"),
            "out" if value != 0.0 => note("the name of the output file says how it is written"),
            "emit" | "row" | "col" | "out" | "list" => {}
            _ if self.passed_over.iter().any(|known| known == word) => {}
            _ => self.passed_over.push(word.to_owned()),
        }
    }

    /// `V number x y z`
    fn vertex(&mut self, line: &Line<'_>) -> Result<(), Problem> {
        let mut words = words(line.rest);
        let expected = self.document.vertices.len() + 1;
        in_sequence(line, "vertex", words.next(), expected)?;
        let mut place = [0.0; 3];
        for (coordinate, axis) in place.iter_mut().zip(["x", "y", "z"]) {
            *coordinate = number(line, words.next(), &format!("{axis} of vertex {expected}"))?;
        }
        self.document.vertices.push(DVec3::from_array(place));
        Ok(())
    }

    /// `S number v1 v2 v3 v4 base cmb emit name`
    fn surface(&mut self, line: &Line<'_>, kind: Kind) -> Result<Surface, Problem> {
        let mut words = words(line.rest).peekable();
        let number = self.document.surfaces.len() + 1;
        in_sequence(line, "surface", words.next(), number)?;
        if let Some(shape) =
            words.next_if(|word| matches!(*word, "R" | "r" | "T" | "t" | "Q" | "q"))
        {
            return Err(line.problem(&format!(
                "surface {number} has a shape ({shape}) instead of vertices; write F 3a above it"
            )));
        }
        let mut vertices = [0; 4];
        for (i, vertex) in vertices.iter_mut().enumerate() {
            *vertex = index(
                line,
                words.next(),
                &format!("vertex {} of surface {number}", i + 1),
            )?;
        }
        if let Some(zero) = vertices[..3].iter().position(|&v| v == 0) {
            let what = format!(
                "vertex {} of surface {number} is 0; only the fourth may be",
                zero + 1
            );
            return Err(line.problem(&what));
        }
        let count = if vertices[3] == 0 { 3 } else { 4 };
        let corners = Corners::Vertices(vertices[..count].to_vec());
        self.with_facts(line, kind, number, corners, words)
    }

    /// `S number shape base cmb emit name`, then `x y z azimuth tilt` and the shape's numbers on lines of their own.
    fn placed_surface<'l>(
        &mut self,
        line: &Line<'_>,
        kind: Kind,
        following: &mut (impl Iterator<Item = &'l Line<'l>> + Clone),
    ) -> Result<Surface, Problem> {
        let mut words = words(line.rest);
        let number = self.document.surfaces.len() + 1;
        in_sequence(line, "surface", words.next(), number)?;
        let shape = words.next().unwrap_or_default();
        let (name, count) = match shape.chars().next().map(|c| c.to_ascii_uppercase()) {
            Some('R') => ("rectangle", 7),
            Some('T') => ("triangle", 11),
            Some('Q') => ("quadrilateral", 13),
            _ => {
                let what = format!(
                    "surface {number} has the shape {}; use R (rectangle), T (triangle) or Q (quadrilateral)",
                    shown(shape)
                );
                return Err(line.problem(&what));
            }
        };
        let numbers = numbers_below(line, number, name, count, following)?;
        let corners = Corners::Places(places(&numbers));
        self.with_facts(line, kind, number, corners, words)
    }

    /// The end of a surface's line: `base cmb emit name`. An obstruction has none of it, but often a name.
    fn with_facts<'w>(
        &mut self,
        line: &Line<'_>,
        kind: Kind,
        number: usize,
        corners: Corners,
        mut words: impl Iterator<Item = &'w str>,
    ) -> Result<Surface, Problem> {
        let mut surface = Surface {
            line: line.number,
            kind,
            corners,
            base: 0,
            combined_with: 0,
            emissivity: 1.0,
            name: String::new(),
        };
        if kind == Kind::Obstruction {
            surface.name = words
                .nth(3)
                .map_or_else(|| format!("obstruction {number}"), str::to_owned);
            return Ok(surface);
        }
        surface.base = index(line, words.next(), &format!("base of surface {number}"))?;
        surface.combined_with = index(
            line,
            words.next(),
            &format!("combination of surface {number}"),
        )?;
        let emissivity: f64 = self::number(
            line,
            words.next(),
            &format!("emissivity of surface {number}"),
        )?;
        surface.name = words
            .next()
            .map_or_else(|| format!("surface {number}"), str::to_owned);
        if !(0.0..=1.0).contains(&emissivity) {
            let place = format!("line {}, surface '{}'", line.number, surface.name);
            let what = format!(
                "emissivity {emissivity} is not between 0 and 1; the nearest of them is taken"
            );
            self.report.warn(place, what);
        }
        #[expect(
            clippy::cast_possible_truncation,
            reason = "reflectances are kept in f32"
        )]
        let emissivity = emissivity.clamp(0.0, 1.0) as f32;
        surface.emissivity = emissivity;
        Ok(surface)
    }
}

/// The numbers on the lines below a surface's.
fn numbers_below<'l>(
    line: &Line<'_>,
    surface: usize,
    shape: &str,
    count: usize,
    following: &mut (impl Iterator<Item = &'l Line<'l>> + Clone),
) -> Result<Vec<f64>, Problem> {
    let mut numbers = Vec::with_capacity(count);
    while numbers.len() < count {
        let mut ahead = following.clone();
        let below = ahead
            .next()
            .filter(|below| !below.key.is_ascii_alphabetic());
        let Some(below) = below else {
            let what = format!(
                "surface {surface}, a {shape}, needs {count} numbers on the lines below (x y z azimuth tilt, then its \
                 shape), {} are there",
                numbers.len()
            );
            return Err(line.problem(&what));
        };
        *following = ahead;
        for word in words(below.whole).take(count - numbers.len()) {
            numbers.push(number(
                below,
                Some(word),
                &format!("a number of surface {surface}"),
            )?);
        }
    }
    Ok(numbers)
}

/// The corners of a shape in its plane, brought into the world. The plane's x runs to the right and its y upwards as
/// seen from the front; the azimuth turns clockwise from +y (north), a tilt of 90° is upright, 0° faces up.
fn places(numbers: &[f64]) -> Vec<DVec3> {
    let origin = DVec3::new(numbers[0], numbers[1], numbers[2]);
    let (sin_azimuth, cos_azimuth) = sin_cos_of_degrees(numbers[3]);
    let (sin_tilt, cos_tilt) = sin_cos_of_degrees(numbers[4]);
    let right = DVec3::new(-cos_azimuth, sin_azimuth, 0.0);
    let up = DVec3::new(-cos_tilt * sin_azimuth, -cos_tilt * cos_azimuth, sin_tilt);
    let at = |x: f64, y: f64| origin + right * x + up * y;
    match numbers[5..] {
        [width, height] => vec![
            at(0.0, height),
            at(0.0, 0.0),
            at(width, 0.0),
            at(width, height),
        ],
        ref pairs => pairs.chunks(2).map(|pair| at(pair[0], pair[1])).collect(),
    }
}

/// Sine and cosine, exact at right angles: walls then meet in the same vertices.
fn sin_cos_of_degrees(angle: f64) -> (f64, f64) {
    match angle.rem_euclid(360.0) {
        0.0 => (0.0, 1.0),
        90.0 => (1.0, 0.0),
        180.0 => (0.0, -1.0),
        270.0 => (-1.0, 0.0),
        other => other.to_radians().sin_cos(),
    }
}

/// Refuses numbers with gaps: View3D counts entries, and a gap means that one is lost.
fn in_sequence(
    line: &Line<'_>,
    what: &str,
    word: Option<&str>,
    expected: usize,
) -> Result<(), Problem> {
    let found = index(line, word, &format!("number of the {what}"))?;
    if found == expected {
        return Ok(());
    }
    Err(line.problem(&format!(
        "{what} {found} stands where {what} {expected} is due; number them 1, 2, 3 and so on"
    )))
}

fn index(line: &Line<'_>, word: Option<&str>, what: &str) -> Result<usize, Problem> {
    let word = word.ok_or_else(|| missing(line, what))?;
    word.parse().map_err(|_| {
        line.problem(&format!(
            "{what}: {} is not a whole number of 0 or more",
            shown(word)
        ))
    })
}

fn number(line: &Line<'_>, word: Option<&str>, what: &str) -> Result<f64, Problem> {
    let word = word.ok_or_else(|| missing(line, what))?;
    let number = word
        .parse::<f64>()
        .ok()
        .filter(|x| x.is_finite() && x.abs() < 1e30);
    number.ok_or_else(|| line.problem(&format!("{what}: {} is not a finite number", shown(word))))
}

fn missing(line: &Line<'_>, what: &str) -> Problem {
    line.problem(&format!("the {what} is missing; complete the line"))
}

/// A word in quotes, cut if it is long.
fn shown(word: &str) -> String {
    let short: String = word.chars().take(40).collect();
    format!("'{short}'")
}
