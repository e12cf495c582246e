//! The digital differential analyser: from column to column, y grows by the slope.

use super::Step;
use super::walk::Walk;
use crate::target::Window;
use core::ops::Range;
use glam::IVec2;

/// Adds the slope for each column and rounds: `y += m`. A steep line swaps the roles of x and y: with y as the major
/// axis the slope is at most 1 again, and no row is left out.
///
/// The term of a [`Step`] is the true coordinate less that of the pixel, between -1/2 and 1/2, as the sums have it.
///
/// Sums are in fixed point with 64 bits behind the point, as the analysers of hardware had them, not in floating point:
/// so `n` additions are one multiplication by `n`, exactly, and a line that is clipped has the pixels of the whole. The
/// slope is off by up to 2^-65, a sum after the longest line by less than 2^-32 of a pixel. A pixel differs from that of
/// [`Bresenham`](super::Bresenham) only where the true line passes exactly between two.
#[derive(Debug, Clone)]
pub struct Dda {
    walk: Walk,
    /// Change across for each step.
    slope: i128,
    steps: Range<i64>,
    /// Coordinate across at the next step.
    y: i128,
}

/// Bits behind the point.
const FRACTION_BITS: u32 = 64;

const HALF: i128 = 1 << (FRACTION_BITS - 1);

impl Dda {
    /// The whole line, both ends included.
    pub fn new(from: IVec2, to: IVec2) -> Self {
        Self::from_walk(Walk::new(from, to))
    }

    /// Its pixels in a window.
    pub fn within(from: IVec2, to: IVec2, window: &Window) -> Self {
        Self::new(from, to).clipped(window)
    }

    /// What the textbook warns of: x is the major axis of all lines. A steep one has one pixel for each column and
    /// gaps between them, a vertical one its first pixel only.
    pub fn along_x(from: IVec2, to: IVec2) -> Self {
        Self::from_walk(Walk::along(from, to, false))
    }

    fn from_walk(walk: Walk) -> Self {
        let rise = i128::from(walk.across_step * walk.rise) << FRACTION_BITS;
        let length = i128::from(walk.length.max(1));
        Self {
            walk,
            slope: (2 * rise + length).div_euclid(2 * length),
            steps: 0..walk.length + 1,
            y: i128::from(walk.start()[1]) << FRACTION_BITS,
        }
    }

    fn clipped(mut self, window: &Window) -> Self {
        let start = self.walk.start()[1];
        let across_step = self.walk.across_step;
        let across = |step| across_step * (nearest(self.y + self.slope * i128::from(step)) - start);
        self.steps = self.walk.visible(window, across);
        self.y += self.slope * i128::from(self.steps.start);
        self
    }
}

/// The whole number next to one in fixed point, halves up.
fn nearest(y: i128) -> i64 {
    ((y + HALF) >> FRACTION_BITS) as i64
}

impl Iterator for Dda {
    type Item = Step<f64>;

    fn next(&mut self) -> Option<Step<f64>> {
        let step = self.steps.next()?;
        let pixel = nearest(self.y);
        let off = self.y - (i128::from(pixel) << FRACTION_BITS);
        self.y += self.slope;
        Some(Step {
            pixel: self.walk.pixel(step, pixel),
            ideal: self.walk.ideal(step),
            error: off as f64 / (2 * HALF) as f64,
        })
    }
}
