//! Unoccluded form factors of polygons in f64.
//!
//! From a point the factor is Lambert's contour sum (Lambert 1760; Nishita, Nakamae 1985), exact. Between areas the
//! point factor is averaged over the receiver by Gauss quadrature where that is good to about 1e-5 of the factor, and
//! for close or touching pairs Stokes' double contour integral (Sparrow 1963) is used, its inner integral in closed
//! form.

use core::f64::consts::PI;
use glam::{DVec3, Vec3};

/// A planar convex polygon of a few corners with its unit normal, in f64.
#[derive(Debug, Clone, Copy)]
pub struct FlatPolygon {
    corners: [DVec3; MAX_CORNERS],
    count: usize,
    /// Unit normal of the side that radiates or receives.
    pub normal: DVec3,
}

/// A quad clipped by one plane has five corners.
const MAX_CORNERS: usize = 6;

impl FlatPolygon {
    /// A polygon of three or four corners, counter-clockwise around `normal`.
    pub fn new(corners: &[Vec3], normal: Vec3) -> Self {
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

    /// Heights of the corners over a plane: smallest and largest.
    fn heights(&self, origin: DVec3, normal: DVec3) -> (f64, f64) {
        self.corners()
            .iter()
            .map(|&c| (c - origin).dot(normal))
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), h| {
                (low.min(h), high.max(h))
            })
    }

    /// Radius around the centre that holds all corners.
    fn radius(&self, centre: DVec3) -> f64 {
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
fn contour_sum(corners: &[DVec3], normal: DVec3) -> f64 {
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

/// `A_a F_ab = A_b F_ba` of two polygons that see each other without obstruction; 0 where neither faces the other.
///
/// Parts behind the other's plane are clipped away. Relative error about 1e-4 or better, see the tests.
pub fn exchange_area(a: &FlatPolygon, b: &FlatPolygon) -> f64 {
    let (a_low, a_high) = a.heights(b.corners[0], b.normal);
    let (b_low, b_high) = b.heights(a.corners[0], a.normal);
    if a_high <= 0.0 || b_high <= 0.0 {
        return 0.0;
    }
    let tolerance = 1e-9 * (a_high + b_high);
    let a_part = if a_low < -tolerance {
        a.clipped(b.corners[0], b.normal)
    } else {
        *a
    };
    let b_part = if b_low < -tolerance {
        b.clipped(a.corners[0], a.normal)
    } else {
        *b
    };
    if a_part.count < 3 || b_part.count < 3 {
        return 0.0;
    }
    let (ca, cb) = (a_part.centre(), b_part.centre());
    let (ra, rb) = (a_part.radius(ca), b_part.radius(cb));
    let distance = ca.distance(cb);
    // The quadrature runs over the smaller polygon; the other is exact at each of its points.
    let (receiver, source, size) = if ra <= rb {
        (&a_part, &b_part, ra)
    } else {
        (&b_part, &a_part, rb)
    };
    let gap = (distance - ra.max(rb)).max(0.0);
    let exchange = if gap > 40.0 * size {
        receiver.area() * point_to_polygon(receiver.centre(), receiver.normal, source)
    } else if gap > 4.0 * size {
        averaged(receiver, source, &GAUSS_2)
    } else if gap > 1.2 * size {
        averaged(receiver, source, &GAUSS_4)
    } else {
        contour(&a_part, &b_part)
    };
    exchange.clamp(0.0, a_part.area().min(b_part.area()))
}

/// Nodes in [0, 1] and weights of Gauss-Legendre quadrature.
const GAUSS_2: [(f64, f64); 2] = [
    (0.211_324_865_405_187_1, 0.5),
    (0.788_675_134_594_812_9, 0.5),
];
const GAUSS_4: [(f64, f64); 4] = [
    (0.069_431_844_202_973_71, 0.173_927_422_568_726_93),
    (0.330_009_478_207_571_87, 0.326_072_577_431_273_07),
    (0.669_990_521_792_428_1, 0.326_072_577_431_273_07),
    (0.930_568_155_797_026_3, 0.173_927_422_568_726_93),
];
const GAUSS_8: [(f64, f64); 8] = [
    (0.019_855_071_751_231_86, 0.050_614_268_145_188_13),
    (0.101_666_761_293_186_6, 0.111_190_517_226_687_24),
    (0.237_233_795_041_835_5, 0.156_853_322_938_943_64),
    (0.408_282_678_752_175_1, 0.181_341_891_689_181),
    (0.591_717_321_247_825, 0.181_341_891_689_181),
    (0.762_766_204_958_164_5, 0.156_853_322_938_943_64),
    (0.898_333_238_706_813_4, 0.111_190_517_226_687_24),
    (0.980_144_928_248_768_1, 0.050_614_268_145_188_13),
];

/// `∫ F_{x,source} dA` over the receiver by a product rule; polygons are taken as a fan of (degenerate) quads.
fn averaged(receiver: &FlatPolygon, source: &FlatPolygon, rule: &[(f64, f64)]) -> f64 {
    let corners = receiver.corners();
    let mut sum = 0.0;
    let mut first = 1;
    while first + 1 < corners.len() {
        let (a, b, c) = (corners[0], corners[first], corners[first + 1]);
        let d = corners.get(first + 2).copied();
        // With a fourth corner the bilinear patch a b c d; otherwise the triangle as one whose last two corners meet.
        let last = d.unwrap_or(a);
        for &(u, wu) in rule {
            for &(v, wv) in rule {
                let x = a * ((1.0 - u) * (1.0 - v))
                    + b * (u * (1.0 - v))
                    + c * (u * v)
                    + last * ((1.0 - u) * v);
                let along_u = (b - a) * (1.0 - v) + (c - last) * v;
                let along_v = (last - a) * (1.0 - u) + (c - b) * u;
                let jacobian = along_u.cross(along_v).length();
                sum += wu * wv * jacobian * point_to_polygon(x, receiver.normal, source);
            }
        }
        first += if d.is_some() { 2 } else { 1 };
    }
    sum
}

/// `A_a F_ab = 1/2π ∮∮ ln r dx·dy` (Sparrow 1963), the inner integral in closed form, the outer by Gauss quadrature
/// after a substitution that flattens the logarithms at the ends of an edge.
fn contour(a: &FlatPolygon, b: &FlatPolygon) -> f64 {
    let mut sum = 0.0;
    for i in 0..a.count {
        let (p, q) = (a.corners[i], a.corners[(i + 1) % a.count]);
        let length = p.distance(q);
        if length == 0.0 {
            continue;
        }
        let direction = (q - p) / length;
        for j in 0..b.count {
            let (r, s) = (b.corners[j], b.corners[(j + 1) % b.count]);
            let cosine = direction.dot(s - r);
            if cosine.abs() <= 1e-14 * length {
                continue;
            }
            let other = r.distance(s);
            sum += cosine / other * outer_integral(p, q, length, r, (s - r) / other, other);
        }
    }
    (sum / (2.0 * PI)).abs()
}

/// `∫ ∫ ln|x - y| dy dx` over two edges; halved in the middle, each half with smoothed ends.
fn outer_integral(
    p: DVec3,
    q: DVec3,
    length: f64,
    start: DVec3,
    direction: DVec3,
    other: f64,
) -> f64 {
    let mut sum = 0.0;
    for half in 0..2 {
        for &(t, weight) in &GAUSS_8 {
            // t -> t² (3 - 2t) on each half puts the nodes where ln bends.
            let smooth = t * t * (3.0 - 2.0 * t);
            let derivative = 6.0 * t * (1.0 - t);
            let along = 0.5 * (f64::from(half) + smooth);
            let x = p + (q - p) * along;
            sum += 0.5 * weight * derivative * length * log_integral(x, start, direction, other);
        }
    }
    sum
}

/// `∫_0^L ln|x - (start + t direction)| dt` in closed form.
fn log_integral(x: DVec3, start: DVec3, direction: DVec3, length: f64) -> f64 {
    let offset = start - x;
    let low = offset.dot(direction);
    let high = low + length;
    let height2 = (offset.length_squared() - low * low).max(0.0);
    let height = height2.sqrt();
    let antiderivative = |t: f64| {
        let r2 = t * t + height2;
        let log = if r2 > 0.0 { 0.5 * t * r2.ln() } else { 0.0 };
        let angle = if height > 0.0 {
            height * (t / height).atan()
        } else {
            0.0
        };
        log - t + angle
    };
    antiderivative(high) - antiderivative(low)
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
    fn parallel_unit_squares() {
        let a = square(Vec3::ZERO, Vec3::X, Vec3::Y);
        let b = square(Vec3::Z, Vec3::Y, Vec3::X);
        let exact = 0.199_824_895_698_387_3;
        assert!(
            (exchange_area(&a, &b) - exact).abs() < 1e-9,
            "{} is not {exact}",
            exchange_area(&a, &b)
        );
    }

    #[test]
    fn perpendicular_unit_squares_with_a_common_edge() {
        let a = square(Vec3::ZERO, Vec3::X, Vec3::Y);
        let b = square(Vec3::ZERO, Vec3::Z, Vec3::X);
        let exact = 0.200_043_776_075_403_3;
        let found = exchange_area(
            &a,
            &FlatPolygon {
                normal: DVec3::Y,
                ..b
            },
        );
        assert!((found - exact).abs() < 1e-6, "{found} is not {exact}");
    }

    #[test]
    fn quadratures_agree_with_the_contour_integral() {
        for (shift, bound) in [
            (1.3, 1e-4),
            (2.0, 3e-5),
            (5.0, 3e-5),
            (12.0, 2e-5),
            (40.0, 2e-4),
        ] {
            let a = square(Vec3::ZERO, Vec3::X, Vec3::Y);
            let b = square(
                Vec3::new(shift * 0.6, 0.3, shift * 0.8),
                Vec3::new(0.1, 0.9, 0.0),
                Vec3::new(1.0, 0.0, 0.2),
            );
            let (by_rule, exact) = (exchange_area(&a, &b), contour(&a, &b));
            let relative = (by_rule - exact).abs() / exact;
            assert!(
                relative < bound,
                "distance {shift}: {by_rule} against {exact}, relative error {relative}"
            );
        }
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
