//! A phrase set in a font: one sample per pixel, samples weighted, and the exact area of its letters.

use super::{named, picture_size};
use crate::sheet::{Cell, cropped, magnified, sheet};
use crate::{Exhibit, GalleryError, Piece, Request};
use glam::{DVec2, dvec2};
use hemicube_raster::antialias::area::{Area, Outline, paint};
use hemicube_raster::antialias::{Antialiasing, Supersampler};
use hemicube_raster::io_error::in_words;
use hemicube_raster::{Image, Rgb};
use rayon::prelude::*;
use skrifa::instance::{LocationRef, Size};
use skrifa::outline::{DrawSettings, OutlinePen};
use skrifa::{FontRef, MetadataProvider};
use std::path::PathBuf;

pub(super) const PHRASE: Exhibit = Exhibit {
    name: "phrase",
    about: "A phrase in white on black: aliased, supersampled, and by exact area, with letters magnified",
    needs: &[],
    draw: |request| draw(request, epaint_default_fonts::UBUNTU_LIGHT),
};

pub(super) const PHRASE_IN_FONT: Exhibit = Exhibit {
    name: "phrase-in-font",
    about: "The same phrase in a font of your own",
    needs: &["font.ttf"],
    draw: |request| {
        let path = &request.files[0];
        let file = |why: String| GalleryError::File {
            path: path.clone(),
            why,
        };
        let data = std::fs::read(path).map_err(|error| file(in_words(&error)))?;
        draw(request, &data).map_err(|error| match error {
            GalleryError::File { why, .. } => file(why),
            other => other,
        })
    },
};

const LINES: [&str; 5] = [
    "The quick",
    "brown fox",
    "jumps over",
    "the lazy",
    "radiosity.",
];

fn draw(request: &Request, font: &[u8]) -> Result<Vec<Piece>, GalleryError> {
    let size = picture_size(request, (512, 512))?;
    let (width, height) = size;
    let outline = text(font, dvec2(width as f64, height as f64))?;
    let mut exact = Image::filled(width, height, Rgb::BLACK);
    paint(&mut exact, &[Area::new(&outline, Rgb::WHITE)]);
    let aliased = sampled(&outline, size, named("none"));
    let supersampled = sampled(&outline, size, named("4x4:bartlett"));
    let side = width.min(height) / 8;
    let detail = [width / 12, height / 14, side, side];
    let cell = |image: &Image<Rgb>, name: &str| {
        let large = magnified(&cropped(image, detail), (width / side).max(1));
        let magnified = format!("{name}, magnified");
        [
            Cell::new(image.clone(), &[name]),
            Cell::new(large, &[&magnified]),
        ]
    };
    let [a, b] = cell(&aliased, "one sample per pixel");
    let [c, d] = cell(&supersampled, "4x4 samples, 7x7 Bartlett filter");
    let [e, f] = cell(&exact, "exact area");
    Ok(vec![
        Piece::picture("", &exact)?,
        Piece::picture("-aliased", &aliased)?,
        Piece::sheet("-compared", &sheet(&[a, c, e, b, d, f], 3))?,
    ])
}

/// White inside of an outline, black outside, by samples on a regular grid.
fn sampled(
    outline: &Outline,
    (width, height): (usize, usize),
    antialiasing: Antialiasing,
) -> Image<Rgb> {
    let sampler = Supersampler::new(width, height, antialiasing);
    let mut image = Image::filled(width, height, 0.0_f32);
    let rows = image.pixels_mut().par_chunks_mut(width);
    rows.enumerate().for_each(|(row, out)| {
        let rows = row..row + 1;
        let lines = sampler.rows(rows.clone());
        let samples: Vec<f32> = lines
            .flat_map(|line| sample_line(outline, &sampler, line))
            .collect();
        sampler.resolve(rows, &samples, out);
    });
    image.map(|&share| Rgb::splat(share))
}

/// The samples of a row of the grid: the winding number is counted from left to right.
fn sample_line(outline: &Outline, sampler: &Supersampler, line: usize) -> Vec<f32> {
    let y = sampler.position(0, line)[1];
    let mut crossings: Vec<(f64, i32)> = outline.contours().flat_map(|c| crossings(c, y)).collect();
    crossings.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut crossings = crossings.into_iter().peekable();
    let mut winding = 0;
    let sample = |column| {
        let x = sampler.position(column, line)[0];
        while let Some((_, sign)) = crossings.next_if(|crossing| crossing.0 <= x) {
            winding += sign;
        }
        if winding == 0 { 0.0 } else { 1.0 }
    };
    (0..sampler.columns()).map(sample).collect()
}

/// Where the edges of a contour cross a horizontal line, and whether down (1) or up (-1).
fn crossings(contour: &[DVec2], y: f64) -> impl Iterator<Item = (f64, i32)> {
    let next = contour.iter().cycle().skip(1);
    contour.iter().zip(next).filter_map(move |(a, b)| {
        let is_crossed = (a.y <= y) != (b.y <= y);
        let x = a.x + (b.x - a.x) * ((y - a.y) / (b.y - a.y));
        is_crossed.then_some((x, if a.y < b.y { 1 } else { -1 }))
    })
}

/// The lines of the phrase, as large as fits into a picture of a size.
fn text(font: &[u8], size: DVec2) -> Result<Outline, GalleryError> {
    let unusable = |why: &str| GalleryError::File {
        path: PathBuf::from("the built-in font"),
        why: why.to_owned(),
    };
    let font = FontRef::new(font)
        .map_err(|error| unusable(&format!("{error}; give a TrueType or OpenType font")))?;
    let has = |c: char| c.is_whitespace() || font.charmap().map(c).is_some();
    if let Some(missing) = LINES
        .iter()
        .flat_map(|line| line.chars())
        .find(|&c| !has(c))
    {
        return Err(unusable(&format!(
            "it has no letter '{missing}'; give a Latin font"
        )));
    }
    let margin = 0.06 * size.min_element();
    let room = size - 2.0 * margin;
    let widest = LINES
        .iter()
        .map(|line| line_width(&font, line))
        .fold(0.0, f64::max);
    if widest <= 0.0 {
        return Err(unusable(
            "it has none of the letters of the phrase; give a Latin font",
        ));
    }
    let leading = room.y / LINES.len() as f64;
    let em = (room.x / widest).min(leading / 1.2);
    let mut outline = Outline::new();
    for (i, line) in LINES.iter().enumerate() {
        let baseline = dvec2(margin, margin + leading * (i as f64 + 0.78));
        set_line(&font, line, em, baseline, &mut outline);
    }
    if !outline.is_finite() {
        return Err(unusable("its letters have coordinates that are no numbers"));
    }
    Ok(outline)
}

/// Width of a line in ems.
fn line_width(font: &FontRef<'_>, line: &str) -> f64 {
    let metrics = font.glyph_metrics(Size::new(1.0), LocationRef::default());
    let letters = line.chars().filter_map(|c| font.charmap().map(c));
    let advances = letters.filter_map(|glyph| metrics.advance_width(glyph));
    advances.map(f64::from).sum()
}

/// Adds the letters of a line; those that the font does not have or cannot draw are left out.
fn set_line(font: &FontRef<'_>, line: &str, em: f64, baseline: DVec2, outline: &mut Outline) {
    let metrics = font.glyph_metrics(Size::new(1.0), LocationRef::default());
    let glyphs = font.outline_glyphs();
    let mut origin = baseline;
    for glyph in line.chars().filter_map(|c| font.charmap().map(c)) {
        if let Some(letter) = glyphs.get(glyph) {
            let mut pen = Pen {
                origin,
                em,
                outline,
            };
            // A letter that cannot be drawn is a gap in the line.
            let _ = letter.draw(
                DrawSettings::unhinted(Size::new(1.0), LocationRef::default()),
                &mut pen,
            );
        }
        origin.x += em * f64::from(metrics.advance_width(glyph).unwrap_or(0.0));
    }
}

/// Letters into an outline: from ems with y up to pixels with y down.
struct Pen<'a> {
    origin: DVec2,
    em: f64,
    outline: &'a mut Outline,
}

impl Pen<'_> {
    fn at(&self, x: f32, y: f32) -> DVec2 {
        self.origin + self.em * dvec2(f64::from(x), -f64::from(y))
    }
}

impl OutlinePen for Pen<'_> {
    fn move_to(&mut self, x: f32, y: f32) {
        self.outline.move_to(self.at(x, y));
    }

    fn line_to(&mut self, x: f32, y: f32) {
        self.outline.line_to(self.at(x, y));
    }

    fn quad_to(&mut self, cx: f32, cy: f32, x: f32, y: f32) {
        self.outline.quad_to(self.at(cx, cy), self.at(x, y));
    }

    fn curve_to(&mut self, ax: f32, ay: f32, bx: f32, by: f32, x: f32, y: f32) {
        self.outline
            .cubic_to(self.at(ax, ay), self.at(bx, by), self.at(x, y));
    }

    fn close(&mut self) {
        self.outline.close();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use hemicube_raster::antialias::area::{FillRule, mask};

    #[test]
    fn letters_have_the_same_light_by_samples_and_by_area() {
        let outline = text(epaint_default_fonts::UBUNTU_LIGHT, dvec2(128.0, 128.0)).expect("font");
        let area = mask(&outline, FillRule::NonZero, (128, 128));
        let samples = sampled(&outline, (128, 128), named("8x8"));
        let mut squares = 0.0;
        for (&area, sample) in area.pixels().iter().zip(samples.pixels()) {
            squares += (area - sample.r).powi(2);
        }
        let total = |values: &mut dyn Iterator<Item = f32>| values.map(f64::from).sum::<f64>();
        let light = total(&mut area.pixels().iter().copied());
        let sampled = total(&mut samples.pixels().iter().map(|c| c.r));
        // 64 samples per pixel: an RMS of about 0.011 at edges.
        assert!((squares / 16384.0).sqrt() < 0.02, "{squares}");
        assert!(
            light > 1000.0 && (sampled / light - 1.0).abs() < 0.005,
            "{light}, {sampled}"
        );
    }

    #[test]
    fn what_is_no_font_is_refused_in_one_line() {
        let good = epaint_default_fonts::UBUNTU_LIGHT;
        for bad in [&[][..], b"not a font at all", &good[..100], &good[..4000]] {
            let error = text(bad, dvec2(64.0, 64.0)).err();
            let line = error.map_or(String::new(), |error| error.to_string());
            assert!(!line.contains('\n'), "{line}");
            assert!(bad.len() > 50 || !line.is_empty(), "{} bytes", bad.len());
        }
    }

    #[test]
    fn broken_fonts_do_no_harm() {
        let good = epaint_default_fonts::UBUNTU_LIGHT;
        for seed in 0..40_usize {
            let mut bad = good.to_vec();
            for i in 0..200 {
                let at = (seed * 7919 + i * 104_729 + i * i * 31)
                    % if i % 2 == 0 { 400 } else { bad.len() };
                bad[at] ^= 1 << (i % 8);
            }
            if let Ok(outline) = text(&bad, dvec2(64.0, 64.0)) {
                let coverage = mask(&outline, FillRule::NonZero, (64, 64));
                assert!(
                    coverage.pixels().iter().all(|c| (0.0..=1.0).contains(c)),
                    "seed {seed}"
                );
            }
        }
    }
}
