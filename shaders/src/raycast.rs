//! Form factors by casting rays.

use crate::{Shader, shader};
use bytemuck::{Pod, Zeroable};

/// Rays from a patch, counted where they arrive; they walk a tree in the shader.
pub const RAYCAST: Shader = shader!("raycast", "rays");
/// The same by ray queries, which not every adapter has.
pub const RAY_QUERY: Shader = shader!("ray_query", "rays");

pub(crate) const SHADERS: [Shader; 2] = [RAYCAST, RAY_QUERY];

/// Where the rays of a patch begin.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct RayParams {
    /// Rays of the patch.
    pub rays: u32,
    /// Polygons that the patch consists of.
    pub parts: u32,
    /// Elements of the mesh.
    pub elements: u32,
    /// Number of the first ray of the dispatch.
    pub first_ray: u32,
    /// Beginning of the sequences, in 2⁻³².
    pub shift: [u32; 4],
    /// First axis in the patch's plane.
    pub tangent: [f32; 3],
    /// Distance by which rays begin off the surface.
    pub offset: f32,
    /// Second axis in the patch's plane.
    pub bitangent: [f32; 3],
    /// Distance beyond which nothing is.
    pub farthest: f32,
    /// The patch's normal.
    pub normal: [f32; 3],
    /// Distance by which sides that only absorb lag behind.
    pub lag: f32,
}

/// A polygon of a patch.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct RayPart {
    /// Its corners; the fourth number of each is unused.
    pub corners: [[f32; 4]; 4],
    /// Share of the patch up to the end of this part.
    pub share: f32,
    /// 3 or 4.
    pub count: u32,
    /// Unused.
    pub padding_0: u32,
    /// Unused.
    pub padding_1: u32,
}

/// Half an element, or of an obstruction.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct RayTriangle {
    /// First corner.
    pub a: [f32; 3],
    /// The element; the number of elements for what only absorbs.
    pub element: u32,
    /// Second corner.
    pub b: [f32; 3],
    /// 1 if its other side is an element of its own.
    pub both_sides: u32,
    /// Third corner.
    pub c: [f32; 3],
    /// Unused.
    pub padding: u32,
}

/// Mask of the instance whose fronts receive.
pub const RECEIVES: u32 = 1;
/// Mask of the instance whose backs absorb.
pub const ABSORBS: u32 = 2;

/// Levels that the tree may have, at most.
pub const STACK: u32 = 32;
