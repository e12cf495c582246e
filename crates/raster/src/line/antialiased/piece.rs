//! A convex piece of a stroke: most of its pixels see a strip, some its ends.

use super::exact::RowEdges;
use super::strip::Strip;
use super::{Sums, clamped};
use crate::stroke::{self, Bar};
use crate::target::Window;
use core::ops::Range;
use glam::DVec2;

/// A convex polygon, clockwise on the screen.
pub(super) struct Piece {
    corners: Vec<DVec2>,
    /// What it is in its middle, if it is a bar.
    strip: Option<Strip>,
    /// Rows of the window that it may touch.
    pub rows: Range<i32>,
    /// Columns of the window that it may touch.
    pub columns: Range<i32>,
}

impl Piece {
    pub fn new(piece: stroke::Piece, window: &Window) -> Self {
        let (corners, bar) = match piece {
            stroke::Piece::Bar(bar) => (trimmed(&bar), Some(bar)),
            stroke::Piece::Polygon(corners) => (corners, None),
        };
        let start = (DVec2::INFINITY, DVec2::NEG_INFINITY);
        let (low, high) = corners
            .iter()
            .fold(start, |(low, high), &p| (low.min(p), high.max(p)));
        let range = |low: f64, high: f64, range: Range<i32>| {
            clamped(low.floor(), &range)..clamped(high.ceil(), &range)
        };
        let rows = range(low.y, high.y, window.top..window.bottom);
        Self {
            strip: bar.map(|bar| Strip::new(&bar, &rows)),
            corners,
            rows,
            columns: range(low.x, high.x, window.left..window.right),
        }
    }

    pub fn is_empty(&self) -> bool {
        self.rows.is_empty() || self.columns.is_empty()
    }

    /// Adds its coverage of a row's pixels.
    #[inline(always)]
    pub fn cover_row(&self, row: i32, sums: &mut Sums) {
        let Some(strip) = &self.strip else {
            let touched = RowEdges::bounds(&self.corners, row, self.columns.clone());
            self.cover_exactly(row, touched, sums);
            return;
        };
        let touched = strip.touched(row, &self.columns);
        let free = strip.free(row, &touched);
        if free.is_empty() {
            self.cover_exactly(row, touched, sums);
            return;
        }
        if touched != free {
            self.cover_exactly(row, touched.start..free.start, sums);
            self.cover_exactly(row, free.end..touched.end, sums);
        }
        strip.add(row, free.start, sums.of(free).0);
    }

    #[inline(never)]
    fn cover_exactly(&self, row: i32, columns: Range<i32>, sums: &mut Sums) {
        if !columns.is_empty() {
            let left = columns.start;
            let (sums, edges) = sums.of(columns);
            edges.add(&self.corners, row, left, sums);
        }
    }
}

/// The corners of a bar without what lies beyond the bisectors at its ends (Sutherland and Hodgman).
fn trimmed(bar: &Bar) -> Vec<DVec2> {
    let mut corners = bar.corners().to_vec();
    let [start, end] = bar.trims;
    let cuts = [(bar.from, start), (bar.to, end.map(|normal| -normal))];
    for (at, normal) in cuts {
        if let Some(normal) = normal {
            corners = cut(&corners, |p| (p - at).dot(normal));
        }
    }
    corners
}

/// The part of a convex polygon where something linear is not negative.
fn cut(corners: &[DVec2], distance: impl Fn(DVec2) -> f64) -> Vec<DVec2> {
    let mut kept = Vec::with_capacity(corners.len() + 1);
    let next = corners.iter().cycle().skip(1);
    for (&from, &to) in corners.iter().zip(next) {
        let [before, after] = [from, to].map(&distance);
        if before >= 0.0 {
            kept.push(from);
        }
        if (before >= 0.0) != (after >= 0.0) {
            kept.push(from.lerp(to, before / (before - after)));
        }
    }
    kept
}
