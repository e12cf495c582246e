//! Lines from pixel to pixel: the three classic ways, fast, dashed and antialiased.
//!
//! A line runs from the centre of one pixel to the centre of another. Along its *major* axis, the one on which it is
//! longer (x if both are equal), it has one pixel in each column (or row, if it is *steep*); across that axis the pixel
//! is the one nearest to the true line. Where two are equally near, all three ways take the one with the larger
//! coordinate: `floor(y + 1/2)`. The rule knows nothing of where a line starts, so both directions draw the same pixels.
//!
//! | way | a pixel costs | across the line |
//! |---|---|---|
//! | [`Equation`] | a multiplication, an addition, rounding | `y = m x + b` in f64 |
//! | [`Dda`] | an addition, rounding | `y += m` in fixed point |
//! | [`Bresenham`] | a comparison, one or two additions | an integer error term, exact |
//!
//! Each is an iterator of [`Step`]s that tells with each pixel the true point and the term it decides by, for lessons
//! and for tests. [`draw_line`] draws Bresenham's pixels fast, [`draw_dashed_line`] those of dashes, and
//! [`antialiased`] covers pixels by the exact area of a line of any width.
//!
//! All of them clip before they step: any coordinates of 32 bits can be given, no time is spent outside of the window,
//! and the pixels inside are those of the whole line.
//!
//! # Current state
//! [`Equation`] and [`Dda`] differ from [`Bresenham`] only where the true line passes exactly between two pixels and
//! rounding takes the other one. Nothing here panics or overflows.

pub mod antialiased;
mod bresenham;
mod dashed;
mod dda;
mod equation;
mod walk;

pub use bresenham::{Bresenham, draw_line};
pub use dashed::{DashError, Dashes, draw_dashed_line};
pub use dda::Dda;
pub use equation::Equation;

use glam::{DVec2, IVec2};

/// A pixel of a line with how it was found. `E` is the kind of number that a way decides by.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Step<E> {
    /// The pixel.
    pub pixel: IVec2,
    /// The point of the true line in this column (in this row, if the line is steep); pixel centres are whole numbers.
    pub ideal: DVec2,
    /// What the way decides by; each says what it is.
    pub error: E,
}
