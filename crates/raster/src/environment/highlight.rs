//! Highlights of lamps, painted into a map once and looked up ever after.

use super::{EnvironmentMap, Projection};
use crate::Rgb;
use core::f32::consts::PI;
use glam::Vec3;

/// A light so far away that its rays are parallel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DistantLight {
    /// Where it stands, seen from anywhere; any length but 0.
    pub direction: Vec3,
    /// Irradiance of a surface that faces it.
    pub irradiance: Rgb,
}

/// The highlights that lights make on a surface of a Phong exponent, over the mirrored direction `r`:
/// `Σ E (n+1)/2π cos^n(r, l)`. Looking the map up by `r` costs the same for one light and for a hundred.
///
/// The lobe has a solid angle of 1, so the flux of the map is the sum of the irradiances. Each texel is the mean of
/// `samples × samples` values; an exponent that makes a highlight smaller than a texel keeps its flux only as far as samples
/// meet it. Lights without a direction are left out; the exponent is at least 0.
pub fn highlights(
    lights: &[DistantLight],
    exponent: f32,
    projection: Projection,
    rows: usize,
    samples: usize,
) -> EnvironmentMap {
    let exponent = exponent.max(0.0);
    let scale = (exponent + 1.0) / (2.0 * PI);
    let lights: Vec<(Vec3, Rgb)> = lights
        .iter()
        .filter_map(|light| Some((light.direction.try_normalize()?, light.irradiance * scale)))
        .collect();
    EnvironmentMap::from_fn(projection, rows, samples, |r| {
        let of_light = |&(direction, peak): &(Vec3, Rgb)| {
            let cosine = r.dot(direction).max(0.0);
            if cosine > 0.0 {
                peak * cosine.powf(exponent)
            } else {
                Rgb::BLACK
            }
        };
        lights.iter().map(of_light).sum()
    })
}
