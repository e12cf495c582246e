//! Pictures in memory and in files.

mod exr;
mod hdr;
mod read;

pub use read::{Format, Picture, ReadError, ReadOptions, Values, open_picture, read_picture};

use crate::color::{Rgb, srgb8_from_linear};
use std::io::{Seek, Write};

/// A picture: rows from top to bottom, pixels from left to right, pixel `(0, 0)` in the upper left corner.
#[derive(Debug, Clone, PartialEq)]
pub struct Image<P> {
    width: usize,
    height: usize,
    pixels: Vec<P>,
}

impl<P: Clone> Image<P> {
    /// A picture of one colour.
    pub fn filled(width: usize, height: usize, pixel: P) -> Self {
        Self {
            width,
            height,
            pixels: vec![pixel; width * height],
        }
    }
}

impl<P> Image<P> {
    /// A picture from its rows; `None` if the number of pixels is not `width * height`.
    pub fn from_pixels(width: usize, height: usize, pixels: Vec<P>) -> Option<Self> {
        (Some(pixels.len()) == width.checked_mul(height)).then_some(Self {
            width,
            height,
            pixels,
        })
    }

    /// Pixels in a row.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Rows.
    pub fn height(&self) -> usize {
        self.height
    }

    /// All pixels, row by row.
    pub fn pixels(&self) -> &[P] {
        &self.pixels
    }

    /// All pixels, row by row.
    pub fn pixels_mut(&mut self) -> &mut [P] {
        &mut self.pixels
    }

    /// The pixel of a column and a row; panics outside the picture.
    pub fn pixel(&self, x: usize, y: usize) -> &P {
        assert!(
            x < self.width && y < self.height,
            "pixel ({x}, {y}) of a picture of {} x {}",
            self.width,
            self.height
        );
        &self.pixels[y * self.width + x]
    }

    /// The pixel of a column and a row; panics outside the picture.
    pub fn pixel_mut(&mut self, x: usize, y: usize) -> &mut P {
        assert!(
            x < self.width && y < self.height,
            "pixel ({x}, {y}) of a picture of {} x {}",
            self.width,
            self.height
        );
        &mut self.pixels[y * self.width + x]
    }

    /// A picture of the same size with `f` applied to each pixel.
    pub fn map<Q>(&self, f: impl FnMut(&P) -> Q) -> Image<Q> {
        Image {
            width: self.width,
            height: self.height,
            pixels: self.pixels.iter().map(f).collect(),
        }
    }
}

/// A picture could not be stored.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ImageError {
    /// The PNG encoder failed.
    #[error("PNG: {0}")]
    Png(#[from] ::image::ImageError),
    /// The OpenEXR encoder failed.
    #[error("OpenEXR: {0}")]
    Exr(#[from] ::exr::error::Error),
}

impl Image<Rgb> {
    /// Writes 8-bit sRGB PNG; values outside [0, 1] are clamped, so map tones first.
    pub fn write_png(&self, out: impl Write) -> Result<(), ImageError> {
        let bytes: Vec<u8> = self
            .pixels
            .iter()
            .flat_map(|c| c.to_array().map(srgb8_from_linear))
            .collect();
        let encoder = ::image::codecs::png::PngEncoder::new(out);
        let (width, height) = (dimension(self.width), dimension(self.height));
        ::image::ImageEncoder::write_image(
            encoder,
            &bytes,
            width,
            height,
            ::image::ExtendedColorType::Rgb8,
        )?;
        Ok(())
    }

    /// Writes linear 32-bit OpenEXR with channels R, G, B (Rec. 709 primaries, the format's default).
    pub fn write_exr(&self, out: impl Write + Seek) -> Result<(), ImageError> {
        use ::exr::prelude::{SpecificChannels, WritableImage};
        let channels = SpecificChannels::rgb(|at: ::exr::math::Vec2<usize>| {
            let c = self.pixel(at.x(), at.y());
            (c.r, c.g, c.b)
        });
        ::exr::image::Image::from_channels((self.width, self.height), channels)
            .write()
            .to_buffered(out)?;
        Ok(())
    }
}

/// A picture's side as the encoders want it; the pixels are in memory, so it fits.
fn dimension(side: usize) -> u32 {
    u32::try_from(side).expect("a picture's side fits 32 bits")
}
