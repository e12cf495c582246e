//! Everything below the plane y = 0.

use super::{CentredLine, Ends};

/// A half-line, all of a line parallel to the plane, or nothing.
pub(super) fn ends(line: &CentredLine) -> Ends {
    let (height, slope) = (line.origin.y, line.direction.y);
    let crossing = -height / slope;
    if slope > 0.0 {
        Ends::span(f64::NEG_INFINITY, crossing)
    } else if slope < 0.0 {
        Ends::span(crossing, f64::INFINITY)
    } else if height <= 0.0 {
        Ends::span(f64::NEG_INFINITY, f64::INFINITY)
    } else {
        Ends::NONE
    }
}
