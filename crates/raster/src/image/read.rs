//! Reading pictures: PNG, JPEG, WebP, Radiance RGBE and OpenEXR, as linear light.
//!
//! What a file is shows its first bytes, not its name. Sides and memory are checked before anything is decoded, so a
//! file of a few hundred bytes cannot ask for gigabytes.

use super::{Image, exr, hdr};
use crate::color::{linear_from_srgb, linear_from_srgb8_table};
use ::image::codecs::{jpeg::JpegDecoder, png::PngDecoder, webp::WebPDecoder};
use ::image::{DynamicImage, ImageDecoder, Limits};
use core::fmt;
use std::io::Cursor;
use std::path::{Path, PathBuf};

/// What a picture may be, and how its numbers are understood.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ReadOptions {
    /// Longest side in pixels. Default value: 16,384.
    pub max_side: usize,
    /// Most pixels, each 16 bytes in memory. Default value: 2^27, a panorama of 16,384 x 8,192.
    pub max_pixels: usize,
    /// What the numbers of PNG, JPEG and WebP mean. Default value: colour.
    pub values: Values,
    /// Whether NaN and infinities of OpenEXR files stay as they are; otherwise NaN becomes 0 and infinities the largest
    /// half float, 65,504, with their sign. Default value: false.
    pub keep_non_finite: bool,
}

impl Default for ReadOptions {
    fn default() -> Self {
        Self {
            max_side: 16_384,
            max_pixels: 1 << 27,
            values: Values::Color,
            keep_non_finite: false,
        }
    }
}

impl ReadOptions {
    /// Another longest side.
    pub fn with_max_side(self, max_side: usize) -> Self {
        Self { max_side, ..self }
    }

    /// Another number of pixels.
    pub fn with_max_pixels(self, max_pixels: usize) -> Self {
        Self { max_pixels, ..self }
    }

    /// Another meaning of integer samples.
    pub fn with_values(self, values: Values) -> Self {
        Self { values, ..self }
    }

    /// With NaN and infinities as in the file.
    pub fn with_non_finite(self, keep_non_finite: bool) -> Self {
        Self {
            keep_non_finite,
            ..self
        }
    }

    /// The door for sizes.
    pub(super) fn check(&self, width: usize, height: usize) -> Result<(), ReadError> {
        let fits = width.max(height) <= self.max_side
            && width
                .checked_mul(height)
                .is_some_and(|n| n <= self.max_pixels);
        if width.min(height) == 0 || !fits {
            return Err(ReadError::Size {
                width,
                height,
                max_side: self.max_side,
                max_pixels: self.max_pixels,
            });
        }
        Ok(())
    }
}

/// What the numbers of a PNG, JPEG or WebP file mean.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Values {
    /// Colours: sRGB, or the power law of a PNG's `gAMA` chunk where it says something else. Alpha is linear.
    #[default]
    Color,
    /// Numbers, code by largest code: normals, heights, roughness.
    Data,
}

/// What a file was.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Format {
    /// Portable Network Graphics.
    Png,
    /// JPEG.
    Jpeg,
    /// WebP, its first frame if it moves.
    WebP,
    /// Radiance RGBE or XYZE.
    Hdr,
    /// OpenEXR.
    Exr,
}

impl Format {
    /// What the first bytes of a file show it to be.
    pub fn of(bytes: &[u8]) -> Option<Self> {
        let starts = |magic: &[u8]| bytes.starts_with(magic);
        match () {
            () if starts(b"\x89PNG\r\n\x1a\n") => Some(Self::Png),
            () if starts(b"\xff\xd8\xff") => Some(Self::Jpeg),
            () if starts(b"RIFF") && bytes.get(8..12) == Some(b"WEBP") => Some(Self::WebP),
            () if starts(b"#?") => Some(Self::Hdr),
            () if starts(b"\x76\x2f\x31\x01") => Some(Self::Exr),
            () => None,
        }
    }

    /// Name for people.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Png => "PNG",
            Self::Jpeg => "JPEG",
            Self::WebP => "WebP",
            Self::Hdr => "Radiance HDR",
            Self::Exr => "OpenEXR",
        }
    }

    /// Whether the file holds linear light, beyond the range of a display too.
    pub const fn is_linear(self) -> bool {
        matches!(self, Self::Hdr | Self::Exr)
    }
}

impl fmt::Display for Format {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

/// A picture from a file.
#[derive(Debug, Clone, PartialEq)]
pub struct Picture {
    /// Red, green, blue (linear, Rec. 709 primaries) and alpha, 1 where the file has none. Colours are not multiplied by
    /// alpha, except those of OpenEXR files, which always are.
    pub image: Image<[f32; 4]>,
    /// What the file was.
    pub format: Format,
    /// Bits of a sample in the file: 8 (also what is less in the file), 16 or 32.
    pub bits: u32,
    /// Whether the file has an alpha channel.
    pub has_alpha: bool,
    /// Samples that were NaN or infinite.
    pub non_finite: usize,
}

impl Picture {
    /// Whether the file held 8-bit codes, of sRGB unless it said otherwise.
    pub fn is_8_bit(&self) -> bool {
        self.bits == 8
    }

    /// The colours without alpha.
    pub fn rgb(&self) -> Image<crate::Rgb> {
        self.image.map(|&[r, g, b, _]| crate::Rgb::new(r, g, b))
    }
}

/// A picture could not be read; one line.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReadError {
    /// The file could not be opened or read.
    #[error("{}", crate::io_error::in_words(.0))]
    Io(#[from] std::io::Error),
    /// The first bytes are of no format that is read here.
    #[error("is no picture that can be read; give a .png, .jpg, .webp, .hdr or .exr file")]
    Format,
    /// A side is 0, or the picture is too large.
    #[error(
        "a picture of {width} x {height} pixels; sides must be from 1 to {max_side}, with at most {max_pixels} pixels in all"
    )]
    Size {
        /// Pixels in a row.
        width: usize,
        /// Rows.
        height: usize,
        /// Longest side.
        max_side: usize,
        /// Most pixels.
        max_pixels: usize,
    },
    /// The header promises more pixels than the rest of the file can hold.
    #[error(
        "{format}: its {bytes} bytes cannot hold {width} x {height} pixels; the file is damaged"
    )]
    Hollow {
        /// What the file says it is.
        format: Format,
        /// Its length.
        bytes: usize,
        /// Pixels in a row.
        width: usize,
        /// Rows.
        height: usize,
    },
    /// The file is damaged, or uses what is not supported.
    #[error("{format}: {why}")]
    Decode {
        /// What the file says it is.
        format: Format,
        /// What is wrong with it.
        why: String,
    },
    /// Any of these, of a named file.
    #[error("{}: {error}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        error: Box<ReadError>,
    },
}

impl ReadError {
    pub(super) fn decode(format: Format, why: impl fmt::Display) -> Self {
        let text = why.to_string();
        let spaced = text.chars().map(|c| if c.is_control() { ' ' } else { c });
        Self::Decode {
            format,
            why: spaced.collect(),
        }
    }
}

/// Reads the picture in a file.
///
/// # Errors
/// One line with the file's name.
pub fn open_picture(path: &Path, options: &ReadOptions) -> Result<Picture, ReadError> {
    let of_file = |error| ReadError::File {
        path: path.to_path_buf(),
        error: Box::new(error),
    };
    let bytes = bytes_of(path).map_err(|e| of_file(ReadError::Io(e)))?;
    read_picture(&bytes, options).map_err(of_file)
}

/// Longest file that is read: no picture that fits is longer.
const MAX_BYTES: u64 = 4 << 30;

fn bytes_of(path: &Path) -> std::io::Result<Vec<u8>> {
    let facts = std::fs::metadata(path)?;
    if facts.is_dir() {
        return Err(std::io::Error::other("is a folder; name a file in it"));
    }
    if facts.len() > MAX_BYTES {
        return Err(std::io::Error::other("is larger than 4 GiB"));
    }
    std::fs::read(path)
}

/// Reads a picture from the bytes of a file.
///
/// # Errors
/// One line: what is wrong and how to mend it.
pub fn read_picture(bytes: &[u8], options: &ReadOptions) -> Result<Picture, ReadError> {
    let format = Format::of(bytes).ok_or(ReadError::Format)?;
    let of_codec = |e: ::image::ImageError| ReadError::decode(format, e);
    let input = Cursor::new(bytes);
    match format {
        Format::Hdr => hdr::read(bytes, options),
        Format::Exr => exr::read(bytes, options),
        Format::Png => {
            let mut limits = Limits::no_limits();
            limits.max_alloc = Some(options.max_pixels as u64 * 16);
            let decoder = PngDecoder::with_limits(input, limits).map_err(of_codec)?;
            decoded(decoder, format, bytes.len(), png_gamma(bytes), options)
        }
        Format::Jpeg => {
            let decoder = JpegDecoder::new(input).map_err(of_codec)?;
            decoded(decoder, format, bytes.len(), None, options)
        }
        Format::WebP => {
            let decoder = WebPDecoder::new(input).map_err(of_codec)?;
            decoded(decoder, format, bytes.len(), None, options)
        }
    }
}

/// The encoding exponent of a PNG's `gAMA` chunk, unless it says more exactly what it means: `sRGB`, or a profile, which
/// is taken for sRGB. (The decoder of the `image` crate finds no such chunk in what it reads.)
fn png_gamma(bytes: &[u8]) -> Option<f64> {
    let mut rest = bytes.get(8..)?;
    let mut gamma = None;
    loop {
        let (&length, after) = rest.split_first_chunk()?;
        let length = u32::from_be_bytes(length) as usize;
        let (kind, after) = after.split_first_chunk::<4>()?;
        match kind {
            b"sRGB" | b"iCCP" => return None,
            b"gAMA" => {
                gamma = after
                    .first_chunk()
                    .map(|&n| f64::from(u32::from_be_bytes(n)));
            }
            b"IDAT" => return gamma.map(|scaled| scaled / 100_000.0),
            _ => {}
        }
        rest = after.get(length.checked_add(4)?..)?;
    }
}

/// Most pixels that a byte of a file can stand for. Deflate makes at most 1032 bytes of one, of 8 pixels each in a
/// bilevel PNG; JPEG and WebP say of blocks of 64 and more pixels in a bit that nothing changes.
const PIXELS_OF_A_BYTE: usize = 1 << 14;

/// Decodes integer samples and makes them linear.
fn decoded(
    mut decoder: impl ImageDecoder,
    format: Format,
    bytes: usize,
    gamma: Option<f64>,
    options: &ReadOptions,
) -> Result<Picture, ReadError> {
    let (width, height) = decoder.dimensions();
    let (width, height) = (width as usize, height as usize);
    options.check(width, height)?;
    if width * height / PIXELS_OF_A_BYTE > bytes {
        return Err(ReadError::Hollow {
            format,
            bytes,
            width,
            height,
        });
    }
    let orientation = decoder.orientation();
    let mut image =
        DynamicImage::from_decoder(decoder).map_err(|e| ReadError::decode(format, e))?;
    // A tag that cannot be understood turns nothing.
    if let Ok(orientation) = orientation {
        image.apply_orientation(orientation);
    }
    let (width, height) = (image.width() as usize, image.height() as usize);
    let has_alpha = image.color().has_alpha();
    let transfer = Transfer::new(options.values, gamma);
    let (bits, pixels) = match image.color() {
        ::image::ColorType::L8
        | ::image::ColorType::La8
        | ::image::ColorType::Rgb8
        | ::image::ColorType::Rgba8 => (8, transfer.of_codes8(image.into_rgba8().as_raw())),
        _ => (16, transfer.of_codes16(image.into_rgba16().as_raw())),
    };
    Ok(Picture {
        image: Image::from_pixels(width, height, pixels).expect("four samples for each pixel"),
        format,
        bits,
        has_alpha,
        non_finite: 0,
    })
}

/// From codes to linear values.
#[derive(Debug, Clone, Copy)]
enum Transfer {
    Srgb,
    Power(f32),
    None,
}

impl Transfer {
    /// A `gAMA` chunk of about 1/2.2 is how old programs say sRGB.
    fn new(values: Values, gamma: Option<f64>) -> Self {
        match (values, gamma) {
            (Values::Data, _) => Self::None,
            #[expect(clippy::cast_possible_truncation, reason = "a small exponent")]
            (Values::Color, Some(g)) if g > 0.01 && g < 10.0 && (g - 1.0 / 2.2).abs() > 0.02 => {
                Self::Power((1.0 / g) as f32)
            }
            (Values::Color, _) => Self::Srgb,
        }
    }

    fn linear(self, encoded: f32) -> f32 {
        match self {
            Self::Srgb => linear_from_srgb(encoded),
            Self::Power(exponent) => encoded.powf(exponent),
            Self::None => encoded,
        }
    }

    fn of_codes8(self, codes: &[u8]) -> Vec<[f32; 4]> {
        let own: [f32; 256];
        let table = match self {
            Self::Srgb => linear_from_srgb8_table(),
            _ => {
                own = core::array::from_fn(|code| self.linear(code as f32 / 255.0));
                &own
            }
        };
        let color = |code: u8| table[code as usize];
        let pixels = codes.as_chunks::<4>().0.iter();
        pixels
            .map(|&[r, g, b, a]| [color(r), color(g), color(b), f32::from(a) / 255.0])
            .collect()
    }

    fn of_codes16(self, codes: &[u16]) -> Vec<[f32; 4]> {
        let share = |code: u16| f32::from(code) / 65_535.0;
        let color = |code: u16| self.linear(share(code));
        let pixels = codes.as_chunks::<4>().0.iter();
        pixels
            .map(|&[r, g, b, a]| [color(r), color(g), color(b), share(a)])
            .collect()
    }
}
