//! Samplers: how a texture is read.

use super::chain::{Texels, Texture};
use super::cubic::Cubic;
use super::lod::{Footprint, Log2, linear_levels, nearest_level};
use super::texel::{Level, Reader, Texel};
use super::wrap::Wrap;
use glam::{DVec2, Vec2, Vec4};

/// What is read where a texel is larger than a pixel.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Magnify {
    /// The texel that holds the point: blocks.
    Point,
    /// The four texels around it, by nearness.
    #[default]
    Bilinear,
    /// Sixteen texels under a cubic kernel.
    Bicubic(Cubic),
}

/// What is read where a pixel is larger than a texel.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Minify {
    /// One texel of the picture: fast, and all that is between is missed.
    Point,
    /// Four texels of the picture: no better beyond a factor of two.
    Bilinear,
    /// Four texels of the nearest mip level; where levels meet an edge is seen.
    NearestMipmap,
    /// Four texels of each of the two levels around the level of detail: blurs what is seen at an angle.
    #[default]
    Trilinear,
    /// Several trilinear samples along the footprint, as Vulkan describes it.
    Anisotropic,
    /// Elliptical weighted average (Heckbert 1989): all texels of a level under the footprint, by a Gaussian.
    Ewa,
}

/// Which shape stands for the footprint of a pixel.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Shape {
    /// The two derivatives as they are, as GPUs take them.
    #[default]
    Derivatives,
    /// The axes of the ellipse that they span ([`Footprint::axes`]), as Direct3D's reference does. EWA always takes these.
    Ellipse,
}

/// How a texture is read.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sampler {
    /// Addressing along u and v. Default value: [`Wrap::Repeat`].
    pub wrap: [Wrap; 2],
    /// What [`Wrap::Border`] reads outside; premultiplied. Default value: transparent black.
    pub border: Vec4,
    /// Filter where texels are larger than pixels. Default value: [`Magnify::Bilinear`].
    pub magnify: Magnify,
    /// Filter where pixels are larger than texels. Default value: [`Minify::Trilinear`].
    pub minify: Minify,
    /// Added to the level of detail: above 0 blurrier, below 0 sharper. EWA reads that much coarser or finer a level
    /// through the same ellipse, so -1 is four times the work and a better answer. NaN counts as 0. Default value: 0.
    pub lod_bias: f32,
    /// Least and greatest level of detail. NaN counts as no limit. Default value: no limits.
    pub lod_range: [f32; 2],
    /// How much longer than wide a footprint may be, from 1 to 256, for [`Minify::Anisotropic`] and [`Minify::Ewa`]; beyond,
    /// it is read blurrier. Default value: 16.
    pub max_anisotropy: f32,
    /// The shape of footprints. Default value: [`Shape::Derivatives`].
    pub shape: Shape,
    /// How logarithms are taken. Default value: [`Log2::Exact`].
    pub log2: Log2,
}

impl Default for Sampler {
    fn default() -> Self {
        Self {
            wrap: [Wrap::Repeat; 2],
            border: Vec4::ZERO,
            magnify: Magnify::default(),
            minify: Minify::default(),
            lod_bias: 0.0,
            lod_range: [f32::NEG_INFINITY, f32::INFINITY],
            max_anisotropy: 16.0,
            shape: Shape::default(),
            log2: Log2::default(),
        }
    }
}

impl Sampler {
    /// With this addressing along u and v.
    pub fn with_wrap(mut self, wrap: [Wrap; 2]) -> Self {
        self.wrap = wrap;
        self
    }

    /// With this (premultiplied) colour outside.
    pub fn with_border(mut self, border: Vec4) -> Self {
        self.border = border;
        self
    }

    /// With this filter for magnification.
    pub fn with_magnify(mut self, magnify: Magnify) -> Self {
        self.magnify = magnify;
        self
    }

    /// With this filter for minification.
    pub fn with_minify(mut self, minify: Minify) -> Self {
        self.minify = minify;
        self
    }

    /// With this added to the level of detail.
    pub fn with_lod_bias(mut self, lod_bias: f32) -> Self {
        self.lod_bias = lod_bias;
        self
    }

    /// With levels of detail within these limits.
    pub fn with_lod_range(mut self, least: f32, greatest: f32) -> Self {
        self.lod_range = [least, greatest];
        self
    }

    /// With footprints at most so much longer than wide.
    pub fn with_max_anisotropy(mut self, max_anisotropy: f32) -> Self {
        self.max_anisotropy = max_anisotropy;
        self
    }

    /// With this shape of footprints.
    pub fn with_shape(mut self, shape: Shape) -> Self {
        self.shape = shape;
        self
    }

    /// With logarithms taken so.
    pub fn with_log2(mut self, log2: Log2) -> Self {
        self.log2 = log2;
        self
    }

    /// The texture at a point, by the filter for magnification.
    #[inline]
    pub fn sample(&self, texture: &Texture, uv: Vec2) -> Vec4 {
        match &texture.texels {
            Texels::Float(levels) => Chain::new(self, levels, ()).magnified(finite(uv)),
            Texels::Bytes(levels, codec) => Chain::new(self, levels, *codec).magnified(finite(uv)),
        }
    }

    /// The texture at a point and a level of detail; bias and limits are added. [`Minify::Anisotropic`] and
    /// [`Minify::Ewa`] have no footprint here and are trilinear.
    #[inline]
    pub fn sample_lod(&self, texture: &Texture, uv: Vec2, lod: f32) -> Vec4 {
        match &texture.texels {
            Texels::Float(levels) => Chain::new(self, levels, ()).at_lod(finite(uv), lod),
            Texels::Bytes(levels, codec) => {
                Chain::new(self, levels, *codec).at_lod(finite(uv), lod)
            }
        }
    }

    /// The texture as a pixel sees it whose texture coordinates change by `ddx` to the right neighbour and by `ddy` to the
    /// one below ([`TexcoordPlanes`](super::TexcoordPlanes) has them).
    #[inline]
    pub fn sample_grad(&self, texture: &Texture, uv: Vec2, ddx: Vec2, ddy: Vec2) -> Vec4 {
        match &texture.texels {
            Texels::Float(levels) => {
                Chain::new(self, levels, ()).with_footprint(finite(uv), ddx, ddy)
            }
            Texels::Bytes(levels, codec) => {
                Chain::new(self, levels, *codec).with_footprint(finite(uv), ddx, ddy)
            }
        }
    }

    /// The level of detail after bias and limits.
    fn limited(&self, lod: f32) -> f32 {
        let bias = if self.lod_bias.is_nan() {
            0.0
        } else {
            self.lod_bias
        };
        // The maximum and minimum with NaN is the other number.
        (lod + bias).max(self.lod_range[0]).min(self.lod_range[1])
    }

    fn anisotropy_limit(&self) -> f32 {
        if self.max_anisotropy.is_nan() {
            1.0
        } else {
            self.max_anisotropy.clamp(1.0, 256.0)
        }
    }
}

/// Coordinates that can be counted with.
#[inline]
pub(super) fn finite(uv: Vec2) -> DVec2 {
    let number = |x: f32| if x.is_finite() { f64::from(x) } else { 0.0 };
    DVec2::new(number(uv.x), number(uv.y))
}

/// Widest minor axis that EWA reads, in texels of a level: a limit on levels would make it read whole pictures.
const WIDEST: f32 = 8.0;

/// A sampler and the levels that it reads.
struct Chain<'a, T: Texel> {
    sampler: &'a Sampler,
    levels: &'a [Level<T>],
    codec: T::Codec,
}

impl<'a, T: Texel> Chain<'a, T> {
    #[inline(always)]
    fn new(sampler: &'a Sampler, levels: &'a [Level<T>], codec: T::Codec) -> Self {
        Self {
            sampler,
            levels,
            codec,
        }
    }

    #[inline(always)]
    fn reader(&self, level: usize) -> Reader<'a, T> {
        Reader {
            level: &self.levels[level],
            codec: self.codec,
            wrap: self.sampler.wrap,
            border: self.sampler.border,
        }
    }

    fn last(&self) -> usize {
        self.levels.len() - 1
    }

    fn magnified(&self, uv: DVec2) -> Vec4 {
        let reader = self.reader(0);
        match self.sampler.magnify {
            Magnify::Point => reader.nearest(uv),
            Magnify::Bilinear => reader.bilinear(uv),
            Magnify::Bicubic(cubic) => reader.bicubic(uv, cubic),
        }
    }

    /// One sample by magnification or from mip levels; NaN counts as minus infinity.
    fn at_lod(&self, uv: DVec2, lod: f32) -> Vec4 {
        let lod = self.sampler.limited(lod);
        if lod.is_nan() || lod <= 0.0 {
            return self.magnified(uv);
        }
        let lod = lod.min(self.last() as f32);
        match self.sampler.minify {
            Minify::Point => self.reader(0).nearest(uv),
            Minify::Bilinear => self.reader(0).bilinear(uv),
            Minify::NearestMipmap => self.reader(nearest_level(lod)).bilinear(uv),
            Minify::Trilinear | Minify::Anisotropic | Minify::Ewa => {
                self.blended(lod, |reader| reader.bilinear(uv))
            }
        }
    }

    /// The mean of two levels by nearness to a level of detail within the chain.
    #[inline]
    fn blended(&self, lod: f32, read: impl Fn(Reader<'a, T>) -> Vec4) -> Vec4 {
        let (upper, lower, weight) = linear_levels(lod, self.last());
        let sharp = read(self.reader(upper));
        if weight == 0.0 {
            return sharp;
        }
        sharp + (read(self.reader(lower)) - sharp) * weight
    }

    fn with_footprint(&self, uv: DVec2, ddx: Vec2, ddy: Vec2) -> Vec4 {
        let base = &self.levels[0];
        let mut footprint = Footprint::new(ddx, ddy, (base.width, base.height));
        if !footprint.is_finite() {
            return self.at_lod(uv, f32::INFINITY);
        }
        if self.sampler.shape == Shape::Ellipse || self.sampler.minify == Minify::Ewa {
            footprint = footprint.axes();
        }
        match self.sampler.minify {
            Minify::Anisotropic => self.anisotropic(uv, &footprint),
            Minify::Ewa => self.elliptical(uv, &footprint),
            _ => self.at_lod(uv, footprint.lod(self.sampler.log2)),
        }
    }

    /// `1/N` of samples at `-1/2 + i / (N + 1)`, `i = 1..N`, along the longer side (Vulkan, informative).
    fn anisotropic(&self, uv: DVec2, footprint: &Footprint) -> Vec4 {
        let lod = footprint.anisotropic_lod(self.sampler.anisotropy_limit(), self.sampler.log2);
        let base = &self.levels[0];
        let along = lod.along.as_dvec2() / DVec2::new(base.width as f64, base.height as f64);
        let mut sum = Vec4::ZERO;
        for i in 1..=lod.samples {
            let place = f64::from(i) / f64::from(lod.samples + 1) - 0.5;
            sum += self.at_lod(uv + along * place, lod.lod);
        }
        sum / f32::from(lod.samples)
    }

    /// EWA in the two levels where the shorter axis is one to two texels long.
    fn elliptical(&self, uv: DVec2, axes: &Footprint) -> Vec4 {
        let log2 = self.sampler.log2;
        if self.sampler.limited(axes.lod(log2)) <= 0.0 {
            return self.magnified(uv);
        }
        let major = axes.dx.length();
        let minor = axes
            .dy
            .length()
            .max(major / self.sampler.anisotropy_limit());
        let across = axes.dx.perp() / major * minor;
        let lod = self
            .sampler
            .limited(log2.half_log2(minor * minor))
            .clamp(0.0, self.last() as f32);
        self.blended(lod, |reader| {
            reader.ewa_limited(uv, axes.dx, across, &self.levels[0])
        })
    }
}

impl<T: Texel> Reader<'_, T> {
    /// [`Reader::ewa`] of axes in texels of the largest level, shortened to what may be read.
    fn ewa_limited(&self, uv: DVec2, d0: Vec2, d1: Vec2, base: &Level<T>) -> Vec4 {
        let ratio = |small: usize, large: usize| small as f32 / large as f32;
        let scale = Vec2::new(
            ratio(self.level.width, base.width),
            ratio(self.level.height, base.height),
        );
        let (d0, d1) = (d0 * scale, d1 * scale);
        let shrink = (WIDEST / d1.length()).min(1.0);
        self.ewa(uv, d0 * shrink, d1 * shrink)
    }
}
