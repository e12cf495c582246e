//! Convex polygons of a few corners in f64, and the exact form factor of a point to one.
//!
//! From a point the factor is Lambert's contour sum (Lambert 1760; Nishita, Nakamae 1985). Factors between areas are in
//! [`analytic`](super::analytic).

use crate::form_factor::analytic::vector_area;
use core::f64::consts::PI;
use glam::{DVec3, Vec3};

/// A planar convex polygon of a few corners with its unit normal, in f64.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FlatPolygon {
    corners: [DVec3; MAX_CORNERS],
    count: usize,
    /// Unit normal of the side that radiates or receives.
    pub normal: DVec3,
}

/// A quad clipped by one plane has five corners.
const MAX_CORNERS: usize = 6;

impl FlatPolygon {
    /// A polygon of three or four corners, counter-clockwise around `normal`. Panics on any other number.
    pub fn new(corners: &[Vec3], normal: Vec3) -> Self {
        assert!(
            (3..=4).contains(&corners.len()),
            "a polygon of {} corners",
            corners.len()
        );
        let mut polygon = Self {
            corners: [DVec3::ZERO; MAX_CORNERS],
            count: corners.len(),
            normal: normal.as_dvec3(),
        };
        for (to, from) in polygon.corners.iter_mut().zip(corners) {
            *to = from.as_dvec3();
        }
        polygon
    }

    /// A polygon of three to six corners, its normal taken from them (Newell). Panics on any other number.
    pub fn from_corners(corners: &[DVec3]) -> Self {
        assert!(
            (3..=MAX_CORNERS).contains(&corners.len()),
            "a polygon of {} corners",
            corners.len()
        );
        let mut polygon = Self {
            corners: [DVec3::ZERO; MAX_CORNERS],
            count: corners.len(),
            normal: vector_area(corners).normalize_or_zero(),
        };
        polygon.corners[..corners.len()].copy_from_slice(corners);
        polygon
    }

    /// Its corners.
    pub fn corners(&self) -> &[DVec3] {
        &self.corners[..self.count]
    }

    /// Mean of the corners.
    pub fn centre(&self) -> DVec3 {
        self.corners().iter().sum::<DVec3>() / self.count as f64
    }

    /// Area.
    pub fn area(&self) -> f64 {
        let origin = self.corners[0];
        let doubled: DVec3 = self
            .corners()
            .windows(2)
            .map(|p| (p[0] - origin).cross(p[1] - origin))
            .sum();
        0.5 * doubled.length()
    }

    /// The part in front of a plane through `origin` (Sutherland, Hodgman 1974).
    fn clipped(&self, origin: DVec3, normal: DVec3) -> Self {
        let mut out = Self { count: 0, ..*self };
        let height = |p: DVec3| (p - origin).dot(normal);
        for i in 0..self.count {
            let (a, b) = (self.corners[i], self.corners[(i + 1) % self.count]);
            let (ha, hb) = (height(a), height(b));
            if ha >= 0.0 {
                out.push(a);
            }
            if (ha > 0.0 && hb < 0.0) || (ha < 0.0 && hb > 0.0) {
                out.push(a + (b - a) * (ha / (ha - hb)));
            }
        }
        if out.count < 3 {
            Self { count: 0, ..out }
        } else {
            out
        }
    }

    fn push(&mut self, corner: DVec3) {
        if self.count < MAX_CORNERS {
            self.corners[self.count] = corner;
            self.count += 1;
        }
    }

    /// Area-uniform point for one of the unit square.
    pub fn point(&self, [u, v]: [f32; 2]) -> DVec3 {
        let origin = self.corners[0];
        let doubled = |i: usize| {
            (self.corners[i] - origin)
                .cross(self.corners[i + 1] - origin)
                .length()
        };
        let total: f64 = (1..self.count - 1).map(doubled).sum();
        let mut wanted = f64::from(u) * total;
        let mut i = 1;
        while i + 2 < self.count && wanted > doubled(i) {
            wanted -= doubled(i);
            i += 1;
        }
        let root = (wanted / doubled(i).max(1e-300)).clamp(0.0, 1.0).sqrt();
        let (b, c) = (self.corners[i], self.corners[i + 1]);
        origin + (b - origin) * (root * (1.0 - f64::from(v))) + (c - origin) * (root * f64::from(v))
    }

    /// The part above the horizon of a point with a normal; `None` if nothing is.
    pub fn above_horizon(&self, point: DVec3, normal: DVec3) -> Option<Self> {
        let part = self.clipped(point, normal);
        (part.count >= 3).then_some(part)
    }

    /// Heights of the corners over a plane: smallest and largest.
    fn heights(&self, origin: DVec3, normal: DVec3) -> (f64, f64) {
        self.corners()
            .iter()
            .map(|&c| (c - origin).dot(normal))
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), h| {
                (low.min(h), high.max(h))
            })
    }

    /// Cut from its first corner into quads and, where corners are odd, a triangle: corners and their number.
    pub(crate) fn pieces(&self) -> impl Iterator<Item = ([DVec3; 4], usize)> + '_ {
        (1..self.count.saturating_sub(1)).step_by(2).map(|first| {
            let last = (first + 2).min(self.count - 1);
            let mut piece = [self.corners[0]; 4];
            piece[1..=last - first + 1].copy_from_slice(&self.corners[first..=last]);
            (piece, last - first + 2)
        })
    }

    /// Distance from a point to the polygon; it has to be convex.
    pub(crate) fn distance(&self, point: DVec3) -> f64 {
        let mut is_over = true;
        let mut nearest2 = f64::INFINITY;
        for (i, &a) in self.corners().iter().enumerate() {
            let edge = self.corners[(i + 1) % self.count] - a;
            let offset = point - a;
            is_over &= edge.cross(offset).dot(self.normal) >= 0.0;
            let along = (offset.dot(edge) / edge.length_squared().max(1e-300)).clamp(0.0, 1.0);
            nearest2 = nearest2.min((offset - edge * along).length_squared());
        }
        if is_over {
            (point - self.corners[0]).dot(self.normal).abs()
        } else {
            nearest2.sqrt()
        }
    }

    /// Radius around the centre that holds all corners.
    pub(crate) fn radius(&self, centre: DVec3) -> f64 {
        self.corners()
            .iter()
            .map(|c| c.distance_squared(centre))
            .fold(0.0, f64::max)
            .sqrt()
    }
}

/// Form factor from a differential element at `point` with unit `normal` to the front of a polygon, in [0, 1]:
/// `F = 1/2π Σ θ_i n·Γ_i` over the edges of the part above the horizon.
pub fn point_to_polygon(point: DVec3, normal: DVec3, polygon: &FlatPolygon) -> f64 {
    if (point - polygon.corners[0]).dot(polygon.normal) <= 0.0 {
        return 0.0;
    }
    let mut local = [DVec3::ZERO; MAX_CORNERS];
    let mut lowest = f64::INFINITY;
    let mut highest = f64::NEG_INFINITY;
    for (to, corner) in local.iter_mut().zip(polygon.corners()) {
        *to = *corner - point;
        let height = to.dot(normal);
        lowest = lowest.min(height);
        highest = highest.max(height);
    }
    if highest <= 0.0 {
        return 0.0;
    }
    let clipped;
    let corners = if lowest < 0.0 {
        let whole = FlatPolygon {
            corners: local,
            ..*polygon
        };
        clipped = whole.clipped(DVec3::ZERO, normal);
        clipped.corners()
    } else {
        &local[..polygon.count]
    };
    (-contour_sum(corners, normal) / (2.0 * PI)).clamp(0.0, 1.0)
}

/// `Σ θ_i n·Γ_i` over the edges of a polygon around the origin: negative for one that faces the origin, since from its
/// front a polygon runs clockwise around the direction towards it.
pub(crate) fn contour_sum(corners: &[DVec3], normal: DVec3) -> f64 {
    let mut sum = 0.0;
    let mut a = corners[corners.len() - 1];
    let mut a_length = a.length();
    for &b in corners {
        let b_length = b.length();
        let scale = a_length * b_length;
        // An edge through the origin subtends no angle that counts: its plane holds the point.
        if scale > 1e-300 {
            sum += angle_over_sine(a.dot(b) / scale, || a.cross(b).length() / scale)
                * a.cross(b).dot(normal)
                / scale;
        }
        (a, a_length) = (b, b_length);
    }
    sum
}

/// `θ / sin θ` for the cosine of an angle and, where that is not enough, its sine.
///
/// Small angles, which are most, take the series of `arccos(1 - x) / √(1 - (1 - x)²)`:
/// `Σ 2^k k!² / (2k + 1)! x^k`, cut after `x^8`: relative error below 3e-12 for `x < 0.1`.
fn angle_over_sine(cosine: f64, sine: impl FnOnce() -> f64) -> f64 {
    let x = 1.0 - cosine;
    if x < 0.1 {
        const SERIES: [f64; 9] = [
            1.0,
            1.0 / 3.0,
            2.0 / 15.0,
            2.0 / 35.0,
            8.0 / 315.0,
            8.0 / 693.0,
            16.0 / 3003.0,
            16.0 / 6435.0,
            128.0 / 109_395.0,
        ];
        return SERIES.iter().rev().fold(0.0, |sum, c| sum * x + c);
    }
    let sine = sine();
    if sine <= 1e-150 {
        0.0
    } else {
        sine.atan2(cosine) / sine
    }
}

/// The parts of two polygons that are in front of each other's plane; `None` if there are none.
pub fn facing_parts(a: &FlatPolygon, b: &FlatPolygon) -> Option<(FlatPolygon, FlatPolygon)> {
    let (a_low, a_high) = a.heights(b.corners[0], b.normal);
    let (b_low, b_high) = b.heights(a.corners[0], a.normal);
    if a_high <= 0.0 || b_high <= 0.0 {
        return None;
    }
    let tolerance = 1e-9 * (a_high + b_high);
    let in_front = |polygon: &FlatPolygon, low: f64, of: &FlatPolygon| {
        if low < -tolerance {
            polygon.clipped(of.corners[0], of.normal)
        } else {
            *polygon
        }
    };
    let (a_part, b_part) = (in_front(a, a_low, b), in_front(b, b_low, a));
    (a_part.count >= 3 && b_part.count >= 3).then_some((a_part, b_part))
}

/// Nodes in [0, 1] and weights of Gauss-Legendre quadrature.
pub(crate) const GAUSS_4: [(f64, f64); 4] = [
    (0.069_431_844_202_973_71, 0.173_927_422_568_726_93),
    (0.330_009_478_207_571_87, 0.326_072_577_431_273_07),
    (0.669_990_521_792_428_1, 0.326_072_577_431_273_07),
    (0.930_568_155_797_026_3, 0.173_927_422_568_726_93),
];
pub(crate) const GAUSS_8: [(f64, f64); 8] = [
    (0.019_855_071_751_231_86, 0.050_614_268_145_188_13),
    (0.101_666_761_293_186_6, 0.111_190_517_226_687_24),
    (0.237_233_795_041_835_5, 0.156_853_322_938_943_64),
    (0.408_282_678_752_175_1, 0.181_341_891_689_181),
    (0.591_717_321_247_825, 0.181_341_891_689_181),
    (0.762_766_204_958_164_5, 0.156_853_322_938_943_64),
    (0.898_333_238_706_813_4, 0.111_190_517_226_687_24),
    (0.980_144_928_248_768_1, 0.050_614_268_145_188_13),
];

/// The part of a polygon inside a convex one in its plane, both counter-clockwise about `normal` (Sutherland and Hodgman,
/// *Reentrant polygon clipping*, CACM 1974). Empty, or of no area, where they have nothing in common.
pub fn common_part(polygon: &[DVec3], inside: &[DVec3], normal: DVec3) -> Vec<DVec3> {
    let mut part = polygon.to_vec();
    for (i, &a) in inside.iter().enumerate() {
        let edge = inside[(i + 1) % inside.len()] - a;
        let height = |p: DVec3| edge.cross(p - a).dot(normal);
        let before = core::mem::take(&mut part);
        for (k, &p) in before.iter().enumerate() {
            let next = before[(k + 1) % before.len()];
            let (here, there) = (height(p), height(next));
            if here >= 0.0 {
                part.push(p);
            }
            if here * there < 0.0 {
                part.push(p.lerp(next, here / (here - there)));
            }
        }
    }
    part
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(origin: Vec3, u: Vec3, v: Vec3) -> FlatPolygon {
        FlatPolygon::new(
            &[origin, origin + u, origin + u + v, origin + v],
            u.cross(v).normalize(),
        )
    }

    #[test]
    fn a_point_in_a_box_sees_all_of_it() {
        let corner = Vec3::splat(-1.0);
        let (x, y, z) = (Vec3::X * 2.0, Vec3::Y * 2.0, Vec3::Z * 2.0);
        let walls = [
            square(corner, y, z),
            square(corner, z, x),
            square(corner, x, y),
            square(-corner, -z, -y),
            square(-corner, -x, -z),
            square(-corner, -y, -x),
        ];
        let normal = DVec3::new(0.3, 0.8, -0.4).normalize();
        let sum: f64 = walls
            .iter()
            .map(|w| point_to_polygon(DVec3::new(0.2, -0.5, 0.7), normal, w))
            .sum();
        assert!(
            (sum - 1.0).abs() < 1e-12,
            "factors from a point inside a box sum to {sum}"
        );
    }
}
