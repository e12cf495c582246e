//! Small scenes with known light.

#![allow(dead_code, reason = "each test file uses its part")]

use glam::Vec3;
use hemicube_radiosity::{Grouping, PatchMesh, PatchOptions, Solution};
use hemicube_raster::{Image, Rgb};
use hemicube_render::{RenderOptions, render};
use hemicube_scene::builtin::SceneBuilder;
use hemicube_scene::{Camera, Material, Projection, Scene, Units};
use std::sync::Arc;

/// A mesh with this irradiance, which may depend on the element's centre.
pub fn lit(scene: Scene, element_size: f32, irradiance: impl Fn(Vec3) -> Rgb) -> Solution {
    let options = PatchOptions::default().with_element_size(element_size);
    let mesh = Arc::new(PatchMesh::build(Arc::new(scene), options).expect("a scene with surfaces"));
    let ids = mesh.elements().iter();
    let values: Vec<Rgb> = ids.map(|&id| irradiance(mesh.node(id).centroid)).collect();
    Solution::new(mesh, &values, Grouping::Together)
}

/// A square of side 2 at height `z`, turned to +z.
pub fn square(z: f32) -> [Vec3; 4] {
    rectangle(-1.0, 1.0, z)
}

/// A rectangle from x = `left` to `right` and y = -1 to 1 at height `z`, turned to +z.
pub fn rectangle(left: f32, right: f32, z: f32) -> [Vec3; 4] {
    [
        Vec3::new(left, -1.0, z),
        Vec3::new(right, -1.0, z),
        Vec3::new(right, 1.0, z),
        Vec3::new(left, 1.0, z),
    ]
}

/// Each material on its corners.
pub fn scene_of(surfaces: &[(Material, [Vec3; 4])]) -> Scene {
    let mut builder = SceneBuilder::new("test", Units::Radiometric);
    for (material, corners) in surfaces {
        let material = builder.material(material.clone());
        builder.node("surface");
        builder.quad(material, *corners);
    }
    builder.finish()
}

/// A parallel view down -z on x and y from -1 to 1.
pub fn from_above() -> Camera {
    let projection = Projection::Orthographic {
        half_width: 1.0,
        half_height: 1.0,
    };
    Camera {
        projection,
        ..Camera::looking_at("above", Vec3::Z * 5.0, Vec3::ZERO, Vec3::Y, 1.0)
    }
}

/// A picture of `side` x `side` pixels with one sample each.
pub fn plain(side: usize) -> RenderOptions {
    RenderOptions::default()
        .with_size(side, side)
        .with_samples(1)
}

pub fn picture(solution: &Solution, camera: &Camera, options: &RenderOptions) -> Image<Rgb> {
    render(solution, camera, options).expect("valid options")
}

/// A material that only emits.
pub fn glowing(radiance: Rgb) -> Material {
    Material::diffuse("glow", Rgb::BLACK).with_emission(radiance)
}

pub fn assert_close(actual: Rgb, expected: Rgb, relative: f32, what: &str) {
    for band in 0..3 {
        let (a, e) = (actual[band], expected[band]);
        let error = (a - e).abs() / e.abs().max(1e-6);
        assert!(error <= relative, "{what}, band {band}: {a} instead of {e}");
    }
}
