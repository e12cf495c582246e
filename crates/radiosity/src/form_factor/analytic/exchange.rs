//! Unoccluded form factors between polygons of any number of corners, convex or not, in f64 with error control.
//!
//! In principle one formula: `A_a F_ab = 1/2π ∮∮ ln r dx·dy` (Sparrow 1963) over the parts of the polygons that are in
//! front of each other's plane. [`polygon`](crate::form_factor::polygon) is the fast version for convex polygons of few corners. This one is
//! exact, and departs from the formula in three places:
//!
//! 1. The inner integral is in closed form; for parallel edges, collinear ones included, the outer one too, so that
//!    rectangles in a box need no quadrature. Other edges take adaptive Gauss-Kronrod quadrature, cut where edges
//!    come closest.
//! 2. Lengths are divided by the size of the pair: `ln r` of a closed contour does not feel a constant, rounding does.
//! 3. The sum is of the size of both perimeters, the result of the size of an area or less. Where that costs too many
//!    digits (tiny, far, nearly coplanar pairs), Lambert's exact factor of a point is integrated over the smaller
//!    polygon by adaptive cubature, and the one with the smaller error is kept.
//!
//! # Achieved error
//! [`Exchange::error`] estimates it for each pair, mostly some ten times too high. Against 38 pairs with known values
//! (touching at 1° to 170°, gaps of 1/1000, slivers, tiny and far ones with factors of 3e-9, clipped ones, not convex
//! ones) the form factor differs by at most 5e-15, in proportion to its value by at most 1e-11. Two cases keep fewer digits:
//! - A polygon of size l that touches one of size L: `1e-16 L/l` of the smaller area, estimated as ten times that.
//! - Pairs that share an edge and are bent by an angle φ from one plane: `1e-16 / φ²` of their (tiny) factor.
//!
//! A pair costs some 10 to 20 µs where edges are not parallel, and up to some ms where the cubature is tried in vain.

use crate::form_factor::nusselt;
use crate::form_factor::polygon::{GAUSS_4, GAUSS_8};
use core::f64::consts::PI;
use glam::DVec3;

/// `A_a F_ab` with an estimate of its error.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Exchange {
    /// `A_a F_ab = A_b F_ba`, square of the unit of length, at least 0.
    pub area: f64,
    /// Estimate of the absolute error, rounding included; in practice an upper bound.
    pub error: f64,
}

/// `A_a F_ab = A_b F_ba` of two simple planar polygons, counter-clockwise seen from the side that radiates.
///
/// Parts behind the other's plane add nothing; 0 where neither faces the other, or has no area.
///
/// ```
/// use glam::DVec3;
/// use hemicube_radiosity::form_factor::analytic::exchange_area;
///
/// let floor = [DVec3::ZERO, DVec3::X, DVec3::new(1.0, 1.0, 0.0), DVec3::Y];
/// let ceiling = [DVec3::Z, DVec3::new(0.0, 1.0, 1.0), DVec3::ONE, DVec3::new(1.0, 0.0, 1.0)];
/// assert!((exchange_area(&floor, &ceiling) - 0.199_824_895_698_387_3).abs() < 1e-14, "unit squares at distance 1");
/// ```
pub fn exchange_area(a: &[DVec3], b: &[DVec3]) -> f64 {
    exchange(a, b).area
}

/// `F_ab`, the share of what leaves `a` that arrives at `b` where nothing is between; 0 if `a` has no area.
pub fn form_factor(a: &[DVec3], b: &[DVec3]) -> f64 {
    let area = area(a);
    if area > 0.0 {
        (exchange_area(a, b) / area).clamp(0.0, 1.0)
    } else {
        0.0
    }
}

/// `F_ba` from `F_ab`: reciprocity `A_a F_ab = A_b F_ba`.
pub fn reciprocal(form_factor: f64, area_a: f64, area_b: f64) -> f64 {
    form_factor * area_a / area_b
}

/// Area of a planar polygon, not negative.
pub fn area(polygon: &[DVec3]) -> f64 {
    vector_area(polygon).length()
}

/// Area times unit normal of the counter-clockwise side (Newell); right for polygons that are not convex.
pub fn vector_area(polygon: &[DVec3]) -> DVec3 {
    let Some(&origin) = polygon.first() else {
        return DVec3::ZERO;
    };
    let doubled: DVec3 = polygon
        .windows(2)
        .map(|p| (p[0] - origin).cross(p[1] - origin))
        .sum();
    0.5 * doubled
}

/// The part of a polygon that is in front of a plane (Sutherland, Hodgman 1974); `tolerance` behind it counts as in it.
///
/// What is left of a polygon that is not convex may be several pieces, joined by bridges along the plane that run forth
/// and back: contour integrals and signed areas over it are right.
pub(crate) fn in_front(
    polygon: &[DVec3],
    origin: DVec3,
    normal: DVec3,
    tolerance: f64,
) -> Vec<DVec3> {
    let height = |p: DVec3| {
        let h = (p - origin).dot(normal);
        if h.abs() <= tolerance { 0.0 } else { h }
    };
    let mut part = Vec::with_capacity(polygon.len() + 2);
    for (i, &a) in polygon.iter().enumerate() {
        let b = polygon[(i + 1) % polygon.len()];
        let (ha, hb) = (height(a), height(b));
        if ha >= 0.0 {
            part.push(a);
        }
        if (ha > 0.0 && hb < 0.0) || (ha < 0.0 && hb > 0.0) {
            part.push(a + (b - a) * (ha / (ha - hb)));
        }
    }
    part
}

/// [`exchange_area`] with its error.
pub fn exchange(a: &[DVec3], b: &[DVec3]) -> Exchange {
    let Some(pair) = Pair::facing(a, b) else {
        return Exchange::default();
    };
    let (area_a, area_b) = (area(&pair.a), area(&pair.b));
    let limit = area_a.min(area_b);
    let mut best = contour(&pair.a, &pair.b);
    if best.error > FALLBACK_ABOVE * limit || best.error > FALLBACK_RELATIVE * best.area.abs() {
        let cubature = if area_a <= area_b {
            cubature(&pair.a, &pair.b)
        } else {
            cubature(&pair.b, &pair.a)
        };
        if cubature.error < best.error {
            best = cubature;
        }
    }
    let unit2 = pair.unit * pair.unit;
    Exchange {
        area: unit2 * best.area.clamp(0.0, limit),
        error: unit2 * best.error,
    }
}

/// The double contour is not trusted where its error is above this share of the smaller area.
const FALLBACK_ABOVE: f64 = 1e-11;
/// Nor where it is above this share of the result.
const FALLBACK_RELATIVE: f64 = 1e-9;

/// The parts of two polygons that face each other, moved to the first corner and divided by the size of the pair.
struct Pair {
    a: Vec<DVec3>,
    b: Vec<DVec3>,
    unit: f64,
}

impl Pair {
    fn facing(a: &[DVec3], b: &[DVec3]) -> Option<Self> {
        let origin = *a.first()?;
        let unit = a
            .iter()
            .chain(b)
            .map(|p| p.distance_squared(origin))
            .fold(0.0, f64::max)
            .sqrt();
        let local = |polygon: &[DVec3]| -> Vec<DVec3> {
            polygon.iter().map(|&p| (p - origin) / unit).collect()
        };
        let (a, b) = (local(a), local(b));
        let normal_a = vector_area(&a).try_normalize()?;
        let normal_b = vector_area(&b).try_normalize()?;
        // Corners of a common edge are in the plane of the other whatever rounding says.
        let part_a = in_front(&a, *b.first()?, normal_b, IN_PLANE);
        let part_b = in_front(&b, *a.first()?, normal_a, IN_PLANE);
        let reach = |part: &[DVec3], origin: DVec3, normal: DVec3| {
            part.iter().any(|p| (p - origin).dot(normal) > IN_PLANE)
        };
        (reach(&part_a, b[0], normal_b) && reach(&part_b, a[0], normal_a)).then_some(Self {
            a: part_a,
            b: part_b,
            unit,
        })
    }
}

/// Heights below this share of the size of the pair are rounding.
const IN_PLANE: f64 = 1e-14;

/// A number that is off by at most `error`, roughly.
#[derive(Clone, Copy, Default)]
struct Estimate {
    value: f64,
    error: f64,
}

/// `1/2π ∮∮ ln r dx·dy`
fn contour(a: &[DVec3], b: &[DVec3]) -> Exchange {
    let mut sum = Estimate::default();
    for one in edges(a) {
        for two in edges(b) {
            let cosine = one.direction.dot(two.direction);
            if cosine.abs() > 1e-16 {
                let pair = edge_pair(&one, &two);
                sum.value += cosine * pair.value;
                sum.error += cosine.abs() * pair.error;
            }
        }
    }
    Exchange {
        area: sum.value / (2.0 * PI),
        error: sum.error / (2.0 * PI),
    }
}

/// A directed edge.
#[derive(Clone, Copy)]
struct Edge {
    start: DVec3,
    direction: DVec3,
    length: f64,
}

/// The edges of a polygon that have a length.
fn edges(polygon: &[DVec3]) -> impl Iterator<Item = Edge> {
    polygon.iter().enumerate().filter_map(|(i, &start)| {
        let along = polygon[(i + 1) % polygon.len()] - start;
        let length = along.length();
        (length > 0.0).then(|| Edge {
            start,
            direction: along / length,
            length,
        })
    })
}

/// `∫∫ ln|x - y| dy dx` over two edges.
fn edge_pair(a: &Edge, b: &Edge) -> Estimate {
    // The integrand of the outer integral bends near the ends of the inner edge: the shorter is the outer one.
    let (outer, inner) = if a.length <= b.length { (a, b) } else { (b, a) };
    parallel(outer, inner).unwrap_or_else(|| integrated(outer, inner))
}

/// Closed form for parallel edges; `None` for others, and where it would lose more digits than quadrature.
///
/// With `G'' = ln √(t² + h²)` for the distance h of the two lines, the integral is the second difference of G.
fn parallel(outer: &Edge, inner: &Edge) -> Option<Estimate> {
    if outer.direction.cross(inner.direction).length_squared() > 1e-31 {
        return None;
    }
    let offset = inner.start - outer.start;
    let turned = inner.length.copysign(outer.direction.dot(inner.direction));
    let along = offset.dot(outer.direction);
    let low = along.min(along + turned);
    let high = low + inner.length;
    let height = offset.cross(outer.direction).length();
    let far = (low - outer.length).abs().max(high.abs()).max(height);
    if far * far > 30.0 * outer.length * inner.length {
        return None;
    }
    let second_integral = |t: f64| {
        let r2 = t * t + height * height;
        if r2 == 0.0 {
            return 0.0;
        }
        0.25 * (t * t - height * height) * r2.ln() - 0.75 * t * t + height * t * t.atan2(height)
    };
    let value = second_integral(high) - second_integral(high - outer.length) - second_integral(low)
        + second_integral(low - outer.length);
    Some(Estimate {
        value,
        error: 4.0 * f64::EPSILON * far * far,
    })
}

/// The outer integral by adaptive Gauss-Kronrod quadrature, from cuts where the integrand bends.
fn integrated(outer: &Edge, inner: &Edge) -> Estimate {
    let scale = outer.length * inner.length;
    let along = |point: DVec3| (point - outer.start).dot(outer.direction);
    let mut cuts = [
        0.0,
        along(inner.start),
        along(inner.start + inner.direction * inner.length),
        closest_approach(outer, inner),
        outer.length,
    ]
    .map(|cut| cut.clamp(0.0, outer.length));
    cuts.sort_unstable_by(f64::total_cmp);
    let mut open: Vec<(f64, f64)> = cuts.windows(2).map(|pair| (pair[0], pair[1])).collect();
    let mut sum = Estimate {
        value: 0.0,
        error: 2.0 * f64::EPSILON * scale,
    };
    while let Some((from, to)) = open.pop() {
        if to <= from {
            continue;
        }
        let piece = gauss_kronrod(from, to, |t| {
            log_integral(outer.start + outer.direction * t, inner)
        });
        if piece.error <= QUADRATURE * scale || to - from < 1e-14 * outer.length {
            sum.value += piece.value;
            sum.error += piece.error;
        } else {
            let middle = 0.5 * (from + to);
            open.push((middle, to));
            open.push((from, middle));
        }
    }
    sum
}

/// Accepted difference of Gauss and Kronrod rule per piece, as a share of the product of lengths.
const QUADRATURE: f64 = 2e-14;

/// Where on the line of `a` the line of `b` is closest; 0 for parallel lines.
fn closest_approach(a: &Edge, b: &Edge) -> f64 {
    let cosine = a.direction.dot(b.direction);
    let sine2 = a.direction.cross(b.direction).length_squared();
    if sine2 < 1e-20 {
        return 0.0;
    }
    let offset = b.start - a.start;
    (offset.dot(a.direction) - offset.dot(b.direction) * cosine) / sine2
}

/// `∫ ln|x - y| dy` over an edge, its error some ulps of the edge's length however far x is.
fn log_integral(x: DVec3, edge: &Edge) -> f64 {
    let offset = edge.start - x;
    let mut low = offset.dot(edge.direction);
    let height = offset.cross(edge.direction).length();
    let mut high = low + edge.length;
    // ln of the far end, so that an end at x does no harm; and ln(far / near) without cancellation.
    if low.abs() > high.abs() {
        (low, high) = (-high, -low);
    }
    let near2 = low * low + height * height;
    let far2 = high * high + height * height;
    let ratio = if near2 > 0.0 {
        0.5 * low * (edge.length * (low + high) / near2).ln_1p()
    } else {
        0.0
    };
    let angle = (height * edge.length).atan2(height * height + low * high);
    0.5 * edge.length * far2.ln() + ratio - edge.length + height * angle
}

/// Kronrod's 15 points with Gauss's 7 among them (Piessens et al. 1983): node in [0, 1], weight of Kronrod, of Gauss.
const KRONROD: [(f64, f64, f64); 8] = [
    (0.991_455_371_120_812_6, 0.022_935_322_010_529_224, 0.0),
    (
        0.949_107_912_342_758_5,
        0.063_092_092_629_978_56,
        0.129_484_966_168_869_7,
    ),
    (0.864_864_423_359_769_1, 0.104_790_010_322_250_19, 0.0),
    (
        0.741_531_185_599_394_4,
        0.140_653_259_715_525_92,
        0.279_705_391_489_276_64,
    ),
    (0.586_087_235_467_691_1, 0.169_004_726_639_267_9, 0.0),
    (
        0.405_845_151_377_397_2,
        0.190_350_578_064_785_4,
        0.381_830_050_505_118_9,
    ),
    (0.207_784_955_007_898_47, 0.204_432_940_075_298_9, 0.0),
    (0.0, 0.209_482_141_084_727_82, 0.417_959_183_673_469_4),
];

/// `∫ f` by Kronrod's rule; the error is its difference to Gauss's, which is larger than its own.
fn gauss_kronrod(from: f64, to: f64, f: impl Fn(f64) -> f64) -> Estimate {
    let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
    let (mut kronrod, mut gauss) = (0.0, 0.0);
    for (node, wk, wg) in KRONROD {
        let value = if node == 0.0 {
            f(middle)
        } else {
            f(middle - half * node) + f(middle + half * node)
        };
        kronrod += wk * value;
        gauss += wg * value;
    }
    Estimate {
        value: half * kronrod,
        error: half * (kronrod - gauss).abs(),
    }
}

/// `∫ F_{x,large} dA` over the smaller polygon: adaptive, the worst triangle is split first.
fn cubature(small: &[DVec3], large: &[DVec3]) -> Exchange {
    let normal = vector_area(small).normalize_or_zero();
    let factor = |x: DVec3| nusselt::contour_factor(x, normal, large);
    // A fan of signed triangles is right for any polygon, convex or not.
    let mut cells: Vec<Triangle> = (1..small.len() - 1)
        .map(|i| Triangle::new([small[0], small[i], small[i + 1]], normal, &factor))
        .collect();
    for _ in 0..MAX_SPLITS {
        let sum = total(&cells);
        let worst = (0..cells.len())
            .max_by(|&i, &j| cells[i].integral.error.total_cmp(&cells[j].integral.error));
        let Some(worst) = worst.filter(|_| sum.error > CUBATURE * sum.value.abs()) else {
            break;
        };
        let cell = cells.swap_remove(worst);
        cells.extend(cell.split(normal, &factor));
    }
    let sum = total(&cells);
    // Rounding of the point factor is that of its angles, not of their small sum.
    let angle = radius(large) / small[0].distance(large[0]).max(radius(large)).max(1e-300);
    Exchange {
        area: sum.value,
        error: sum.error + 4.0 * f64::EPSILON * angle * area(small),
    }
}

/// Error as a share of the value at which the cubature ends.
const CUBATURE: f64 = 1e-11;
/// Splits after which the cubature ends anyhow: 77,000 point factors.
const MAX_SPLITS: usize = 240;

fn radius(polygon: &[DVec3]) -> f64 {
    let squares = polygon.iter().map(|p| p.distance_squared(polygon[0]));
    squares.fold(0.0, f64::max).sqrt()
}

fn total(cells: &[Triangle]) -> Estimate {
    Estimate {
        value: cells.iter().map(|c| c.integral.value).sum(),
        error: cells.iter().map(|c| c.integral.error).sum(),
    }
}

/// A triangle of the cubature with the integral over it.
#[derive(Clone, Copy)]
struct Triangle {
    corners: [DVec3; 3],
    integral: Estimate,
}

impl Triangle {
    fn new(corners: [DVec3; 3], normal: DVec3, f: &impl Fn(DVec3) -> f64) -> Self {
        let [origin, b, c] = corners;
        let doubled = (b - origin).cross(c - origin).dot(normal);
        // The unit square, one side drawn together to the first corner.
        let rule = |rule: &[(f64, f64)]| -> f64 {
            let mut sum = 0.0;
            for &(u, wu) in rule {
                for &(v, wv) in rule {
                    let x = origin + ((b - origin) * (1.0 - v) + (c - origin) * v) * u;
                    sum += wu * wv * u * f(x);
                }
            }
            doubled * sum
        };
        let (coarse, value) = (rule(&GAUSS_4), rule(&GAUSS_8));
        // Twice the points square the error of a smooth integrand; QUADPACK's exponent is more careful.
        let scale = (0.5 * doubled.abs()).min(value.abs()).max(1e-300);
        let error = (200.0 * (value - coarse).abs() / scale).powf(1.5) * scale;
        Self {
            corners,
            integral: Estimate {
                value,
                error: error.min((value - coarse).abs()),
            },
        }
    }

    /// Four similar ones.
    fn split(self, normal: DVec3, f: &impl Fn(DVec3) -> f64) -> [Self; 4] {
        let [a, b, c] = self.corners;
        let (ab, bc, ca) = (a.midpoint(b), b.midpoint(c), c.midpoint(a));
        [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
            .map(|corners| Self::new(corners, normal, f))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rectangle(origin: DVec3, u: DVec3, v: DVec3) -> [DVec3; 4] {
        [origin, origin + u, origin + u + v, origin + v]
    }

    #[track_caller]
    fn assert_close(found: f64, exact: f64, bound: f64, what: &str) {
        assert!(
            (found - exact).abs() <= bound,
            "{what}: {found} is not {exact} within {bound}"
        );
    }

    #[test]
    fn kronrod_is_exact_for_polynomials() {
        let (power, wanted) = (22, 1.0 / 23.0);
        let found = gauss_kronrod(0.0, 1.0, |t| t.powi(power));
        assert_close(found.value, wanted, 1e-16, "x^22 needs all of Kronrod");
        assert!(
            gauss_kronrod(0.0, 1.0, |t| t.powi(13)).error < 1e-15,
            "x^13 is exact for Gauss"
        );
    }

    #[test]
    fn closed_form_and_quadrature_of_parallel_edges_agree() {
        let outer = Edge {
            start: DVec3::ZERO,
            direction: DVec3::X,
            length: 0.7,
        };
        for (start, direction) in [
            (DVec3::new(0.2, 0.3, 0.0), DVec3::X),
            (DVec3::new(0.9, 0.0, 0.5), -DVec3::X),
            (DVec3::new(0.7, 0.0, 0.0), DVec3::X),
            (DVec3::new(0.7, 0.0, 0.0), -DVec3::X),
            (DVec3::new(-0.4, 0.0, 0.0), DVec3::X),
        ] {
            let inner = Edge {
                start,
                direction,
                length: 0.8,
            };
            let closed = parallel(&outer, &inner).expect("they are parallel");
            let adaptive = integrated(&outer, &inner);
            assert_close(closed.value, adaptive.value, 1e-13, "parallel edges");
        }
    }

    #[test]
    fn contour_and_cubature_agree() {
        let floor = rectangle(DVec3::ZERO, DVec3::X, DVec3::Y);
        let tilted = rectangle(
            DVec3::new(0.4, 0.2, 1.1),
            DVec3::new(0.1, 0.9, 0.2),
            DVec3::new(1.0, 0.1, 0.3),
        );
        let by_contour = contour(&floor, &tilted);
        let by_cubature = cubature(&floor, &tilted);
        assert_close(
            by_contour.area,
            by_cubature.area,
            1e-12,
            "two ways to one factor",
        );
    }

    #[test]
    fn tiny_polygons_have_the_factor_of_a_point() {
        let ceiling = rectangle(DVec3::new(-1.0, -2.0, 1.5), DVec3::Y * 3.0, DVec3::X * 4.0);
        for size in [1e-2, 1e-4, 1e-6, 1e-8] {
            let tiny = rectangle(DVec3::ZERO, DVec3::X * size, DVec3::Y * size);
            let centre = DVec3::new(0.5 * size, 0.5 * size, 0.0);
            let point = nusselt::element_to_polygon(centre, DVec3::Z, &ceiling);
            // The mean over the element differs from its middle by the square of its size.
            assert_close(
                form_factor(&tiny, &ceiling),
                point,
                1e-12 + 0.1 * size * size,
                &format!("size {size}"),
            );
        }
    }

    #[test]
    fn far_pairs_keep_their_digits() {
        let near = rectangle(DVec3::ZERO, DVec3::X, DVec3::Y);
        for distance in [1e2, 1e4, 1e6] {
            let far = rectangle(DVec3::Z * distance, DVec3::Y, DVec3::X);
            // The mean of d²/π(d² + ρ²)², ρ the distance across, whose mean square is 1/3.
            let d2: f64 = distance * distance;
            let exact = (1.0 - 2.0 / (3.0 * d2)) / (PI * d2);
            let found = exchange_area(&near, &far);
            assert_close(
                found / exact,
                1.0,
                1e-8 + 2.0 / (d2 * d2),
                &format!("distance {distance}"),
            );
        }
    }

    #[test]
    fn a_polygon_is_the_sum_of_its_parts_although_clipping_cuts_it_in_two() {
        // A U that looks at the floor, its two arms above the floor's plane, its foot below.
        let p = |x: f64, z: f64| DVec3::new(x, 2.0, z);
        let u = [
            p(0.0, -1.5),
            p(3.0, -1.5),
            p(3.0, 1.0),
            p(2.0, 1.0),
            p(2.0, -1.0),
            p(1.0, -1.0),
            p(1.0, 1.0),
            p(0.0, 1.0),
        ];
        let floor = rectangle(DVec3::ZERO, DVec3::X * 3.0, DVec3::Y);
        let arms = [0.0, 2.0]
            .map(|x| exchange_area(&floor, &rectangle(p(x, -1.0), DVec3::X, DVec3::Z * 2.0)));
        assert!(arms[0] > 0.01, "the arms are seen: {arms:?}");
        let whole = exchange_area(&floor, &u);
        assert_close(
            whole,
            arms[0] + arms[1],
            1e-13,
            "a U that stands in the floor",
        );
    }

    /// Numbers in [0, 1) that are the same each time.
    struct Random(u64);

    impl Random {
        fn next(&mut self) -> f64 {
            self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005);
            self.0 = self.0.wrapping_add(1_442_695_040_888_963_407);
            (self.0 >> 11) as f64 / (1_u64 << 53) as f64
        }

        fn vector(&mut self) -> DVec3 {
            2.0 * DVec3::new(self.next(), self.next(), self.next()) - DVec3::ONE
        }

        /// A star around a centre, which is mostly not convex.
        fn star(&mut self, centre: DVec3) -> Vec<DVec3> {
            let normal = self.vector().normalize();
            let (x, y) = normal.any_orthonormal_pair();
            let corners = 7;
            let corner = |i| {
                let (sine, cosine) = (f64::from(i) * 2.0 * PI / f64::from(corners)).sin_cos();
                centre + (x * cosine + y * sine) * (0.2 + 0.8 * self.next())
            };
            (0..corners).map(corner).collect()
        }
    }

    /// Its triangles around the centre of a star.
    fn triangles(star: &[DVec3], centre: DVec3) -> Vec<[DVec3; 3]> {
        (0..star.len())
            .map(|i| [centre, star[i], star[(i + 1) % star.len()]])
            .collect()
    }

    #[test]
    fn stars_are_the_sum_of_their_triangles() {
        let mut random = Random(1);
        let mut seen = 0;
        for _ in 0..60 {
            // So close that most cross each other's plane, and some each other.
            let (centre_a, centre_b) = (random.vector(), random.vector());
            let (a, b) = (random.star(centre_a), random.star(centre_b));
            let whole = exchange(&a, &b);
            let mut sum = 0.0;
            for one in triangles(&a, centre_a) {
                for two in triangles(&b, centre_b) {
                    sum += exchange_area(&one, &two);
                }
            }
            seen += usize::from(whole.area > 0.0);
            assert_close(whole.area, sum, 1e-12, &format!("{a:?} and {b:?}"));
        }
        assert!(seen > 20, "only {seen} of 60 pairs see each other");
    }

    #[test]
    fn touching_pairs_of_any_angle_agree_with_cubature() {
        let floor = [
            DVec3::ZERO,
            DVec3::X * 2.0,
            DVec3::new(1.5, 1.3, 0.0),
            DVec3::new(0.2, 0.9, 0.0),
        ];
        for angle in [0.1_f64, 5.0, 45.0, 120.0, 179.0, 179.99] {
            let (sine, cosine) = angle.to_radians().sin_cos();
            let up = DVec3::new(0.0, cosine, sine);
            // A triangle that shares a part of the edge, its other sides parallel to nothing.
            let wall = [
                DVec3::X * 0.5,
                DVec3::X * 0.5 + DVec3::X * 0.3 + up * 0.7,
                DVec3::X * 1.7,
            ];
            let contour = exchange(&floor, &wall);
            let by_area = cubature(&wall, &floor);
            assert!(
                contour.error < 1e-12,
                "{angle} degrees: estimate {}",
                contour.error
            );
            // The point factor jumps along the common edge: the cubature says itself that it is the worse one.
            assert_close(
                contour.area,
                by_area.area,
                contour.error + 3.0 * by_area.error + 1e-7 * by_area.area,
                &format!("{angle} degrees"),
            );
        }
    }

    #[test]
    fn small_polygons_that_touch_large_ones_add_up() {
        let floor = rectangle(
            DVec3::ZERO,
            DVec3::X,
            DVec3::new(0.0, 3f64.sqrt() / 2.0, 0.5),
        );
        for size in [1e-1, 1e-2, 1e-3, 1e-4, 1e-5] {
            // A triangle on the edge, and the same in two halves.
            let foot = DVec3::X * 0.37;
            let top = foot + DVec3::new(0.3, -0.2, 1.0) * size;
            let [left, right] = [0.0, size].map(|x| foot + DVec3::X * x);
            let middle = 0.3 * left + 0.7 * right;
            let whole = exchange(&floor, &[left, top, right]);
            let halves = exchange_area(&floor, &[left, top, middle])
                + exchange_area(&floor, &[middle, top, right]);
            let share = |area: f64| area / (0.5 * size * size);
            assert_close(
                share(whole.area),
                share(halves),
                1e-13 / size + 1e-11,
                &format!("size {size}"),
            );
        }
    }

    #[test]
    fn nearly_coplanar_pairs_keep_digits() {
        let floor = [
            DVec3::ZERO,
            DVec3::X * 2.0,
            DVec3::new(1.5, 1.3, 0.0),
            DVec3::new(0.2, 0.9, 0.0),
        ];
        for bend in [1e-2_f64, 1e-3, 1e-4, 1e-5, 1e-6] {
            let up = DVec3::new(0.0, -bend.cos(), bend.sin());
            let leaf = [DVec3::X * 0.5, DVec3::X * 0.8 + up * 0.7, DVec3::X * 1.7];
            let found = exchange(&floor, &leaf);
            // Limit of A F over the square of the bend: the factor goes with it and its next term with the fourth power.
            let limit = 0.066_404_317_4;
            let relative = found.area / (bend * bend * limit) - 1.0;
            // Rounding of the contour is absolute: 2e-18 of the floor's square size.
            assert!(
                relative.abs() < 1e-9 + bend * bend + 1e-16 / (bend * bend),
                "bent by {bend}: relative error {relative:.1e}"
            );
            assert!(
                found.error < 1e-14,
                "bent by {bend}: estimate {:.1e}",
                found.error
            );
        }
    }

    #[test]
    fn factors_are_reciprocal_and_zero_from_behind() {
        let a = rectangle(DVec3::ZERO, DVec3::X, DVec3::Y * 2.0);
        let b = [
            DVec3::new(0.3, 0.2, 0.7),
            DVec3::new(0.1, 2.0, 1.0),
            DVec3::new(2.0, 0.4, 1.5),
        ];
        let (ab, ba) = (form_factor(&a, &b), form_factor(&b, &a));
        assert!(ab > 0.1, "they face each other: {ab}");
        assert_close(reciprocal(ab, area(&a), area(&b)), ba, 1e-14, "reciprocity");
        let back: Vec<DVec3> = b.iter().rev().copied().collect();
        assert_close(form_factor(&a, &back), 0.0, 0.0, "a turned polygon");
        assert_close(form_factor(&a, &a), 0.0, 0.0, "a plane polygon and itself");
        assert_close(form_factor(&a, &b[..2]), 0.0, 0.0, "two corners");
        assert_close(form_factor(&[], &b), 0.0, 0.0, "no corners");
    }
}
