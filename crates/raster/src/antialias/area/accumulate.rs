//! A row of differences whose running sum is coverage.

use super::Spans;

/// A straight piece of an edge within one row.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Piece {
    /// y of its upper and of its lower end.
    pub top: f64,
    pub bottom: f64,
    /// x of its upper and of its lower end.
    pub x_top: f64,
    pub x_bottom: f64,
}

impl Piece {
    /// x at a y between top and bottom.
    pub fn x_at(&self, y: f64) -> f64 {
        let t = (y - self.top) / (self.bottom - self.top);
        self.x_top + (self.x_bottom - self.x_top) * t
    }
}

/// Differences of coverage from pixel to pixel of one row.
#[derive(Debug, Clone)]
pub(super) struct Differences {
    /// All zero between rows; three more than there are columns, for what lies on the right edge.
    values: Vec<f32>,
    /// First and last columns of ranges that may not be zero; neighbours may overlap.
    touched: Vec<[usize; 2]>,
    /// Coverage of a range.
    coverage: Vec<f32>,
}

impl Differences {
    /// A row of so many columns.
    pub fn new(width: usize) -> Self {
        Self {
            values: vec![0.0; width + 3],
            touched: Vec::new(),
            coverage: vec![0.0; width + 3],
        }
    }

    /// Adds `sign` times the area to the right of a piece.
    #[inline]
    pub fn add(&mut self, piece: &Piece, sign: f64) {
        #[expect(clippy::cast_possible_truncation, reason = "at most 1")]
        let height = ((piece.bottom - piece.top) * sign) as f32;
        let left = piece.x_top.min(piece.x_bottom);
        let right = piece.x_top.max(piece.x_bottom);
        let first = column(left);
        #[expect(clippy::cast_possible_truncation, reason = "a number of pixels")]
        let (from, to) = ((left - first as f64) as f32, (right - first as f64) as f32);
        if to <= 2.0 {
            self.add_steep(first, height, from, to);
        } else {
            self.add_flat(first, height, from, to);
        }
    }

    /// Adds a piece in a column and the next one, from x to x as seen from the first of them.
    ///
    /// One column or two is a matter of luck, so there is no branch for it: t is the share in the first column, where it
    /// runs at a mean distance of (b + r) / 2 from the column's right side, and at e / 2 to the right of it in the other.
    #[inline]
    fn add_steep(&mut self, first: usize, height: f32, from: f32, to: f32) {
        let b = 1.0 - from;
        let r = (1.0 - to).max(0.0);
        let e = (to - 1.0).max(0.0);
        // Upright pieces divide by 0: the share is 1.
        let t = (b / (to - from)).min(1.0);
        let near = height * t * (0.5 * (b + r));
        let beyond = height * (1.0 - t) * (0.5 * e);
        let cells = &mut self.values[first..first + 3];
        cells[0] += near;
        cells[1] += height - near - beyond;
        cells[2] += beyond;
    }

    /// Adds a piece through three columns or more, from x to x as seen from the first of them.
    ///
    /// Of a piece of height h from x = l to r, the area to its right and left of a column's right side x is
    /// P(x) = h (x - l)^2 / (2 (r - l)) up to r, and grows by h per pixel from there on. A column's coverage is the
    /// difference of two P; the difference of two columns' coverage is what is stored: h / (r - l) in the middle.
    fn add_flat(&mut self, first: usize, height: f32, from: f32, to: f32) {
        let step = height / (to - from);
        let last = column(f64::from(to));
        let rest = to - last as f32;
        let start = 0.5 * step * (1.0 - from) * (1.0 - from);
        let end = 0.5 * step * rest * rest;
        let cells = &mut self.values[first..first + last + 2];
        cells[0] += start;
        cells[1] += step * (1.5 - from) - start;
        for cell in &mut cells[2..last] {
            *cell += step;
        }
        cells[last] += step * (0.5 + rest) - end;
        cells[last + 1] += end;
    }

    /// Notes that pieces between two x were added.
    #[inline]
    pub fn touch(&mut self, left: f64, right: f64) {
        self.touched.push([column(left), column(right) + 1]);
    }

    /// Takes the row apart: coverage by columns where pieces were added, one value for all columns between.
    ///
    /// The last difference of a range brings the sum to what holds behind it, so its column belongs to the run.
    #[inline]
    pub fn emit(&mut self, y: usize, fold: impl Fn(f32) -> f32, spans: &mut impl Spans) {
        sort_by_start(&mut self.touched);
        let width = self.values.len() - 3;
        let mut sum = 0.0;
        let mut at = 0;
        let mut touched = self.touched.iter().peekable();
        while let Some(&[start, mut last]) = touched.next() {
            while let Some([_, further]) = touched.next_if(|next| next[0] <= last) {
                last = last.max(*further);
            }
            emit_run(y, [at, start], settled(fold(sum)), spans);
            let differences = self.values[start..last].iter_mut();
            for (difference, coverage) in differences.zip(&mut self.coverage) {
                sum += core::mem::take(difference);
                *coverage = fold(sum);
            }
            let shown = last.min(width).saturating_sub(start);
            if shown > 0 {
                spans.cells(y, start, &self.coverage[..shown]);
            }
            sum += core::mem::take(&mut self.values[last]);
            at = last;
        }
        self.touched.clear();
        emit_run(y, [at, width], settled(fold(sum)), spans);
    }
}

#[inline]
fn emit_run(y: usize, [start, end]: [usize; 2], coverage: f32, spans: &mut impl Spans) {
    if start < end && coverage > 0.0 {
        spans.run(y, start, end, coverage);
    }
}

/// Full and empty runs are exactly so: what rounding left of a sum is less than this.
fn settled(coverage: f32) -> f32 {
    const ROUNDING: f32 = 4e-6;
    match coverage {
        c if c < ROUNDING => 0.0,
        c if c > 1.0 - ROUNDING => 1.0,
        c => c,
    }
}

/// The column in which an x lies.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "x lies in the picture, but for rounding; the cast saturates"
)]
#[inline]
fn column(x: f64) -> usize {
    x as u32 as usize
}

/// Chains come in order already, most of the time.
#[inline]
fn sort_by_start(touched: &mut [[usize; 2]]) {
    if !touched.is_sorted_by_key(|range| range[0]) {
        touched.sort_unstable();
    }
}
