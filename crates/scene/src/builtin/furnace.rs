//! The closed box in which radiosity is known everywhere.

use super::build::{SceneBuilder, Sides};
use crate::{Camera, Material, Scene, Units};
use glam::Vec3;
use hemicube_raster::Rgb;
use std::f32::consts::PI;

/// Reflectance 0.5, exitance 1 W/m².
pub(super) fn scene() -> Scene {
    furnace_with(0.5, 1.0)
}

/// A closed cube of 2 m whose inner sides all have this reflectance and exitance (W/m²).
///
/// Its solution is uniform: radiosity `B = E / (1 - ρ)`, irradiance `H = B`, for any way of subdividing it.
pub fn furnace_with(reflectance: f32, exitance: f32) -> Scene {
    let mut builder = SceneBuilder::new("furnace", Units::Radiometric);
    let wall =
        Material::diffuse("wall", Rgb::splat(reflectance)).with_emission(Rgb::splat(exitance / PI));
    let wall = builder.material(wall);
    builder.node("box");
    builder.room(wall, Vec3::splat(-1.0), Vec3::ONE, Sides::ALL);
    let eye = Vec3::new(-0.8, 0.6, 0.8);
    builder.camera(Camera::looking_at(
        "inside",
        eye,
        Vec3::ZERO,
        Vec3::Y,
        70.0_f32.to_radians(),
    ));
    builder.finish()
}
