//! Conversions that may lose digits, said once.

/// Sums are made in f64 and kept in f32.
#[expect(clippy::cast_possible_truncation, reason = "light is kept in f32")]
pub(crate) fn to_f32(x: f64) -> f32 {
    x as f32
}

/// The nearest whole number; 0 of negative ones and of what is none.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a cast of floats saturates"
)]
pub(crate) fn nearest(x: f64) -> usize {
    x.round() as usize
}
