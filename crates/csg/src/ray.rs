//! Rays: half a line in the search for what is seen, a whole one where a solid's spans are asked for.

use glam::DVec3;

/// A line with a start and a direction of length 1; points on it are `origin + t direction`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ray {
    origin: DVec3,
    direction: DVec3,
    /// 1 / direction, infinite where the ray is parallel to an axis' planes.
    inverse: DVec3,
}

impl Ray {
    /// From a point into a direction of any length. If one of them is not finite or the direction has no length, the
    /// ray meets nothing.
    pub fn new(origin: DVec3, direction: DVec3) -> Self {
        let direction = if origin.is_finite() {
            direction.normalize_or_zero()
        } else {
            DVec3::ZERO
        };
        Self {
            origin,
            direction,
            inverse: direction.recip(),
        }
    }

    /// Where it starts.
    pub fn origin(&self) -> DVec3 {
        self.origin
    }

    /// Where it goes: a unit vector, or 0 if it meets nothing.
    pub fn direction(&self) -> DVec3 {
        self.direction
    }

    /// The point at distance `t` from the origin, behind it if negative.
    pub fn at(&self, t: f64) -> DVec3 {
        self.origin + self.direction * t
    }

    /// Whether it goes anywhere.
    pub(crate) fn is_cast(&self) -> bool {
        self.direction != DVec3::ZERO
    }

    pub(crate) fn inverse_direction(&self) -> DVec3 {
        self.inverse
    }
}
