//! Textures: magnification, minification, addressing, levels of detail, and how each filter errs and shimmers.

mod ewa_error;
mod lod;
mod magnification;
mod minification;
mod mipmaps;
mod plane;
mod shimmer;
mod wrap_modes;

use crate::{Exhibit, GalleryError, Request};
use hemicube_raster::texture::{
    Minify, Ripmap, Sampler, SummedAreaTable, Texcoord, Texture, TextureOptions,
};
use hemicube_raster::{Image, Rgb};

pub(crate) const EXHIBITS: &[Exhibit] = &[
    magnification::EXHIBIT,
    wrap_modes::EXHIBIT,
    mipmaps::EXHIBIT,
    lod::EXHIBIT,
    minification::EXHIBIT,
    ewa_error::EXHIBIT,
    shimmer::EXHIBIT,
];

/// The size asked for, or the usual one.
fn size(request: &Request, usual: (usize, usize)) -> Result<(usize, usize), GalleryError> {
    crate::sheet::picture_size(request, usual, 16..=2048)
}

/// A texture in all forms that a filter may want.
struct Prefiltered {
    texture: Texture,
    ripmap: Ripmap,
    table: SummedAreaTable,
}

impl Prefiltered {
    fn new(image: &Image<Rgb>) -> Self {
        let options = TextureOptions::default();
        let texture = Texture::from_rgb(image, &options).expect("an exhibit's texture has texels");
        Self {
            ripmap: Ripmap::new(&texture, &options),
            table: SummedAreaTable::new(&texture),
            texture,
        }
    }
}

/// A filter for minification, of any kind.
#[derive(Debug, Clone, Copy)]
enum Filter {
    Mip(Sampler),
    Ripmap,
    SummedArea,
}

impl Filter {
    /// All, from the worst of the textbook to the best, with their names.
    fn all() -> [(&'static str, Self); 8] {
        let mip = |minify| Self::Mip(Sampler::default().with_minify(minify));
        [
            ("point", mip(Minify::Point)),
            ("bilinear", mip(Minify::Bilinear)),
            ("nearest mip level", mip(Minify::NearestMipmap)),
            ("trilinear", mip(Minify::Trilinear)),
            ("ripmap", Self::Ripmap),
            ("summed-area table", Self::SummedArea),
            ("anisotropic, 16", mip(Minify::Anisotropic)),
            ("EWA, 16", mip(Minify::Ewa)),
        ]
    }

    /// What a pixel sees, in grey.
    fn sample(self, of: &Prefiltered, at: &Texcoord) -> f32 {
        let repeat = Sampler::default();
        match self {
            Self::Mip(sampler) => sampler.sample_grad(&of.texture, at.uv, at.ddx, at.ddy),
            Self::Ripmap => of.ripmap.sample_grad(&repeat, at.uv, at.ddx, at.ddy),
            Self::SummedArea => of.table.sample_grad(&repeat, at.uv, at.ddx, at.ddy),
        }
        .x
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{GalleryError, Request};

    #[test]
    fn quick_exhibits_draw_at_a_small_size() {
        let request = Request {
            size: Some((48, 36)),
            ..Request::default()
        };
        // Those left out draw a chart of a fixed measurement, which their own tests do smaller.
        for exhibit in EXHIBITS
            .iter()
            .filter(|e| !["shimmer", "ewa-error"].contains(&e.name))
        {
            let pieces = (exhibit.draw)(&request).expect("it draws");
            assert!(
                pieces.iter().all(|p| !p.bytes.is_empty()),
                "{}",
                exhibit.name
            );
        }
    }

    #[test]
    fn sizes_without_sense_are_refused() {
        for size in [(0, 10), (10, 100_000)] {
            let request = Request {
                size: Some(size),
                ..Request::default()
            };
            for exhibit in EXHIBITS {
                let drawn = (exhibit.draw)(&request);
                assert!(
                    matches!(drawn, Err(GalleryError::Size { .. })),
                    "{}",
                    exhibit.name
                );
            }
        }
    }
}
