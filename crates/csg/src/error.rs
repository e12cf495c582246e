//! Why a solid, a material or a camera cannot be.

/// A parameter that makes no sense; one line: what, where, how to mend it.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CsgError {
    /// A length is too small, too large or not a number.
    #[error(
        "{shape}: {what} is {value}; give a length from {} to {}",
        crate::SMALLEST,
        crate::LARGEST
    )]
    Length {
        /// Which solid.
        shape: &'static str,
        /// Which of its lengths.
        what: &'static str,
        /// What was given.
        value: f64,
    },
    /// A point is not finite or too far away.
    #[error("{shape}: {what} is ({}, {}, {}); give coordinates of at most {} in magnitude", value[0], value[1], value[2], crate::LARGEST)]
    Point {
        /// Which solid, or the camera.
        shape: &'static str,
        /// Which of its points.
        what: &'static str,
        /// What was given.
        value: [f64; 3],
    },
    /// A direction has no length, or is not finite.
    #[error("{shape}: {what} is ({}, {}, {}), which has no direction; give a vector with a length above 0", value[0], value[1], value[2])]
    Direction {
        /// Which solid, or the camera.
        shape: &'static str,
        /// Which of its directions.
        what: &'static str,
        /// What was given.
        value: [f64; 3],
    },
    /// A transform flattens space, or its numbers are out of reach.
    #[error(
        "transform: its determinant is {determinant}; give one that stretches every direction by a factor from 1e-6 to 1e6"
    )]
    Transform {
        /// Determinant of its linear part.
        determinant: f64,
    },
    /// A share or a colour is not in [0, 1].
    #[error("{what} is {value}; give a share from 0 to 1")]
    Share {
        /// Which one.
        what: &'static str,
        /// What was given.
        value: f32,
    },
    /// A number lies outside its range.
    #[error("{what} is {value}; give a number from {low} to {high}")]
    Number {
        /// Which one.
        what: &'static str,
        /// What was given.
        value: f64,
        /// Smallest that is taken.
        low: f64,
        /// Largest that is taken.
        high: f64,
    },
}

/// Refuses a share that is not in [0, 1].
pub(crate) fn check_share(what: &'static str, value: f32) -> Result<(), CsgError> {
    if (0.0..=1.0).contains(&value) {
        return Ok(());
    }
    Err(CsgError::Share { what, value })
}

/// Refuses a number outside a range.
pub(crate) fn check_number(
    what: &'static str,
    value: f64,
    low: f64,
    high: f64,
) -> Result<(), CsgError> {
    if (low..=high).contains(&value) {
        return Ok(());
    }
    Err(CsgError::Number {
        what,
        value,
        low,
        high,
    })
}
