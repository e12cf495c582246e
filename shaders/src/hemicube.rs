//! Hemicubes: vertices into their frames, item buffers, sums of delta form factors.

use crate::{Shader, shader};
use bytemuck::{Pod, Zeroable};

/// Vertices into the frames of hemicubes, and what each receiver may be seen as.
pub const PLACE: Shader = shader!("hemicube_place", "hemicube_types");
/// The receivers that each face shows, in lists.
pub const ARRANGE: Shader = shader!("hemicube_arrange", "hemicube_types");
/// Item buffers.
pub const DRAW: Shader = shader!("hemicube_draw", "hemicube_types");
/// Sums of delta form factors by item.
pub const SUM: Shader = shader!("hemicube_sum", "hemicube_rows", "hemicube_types");
/// The same where panes let light through, layer by layer.
pub const PEEL: Shader = shader!("hemicube_peel", "hemicube_rows", "hemicube_types");

pub(crate) const SHADERS: [Shader; 5] = [PLACE, ARRANGE, DRAW, SUM, PEEL];

/// An element or an obstruction; its vertices are kept apart.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct Receiver {
    /// Unit normal of its lit side.
    pub normal: [f32; 3],
    /// `RECEIVER_*` bits.
    pub flags: u32,
    /// Centroid.
    pub centroid: [f32; 3],
    /// Radius around the centroid.
    pub radius: f32,
}

/// A point of a patch with a frame.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct Viewpoint {
    /// Off the surface.
    pub origin: [f32; 3],
    /// Least distance of the near planes.
    pub least_near: f32,
    /// First axis in the patch's plane.
    pub tangent: [f32; 3],
    /// Distance beyond which nothing is.
    pub farthest: f32,
    /// Second axis in the patch's plane.
    pub bitangent: [f32; 3],
    /// Unused.
    pub padding_0: u32,
    /// The patch's normal.
    pub normal: [f32; 3],
    /// Unused.
    pub padding_1: u32,
}

/// Sizes that all stages need.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq, Pod, Zeroable)]
pub struct HemicubeParams {
    /// Elements and obstructions.
    pub receivers: u32,
    /// Vertices of the mesh.
    pub vertices: u32,
    /// Elements; what follows them in the list of receivers only absorbs.
    pub elements: u32,
    /// Cells along an edge of the top face.
    pub resolution: u32,
    /// Groups of 64 receivers.
    pub groups: u32,
    /// Indices that draw a receiver: 6, or 3 where all are triangles.
    pub indices: u32,
    /// Unused.
    pub padding_0: u32,
    /// Unused.
    pub padding_1: u32,
}

/// What one draw call needs.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq, Pod, Zeroable)]
pub struct DrawParams {
    /// Which of the batch's hemicubes.
    pub viewpoint: u32,
    /// Which of its faces.
    pub face: u32,
    /// Unused.
    pub padding_0: u32,
    /// Unused.
    pub padding_1: u32,
}

/// What peeling one layer needs.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq, Pod, Zeroable)]
pub struct LayerParams {
    /// Layers before this one.
    pub layer: u32,
    /// 1 if what passes this one counts as absorbed.
    pub is_last: u32,
    /// Unused.
    pub padding_0: u32,
    /// Unused.
    pub padding_1: u32,
}

/// Both sides of its face are elements.
pub const RECEIVER_BOTH_SIDES: u32 = 1;
/// Some of it is not covered by other surfaces.
pub const RECEIVER_EXPOSED: u32 = 2;
/// It only blocks and absorbs, on both sides.
pub const RECEIVER_OBSTRUCTION: u32 = 4;
/// Faces of a hemicube.
pub const FACES: u32 = 5;
/// Masks of a hemicube over its receivers: one for each face, and one for sides that only absorb.
pub const MASKS: u32 = 6;
/// Layers of panes that are looked through.
pub const MAX_LAYERS: u32 = 8;
/// A cell that sees nothing.
pub const ITEM_EMPTY: u32 = u32::MAX;
/// Cells of a row that one invocation of the sum walks along.
pub const SEGMENT: u32 = 32;
