//! Many areas into one picture.

use super::{Blend, FillRule, Outline, Pixel, Rasterizer};
use crate::Image;
use core::ops::Range;
use rayon::prelude::*;

/// An area with what it is painted with.
#[derive(Debug, Clone, Copy)]
pub struct Area<'a, P> {
    /// Its outline.
    pub outline: &'a Outline,
    /// Which side of the outline is painted. Default value: `FillRule::NonZero`.
    pub rule: FillRule,
    /// Colour or value.
    pub value: P,
    /// Share of the value where the area is whole; see [`Blend::new`]. Default value: 1.
    pub opacity: f32,
}

impl<'a, P> Area<'a, P> {
    /// An opaque area.
    pub const fn new(outline: &'a Outline, value: P) -> Self {
        Self {
            outline,
            rule: FillRule::NonZero,
            value,
            opacity: 1.0,
        }
    }

    /// The same with another rule.
    #[must_use]
    pub fn with_rule(mut self, rule: FillRule) -> Self {
        self.rule = rule;
        self
    }

    /// The same with another opacity.
    #[must_use]
    pub fn with_opacity(mut self, opacity: f32) -> Self {
        self.opacity = opacity;
        self
    }
}

/// Bytes of a picture that are painted at a time: they stay in a core's cache while one area after the other is blended.
const BAND_BYTES: usize = 1 << 18;

/// Blends areas into a picture, the first one lowest; made by all threads, the same bits on any number of them.
///
/// The picture is painted in bands of rows. That is faster than [`Rasterizer::fill`] for each area also on one thread, as
/// soon as the picture is larger than a cache.
pub fn paint<P: Pixel + Send + Sync>(image: &mut Image<P>, areas: &[Area<'_, P>]) {
    let (width, height) = (image.width(), image.height());
    if width == 0 {
        return;
    }
    let rows = (BAND_BYTES / (width * size_of::<P>()).max(1)).clamp(8, height.max(8));
    let bins = bins(areas, height, rows);
    let bands = image.pixels_mut().par_chunks_mut(rows * width);
    let bands = bands.zip(bins).enumerate();
    bands.for_each_init(Vec::new, |near, (band, (pixels, bin))| {
        let first = band * rows;
        let rows = first..(first + rows).min(height);
        // Memory that was read in a row and is used again is faster than pixels here and there of a large picture.
        near.clear();
        near.extend_from_slice(pixels);
        paint_band(near, width, rows, &bin);
        pixels.copy_from_slice(near);
    });
}

fn paint_band<P: Pixel>(
    pixels: &mut [P],
    width: usize,
    rows: Range<usize>,
    areas: &[&Area<'_, P>],
) {
    let first = rows.start;
    let mut rasterizer = Rasterizer::for_rows(width, rows);
    for area in areas {
        let mut blend = Blend::new(pixels, width, first, area.value, area.opacity);
        rasterizer.rasterize(area.outline, area.rule, &mut blend);
    }
}

/// The areas that reach into each band of rows.
fn bins<'a, P>(areas: &'a [Area<'a, P>], height: usize, rows: usize) -> Vec<Vec<&'a Area<'a, P>>> {
    let mut bins: Vec<Vec<&Area<'_, P>>> = Vec::new();
    bins.resize_with(height.div_ceil(rows), Vec::new);
    for area in areas {
        for bin in &mut bins[touched(area.outline, height, rows)] {
            bin.push(area);
        }
    }
    bins
}

/// The bands that an outline may reach into.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "clamped to the picture's rows"
)]
fn touched(outline: &Outline, height: usize, rows: usize) -> Range<usize> {
    let Some([top, bottom]) = outline.extent_y() else {
        return 0..0;
    };
    let row = |y: f64| y.clamp(0.0, height as f64) as usize;
    let (first, end) = (row(top.floor()), row(bottom.ceil()));
    match first < end {
        true => first / rows..end.div_ceil(rows),
        false => 0..0,
    }
}
