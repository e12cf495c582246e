//! What can be drawn on: a window of pixels that are set by runs, one by one, or by how much of them is covered.
//!
//! Every way of scan conversion here hands its pixels to a [`Target`], the antialiased ones to a [`CoverageTarget`], and
//! clips to the target's [`Window`] itself, before it steps. So a picture of any pixel type can be drawn into, and so
//! can what is no picture at all: a window with a closure is a target too.
//!
//! ```
//! use glam::IVec2;
//! use hemicube_raster::line::draw_line;
//! use hemicube_raster::target::Window;
//! use hemicube_raster::{Image, Rgb};
//!
//! let mut image = Image::filled(8, 4, Rgb::BLACK);
//! draw_line(&mut image.pen(Rgb::WHITE), IVec2::new(-5, 1), IVec2::new(i32::MAX, 1));
//! assert_eq!(image.pixels().iter().filter(|&&p| p == Rgb::WHITE).count(), 8);
//!
//! // The number of pixels of a line, without a picture.
//! let mut count = 0;
//! let mut counter = (Window::new(0..100, 0..100), |_, x: core::ops::Range<i32>| count += x.len());
//! draw_line(&mut counter, IVec2::new(3, 0), IVec2::new(8, 99));
//! assert_eq!(count, 100);
//! ```

mod queue;

pub(crate) use queue::{CoverageQueue, LANES};

use crate::color::Rgb;
use crate::image::Image;
use core::ops::Range;
use glam::IVec2;

/// The pixels that can be drawn to: columns `left..right` of the rows `top..bottom`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Window {
    /// First column.
    pub left: i32,
    /// First row.
    pub top: i32,
    /// Column behind the last one.
    pub right: i32,
    /// Row behind the last one.
    pub bottom: i32,
}

impl Window {
    /// A window of columns and rows; empty if one of the ranges is.
    pub const fn new(columns: Range<i32>, rows: Range<i32>) -> Self {
        Self {
            left: columns.start,
            top: rows.start,
            right: columns.end,
            bottom: rows.end,
        }
    }

    /// All pixels of a picture; of a side above 2^31 - 1 the first ones.
    pub fn of<P>(image: &Image<P>) -> Self {
        let side = |pixels: usize| i32::try_from(pixels).unwrap_or(i32::MAX);
        Self::new(0..side(image.width()), 0..side(image.height()))
    }

    /// Whether there is no pixel in it.
    pub const fn is_empty(&self) -> bool {
        self.left >= self.right || self.top >= self.bottom
    }

    /// Whether a pixel is in it.
    pub const fn contains(&self, pixel: IVec2) -> bool {
        self.left <= pixel.x && pixel.x < self.right && self.top <= pixel.y && pixel.y < self.bottom
    }

    /// Whether all pixels of two ranges of columns and rows are in it.
    pub(crate) fn contains_box(&self, columns: Range<i64>, rows: Range<i64>) -> bool {
        i64::from(self.left) <= columns.start
            && columns.end <= i64::from(self.right)
            && i64::from(self.top) <= rows.start
            && rows.end <= i64::from(self.bottom)
    }

    /// The columns of a range that are in it.
    pub(crate) fn columns_in(&self, columns: Range<i64>) -> Range<i32> {
        narrow(columns.start, self.left, self.right)..narrow(columns.end, self.left, self.right)
    }
}

/// A number moved between two others, of which the first is not above the second.
#[expect(
    clippy::cast_possible_truncation,
    reason = "between two 32-bit numbers"
)]
fn narrow(number: i64, low: i32, high: i32) -> i32 {
    number.max(i64::from(low)).min(i64::from(high)) as i32
}

/// Pixels that can be set.
pub trait Target {
    /// The pixels that exist. Nobody passes others to the methods below.
    fn window(&self) -> Window;

    /// Sets the pixels of a row; they are not empty.
    fn span(&mut self, row: i32, columns: Range<i32>);

    /// Sets one pixel.
    #[inline(always)]
    fn pixel(&mut self, x: i32, y: i32) {
        self.span(y, x..x + 1);
    }
}

/// Pixels of which parts can be covered.
pub trait CoverageTarget {
    /// The pixels that exist. Nobody passes others to the method below.
    fn window(&self) -> Window;

    /// Covers pixels of a row from column `left` on, each by its share in [0, 1].
    fn cover(&mut self, row: i32, left: i32, shares: &[f32]);

    /// Covers pixels of a row as a whole; as [`cover`](Self::cover) with shares of 1 unless a target is faster at it.
    fn cover_whole(&mut self, row: i32, columns: Range<i32>) {
        const WHOLE: [f32; 64] = [1.0; 64];
        let mut left = columns.start;
        while left < columns.end {
            let count = (left..columns.end).len().min(WHOLE.len());
            self.cover(row, left, &WHOLE[..count]);
            left = left.saturating_add(64);
        }
    }
}

impl<F: FnMut(i32, Range<i32>)> Target for (Window, F) {
    fn window(&self) -> Window {
        self.0
    }

    #[inline(always)]
    fn span(&mut self, row: i32, columns: Range<i32>) {
        self.1(row, columns);
    }
}

impl<F: FnMut(i32, i32, &[f32])> CoverageTarget for (Window, F) {
    fn window(&self) -> Window {
        self.0
    }

    #[inline(always)]
    fn cover(&mut self, row: i32, left: i32, shares: &[f32]) {
        self.1(row, left, shares);
    }
}

/// Pixels that can be mixed. Coverage is a share of light, so the numbers must be linear light; bytes are masks or other
/// shares of 256 levels, rounded to the nearest.
pub trait Blend: Copy {
    /// `self + share (over - self)`.
    #[must_use]
    fn blend(self, over: Self, share: f32) -> Self;
}

impl Blend for f32 {
    #[inline(always)]
    fn blend(self, over: Self, share: f32) -> Self {
        self + share * (over - self)
    }
}

impl Blend for Rgb {
    #[inline(always)]
    fn blend(self, over: Self, share: f32) -> Self {
        Self::new(
            self.r.blend(over.r, share),
            self.g.blend(over.g, share),
            self.b.blend(over.b, share),
        )
    }
}

impl Blend for u8 {
    #[inline(always)]
    fn blend(self, over: Self, share: f32) -> Self {
        let (from, to) = (f32::from(self), f32::from(over));
        rounded_byte(from + share * (to - from))
    }
}

/// The whole number next to one in [0, 255]. From 2^23 on floats have no fraction, so that their last byte is the number;
/// vectors have no instruction for a cast that saturates.
#[inline(always)]
pub(crate) fn rounded_byte(number: f32) -> u8 {
    (number + 8_388_608.0).to_bits().to_le_bytes()[0]
}

impl<const N: usize> Blend for [u8; N] {
    #[inline(always)]
    fn blend(self, over: Self, share: f32) -> Self {
        std::array::from_fn(|k| self[k].blend(over[k], share))
    }
}

impl<const N: usize> Blend for [f32; N] {
    #[inline(always)]
    fn blend(self, over: Self, share: f32) -> Self {
        std::array::from_fn(|k| self[k].blend(over[k], share))
    }
}

/// A picture with what is drawn into it: each pixel that is set becomes `pixel`, and one that is covered in part is
/// mixed with it.
#[derive(Debug)]
pub struct Pen<'a, P> {
    window: Window,
    width: usize,
    pixels: &'a mut [P],
    pixel: P,
}

impl<P> Image<P> {
    /// What draws into this picture with one pixel value.
    pub fn pen(&mut self, pixel: P) -> Pen<'_, P> {
        Pen {
            window: Window::of(self),
            width: self.width(),
            pixels: self.pixels_mut(),
            pixel,
        }
    }
}

impl<P> Pen<'_, P> {
    /// The same pen that draws to a part of the picture only.
    #[must_use]
    pub fn within(mut self, window: Window) -> Self {
        self.window = Window {
            left: self.window.left.max(window.left),
            top: self.window.top.max(window.top),
            right: self.window.right.min(window.right),
            bottom: self.window.bottom.min(window.bottom),
        };
        self
    }

    #[inline(always)]
    fn index(&self, x: i32, y: i32) -> usize {
        debug_assert!(
            self.window.contains(IVec2::new(x, y)),
            "pixel ({x}, {y}) is not in {:?}",
            self.window
        );
        index(y) * self.width + index(x)
    }
}

#[expect(clippy::cast_sign_loss, reason = "a row or column of a picture")]
#[inline(always)]
fn index(number: i32) -> usize {
    number as usize
}

impl<P: Copy> Target for Pen<'_, P> {
    #[inline(always)]
    fn window(&self) -> Window {
        self.window
    }

    #[inline(always)]
    fn span(&mut self, row: i32, columns: Range<i32>) {
        let start = self.index(columns.start, row);
        self.pixels[start..start + columns.len()].fill(self.pixel);
    }

    #[inline(always)]
    fn pixel(&mut self, x: i32, y: i32) {
        let index = self.index(x, y);
        self.pixels[index] = self.pixel;
    }
}

impl<P: Blend> CoverageTarget for Pen<'_, P> {
    #[inline(always)]
    fn window(&self) -> Window {
        self.window
    }

    #[inline(always)]
    fn cover(&mut self, row: i32, left: i32, shares: &[f32]) {
        let start = self.index(left, row);
        let pixels = &mut self.pixels[start..start + shares.len()];
        for (pixel, &share) in pixels.iter_mut().zip(shares) {
            *pixel = pixel.blend(self.pixel, share);
        }
    }
    #[inline(always)]
    fn cover_whole(&mut self, row: i32, columns: Range<i32>) {
        self.span(row, columns);
    }
}
