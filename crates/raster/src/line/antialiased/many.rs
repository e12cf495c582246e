//! Many lines into one picture.

use super::draw_line;
use crate::Image;
use crate::target::{Blend, CoverageTarget, Window};
use glam::DVec2;
use rayon::prelude::*;

/// A line with what it is drawn with.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Line<P> {
    /// One end.
    pub from: DVec2,
    /// The other end.
    pub to: DVec2,
    /// Width in pixels.
    pub width: f64,
    /// What covered pixels become.
    pub pixel: P,
}

/// Bytes of a picture that are drawn to at a time: they stay in a core's cache from one line to the next.
const BAND_BYTES: usize = 1 << 18;

/// Draws lines one over the other, the first one lowest, as [`draw_line`] does but for rounding; made by all threads, the
/// same bits on any number of them.
///
/// The picture is drawn in bands of rows. Also on one thread this is faster than [`draw_line`] for each line, as soon as
/// the picture is larger than a cache. Next to the picture it takes a copy of each line for each band
/// that it meets.
///
/// ```
/// use glam::DVec2;
/// use hemicube_raster::line::antialiased::{Line, draw_lines};
/// use hemicube_raster::{Image, Rgb};
///
/// let mut image = Image::filled(64, 64, Rgb::BLACK);
/// let line = |x: f64| Line {
///     from: DVec2::new(x, 8.0),
///     to: DVec2::new(64.0 - x, 56.0),
///     width: 1.5,
///     pixel: Rgb::WHITE,
/// };
/// draw_lines(&mut image, &[10.0, 20.0, 30.0].map(line));
/// let light: f32 = image.pixels().iter().map(|pixel| pixel.g).sum();
/// assert!((225.0..250.0).contains(&light), "{light}");
/// ```
pub fn draw_lines<P: Blend + Send + Sync>(image: &mut Image<P>, lines: &[Line<P>]) {
    let window = Window::of(image);
    if window.is_empty() {
        return;
    }
    let width = image.width();
    let rows = (BAND_BYTES / (width * size_of::<P>()).max(1)).max(8);
    let bands = sorted_into_bands(lines, &window, rows);
    let pixels = image.pixels_mut().par_chunks_mut(rows * width);
    pixels
        .zip(bands)
        .for_each_init(Vec::new, |near, (pixels, band)| {
            // Memory that was read in a row and is used again is faster than pixels here and there of a large picture.
            near.clear();
            near.extend_from_slice(pixels);
            for line in &band.lines {
                let mut pen = BandPen {
                    window: band.window,
                    width,
                    pixels: near,
                    pixel: line.pixel,
                };
                draw_line(&mut pen, line.from, line.to, line.width);
            }
            pixels.copy_from_slice(near);
        });
}

/// Rows of a picture and the lines that may meet them, copied so that they lie in the order in which they are drawn.
struct Band<P> {
    window: Window,
    lines: Vec<Line<P>>,
}

/// What draws into the rows of a band.
struct BandPen<'a, P> {
    window: Window,
    width: usize,
    pixels: &'a mut [P],
    pixel: P,
}

impl<P: Blend> CoverageTarget for BandPen<'_, P> {
    #[inline(always)]
    fn window(&self) -> Window {
        self.window
    }

    #[inline(always)]
    fn cover(&mut self, row: i32, left: i32, shares: &[f32]) {
        let start = offset(row - self.window.top) * self.width + offset(left);
        let pixels = &mut self.pixels[start..start + shares.len()];
        for (pixel, &share) in pixels.iter_mut().zip(shares) {
            *pixel = pixel.blend(self.pixel, share);
        }
    }
}

fn sorted_into_bands<P: Copy>(lines: &[Line<P>], window: &Window, rows: usize) -> Vec<Band<P>> {
    let height = offset(window.bottom);
    let row = |row: usize| i32::try_from(row).unwrap_or(i32::MAX);
    let band = |first: usize| Band {
        window: Window {
            top: row(first),
            bottom: row(height.min(first + rows)),
            ..*window
        },
        lines: Vec::new(),
    };
    let mut bands: Vec<Band<P>> = (0..height).step_by(rows).map(band).collect();
    for line in lines {
        let reach = 0.5 * line.width.max(0.0);
        let top = line.from.y.min(line.to.y) - reach;
        let bottom = line.from.y.max(line.to.y) + reach;
        let first = met(top, height) / rows;
        let end = met(bottom.ceil(), height).div_ceil(rows);
        for band in &mut bands[first..end.max(first)] {
            band.lines.push(*line);
        }
    }
    bands
}

/// A row that is not below a y, or the number of rows; NaN is 0.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "casts of floats saturate"
)]
fn met(y: f64, height: usize) -> usize {
    (y as usize).min(height)
}

#[expect(clippy::cast_sign_loss, reason = "a row or column of a picture")]
#[inline(always)]
fn offset(number: i32) -> usize {
    number as usize
}
