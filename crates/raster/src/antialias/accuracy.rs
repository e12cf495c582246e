//! How far antialiasing is from the truth, in figures.
//!
//! [`coverage_error`] compares the coverage of polygons with their exact area in each pixel, [`zone_plate_error`] measures
//! what is left of waves that pixels cannot show, and what is lost of those that they can. Filters that reach beyond
//! a pixel spread edges on purpose: their coverage differs from the area in one pixel, and the zone plate shows what
//! that is good for.

use super::area::{FillRule, Outline, mask, mask8};
use super::{Antialiasing, Supersampler};
use core::f64::consts::TAU;
use glam::{DVec2, dvec2};

/// A way to find coverage.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Method {
    /// Samples of inside and outside.
    Samples(Antialiasing),
    /// The exact area, as [`mask`] finds it.
    Area,
    /// The same rounded to 256 levels.
    Area8,
}

/// Difference between coverage and area over the pixels in which an edge lies.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct CoverageError {
    /// Root of the mean square.
    pub rms: f64,
    /// The largest.
    pub largest: f64,
    /// The mean: above 0 if areas come out too large.
    pub bias: f64,
    /// Number of pixels compared.
    pub pixels: usize,
}

/// Side of the picture in which polygons are compared.
const SIDE: usize = 52;

/// So many random triangles in a box of 50 pixels.
pub fn triangles(count: usize, seed: u64) -> Vec<Vec<DVec2>> {
    let mut random = Random(seed);
    let mut point = || dvec2(random.unit(), random.unit()) * 50.0 + 1.0;
    (0..count)
        .map(|_| (0..3).map(|_| point()).collect())
        .collect()
}

/// So many random bars of 40 by 8 pixels that lie within 5 degrees of level: the edges that show stairs most.
pub fn near_level_bars(count: usize, seed: u64) -> Vec<Vec<DVec2>> {
    let mut random = Random(seed);
    let mut bar = || {
        let along = DVec2::from_angle((10.0 * random.unit() - 5.0).to_radians());
        let center = dvec2(26.0 + random.unit(), 26.0 + random.unit());
        let corner = |x: f64, y: f64| center + along * x + along.perp() * y;
        vec![
            corner(-20.0, -4.0),
            corner(20.0, -4.0),
            corner(20.0, 4.0),
            corner(-20.0, 4.0),
        ]
    };
    (0..count).map(|_| bar()).collect()
}

/// Error of a method over convex polygons within 52 x 52 pixels.
pub fn coverage_error(method: Method, polygons: &[Vec<DVec2>]) -> CoverageError {
    let (mut sum, mut squares, mut largest, mut pixels) = (0.0, 0.0, 0.0_f64, 0);
    for polygon in polygons {
        let coverage = coverage(method, polygon);
        let edges = edges(polygon);
        let pixels_in_rows = (0..SIDE * SIDE).map(|i| (i % SIDE, i / SIDE));
        for (x, y) in pixels_in_rows.filter(|&(x, y)| may_have_edge(&edges, x, y)) {
            let exact = area_in_pixel(polygon, x, y);
            if exact > 1e-9 && exact < 1.0 - 1e-9 {
                let error = coverage(x, y) - exact;
                (sum, squares) = (sum + error, squares + error * error);
                largest = largest.max(error.abs());
                pixels += 1;
            }
        }
    }
    let count = pixels.max(1) as f64;
    CoverageError {
        rms: (squares / count).sqrt(),
        largest,
        bias: sum / count,
        pixels,
    }
}

/// Coverage of the pixel of a column and a row by a method.
fn coverage(method: Method, polygon: &[DVec2]) -> Box<dyn Fn(usize, usize) -> f64> {
    let outline = || Outline::polygon(polygon.iter().copied());
    let size = (SIDE, SIDE);
    match method {
        Method::Samples(antialiasing) => {
            let edges = edges(polygon);
            let sampler = Supersampler::new(SIDE, SIDE, antialiasing);
            Box::new(move |x, y| sampled(&sampler, &edges, x, y))
        }
        Method::Area => {
            let image = mask(&outline(), FillRule::NonZero, size);
            Box::new(move |x, y| f64::from(*image.pixel(x, y)))
        }
        Method::Area8 => {
            let image = mask8(&outline(), FillRule::NonZero, size);
            Box::new(move |x, y| f64::from(*image.pixel(x, y)) / 255.0)
        }
    }
}

/// Weight of the samples of one pixel that lie inside; only pixels with an edge are asked for, so no picture is made.
fn sampled(sampler: &Supersampler, edges: &[[DVec2; 2]], x: usize, y: usize) -> f64 {
    let (column, row) = (x * sampler.factor(), y * sampler.factor());
    let mut sum = 0.0;
    for (j, &down) in sampler.weights().iter().enumerate() {
        for (i, &across) in sampler.weights().iter().enumerate() {
            if is_inside(edges, sampler.position(column + i, row + j).into()) {
                sum += f64::from(across) * f64::from(down);
            }
        }
    }
    sum
}

/// Beginnings and directions of the edges of a convex polygon, turned so that the inside is on their left.
fn edges(polygon: &[DVec2]) -> Vec<[DVec2; 2]> {
    let next = polygon.iter().cycle().skip(1);
    let edges = polygon.iter().zip(next).map(|(&a, &b)| [a, b - a]);
    let turn = area(polygon).signum();
    edges.map(|[a, along]| [a, along * turn]).collect()
}

fn is_inside(edges: &[[DVec2; 2]], p: DVec2) -> bool {
    edges.iter().all(|&[a, along]| along.perp_dot(p - a) >= 0.0)
}

/// Whether a pixel is neither whole inside nor beyond one of the edges.
fn may_have_edge(edges: &[[DVec2; 2]], column: usize, row: usize) -> bool {
    let low = dvec2(column as f64, row as f64);
    let corners = [DVec2::ZERO, DVec2::X, DVec2::Y, DVec2::ONE].map(|corner| low + corner);
    let is_beyond = |&[a, along]: &[DVec2; 2]| corners.iter().all(|&p| along.perp_dot(p - a) < 0.0);
    !edges.iter().any(is_beyond) && !corners.iter().all(|&p| is_inside(edges, p))
}

/// Signed area of a polygon (the shoelace formula).
fn area(polygon: &[DVec2]) -> f64 {
    let next = polygon.iter().cycle().skip(1);
    let twice: f64 = polygon.iter().zip(next).map(|(a, b)| a.perp_dot(*b)).sum();
    twice / 2.0
}

/// Area of a polygon in the pixel of a column and a row: it is clipped at the pixel's sides, one after the other.
fn area_in_pixel(polygon: &[DVec2], column: usize, row: usize) -> f64 {
    let low = dvec2(column as f64, row as f64);
    let sides = [
        (DVec2::NEG_X, -low.x),
        (DVec2::X, low.x + 1.0),
        (DVec2::NEG_Y, -low.y),
        (DVec2::Y, low.y + 1.0),
    ];
    let clipped = sides
        .into_iter()
        .try_fold(polygon.to_vec(), |polygon, (normal, limit)| {
            let clipped = clip(&polygon, normal, limit);
            (!clipped.is_empty()).then_some(clipped)
        });
    clipped.map_or(0.0, |polygon| area(&polygon).abs())
}

/// The part of a polygon on one side of a line (Sutherland and Hodgman 1974).
fn clip(polygon: &[DVec2], normal: DVec2, limit: f64) -> Vec<DVec2> {
    let mut kept = Vec::with_capacity(polygon.len() + 1);
    let next = polygon.iter().cycle().skip(1);
    for (&a, &b) in polygon.iter().zip(next) {
        let (beyond_a, beyond_b) = (normal.dot(a) - limit, normal.dot(b) - limit);
        if beyond_a <= 0.0 {
            kept.push(a);
        }
        if (beyond_a < 0.0 && beyond_b > 0.0) || (beyond_a > 0.0 && beyond_b < 0.0) {
            kept.push(a.lerp(b, beyond_a / (beyond_a - beyond_b)));
        }
    }
    kept
}

/// A zone plate of a side of `size` pixels, `0.5 + 0.5 cos(2 pi r^2 / size)`: rings of `2 x / size` cycles per pixel in x
/// and `2 y / size` in y, `x` and `y` counted from the middle. Half a cycle, the most that pixels can show, is reached
/// half-way to the sides, and a whole one, which looks flat to one sample per pixel, at the sides.
pub fn zone_plate(size: f64) -> impl Fn(f64, f64) -> f32 + Sync {
    move |x, y| {
        let square = (x - size / 2.0).powi(2) + (y - size / 2.0).powi(2);
        #[expect(clippy::cast_possible_truncation, reason = "between 0 and 1")]
        let value = (0.5 + 0.5 * (TAU * square / size).cos()) as f32;
        value
    }
}

/// What becomes of a [`zone_plate`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ZonePlateError {
    /// RMS contrast of what should be flat grey, where rings have more than half a cycle per pixel in x or in y; 0.354 if
    /// all of it is left. It is moiré where samples lie on a grid; jitter turns it into noise, which counts the same here.
    pub moire: f64,
    /// Share of the RMS contrast that is kept where rings have at most a quarter of a cycle per pixel; 1 is best.
    pub kept: f64,
}

/// What becomes of a zone plate with a side of so many pixels.
pub fn zone_plate_error(antialiasing: Antialiasing, size: usize) -> ZonePlateError {
    let truth = zone_plate(size as f64);
    let image = Supersampler::new(size, size, antialiasing).render(&truth);
    let cycles = |index: usize| 2.0 * (index as f64 + 0.5) / size as f64 - 1.0;
    let (mut beyond, mut within, mut original) = (Vec::new(), Vec::new(), Vec::new());
    for (i, &value) in image.pixels().iter().enumerate() {
        let (column, row) = (i % size, i / size);
        let (fx, fy) = (cycles(column).abs(), cycles(row).abs());
        if fx.max(fy) > 0.5 {
            beyond.push(f64::from(value) - 0.5);
        } else if fx.hypot(fy) < 0.25 {
            within.push(f64::from(value) - 0.5);
            let center = truth(column as f64 + 0.5, row as f64 + 0.5);
            original.push(f64::from(center) - 0.5);
        }
    }
    ZonePlateError {
        moire: rms(&beyond),
        kept: rms(&within) / rms(&original).max(f64::MIN_POSITIVE),
    }
}

fn rms(values: &[f64]) -> f64 {
    let squares: f64 = values.iter().map(|v| v * v).sum();
    (squares / values.len().max(1) as f64).sqrt()
}

/// Numbers in [0, 1): a linear congruential generator (Knuth's MMIX), of which the high bits are used.
struct Random(u64);

impl Random {
    fn unit(&mut self) -> f64 {
        let (a, c) = (6_364_136_223_846_793_005, 1_442_695_040_888_963_407);
        self.0 = self.0.wrapping_mul(a).wrapping_add(c);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn samples(name: &str) -> Method {
        Method::Samples(name.parse().expect(name))
    }

    #[test]
    fn errors_of_sampling_patterns_are_those_of_other_programs() {
        // Measured elsewhere over 31 549 pixels of other random triangles; of some 15 000 pixels in 150 triangles, which
        // share edges, the RMS varies by some percent.
        let polygons = triangles(150, 1);
        for (name, expected) in [
            ("1x1", 0.250),
            ("2x2", 0.0876),
            ("4x4", 0.0311),
            ("8x8", 0.0109),
            ("2x2-jittered@0.25", 0.127),
            ("4x4-jittered@0.125", 0.0452),
            ("8x8-jittered@0.0625", 0.0161),
        ] {
            let error = coverage_error(samples(name), &polygons);
            assert!(
                (error.rms / expected - 1.0).abs() < 0.06,
                "{name}: {error:?}, elsewhere {expected}"
            );
            assert!(error.bias.abs() < 0.01, "{name}: {error:?}");
        }
    }

    #[test]
    fn areas_are_exact_and_bytes_are_rounded_areas() {
        let polygons = triangles(100, 2);
        let exact = coverage_error(Method::Area, &polygons);
        assert!(exact.rms < 1e-6 && exact.largest < 1e-5, "{exact:?}");
        let bytes = coverage_error(Method::Area8, &polygons);
        // Rounding to steps of 1 / 255 has an RMS of 0.2887 of a step.
        assert!(
            bytes.rms * 255.0 < 0.30 && bytes.largest * 255.0 < 0.501,
            "{bytes:?}"
        );
    }

    #[test]
    fn level_edges_need_rows_of_samples() {
        let bars = near_level_bars(40, 3);
        let error = |name| coverage_error(samples(name), &bars);
        // Each row of samples counts as one step of coverage: the RMS of rounding to n steps is 0.289 / n.
        for (name, rows) in [("2x2", 2.0), ("4x4", 4.0), ("8x8", 8.0)] {
            let rms = error(name).rms;
            assert!((0.6..1.1).contains(&(rms * rows / 0.289)), "{name}: {rms}");
        }
        assert!(coverage_error(Method::Area, &bars).largest < 1e-5, "area");
    }

    #[test]
    fn zone_plate_tells_filters_apart() {
        let of = |name: &str| zone_plate_error(name.parse().expect(name), 128);
        for n in [
            "none",
            "4x4",
            "4x4:bartlett",
            "4x4:bartlett-3x3",
            "2x2",
            "2x2:bartlett",
            "3x3-jittered",
            "4x4:gaussian",
            "4x4:mitchell",
            "4x4:blackman-harris",
            "4x4:lanczos",
            "8x8:lanczos",
        ] {
            println!("{n}: {:?}", of(n));
        }
        let [none, samples, bartlett] = [of("none"), of("4x4"), of("4x4:bartlett")];
        assert!(
            (none.moire - 0.354).abs() < 0.02 && (none.kept - 1.0).abs() < 1e-6,
            "{none:?}"
        );
        assert!(samples.moire < 0.6 * none.moire, "{samples:?}");
        assert!(bartlett.moire < 0.6 * samples.moire, "{bartlett:?}");
        assert!(
            bartlett.kept < samples.kept && bartlett.kept > 0.7,
            "{bartlett:?}"
        );
        // Twice the pixels' frequency: a filter too narrow for its factor lets it through.
        let unfit = of("4x4:bartlett-3x3");
        assert!(unfit.moire > 2.0 * bartlett.moire, "{unfit:?}");
    }
}
