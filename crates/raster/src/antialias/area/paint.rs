//! Many areas into one picture.

use super::chain::{Chains, Cut};
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

/// An area cut to the rows of a band.
struct Part<P> {
    cut: Cut,
    rule: FillRule,
    value: P,
    opacity: f32,
}

/// The parts of all areas in a band, in the order of the areas.
struct Band<P> {
    rows: Range<usize>,
    chains: Chains,
    parts: Vec<Part<P>>,
}

/// Blends areas into a picture, the first one lowest; made by all threads, the same bits on any number of them.
///
/// The picture is painted in bands of rows. That is faster than [`Rasterizer::fill`] for each area also on one thread, as
/// soon as the picture is larger than a cache; it takes memory for three or four times what the outlines take.
pub fn paint<P: Pixel + Send + Sync>(image: &mut Image<P>, areas: &[Area<'_, P>]) {
    let (width, height) = (image.width(), image.height());
    if width == 0 || height == 0 {
        return;
    }
    let rows = (BAND_BYTES / (width * size_of::<P>()).max(1)).clamp(8, height.max(8));
    let bands = cut_into_bands(areas, width, height, rows);
    let pixels = image.pixels_mut().par_chunks_mut(rows * width);
    pixels
        .zip(bands)
        .for_each_init(Vec::new, |near, (pixels, band)| {
            // Memory that was read in a row and is used again is faster than pixels here and there of a large picture.
            near.clear();
            near.extend_from_slice(pixels);
            band.paint(near, width);
            pixels.copy_from_slice(near);
        });
}

impl<P: Pixel> Band<P> {
    fn paint(&self, pixels: &mut [P], width: usize) {
        let mut rasterizer = Rasterizer::for_rows(width, self.rows.clone());
        for part in &self.parts {
            let first = self.rows.start;
            let mut blend = Blend::new(pixels, width, first, part.value, part.opacity);
            rasterizer.rasterize_cut(&self.chains, &part.cut, part.rule, &mut blend);
        }
    }
}

/// Cuts areas into bands of so many rows. Outlines are read once and in order, bands are then painted from memory that
/// lies in order too.
fn cut_into_bands<P: Pixel>(
    areas: &[Area<'_, P>],
    width: usize,
    height: usize,
    rows: usize,
) -> Vec<Band<P>> {
    let band = |first: usize| Band {
        rows: first..(first + rows).min(height),
        chains: Chains::default(),
        parts: Vec::new(),
    };
    let mut bands: Vec<Band<P>> = (0..height).step_by(rows).map(band).collect();
    for area in areas {
        for band in &mut bands[touched(area.outline, height, rows)] {
            band.parts.push(Part {
                cut: band.chains.cut(area.outline, width, &band.rows),
                rule: area.rule,
                value: area.value,
                opacity: area.opacity,
            });
        }
    }
    bands
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
