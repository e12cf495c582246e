//! The cube from -1 to 1, which a transform makes any parallelepiped.

use super::{CentredLine, Ends};
use glam::DVec3;

/// The part of the line between each pair of planes, and of those what is common.
pub(super) fn ends(line: &CentredLine) -> Ends {
    let (mut enter, mut leave) = (f64::NEG_INFINITY, f64::INFINITY);
    for axis in 0..3 {
        let (place, slope) = (line.origin[axis], line.direction[axis]);
        if slope == 0.0 {
            if place.abs() > 1.0 {
                return Ends::NONE;
            }
        } else {
            let (a, b) = ((-1.0 - place) / slope, (1.0 - place) / slope);
            enter = enter.max(a.min(b));
            leave = leave.min(a.max(b));
        }
    }
    Ends::span(enter, leave)
}

/// Of the face that is nearest: the one whose coordinate is largest.
pub(super) fn normal(p: DVec3) -> DVec3 {
    let size = p.abs();
    if size.x >= size.y && size.x >= size.z {
        DVec3::X * p.x
    } else if size.y >= size.z {
        DVec3::Y * p.y
    } else {
        DVec3::Z * p.z
    }
}
