//! The unit sphere.

use super::{CentredLine, Ends};

/// The line's nearest point halves the chord, and Pythagoras gives its length.
pub(super) fn ends(line: &CentredLine) -> Ends {
    let half_squared = 1.0 - line.origin.length_squared();
    if half_squared > 0.0 {
        let half = half_squared.sqrt();
        Ends::span(-half, half)
    } else {
        Ends::NONE
    }
}
