//! Pictures on surfaces.

use glam::Vec2;
use hemicube_raster::color::linear_from_srgb8_table;
use hemicube_raster::{Image, texture};
use serde::{Deserialize, Serialize};
use std::io::Cursor;
use std::sync::{Arc, OnceLock};

/// Largest side and largest decoded size that a texture may have; a larger one is refused before it is decoded.
const MAX_SIDE: u32 = 16_384;
const MAX_DECODED_BYTES: u64 = 256 << 20;

/// How coordinates outside [0, 1] are brought back.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum Wrap {
    /// The picture repeats.
    #[default]
    Repeat,
    /// It repeats with every second copy mirrored.
    MirroredRepeat,
    /// Its border goes on.
    ClampToEdge,
}

impl From<Wrap> for texture::Wrap {
    fn from(wrap: Wrap) -> Self {
        match wrap {
            Wrap::Repeat => Self::Repeat,
            Wrap::MirroredRepeat => Self::MirroredRepeat,
            Wrap::ClampToEdge => Self::ClampToEdge,
        }
    }
}

/// What the numbers of a picture stand for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum TextureUse {
    /// Colours in sRGB; alpha means nothing.
    Color,
    /// Colours in sRGB, and how much of the texel they cover: they are averaged with that weight, and samples are
    /// premultiplied.
    ColorAndAlpha,
    /// Four numbers as they are.
    Data,
}

/// What the file asks for where a texel covers more than a sample.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum Magnify {
    /// The texel that is nearest.
    Nearest,
    /// Interpolated between four.
    #[default]
    Linear,
}

/// What the file asks for where a sample covers more than a texel.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum Minify {
    /// The nearest texel of the whole picture.
    Nearest,
    /// Four texels of the whole picture.
    Linear,
    /// Any way of averaging; files that say nothing, or name a kind of mipmap, mean this.
    #[default]
    Mipmap,
}

/// A picture with a rule for its borders.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Texture {
    /// Index into [`Scene::images`](crate::Scene::images).
    pub image: usize,
    /// Rules along u and v.
    pub wrap: [Wrap; 2],
    /// What the file asks for close up.
    pub magnify: Magnify,
    /// And from afar.
    pub minify: Minify,
}

impl Texture {
    /// A picture with the usual filters.
    pub fn new(image: usize, wrap: [Wrap; 2]) -> Self {
        Self {
            image,
            wrap,
            magnify: Magnify::default(),
            minify: Minify::default(),
        }
    }
}

/// A PNG, JPEG or WebP file and its pixels.
///
/// The file's bytes are kept so that an export hands on exactly what came in; of WebP, which glTF does not know without
/// an extension, the pixels as PNG.
#[derive(Debug, Clone)]
pub struct TextureImage {
    /// Name from the scene file.
    pub name: String,
    encoded: Arc<[u8]>,
    media_type: &'static str,
    pixels: Arc<Image<[u8; 4]>>,
    /// Mip chains by wraps and use, each made at its first use and shared by all clones.
    chains: Arc<[OnceLock<texture::Texture>; 27]>,
}

impl TextureImage {
    /// Decodes a PNG, JPEG or WebP file; the error says in words why it cannot be used.
    pub fn decode(name: impl Into<String>, encoded: impl Into<Arc<[u8]>>) -> Result<Self, String> {
        let encoded = encoded.into();
        let mut reader = image::ImageReader::new(Cursor::new(&encoded))
            .with_guessed_format()
            .map_err(|e| e.to_string())?;
        let media_type = match reader.format() {
            Some(image::ImageFormat::Png) => "image/png",
            Some(image::ImageFormat::Jpeg) => "image/jpeg",
            Some(image::ImageFormat::WebP) => "image/webp",
            _ => return Err(String::from("it is neither PNG, JPEG nor WebP")),
        };
        let mut limits = image::Limits::default();
        limits.max_image_width = Some(MAX_SIDE);
        limits.max_image_height = Some(MAX_SIDE);
        limits.max_alloc = Some(MAX_DECODED_BYTES);
        reader.limits(limits);
        let decoded = reader.decode().map_err(|e| e.to_string())?.into_rgba8();
        let (width, height) = (decoded.width() as usize, decoded.height() as usize);
        let pixels = decoded
            .into_raw()
            .chunks_exact(4)
            .map(|p| [p[0], p[1], p[2], p[3]])
            .collect();
        let pixels =
            Image::from_pixels(width, height, pixels).ok_or("its size does not fit its pixels")?;
        if media_type == "image/webp" {
            return Ok(Self::from_pixels(name, pixels));
        }
        Ok(Self {
            name: name.into(),
            encoded,
            media_type,
            pixels: Arc::new(pixels),
            chains: Arc::default(),
        })
    }

    /// A picture made by the program, kept as PNG.
    pub fn from_pixels(name: impl Into<String>, pixels: Image<[u8; 4]>) -> Self {
        let mut encoded = Vec::new();
        let (width, height) = (pixels.width(), pixels.height());
        let bytes: Vec<u8> = pixels.pixels().iter().flatten().copied().collect();
        let encoder = image::codecs::png::PngEncoder::new(&mut encoded);
        let side = |n: usize| u32::try_from(n).expect("a texture's side fits 32 bits");
        image::ImageEncoder::write_image(
            encoder,
            &bytes,
            side(width),
            side(height),
            image::ExtendedColorType::Rgba8,
        )
        .expect("encoding into memory does not fail");
        Self {
            name: name.into(),
            encoded: encoded.into(),
            media_type: "image/png",
            pixels: Arc::new(pixels),
            chains: Arc::default(),
        }
    }

    /// The bytes of the file.
    pub fn encoded(&self) -> &[u8] {
        &self.encoded
    }

    /// `image/png` or `image/jpeg`.
    pub fn media_type(&self) -> &'static str {
        self.media_type
    }

    /// The decoded pixels, red, green, blue, alpha as stored (colour sRGB-encoded where the material says so).
    pub fn pixels(&self) -> &Image<[u8; 4]> {
        &self.pixels
    }

    /// The picture and its smaller copies, made in linear light at the first call for these wraps and this use.
    pub fn chain(&self, wrap: [Wrap; 2], usage: TextureUse) -> &texture::Texture {
        let number = (wrap[0] as usize * 3 + wrap[1] as usize) * 3 + usage as usize;
        self.chains[number].get_or_init(|| {
            let (alpha, encoding) = match usage {
                TextureUse::Color => (texture::Alpha::Independent, texture::Encoding::Srgb),
                TextureUse::ColorAndAlpha => (texture::Alpha::Coverage, texture::Encoding::Srgb),
                TextureUse::Data => (texture::Alpha::Independent, texture::Encoding::Linear),
            };
            let options = texture::TextureOptions::default()
                .with_wrap(wrap.map(texture::Wrap::from))
                .with_alpha(alpha);
            texture::Texture::from_rgba8(&self.pixels, encoding, &options)
                .expect("decoded pictures have texels and bounded sides")
        })
    }

    /// Bilinear sample at texture coordinates, filtered in linear light; colour is decoded from sRGB if `srgb`.
    ///
    /// Coordinates that are not finite read the first texel.
    pub fn sample(&self, at: Vec2, wrap: [Wrap; 2], srgb: bool) -> [f32; 4] {
        let at = if at.is_finite() { at } else { Vec2::ZERO };
        let (x, fx) = texel_and_fraction(at.x, self.pixels.width());
        let (y, fy) = texel_and_fraction(at.y, self.pixels.height());
        let table = linear_from_srgb8_table();
        let mut sum = [0.0; 4];
        for (dy, wy) in [(0, 1.0 - fy), (1, fy)] {
            for (dx, wx) in [(0, 1.0 - fx), (1, fx)] {
                let column = wrapped(x + dx, self.pixels.width(), wrap[0]);
                let row = wrapped(y + dy, self.pixels.height(), wrap[1]);
                let texel = self.pixels.pixel(column, row);
                for (channel, total) in sum.iter_mut().enumerate() {
                    let code = texel[channel];
                    let value = if srgb && channel < 3 {
                        table[code as usize]
                    } else {
                        f32::from(code) / 255.0
                    };
                    *total += wx * wy * value;
                }
            }
        }
        sum
    }
}

/// The lower texel of the pair around a coordinate, and the weight of the upper one (Vulkan 1.3, 16.6.1).
#[expect(
    clippy::cast_possible_truncation,
    reason = "float to integer casts saturate, wrapping brings them back"
)]
fn texel_and_fraction(coordinate: f32, size: usize) -> (i64, f32) {
    let position = f64::from(coordinate) * size as f64 - 0.5;
    let lower = position.floor();
    (lower as i64, (position - lower) as f32)
}

/// Index of a texel inside the picture.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    clippy::cast_possible_wrap,
    reason = "in 0..size"
)]
fn wrapped(index: i64, size: usize, wrap: Wrap) -> usize {
    let size = size as i64;
    let inside = match wrap {
        Wrap::Repeat => index.rem_euclid(size),
        Wrap::ClampToEdge => index.clamp(0, size - 1),
        Wrap::MirroredRepeat => {
            let period = index.rem_euclid(2 * size);
            if period < size {
                period
            } else {
                2 * size - 1 - period
            }
        }
    };
    inside as usize
}
