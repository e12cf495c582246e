//! A convex piece of a stroke: most of its pixels see a strip, some its ends.

use super::exact::{self, Side};
use super::strip::Strip;
use super::{Sums, clamped};
use crate::stroke::{self, Bar};
use crate::target::{CoverageTarget, Window};
use core::ops::Range;
use glam::DVec2;

/// A convex polygon, clockwise on the screen.
pub(super) struct Piece {
    sides: Sides,
    /// What it is in its middle, if it is a bar of many rows.
    strip: Option<Strip>,
    /// Rows of the window that it may touch.
    pub rows: Range<i32>,
    /// Columns of the window that it may touch.
    pub columns: Range<i32>,
}

/// Rows from which on a bar is worth the set-up of its strip.
pub(super) const SHORT: usize = 16;

/// The most corners of a bar whose ends are cut along two bisectors.
const BAR_SIDES: usize = 6;

/// Sides of a polygon; those of bars need no memory of their own.
#[expect(clippy::large_enum_variant, reason = "most pieces are bars")]
enum Sides {
    Bar([Side; BAR_SIDES], usize),
    Polygon(Vec<Side>),
}

impl Sides {
    fn as_slice(&self) -> &[Side] {
        match self {
            Self::Bar(sides, count) => &sides[..*count],
            Self::Polygon(sides) => sides,
        }
    }
}

/// The sides between corners.
fn sides_of(corners: &[DVec2]) -> impl Iterator<Item = Side> + '_ {
    let next = corners.iter().cycle().skip(1);
    corners.iter().zip(next).map(|(&a, &b)| Side::new(a, b))
}

impl Piece {
    pub fn new(piece: stroke::Piece, window: &Window) -> Self {
        match piece {
            stroke::Piece::Bar(bar) => Self::bar(&bar, window),
            stroke::Piece::Polygon(corners) => {
                let [rows, columns] = extent(&corners, window);
                // Of a wide arc most sides may be above or below the window.
                let sides = sides_of(&corners).filter(|side| side.meets(&rows));
                Self {
                    sides: Sides::Polygon(sides.collect()),
                    strip: None,
                    rows,
                    columns,
                }
            }
        }
    }

    pub fn bar(bar: &Bar, window: &Window) -> Self {
        let (corners, count) = trimmed(bar);
        let corners = &corners[..count];
        let [rows, columns] = extent(corners, window);
        let mut sides = [Side::ZERO; BAR_SIDES];
        for (place, side) in sides.iter_mut().zip(sides_of(corners)) {
            *place = side;
        }
        Self {
            sides: Sides::Bar(sides, count),
            strip: (rows.len() >= SHORT).then(|| Strip::new(bar, &rows)),
            rows,
            columns,
        }
    }

    /// Whether it is a bar, not a join or a cap.
    pub fn is_bar(&self) -> bool {
        matches!(self.sides, Sides::Bar(..))
    }

    pub fn is_empty(&self) -> bool {
        self.rows.is_empty() || self.columns.is_empty()
    }

    /// Covers the pixels of rows that a bar has for itself.
    #[inline]
    pub fn cover_alone(&self, target: &mut impl CoverageTarget, rows: Range<i32>) {
        let exactly = |target: &mut _, rows: Range<i32>| {
            for row in rows {
                exact::cover::<BAR_SIDES>(target, self.sides.as_slice(), row, &self.columns);
            }
        };
        match &self.strip {
            Some(strip) => strip.cover(target, rows, &self.columns, exactly),
            None => exactly(target, rows),
        }
    }

    /// Adds its coverage of a row's pixels.
    pub fn cover_row(&self, row: i32, sums: &mut Sums) {
        let Some(strip) = &self.strip else {
            let touched = exact::bounds(self.sides.as_slice(), row, &self.columns);
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
        strip.add(row, free.start, sums.of(free));
    }

    fn cover_exactly(&self, row: i32, columns: Range<i32>, sums: &mut Sums) {
        if !columns.is_empty() {
            let left = columns.start;
            exact::add(self.sides.as_slice(), row, left, sums.of(columns));
        }
    }
}

/// Rows and columns of the window that a polygon touches.
pub(super) fn extent(corners: &[DVec2], window: &Window) -> [Range<i32>; 2] {
    let start = (DVec2::INFINITY, DVec2::NEG_INFINITY);
    let (low, high) = corners
        .iter()
        .fold(start, |(low, high), &p| (low.min(p), high.max(p)));
    let range = |low: f64, high: f64, range: Range<i32>| {
        clamped(low.floor(), &range)..clamped(high.ceil(), &range)
    };
    [
        range(low.y, high.y, window.top..window.bottom),
        range(low.x, high.x, window.left..window.right),
    ]
}

/// The corners of a bar without what lies beyond the bisectors at its ends, and how many they are.
fn trimmed(bar: &Bar) -> ([DVec2; BAR_SIDES], usize) {
    let [a, b, c, d] = bar.corners();
    let mut corners = ([a, b, c, d, a, a], 4);
    let [start, end] = bar.trims;
    let cuts = [(bar.from, start), (bar.to, end.map(|normal| -normal))];
    for (at, normal) in cuts {
        if let Some(normal) = normal {
            corners = cut(&corners.0[..corners.1], |p| (p - at).dot(normal));
        }
    }
    corners
}

/// The part of a convex polygon where something linear is not negative (Sutherland and Hodgman).
fn cut(corners: &[DVec2], distance: impl Fn(DVec2) -> f64) -> ([DVec2; BAR_SIDES], usize) {
    let mut kept = [DVec2::ZERO; BAR_SIDES];
    let mut count = 0;
    let mut keep = |p: DVec2| {
        // One more than before at most, but for a dent by rounding.
        if count < BAR_SIDES {
            kept[count] = p;
            count += 1;
        }
    };
    let next = corners.iter().cycle().skip(1);
    for (&from, &to) in corners.iter().zip(next) {
        let [before, after] = [from, to].map(&distance);
        if before >= 0.0 {
            keep(from);
        }
        if (before >= 0.0) != (after >= 0.0) {
            keep(from.lerp(to, before / (before - after)));
        }
    }
    (kept, count)
}
