//! STL files come in, text and binary.
//!
//! # What is read
//! Triangles by the winding of their vertices. Each `solid` of a text file is one [`Mesh`], [`Instance`] and material
//! (grey 0.5) of that name; a binary file is one solid, called as its header says after the word `solid`, else like the
//! file. What the file is, its content decides: there are binary files that begin with `solid`.
//!
//! # What is not read
//! Normals: where they disagree with the winding, a warning says how many do. Attributes and colours of binary files.
//! STL knows no unit and no upward axis: lengths count as metres, +Y is up, unless the scene's options say otherwise.

use crate::open::{checked, no_triangles, one_line, stem};
use crate::report::counted;
use crate::{Face, ImportReport, Instance, Material, Mesh, Scene, SceneError};
use glam::{Affine3A, Vec3};
use hemicube_raster::Rgb;
use std::collections::{HashMap, HashSet};

/// Reflectance of what has no colour in the file.
const GREY: Rgb = Rgb::splat(0.5);
/// Bytes before the number of triangles of a binary file, and with it.
const HEADER: usize = 80;
const START: usize = 84;
/// Bytes of a triangle: normal, three vertices, attributes.
const RECORD: usize = 50;
/// Bytes within which a text file shows that it is one.
const LOOK_AHEAD: usize = 1024;

/// Whether a file is STL by its content.
pub fn is_stl(bytes: &[u8]) -> bool {
    is_text(bytes) || is_whole_binary(bytes)
}

/// Reads an STL file from memory; `file` names it in messages.
///
/// # Errors
/// One line that starts with `file`: what is wrong, where, how to mend it.
pub fn import(bytes: &[u8], file: &str) -> Result<Scene, SceneError> {
    let invalid = |what: &str| SceneError::Invalid(one_line(&format!("{file}: {what}")));
    let mut scene = Scene {
        name: stem(file),
        ..Scene::default()
    };
    let mut solids = Solids::new(&scene.name);
    if is_text(bytes) && !is_whole_binary(bytes) {
        text(bytes, &mut solids, &mut scene.report);
    } else {
        binary(bytes, &mut solids, &mut scene.report).map_err(|what| invalid(&what))?;
    }
    solids.report(&mut scene.report);
    for solid in solids.done {
        place(solid, &mut scene);
    }
    if scene.instances.is_empty() {
        return Err(invalid(&no_triangles(&scene.report)));
    }
    checked(scene, file)
}

/// Whether the length is exactly that of the triangles which a binary file says it has.
fn is_whole_binary(bytes: &[u8]) -> bool {
    triangle_count(bytes).is_some_and(|count| count > 0 && bytes.len() == START + RECORD * count)
}

fn triangle_count(bytes: &[u8]) -> Option<usize> {
    let count = bytes.get(HEADER..START)?.first_chunk::<4>()?;
    usize::try_from(u32::from_le_bytes(*count)).ok()
}

/// Whether a file begins as text files do.
fn is_text(bytes: &[u8]) -> bool {
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    let start = bytes.trim_ascii_start();
    let start = start[..start.len().min(LOOK_AHEAD)].to_ascii_lowercase();
    let has = |word: &[u8]| start.windows(word.len()).any(|w| w == word);
    start.starts_with(b"solid") && (has(b"facet") || has(b"endsolid"))
}

/// Solids on their way into the scene.
struct Solids<'a> {
    stem: &'a str,
    names: HashSet<String>,
    done: Vec<Mesh>,
    vertices: HashMap<[u32; 3], u32>,
    triangles: usize,
    /// Triangles two corners of which are the same.
    flat: usize,
    /// Triangles whose normal points against their winding.
    against_winding: usize,
}

impl<'a> Solids<'a> {
    fn new(stem: &'a str) -> Self {
        Self {
            stem,
            names: HashSet::new(),
            done: Vec::new(),
            vertices: HashMap::new(),
            triangles: 0,
            flat: 0,
            against_winding: 0,
        }
    }

    /// Begins a solid; nobody else has its name.
    fn begin(&mut self, name: &str) {
        let name = one_line(name.trim());
        let wanted = if name.is_empty() { self.stem } else { &name };
        let mut name = wanted.to_owned();
        let mut count = 1_usize;
        while !self.names.insert(name.clone()) {
            count += 1;
            name = format!("{wanted} ({count})");
        }
        // Not cleared: that would take as long as the largest solid, for each of many small ones.
        self.vertices = HashMap::new();
        self.done.push(Mesh {
            name,
            ..Mesh::default()
        });
    }

    /// Adds a triangle to the solid at work.
    fn add(&mut self, normal: Vec3, corners: [Vec3; 3]) {
        let [a, b, c] = corners;
        self.triangles += 1;
        if a == b || b == c || c == a {
            self.flat += 1;
            return;
        }
        if (b - a).cross(c - a).dot(normal) < 0.0 {
            self.against_winding += 1;
        }
        if self.done.is_empty() {
            self.begin("");
        }
        let mesh = self.done.last_mut().expect("a solid has begun");
        let corners = corners.map(|corner| {
            // -0 and 0 are the same place.
            let key = (corner + Vec3::ZERO).to_array().map(f32::to_bits);
            *self.vertices.entry(key).or_insert_with(|| {
                mesh.positions.push(corner);
                u32::try_from(mesh.positions.len() - 1)
                    .expect("2 GiB hold fewer than 2^32 vertices")
            })
        });
        mesh.faces.push(Face::Triangle(corners));
    }

    fn report(&self, report: &mut ImportReport) {
        if self.flat > 0 {
            let what = format!(
                "{} without an area; left out",
                counted(self.flat, "triangle")
            );
            report.warn("file", what);
        }
        if self.against_winding > 0 {
            let what = format!(
                "the normals of {} of {} triangles point against their winding; the winding decides which side is the \
                 front (--flip turns a solid around)",
                self.against_winding, self.triangles
            );
            report.warn("file", what);
        }
    }
}

fn binary(bytes: &[u8], solids: &mut Solids<'_>, report: &mut ImportReport) -> Result<(), String> {
    let count = triangle_count(bytes).ok_or_else(|| {
        format!(
            "it is no STL file: its {} bytes do not begin with 'solid' and are fewer than the {START} of a binary header; \
             export it again",
            bytes.len()
        )
    })?;
    let records = &bytes[START..];
    if records.len() / RECORD < count {
        return Err(format!(
            "it is cut off, or no STL file: it says that it has {count} triangles, there is room for {}; export it again",
            records.len() / RECORD
        ));
    }
    solids.begin(name_in_header(&bytes[..HEADER]));
    for (i, record) in records.chunks_exact(RECORD).take(count).enumerate() {
        let vector = |k: usize| {
            let at = |axis: usize| {
                let bytes = record[12 * k + 4 * axis..].first_chunk::<4>();
                f32::from_le_bytes(*bytes.expect("a record has twelve numbers"))
            };
            Vec3::new(at(0), at(1), at(2))
        };
        let corners = [vector(1), vector(2), vector(3)];
        if corners.iter().all(|c| c.is_finite()) {
            solids.add(vector(0), corners);
        } else {
            report.warn(
                format!("triangle {}", i + 1),
                "a coordinate is not finite; left out",
            );
        }
    }
    if records.len() > RECORD * count {
        let what = format!(
            "{} bytes after the last triangle; passed over",
            records.len() - RECORD * count
        );
        report.warn("file", what);
    }
    Ok(())
}

/// What stands after `solid`; other headers tell which program wrote the file.
fn name_in_header(header: &[u8]) -> &str {
    let end = header.iter().position(|&b| b == 0).unwrap_or(header.len());
    let text = str::from_utf8(&header[..end]).unwrap_or_default();
    text.strip_prefix("solid ").unwrap_or_default()
}

/// Reads the lines of a text file; what cannot be read is left out with a warning that names the line.
fn text(bytes: &[u8], solids: &mut Solids<'_>, report: &mut ImportReport) {
    let mut normal = Vec3::ZERO;
    // Corners of the facet at work, and its line.
    let mut corners: Vec<Vec3> = Vec::with_capacity(3);
    let mut facet: Option<usize> = None;
    let mut unknown = 0_usize;
    let mut is_open = false;
    let text = String::from_utf8_lossy(bytes);
    // Lines end in LF, in CR LF, or on very old machines in CR alone.
    let line_end = if text.contains('\n') { '\n' } else { '\r' };
    for (i, line) in text
        .trim_start_matches('\u{feff}')
        .split(line_end)
        .enumerate()
    {
        let line = line.trim();
        let mut words = line.split_ascii_whitespace();
        let key = words.next().unwrap_or_default().to_ascii_lowercase();
        match key.as_str() {
            "solid" => {
                end_facet(&mut facet, &mut corners, normal, solids, report);
                solids.begin(line["solid".len()..].trim());
                is_open = true;
            }
            "facet" => {
                end_facet(&mut facet, &mut corners, normal, solids, report);
                facet = Some(i + 1);
                normal = vector(words.skip(1)).unwrap_or(Vec3::ZERO);
            }
            // One that cannot be read keeps its place, so that the facet is told of.
            "vertex" => corners.push(vector(words).unwrap_or(Vec3::NAN)),
            "endfacet" => end_facet(&mut facet, &mut corners, normal, solids, report),
            "endsolid" => {
                end_facet(&mut facet, &mut corners, normal, solids, report);
                is_open = false;
            }
            "" | "outer" | "endloop" => {}
            _ => unknown += 1,
        }
    }
    end_facet(&mut facet, &mut corners, normal, solids, report);
    if is_open {
        report.warn("file", "ends before 'endsolid': it may have been cut off");
    }
    if unknown > 0 {
        report.warn(
            "file",
            format!(
                "{} without a meaning in STL; passed over",
                counted(unknown, "line")
            ),
        );
    }
}

fn end_facet(
    facet: &mut Option<usize>,
    corners: &mut Vec<Vec3>,
    normal: Vec3,
    solids: &mut Solids<'_>,
    report: &mut ImportReport,
) {
    let line = facet.take();
    let found = core::mem::take(corners);
    let Some(line) = line else {
        return;
    };
    match *found.as_slice() {
        [a, b, c] if found.iter().all(|c| c.is_finite()) => solids.add(normal, [a, b, c]),
        [_, _, _] => report.warn(
            format!("line {line}"),
            "a vertex of the facet is not three finite numbers; left out",
        ),
        ref other => {
            let what = format!("the facet has {} vertices, not 3; left out", other.len());
            report.warn(format!("line {line}"), what);
        }
    }
}

/// The next three words as numbers.
fn vector<'a>(mut words: impl Iterator<Item = &'a str>) -> Option<Vec3> {
    let mut next = || words.next()?.parse::<f32>().ok().filter(|x| x.is_finite());
    Some(Vec3::new(next()?, next()?, next()?))
}

/// Adds a solid to the scene, unless it is empty.
fn place(mut mesh: Mesh, scene: &mut Scene) {
    if mesh.faces.is_empty() {
        return;
    }
    mesh.material = scene.materials.len();
    scene.materials.push(Material::diffuse(&mesh.name, GREY));
    scene.instances.push(Instance {
        node: mesh.name.clone(),
        mesh: scene.meshes.len(),
        world_from_mesh: Affine3A::IDENTITY,
        flipped: false,
    });
    scene.meshes.push(mesh);
}
