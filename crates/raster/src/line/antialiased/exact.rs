//! The exact area of a polygon in each pixel of a row.

use super::{clamped, narrow};
use core::ops::Range;
use glam::DVec2;

/// A side of a polygon with its slope, cut to rows of pixels on demand.
///
/// A side covers, in a pixel from `x` to `x + 1`, all that is right of it: the integral of `clamp(x + 1 - side, 0, 1)`
/// over its rows. Sides that go up (on the left, clockwise) count positive, those that go down negative; they sum up to
/// the area of the polygon, by Green's theorem.
#[derive(Debug, Clone, Copy)]
pub(super) struct Side {
    from: DVec2,
    to: DVec2,
    /// Change of x for each row.
    slope: f64,
}

/// The part of a side within a row.
#[derive(Debug, Clone, Copy)]
struct Cut {
    /// x of both ends.
    ends: [f64; 2],
    /// Rows that it spans, positive if it goes up.
    height: f64,
}

impl Side {
    pub const ZERO: Self = Self {
        from: DVec2::ZERO,
        to: DVec2::ZERO,
        slope: 0.0,
    };

    pub fn new(from: DVec2, to: DVec2) -> Self {
        let d = to - from;
        let slope = if d.y == 0.0 { 0.0 } else { d.x / d.y };
        Self { from, to, slope }
    }

    /// Whether it is in some of the rows.
    pub fn meets(&self, rows: &Range<i32>) -> bool {
        let [low, high] = [self.from.y.min(self.to.y), self.from.y.max(self.to.y)];
        low < f64::from(rows.end) && high > f64::from(rows.start)
    }

    /// `None` if it is not in the row, or lies along it.
    #[inline(always)]
    fn cut(&self, row: f64) -> Option<Cut> {
        let [from, to] = [self.from.y, self.to.y].map(|y| y.clamp(row, row + 1.0));
        (from != to).then(|| {
            let (low, high) = (self.from.x.min(self.to.x), self.from.x.max(self.to.x));
            let x_at = |y: f64| {
                let x = self.from.x + (y - self.from.y) * self.slope;
                x.max(low).min(high)
            };
            Cut {
                ends: [x_at(from), x_at(to)],
                height: from - to,
            }
        })
    }
}

/// Those of some columns that a polygon touches in a row.
pub(super) fn bounds(sides: &[Side], row: i32, columns: &Range<i32>) -> Range<i32> {
    let cuts = sides.iter().filter_map(|side| side.cut(f64::from(row)));
    let start = [f64::INFINITY, f64::NEG_INFINITY];
    let [low, high] = cuts
        .flat_map(|cut| cut.ends)
        .fold(start, |[low, high], x| [low.min(x), high.max(x)]);
    let start = clamped(low.floor(), columns);
    start..clamped(high.ceil(), columns).max(start)
}

/// Pixels at once.
const LANES: usize = 4;

/// Adds the areas of a polygon in some pixels of a row to `sums`; clockwise polygons have positive areas.
pub(super) fn add(sides: &[Side], row: i32, left: i32, sums: &mut [f32]) {
    for side in sides {
        if let Some(cut) = side.cut(f64::from(row)) {
            cut.add(f64::from(left), sums);
        }
    }
}

impl Cut {
    #[inline(always)]
    fn add(&self, left: f64, sums: &mut [f32]) {
        // From the side to the right border of the present pixel.
        let mut ends = self.ends.map(|x| left + 1.0 - x);
        let length = ends[1] - ends[0];
        let weight = self.height / length;
        for sums in sums.chunks_mut(LANES) {
            let areas: [f64; LANES] = if length.abs() < 1e-6 {
                let middle = 0.5 * (ends[0] + ends[1]);
                LANE.map(|lane| self.height * (middle + lane).clamp(0.0, 1.0))
            } else {
                LANE.map(|lane| weight * (integral(ends[1] + lane) - integral(ends[0] + lane)))
            };
            for (sum, area) in sums.iter_mut().zip(areas) {
                *sum += narrow(area);
            }
            ends = ends.map(|end| end + LANES as f64);
        }
    }
}

const LANE: [f64; LANES] = [0.0, 1.0, 2.0, 3.0];

/// The integral of `clamp(u, 0, 1)` from 0 on.
#[inline(always)]
fn integral(u: f64) -> f64 {
    let within = u.clamp(0.0, 1.0);
    0.5 * within * within + (u - 1.0).max(0.0)
}
