//! A line by its equation: `y = m x + b`, evaluated for each column.

use super::Step;
use super::walk::Walk;
use crate::target::Window;
use core::ops::Range;
use glam::IVec2;

/// Evaluates `y = m x + b` in each column and rounds; a steep line evaluates `x = m y + b` in each row.
///
/// The term of a [`Step`] is the true coordinate less that of the pixel, between -1/2 and 1/2.
///
/// Computed in f64, with an error below 2^-20 of a pixel for any coordinates. A pixel so differs from that of
/// [`Bresenham`](super::Bresenham) only where the true line passes exactly between two.
///
/// ```
/// use glam::IVec2;
/// use hemicube_raster::line::Equation;
///
/// let rows: Vec<i32> = Equation::new(IVec2::ZERO, IVec2::new(4, 2)).map(|s| s.pixel.y).collect();
/// assert_eq!(rows, [0, 1, 1, 2, 2]);
/// ```
#[derive(Debug, Clone)]
pub struct Equation {
    walk: Walk,
    m: f64,
    b: f64,
    steps: Range<i64>,
}

impl Equation {
    /// The whole line, both ends included.
    pub fn new(from: IVec2, to: IVec2) -> Self {
        let walk = Walk::new(from, to);
        let m = walk.along_step as f64 * walk.slope();
        let [x, y] = walk.start();
        Self {
            walk,
            m,
            b: y as f64 - m * x as f64,
            steps: 0..walk.length + 1,
        }
    }

    /// Its pixels in a window.
    pub fn within(from: IVec2, to: IVec2, window: &Window) -> Self {
        let mut line = Self::new(from, to);
        let start = line.walk.start()[1];
        let across_step = line.walk.across_step;
        let across = |step| across_step * (line.y(step).1 - start);
        line.steps = line.walk.visible(window, across);
        line
    }

    /// The true coordinate across the line after so many steps, and the nearest pixel's.
    #[expect(clippy::cast_possible_truncation, reason = "between both ends")]
    fn y(&self, step: i64) -> (f64, i64) {
        let x = self.walk.along_at(step) as f64;
        let y = self.m * x + self.b;
        (y, (y + 0.5).floor() as i64)
    }
}

impl Iterator for Equation {
    type Item = Step<f64>;

    fn next(&mut self) -> Option<Step<f64>> {
        let step = self.steps.next()?;
        let (y, pixel) = self.y(step);
        Some(Step {
            pixel: self.walk.pixel(step, pixel),
            ideal: self.walk.ideal(step),
            error: y - pixel as f64,
        })
    }
}
