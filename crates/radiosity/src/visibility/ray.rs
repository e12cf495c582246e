//! A ray with what the tests against boxes and quads want to know of it.

use glam::Vec3;

/// A ray up to some length.
#[derive(Debug, Clone, Copy, Default)]
#[repr(C, align(32))]
pub(super) struct Ray {
    /// 1 / direction, bounded.
    pub(super) inverse: [f32; 3],
    /// What to add to `plane × inverse` for a lower and an upper bound of the distance of an axis-aligned plane.
    pub(super) near: [f32; 3],
    pub(super) far: [f32; 3],
    pub(super) length: f32,
    /// Coordinates of the origin, in the order of `axes`.
    pub(super) origin: [f32; 3],
    /// `d_x / d_z`, `d_y / d_z` and `1 / d_z` of the direction in the order of `axes`.
    pub(super) shear: [f32; 3],
    /// The axes turned so that the last is the direction's longest.
    pub(super) axes: [u8; 3],
    /// 1 for each axis along which it runs down.
    pub(super) runs_down: [u8; 3],
}

impl Ray {
    /// A ray in a scene whose coordinates are at most `extent` in size. `length` and all distances are
    /// in units of the direction's length.
    ///
    /// Bounds of distances are widened by what rounding may do to them, so that no box is missed whose content is
    /// met. Of components below 1e-18 the ray is taken to run along the plane: there nothing moves by more than that.
    #[inline(always)]
    pub(super) fn new(origin: Vec3, direction: Vec3, length: f32, extent: Vec3) -> Self {
        let magnitude = direction.abs();
        let is_tiny = magnitude.cmplt(Vec3::splat(1e-18));
        let inverse = Vec3::select(is_tiny, Vec3::splat(1e18), 1.0 / direction);
        // Four roundings of half an epsilon each, and as much again for the corners' own projection.
        let rounding = (origin.abs() + extent) * inverse.abs() * (4.0 * f32::EPSILON);
        let offset = -origin * inverse;
        let longest = longest_axis(magnitude);
        let axes = [(longest + 1) % 3, (longest + 2) % 3, longest];
        let [x, y, z] = axes.map(|axis| direction[usize::from(axis)]);
        let inverse_z = 1.0 / z;
        Self {
            inverse: inverse.to_array(),
            near: (offset - rounding).to_array(),
            far: (offset + rounding).to_array(),
            length,
            origin: axes.map(|axis| origin[usize::from(axis)]),
            shear: [x * inverse_z, y * inverse_z, inverse_z],
            axes,
            runs_down: inverse.to_array().map(|i| u8::from(i < 0.0)),
        }
    }

    /// The ray from one point to another; its distances are shares of the way.
    #[inline(always)]
    pub(super) fn between(from: Vec3, to: Vec3, extent: Vec3) -> Self {
        Self::new(from, to - from, 1.0, extent)
    }
}

fn longest_axis(magnitude: Vec3) -> u8 {
    if magnitude.x > magnitude.y && magnitude.x > magnitude.z {
        0
    } else if magnitude.y > magnitude.z {
        1
    } else {
        2
    }
}
