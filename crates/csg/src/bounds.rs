//! Boxes around solids, so that most rays cost one comparison and no equation.

use crate::ray::Ray;
use core::ops::Range;
use glam::{DAffine3, DVec3};

/// A box with sides parallel to the axes. It may reach to infinity, and is empty if a lower side lies above the upper.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounds {
    /// Smallest coordinates.
    pub low: DVec3,
    /// Largest coordinates.
    pub high: DVec3,
}

/// How far boxes reach beyond what they bound, relative to size and place: a ray within a face must not be lost to
/// rounding.
pub(crate) const MARGIN: f64 = 1e-9;

impl Bounds {
    /// No point.
    pub const EMPTY: Self = Self {
        low: DVec3::INFINITY,
        high: DVec3::NEG_INFINITY,
    };

    /// All points.
    pub const EVERYTHING: Self = Self {
        low: DVec3::NEG_INFINITY,
        high: DVec3::INFINITY,
    };

    /// Whether no point lies in it.
    pub fn is_empty(&self) -> bool {
        !self.low.cmple(self.high).all()
    }

    /// Whether it ends in all directions; an empty one does.
    pub fn is_bounded(&self) -> bool {
        self.is_empty() || (self.low.is_finite() && self.high.is_finite())
    }

    /// The smallest box around both.
    pub fn union(&self, other: &Self) -> Self {
        Self {
            low: self.low.min(other.low),
            high: self.high.max(other.high),
        }
    }

    /// What lies in both.
    pub fn intersection(&self, other: &Self) -> Self {
        Self {
            low: self.low.max(other.low),
            high: self.high.min(other.high),
        }
    }

    /// Middle of it; meaningful only where it is bounded and not empty.
    pub(crate) fn centre(&self) -> DVec3 {
        (self.low + self.high) * 0.5
    }

    /// The box around this one after a transform, a little wider; a side at infinity sends all sides there.
    pub(crate) fn transformed(&self, world_from_local: &DAffine3) -> Self {
        if !self.is_bounded() {
            return Self::EVERYTHING;
        }
        let centre = world_from_local.transform_point3(self.centre());
        let half = (self.high - self.low) * 0.5;
        let m = world_from_local.matrix3;
        let reach = m.x_axis.abs() * half.x + m.y_axis.abs() * half.y + m.z_axis.abs() * half.z;
        let reach = reach + (reach + centre.abs()) * MARGIN;
        Self {
            low: centre - reach,
            high: centre + reach,
        }
    }

    /// Whether the part `range` of a ray touches it. Kay and Kajiya, *Ray tracing complex scenes* (SIGGRAPH 1986).
    #[inline]
    pub(crate) fn is_hit(&self, ray: &Ray, range: &Range<f64>) -> bool {
        let a = (self.low - ray.origin()) * ray.inverse_direction();
        let b = (self.high - ray.origin()) * ray.inverse_direction();
        let enter = a.min(b).max_element().max(range.start);
        let leave = a.max(b).min_element().min(range.end);
        enter <= leave
    }
}
