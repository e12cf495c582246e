//! Procedural bumps: heights as functions of space, each with its exact gradient.
//!
//! A [`Relief`] is taken at a point of space for bumps that need no texture coordinates
//! ([`SurfaceGradient::from_volume`](super::SurfaceGradient::from_volume)), or at `(u, v, 0)` for bumps of a texture, whose
//! slopes are then the gradient's x and y.

mod noise;
mod patterns;

pub use noise::{Noise, OrangePeel};
pub use patterns::{Bricks, GolfBall, Ripples};

use glam::Vec3;

/// A height and its gradient.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ReliefSample {
    /// Height, in the unit of lengths.
    pub height: f32,
    /// Its derivatives by x, y and z.
    pub gradient: Vec3,
}

/// A height in space. Where a point is not finite it is flat: height 0, gradient 0.
pub trait Relief {
    /// The height and its gradient at a point.
    fn sample(&self, point: Vec3) -> ReliefSample;
}

impl ReliefSample {
    /// Flat.
    pub const FLAT: Self = Self {
        height: 0.0,
        gradient: Vec3::ZERO,
    };

    fn or_flat(self) -> Self {
        if self.height.is_finite() && self.gradient.is_finite() {
            self
        } else {
            Self::FLAT
        }
    }
}

/// A hump of height 1 and radius 1 by the square of the distance, `(1 - t)^3`, with its derivative by that square; twice
/// continuously differentiable where it ends.
fn hump(square: f32) -> (f32, f32) {
    let rest = 1.0 - square;
    if rest > 0.0 {
        (rest * rest * rest, -3.0 * rest * rest)
    } else {
        (0.0, 0.0)
    }
}
