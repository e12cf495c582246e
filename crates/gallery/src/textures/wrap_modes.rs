//! What lies around a texture, by rule of addressing.

use super::size;
use crate::sheet::{Cell, picture, sheet};
use crate::{Exhibit, GalleryError, Piece, Request};
use glam::{Vec2, Vec4};
use hemicube_raster::texture::{Magnify, Sampler, Texture, TextureOptions, Wrap};
use hemicube_raster::{Image, Rgb};

pub(super) const EXHIBIT: Exhibit = Exhibit {
    name: "wrap-modes",
    about: "repeat, mirror, clamp, mirror once, border: a texture and what is read around it, from -1.5 to 2.5",
    needs: &[],
    draw,
};

const SIDE: usize = 32;
const BORDER: Vec4 = Vec4::new(0.8, 0.1, 0.5, 1.0);

fn draw(request: &Request) -> Result<Vec<Piece>, GalleryError> {
    let (width, height) = size(request, (300, 300))?;
    let texture = Texture::from_rgb(&arrow(), &TextureOptions::default()).expect("it has texels");
    let cell = |wrap: Wrap| Cell {
        image: around(&texture, wrap, width, height),
        lines: vec![
            name(wrap).to_owned(),
            String::from("frame: the texture itself"),
        ],
    };
    Ok(vec![Piece::sheet("", &sheet(&Wrap::ALL.map(cell), 3))?])
}

fn name(wrap: Wrap) -> &'static str {
    match wrap {
        Wrap::Repeat => "repeat",
        Wrap::MirroredRepeat => "mirrored repeat",
        Wrap::ClampToEdge => "clamp to edge",
        Wrap::MirrorOnce => "mirror once",
        Wrap::Border => "border",
    }
}

/// A picture that is nowhere symmetric: a slanted arrow over a gradient with stripes at its right edge.
fn arrow() -> Image<Rgb> {
    picture(SIDE, SIDE, |x, y| {
        let (u, v) = (x as f32 / SIDE as f32, y as f32 / SIDE as f32);
        let is_shaft = (u - v).abs() < 0.08 && u > 0.2;
        let is_head = u < 0.45 && v < 0.45 && u > 0.12 && v > 0.12 && u + v < 0.6;
        if is_shaft || is_head {
            Rgb::new(0.95, 0.85, 0.2)
        } else if u > 0.85 && y % 8 < 4 {
            Rgb::new(0.1, 0.6, 0.3)
        } else {
            Rgb::new(0.1 + 0.3 * u, 0.15, 0.6 - 0.4 * v)
        }
    })
}

fn around(texture: &Texture, wrap: Wrap, width: usize, height: usize) -> Image<Rgb> {
    let sampler = Sampler::default()
        .with_magnify(Magnify::Point)
        .with_wrap([wrap; 2])
        .with_border(BORDER);
    let size = Vec2::new(width as f32, height as f32);
    picture(width, height, |x, y| {
        let uv = Vec2::new(x as f32 + 0.5, y as f32 + 0.5) / size * 4.0 - 1.5;
        let from_edge = uv.min(Vec2::ONE - uv).min_element().abs();
        let inside =
            (uv.min(Vec2::ONE - uv).min_element() > -0.03) && from_edge < 4.0 / size.min_element();
        let color = sampler.sample(texture, uv);
        if inside {
            Rgb::WHITE
        } else {
            Rgb::new(color.x, color.y, color.z)
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn corners_are_what_the_rules_say() {
        let texture = Texture::from_rgb(&arrow(), &TextureOptions::default()).expect("texels");
        let corner = |wrap| *around(&texture, wrap, 64, 64).pixel(0, 0);
        let texel = |x, y| *arrow().pixel(x, y);
        // The first pixel lies at -1.5 + 1/32, texel -47 of 32.
        assert_eq!(corner(Wrap::Repeat), texel(17, 17), "two copies on");
        assert_eq!(
            corner(Wrap::MirroredRepeat),
            texel(17, 17),
            "mirrored twice"
        );
        assert_eq!(corner(Wrap::ClampToEdge), texel(0, 0), "the corner");
        assert_eq!(
            corner(Wrap::MirrorOnce),
            texel(31, 31),
            "beyond the mirrored copy"
        );
        assert_eq!(
            corner(Wrap::Border),
            Rgb::new(BORDER.x, BORDER.y, BORDER.z),
            "the border"
        );
    }
}
