//! What a straight piece of an edge has to its right in eight pixels of a row at once.
//!
//! A piece of height h that runs from x = l to r covers, of the pixel from x to x + 1, what is to its right:
//! ```text
//! h (o (p + q - 2 l) / (2 (r - l)) + clamp(x + 1 - r, 0, 1)),    p = max(x, l), q = min(x + 1, r), o = max(q - p, 0)
//! ```
//! The first term is the triangle or trapezoid under the part of the piece that is in the pixel, the second one what lies
//! behind the piece. All numbers are small, or relative to the piece's left end, so nothing cancels. With signed heights
//! (positive where an area begins, negative where it ends) the sum over the pieces of an outline is the area that it has
//! in each pixel, by Green's theorem; the rasterisers of fonts go the same way pixel by pixel.

use wide::f32x8;

/// Pixels at once.
pub(crate) const LANES: usize = 8;

/// A piece of an edge in a row, with a sign.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SignedArea {
    /// x of its ends.
    pub left: f64,
    pub right: f64,
    /// `1 / (2 (right - left))`; 0 of a piece that is upright, or so nearly that it does not matter.
    pub per_2w: f32,
    /// Share of the row's height that it spans; positive where the area begins, negative where it ends.
    pub height: f32,
}

/// The pixels' left and right sides.
const LEFT_SIDES: f32x8 = f32x8::new([0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0]);
const RIGHT_SIDES: f32x8 = f32x8::new([1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0]);

impl SignedArea {
    /// Nothing.
    pub const ZERO: Self = Self {
        left: 0.0,
        right: 0.0,
        per_2w: 0.0,
        height: 0.0,
    };

    /// Pieces of a smaller width are upright: less is a matter of rounding, as x has an error of some 1e-7 within a block.
    pub const UPRIGHT: f64 = 1e-6;

    /// What [`Self::per_2w`] is for a width.
    #[inline(always)]
    pub fn per_twice(width: f64) -> f32 {
        if width > Self::UPRIGHT {
            narrow(0.5 / width)
        } else {
            0.0
        }
    }

    /// Between two x, in any order.
    #[inline(always)]
    pub fn new([a, b]: [f64; 2], height: f32) -> Self {
        // Comparisons, as `max` and `min` take longer for the sake of NaN.
        let (left, right) = if a < b { (a, b) } else { (b, a) };
        Self {
            left,
            right,
            per_2w: Self::per_twice(right - left),
            height,
        }
    }

    /// Its shares of eight pixels, of which the first one begins at x = `first`.
    #[inline(always)]
    pub fn shares(&self, first: f64) -> f32x8 {
        let [left, right] = [self.left - first, self.right - first].map(narrow);
        let (l, r) = (f32x8::splat(left), f32x8::splat(right));
        let (p, q) = (l.fast_max(LEFT_SIDES), r.fast_min(RIGHT_SIDES));
        let under = (q - p).fast_max(f32x8::ZERO) * (p + q - (l + l)) * self.per_2w;
        let behind = (RIGHT_SIDES - r).fast_max(f32x8::ZERO).fast_min(f32x8::ONE);
        (under + behind) * self.height
    }
}

#[expect(clippy::cast_possible_truncation, reason = "rounds to the nearest f32")]
#[inline(always)]
fn narrow(number: f64) -> f32 {
    number as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The area to the right of a piece in the pixel from x on: the mean of `clamp(x + 1 - t, 0, 1)` over its t, in
    /// double precision.
    fn by_integral(left: f64, right: f64, x: f64) -> f64 {
        let integral = |u: f64| 0.5 * u.clamp(0.0, 1.0).powi(2) + (u - 1.0).max(0.0);
        if left == right {
            return (x + 1.0 - left).clamp(0.0, 1.0);
        }
        (integral(x + 1.0 - left) - integral(x + 1.0 - right)) / (right - left)
    }

    #[test]
    fn shares_are_the_area_to_the_right() {
        for (left, right) in [
            (100.0, 100.0),
            (100.25, 100.25),
            (103.0, 104.0),
            (101.3, 101.300_001),
            (102.9, 103.2),
            (99.5, 104.75),
            (-700.0, 1300.5),
            (107.999, 108.5),
            (90.0, 95.0),
            (120.0, 125.0),
        ] {
            for ends in [[left, right], [right, left]] {
                let shares = SignedArea::new(ends, -0.5).shares(100.0).to_array();
                for (x, share) in (100..).zip(shares) {
                    let expected = -0.5 * by_integral(left, right, f64::from(x));
                    let off = (f64::from(share) - expected).abs();
                    assert!(off < 5e-7, "{ends:?}, {x}: {share} for {expected}");
                }
            }
        }
    }
}
