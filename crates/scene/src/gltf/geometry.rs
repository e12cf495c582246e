//! Primitives of meshes.

use super::accessor::Elements;
use super::material::default_material;
use super::{Source, name_or};
use crate::{Face, ImportReport, Mesh, Scene};
use glam::{Vec2, Vec3, Vec4};
use gltf::json::mesh::{Mode, Primitive, Semantic};
use gltf::json::validation::Checked;

/// All meshes together may have so many corners of triangles, and sets of texture coordinates a mesh.
const MAX_CORNERS: usize = 100_000_000;
const MAX_TEXCOORD_SETS: u32 = 8;

/// Bad triangles of a mesh that are told one by one.
const LISTED: usize = 1_000;

/// Reads meshes at their first use and each only once.
pub struct Geometry<'a> {
    source: Source<'a>,
    /// The scene's meshes for each mesh of the file that a node asked for.
    read: Vec<Option<Vec<usize>>>,
    default_material: Option<usize>,
    corners: usize,
}

impl<'a> Geometry<'a> {
    /// Nothing read yet.
    pub fn new(source: Source<'a>) -> Self {
        Self {
            source,
            read: vec![None; source.root.meshes.len()],
            default_material: None,
            corners: 0,
        }
    }

    /// The scene's meshes of a mesh of the file: one per primitive that has triangles.
    pub fn meshes(&mut self, index: usize, scene: &mut Scene) -> Result<Vec<usize>, String> {
        let count = self.read.len();
        let Some(known) = self.read.get(index) else {
            return Err(format!("mesh {index} of {count}; export the file again"));
        };
        if let Some(known) = known {
            return Ok(known.clone());
        }
        let mesh = &self.source.root.meshes[index];
        let name = name_or(mesh.name.as_ref(), "mesh", index);
        let mut meshes = Vec::new();
        for (i, primitive) in mesh.primitives.iter().enumerate() {
            let name = if mesh.primitives.len() > 1 {
                format!("{name}.{i}")
            } else {
                name.clone()
            };
            let read = self
                .primitive(primitive, &name, scene)
                .map_err(|e| format!("mesh '{name}': {e}"))?;
            if let Some(mesh) = read {
                meshes.push(scene.meshes.len());
                scene.meshes.push(mesh);
            }
        }
        self.read[index] = Some(meshes.clone());
        Ok(meshes)
    }

    /// A primitive; `None`, with a warning, if it has no triangle that can be used.
    fn primitive(
        &mut self,
        primitive: &Primitive,
        name: &str,
        scene: &mut Scene,
    ) -> Result<Option<Mesh>, String> {
        let place = format!("mesh '{name}'");
        let corners = match Corners::of(self.source, primitive)? {
            Ok(corners) => corners,
            Err(why) => {
                scene.report.warn(place, format!("{why}; left out"));
                return Ok(None);
            }
        };
        self.corners = self
            .corners
            .saturating_add(corners.triangles.saturating_mul(3));
        if self.corners > MAX_CORNERS {
            return Err(format!(
                "the meshes have more than {} triangles together; split the scene",
                MAX_CORNERS / 3
            ));
        }
        let mut faces = corners.faces(&place, &mut scene.report);
        if faces.is_empty() {
            scene
                .report
                .warn(place, "none of its triangles can be used; left out");
            return Ok(None);
        }
        let vertices = keep_used(&mut faces);
        let material = self.material(primitive, &place, scene);
        let mut mesh = Mesh {
            name: String::from(name),
            material,
            positions: vertices
                .iter()
                .map(|&v| Vec3::from(corners.positions.vector::<3>(v as usize)))
                .collect(),
            faces: faces.into_iter().map(Face::Triangle).collect(),
            ..Mesh::default()
        };
        let attributes = Attributes {
            source: self.source,
            count: corners.positions.count,
            vertices: &vertices,
            primitive,
        };
        attributes.read_into(&mut mesh, &place, &mut scene.report);
        warn_of_missing_texcoords(&mesh, &place, scene);
        Ok(Some(mesh))
    }

    fn material(&mut self, primitive: &Primitive, place: &str, scene: &mut Scene) -> usize {
        let named = primitive.material.map(|material| material.value());
        if let Some(index) = named {
            let count = self.source.root.materials.len();
            if index < count {
                return index;
            }
            scene.report.warn(
                place,
                format!("material {index} of {count}; the default one is taken"),
            );
        }
        *self.default_material.get_or_insert_with(|| {
            scene.materials.push(default_material());
            scene.materials.len() - 1
        })
    }
}

/// The triangles of a primitive as the file states them.
struct Corners<'a> {
    positions: Elements<'a>,
    /// Without indices the vertices come in order.
    indices: Option<Elements<'a>>,
    mode: Mode,
    triangles: usize,
    /// Corners that are no whole triangle.
    left_over: usize,
}

impl<'a> Corners<'a> {
    /// The inner error says why there are no triangles although nothing is damaged.
    fn of(source: Source<'a>, primitive: &Primitive) -> Result<Result<Self, &'static str>, String> {
        let Checked::Valid(mode) = primitive.mode else {
            return Ok(Err("its mode is none of glTF's"));
        };
        if !matches!(
            mode,
            Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan
        ) {
            return Ok(Err("it is made of points or lines, which have no surface"));
        }
        let Some(positions) = primitive
            .attributes
            .get(&Checked::Valid(Semantic::Positions))
        else {
            return Ok(Err("it has no POSITION"));
        };
        let positions = source
            .elements(positions.value())
            .map_err(|e| format!("POSITION: {e}; export the file again"))?;
        if positions.width != 3 {
            return Err(String::from(
                "POSITION: its accessor is not VEC3; export the file again",
            ));
        }
        let indices = primitive
            .indices
            .map(|indices| source.elements(indices.value()))
            .transpose();
        let indices = indices.map_err(|e| format!("indices: {e}; export the file again"))?;
        if indices.as_ref().is_some_and(|indices| !indices.is_index()) {
            return Err(String::from(
                "indices: their accessor is not SCALAR of unsigned integers; export the file again",
            ));
        }
        if !positions.has_data || indices.as_ref().is_some_and(|indices| !indices.has_data) {
            return Ok(Err("its accessors have no data, all is 0"));
        }
        let count = indices
            .as_ref()
            .map_or(positions.count, |indices| indices.count);
        let (triangles, left_over) = match mode {
            Mode::Triangles => (count / 3, count % 3),
            _ => (count.saturating_sub(2), if count < 3 { count } else { 0 }),
        };
        Ok(Ok(Self {
            positions,
            indices,
            mode,
            triangles,
            left_over,
        }))
    }

    /// The vertices of a triangle, counter-clockwise (glTF 2.0, section 3.7.2.1).
    fn triangle(&self, i: usize) -> [u32; 3] {
        let places = match self.mode {
            Mode::TriangleStrip => [i, i + 1 + i % 2, i + 2 - i % 2],
            Mode::TriangleFan => [i + 1, i + 2, 0],
            _ => [3 * i, 3 * i + 1, 3 * i + 2],
        };
        places.map(|place| match &self.indices {
            Some(indices) => indices.index(place),
            #[expect(
                clippy::cast_possible_truncation,
                reason = "an accessor's count fits 32 bits"
            )]
            None => place as u32,
        })
    }

    /// The triangles that can be used; of the others the report tells.
    fn faces(&self, place: &str, report: &mut ImportReport) -> Vec<[u32; 3]> {
        let mut faces = Vec::new();
        let mut bad = 0;
        let mut repeated: Option<(usize, usize)> = None;
        for i in 0..self.triangles {
            let [a, b, c] = self.triangle(i);
            if a == b || b == c || c == a {
                repeated = Some(repeated.map_or((i, 0), |(first, more)| (first, more + 1)));
            } else if let Some(what) = [a, b, c]
                .into_iter()
                .find_map(|vertex| self.what_is_wrong_with(vertex))
            {
                if bad < LISTED {
                    report.warn(
                        format!("{place}, triangle {i}"),
                        format!("{what}; left out"),
                    );
                }
                bad += 1;
            } else {
                faces.push([a, b, c]);
            }
        }
        report.unlisted += bad.saturating_sub(LISTED);
        match repeated {
            // Strips are stitched together by such triangles.
            Some((first, more)) if self.mode != Mode::TriangleStrip => {
                let more = if more > 0 {
                    format!(" (and {more} more triangles like it)")
                } else {
                    String::new()
                };
                report.warn(
                    format!("{place}, triangle {first}"),
                    format!("a vertex is used twice{more}; left out"),
                );
            }
            _ => {}
        }
        if self.left_over > 0 {
            report.warn(
                place,
                format!(
                    "its last {} corners are no whole triangle; left out",
                    self.left_over
                ),
            );
        }
        faces
    }

    fn what_is_wrong_with(&self, vertex: u32) -> Option<String> {
        let count = self.positions.count;
        if vertex as usize >= count {
            return Some(format!("vertex {vertex} of {count}"));
        }
        let position = self.positions.vector::<3>(vertex as usize);
        (!position.iter().all(|x| x.is_finite()))
            .then(|| format!("vertex {vertex} is at {position:?}"))
    }
}

/// Numbers the vertices that faces use anew and returns the old numbers, ascending.
///
/// Exporters share one big set of vertices among many primitives; each mesh keeps what it needs.
fn keep_used(faces: &mut [[u32; 3]]) -> Vec<u32> {
    let mut used: Vec<u32> = faces.iter().flatten().copied().collect();
    used.sort_unstable();
    used.dedup();
    used.shrink_to_fit();
    let in_order = used
        .last()
        .is_some_and(|&last| last as usize + 1 == used.len());
    if !in_order {
        for corner in faces.iter_mut().flatten() {
            #[expect(
                clippy::cast_possible_truncation,
                reason = "no more vertices are used than there are"
            )]
            let place = used.partition_point(|&vertex| vertex < *corner) as u32;
            *corner = place;
        }
    }
    used
}

/// The vertex attributes beside the positions.
struct Attributes<'a, 'p> {
    source: Source<'a>,
    /// Number of vertices in the file.
    count: usize,
    /// Those that are kept.
    vertices: &'p [u32],
    primitive: &'p Primitive,
}

impl Attributes<'_, '_> {
    /// What cannot be used is left out with a warning.
    fn read_into(&self, mesh: &mut Mesh, place: &str, report: &mut ImportReport) {
        if let Some(elements) = self.elements(Semantic::Normals, "NORMAL", &[3], place, report) {
            let (normals, mended) =
                self.values(|v| unit_or_zero(Vec3::from(elements.vector::<3>(v))));
            warn_of_mended(mended, "NORMAL", place, report);
            mesh.normals = normals;
        }
        if let Some(elements) = self.elements(Semantic::Tangents, "TANGENT", &[4], place, report) {
            let (tangents, mended) = self.values(|v| {
                let [x, y, z, w] = elements.vector::<4>(v);
                let (unit, is_fine) = unit_or_zero(Vec3::new(x, y, z));
                (unit.extend(if w < 0.0 { -1.0 } else { 1.0 }), is_fine)
            });
            warn_of_mended(mended, "TANGENT", place, report);
            mesh.tangents = tangents;
        }
        if let Some(elements) =
            self.elements(Semantic::Colors(0), "COLOR_0", &[3, 4], place, report)
        {
            let elements = elements.with_normalized();
            let (colors, mended) = self.values(|v| {
                let mut color = elements.vector::<4>(v);
                if elements.width == 3 {
                    color[3] = 1.0;
                }
                let within = color.map(|c| if c.is_nan() { 0.0 } else { c.clamp(0.0, 1.0) });
                (Vec4::from(within), within == color)
            });
            warn_of_mended(mended, "COLOR_0", place, report);
            mesh.colors = colors;
        }
        self.read_texcoords(mesh, place, report);
    }

    fn read_texcoords(&self, mesh: &mut Mesh, place: &str, report: &mut ImportReport) {
        let mut sets: Vec<Option<Vec<Vec2>>> = Vec::new();
        for set in 0..MAX_TEXCOORD_SETS {
            let name = format!("TEXCOORD_{set}");
            let elements = self.elements(Semantic::TexCoords(set), &name, &[2], place, report);
            sets.push(elements.map(|elements| {
                let (texcoords, mended) = self.values(|v| {
                    let texcoord = Vec2::from(elements.vector::<2>(v));
                    if texcoord.is_finite() {
                        (texcoord, true)
                    } else {
                        (Vec2::ZERO, false)
                    }
                });
                warn_of_mended(mended, &name, place, report);
                texcoords
            }));
        }
        let count = sets
            .iter()
            .rposition(Option::is_some)
            .map_or(0, |last| last + 1);
        // A gap is filled so that numbers of sets stay what they are.
        let zeros = || vec![Vec2::ZERO; self.vertices.len()];
        mesh.texcoords = sets
            .into_iter()
            .take(count)
            .map(|set| set.unwrap_or_else(zeros))
            .collect();
    }

    /// The elements of an attribute, if it is there and as it should be.
    fn elements(
        &self,
        semantic: Semantic,
        name: &str,
        widths: &[usize],
        place: &str,
        report: &mut ImportReport,
    ) -> Option<Elements<'_>> {
        let accessor = self.primitive.attributes.get(&Checked::Valid(semantic))?;
        let what = match self.source.elements(accessor.value()) {
            Ok(elements) if elements.count != self.count => {
                format!("{} elements for {} vertices", elements.count, self.count)
            }
            Ok(elements) if !widths.contains(&elements.width) => {
                format!("its accessor has {} components", elements.width)
            }
            Ok(elements) => return Some(elements),
            Err(what) => what,
        };
        report.warn(place, format!("{name}: {what}; left out"));
        None
    }

    /// The values of the kept vertices, and how many of them had to be mended.
    fn values<T>(&self, value: impl Fn(usize) -> (T, bool)) -> (Vec<T>, usize) {
        let mut mended = 0;
        let values = self.vertices.iter().map(|&vertex| {
            let (value, is_fine) = value(vertex as usize);
            mended += usize::from(!is_fine);
            value
        });
        (values.collect(), mended)
    }
}

fn warn_of_mended(mended: usize, attribute: &str, place: &str, report: &mut ImportReport) {
    if mended > 0 {
        report.warn(place, format!("{attribute}: {mended} vertices have values out of range or not finite; mended (NaN is 0)"));
    }
}

/// A direction of unit length; 0 where there is none.
fn unit_or_zero(direction: Vec3) -> (Vec3, bool) {
    direction
        .try_normalize()
        .map_or((Vec3::ZERO, false), |unit| (unit, unit.is_finite()))
}

fn warn_of_missing_texcoords(mesh: &Mesh, place: &str, scene: &mut Scene) {
    let material = &scene.materials[mesh.material];
    if let Some(slot) = material
        .slots()
        .find(|slot| slot.texcoord_set >= mesh.texcoords.len())
    {
        let what = format!(
            "its material '{}' needs TEXCOORD_{}, which it lacks",
            material.name, slot.texcoord_set
        );
        scene.report.warn(place, what);
    }
}
