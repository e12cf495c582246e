//! The exact area of one quadrilateral in each pixel, its four sides at once.

use super::clamped;
use super::exact::FARTHEST;
use crate::signed_area::{LANES, SignedArea};
use crate::target::CoverageTarget;
use core::ops::Range;
use glam::DVec2;
use wide::{f32x8, f64x4};

/// The sides of a quadrilateral, clockwise on the screen; a number of each in a vector.
///
/// All four are cut to each row, though two or three of them are not in it and count nothing: which ones changes from row to
/// row of a short line, and a branch for it would be mispredicted most of the time.
#[derive(Debug, Clone, Copy)]
pub(super) struct Quad {
    from_y: f64x4,
    to_y: f64x4,
    from_x: f64x4,
    /// Change of x for each row.
    slope: f64x4,
    /// The least and the greatest x of each side.
    low: f64x4,
    high: f64x4,
}

impl Quad {
    #[inline(always)]
    pub fn new(corners: [DVec2; 4]) -> Self {
        let [a, b, c, d] = corners;
        let x = |[a, b, c, d]: [DVec2; 4]| f64x4::new([a.x, b.x, c.x, d.x]);
        let y = |[a, b, c, d]: [DVec2; 4]| f64x4::new([a.y, b.y, c.y, d.y]);
        let ends = [b, c, d, a];
        let (from_x, to_x, from_y, to_y) = (x(corners), x(ends), y(corners), y(ends));
        let slope = (to_x - from_x) / (to_y - from_y);
        // Sides along a row have none, and are not in it.
        let is_steep = slope.abs().simd_lt(f64x4::splat(1e100));
        let near = |x: f64x4| {
            x.fast_max(f64x4::splat(-FARTHEST))
                .fast_min(f64x4::splat(FARTHEST))
        };
        Self {
            from_y,
            to_y,
            from_x,
            slope: slope & is_steep,
            low: near(from_x.fast_min(to_x)),
            high: near(from_x.fast_max(to_x)),
        }
    }

    /// What its sides cover of a row, and the interval of x in which they are.
    #[inline(always)]
    fn cut(&self, row: f64) -> ([SignedArea; 4], [f64; 2]) {
        let (top, bottom) = (f64x4::splat(row), f64x4::splat(row + 1.0));
        let in_row = |y: f64x4| y.fast_max(top).fast_min(bottom);
        let x_at = |y: f64x4| {
            let x = self.from_x + (y - self.from_y) * self.slope;
            x.fast_max(self.low).fast_min(self.high)
        };
        let (from, to) = (in_row(self.from_y), in_row(self.to_y));
        let (a, b) = (x_at(from), x_at(to));
        let (left, right) = (a.fast_min(b), a.fast_max(b));
        let width = right - left;
        let is_wide = width.simd_gt(f64x4::splat(SignedArea::UPRIGHT));
        let per_2w = (f64x4::splat(0.5) / width) & is_wide;
        let height = from - to;
        let is_outside = height.simd_eq(f64x4::ZERO);
        let least = is_outside.bitselect(f64x4::splat(f64::INFINITY), left);
        let greatest = is_outside.bitselect(f64x4::splat(f64::NEG_INFINITY), right);
        let [left, right, per_2w, height] = [left, right, per_2w, height].map(f64x4::to_array);
        let areas = core::array::from_fn(|i| SignedArea {
            left: left[i],
            right: right[i],
            per_2w: narrow(per_2w[i]),
            height: narrow(height[i]),
        });
        (areas, [smallest(least), -smallest(-greatest)])
    }

    /// Covers its pixels of a row.
    #[inline(always)]
    pub fn cover(&self, target: &mut impl CoverageTarget, row: i32, columns: &Range<i32>) {
        let (areas, [low, high]) = self.cut(f64::from(row));
        let mut left = clamped(low.floor(), columns);
        let right = clamped(high.ceil(), columns);
        while left < right {
            let first = f64::from(left);
            let [a, b, c, d] = areas.map(|area| area.shares(first));
            let shares = ((a + b) + (c + d))
                .fast_max(f32x8::ZERO)
                .fast_min(f32x8::ONE)
                .to_array();
            let count = (left..right).len().min(LANES);
            target.cover(row, left, &shares[..count]);
            left = left.saturating_add(8);
        }
    }
}

/// The smallest of four numbers.
#[inline(always)]
fn smallest(numbers: f64x4) -> f64 {
    let [a, b, c, d] = numbers.to_array();
    let less = |a: f64, b: f64| if a < b { a } else { b };
    less(less(a, b), less(c, d))
}

#[expect(clippy::cast_possible_truncation, reason = "rounds to the nearest f32")]
#[inline(always)]
fn narrow(number: f64) -> f32 {
    number as f32
}
