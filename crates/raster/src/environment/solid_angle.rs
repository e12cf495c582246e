//! Solid angles of polygons and of parts of discs.

use core::f64::consts::TAU;
use glam::{DVec2, DVec3};

/// Solid angle of a flat convex polygon seen from the origin, its corners at any distance, as a fan of triangles
/// (van Oosterom and Strackee 1983). 0 for fewer than three corners.
pub(super) fn of_polygon(corners: &[DVec3]) -> f64 {
    let unit: Vec<DVec3> = corners.iter().map(|p| p.normalize_or_zero()).collect();
    let Some((&a, rest)) = unit.split_first() else {
        return 0.0;
    };
    rest.windows(2)
        .map(|pair| of_triangle(a, pair[0], pair[1]))
        .sum()
}

/// Of a triangle of unit vectors: `tan(Ω/2) = |a·(b×c)| / (1 + a·b + b·c + c·a)`.
fn of_triangle(a: DVec3, b: DVec3, c: DVec3) -> f64 {
    let volume = (b - a).cross(c - a).dot(a).abs();
    2.0 * volume.atan2(1.0 + a.dot(b) + b.dot(c) + c.dot(a))
}

/// The parts of an interval left and right of 0, by absolute values.
pub(super) fn split_at_zero([low, high]: [f64; 2]) -> impl Iterator<Item = [f64; 2]> {
    let left = (low < 0.0).then(|| [-high.min(0.0), -low]);
    let right = (high > 0.0).then(|| [low.max(0.0), high]);
    left.into_iter().chain(right)
}

/// A projection around an axis onto the unit disc.
pub(super) trait Disc {
    /// `(1 - cos θ) / r²` for the angle θ that is seen at distance `r` from the middle: the solid angle of the cap
    /// inside, by that of its picture, and twice that.
    fn cap_by_square(&self, r: f64) -> f64;
}

/// Solid angle of the part of a rectangle that lies in the unit disc.
///
/// By Stokes' theorem it is the integral of `(1 - cos θ) dφ` along the border. On a straight piece from `a` to `b`, `dφ` is
/// `(a × b) / r²` by the share of the way, so what is left is a smooth function of `r`: Gauss and Legendre integrate it to
/// rounding (hemispherical: to 1e-4 of the texels that touch the rim). On the rim `1 - cos θ` is constant. Neighbours share their sides, so errors of texels cancel and the whole disc is exact.
pub(super) fn of_rectangle_in_disc(
    disc: &impl Disc,
    [x0, x1]: [f64; 2],
    [y0, y1]: [f64; 2],
) -> f64 {
    let corners = [(x0, y0), (x1, y0), (x1, y1), (x0, y1)].map(DVec2::from);
    if corners.iter().all(|p| p.length_squared() <= 1.0) {
        let sides = (0..4).map(|i| along(disc, corners[i], corners[(i + 1) % 4]));
        return sides.sum();
    }
    let sides = (0..4).filter_map(|i| in_unit_disc(corners[i], corners[(i + 1) % 4]));
    let sides: Vec<(DVec2, DVec2)> = sides.collect();
    let rim = disc.cap_by_square(1.0);
    if sides.is_empty() {
        let covers = x0 < 0.0 && x1 > 0.0 && y0 < 0.0 && y1 > 0.0;
        return if covers { rim * TAU } else { 0.0 };
    }
    let mut sum = 0.0;
    for (i, &(a, b)) in sides.iter().enumerate() {
        let (next, _) = sides[(i + 1) % sides.len()];
        sum += along(disc, a, b) + rim * arc(b, next);
    }
    sum
}

/// Angle of the way along the unit circle from one point to another, 0 if they are the same.
fn arc(from: DVec2, to: DVec2) -> f64 {
    if from.distance_squared(to) < 1e-24 {
        return 0.0;
    }
    from.angle_to(to).rem_euclid(TAU)
}

/// The part of a line that lies in the unit disc.
fn in_unit_disc(a: DVec2, b: DVec2) -> Option<(DVec2, DVec2)> {
    let d = b - a;
    let (square, half, rest) = (d.length_squared(), a.dot(d), a.length_squared() - 1.0);
    let root = half * half - square * rest;
    if root <= 0.0 {
        return None;
    }
    let (first, last) = (
        (-half - root.sqrt()) / square,
        (-half + root.sqrt()) / square,
    );
    let (first, last) = (first.max(0.0), last.min(1.0));
    (first < last).then(|| (a + first * d, a + last * d))
}

/// Points and weights of Gauss and Legendre on [0, 1], of degree 11.
const GAUSS: [(f64, f64); 6] = [
    (0.033_765_242_898_423_99, 0.085_662_246_189_585_17),
    (0.169_395_306_766_867_74, 0.180_380_786_524_069_3),
    (0.380_690_406_958_401_56, 0.233_956_967_286_345_52),
    (0.619_309_593_041_598_5, 0.233_956_967_286_345_52),
    (0.830_604_693_233_132_3, 0.180_380_786_524_069_3),
    (0.966_234_757_101_576, 0.085_662_246_189_585_17),
];

/// The integral along a straight piece; long ones, of maps of a few texels, are cut.
fn along(disc: &impl Disc, a: DVec2, b: DVec2) -> f64 {
    let turn = a.perp_dot(b);
    let length = a.distance(b);
    if length > 0.25 {
        let middle = a.midpoint(b);
        return along(disc, a, middle) + along(disc, middle, b);
    }
    let values =
        GAUSS.map(|(share, weight)| weight * disc.cap_by_square(a.lerp(b, share).length()));
    turn * values.iter().sum::<f64>()
}
