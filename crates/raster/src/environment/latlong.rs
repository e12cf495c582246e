//! Latitude and longitude (equirectangular), the first environment map (Blinn and Newell 1976).
//!
//! `s = 1/2 + atan2(x, -z) / 2π`, `t = acos(y) / π`: the middle lies ahead, at -z, the right quarter at +x, the first row
//! at the zenith.

use core::f32::consts::PI;
use glam::{Vec2, Vec3};

/// Texture coordinates of a direction of unit length.
pub(super) fn coordinates(d: Vec3) -> Vec2 {
    let s = 0.5 + d.x.atan2(-d.z) / (2.0 * PI);
    // Near the poles the arc cosine would lose digits.
    let t = d.x.hypot(d.z).atan2(d.y) / PI;
    Vec2::new(s, t)
}

/// Direction of a point, of unit length.
pub(super) fn direction(at: Vec2) -> Vec3 {
    let (sin, cos) = (PI * at.y).sin_cos();
    let (right, behind) = (2.0 * PI * (at.x - 0.5)).sin_cos();
    Vec3::new(sin * right, cos, -sin * behind)
}

/// Gradients of s and t by a direction of unit length; finite at the poles, where there is none.
pub(super) fn gradient(d: Vec3) -> [Vec3; 2] {
    let square = (d.x * d.x + d.z * d.z).max(1e-12);
    let s = Vec3::new(-d.z, 0.0, d.x) / (2.0 * PI * square);
    [s, Vec3::new(0.0, -1.0 / (PI * square.sqrt()), 0.0)]
}

/// Solid angle by area of texture coordinates, `2π² sin(πt)`.
pub(super) fn density(at: Vec2) -> f32 {
    2.0 * PI * PI * (PI * at.y).sin()
}

/// Solid angle of a rectangle of texture coordinates, exactly.
pub(super) fn solid_angle([s0, s1]: [f64; 2], [t0, t1]: [f64; 2]) -> f64 {
    use core::f64::consts::PI;
    // cos a - cos b as a product: the difference would lose digits in small texels.
    let height = 2.0 * (PI * (t0 + t1) / 2.0).sin() * (PI * (t1 - t0) / 2.0).sin();
    2.0 * PI * (s1 - s0) * height
}

/// The texel that is meant by a column or a row just outside: around, or over a pole.
pub(super) fn around(width: usize, height: usize, x: isize, y: isize) -> (usize, usize) {
    let (w, h) = (width.cast_signed(), height.cast_signed());
    let (x, y) = match y {
        _ if y < 0 => (x + w / 2, -1 - y),
        _ if y >= h => (x + w / 2, 2 * h - 1 - y),
        _ => (x, y),
    };
    (
        x.rem_euclid(w).cast_unsigned(),
        y.clamp(0, h - 1).cast_unsigned(),
    )
}
