//! The faces of a cube map: the table of OpenGL, Direct3D and Vulkan.
//!
//! | face | s grows with | t grows with |
//! |---|---|---|
//! | 0 px | -z | -y |
//! | 1 nx | +z | -y |
//! | 2 py | +x | +z |
//! | 3 ny | +x | -z |
//! | 4 pz | +x | -y |
//! | 5 nz | -x | -y |
//!
//! The space of the table is left-handed: its z is the world's -z, so that every face shows what an eye in the middle
//! sees, not its mirror image. Face pz lies ahead, where a camera looks that has not been turned.

use core::ops::Neg;
use glam::{Vec2, Vec3};

/// Names of the faces, in their order.
pub const FACE_NAMES: [&str; 6] = ["px", "nx", "py", "ny", "pz", "nz"];

/// Point `(u, v)` of a face at distance `m` from the middle, in the space of the table.
fn point<T: Copy + Neg<Output = T>>(face: usize, u: T, v: T, m: T) -> [T; 3] {
    match face {
        0 => [m, -v, -u],
        1 => [-m, -v, u],
        2 => [u, m, v],
        3 => [u, -m, -v],
        4 => [u, -v, m],
        _ => [-u, -v, -m],
    }
}

/// Face, `u`, `v` and distance from the middle of a point; of equal components z comes before y before x.
fn project<T: Copy + Neg<Output = T> + PartialOrd>([x, y, z]: [T; 3]) -> (usize, T, T, T) {
    let size = |a: T| if a < -a { -a } else { a };
    let is_negative = |a: T| a < -a;
    let (ax, ay, az) = (size(x), size(y), size(z));
    if az >= ay && az >= ax {
        let (u, face) = if is_negative(z) { (-x, 5) } else { (x, 4) };
        (face, u, -y, az)
    } else if ay >= ax {
        let (v, face) = if is_negative(y) { (-z, 3) } else { (z, 2) };
        (face, x, v, ay)
    } else {
        let (u, face) = if is_negative(x) { (z, 1) } else { (-z, 0) };
        (face, u, -y, ax)
    }
}

/// Face and texture coordinates of a direction that is not 0.
pub(super) fn coordinates(d: Vec3) -> (usize, Vec2) {
    let (face, u, v, m) = project([d.x, d.y, -d.z]);
    (face, (Vec2::new(u, v) / m + 1.0) / 2.0)
}

/// Direction of a point of a face, of unit length.
pub(super) fn direction(face: usize, at: Vec2) -> Vec3 {
    let at = 2.0 * at - 1.0;
    let [x, y, z] = point(face, at.x, at.y, 1.0);
    Vec3::new(x, y, -z).normalize()
}

/// Gradients of s and t by a direction of unit length.
pub(super) fn gradient(d: Vec3) -> [Vec3; 2] {
    let (face, u, v, m) = project([d.x, d.y, -d.z]);
    let world = |[x, y, z]: [f32; 3]| Vec3::new(x, y, -z);
    let du = world(point(face, 1.0, 0.0, 0.0));
    let dv = world(point(face, 0.0, 1.0, 0.0));
    let dm = world(point(face, 0.0, 0.0, 1.0));
    let by = 2.0 * m * m;
    [(m * du - u * dm) / by, (m * dv - v * dm) / by]
}

/// Solid angle by area of texture coordinates, `4 / (1 + u² + v²)^1.5`.
pub(super) fn density(at: Vec2) -> f32 {
    let at = 2.0 * at - 1.0;
    4.0 * (1.0 + at.length_squared()).powf(-1.5)
}

/// Solid angle of the rectangle from the middle of a face to `(u, v)`.
fn from_the_middle(u: f64, v: f64) -> f64 {
    (u * v).atan2((u * u + v * v + 1.0).sqrt())
}

/// Solid angle of a rectangle of texture coordinates, exactly.
pub(super) fn solid_angle([s0, s1]: [f64; 2], [t0, t1]: [f64; 2]) -> f64 {
    let [u0, u1, v0, v1] = [s0, s1, t0, t1].map(|x| 2.0 * x - 1.0);
    from_the_middle(u1, v1) - from_the_middle(u0, v1) - from_the_middle(u1, v0)
        + from_the_middle(u0, v0)
}

/// The texel beside the edge of a face that is meant by a column or a row just outside; `None` at a corner, where three
/// faces meet and there is no fourth texel.
///
/// In halves of texels the face has the sides `-n` and `n` and lies at distance `n`; stepping over an edge, its distance
/// becomes that of the neighbour's first row, `n - 1`, and the step ends at `n`, which is the neighbour's face.
pub(super) fn across(n: usize, face: usize, x: isize, y: isize) -> Option<(usize, usize, usize)> {
    let side = n.cast_signed();
    let halves = |i: isize| (2 * i + 1 - side).clamp(-side, side);
    let inside = |i: isize| (0..side).contains(&i);
    let distance = match (inside(x), inside(y)) {
        (true, true) => side,
        (false, false) => return None,
        _ => side - 1,
    };
    let (face, u, v, _) = project(point(face, halves(x), halves(y), distance));
    let texel = |u: isize| ((u + side - 1) / 2).cast_unsigned();
    Some((face, texel(u), texel(v)))
}
