//! Unoccluded form factors of polygons in f64.
//!
//! From a point the factor is Lambert's contour sum (Lambert 1760; Nishita, Nakamae 1985), exact. Between areas the
//! point factor is averaged over the receiver by Gauss quadrature where that is good to about 1e-5 of the factor, and
//! for close or touching pairs Stokes' double contour integral (Sparrow 1963) is used, its inner integral in closed
//! form.

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

/// `A_a F_ab = A_b F_ba` of two polygons that see each other without obstruction; 0 where neither faces the other.
///
/// Parts behind the other's plane are clipped away. Relative error below 1e-4 for pairs apart, below 1e-3 for pairs that
/// share (a part of) an edge at up to 170° or stand beside each other with a gap; see the tests.
pub fn exchange_area(a: &FlatPolygon, b: &FlatPolygon) -> f64 {
    facing_parts(a, b).map_or(0.0, |(a_part, b_part)| exchange_of_parts(&a_part, &b_part))
}

/// [`exchange_area`] of two polygons that are wholly in front of each other's plane.
pub fn exchange_of_parts(a_part: &FlatPolygon, b_part: &FlatPolygon) -> f64 {
    let (ca, cb) = (a_part.centre(), b_part.centre());
    let (ra, rb) = (a_part.radius(ca), b_part.radius(cb));
    let distance = ca.distance(cb);
    // The quadrature runs over the smaller polygon; the other is exact at each of its points.
    let (receiver, source, size) = if ra <= rb {
        (a_part, b_part, ra)
    } else {
        (b_part, a_part, rb)
    };
    let gap = (distance - ra.max(rb)).max(0.0);
    let exchange = if gap > 40.0 * size {
        receiver.area() * point_to_polygon(receiver.centre(), receiver.normal, source)
    } else if gap > 4.0 * size {
        averaged(receiver, source, &GAUSS_2)
    } else if gap > 1.2 * size {
        averaged(receiver, source, &GAUSS_4)
    } else {
        contour(a_part, b_part)
    };
    exchange.clamp(0.0, a_part.area().min(b_part.area()))
}

/// Nodes in [0, 1] and weights of Gauss-Legendre quadrature.
pub(crate) const GAUSS_2: [(f64, f64); 2] = [
    (0.211_324_865_405_187_1, 0.5),
    (0.788_675_134_594_812_9, 0.5),
];
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

/// `∫ F_{x,source} dA` over the receiver by a product rule; polygons are taken as a fan of (degenerate) quads.
pub(crate) fn averaged(receiver: &FlatPolygon, source: &FlatPolygon, rule: &[(f64, f64)]) -> f64 {
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

/// `A_a F_ab = 1/2π ∮∮ ln r dx·dy` (Sparrow 1963), the inner integral in closed form, the outer by Gauss quadrature.
fn contour(a: &FlatPolygon, b: &FlatPolygon) -> f64 {
    let mut sum = 0.0;
    for i in 0..a.count {
        let one = Edge::new(a.corners[i], a.corners[(i + 1) % a.count]);
        for j in 0..b.count {
            let two = Edge::new(b.corners[j], b.corners[(j + 1) % b.count]);
            let cosine = one.direction.dot(two.direction);
            if cosine.abs() > 1e-14 && one.length > 0.0 && two.length > 0.0 {
                sum += cosine * edge_pair(&one, &two);
            }
        }
    }
    (sum / (2.0 * PI)).abs()
}

/// A directed edge.
#[derive(Clone, Copy)]
struct Edge {
    start: DVec3,
    direction: DVec3,
    length: f64,
}

impl Edge {
    fn new(start: DVec3, end: DVec3) -> Self {
        let length = start.distance(end);
        Self {
            start,
            direction: (end - start) / length.max(1e-300),
            length,
        }
    }
}

/// `∫ ∫ ln|x - y| dy dx` over two edges. The integrand of the outer integral bends where the inner edge ends, so the
/// outer one is the shorter, cut there, and a substitution flattens the logarithm at the ends of each piece.
fn edge_pair(a: &Edge, b: &Edge) -> f64 {
    let (outer, inner) = if a.length <= b.length { (a, b) } else { (b, a) };
    let along = |point: DVec3| {
        (point - outer.start)
            .dot(outer.direction)
            .clamp(0.0, outer.length)
    };
    let first = along(inner.start);
    let last = along(inner.start + inner.direction * inner.length);
    let middle = 0.5 * outer.length;
    let mut cuts = [0.0, first.min(last), first.max(last), middle, outer.length];
    cuts.sort_unstable_by(f64::total_cmp);
    let piece = |pair: &[f64]| {
        let (from, length) = (pair[0], pair[1] - pair[0]);
        if length <= 1e-12 * outer.length {
            return 0.0;
        }
        let nodes = GAUSS_8.iter().map(|&(t, weight)| {
            // t -> t² (3 - 2t) puts the nodes where ln bends.
            let (smooth, derivative) = (t * t * (3.0 - 2.0 * t), 6.0 * t * (1.0 - t));
            let x = outer.start + outer.direction * (from + smooth * length);
            weight * derivative * log_integral(x, inner.start, inner.direction, inner.length)
        });
        length * nodes.sum::<f64>()
    };
    cuts.windows(2).map(piece).sum()
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

    /// `∫ F_{x,source} dA` over a parallelogram by adaptive quadrature of the exact point factor.
    fn oracle(receiver: &FlatPolygon, source: &FlatPolygon) -> f64 {
        let [origin, b, _, d] = *receiver.corners() else {
            panic!("a parallelogram")
        };
        let cell = Cell {
            origin,
            u: b - origin,
            v: d - origin,
        };
        let estimate = cell.integral(receiver.normal, source);
        cell.refined(
            receiver.normal,
            source,
            estimate,
            1e-7 * estimate.max(1e-9),
            12,
        )
    }

    #[derive(Clone, Copy)]
    struct Cell {
        origin: DVec3,
        u: DVec3,
        v: DVec3,
    }

    impl Cell {
        fn integral(self, normal: DVec3, source: &FlatPolygon) -> f64 {
            let mut sum = 0.0;
            for &(s, ws) in &GAUSS_4 {
                for &(t, wt) in &GAUSS_4 {
                    sum += ws
                        * wt
                        * point_to_polygon(self.origin + self.u * s + self.v * t, normal, source);
                }
            }
            sum * self.u.cross(self.v).length()
        }

        fn refined(
            self,
            normal: DVec3,
            source: &FlatPolygon,
            whole: f64,
            tolerance: f64,
            depth: u32,
        ) -> f64 {
            let (u, v) = (self.u * 0.5, self.v * 0.5);
            let parts = [DVec3::ZERO, u, v, u + v].map(|shift| Self {
                origin: self.origin + shift,
                u,
                v,
            });
            let values = parts.map(|part| part.integral(normal, source));
            let sum: f64 = values.iter().sum();
            if (sum - whole).abs() < tolerance || depth == 0 {
                return sum;
            }
            let refine = |(part, value): (Self, f64)| {
                part.refined(normal, source, value, tolerance * 0.5, depth - 1)
            };
            parts.into_iter().zip(values).map(refine).sum()
        }
    }

    #[track_caller]
    fn assert_as_the_oracle(a: &FlatPolygon, b: &FlatPolygon, bound: f64, what: &str) {
        let exact = oracle(b, a);
        for (order, found) in [("a, b", exchange_area(a, b)), ("b, a", exchange_area(b, a))] {
            let relative = (found - exact).abs() / exact;
            assert!(
                relative < bound,
                "{what}, {order}: {found} is not {exact}, relative error {relative:.1e}"
            );
        }
    }

    #[test]
    fn pairs_apart_agree_with_adaptive_integration() {
        for (shift, bound) in [
            (0.6, 1e-4),
            (1.3, 1e-4),
            (2.0, 1e-4),
            (5.0, 1e-4),
            (12.0, 1e-4),
            (40.0, 1e-4),
        ] {
            let a = square(Vec3::ZERO, Vec3::X, Vec3::Y);
            let origin = Vec3::new(shift * 0.6, 0.3, shift * 0.8);
            let b = square(origin, Vec3::new(0.1, 0.9, 0.0), Vec3::new(1.0, 0.0, 0.2));
            assert_as_the_oracle(&a, &b, bound, &format!("distance {shift}"));
        }
    }

    #[test]
    fn touching_pairs_agree_with_adaptive_integration() {
        let floor = square(Vec3::ZERO, Vec3::X * 3.0, Vec3::Y * 3.0);
        for (angle, bound) in [(10.0_f32, 1e-4), (90.0, 1e-4), (135.0, 1e-4), (170.0, 1e-3)] {
            let (sine, cosine) = angle.to_radians().sin_cos();
            let up = Vec3::new(0.0, cosine, sine);
            // A whole corner of the edge, its middle, and a part that reaches beyond it.
            for start in [0.0, 1.0, 2.5] {
                let wall = square(Vec3::X * start, up, Vec3::X);
                assert_as_the_oracle(&floor, &wall, bound, &format!("{angle}° at {start}"));
            }
        }
    }

    #[test]
    fn pairs_with_a_small_gap_agree_with_adaptive_integration() {
        let floor = square(Vec3::ZERO, Vec3::X * 3.0, Vec3::Y * 3.0);
        for gap in [0.2, 0.05, 0.01] {
            for (place, bound) in [
                (Vec3::new(1.0, 1.0, gap), 1e-4),
                (Vec3::new(3.0, 1.0, gap), 1e-3),
            ] {
                let above = square(place, Vec3::Y, Vec3::X);
                assert_as_the_oracle(&floor, &above, bound, &format!("{place} above the floor"));
            }
        }
    }

    #[test]
    fn pairs_that_cross_the_horizon_agree_with_adaptive_integration() {
        let floor = square(Vec3::ZERO, Vec3::X, Vec3::Y);
        let wall = square(Vec3::new(1.5, 0.0, -0.9), Vec3::Z, Vec3::Y);
        // The oracle runs over the part of the wall that the floor sees; the rest adds nothing.
        assert_as_the_oracle(&floor, &wall, 1e-4, "a wall 90 % below");
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
