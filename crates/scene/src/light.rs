//! Lights without an area; emitting surfaces are materials.

use glam::Vec3;
use hemicube_raster::Rgb;
use serde::{Deserialize, Serialize};

/// A light that is no surface.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Light {
    /// Name from the file.
    pub name: String,
    /// What it is and how strong.
    pub kind: LightKind,
}

/// The kinds of `KHR_lights_punctual`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub enum LightKind {
    /// Equal intensity in all directions.
    Point {
        /// Where it is, in world units.
        position: Vec3,
        /// Intensity in each band: cd (photometric) or W/sr (radiometric).
        intensity: Rgb,
    },
    /// A cone of light.
    Spot {
        /// Where it is, in world units.
        position: Vec3,
        /// Axis of the cone, of unit length, pointing away from the light.
        direction: Vec3,
        /// Intensity on the axis: cd or W/sr.
        intensity: Rgb,
        /// Angle from the axis in radians up to which the intensity is full.
        inner_angle: f32,
        /// Angle from the axis in radians beyond which there is no light.
        outer_angle: f32,
    },
    /// Parallel light from infinitely far.
    Directional {
        /// Direction in which the light travels, of unit length.
        direction: Vec3,
        /// Irradiance on a surface that faces the light: lx or W/m².
        irradiance: Rgb,
    },
}

impl LightKind {
    /// Irradiance at `point` on a surface that faces the light, and the unit direction from the point towards it and
    /// its distance (infinite for directional lights). Occlusion is not considered.
    ///
    /// The spot's falloff between the angles is that of `KHR_lights_punctual`: `clamp(cos-linear ramp)²`.
    pub fn arriving_at(&self, point: Vec3) -> (Rgb, Vec3, f32) {
        match *self {
            Self::Directional {
                direction,
                irradiance,
            } => (irradiance, -direction, f32::INFINITY),
            Self::Point {
                position,
                intensity,
            } => {
                let (to_light, distance) = direction_and_distance(point, position);
                (intensity / (distance * distance), to_light, distance)
            }
            Self::Spot {
                position,
                direction,
                intensity,
                inner_angle,
                outer_angle,
            } => {
                let (to_light, distance) = direction_and_distance(point, position);
                let (inner, outer) = (inner_angle.cos(), outer_angle.cos());
                let ramp = ((-to_light).dot(direction) - outer) / (inner - outer).max(1e-4);
                let falloff = ramp.clamp(0.0, 1.0).powi(2);
                (
                    intensity * (falloff / (distance * distance)),
                    to_light,
                    distance,
                )
            }
        }
    }
}

/// Unit direction and distance from one point to another; a light in the point itself is pushed off by a tiny step.
fn direction_and_distance(from: Vec3, to: Vec3) -> (Vec3, f32) {
    let offset = to - from;
    let distance = offset.length().max(1e-6);
    (offset / distance, distance)
}
