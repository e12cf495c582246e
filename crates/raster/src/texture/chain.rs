//! A texture: a picture and its smaller copies.

use super::mipmap::{MipFilter, Reduction, level_count};
use super::texel::{ByteCodec, Level, Texel};
use super::wrap::Wrap;
use crate::{Image, Rgb};
use glam::Vec4;

/// What the fourth channel of a texture means.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Alpha {
    /// How much of the texel is covered, in [0, 1]: colours count with that weight, and what is transparent has none.
    #[default]
    Coverage,
    /// A number like the other three (a normal map, roughness and metalness packed together).
    Independent,
}

/// How the bytes of red, green and blue encode a number; alpha is always `byte / 255`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Encoding {
    /// Colour in sRGB (IEC 61966-2-1).
    #[default]
    Srgb,
    /// `byte / 255`: data that is no colour.
    Linear,
}

/// How a texture is made.
#[derive(Debug, Clone, PartialEq)]
pub struct TextureOptions {
    /// Whether smaller copies are made; without them minification reads the picture itself. Default value: true.
    pub mipmaps: bool,
    /// How each level is made from the one before. Default value: [`MipFilter::Box`].
    pub filter: MipFilter,
    /// What wide filters read beyond the edges of the picture; a border counts as its edge. Default value: repeat.
    pub wrap: [Wrap; 2],
    /// What the fourth channel means. Default value: [`Alpha::Coverage`].
    pub alpha: Alpha,
    /// Keeps cut-outs from growing thin: each level's alpha is scaled so that the share of its texels above this value
    /// is that of the picture (Castaño 2010). Default value: none.
    pub cutoff: Option<f32>,
}

impl Default for TextureOptions {
    fn default() -> Self {
        Self {
            mipmaps: true,
            filter: MipFilter::Box,
            wrap: [Wrap::Repeat; 2],
            alpha: Alpha::Coverage,
            cutoff: None,
        }
    }
}

impl TextureOptions {
    /// With or without smaller copies.
    pub fn with_mipmaps(mut self, mipmaps: bool) -> Self {
        self.mipmaps = mipmaps;
        self
    }

    /// With this filter between levels.
    pub fn with_filter(mut self, filter: MipFilter) -> Self {
        self.filter = filter;
        self
    }

    /// With these rules for filters that reach beyond the edges.
    pub fn with_wrap(mut self, wrap: [Wrap; 2]) -> Self {
        self.wrap = wrap;
        self
    }

    /// With this meaning of the fourth channel.
    pub fn with_alpha(mut self, alpha: Alpha) -> Self {
        self.alpha = alpha;
        self
    }

    /// With the share of texels above `cutoff` kept.
    pub fn with_cutoff(mut self, cutoff: f32) -> Self {
        self.cutoff = Some(cutoff);
        self
    }
}

/// A picture cannot be a texture.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum TextureError {
    /// It has no texel.
    #[error("a texture of {width} x {height} texels: both sides must be at least 1")]
    Empty {
        /// Texels in a row.
        width: usize,
        /// Rows.
        height: usize,
    },
    /// A side is too long for coordinates of 32 bits.
    #[error(
        "a texture of {width} x {height} texels: a side may have {}; cut or shrink it",
        Texture::MAX_SIDE
    )]
    TooLarge {
        /// Texels in a row.
        width: usize,
        /// Rows.
        height: usize,
    },
}

/// A picture and its smaller copies, each half as wide and high (rounded down, at least 1) as the one before.
///
/// Bytes stay bytes, so a picture of `n` texels takes `16/3 n` bytes as [`Texture::from_rgba8`] and `64/3 n` as
/// [`Texture::new`].
#[derive(Debug, Clone)]
pub struct Texture {
    pub(super) texels: Texels,
    mended: usize,
}

/// The levels in one of two forms.
#[derive(Debug, Clone)]
pub(super) enum Texels {
    Float(Vec<Level<Vec4>>),
    Bytes(Vec<Level<[u8; 4]>>, ByteCodec),
}

impl Texture {
    /// The longest side: of 24 bits of a coordinate near 1 eight are left within a texel, as Direct3D demands.
    pub const MAX_SIDE: usize = 1 << 16;

    /// Texels brighter than this are darkened to it: means of them are finite.
    const BRIGHTEST: f32 = 1e30;

    /// A texture of linear, straight (not premultiplied) red, green, blue, alpha.
    ///
    /// NaN becomes 0, infinities become +-1e30, coverage outside [0, 1] is clamped: one bad pixel is no reason to refuse a
    /// photograph. [`Texture::mended`] tells how many texels were.
    pub fn new(image: &Image<[f32; 4]>, options: &TextureOptions) -> Result<Self, TextureError> {
        let mut mended = 0;
        let texel = |pixel: &[f32; 4]| {
            let (texel, is_good) = usable(Vec4::from_array(*pixel), options.alpha);
            mended += usize::from(!is_good);
            weighted(texel, options.alpha)
        };
        let base = checked(image, texel)?;
        let texels = Texels::Float(chain(base, (), options));
        Ok(Self { texels, mended })
    }

    /// An opaque texture of linear colours.
    pub fn from_rgb(image: &Image<Rgb>, options: &TextureOptions) -> Result<Self, TextureError> {
        Self::new(&image.map(|c| [c.r, c.g, c.b, 1.0]), options)
    }

    /// A texture of bytes, straight (not premultiplied), that stays in bytes.
    ///
    /// Its levels are made in linear light from unrounded ones and rounded when stored. With [`Alpha::Coverage`] the
    /// premultiplied colour of a translucent texel is rounded as well, opaque ones are kept exactly.
    pub fn from_rgba8(
        image: &Image<[u8; 4]>,
        encoding: Encoding,
        options: &TextureOptions,
    ) -> Result<Self, TextureError> {
        let codec = ByteCodec::new(encoding == Encoding::Srgb);
        let texel = |&pixel: &[u8; 4]| match (options.alpha, pixel[3]) {
            (Alpha::Independent, _) | (_, 255) => pixel,
            _ => Texel::encode(weighted(pixel.decode(codec), options.alpha), codec),
        };
        let base = checked(image, texel)?;
        let texels = Texels::Bytes(chain(base, codec, options), codec);
        Ok(Self { texels, mended: 0 })
    }

    /// Texels whose numbers were replaced, see [`Texture::new`].
    pub fn mended(&self) -> usize {
        self.mended
    }

    /// How many levels there are, the picture itself included.
    pub fn levels(&self) -> usize {
        match &self.texels {
            Texels::Float(levels) => levels.len(),
            Texels::Bytes(levels, _) => levels.len(),
        }
    }

    /// Width and height of the picture in texels.
    pub fn size(&self) -> (usize, usize) {
        self.level_size(0)
    }

    /// Width and height of a level.
    ///
    /// # Panics
    /// If there is no such level.
    pub fn level_size(&self, level: usize) -> (usize, usize) {
        match &self.texels {
            Texels::Float(levels) => (levels[level].width, levels[level].height),
            Texels::Bytes(levels, _) => (levels[level].width, levels[level].height),
        }
    }

    /// The texels of a level, linear and, with [`Alpha::Coverage`], premultiplied.
    ///
    /// # Panics
    /// If there is no such level.
    pub fn level(&self, level: usize) -> Image<[f32; 4]> {
        let (width, height) = self.level_size(level);
        let level = match &self.texels {
            Texels::Float(levels) => levels[level].mapped(Vec4::to_array),
            Texels::Bytes(levels, codec) => levels[level].mapped(|t| t.decode(*codec).to_array()),
        };
        Image::from_pixels(width, height, level.texels).expect("a level has its size")
    }

    /// The texels of a level as they are stored, of a texture in bytes ([`Texture::from_rgba8`]); none of one in floats.
    ///
    /// # Panics
    /// If there is no such level.
    pub fn level_bytes(&self, level: usize) -> Option<&[[u8; 4]]> {
        match &self.texels {
            Texels::Float(_) => None,
            Texels::Bytes(levels, _) => Some(&levels[level].texels),
        }
    }

    /// The largest level in floats.
    pub(super) fn base(&self) -> Level<Vec4> {
        match &self.texels {
            Texels::Float(levels) => levels[0].clone(),
            Texels::Bytes(levels, codec) => levels[0].mapped(|t| t.decode(*codec)),
        }
    }

    /// Bytes that the texels take.
    pub fn bytes(&self) -> usize {
        match &self.texels {
            Texels::Float(levels) => levels.iter().map(|l| size_of_val(&*l.texels)).sum(),
            Texels::Bytes(levels, _) => levels.iter().map(|l| size_of_val(&*l.texels)).sum(),
        }
    }
}

/// Divides the colour of a premultiplied sample by its alpha; transparent black where alpha is 0.
pub fn straight(sample: Vec4) -> Vec4 {
    if sample.w > 0.0 {
        (sample / sample.w).with_w(sample.w)
    } else {
        Vec4::ZERO
    }
}

/// The largest level, if the picture can be one.
fn checked<P, T>(image: &Image<P>, texel: impl FnMut(&P) -> T) -> Result<Level<T>, TextureError> {
    let (width, height) = (image.width(), image.height());
    if width.min(height) == 0 {
        return Err(TextureError::Empty { width, height });
    }
    if width.max(height) > Texture::MAX_SIDE {
        return Err(TextureError::TooLarge { width, height });
    }
    let texels = image.pixels().iter().map(texel).collect();
    Ok(Level {
        width,
        height,
        texels,
    })
}

/// A texel with numbers that can be averaged, and whether it had them before.
fn usable(texel: Vec4, alpha: Alpha) -> (Vec4, bool) {
    let number = |x: f32| {
        if x.is_nan() {
            0.0
        } else {
            x.clamp(-Texture::BRIGHTEST, Texture::BRIGHTEST)
        }
    };
    let mut mended = Vec4::from_array(texel.to_array().map(number));
    if alpha == Alpha::Coverage {
        mended.w = mended.w.clamp(0.0, 1.0);
    }
    (mended, mended == texel)
}

/// The texel as it is averaged.
fn weighted(texel: Vec4, alpha: Alpha) -> Vec4 {
    match alpha {
        Alpha::Coverage => (texel * texel.w).with_w(texel.w),
        Alpha::Independent => texel,
    }
}

/// All levels from the largest one.
fn chain<T: Texel>(base: Level<T>, codec: T::Codec, options: &TextureOptions) -> Vec<Level<T>> {
    if !options.mipmaps {
        return vec![base];
    }
    let count = level_count(base.width, base.height);
    let reduction = Reduction::new(options, &base, codec);
    let mut levels = Vec::with_capacity(count);
    levels.push(base);
    if count > 1 {
        // Rounded levels are never reduced again: errors of bytes do not add up.
        let mut exact = reduction.reduced(&levels[0], codec);
        levels.push(reduction.stored(&exact, codec));
        while levels.len() < count {
            exact = reduction.reduced(&exact, ());
            levels.push(reduction.stored(&exact, codec));
        }
    }
    levels
}
