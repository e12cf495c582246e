//! Phong's reflection models: how much light a glossy surface sends from one direction into another.
//!
//! All directions point away from the surface and have length 1. The classic lobes have a peak of 1 and add light as the
//! exponent falls; the normalised ones are reflectance distributions (per steradian) that never send back more than they
//! get.

use core::f32::consts::{PI, TAU};
use glam::Vec3;

/// Phong, *Illumination for computer generated pictures* (CACM 1975): the angle between the mirrored light and the eye.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Phong {
    /// How narrow the highlight is, not negative. Its slope variance is about `1 / (4 exponent)`, see [`BlinnPhong`].
    pub exponent: f32,
}

/// Blinn, *Models of light reflection for computer synthesized pictures* (SIGGRAPH 1977): the angle between the normal
/// and the half vector of light and eye.
///
/// Four times Phong's exponent gives a highlight of the same size around the mirror direction, but one that becomes
/// narrow across and long along at grazing angles, as on a wet road.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BlinnPhong {
    /// How narrow the highlight is, not negative; slopes of microscopic facets have the variance `1 / exponent` along each
    /// axis (approximately: the Gaussian of the same peak).
    pub exponent: f32,
}

impl Phong {
    /// A model of such an exponent.
    pub const fn new(exponent: f32) -> Self {
        Self { exponent }
    }

    /// The classic lobe `max(r . v, 0)^n`, `r` the light mirrored at the normal; 0 if light or eye is behind the surface.
    pub fn lobe(&self, normal: Vec3, light: Vec3, view: Vec3) -> f32 {
        if normal.dot(light) <= 0.0 || normal.dot(view) <= 0.0 {
            return 0.0;
        }
        mirrored(normal, light)
            .dot(view)
            .max(0.0)
            .powf(self.exponent)
    }

    /// The lobe times `(n + 2) / 2 pi` (Lafortune and Willems 1994): all light along the normal comes back, and less from
    /// the side, where half of the lobe is below the surface.
    pub fn reflectance(&self, normal: Vec3, light: Vec3, view: Vec3) -> f32 {
        self.lobe(normal, light, view) * (self.exponent + 2.0) / TAU
    }
}

impl BlinnPhong {
    /// A model of such an exponent.
    pub const fn new(exponent: f32) -> Self {
        Self { exponent }
    }

    /// The exponent with facets of Beckmann's roughness `alpha`: `2 / alpha^2 - 2`, at least 0 (Walter et al. 2007).
    pub fn from_roughness(alpha: f32) -> Self {
        Self::new((2.0 / (alpha * alpha) - 2.0).max(0.0))
    }

    /// The classic lobe `max(n . h, 0)^n`; 0 if light or eye is behind the surface.
    pub fn lobe(&self, normal: Vec3, light: Vec3, view: Vec3) -> f32 {
        if normal.dot(light) <= 0.0 || normal.dot(view) <= 0.0 {
            return 0.0;
        }
        let half = (light + view).normalize_or_zero();
        normal.dot(half).max(0.0).powf(self.exponent)
    }

    /// The lobe times `(n + 2)(n + 4) / (8 pi (2^(-n/2) + n))`, the exact factor with which all light along the normal
    /// comes back (Giesen 2009). Towards grazing angles it falls, so more never comes back.
    pub fn reflectance(&self, normal: Vec3, light: Vec3, view: Vec3) -> f32 {
        self.lobe(normal, light, view) * self.normalization()
    }

    /// What [`Self::reflectance`] multiplies the lobe by.
    pub fn normalization(&self) -> f32 {
        let n = self.exponent;
        (n + 2.0) * (n + 4.0) / (8.0 * PI * ((-0.5 * n).exp2() + n))
    }

    /// The lobe as a distribution of facet normals per solid angle: `(n + 2) / 2 pi cos^n`, which integrates to 1 against
    /// the cosine.
    pub fn normal_distribution(&self, cosine: f32) -> f32 {
        cosine.max(0.0).powf(self.exponent) * (self.exponent + 2.0) / TAU
    }
}

/// A direction mirrored at the normal: `2 (n . l) n - l`.
#[inline]
pub fn mirrored(normal: Vec3, direction: Vec3) -> Vec3 {
    normal * (2.0 * normal.dot(direction)) - direction
}
