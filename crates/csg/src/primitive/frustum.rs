//! Cylinders, cones and what lies between.
//!
//! Inside is where `q(t) = x² + z² - (1 - taper y)²` is not above 0, between the planes y = 0 and y = 1. The quadric
//! goes on behind its apex; since the taper is at most 1, the apex lies at y = 1 or beyond, and the planes cut that
//! half off.

use super::{CentredLine, Ends};
use glam::DVec3;

/// The part of the line between the planes that is inside of the quadric.
pub(super) fn ends(taper: f64, line: &CentredLine) -> Ends {
    let Some([low, high]) = between_planes(line) else {
        return Ends::NONE;
    };
    let (o, d) = (line.origin, line.direction);
    let (radius, slope) = (1.0 - taper * o.y, -taper * d.y);
    // q(t) = a t² + 2 b t + c
    let a = d.x * d.x + d.z * d.z - slope * slope;
    let b = o.x * d.x + o.z * d.z - radius * slope;
    let c = o.x * o.x + o.z * o.z - radius * radius;
    let discriminant = b * b - a * c;
    if discriminant <= 0.0 {
        // A line through the apex inside of both halves, or along the surface; or one that misses.
        let is_inside = a < 0.0 || (a == 0.0 && c < 0.0);
        return if is_inside {
            Ends::span(low, high)
        } else {
            Ends::NONE
        };
    }
    // Without cancellation; one of the two is infinite where a is 0.
    let q = -(b + discriminant.sqrt().copysign(b));
    let (r, s) = (q / a, c / q);
    let (first, last) = (r.min(s), r.max(s));
    if a > 0.0 {
        return Ends::span(low.max(first), high.min(last));
    }
    if a == 0.0 {
        // q(t) = 2 b t + c
        let root = s;
        return if b > 0.0 {
            Ends::span(low, high.min(root))
        } else {
            Ends::span(low.max(root), high)
        };
    }
    // Steeper than the cone: inside before the first root in one half, behind the last in the other one.
    let (before, behind) = (high.min(first), low.max(last));
    if before - low >= high - behind {
        Ends::span(low, before)
    } else {
        Ends::span(behind, high)
    }
}

/// The part of the line with 0 <= y <= 1.
fn between_planes(line: &CentredLine) -> Option<[f64; 2]> {
    let (height, slope) = (line.origin.y, line.direction.y);
    if slope == 0.0 {
        let is_between = (0.0..=1.0).contains(&height);
        return is_between.then_some([f64::NEG_INFINITY, f64::INFINITY]);
    }
    let (a, b) = (-height / slope, (1.0 - height) / slope);
    Some([a.min(b), a.max(b)])
}

/// Of the side, the bottom or the top, whichever is nearest.
pub(super) fn normal(taper: f64, p: DVec3) -> DVec3 {
    let radius = 1.0 - taper * p.y;
    let rho = p.x.hypot(p.z);
    let off_side = (rho - radius).abs();
    if off_side <= p.y.abs() && off_side <= (1.0 - p.y).abs() {
        DVec3::new(p.x, taper * radius, p.z)
    } else if p.y < 0.5 {
        DVec3::NEG_Y
    } else {
        DVec3::Y
    }
}

pub(super) fn contains(taper: f64, p: DVec3) -> bool {
    let radius = 1.0 - taper * p.y;
    (0.0..=1.0).contains(&p.y) && p.x * p.x + p.z * p.z <= radius * radius
}
