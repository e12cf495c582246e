//! Normal maps whose variance survives filtering: LEAN mapping and Toksvig's factor.

use super::chain::{Alpha, Texture, TextureError, TextureOptions};
use super::sampler::Sampler;
use crate::Image;
use glam::{Vec2, Vec3, Vec4, Vec4Swizzles};

/// A normal map in tangent space with all that filtering must keep of it.
///
/// The mean of normals says where a bumpy surface faces, not how rough it looks from afar. So the mip levels hold the
/// moments of the slopes `b = (n_x / n_z, n_y / n_z)`, that is `b`, `b_x^2`, `b_y^2` and `b_x b_y` (LEAN mapping, Olano and
/// Baker 2010), beside the mean of the unit normals, whose length tells their spread (Toksvig 2005). All are plain means,
/// so every filter of [`Sampler`] works on them.
#[derive(Debug, Clone)]
pub struct NormalMap {
    /// Mean unit normal, and mean of `b_x b_y`.
    normals: Texture,
    /// Means of `b_x`, `b_y`, `b_x^2`, `b_y^2`.
    slopes: Texture,
}

/// Smallest z of a unit normal that counts: steeper slopes are cut to 16.
const SMALLEST_Z: f32 = 1.0 / 16.0;

impl NormalMap {
    /// From normals in [-1, 1], z out of the surface; any length but 0. What is NaN or without length is `+z`.
    ///
    /// Of `options` count filter, wrapping and mipmaps.
    pub fn new(image: &Image<[f32; 3]>, options: &TextureOptions) -> Result<Self, TextureError> {
        let options = TextureOptions {
            alpha: Alpha::Independent,
            cutoff: None,
            ..options.clone()
        };
        let unit = |n: &[f32; 3]| Vec3::from_array(*n).try_normalize().unwrap_or(Vec3::Z);
        let slope = |n: Vec3| n.truncate() / n.z.max(SMALLEST_Z);
        let normals = image.map(|n| {
            let (n, b) = (unit(n), slope(unit(n)));
            [n.x, n.y, n.z, b.x * b.y]
        });
        let slopes = image.map(|n| {
            let b = slope(unit(n));
            [b.x, b.y, b.x * b.x, b.y * b.y]
        });
        Ok(Self {
            normals: Texture::new(&normals, &options)?,
            slopes: Texture::new(&slopes, &options)?,
        })
    }

    /// From bytes as files store them, `2 byte / 255 - 1`.
    pub fn from_rgb8(
        image: &Image<[u8; 3]>,
        options: &TextureOptions,
    ) -> Result<Self, TextureError> {
        let normal = |bytes: &[u8; 3]| bytes.map(|byte| f32::from(byte) / 127.5 - 1.0);
        Self::new(&image.map(normal), options)
    }

    /// The normals as a pixel sees them; see [`Sampler::sample_grad`].
    pub fn sample_grad(&self, sampler: &Sampler, uv: Vec2, ddx: Vec2, ddy: Vec2) -> FilteredNormal {
        let read = |texture| sampler.sample_grad(texture, uv, ddx, ddy);
        FilteredNormal::from_means(read(&self.normals), read(&self.slopes))
    }

    /// The normals at a point and a level of detail; see [`Sampler::sample_lod`].
    pub fn sample_lod(&self, sampler: &Sampler, uv: Vec2, lod: f32) -> FilteredNormal {
        let read = |texture| sampler.sample_lod(texture, uv, lod);
        FilteredNormal::from_means(read(&self.normals), read(&self.slopes))
    }
}

/// What a pixel sees of a normal map.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FilteredNormal {
    /// Mean of the unit normals: shorter than 1 the more they differ.
    pub mean: Vec3,
    /// Mean slope `(n_x / n_z, n_y / n_z)`.
    pub slope: Vec2,
    /// Variance of the slopes along x and along y and their covariance.
    pub covariance: Vec3,
}

impl FilteredNormal {
    fn from_means(normals: Vec4, slopes: Vec4) -> Self {
        let (b, squares) = (slopes.xy(), slopes.zw());
        let variance = (squares - b * b).max(Vec2::ZERO);
        // Rounding and negative lobes of filters may leave what no set of slopes has.
        let limit = (variance.x * variance.y).sqrt();
        let covariance = (normals.w - b.x * b.y).clamp(-limit, limit);
        Self {
            mean: normals.xyz(),
            slope: b,
            covariance: variance.extend(covariance),
        }
    }

    /// The unit normal of the mean slope, for shading.
    pub fn normal(&self) -> Vec3 {
        self.slope.extend(1.0).normalize()
    }

    /// Toksvig's factor `f = |N| / (|N| + s (1 - |N|))` for a Blinn-Phong exponent `s`: the exponent becomes `f s`, the
    /// highlight is scaled by `(1 + f s) / (1 + s)`. 1 where all normals agree, 0 where they cancel.
    pub fn toksvig_factor(&self, exponent: f32) -> f32 {
        let length = self.mean.length().min(1.0);
        let spread = exponent.max(0.0) * (1.0 - length);
        if length == 0.0 {
            0.0
        } else {
            length / (length + spread)
        }
    }

    /// The covariance of a Beckmann distribution of slopes (`xx`, `yy`, `xy`) whose surface is rough already: a base of
    /// roughness `alpha` adds `alpha^2 / 2` to both variances; in terms of a Blinn-Phong exponent `s` that is `1 / s`.
    pub fn beckmann_covariance(&self, alpha: f32) -> Vec3 {
        let base = 0.5 * alpha * alpha;
        self.covariance + Vec3::new(base, base, 0.0)
    }

    /// The roughness `alpha` of the isotropic Beckmann (or GGX) distribution with the same mean variance:
    /// `sqrt(alpha^2 + var_x + var_y)`, since `alpha^2 / 2` is the variance along one axis.
    pub fn roughness(&self, alpha: f32) -> f32 {
        (alpha * alpha + self.covariance.x + self.covariance.y).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Normals of the slopes of each texel.
    fn map(width: usize, height: usize, slope: impl Fn(usize, usize) -> Vec2) -> NormalMap {
        let normal = |i: usize| {
            let n = slope(i % width, i / width).extend(1.0);
            n.normalize().to_array()
        };
        let pixels = (0..width * height).map(normal).collect();
        let image = Image::from_pixels(width, height, pixels).expect("one normal per texel");
        NormalMap::new(&image, &TextureOptions::default()).expect("it has texels")
    }

    #[test]
    fn grooves_from_afar_are_flat_and_rough_across() {
        // Slopes +-0.5 along x in turns, 0 along y.
        let grooves = map(16, 8, |x, _| {
            Vec2::new(if x % 2 == 0 { 0.5 } else { -0.5 }, 0.0)
        });
        let sampler = Sampler::default();
        let far = grooves.sample_lod(&sampler, Vec2::new(0.3, 0.6), 10.0);
        assert!((far.normal() - Vec3::Z).length() < 1e-6, "{far:?}");
        assert!(
            (far.covariance - Vec3::new(0.25, 0.0, 0.0)).length() < 1e-6,
            "{far:?}"
        );
        assert!(
            (far.roughness(0.0) - 0.5).abs() < 1e-6,
            "{}",
            far.roughness(0.0)
        );
        // Both normals have z = 1 / sqrt(1.25), so has their mean.
        let length = 1.0 / 1.25_f32.sqrt();
        assert!((far.mean.length() - length).abs() < 1e-6, "{far:?}");
        let factor = length / (length + 64.0 * (1.0 - length));
        assert!(
            (far.toksvig_factor(64.0) - factor).abs() < 1e-6,
            "{}",
            far.toksvig_factor(64.0)
        );
        // Seen from near, texel by texel, there is no spread.
        let near = grooves.sample_lod(&sampler, Vec2::new(2.5 / 16.0, 0.5 / 8.0), -1.0);
        assert!(
            (near.slope - Vec2::new(0.5, 0.0)).length() < 1e-6,
            "{near:?}"
        );
        assert!(
            near.covariance.length() < 1e-6 && (near.toksvig_factor(64.0) - 1.0).abs() < 1e-5,
            "{near:?}"
        );
    }

    #[test]
    fn moments_are_those_of_all_slopes_for_any_size() {
        let slope = |x: usize, y: usize| {
            let (x, y) = (x as f32, y as f32);
            Vec2::new(
                (1.7 * x + y).sin(),
                0.5 * (x - 2.3 * y).cos() + 0.3 * (1.7 * x + y).sin(),
            )
        };
        let (width, height) = (37, 21);
        let far = map(width, height, slope).sample_lod(&Sampler::default(), Vec2::ZERO, 20.0);
        let slopes: Vec<Vec2> = (0..width * height)
            .map(|i| slope(i % width, i / width))
            .collect();
        let mean = |f: &dyn Fn(Vec2) -> f32| {
            slopes.iter().map(|&b| f(b)).sum::<f32>() / slopes.len() as f32
        };
        let (x, y) = (mean(&|b| b.x), mean(&|b| b.y));
        let expected = Vec3::new(
            mean(&|b| (b.x - x).powi(2)),
            mean(&|b| (b.y - y).powi(2)),
            mean(&|b| (b.x - x) * (b.y - y)),
        );
        assert!((far.slope - Vec2::new(x, y)).length() < 1e-5, "{far:?}");
        assert!(
            (far.covariance - expected).length() < 1e-5,
            "{far:?}, not {expected}"
        );
        assert!(expected.z > 0.1, "the slopes are correlated");
    }

    #[test]
    fn broken_normals_point_out() {
        let image = Image::from_pixels(2, 1, vec![[f32::NAN; 3], [0.0; 3]]).expect("two");
        let map = NormalMap::new(&image, &TextureOptions::default()).expect("it has texels");
        let seen = map.sample_lod(&Sampler::default(), Vec2::ZERO, 0.5);
        assert_eq!(seen.normal(), Vec3::Z, "{seen:?}");
    }
}
