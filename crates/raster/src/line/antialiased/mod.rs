//! Antialiased lines: every pixel is covered by exactly the area that the line has in it.
//!
//! A line of a width is a rectangle, a path a row of such. Away from the ends of a segment a pixel sees an infinite
//! strip, and the share of a unit square within distance `s` of a straight edge is known in closed form. With the
//! edge's unit normal, `a >= b >= 0` the sizes of its components, `s` the centre's distance from the edge:
//! ```text
//! share(s) = 1 - max(m - s, 0) / a - clamp(M - s, 0, b)^2 / (2 a b)    for s >= 0, m = (a - b) / 2, M = (a + b) / 2
//! share(-s) = 1 - share(s)
//! ```
//! which is the convolution of a half-plane with a square pixel. A strip's coverage is the difference of two of those, a
//! few operations without branches that SIMD does for eight pixels at once. Near the ends, and all along short lines, the area
//! is summed over the edges of the piece, exactly for any polygon.
//!
//! At a joint the two segments are cut along its bisector on the inner side and at a right angle on the outer one; what
//! is missing is a piece of its own, the [join](crate::stroke::Join). Pieces do not overlap, and rows are summed up before they are handed to
//! the target: no joint is brighter or darker than the line.
//!
//! What follows, and is tested: the coverage of a line sums up to its length times its width at every angle, and does
//! not vary along a line but for the sampling by pixels itself.
//!
//! # Current state
//! Exact but for rounding: no pixel is off by more than 2e-6 (f32), for coordinates up to 2^20. Where a path runs over
//! itself, or turns within less than a width, coverages are added up and end at 1, as if the parts lay beside each
//! other. Round joins and caps are polygons within 0.02 pixels of the arc. Dashes are drawn too. Working memory is one
//! row of the path's bounding box within the window; a line needs none. Of a picture beyond the cache, lines one by one
//! wait for memory; [`draw_lines`] goes through it in bands.
//!
//! Coverage is a share of light: mix in linear light, as [`Blend`](crate::target::Blend) does for
//! [`Rgb`](crate::Rgb).

mod exact;
mod many;
mod piece;
mod quad;
mod strip;

pub use self::many::{Line, draw_lines};

use self::piece::{Piece, SHORT, extent};
use self::quad::Quad;
use self::strip::Strip;
use crate::stroke::{Bar, Path, Stroke, pieces};
use crate::target::CoverageTarget;
use core::ops::Range;
use glam::DVec2;

/// Draws a line of a width in pixels that is cut off at right angles at both ends. Pixel `(x, y)` is the square from
/// there to `(x + 1, y + 1)`.
///
/// ```
/// use glam::DVec2;
/// use hemicube_raster::Image;
/// use hemicube_raster::line::antialiased::draw_line;
///
/// let mut coverage = Image::filled(40, 30, 0.0);
/// draw_line(&mut coverage.pen(1.0), DVec2::new(5.0, 5.0), DVec2::new(29.0, 23.0), 1.5);
/// let area: f32 = coverage.pixels().iter().sum();
/// assert!((area - 30.0 * 1.5).abs() < 1e-4);
/// ```
pub fn draw_line(target: &mut impl CoverageTarget, from: DVec2, to: DVec2, width: f64) {
    if let Some(bar) = Bar::new(from, to, width) {
        let corners = bar.corners();
        let [rows, columns] = extent(&corners, &target.window());
        let quad = Quad::new(corners);
        let exactly = |target: &mut _, rows: Range<i32>| {
            for row in rows {
                quad.cover(target, row, &columns);
            }
        };
        if rows.len() < SHORT {
            exactly(target, rows);
        } else {
            Strip::new(&bar, &rows).cover(target, rows, &columns, exactly);
        }
    }
}

/// Strokes a path.
pub fn draw_stroke(target: &mut impl CoverageTarget, path: &Path, stroke: &Stroke) {
    let window = target.window();
    let pieces = pieces(path, stroke, &window).into_iter();
    let mut pieces: Vec<Piece> = pieces.map(|piece| Piece::new(piece, &window)).collect();
    pieces.sort_by_key(|piece| piece.rows.start);
    draw_pieces(target, &pieces);
}

/// Draws pieces that come in the order of their first rows.
fn draw_pieces(target: &mut impl CoverageTarget, pieces: &[Piece]) {
    let mut sums = Sums::new(pieces);
    let mut waiting = pieces.iter().filter(|piece| !piece.is_empty()).peekable();
    let mut active: Vec<&Piece> = Vec::new();
    let mut row = i32::MIN;
    loop {
        if active.is_empty() {
            match waiting.peek() {
                Some(piece) => row = piece.rows.start,
                None => return,
            }
        }
        while let Some(piece) = waiting.next_if(|piece| piece.rows.start <= row) {
            active.push(piece);
        }
        let end = waiting.peek().map_or(i32::MAX, |piece| piece.rows.start);
        row = match active.as_slice() {
            [piece] if piece.is_bar() => {
                let rows = row..end.min(piece.rows.end);
                piece.cover_alone(target, rows.clone());
                rows.end
            }
            _ => {
                draw_row(target, &active, row, &mut sums);
                row + 1
            }
        };
        active.retain(|piece| piece.rows.end > row);
    }
}

fn draw_row(target: &mut impl CoverageTarget, pieces: &[&Piece], row: i32, sums: &mut Sums) {
    for piece in pieces {
        piece.cover_row(row, sums);
    }
    sums.hand_over(target, row);
}

/// The coverages of a row while its pieces are summed up.
struct Sums {
    left: i32,
    shares: Vec<f32>,
    /// What may not be 0, as indices; ranges may overlap.
    touched: Vec<Range<usize>>,
}

impl Sums {
    fn new(pieces: &[Piece]) -> Self {
        let left = pieces.iter().map(|p| p.columns.start).min().unwrap_or(0);
        let right = pieces.iter().map(|p| p.columns.end).max().unwrap_or(0);
        Self {
            left,
            shares: vec![0.0; (left..right).len()],
            touched: Vec::new(),
        }
    }

    /// The shares of some columns, which are not empty.
    #[inline(always)]
    fn of(&mut self, columns: Range<i32>) -> &mut [f32] {
        let [start, end] = [columns.start, columns.end].map(|x| index(x - self.left));
        self.touched.push(start..end);
        &mut self.shares[start..end]
    }

    /// Covers the target's pixels, and forgets what is summed up.
    #[inline(always)]
    fn hand_over(&mut self, target: &mut impl CoverageTarget, row: i32) {
        self.touched.sort_unstable_by_key(|range| range.start);
        let mut ranges = self.touched.iter().cloned();
        let mut next = ranges.next();
        while let Some(mut run) = next {
            next = ranges.next();
            while let Some(range) = next.take_if(|range| range.start <= run.end) {
                run.end = run.end.max(range.end);
                next = ranges.next();
            }
            let shares = &mut self.shares[run.clone()];
            for share in shares.iter_mut() {
                *share = share.clamp(0.0, 1.0);
            }
            target.cover(row, self.left + offset(run.start), shares);
            shares.fill(0.0);
        }
        self.touched.clear();
    }
}

#[expect(clippy::cast_sign_loss, reason = "a column right of the leftmost")]
#[inline(always)]
fn index(column: i32) -> usize {
    column as usize
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_possible_wrap,
    reason = "a column of a window"
)]
#[inline(always)]
fn offset(index: usize) -> i32 {
    index as i32
}

#[expect(clippy::cast_possible_truncation, reason = "rounds to the nearest f32")]
#[inline(always)]
fn narrow(number: f64) -> f32 {
    number as f32
}

/// A whole number moved between the ends of a range of rows or columns.
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
