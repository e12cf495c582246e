//! The octahedron `|x| + |y| + |z| = 1` unfolded into a square (Praun and Hoppe 2003; Engelhardt and Dachsbacher 2008).
//!
//! The middle is the zenith, the corners are the nadir, the horizon is the square on its tip between them; +x is at the
//! right, what lies ahead (-z) at the lower side: the sky as one sees it lying on the back, feet ahead.

use super::solid_angle::{of_polygon, split_at_zero};
use glam::{DVec2, DVec3, Vec2, Vec3};

/// With the sign of `of`, where 0 counts as positive.
fn signed(size: f32, of: f32) -> f32 {
    if of < 0.0 { -size } else { size }
}

/// Texture coordinates of a direction that is not 0.
pub(super) fn coordinates(d: Vec3) -> Vec2 {
    let d = d / (d.x.abs() + d.y.abs() + d.z.abs());
    let (u, v) = if d.y >= 0.0 {
        (d.x, d.z)
    } else {
        (signed(1.0 - d.z.abs(), d.x), signed(1.0 - d.x.abs(), d.z))
    };
    Vec2::new(1.0 + u, 1.0 - v) / 2.0
}

/// Point of the octahedron, not of unit length.
fn on_octahedron(at: Vec2) -> Vec3 {
    let (u, v) = (2.0 * at.x - 1.0, 1.0 - 2.0 * at.y);
    let y = 1.0 - u.abs() - v.abs();
    if y >= 0.0 {
        Vec3::new(u, y, v)
    } else {
        Vec3::new(signed(1.0 - v.abs(), u), y, signed(1.0 - u.abs(), v))
    }
}

/// Direction of a point, of unit length.
pub(super) fn direction(at: Vec2) -> Vec3 {
    on_octahedron(at).normalize()
}

/// Gradients of s and t by a direction of unit length.
pub(super) fn gradient(d: Vec3) -> [Vec3; 2] {
    let sum = d.x.abs() + d.y.abs() + d.z.abs();
    let p = d / sum;
    let signs = Vec3::new(signed(1.0, d.x), signed(1.0, d.y), signed(1.0, d.z));
    let du = (Vec3::X - p.x * signs) / sum;
    let dv = (Vec3::Z - p.z * signs) / sum;
    if d.y >= 0.0 {
        return [du / 2.0, -dv / 2.0];
    }
    // Below the horizon u is the sign of x times 1 - |z|, v that of z times 1 - |x|.
    let side = signs.x * signs.z;
    [-side * dv / 2.0, side * du / 2.0]
}

/// Solid angle by area of texture coordinates, `4 / |p|³` with `p` on the octahedron.
pub(super) fn density(at: Vec2) -> f32 {
    4.0 * on_octahedron(at).length_squared().powf(-1.5)
}

/// Solid angle of a rectangle of texture coordinates, exactly: it is cut at the axes and at the horizon into polygons
/// that lie flat on faces of the octahedron.
pub(super) fn solid_angle(s: [f64; 2], t: [f64; 2]) -> f64 {
    let scaled = |[a, b]: [f64; 2]| [2.0 * a - 1.0, 2.0 * b - 1.0];
    let mut sum = 0.0;
    for [u0, u1] in split_at_zero(scaled(s)) {
        for [v0, v1] in split_at_zero(scaled(t)) {
            sum += in_a_quarter([u0, u1], [v0, v1]);
        }
    }
    sum
}

/// As [`solid_angle`], of a rectangle in one quarter, by absolute values.
fn in_a_quarter([u0, u1]: [f64; 2], [v0, v1]: [f64; 2]) -> f64 {
    let corners = [(u0, v0), (u1, v0), (u1, v1), (u0, v1)].map(DVec2::from);
    let upper = clipped(&corners, |p| 1.0 - p.x - p.y);
    let lower = clipped(&corners, |p| p.x + p.y - 1.0);
    let folded: Vec<DVec2> = lower
        .iter()
        .map(|p| DVec2::new(1.0 - p.y, 1.0 - p.x))
        .collect();
    [upper, folded].iter().map(|part| of_face(part)).sum()
}

fn of_face(polygon: &[DVec2]) -> f64 {
    let lifted: Vec<DVec3> = polygon
        .iter()
        .map(|p| DVec3::new(p.x, (1.0 - p.x - p.y).max(0.0), p.y))
        .collect();
    of_polygon(&lifted)
}

/// The part of a convex polygon where a linear function is not negative (Sutherland and Hodgman 1974).
fn clipped(polygon: &[DVec2], height: impl Fn(DVec2) -> f64) -> Vec<DVec2> {
    let mut kept = Vec::with_capacity(polygon.len() + 1);
    for (i, &a) in polygon.iter().enumerate() {
        let b = polygon[(i + 1) % polygon.len()];
        let (ha, hb) = (height(a), height(b));
        if ha >= 0.0 {
            kept.push(a);
        }
        if (ha > 0.0 && hb < 0.0) || (ha < 0.0 && hb > 0.0) {
            kept.push(a + (b - a) * (ha / (ha - hb)));
        }
    }
    kept
}

/// The texel that is meant by a column or a row just outside: each side of the square is sewn to itself, turned over at
/// its middle.
pub(super) fn across(n: usize, x: isize, y: isize) -> (usize, usize) {
    let side = n.cast_signed();
    let (mut x, mut y) = (x, y);
    if !(0..side).contains(&x) {
        (x, y) = (x.clamp(0, side - 1), side - 1 - y);
    }
    if !(0..side).contains(&y) {
        (x, y) = (side - 1 - x, y.clamp(0, side - 1));
    }
    (x.cast_unsigned(), y.cast_unsigned())
}
