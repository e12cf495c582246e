//! Sorted shooting with all its state on the device.

use crate::{Shader, shader};
use bytemuck::{Pod, Zeroable};

/// Choosing the patch that shoots, spreading its light, measuring what is left.
pub const SHOOTING: Shader = shader!("shooting", "hemicube_types");

pub(crate) const SHADERS: [Shader; 1] = [SHOOTING];

/// Sizes that all stages need.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct ShootingParams {
    /// Elements.
    pub elements: u32,
    /// Patches.
    pub patches: u32,
    /// Groups of luminaires times bands.
    pub channels: u32,
    /// Sums of each hemicube: 3 where panes let light of each band through by its own share, else 1.
    pub bands: u32,
    /// Distance beyond which nothing is.
    pub farthest: f32,
    /// Unused.
    pub padding_0: u32,
    /// Unused.
    pub padding_1: u32,
    /// Unused.
    pub padding_2: u32,
}

/// What a shot needs to know of an element.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct ElementLight {
    /// Exposed area.
    pub area: f32,
    /// 0 where nothing of it is exposed.
    pub inverse_area: f32,
    /// Unused.
    pub padding_0: u32,
    /// Unused.
    pub padding_1: u32,
    /// Of each band.
    pub reflectance: [f32; 3],
    /// Unused.
    pub padding_2: u32,
}

/// A patch: its elements and its hemicubes.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct ShootingPatch {
    /// Its first element.
    pub first_element: u32,
    /// Number of its elements.
    pub elements: u32,
    /// Where its hemicubes stand: the first.
    pub first_view: u32,
    /// Number of its hemicubes.
    pub views: u32,
    /// Its normal.
    pub normal: [f32; 3],
    /// Unused.
    pub padding: u32,
}

/// Where a hemicube of a patch stands; the rest of its frame follows from the patch.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct ShotView {
    /// Off the surface.
    pub origin: [f32; 3],
    /// Share of the patch that it stands for.
    pub weight: f32,
    /// First axis in the patch's plane.
    pub tangent: [f32; 3],
    /// Least distance of the near planes.
    pub least_near: f32,
}

/// Where the solver is.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct ShotState {
    /// The patch that shoots.
    pub shooter: u32,
    /// Which of its hemicubes is drawn.
    pub view: u32,
    /// How many it has; 0 if nobody has anything to shoot.
    pub views: u32,
    /// Patches that have begun to shoot.
    pub shots: u32,
    /// Share of the patch that the hemicube stands for.
    pub weight: f32,
    /// Unshot flux over all patches, absolute, when it was last looked at.
    pub unshot: f32,
    /// The most that one patch has.
    pub largest: f32,
    /// No patch begins to shoot after so many.
    pub most_shots: u32,
}

/// Numbers of each channel behind the light: flux shot; flux absorbed by backs and flux escaped, both with what their sums
/// have lost to rounding; flux that elements have received; flux that is unshot.
pub const CHANNEL_WORDS: u32 = 7;

/// Elements whose light may come to the CPU after every step.
pub const MOST_WATCHED: u32 = 4;
