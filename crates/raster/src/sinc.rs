//! `sin x / x`, in the two precisions that are needed.

/// `sin x / x`, 1 at 0.
#[inline]
pub(crate) fn sinc(x: f64) -> f64 {
    if x.abs() < 1e-8 { 1.0 } else { x.sin() / x }
}

/// `sin x / x`, 1 at 0.
#[inline]
pub(crate) fn sinc32(x: f32) -> f32 {
    if x.abs() < 1e-4 { 1.0 } else { x.sin() / x }
}
