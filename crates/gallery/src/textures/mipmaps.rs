//! Mip pyramids of one picture: made of light, and made of codes as so many programs do.

use super::size;
use crate::sheet::{Cell, picture, sheet};
use crate::{Exhibit, GalleryError, Piece, Request};
use glam::Vec2;
use hemicube_raster::color::{linear_from_srgb, srgb_from_linear};
use hemicube_raster::texture::{MipFilter, Texture, TextureOptions};
use hemicube_raster::{Image, Rgb};

pub(super) const EXHIBIT: Exhibit = Exhibit {
    name: "mipmaps",
    about: "pyramids of a picture averaged in linear light, by a sharper filter, and in gamma, where it grows dark",
    needs: &[],
    draw,
};

fn draw(request: &Request) -> Result<Vec<Piece>, GalleryError> {
    let (width, height) = size(request, (384, 256))?;
    let pyramids = pyramids(&city(width, height));
    let mut table = String::from("level,width,height");
    for (name, _) in &pyramids {
        table += &format!(",\"{name}\"");
    }
    for level in 0..pyramids[0].1.len() {
        let image = &pyramids[0].1[level];
        table += &format!("\n{level},{},{}", image.width(), image.height());
        for (_, levels) in &pyramids {
            table += &format!(",{:.5}", mean_light(&levels[level]));
        }
    }
    let cell = |(name, levels): &(&str, Vec<Image<Rgb>>)| Cell {
        image: side_by_side(levels),
        lines: vec![
            (*name).to_owned(),
            format!(
                "mean light {:.3}, of the last level {:.3}",
                mean_light(&levels[0]),
                mean_light(&levels[levels.len() - 1])
            ),
        ],
    };
    let cells: Vec<Cell> = pyramids.iter().map(cell).collect();
    Ok(vec![
        Piece::sheet("", &sheet(&cells, 1))?,
        Piece::csv("", table + "\n"),
    ])
}

/// All levels, in linear light, of the three ways to make them.
fn pyramids(picture: &Image<Rgb>) -> [(&'static str, Vec<Image<Rgb>>); 3] {
    let codes = picture.map(|c| c.map(srgb_from_linear));
    let in_gamma = levels(&codes, MipFilter::Box)
        .iter()
        .map(|level| level.map(|c| c.map(linear_from_srgb)))
        .collect();
    [
        ("box, linear light", levels(picture, MipFilter::Box)),
        ("Kaiser, linear light", levels(picture, MipFilter::Kaiser)),
        ("box, in gamma", in_gamma),
    ]
}

fn levels(picture: &Image<Rgb>, filter: MipFilter) -> Vec<Image<Rgb>> {
    let options = TextureOptions::default().with_filter(filter);
    let texture = Texture::from_rgb(picture, &options).expect("it has texels");
    let level = |i| texture.level(i).map(|&[r, g, b, _]| Rgb::new(r, g, b));
    (0..texture.levels()).map(level).collect()
}

/// A town at night: many small lights on black, fine stripes, and a moon.
fn city(width: usize, height: usize) -> Image<Rgb> {
    picture(width, height, |x, y| {
        let at = Vec2::new(x as f32 + 0.5, y as f32 + 0.5) / height as f32;
        let is_window = x % 4 < 2 && y % 6 < 2 && (x / 24 * 7 + y / 36 * 5) % 4 != 0;
        if (at - Vec2::new(1.2, 0.22)).length() < 0.12 {
            Rgb::new(0.9, 0.88, 0.75)
        } else if at.y > 0.85 {
            Rgb::splat(if x % 2 == 0 { 1.0 } else { 0.0 })
        } else if at.y > 0.35 && is_window {
            Rgb::new(1.0, 0.75, 0.3)
        } else {
            Rgb::new(0.004, 0.006, 0.02)
        }
    })
}

fn mean_light(image: &Image<Rgb>) -> f64 {
    let sum: f64 = image
        .pixels()
        .iter()
        .map(|c| f64::from(c.luminance()))
        .sum();
    sum / image.pixels().len() as f64
}

/// The first level with the others in a column to its right.
fn side_by_side(levels: &[Image<Rgb>]) -> Image<Rgb> {
    let first = &levels[0];
    let (width, height) = (first.width() + first.width() / 2, first.height());
    let mut all = Image::filled(width, height, Rgb::WHITE);
    let (mut left, mut top) = (0, 0);
    for level in levels {
        for y in 0..level.height().min(height.saturating_sub(top)) {
            for x in 0..level.width().min(width - left) {
                *all.pixel_mut(left + x, top + y) = *level.pixel(x, y);
            }
        }
        top = if left == 0 { 0 } else { top + level.height() };
        left = first.width();
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn light_is_kept_in_linear_light_only() {
        let [linear, kaiser, gamma] = pyramids(&city(96, 64)).map(|(_, levels)| levels);
        let before = mean_light(&linear[0]);
        let after = |levels: &[Image<Rgb>]| mean_light(&levels[levels.len() - 1]);
        assert!(
            (after(&linear) - before).abs() < 1e-6,
            "{before}, {}",
            after(&linear)
        );
        assert!(
            (after(&kaiser) - before).abs() < 0.05 * before,
            "{before}, {}",
            after(&kaiser)
        );
        assert!(after(&gamma) < 0.6 * before, "{before}, {}", after(&gamma));
    }
}
