//! Tangents of textured triangles, by MikkTSpace.
//!
//! A normal map was made for the tangents of the program that baked it; only the same tangents read it back. Practically
//! all programs agree on Mikkelsen, *Simulation of wrinkled surfaces revisited* (master's thesis, Copenhagen 2008), and
//! glTF 2.0 prescribes it where a file has no tangents.

use bevy_mikktspace::{Geometry, TangentSpace, generate_tangents};
use glam::{Vec2, Vec3, Vec4};
use std::collections::HashMap;

/// Triangles that share vertices; vertex `i` is `positions[i]`, `normals[i]`, `texcoords[i]`.
#[derive(Debug, Clone, Copy)]
pub struct IndexedTriangles<'a> {
    /// Places of the vertices.
    pub positions: &'a [Vec3],
    /// Unit normals, pointing away from the front side.
    pub normals: &'a [Vec3],
    /// Texture coordinates: origin in the upper left corner, u right, v down.
    pub texcoords: &'a [Vec2],
    /// Three vertices each, counter-clockwise seen from the front.
    pub triangles: &'a [[u32; 3]],
}

/// Why triangles have no tangents.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum TangentError {
    /// The attributes are not of the same vertices.
    #[error(
        "{positions} positions, {normals} normals and {texcoords} texture coordinates; give one of each for each vertex"
    )]
    Lengths {
        /// Number of positions.
        positions: usize,
        /// Number of normals.
        normals: usize,
        /// Number of texture coordinates.
        texcoords: usize,
    },
    /// A triangle names a vertex that does not exist.
    #[error("triangle {triangle} has vertex {vertex}, but there are only {vertices}")]
    Index {
        /// The triangle.
        triangle: usize,
        /// The vertex that it names.
        vertex: u32,
        /// Number of vertices.
        vertices: usize,
    },
}

impl IndexedTriangles<'_> {
    /// Refuses attributes of different lengths and triangles of vertices that do not exist.
    fn check(&self) -> Result<(), TangentError> {
        let vertices = self.positions.len();
        if self.normals.len() != vertices || self.texcoords.len() != vertices {
            return Err(TangentError::Lengths {
                positions: vertices,
                normals: self.normals.len(),
                texcoords: self.texcoords.len(),
            });
        }
        let is_missing = |&(_, &vertex): &(usize, &u32)| vertex as usize >= vertices;
        let corners = self.triangles.iter().enumerate();
        let mut corners = corners.flat_map(|(i, triangle)| triangle.iter().map(move |v| (i, v)));
        corners
            .find(is_missing)
            .map_or(Ok(()), |(triangle, &vertex)| {
                Err(TangentError::Index {
                    triangle,
                    vertex,
                    vertices,
                })
            })
    }

    fn is_finite(&self, triangle: [u32; 3]) -> bool {
        triangle.into_iter().all(|vertex| {
            let i = vertex as usize;
            let (p, n, t) = (self.positions[i], self.normals[i], self.texcoords[i]);
            p.is_finite() && n.is_finite() && t.is_finite()
        })
    }

    /// The bits of a vertex; `+ 0.0` makes the two zeros one.
    fn key(&self, vertex: u32) -> [u32; 8] {
        let i = vertex as usize;
        let (p, n, t) = (self.positions[i], self.normals[i], self.texcoords[i]);
        [p.x, p.y, p.z, n.x, n.y, n.z, t.x, t.y].map(|value| (value + 0.0).to_bits())
    }

    /// A tangent for a triangle on its own: towards growing u, as far as there is such a direction.
    fn flat_tangents(&self, triangle: [u32; 3]) -> [Vec4; 3] {
        let [a, b, c] = triangle.map(|vertex| vertex as usize);
        let (e1, e2) = (
            self.positions[b] - self.positions[a],
            self.positions[c] - self.positions[a],
        );
        let (t1, t2) = (
            self.texcoords[b] - self.texcoords[a],
            self.texcoords[c] - self.texcoords[a],
        );
        let area = t1.perp_dot(t2);
        let along_u = (e1 * t2.y - e2 * t1.y) * area.signum();
        // v points down, so the area of what is not mirrored is negative.
        let sign = if area > 0.0 { -1.0 } else { 1.0 };
        [a, b, c].map(|vertex| orthonormal(self.normals[vertex], along_u).extend(sign))
    }
}

/// The part of `tangent` at right angles to `normal`, of length 1; any such direction if there is none.
fn orthonormal(normal: Vec3, tangent: Vec3) -> Vec3 {
    let projected = tangent - normal * normal.dot(tangent);
    projected.try_normalize().unwrap_or_else(|| {
        normal
            .try_normalize()
            .map_or(Vec3::X, |n| n.any_orthonormal_vector())
    })
}

/// Triangles that may meet in one vertex. The grouping of MikkTSpace recurses from triangle to triangle and compares all
/// pairs; real fans have tens, and a made-up one of a million would overflow the stack.
const MOST_AROUND_VERTEX: usize = 2048;

/// The tangents of all corners: `xyz` of length 1 towards growing u, `w` the sign of the bitangent.
///
/// As in glTF the bitangent `B = w (N x T)` points up in the texture, towards *falling* v (the interface of MikkTSpace
/// takes v as growing upwards; hence its sign is turned). Corners of a vertex have the same tangent unless the texture
/// is mirrored between their triangles; [`split_vertices`] makes vertices of them.
///
/// Triangles without area in space or texture inherit from neighbours. Where nothing can be inherited, a number is not
/// finite, or more than 2048 triangles meet in a vertex, a triangle takes the tangent of its own plane; where it has none
/// either, any direction at right angles to the normal.
pub fn corner_tangents(mesh: &IndexedTriangles<'_>) -> Result<Vec<[Vec4; 3]>, TangentError> {
    mesh.check()?;
    let tangents = mesh.triangles.iter().map(|&triangle| {
        if mesh.is_finite(triangle) {
            mesh.flat_tangents(triangle)
        } else {
            [Vec4::new(1.0, 0.0, 0.0, 1.0); 3]
        }
    });
    let mut corners = Corners {
        mesh,
        faces: smoothed_faces(mesh),
        tangents: tangents.collect(),
    };
    // Its error type has no values.
    let _ = generate_tangents(&mut corners);
    Ok(corners.tangents)
}

/// The triangles for MikkTSpace: those with finite numbers, not too many around a vertex.
fn smoothed_faces(mesh: &IndexedTriangles<'_>) -> Vec<usize> {
    let mut counts: HashMap<[u32; 8], usize> = HashMap::new();
    let mut take = |triangle: [u32; 3]| {
        triangle.iter().fold(true, |all, &vertex| {
            let count = counts.entry(mesh.key(vertex)).or_default();
            *count += 1;
            all && *count <= MOST_AROUND_VERTEX
        })
    };
    let faces = mesh.triangles.iter().enumerate();
    faces
        .filter(|&(_, &triangle)| mesh.is_finite(triangle) && take(triangle))
        .map(|(i, _)| i)
        .collect()
}

/// What MikkTSpace reads and writes.
struct Corners<'a> {
    mesh: &'a IndexedTriangles<'a>,
    /// Triangle of each of its faces.
    faces: Vec<usize>,
    /// Of all triangles.
    tangents: Vec<[Vec4; 3]>,
}

impl Corners<'_> {
    fn vertex(&self, face: usize, corner: usize) -> usize {
        self.mesh.triangles[self.faces[face]][corner] as usize
    }
}

impl Geometry for Corners<'_> {
    fn num_faces(&self) -> usize {
        self.faces.len()
    }

    fn num_vertices_of_face(&self, _: usize) -> usize {
        3
    }

    fn position(&self, face: usize, corner: usize) -> [f32; 3] {
        self.mesh.positions[self.vertex(face, corner)].into()
    }

    fn normal(&self, face: usize, corner: usize) -> [f32; 3] {
        self.mesh.normals[self.vertex(face, corner)].into()
    }

    fn tex_coord(&self, face: usize, corner: usize) -> [f32; 2] {
        self.mesh.texcoords[self.vertex(face, corner)].into()
    }

    fn set_tangent(&mut self, space: Option<TangentSpace>, face: usize, corner: usize) {
        let Some([x, y, z, w]) = space.map(|space| space.tangent_encoded()) else {
            return;
        };
        let tangent = Vec3::new(x, y, z);
        if tangent.is_finite() && tangent != Vec3::ZERO {
            self.tangents[self.faces[face]][corner] = tangent.extend(-w);
        }
    }
}

/// Vertices each with one tangent.
#[derive(Debug, Clone, PartialEq)]
pub struct SplitVertices {
    /// For each vertex, the one it was made from; copies stand at the end.
    pub sources: Vec<u32>,
    /// For each vertex its tangent; zero for a vertex of no triangle.
    pub tangents: Vec<Vec4>,
    /// The triangles, of these vertices.
    pub triangles: Vec<[u32; 3]>,
}

/// Copies the vertices at which triangles of different tangents meet, so that each has one.
///
/// `tangents` are the corners' as [`corner_tangents`] returns them; vertices `0..vertices` stay where they are.
///
/// # Panics
/// If there is not one tangent for each corner, a vertex is missing, or there are more than 2^32 of them in the end.
pub fn split_vertices(
    vertices: usize,
    triangles: &[[u32; 3]],
    tangents: &[[Vec4; 3]],
) -> SplitVertices {
    assert_eq!(triangles.len(), tangents.len(), "tangents of the triangles");
    let index = |i: usize| u32::try_from(i).expect("fewer than 2^32 vertices");
    let mut split = SplitVertices {
        sources: (0..vertices).map(index).collect(),
        tangents: vec![Vec4::ZERO; vertices],
        triangles: triangles.to_vec(),
    };
    let mut copies: HashMap<(u32, [u32; 4]), u32> = HashMap::new();
    for (triangle, tangents) in split.triangles.iter_mut().zip(tangents) {
        for (vertex, tangent) in triangle.iter_mut().zip(tangents) {
            let original = *vertex;
            let first = &mut split.tangents[original as usize];
            if *first == Vec4::ZERO {
                *first = *tangent;
            }
            if *first != *tangent {
                let bits = tangent.to_array().map(f32::to_bits);
                *vertex = *copies.entry((original, bits)).or_insert_with(|| {
                    split.sources.push(original);
                    split.tangents.push(*tangent);
                    index(split.sources.len() - 1)
                });
            }
        }
    }
    split
}

/// The bitangent `B = w (N x T)`: up in the texture.
#[inline]
pub fn bitangent(normal: Vec3, tangent: Vec4) -> Vec3 {
    normal.cross(tangent.truncate()) * tangent.w
}
