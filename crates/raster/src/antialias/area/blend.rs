//! Coverage into pictures.

use super::{FillRule, Outline, Rasterizer, Spans};
use crate::target::rounded_byte;
use crate::{Image, Rgb};

/// What can be blended; colours in linear light.
pub trait Pixel: Copy {
    /// `self + share (value - self)`.
    #[must_use]
    fn blend(self, value: Self, share: f32) -> Self;

    /// Blends eight pixels at once; as [`blend`](Self::blend) one by one.
    #[inline(always)]
    fn blend_eight(pixels: &mut [Self; 8], value: Self, shares: &[f32; 8]) {
        for (pixel, &share) in pixels.iter_mut().zip(shares) {
            *pixel = pixel.blend(value, share);
        }
    }
}

impl Pixel for Rgb {
    #[inline]
    fn blend(self, value: Self, share: f32) -> Self {
        self + (value - self) * share
    }
}

impl Pixel for f32 {
    #[inline]
    fn blend(self, value: Self, share: f32) -> Self {
        self + (value - self) * share
    }
}

/// A mask of 256 levels, rounded to the nearest.
impl Pixel for u8 {
    #[inline(always)]
    fn blend(self, value: Self, share: f32) -> Self {
        let (from, to) = (f32::from(self), f32::from(value));
        rounded_byte(from + (to - from) * share)
    }
}

/// Blends one value into a picture wherever there is coverage.
#[derive(Debug)]
pub struct Blend<'a, P> {
    pixels: &'a mut [P],
    width: usize,
    first_row: usize,
    value: P,
    opacity: f32,
}

impl<'a, P: Pixel> Blend<'a, P> {
    /// Blends a value into rows of pixels of a width, of which the first one is row `first_row`; an opacity outside of
    /// [0, 1] is drawn to its ends, NaN counts as 0.
    pub fn new(
        pixels: &'a mut [P],
        width: usize,
        first_row: usize,
        value: P,
        opacity: f32,
    ) -> Self {
        Self {
            pixels,
            width,
            first_row,
            value,
            opacity: if opacity > 0.0 { opacity.min(1.0) } else { 0.0 },
        }
    }
}

impl<P: Pixel> Spans for Blend<'_, P> {
    #[inline]
    fn cells(&mut self, y: usize, x: usize, coverage: &[f32]) {
        let pixels = &mut self.pixels[(y - self.first_row) * self.width + x..][..coverage.len()];
        for (pixel, &coverage) in pixels.iter_mut().zip(coverage) {
            *pixel = pixel.blend(self.value, coverage * self.opacity);
        }
    }

    #[inline(always)]
    fn block(&mut self, y: usize, x: usize, coverage: &[f32; 8]) {
        let pixels = &mut self.pixels[(y - self.first_row) * self.width + x..];
        if let Some(pixels) = pixels.first_chunk_mut() {
            let shares = coverage.map(|coverage| coverage * self.opacity);
            P::blend_eight(pixels, self.value, &shares);
        }
    }

    #[inline]
    fn run(&mut self, y: usize, start: usize, end: usize, coverage: f32) {
        let pixels = &mut self.pixels[(y - self.first_row) * self.width..][start..end];
        let share = coverage * self.opacity;
        if share == 1.0 {
            fill(pixels, self.value);
        } else {
            for pixel in pixels {
                *pixel = pixel.blend(self.value, share);
            }
        }
    }
}

/// Eight pixels at a time are three whole vectors of colours.
fn fill<P: Copy>(pixels: &mut [P], value: P) {
    let (blocks, rest) = pixels.as_chunks_mut::<8>();
    blocks.fill([value; 8]);
    rest.fill(value);
}

/// The coverage of an outline in each pixel, in [0, 1].
pub fn mask(outline: &Outline, rule: FillRule, (width, height): (usize, usize)) -> Image<f32> {
    let mut image = Image::filled(width, height, 0.0);
    Rasterizer::new(width, height).fill(outline, rule, &mut image, 1.0, 1.0);
    image
}

/// The coverage of an outline in each pixel, in 256 levels.
pub fn mask8(outline: &Outline, rule: FillRule, (width, height): (usize, usize)) -> Image<u8> {
    let mut image = Image::filled(width, height, 0);
    Rasterizer::new(width, height).fill(outline, rule, &mut image, 255, 1.0);
    image
}
