//! Two unit squares whose form factor is known.

use super::build::SceneBuilder;
use crate::{Camera, Material, Scene, Units};
use glam::Vec3;
use hemicube_raster::Rgb;
use std::f32::consts::PI;

/// Squares 1 m apart, face to face; the lower one emits 1 W/m², the upper one reflects half.
pub(super) fn parallel() -> Scene {
    let lower = [
        Vec3::new(0.0, 0.0, 1.0),
        Vec3::new(1.0, 0.0, 1.0),
        Vec3::X,
        Vec3::ZERO,
    ];
    let upper = [
        Vec3::Y,
        Vec3::new(1.0, 1.0, 0.0),
        Vec3::ONE,
        Vec3::new(0.0, 1.0, 1.0),
    ];
    plates("parallel-plates", lower, upper)
}

/// Squares at a right angle with a common edge; the lying one emits 1 W/m², the standing one reflects half.
pub(super) fn perpendicular() -> Scene {
    let lying = [
        Vec3::new(0.0, 0.0, 1.0),
        Vec3::new(1.0, 0.0, 1.0),
        Vec3::X,
        Vec3::ZERO,
    ];
    let standing = [Vec3::ZERO, Vec3::X, Vec3::new(1.0, 1.0, 0.0), Vec3::Y];
    plates("perpendicular-plates", lying, standing)
}

fn plates(name: &str, source: [Vec3; 4], receiver: [Vec3; 4]) -> Scene {
    let mut builder = SceneBuilder::new(name, Units::Radiometric);
    let light = builder
        .material(Material::diffuse("light", Rgb::BLACK).with_emission(Rgb::splat(1.0 / PI)));
    let grey = builder.material(Material::diffuse("grey", Rgb::splat(0.5)));
    builder.node("source");
    builder.quad(light, source);
    builder.node("receiver");
    builder.quad(grey, receiver);
    let (eye, target) = (Vec3::new(0.9, 0.8, 3.0), Vec3::splat(0.5));
    builder.camera(Camera::looking_at(
        "front",
        eye,
        target,
        Vec3::Y,
        40.0_f32.to_radians(),
    ));
    builder.finish()
}
