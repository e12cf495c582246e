//! Antialiased discs and rings: every pixel is covered by exactly the area that the circle has in it.
//!
//! In a row of pixels at distances `a..b` from the centre, with `h(x) = sqrt(r^2 - x^2)`, the disc has in a column the
//! integral of `clamp(h(x), a, b) - a`. Where `h >= b` the pixel is covered in full; between there and where `h` falls
//! below `a` the area under the arc is that of a trapezoid below the chord and of the circular segment above it,
//! ```text
//! r^2 (asin k - k sqrt(1 - k^2)) = r^2 (2/3 k^3 + 1/5 k^5 + 3/28 k^7 + 5/72 k^9 + ..),    k = chord / (2 r)
//! ```
//! The series is used for small `k`, where the difference would lose its digits. A ring is a disc less a smaller one.
//!
//! Only pixels that an edge runs through are integrated, four at a time: both borders of a column are moved to where the
//! arc is in the row, so that a column left or right of it, or above or below, needs no branch. Runs of whole pixels
//! between edges are handed over as such.
//!
//! # Current state
//! Exact but for rounding: no pixel is off by more than 1e-6 for radii of up to 2^20 pixels. Pixels inside of a ring are
//! not looked at. Working memory is two numbers for each column of the circle, of at most 4096 columns at a time. Below 4
//! pixels of radius arcs are integrated one by one.

use crate::target::{CoverageQueue, CoverageTarget, LANES};
use core::ops::Range;
use glam::DVec2;
use wide::f64x4;

/// Fills a disc. Pixel `(x, y)` is the square from there to `(x + 1, y + 1)`. Nothing is drawn unless all numbers are
/// finite and the radius is above 0.
///
/// ```
/// use glam::DVec2;
/// use hemicube_raster::Image;
/// use hemicube_raster::circle::antialiased::fill_circle;
///
/// let mut coverage = Image::filled(20, 20, 0.0);
/// fill_circle(&mut coverage.pen(1.0), DVec2::new(9.7, 10.4), 8.0);
/// let area: f32 = coverage.pixels().iter().sum();
/// assert!((area - 64.0 * std::f32::consts::PI).abs() < 1e-4);
/// ```
pub fn fill_circle(target: &mut impl CoverageTarget, center: DVec2, radius: f64) {
    cover(target, center, [radius, 0.0]);
}

/// Draws a circle as a ring of a width around its radius; one that is wider than the circle is a disc.
pub fn draw_circle(target: &mut impl CoverageTarget, center: DVec2, radius: f64, width: f64) {
    if radius >= 0.0 && width > 0.0 {
        let radii = [radius + 0.5 * width, radius - 0.5 * width];
        cover(target, center, radii.map(|r| r.max(0.0)));
    }
}

/// The largest numbers whose squares are finite.
const LARGEST: f64 = 1e150;

/// A number moved between two others.
#[expect(
    clippy::cast_possible_truncation,
    reason = "between two 32-bit numbers"
)]
#[inline(always)]
fn clamped(number: f64, range: &Range<i32>) -> i32 {
    let [start, end] = [f64::from(range.start), f64::from(range.end)];
    // Comparisons, as `max` and `min` take longer for the sake of NaN.
    let raised = if number > start { number } else { start };
    (if raised < end { raised } else { end }) as i32
}

/// Covers what is between two circles.
fn cover(target: &mut impl CoverageTarget, center: DVec2, [outer, inner]: [f64; 2]) {
    let window = target.window();
    let is_drawn = outer > 0.0 && outer <= LARGEST && center.abs().max_element() <= LARGEST;
    if window.is_empty() || !is_drawn || center.is_nan() {
        return;
    }
    let columns = clamped((center.x - outer).floor(), &(window.left..window.right))
        ..clamped((center.x + outer).ceil(), &(window.left..window.right));
    let mut left = columns.start;
    while left < columns.end {
        let right = left.saturating_add(TILE).min(columns.end);
        cover_tile(target, center, [outer, inner], left..right);
        left = right;
    }
}

/// Columns whose heights are kept at a time.
const TILE: i32 = 4096;

/// Covers those columns of what is between two circles.
fn cover_tile(
    target: &mut impl CoverageTarget,
    center: DVec2,
    [outer, inner]: [f64; 2],
    columns: Range<i32>,
) {
    let window = target.window();
    let rows = window.top..window.bottom;
    let [first, end] = [(center.y - outer).floor(), (center.y + outer).ceil()];
    let outer = Disc::new(outer, center, &columns);
    let inner = Disc::new(inner, center, &columns);
    let queue = &mut CoverageQueue::new();
    for row in clamped(first, &rows)..clamped(end, &rows) {
        let disc = outer.row(row, &columns);
        let hole = inner.row(row, &columns);
        if hole.touched.is_empty() {
            disc.cover(target, queue, row);
        } else {
            cover_ring(target, queue, row, [&disc, &hole]);
        }
    }
    queue.flush(target);
}

/// Covers what a disc has in a row and a smaller one has not.
fn cover_ring(
    target: &mut impl CoverageTarget,
    queue: &mut CoverageQueue,
    row: i32,
    [disc, hole]: [&DiscRow<'_>; 2],
) {
    let touched = &disc.touched;
    let within = |column: i32| column.clamp(touched.start, touched.end);
    let [near, far] = [&hole.touched, &hole.full].map(|r| within(r.start)..within(r.end));
    let outside = |column| disc.areas(column);
    let inside = |column| f64x4::ONE - hole.areas(column);
    let between = |column| disc.areas(column) - hole.areas(column);
    let left = [touched.start, disc.full.start, near.start, far.start];
    let right = [far.end, near.end, disc.full.end, touched.end];
    // An edge, whole pixels and the other edge, or both edges at once.
    match left {
        [start, from, to, end] if from < to => {
            cover_edge(target, queue, row, start..from, outside);
            target.cover_whole(row, from..to);
            cover_edge(target, queue, row, to..end, inside);
        }
        [start, .., end] => cover_edge(target, queue, row, start..end, between),
    }
    match right {
        [start, from, to, end] if from < to => {
            cover_edge(target, queue, row, start..from, inside);
            target.cover_whole(row, from..to);
            cover_edge(target, queue, row, to..end, outside);
        }
        [start, .., end] => cover_edge(target, queue, row, start..end, between),
    }
}

/// Covers pixels of an edge by four shares at a time, as those of a column and its next three.
#[inline]
fn cover_edge(
    target: &mut impl CoverageTarget,
    queue: &mut CoverageQueue,
    row: i32,
    columns: Range<i32>,
    shares: impl Fn(i32) -> f64x4,
) {
    let mut left = columns.start;
    while left < columns.end {
        let count = (left..columns.end).len().min(LANES);
        let shares = shares(left).fast_max(f64x4::ZERO).fast_min(f64x4::ONE);
        queue.push(target, [row, left], shares.to_array().map(narrow), count);
        left = left.saturating_add(4);
    }
}

#[expect(clippy::cast_possible_truncation, reason = "rounds to the nearest f32")]
#[inline(always)]
fn narrow(number: f64) -> f32 {
    number as f32
}

#[expect(clippy::cast_sign_loss, reason = "a column right of the first")]
#[inline(always)]
fn index(column: i32) -> usize {
    column as usize
}

/// A disc of which many rows are asked for.
struct Disc {
    center: DVec2,
    radius: f64,
    /// First of its columns.
    left: i32,
    /// The circle's height at the columns' borders, and some numbers more.
    heights: Vec<f64>,
    /// `1 / (4 r^2)`, or 0.
    per_4r2: f64,
}

/// What a disc has in a row of pixels.
struct DiscRow<'a> {
    disc: &'a Disc,
    /// The parts of the row above and below the centre, by their distances from it; the second may be empty.
    bands: [Band; 2],
    /// The columns that it touches.
    touched: Range<i32>,
    /// Those of them in which it is as high as the row.
    full: Range<i32>,
}

/// A part of a row on one side of the centre.
#[derive(Debug, Clone, Copy)]
struct Band {
    /// Distances from the centre.
    near: f64,
    far: f64,
    /// Where the circle is as high as `near` and as `far`; 0 if it is nowhere.
    half_widths: [f64; 2],
}

/// The height of a circle, 0 beyond it.
#[inline(always)]
fn height(radius: f64, x: f64) -> f64 {
    let squared = (radius - x) * (radius + x);
    // A comparison, as `max` takes longer for the sake of NaN.
    (if squared > 0.0 { squared } else { 0.0 }).sqrt()
}

impl Disc {
    fn new(radius: f64, center: DVec2, columns: &Range<i32>) -> Self {
        let first = f64::from(columns.start) - center.x;
        // Beyond the last border as many as a block of columns may read.
        let borders = if radius > 0.0 {
            columns.end - columns.start + 5
        } else {
            0
        };
        let mut heights = vec![0.0; index(borders)];
        for (border, place) in (0..borders).zip(&mut heights) {
            *place = height(radius, (first + f64::from(border)).abs());
        }
        Self {
            left: columns.start,
            heights,
            center,
            radius,
            per_4r2: if radius > 0.0 {
                0.25 / (radius * radius)
            } else {
                0.0
            },
        }
    }

    #[inline(always)]
    fn row(&self, row: i32, columns: &Range<i32>) -> DiscRow<'_> {
        let top = f64::from(row) - self.center.y;
        let bottom = top + 1.0;
        let bands = if top < 0.0 && bottom > 0.0 {
            [self.band(0.0, bottom), self.band(0.0, -top)]
        } else {
            let [near, far] = [top.abs().min(bottom.abs()), top.abs().max(bottom.abs())];
            [
                self.band(near, far),
                Band {
                    near: far,
                    far,
                    half_widths: [0.0, self.radius],
                },
            ]
        };
        let [half, full] = [
            bands[0].half_widths[0].max(bands[1].half_widths[0]),
            bands[0].half_widths[1].min(bands[1].half_widths[1]),
        ];
        let x = self.center.x;
        let touched = clamped((x - half).floor(), columns)..clamped((x + half).ceil(), columns);
        let start = clamped((x - full).ceil(), &touched);
        let full = start..clamped((x + full).floor(), &(start..touched.end));
        let touched = if half > 0.0 { touched } else { start..start };
        DiscRow {
            disc: self,
            bands,
            touched,
            full,
        }
    }

    #[inline(always)]
    fn band(&self, near: f64, far: f64) -> Band {
        Band {
            near,
            far,
            half_widths: [height(self.radius, near), height(self.radius, far)],
        }
    }

    /// The heights at the left and right borders of columns.
    #[inline(always)]
    fn heights_from(&self, left: i32) -> [f64x4; 2] {
        let heights = &self.heights[index(left - self.left)..];
        [four(heights), four(&heights[1..])]
    }

    /// The area between the circle and its chords over columns, which are at most half a disc.
    #[inline(always)]
    fn segments(&self, chords_squared: f64x4) -> f64x4 {
        let k2 = chords_squared * self.per_4r2;
        let k = k2.sqrt();
        let of_unit = if self.per_4r2 < LARGEST_FOR_SERIES {
            let rest = f64x4::splat(3.0 / 28.0) + k2 * (5.0 / 72.0);
            k * k2 * (f64x4::splat(2.0 / 3.0) + k2 * (f64x4::splat(1.0 / 5.0) + k2 * rest))
        } else {
            f64x4::from(k.to_array().map(segment))
        };
        of_unit * (self.radius * self.radius)
    }
}

impl DiscRow<'_> {
    /// Covers all of it.
    fn cover(&self, target: &mut impl CoverageTarget, queue: &mut CoverageQueue, row: i32) {
        let Range { start, end } = self.full;
        let shares = |column| self.areas(column);
        cover_edge(target, queue, row, self.touched.start..start, shares);
        if start < end {
            target.cover_whole(row, start..end);
        }
        cover_edge(target, queue, row, end..self.touched.end, shares);
    }

    /// Its areas in pixels from column `left` on.
    #[inline(always)]
    fn areas(&self, left: i32) -> f64x4 {
        let first = f64::from(left) - self.disc.center.x;
        let start = f64x4::splat(first) + STEPS;
        let borders = [start.abs(), (start + f64x4::ONE).abs()];
        let areas = self.between(borders, self.disc.heights_from(left));
        // Both sides of the centre are alike; a pixel above it has parts on both.
        if first < 0.0 && first > -(LANES as f64) && first.fract() != 0.0 {
            self.with_centre(areas, first)
        } else {
            areas
        }
    }

    /// Areas of which one is that of the pixel above the centre.
    #[cold]
    fn with_centre(&self, areas: f64x4, first: f64) -> f64x4 {
        let own = -first.floor() - 1.0;
        let borders = [-first - own, first + own + 1.0, 0.0, 0.0];
        let heights = borders.map(|x| height(self.disc.radius, x));
        let start = [f64x4::ZERO, f64x4::splat(self.disc.radius)];
        let halves = self.between([start[0], borders.into()], [start[1], heights.into()]);
        let [a, b, ..] = halves.to_array();
        let mut areas = areas.to_array();
        areas[lane(own)] = a + b;
        areas.into()
    }

    /// The areas between two borders each on the same side of the centre.
    #[inline(always)]
    fn between(&self, borders: [f64x4; 2], heights: [f64x4; 2]) -> f64x4 {
        let areas = self.bands[0].areas(self.disc, borders, heights);
        if self.bands[1].near < self.bands[1].far {
            areas + self.bands[1].areas(self.disc, borders, heights)
        } else {
            areas
        }
    }
}

/// The first four of some numbers; 0 if they are fewer.
#[inline(always)]
fn four(numbers: &[f64]) -> f64x4 {
    numbers.first_chunk().copied().unwrap_or_default().into()
}

/// The first four whole numbers.
const STEPS: f64x4 = f64x4::new([0.0, 1.0, 2.0, 3.0]);

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "one of a few lanes"
)]
#[inline(always)]
fn lane(number: f64) -> usize {
    number as usize
}

/// `1 / (4 r^2)` from which on chords through a pixel are too long for the series: 4 pixels of radius.
const LARGEST_FOR_SERIES: f64 = 1.0 / 64.0;

impl Band {
    /// The areas between columns at distances from the centre where the circle has the given heights.
    #[inline(always)]
    fn areas(&self, disc: &Disc, x: [f64x4; 2], heights: [f64x4; 2]) -> f64x4 {
        let (near, far) = (f64x4::splat(self.near), f64x4::splat(self.far));
        let arc_end = f64x4::splat(self.half_widths[0]);
        let arc_start = f64x4::splat(self.half_widths[1]);
        let full = (x[1].fast_min(arc_start) - x[0].fast_min(arc_start)).abs() * (far - near);
        let on_arc = |x: f64x4| x.fast_max(arc_start).fast_min(arc_end);
        let in_row = |height: f64x4| height.fast_max(near).fast_min(far);
        let (high, low) = (in_row(heights[0]), in_row(heights[1]));
        let across = (on_arc(x[1]) - on_arc(x[0])).abs();
        let down = high - low;
        let below_chord = across * ((high + low) * 0.5 - near);
        full + below_chord + disc.segments(across * across + down * down)
    }
}

/// The area between a chord of length `2 k` and its arc of a circle of radius 1, at most half a disc.
fn segment(k: f64) -> f64 {
    let k = k.min(1.0);
    let k2 = k * k;
    if k < 0.2 {
        k * k2 * (2.0 / 3.0 + k2 * (1.0 / 5.0 + k2 * (3.0 / 28.0 + k2 * (5.0 / 72.0))))
    } else {
        k.asin() - k * (1.0 - k2).sqrt()
    }
}
