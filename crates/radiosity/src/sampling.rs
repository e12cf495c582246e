//! Low-discrepancy and stratified points, on polygons and over the hemisphere.
//!
//! Sequences are additive recurrences with the generalised golden ratio (Roberts 2018: `α_k = φ_d^-k`), shifted modulo
//! 1 by a hash (Cranley, Patterson 1976). They need one multiplication a dimension and any prefix of them is even.

use core::f32::consts::PI;
use glam::Vec3;
use hemicube_raster::random::{GOLDEN, mix};

/// Inverse powers of the root of `x³ = x + 1`.
const R2: [f64; 2] = [0.754_877_666_246_692_8, 0.569_840_290_998_053_2];
/// Inverse powers of the root of `x⁵ = x + 1`.
const R4: [f64; 4] = [
    0.856_674_883_854_502_9,
    0.733_891_856_627_126,
    0.628_706_721_037_767_4,
    0.538_597_257_220_357_1,
];

/// Well-mixed 64 bits of two numbers.
pub fn hash(a: u64, b: u64) -> u64 {
    mix(a.wrapping_mul(GOLDEN).wrapping_add(b).wrapping_add(GOLDEN))
}

/// Point `index` of the two-dimensional sequence with the shift of `seed`, in [0, 1)².
pub fn point2(index: u32, seed: u64) -> [f32; 2] {
    let shift = hash(seed, 0);
    [
        fraction(f64::from(index) * R2[0], shift),
        fraction(f64::from(index) * R2[1], shift >> 32),
    ]
}

/// Point `index` of the four-dimensional sequence with the shift of `seed`, in [0, 1)⁴.
pub fn point4(index: u32, seed: u64) -> [f32; 4] {
    let (low, high) = (hash(seed, 0), hash(seed, 1));
    let i = f64::from(index);
    [
        fraction(i * R4[0], low),
        fraction(i * R4[1], low >> 32),
        fraction(i * R4[2], high),
        fraction(i * R4[3], high >> 32),
    ]
}

/// Points of the unit square, one drawn in each cell of a grid, row by row ("jittered"; Cook 1986). The grid is as square
/// as it can be with at most `count` cells, at least 1: a few less than `count` where that has no such grid.
pub fn stratified2(count: u32, seed: u64) -> Vec<[f32; 2]> {
    let count = count.max(1);
    let rows = count.isqrt();
    let columns = count / rows;
    let unit = |bits: u64| (bits & 0xFF_FFFF) as f32 / (1 << 24) as f32;
    let within =
        |i: u32, cells: u32, bits: u64| ((i as f32 + unit(bits)) / cells as f32).min(0.999_999_94);
    (0..rows * columns)
        .map(|cell| {
            let bits = hash(seed, u64::from(cell));
            [
                within(cell % columns, columns, bits),
                within(cell / columns, rows, bits >> 32),
            ]
        })
        .collect()
}

/// Pairs of points of two unit squares, each stratified as by [`stratified2`], mated at random.
pub fn stratified4(count: u32, seed: u64) -> Vec<[f32; 4]> {
    let (first, mut second) = (
        stratified2(count, hash(seed, 0)),
        stratified2(count, hash(seed, 1)),
    );
    shuffle(&mut second, hash(seed, 2));
    let pairs = first.into_iter().zip(second);
    pairs.map(|([u, v], [s, t])| [u, v, s, t]).collect()
}

/// Fisher and Yates's shuffle.
fn shuffle<T>(items: &mut [T], seed: u64) {
    for i in (1..items.len()).rev() {
        // The bias of a remainder is below 2^-32 for what fits memory.
        let other = hash(seed, i as u64) % (i as u64 + 1);
        items.swap(i, usize::try_from(other).unwrap_or(0));
    }
}

/// Fractional part of the sum of `x` and 32 shifting bits.
#[expect(
    clippy::cast_possible_truncation,
    reason = "a random number is wanted, not its last digits"
)]
fn fraction(x: f64, shift: u64) -> f32 {
    let shifted = x + f64::from(shift as u32) * (1.0 / 4_294_967_296.0);
    ((shifted - shifted.floor()) as f32).min(0.999_999_94)
}

/// Area-uniform point of a planar convex polygon of three or four corners for a point of the unit square.
pub fn polygon_point(polygon: &[Vec3], [u, v]: [f32; 2]) -> Vec3 {
    let triangle = |a: Vec3, b: Vec3, c: Vec3, u: f32, v: f32| {
        // Shirley's square root: the map keeps neighbouring samples together.
        let root = u.sqrt();
        a + (b - a) * (root * (1.0 - v)) + (c - a) * (root * v)
    };
    match *polygon {
        [a, b, c] => triangle(a, b, c, u, v),
        [a, b, c, d] => {
            // A parallelogram maps the square as it is; other quads go by the areas of their two halves.
            let (e, f) = (b - a, d - a);
            if (a + c - b - d).length_squared() <= 1e-10 * (e.length_squared() + f.length_squared())
            {
                return a + e * u + f * v;
            }
            let first = (b - a).cross(c - a).length();
            let share = first / (first + (c - a).cross(d - a).length()).max(1e-30);
            if u < share {
                triangle(a, b, c, u / share, v)
            } else {
                triangle(a, c, d, (u - share) / (1.0 - share), v)
            }
        }
        _ => polygon.first().copied().unwrap_or(Vec3::ZERO),
    }
}

/// Point `index` of the sequence of `seed` in a polygon.
pub fn point_in_polygon(polygon: &[Vec3], index: u32, seed: u64) -> Vec3 {
    polygon_point(polygon, point2(index, seed))
}

/// Direction of cosine-weighted density `cos θ / π` around a unit normal (Malley's method over Shirley and Chiu's
/// concentric map, which keeps neighbouring samples together).
pub fn cosine_direction(normal: Vec3, [u, v]: [f32; 2]) -> Vec3 {
    let (a, b) = (2.0 * u - 1.0, 2.0 * v - 1.0);
    let (radius, angle) = if a == 0.0 && b == 0.0 {
        (0.0, 0.0)
    } else if a.abs() > b.abs() {
        (a, PI / 4.0 * (b / a))
    } else {
        (b, PI / 2.0 - PI / 4.0 * (a / b))
    };
    let (x, y) = (radius * angle.cos(), radius * angle.sin());
    let z = (1.0 - x * x - y * y).max(0.0).sqrt();
    let (tangent, bitangent) = normal.any_orthonormal_pair();
    tangent * x + bitangent * y + normal * z
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_follow_the_cosine() {
        let n = 4096;
        let mean: f32 = (0..n)
            .map(|i| cosine_direction(Vec3::Z, point2(i, 7)).z)
            .sum::<f32>()
            / n as f32;
        assert!(
            (mean - 2.0 / 3.0).abs() < 1e-3,
            "mean cosine {mean} of density cos θ / π is 2/3"
        );
    }

    #[test]
    fn strata_have_a_point_each() {
        for count in [1, 2, 7, 64, 100, 1000] {
            let points = stratified4(count, 5);
            let (rows, cells) = (count.isqrt() as usize, points.len());
            let columns = cells / rows;
            assert!(
                cells <= count as usize && 10 * cells >= 7 * count as usize,
                "{count} points wanted, {cells} given"
            );
            for square in 0..2 {
                let mut hits = vec![0; cells];
                let cell = |x: f32, cells: usize| {
                    let edges = (1..=cells).map(|i| i as f32);
                    edges.take_while(|&edge| edge <= x * cells as f32).count()
                };
                for point in &points {
                    let (u, v) = (point[2 * square], point[2 * square + 1]);
                    hits[cell(v, rows) * columns + cell(u, columns)] += 1;
                }
                assert!(
                    hits.iter().all(|&n| n == 1),
                    "square {square} of {count}: every cell has one point"
                );
            }
        }
    }

    #[test]
    fn points_of_a_trapezoid_are_uniform_in_area() {
        let trapezoid = [Vec3::ZERO, Vec3::X * 4.0, Vec3::new(2.0, 1.0, 0.0), Vec3::Y];
        let n = 4096;
        let mean: Vec3 = (0..n)
            .map(|i| point_in_polygon(&trapezoid, i, 3))
            .sum::<Vec3>()
            / n as f32;
        let centre = Vec3::new(14.0 / 9.0, 4.0 / 9.0, 0.0);
        assert!(
            mean.distance(centre) < 5e-3,
            "mean {mean} of the points, centre of mass {centre}"
        );
    }
}
