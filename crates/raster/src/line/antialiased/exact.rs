//! The exact area of a polygon in each pixel of a row.

use super::clamped;
use crate::signed_area::{LANES, SignedArea};
use crate::target::CoverageTarget;
use core::ops::Range;
use glam::DVec2;
use wide::f32x8;

/// A side of a polygon with its slope, cut to rows of pixels on demand.
///
/// A side covers, in a pixel, all that is right of it ([`SignedArea`]). Sides that go up (on the left, clockwise) count
/// positive, those that go down negative; they sum up to the area of the polygon.
#[derive(Debug, Clone, Copy)]
pub(super) struct Side {
    from: DVec2,
    to: DVec2,
    /// Change of x for each row.
    slope: f64,
    /// Its least and its greatest x, drawn back to where they have squares in f32.
    extent: [f64; 2],
}

/// Beyond, nothing is known of pixels anyway.
pub(super) const FARTHEST: f64 = 1e18;

/// A number moved between two others; comparisons, as `max` and `min` take longer for the sake of NaN.
#[inline(always)]
fn moved(number: f64, [low, high]: [f64; 2]) -> f64 {
    let raised = if number > low { number } else { low };
    if raised < high { raised } else { high }
}

impl Side {
    pub const ZERO: Self = Self {
        from: DVec2::ZERO,
        to: DVec2::ZERO,
        slope: 0.0,
        extent: [0.0; 2],
    };

    #[inline(always)]
    pub fn new(from: DVec2, to: DVec2) -> Self {
        let d = to - from;
        let slope = if d.y == 0.0 { 0.0 } else { d.x / d.y };
        let extent = if d.x > 0.0 {
            [from.x, to.x]
        } else {
            [to.x, from.x]
        };
        Self {
            from,
            to,
            slope,
            extent: extent.map(|x| moved(x, [-FARTHEST, FARTHEST])),
        }
    }

    /// Whether it is in some of the rows.
    pub fn meets(&self, rows: &Range<i32>) -> bool {
        let [low, high] = [self.from.y.min(self.to.y), self.from.y.max(self.to.y)];
        low < f64::from(rows.end) && high > f64::from(rows.start)
    }

    /// What it covers of a row; `None` if it is not in the row, or lies along it.
    #[inline(always)]
    fn cut(&self, row: f64) -> Option<SignedArea> {
        let [from, to] = [self.from.y, self.to.y].map(|y| moved(y, [row, row + 1.0]));
        (from != to).then(|| {
            let x_at = |y: f64| moved(self.from.x + (y - self.from.y) * self.slope, self.extent);
            SignedArea::new([x_at(from), x_at(to)], narrow(from - to))
        })
    }
}

#[expect(clippy::cast_possible_truncation, reason = "rounds to the nearest f32")]
#[inline(always)]
fn narrow(number: f64) -> f32 {
    number as f32
}

/// Those of some columns that a polygon touches in a row.
pub(super) fn bounds(sides: &[Side], row: i32, columns: &Range<i32>) -> Range<i32> {
    let cuts = sides.iter().filter_map(|side| side.cut(f64::from(row)));
    let start = [f64::INFINITY, f64::NEG_INFINITY];
    let [low, high] = cuts.fold(start, |[low, high], cut| {
        [low.min(cut.left), high.max(cut.right)]
    });
    let start = clamped(low.floor(), columns);
    start..clamped(high.ceil(), columns).max(start)
}

/// Adds the areas of a polygon in some pixels of a row to `sums`; clockwise polygons have positive areas.
pub(super) fn add(sides: &[Side], row: i32, left: i32, sums: &mut [f32]) {
    for cut in sides.iter().filter_map(|side| side.cut(f64::from(row))) {
        let mut first = f64::from(left);
        for sums in sums.chunks_mut(LANES) {
            let shares = cut.shares(first).to_array();
            for (sum, share) in sums.iter_mut().zip(shares) {
                *sum += share;
            }
            first += LANES as f64;
        }
    }
}

/// Covers the pixels of a row that a polygon of at most `N` sides has for itself.
#[inline]
pub(super) fn cover<const N: usize>(
    target: &mut impl CoverageTarget,
    sides: &[Side],
    row: i32,
    columns: &Range<i32>,
) {
    let mut cuts = [SignedArea::ZERO; N];
    let mut count = 0;
    let [mut low, mut high] = [f64::INFINITY, f64::NEG_INFINITY];
    for cut in sides.iter().filter_map(|side| side.cut(f64::from(row))) {
        low = if cut.left < low { cut.left } else { low };
        high = if cut.right > high { cut.right } else { high };
        cuts[count] = cut;
        count += 1;
    }
    let mut left = clamped(low.floor(), columns);
    let right = clamped(high.ceil(), columns);
    while left < right {
        let mut shares = f32x8::ZERO;
        for cut in &cuts[..count] {
            shares += cut.shares(f64::from(left));
        }
        let shares = shares.fast_max(f32x8::ZERO).fast_min(f32x8::ONE).to_array();
        let seen = (left..right).len().min(LANES);
        target.cover(row, left, &shares[..seen]);
        left = left.saturating_add(8);
    }
}
