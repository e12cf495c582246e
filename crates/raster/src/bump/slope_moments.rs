//! Bumps seen from afar: their slopes' mean and spread, so that what is too small to be seen becomes roughness.
//!
//! A mean normal alone makes a distant bumpy surface as shiny as a flat one. Olano and Baker, *LEAN mapping* (I3D 2010):
//! slopes `b` and their products are averaged, which both may be as they are linear; the covariance
//! `E[b b^T] - E[b] E[b]^T` widens the Gaussian of slopes that a glossy reflection is made of. Toksvig, *Mipmapping normal
//! maps* (Journal of Graphics Tools 10(3), 2005), reads a single number from the mean normal's length.

use crate::Image;
use core::f32::consts::TAU;
use core::ops::{Add, AddAssign, Mul};
use glam::{Vec2, Vec3};

/// Means of slopes and of their products.
///
/// The slopes are those of the height by two lengths or parameters; the plane's normal is `(-b.x, -b.y, 1)` along them.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct SlopeMoments {
    /// `E[b]`
    pub mean: Vec2,
    /// `E[b_x^2], E[b_y^2], E[b_x b_y]`
    pub products: [f32; 3],
}

impl SlopeMoments {
    /// Those of one slope, which does not spread.
    pub fn of(slopes: Vec2) -> Self {
        Self {
            mean: slopes,
            products: [
                slopes.x * slopes.x,
                slopes.y * slopes.y,
                slopes.x * slopes.y,
            ],
        }
    }

    /// Variances and covariance `[xx, yy, xy]`; variances that rounding made negative are 0.
    pub fn covariance(&self) -> [f32; 3] {
        let [xx, yy, xy] = self.products;
        let b = self.mean;
        [
            (xx - b.x * b.x).max(0.0),
            (yy - b.y * b.y).max(0.0),
            xy - b.x * b.y,
        ]
    }

    /// The moments of slopes multiplied by `scale.x` and `scale.y`: from parameters to lengths, or of a stronger bump.
    pub fn scaled(&self, scale: Vec2) -> Self {
        let [xx, yy, xy] = self.products;
        Self {
            mean: self.mean * scale,
            products: [
                xx * scale.x * scale.x,
                yy * scale.y * scale.y,
                xy * scale.x * scale.y,
            ],
        }
    }

    /// Distribution of the slopes `-h.xy / h.z` of half vectors: a Gaussian of this mean, and of this covariance widened by
    /// the roughness of the surface itself, `alpha` in Beckmann's sense (slope variance `alpha^2 / 2`).
    ///
    /// `half` is in the frame of the two lengths and the normal. Per solid angle of the half vector, as a normal
    /// distribution function: `D = P(slope) / cos^4`, which over the hemisphere integrates to 1 against the cosine. 0 for
    /// a half vector below the surface.
    pub fn normal_distribution(&self, half: Vec3, alpha: f32) -> f32 {
        // A covariance of 0 would be an infinite peak; this one is that of 0.06 degrees.
        const SMALLEST: f32 = 1e-6;
        if half.z <= 0.0 {
            return 0.0;
        }
        let own = (0.5 * alpha * alpha).max(SMALLEST);
        let [xx, yy, xy] = self.covariance();
        let (xx, yy) = (xx + own, yy + own);
        // |xy|^2 <= xx yy before own was added, but rounding may break it.
        let determinant = (xx * yy - xy * xy).max(own * own);
        let d = -half.truncate() / half.z - self.mean;
        let q = (yy * d.x * d.x + xx * d.y * d.y - 2.0 * xy * d.x * d.y) / determinant;
        let cos2 = half.z * half.z / half.length_squared();
        (-0.5 * q.max(0.0)).exp() / (TAU * determinant.sqrt() * cos2 * cos2)
    }

    /// Toksvig's exponent for Blinn-Phong reflection: `ft s` with `ft = |Na| / (|Na| + s (1 - |Na|))`, where `|Na|` is the
    /// length of the mean of the unit normals. Here it follows from the spread of the slopes: `|Na| = 1 / (1 + v)` with `v`
    /// their variance, that of the two axes averaged, which gives `1 / (1/s + v)`: variances add, `1/s` being that of the
    /// exponent.
    pub fn toksvig_exponent(&self, exponent: f32) -> f32 {
        let [xx, yy, _] = self.covariance();
        1.0 / (1.0 / exponent + 0.5 * (xx + yy))
    }
}

impl Add for SlopeMoments {
    type Output = Self;
    fn add(self, o: Self) -> Self {
        Self {
            mean: self.mean + o.mean,
            products: [0, 1, 2].map(|k| self.products[k] + o.products[k]),
        }
    }
}

impl AddAssign for SlopeMoments {
    fn add_assign(&mut self, o: Self) {
        *self = *self + o;
    }
}

impl Mul<f32> for SlopeMoments {
    type Output = Self;
    fn mul(self, k: f32) -> Self {
        Self {
            mean: self.mean * k,
            products: self.products.map(|p| p * k),
        }
    }
}

/// Moments at all scales: each level averages areas of the one before, down to a single texel.
#[derive(Debug, Clone, PartialEq)]
pub struct SlopePyramid {
    levels: Vec<Image<SlopeMoments>>,
}

impl SlopePyramid {
    /// From the moments of each texel. An empty picture has a flat surface.
    pub fn new(base: Image<SlopeMoments>) -> Self {
        if base.pixels().is_empty() {
            return Self {
                levels: vec![Image::filled(1, 1, SlopeMoments::default())],
            };
        }
        let mut levels = vec![base];
        while let Some(next) = levels.last().and_then(halved) {
            levels.push(next);
        }
        Self { levels }
    }

    /// Its levels, the finest first.
    pub fn levels(&self) -> &[Image<SlopeMoments>] {
        &self.levels
    }

    /// The moments around a texture coordinate over a pixel's footprint; the texture repeats.
    ///
    /// `d_texcoord` are the derivatives by the pixel's column and row. Up to 16 trilinear samples lie along the longer of
    /// them, each as wide as the footprint is across: what is seen at a grazing angle is long and narrow, and moments of a
    /// round footprint would be those of too much or too little. Flat for numbers that are not finite.
    pub fn sample(&self, texcoord: Vec2, d_texcoord: [Vec2; 2]) -> SlopeMoments {
        let base = &self.levels[0];
        let size = Vec2::new(base.width() as f32, base.height() as f32);
        let [dx, dy] = d_texcoord.map(|d| d * size);
        let (longer, along) = if dx.length_squared() > dy.length_squared() {
            (dx.length(), d_texcoord[0])
        } else {
            (dy.length(), d_texcoord[1])
        };
        let across = dx.perp_dot(dy).abs() / longer.max(f32::MIN_POSITIVE);
        if !texcoord.is_finite() || !longer.is_finite() || !across.is_finite() {
            return SlopeMoments::default();
        }
        let taps = (longer / across.max(1.0)).ceil().clamp(1.0, MOST_TAPS);
        let level = across.max(longer / taps).max(1.0).log2();
        let mut sum = SlopeMoments::default();
        for i in 0..index(taps) {
            let share = (i as f32 + 0.5) / taps - 0.5;
            sum += self.trilinear(texcoord + along * share, level);
        }
        sum * (1.0 / taps)
    }

    /// Bilinear in the two levels around one of them, which is not negative.
    fn trilinear(&self, texcoord: Vec2, level: f32) -> SlopeMoments {
        let coarsest = self.levels.len() - 1;
        let level = level.min(coarsest as f32);
        let fine = index(level);
        let share = level - fine as f32;
        bilinear(&self.levels[fine], texcoord) * (1.0 - share)
            + bilinear(&self.levels[(fine + 1).min(coarsest)], texcoord) * share
    }
}

/// Most samples along a footprint; one that is longer is read blurrier.
const MOST_TAPS: f32 = 16.0;

/// Half as many texels along each side (rounded down, at least 1), each the mean of the area that it covers. `None` for a
/// single texel.
fn halved(level: &Image<SlopeMoments>) -> Option<Image<SlopeMoments>> {
    let (width, height) = (level.width(), level.height());
    if width * height == 1 {
        return None;
    }
    let (w, h) = ((width / 2).max(1), (height / 2).max(1));
    let columns: Vec<_> = (0..w).map(|x| covered(x, w, width)).collect();
    let texel = |i: usize| {
        let mut sum = SlopeMoments::default();
        for &(y, wy) in &covered(i / w, h, height) {
            for &(x, wx) in &columns[i % w] {
                sum += *level.pixel(x, y) * (wx * wy);
            }
        }
        sum
    };
    Image::from_pixels(w, h, (0..w * h).map(texel).collect())
}

/// The texels of `from` that texel `i` of `to` covers, with the shares of its side; they add up to 1.
fn covered(i: usize, to: usize, from: usize) -> Vec<(usize, f32)> {
    // In units of 1/to of a fine texel everything is whole.
    let (start, end) = (i * from, (i + 1) * from);
    let texels = start / to..end.div_ceil(to);
    let share = |x: usize| ((x + 1) * to).min(end) - (x * to).max(start);
    texels.map(|x| (x, share(x) as f32 / from as f32)).collect()
}

/// Bilinear between texel centres, repeating.
fn bilinear(level: &Image<SlopeMoments>, texcoord: Vec2) -> SlopeMoments {
    let (width, height) = (level.width(), level.height());
    let at = (texcoord - texcoord.floor()) * Vec2::new(width as f32, height as f32) - 0.5;
    let first = at.floor();
    let t = at - first;
    let (x0, y0) = (
        index(first.x + width as f32),
        index(first.y + height as f32),
    );
    let texel = |x: usize, y: usize| *level.pixel(x % width, y % height);
    let row = |y: usize| texel(x0, y) * (1.0 - t.x) + texel(x0 + 1, y) * t.x;
    row(y0) * (1.0 - t.y) + row(y0 + 1) * t.y
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "not negative, at most twice a picture's side"
)]
fn index(value: f32) -> usize {
    value as usize
}
