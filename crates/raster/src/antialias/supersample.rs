//! From a fine grid of samples to pixels, row by row.

use super::Antialiasing;
use crate::Image;
use core::ops::{AddAssign, Mul, Range};
use rayon::prelude::*;

/// What can be filtered: [`Rgb`](crate::Rgb), `f32`, or any other sum of values.
pub trait Value: Copy + Default + Send + Sync + AddAssign + Mul<f32, Output = Self> {}

impl<V: Copy + Default + Send + Sync + AddAssign + Mul<f32, Output = Self>> Value for V {}

/// The grid of samples of an image, and how they become pixels.
///
/// With `k` samples per pixel and a filter of `n` taps the grid has `k (width - 1) + n` columns: pixel `p` is the weighted
/// sum of the columns `k p .. k p + n`, whose middle is the pixel's centre. Filters wider than a pixel share samples
/// with their neighbours, and the outermost samples lie outside of the image, so that borders need no exception.
/// Rows likewise.
///
/// A pixel is summed in one order, first along rows, then down: bands of rows may be cut anywhere and made by any thread.
#[derive(Debug, Clone, PartialEq)]
pub struct Supersampler {
    width: usize,
    height: usize,
    antialiasing: Antialiasing,
    weights: Vec<f32>,
}

/// Rows of pixels that a thread makes at a time: the rows of samples that two bands share stay a small part.
const BAND: usize = 16;

impl Supersampler {
    /// The grid of an image of so many pixels across and down.
    pub fn new(width: usize, height: usize, antialiasing: Antialiasing) -> Self {
        let weights = antialiasing.filter.weights(antialiasing.factor);
        #[expect(clippy::cast_possible_truncation, reason = "weights of f32 samples")]
        let weights = weights.iter().map(|&w| w as f32).collect();
        Self {
            width,
            height,
            antialiasing,
            weights,
        }
    }

    /// Width and height of the image in pixels.
    pub fn size(&self) -> (usize, usize) {
        (self.width, self.height)
    }

    /// Samples per pixel in each direction.
    pub fn factor(&self) -> usize {
        self.antialiasing.factor.get()
    }

    /// Weights of the samples of a pixel in one direction, of sum 1.
    pub fn weights(&self) -> &[f32] {
        &self.weights
    }

    /// Columns of the grid.
    pub fn columns(&self) -> usize {
        self.range(0..self.width).end
    }

    /// The grid's rows that rows of pixels need; bands of pixels that touch share some.
    pub fn rows(&self, pixels: Range<usize>) -> Range<usize> {
        self.range(pixels)
    }

    /// The samples of one direction that pixels of it need; none if there are no pixels.
    fn range(&self, pixels: Range<usize>) -> Range<usize> {
        let start = self.factor() * pixels.start;
        match pixels.is_empty() {
            true => start..start,
            false => start..self.factor() * (pixels.end - 1) + self.weights.len(),
        }
    }

    /// Where the grid's first sample lies without jitter, in x and in y, in pixels; the next ones follow at distances
    /// of [`Self::spacing`].
    pub fn origin(&self) -> f64 {
        0.5 - (self.weights.len() - 1) as f64 / 2.0 * self.spacing()
    }

    /// Distance of two samples in pixels.
    pub fn spacing(&self) -> f64 {
        1.0 / self.factor() as f64
    }

    /// Where the sample of a column and a row of the grid lies, in pixels.
    pub fn position(&self, column: usize, row: usize) -> [f64; 2] {
        let [dx, dy] = self.antialiasing.pattern.offset(column, row);
        let at = |index: usize| self.origin() + index as f64 * self.spacing();
        [at(column) + dx, at(row) + dy]
    }

    /// Makes rows of pixels of their samples: all rows [`Self::rows`] of the grid, one after the other.
    ///
    /// Panics if `samples` or `out` does not have as many values as there are in these rows.
    pub fn resolve<V: Value>(&self, pixels: Range<usize>, samples: &[V], out: &mut [V]) {
        let first = self.rows(pixels.clone()).start;
        let columns = self.columns();
        let expected = self.rows(pixels.clone()).len() * columns;
        assert_eq!(samples.len(), expected, "samples of the rows {pixels:?}");
        self.stream(pixels, out, |row, line| {
            line.copy_from_slice(&samples[(row - first) * columns..][..columns]);
        });
    }

    /// Makes rows of pixels of a function of position in pixels; keeps few rows of samples at a time.
    ///
    /// Panics if `out` does not have as many values as there are pixels in these rows.
    pub fn sample<V: Value>(
        &self,
        pixels: Range<usize>,
        out: &mut [V],
        mut value: impl FnMut(f64, f64) -> V,
    ) {
        self.stream(pixels, out, |row, line| {
            for (column, sample) in line.iter_mut().enumerate() {
                let [x, y] = self.position(column, row);
                *sample = value(x, y);
            }
        });
    }

    /// The whole image of a function of position in pixels, made by all threads.
    pub fn render<V: Value>(&self, value: impl Fn(f64, f64) -> V + Sync) -> Image<V> {
        let mut image = Image::filled(self.width, self.height, V::default());
        let bands = image.pixels_mut().par_chunks_mut(BAND * self.width.max(1));
        bands.enumerate().for_each(|(band, out)| {
            let rows = BAND * band..(BAND * (band + 1)).min(self.height);
            self.sample(rows, out, &value);
        });
        image
    }

    /// Asks for each row of samples once, from top to bottom, and keeps those filtered along x until the last row of
    /// pixels that needs them is done.
    fn stream<V: Value>(
        &self,
        pixels: Range<usize>,
        out: &mut [V],
        mut samples: impl FnMut(usize, &mut [V]),
    ) {
        let (width, taps) = (self.width, self.weights.len());
        assert_eq!(
            out.len(),
            pixels.len() * width,
            "pixels of the rows {pixels:?}"
        );
        if out.is_empty() {
            return;
        }
        let mut line = vec![V::default(); self.columns()];
        let mut filtered = vec![V::default(); taps * width];
        let mut next = self.factor() * pixels.start;
        for (pixel_row, out) in pixels.zip(out.chunks_exact_mut(width)) {
            let rows = self.rows(pixel_row..pixel_row + 1);
            for row in next..rows.end {
                samples(row, &mut line);
                self.filter_along(&line, &mut filtered[(row % taps) * width..][..width]);
            }
            next = next.max(rows.end);
            out.fill(V::default());
            for (row, &weight) in rows.zip(&self.weights) {
                let line = &filtered[(row % taps) * width..][..width];
                add_scaled(out, line, weight);
            }
        }
    }

    /// Filters a row of samples along x.
    fn filter_along<V: Value>(&self, samples: &[V], out: &mut [V]) {
        for (pixel, out) in out.iter_mut().enumerate() {
            let taps = &samples[pixel * self.factor()..][..self.weights.len()];
            let mut sum = V::default();
            for (&value, &weight) in taps.iter().zip(&self.weights) {
                sum += value * weight;
            }
            *out = sum;
        }
    }
}

fn add_scaled<V: Value>(out: &mut [V], line: &[V], weight: f32) {
    for (out, &value) in out.iter_mut().zip(line) {
        *out += value * weight;
    }
}
