//! Wavefront OBJ comes in, with its MTL material files.
//!
//! # What is read
//! - `v` (with vertex colours, taken as sRGB), `vt`, `vn`, `f` with positive and negative
//!   indices, `o`, `g`, `usemtl`, `mtllib` (names with spaces too), line continuation, any line ends, any bytes.
//! - Faces of four corners that are planar and convex stay quads, others become triangles. Every object or group with
//!   one material is one [`Mesh`] and one [`Instance`].
//! - MTL: `Kd`, `map_Kd`, `Ke`, `map_Ke`, `d`, `Tr`, `map_d`, `Ns` and `Pr` (roughness), `Pm` (metallic), `Tf` of glass
//!   (`illum` 6 and 7). Of the options of maps `-clamp` counts, the others are passed over.
//!
//! # What is not read
//! Points, lines, free-form curves and surfaces, smoothing groups, bump and reflection maps. A material that is not
//! found is grey 0.5.

mod material;
mod parse;
mod polygon;

use crate::open::{checked, no_triangles, one_line, stem};
use crate::{Face, ImportReport, Instance, Mesh, Scene, SceneError};
use glam::{Affine3A, Vec2, Vec3, Vec4};
use parse::{Corner, Document, Group, NONE};
use polygon::Polygons;
use std::path::Path;

/// Reads an OBJ file from memory: `file` names it in messages, `folder` is where the files beside it are.
///
/// # Errors
/// One line that starts with `file`: what is wrong, where, how to mend it.
pub fn import(bytes: &[u8], file: &str, folder: Option<&Path>) -> Result<Scene, SceneError> {
    let mut scene = Scene {
        name: stem(file),
        ..Scene::default()
    };
    let document = parse::parse(bytes, &scene.name, &mut scene.report);
    let mut builder = Builder::new(&document);
    for group in &document.groups {
        let Some(mesh) = builder.mesh(group, &mut scene.report) else {
            continue;
        };
        let placed = Instance {
            node: mesh.name.clone(),
            mesh: scene.meshes.len(),
            world_from_mesh: Affine3A::IDENTITY,
            flipped: false,
        };
        scene.meshes.push(mesh);
        scene.instances.push(placed);
    }
    if scene.instances.is_empty() {
        let message = format!("{file}: {}", no_triangles(&scene.report));
        return Err(SceneError::Invalid(one_line(&message)));
    }
    material::read_all(&document.materials, &document.libraries, folder, &mut scene);
    checked(scene, file)
}

/// Makes meshes with vertices of their own out of groups.
struct Builder<'a> {
    document: &'a Document,
    polygons: Polygons,
    /// For each position the first vertex of the mesh at work that has it, or [`NONE`].
    first_at: Vec<u32>,
}

/// A vertex of the mesh at work and the next one with the same position.
struct Vertex {
    corner: Corner,
    next: u32,
}

impl<'a> Builder<'a> {
    fn new(document: &'a Document) -> Self {
        Self {
            document,
            polygons: Polygons::default(),
            first_at: vec![NONE; document.positions.len()],
        }
    }

    /// The mesh of a group; `None` if none of its faces can be used.
    fn mesh(&mut self, group: &Group, report: &mut ImportReport) -> Option<Mesh> {
        let mut vertices: Vec<Vertex> = Vec::new();
        let mut faces = Vec::new();
        let mut start = 0;
        for &(end, line) in &group.faces {
            let corners = &group.corners[start..end];
            start = end;
            if let Err(what) = self.face(corners, &mut vertices, &mut faces) {
                report.warn(
                    format!("line {line}"),
                    format!("{what}; the face is left out"),
                );
            }
        }
        for vertex in &vertices {
            self.first_at[vertex.corner.position as usize] = NONE;
        }
        (!faces.is_empty()).then(|| self.filled(group, &vertices, faces, report))
    }

    /// Appends a face, whole or in triangles.
    fn face(
        &mut self,
        corners: &[Corner],
        vertices: &mut Vec<Vertex>,
        faces: &mut Vec<Face>,
    ) -> Result<(), String> {
        let positions = &self.document.positions;
        let count = positions.len();
        for corner in corners {
            match positions.get(corner.position as usize) {
                None => {
                    return Err(format!(
                        "vertex {} of {count}",
                        u64::from(corner.position) + 1
                    ));
                }
                Some(p) if !p.is_finite() => {
                    return Err(format!("vertex {} is at {p}", corner.position + 1));
                }
                Some(_) => {}
            }
        }
        let at = |i: usize| positions[corners[i].position as usize];
        for piece in self
            .polygons
            .split(corners.len(), at, |i| corners[i].position)?
        {
            faces.push(match *piece {
                polygon::Piece::Triangle(c) => {
                    Face::Triangle(c.map(|i| self.first_at.vertex(corners[i], vertices)))
                }
                polygon::Piece::Quad(c) => {
                    Face::Quad(c.map(|i| self.first_at.vertex(corners[i], vertices)))
                }
            });
        }
        Ok(())
    }

    /// The mesh with its vertex attributes.
    fn filled(
        &self,
        group: &Group,
        vertices: &[Vertex],
        faces: Vec<Face>,
        report: &mut ImportReport,
    ) -> Mesh {
        let document = self.document;
        let mut missing = 0;
        let mut mesh = Mesh {
            name: group.name.clone(),
            material: group.material,
            faces,
            ..Mesh::default()
        };
        mesh.positions = vertices
            .iter()
            .map(|v| document.positions[v.corner.position as usize])
            .collect();
        if vertices.iter().any(|v| v.corner.texcoord != NONE) {
            let mut texcoord = |v: &Vertex| {
                let found = document
                    .texcoords
                    .get(v.corner.texcoord as usize)
                    .filter(|t| t.is_finite());
                missing += usize::from(found.is_none());
                // OBJ counts v from below, glTF and this project from above.
                found.map_or(Vec2::ZERO, |t| Vec2::new(t.x, 1.0 - t.y))
            };
            mesh.texcoords = vec![vertices.iter().map(&mut texcoord).collect()];
        }
        if vertices.iter().any(|v| v.corner.normal != NONE) {
            let mut normal = |v: &Vertex| {
                let found = document
                    .normals
                    .get(v.corner.normal as usize)
                    .and_then(|n| n.try_normalize());
                missing += usize::from(found.is_none());
                found.unwrap_or(Vec3::ZERO)
            };
            mesh.normals = vertices.iter().map(&mut normal).collect();
        }
        if missing > 0 {
            let what =
                format!("{missing} vertices lack a usable vt or vn that others have; taken as 0");
            report.warn(format!("mesh '{}'", mesh.name), what);
        }
        if document.has_colors {
            let color = |v: &Vertex| {
                document
                    .colors
                    .get(v.corner.position as usize)
                    .map_or(Vec4::ONE, |c| c.extend(1.0))
            };
            mesh.colors = vertices.iter().map(color).collect();
        }
        mesh
    }
}

/// The table from positions to vertices of the mesh at work.
trait VertexTable {
    /// The vertex for a corner, a new one if there is none like it.
    fn vertex(&mut self, corner: Corner, vertices: &mut Vec<Vertex>) -> u32;
}

impl VertexTable for Vec<u32> {
    fn vertex(&mut self, corner: Corner, vertices: &mut Vec<Vertex>) -> u32 {
        let first = self[corner.position as usize];
        let mut candidate = first;
        // A position has few different texture coordinates and normals; beyond this many a double does no harm.
        for _ in 0..64 {
            match vertices.get(candidate as usize) {
                Some(vertex) if vertex.corner == corner => return candidate,
                Some(vertex) => candidate = vertex.next,
                None => break,
            }
        }
        #[expect(
            clippy::cast_possible_truncation,
            reason = "a file of 2 GiB has fewer than 2^32 corners"
        )]
        let new = vertices.len() as u32;
        vertices.push(Vertex {
            corner,
            next: first,
        });
        self[corner.position as usize] = new;
        new
    }
}
