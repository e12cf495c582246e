//! Pictures of drawings: pixels in sRGB, with letters as pixels of their own.

use super::drawing::{Anchor, DASH, Drawing, Shape};
use core::ops::Range;
use hemicube_raster::color::{linear_from_srgb8_table, srgb8_from_linear};
use hemicube_raster::image::ImageError;
use hemicube_raster::{Image, Rgb};
use noto_sans_mono_bitmap::{FontWeight, RasterHeight, get_raster, get_raster_width};
use std::io::Cursor;

/// A picture to draw on, white at first.
#[derive(Debug, Clone)]
pub struct Canvas {
    width: usize,
    height: usize,
    pixels: Vec<[u8; 3]>,
}

/// The letters for a height in pixels: there are two sizes.
fn raster_height(size: u32) -> RasterHeight {
    if size >= 20 {
        RasterHeight::Size20
    } else {
        RasterHeight::Size16
    }
}

/// Width of all letters of a height in pixels.
pub(super) fn glyph_width(size: u32) -> usize {
    get_raster_width(FontWeight::Regular, raster_height(size))
}

impl Canvas {
    /// White, of so many pixels.
    pub fn new(width: usize, height: usize) -> Self {
        Self {
            width,
            height,
            pixels: vec![[255; 3]; width * height],
        }
    }

    /// Draws a drawing with its upper left corner at a pixel.
    pub fn draw(&mut self, drawing: &Drawing, left: usize, top: usize) {
        let offset = [left as f64, top as f64];
        for shape in &drawing.shapes {
            match shape {
                Shape::Path {
                    points,
                    color,
                    width,
                    dashed,
                } => {
                    let points: Vec<[f64; 2]> = points
                        .iter()
                        .map(|[x, y]| [x + offset[0], y + offset[1]])
                        .collect();
                    let dash = dashed.then_some(DASH);
                    self.path(&points, *color, *width, dash);
                }
                Shape::Text {
                    at: [x, y],
                    text,
                    anchor,
                    size,
                    color,
                } => self.text([x + offset[0], y + offset[1]], text, *anchor, *size, *color),
            }
        }
    }

    /// Copies a picture of displayable light to a place.
    pub fn paste(&mut self, image: &Image<Rgb>, left: usize, top: usize) {
        for y in 0..image.height().min(self.height.saturating_sub(top)) {
            for x in 0..image.width().min(self.width.saturating_sub(left)) {
                let color = image.pixel(x, y).to_array().map(srgb8_from_linear);
                self.pixels[(top + y) * self.width + left + x] = color;
            }
        }
    }

    /// A line through points. Coverage is that of the nearest segment, so corners are not drawn twice.
    fn path(&mut self, points: &[[f64; 2]], color: [u8; 3], width: f64, dash: Option<f64>) {
        let range = |axis: usize, size: usize| {
            let along = points.iter().map(|p| p[axis]);
            covered(along, width, size)
        };
        // Only its surroundings are looked at: a drawing may have thousands of short lines.
        let mut coverage = Coverage::new(range(0, self.width), range(1, self.height));
        let mut gone = 0.0;
        for pair in points.windows(2) {
            coverage.add(pair[0], pair[1], width, dash, gone);
            gone += length(pair[0], pair[1]);
        }
        for (y, row) in coverage.rows() {
            let start = y * self.width + coverage.columns.start;
            for (pixel, &share) in self.pixels[start..].iter_mut().zip(row) {
                blend(pixel, color, share);
            }
        }
    }

    fn text(&mut self, at: [f64; 2], text: &str, anchor: Anchor, size: u32, color: [u8; 3]) {
        let advance = glyph_width(size) as f64;
        let length = advance * text.chars().count() as f64;
        let start = match anchor {
            Anchor::Start => 0.0,
            Anchor::Middle => length / 2.0,
            Anchor::End => length,
        };
        let mut left = (at[0] - start).round();
        for c in text.chars() {
            self.letter([left, at[1].round()], c, size, color);
            left += advance;
        }
    }

    fn letter(&mut self, at: [f64; 2], c: char, size: u32, color: [u8; 3]) {
        let raster = |c| get_raster(c, FontWeight::Regular, raster_height(size));
        let Some(glyph) = raster(c).or_else(|| raster('?')) else {
            return;
        };
        for (y, row) in glyph.rows().enumerate() {
            for (x, &intensity) in row.iter().enumerate() {
                let (x, y) = (at[0] + x as f64, at[1] + y as f64);
                let is_inside =
                    x >= 0.0 && y >= 0.0 && x < self.width as f64 && y < self.height as f64;
                if is_inside {
                    let i = clamped(y, self.height) * self.width + clamped(x, self.width);
                    blend(&mut self.pixels[i], color, f32::from(intensity) / 255.0);
                }
            }
        }
    }

    /// As a PNG file.
    pub fn png(&self) -> Result<Vec<u8>, ImageError> {
        let table = linear_from_srgb8_table();
        let color = |c: &[u8; 3]| Rgb::from(c.map(|code| table[code as usize]));
        let pixels = self.pixels.iter().map(color).collect();
        let image =
            Image::from_pixels(self.width, self.height, pixels).expect("one colour for each pixel");
        let mut file = Cursor::new(Vec::new());
        image.write_png(&mut file)?;
        Ok(file.into_inner())
    }
}

/// How much of each pixel of a part of a picture a line covers.
struct Coverage {
    columns: Range<usize>,
    rows: Range<usize>,
    shares: Vec<f32>,
}

impl Coverage {
    fn new(columns: Range<usize>, rows: Range<usize>) -> Self {
        let shares = vec![0.0; columns.len() * rows.len()];
        Self {
            columns,
            rows,
            shares,
        }
    }

    /// Each row with its number, if there are any pixels.
    fn rows(&self) -> impl Iterator<Item = (usize, &[f32])> {
        let rows = self.shares.chunks(self.columns.len().max(1));
        self.rows.clone().zip(rows)
    }

    /// Adds a segment; `gone` is the length of the path before it.
    fn add(&mut self, a: [f64; 2], b: [f64; 2], width: f64, dash: Option<f64>, gone: f64) {
        let length = length(a, b);
        let within = |range: &Range<usize>, axis: usize| {
            let near = covered([a[axis], b[axis]].into_iter(), width, range.end);
            near.start.max(range.start)..near.end
        };
        for y in within(&self.rows, 1) {
            for x in within(&self.columns, 0) {
                let p = [x as f64 + 0.5, y as f64 + 0.5];
                let (distance, along) = distance_to(p, a, b);
                let is_gap = dash.is_some_and(|d| ((gone + along * length) / d) % 2.0 >= 1.0);
                let share = (width / 2.0 + 0.5 - distance).clamp(0.0, 1.0);
                if !is_gap {
                    let i = (y - self.rows.start) * self.columns.len() + x - self.columns.start;
                    self.shares[i] = self.shares[i].max(to_f32(share));
                }
            }
        }
    }
}

/// The pixels below `size` that a line of such a width through these coordinates may cover.
fn covered(
    coordinates: impl Iterator<Item = f64> + Clone,
    width: f64,
    size: usize,
) -> Range<usize> {
    let reach = width / 2.0 + 1.0;
    let low = coordinates.clone().fold(f64::INFINITY, f64::min) - reach;
    let high = coordinates.fold(f64::NEG_INFINITY, f64::max) + reach;
    clamped(low, size)..clamped(high.ceil(), size)
}

fn blend(pixel: &mut [u8; 3], color: [u8; 3], share: f32) {
    for (to, from) in pixel.iter_mut().zip(color) {
        let mixed = f32::from(*to) + (f32::from(from) - f32::from(*to)) * share;
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "between two bytes"
        )]
        let mixed = mixed.round() as u8;
        *to = mixed;
    }
}

/// Distance of a point from a segment, and the share of the segment at which it is nearest.
fn distance_to(p: [f64; 2], a: [f64; 2], b: [f64; 2]) -> (f64, f64) {
    let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
    let square = dx * dx + dy * dy;
    let along = if square > 0.0 {
        (((p[0] - a[0]) * dx + (p[1] - a[1]) * dy) / square).clamp(0.0, 1.0)
    } else {
        0.0
    };
    (length(p, [a[0] + along * dx, a[1] + along * dy]), along)
}

fn length(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

/// A coordinate as a pixel from 0 to `size`.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "clamped to the picture"
)]
fn clamped(x: f64, size: usize) -> usize {
    x.clamp(0.0, size as f64) as usize
}

#[expect(clippy::cast_possible_truncation, reason = "a share")]
fn to_f32(x: f64) -> f32 {
    x as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_beside_the_picture_are_not_seen() {
        let mut canvas = Canvas::new(20, 10);
        for points in [
            vec![],
            vec![[3.0, 3.0]],
            vec![[-50.0, -50.0], [-20.0, 30.0]],
            vec![[30.0, 4.0], [90.0, 4.0]],
            vec![[f64::NAN, 4.0], [5.0, 4.0]],
        ] {
            canvas.path(&points, [0; 3], 2.0, None);
        }
        assert_eq!(darkness(&canvas), 0.0, "nothing within the picture");
        canvas.path(&[[-1e9, 5.0], [1e9, 5.0]], [0; 3], 2.0, None);
        assert!(
            (darkness(&canvas) - 40.0).abs() < 1e-3,
            "a stripe through it"
        );
    }

    fn darkness(canvas: &Canvas) -> f64 {
        let dark = |p: &[u8; 3]| 1.0 - f64::from(p[0]) / 255.0;
        canvas.pixels.iter().map(dark).sum()
    }

    #[test]
    fn lines_cover_their_area() {
        for (from, to) in [([10.0, 10.0], [90.0, 10.0]), ([10.0, 20.0], [70.0, 80.0])] {
            let mut canvas = Canvas::new(100, 100);
            canvas.path(&[from, to], [0; 3], 2.0, None);
            let expected = 2.0 * length(from, to);
            let covered = darkness(&canvas);
            // Round ends add about a pixel each.
            assert!(
                (covered - expected).abs() < 0.06 * expected,
                "{covered} of {expected}"
            );
        }
    }

    #[test]
    fn text_is_seen_and_may_stick_out() {
        let mut canvas = Canvas::new(60, 30);
        canvas.text([50.0, 20.0], "wide µ", Anchor::Middle, 16, [0; 3]);
        canvas.text([0.0, -8.0], "high", Anchor::End, 20, [0; 3]);
        assert!(darkness(&canvas) > 10.0, "there are letters");
    }
}
