//! Geometry.

use glam::{Affine3A, Vec2, Vec3, Vec4};
use serde::{Deserialize, Serialize};

/// Faces over shared vertices, all of one material: a glTF primitive, an OBJ group.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Mesh {
    /// Name of the mesh in the file, with the primitive's number where there are several.
    pub name: String,
    /// Index into [`Scene::materials`](crate::Scene::materials).
    pub material: usize,
    /// Vertex positions in the mesh's own space.
    pub positions: Vec<Vec3>,
    /// Vertex normals of unit length; empty if the file has none. They shade, they do not decide sides.
    pub normals: Vec<Vec3>,
    /// Vertex tangents from the file, along +u of the relief's texture coordinates (xyz, unit length), and the sign of
    /// the bitangent `w N × T`, which points upwards in the picture; empty if the file has none.
    pub tangents: Vec<Vec4>,
    /// Sets of texture coordinates, origin in the upper left corner of the picture, +v down (as in glTF); each set is
    /// as long as `positions`.
    pub texcoords: Vec<Vec<Vec2>>,
    /// Vertex colours: linear factors of the base colour (rgb) and alpha (a); empty if the file has none.
    pub colors: Vec<Vec4>,
    /// Triangles and planar convex quads.
    pub faces: Vec<Face>,
}

/// A polygon over vertices of its mesh, counter-clockwise seen from its front.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Face {
    /// Three corners.
    Triangle([u32; 3]),
    /// Four corners in a plane, convex.
    Quad([u32; 4]),
}

impl Face {
    /// The vertex indices.
    pub fn corners(&self) -> &[u32] {
        match self {
            Self::Triangle(corners) => corners,
            Self::Quad(corners) => corners,
        }
    }
}

/// A mesh placed in the world.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Instance {
    /// Name of the scene node by which `--hide` and `--flip` find it.
    pub node: String,
    /// Index of the mesh in [`Scene::meshes`](crate::Scene::meshes).
    pub mesh: usize,
    /// World from mesh. A mirroring transform keeps the front of the faces on the outside, as glTF asks.
    pub world_from_mesh: Affine3A,
    /// Turns all faces of this instance around.
    pub flipped: bool,
}
