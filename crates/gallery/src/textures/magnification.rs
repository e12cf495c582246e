//! A small picture drawn large by five filters.

use super::size;
use crate::sheet::{Cell, picture, sheet};
use crate::{Exhibit, GalleryError, Piece, Request};
use glam::Vec2;
use hemicube_raster::texture::{Cubic, Magnify, Sampler, Texture, TextureOptions, Wrap};
use hemicube_raster::{Image, Rgb};

pub(super) const EXHIBIT: Exhibit = Exhibit {
    name: "magnification",
    about: "a picture of 24 x 24 texels drawn large: point, bilinear, Catmull-Rom, B-spline, Mitchell, with their ranges",
    needs: &[],
    draw,
};

const SIDE: usize = 24;
const DARK: f32 = 0.1;
const BRIGHT: f32 = 0.9;

const FILTERS: [(&str, Magnify); 5] = [
    ("point", Magnify::Point),
    ("bilinear", Magnify::Bilinear),
    ("Catmull-Rom", Magnify::Bicubic(Cubic::CatmullRom)),
    ("B-spline", Magnify::Bicubic(Cubic::BSpline)),
    ("Mitchell", Magnify::Bicubic(Cubic::Mitchell)),
];

fn draw(request: &Request) -> Result<Vec<Piece>, GalleryError> {
    let (width, height) = size(request, (300, 300))?;
    let texture = Texture::from_rgb(&badge(), &TextureOptions::default()).expect("it has texels");
    let cell = |(name, magnify): (&str, Magnify)| {
        let image = enlarged(&texture, magnify, width, height);
        let (low, high) = range(&image);
        let lines = vec![
            String::from(name),
            format!("from {low:.3} to {high:.3} of {DARK} to {BRIGHT}"),
        ];
        Cell { image, lines }
    };
    Ok(vec![Piece::sheet("", &sheet(&FILTERS.map(cell), 3))?])
}

/// A ring, a slanted bar, checks of one texel and a gradient: edges of all directions.
fn badge() -> Image<Rgb> {
    picture(SIDE, SIDE, |x, y| {
        let at = Vec2::new(x as f32 + 0.5, y as f32 + 0.5);
        let radius = (at - Vec2::splat(10.0)).length();
        if (6.0..8.0).contains(&radius) {
            Rgb::new(BRIGHT, 0.25, DARK)
        } else if (at.x - 0.4 * at.y - 4.0).abs() < 1.0 && radius < 6.0 {
            Rgb::splat(BRIGHT)
        } else if x >= 18 && y < 12 {
            Rgb::splat(if (x + y) % 2 == 0 { BRIGHT } else { DARK })
        } else if y >= 19 {
            Rgb::splat(DARK + (BRIGHT - DARK) * x as f32 / (SIDE - 1) as f32)
        } else {
            Rgb::new(DARK, 0.15, 0.3)
        }
    })
}

fn enlarged(texture: &Texture, magnify: Magnify, width: usize, height: usize) -> Image<Rgb> {
    let sampler = Sampler::default()
        .with_magnify(magnify)
        .with_wrap([Wrap::ClampToEdge; 2]);
    let size = Vec2::new(width as f32, height as f32);
    picture(width, height, |x, y| {
        let uv = Vec2::new(x as f32 + 0.5, y as f32 + 0.5) / size;
        let color = sampler.sample(texture, uv);
        Rgb::new(color.x, color.y, color.z)
    })
}

/// Least and largest value of any channel.
fn range(image: &Image<Rgb>) -> (f32, f32) {
    let values = || image.pixels().iter().flat_map(|c| c.to_array());
    (
        values().fold(f32::INFINITY, f32::min),
        values().fold(0.0, f32::max),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_interpolating_cubics_overshoot() {
        let texture = Texture::from_rgb(&badge(), &TextureOptions::default()).expect("texels");
        for (name, magnify) in FILTERS {
            let (low, high) = range(&enlarged(&texture, magnify, 96, 96));
            let overshoots = low < DARK - 0.01 && high > BRIGHT + 0.01;
            assert_eq!(
                overshoots,
                name == "Catmull-Rom" || name == "Mitchell",
                "{name}: {low} to {high}"
            );
        }
    }
}
