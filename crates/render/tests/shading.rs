//! Radiance of pixels against what it must be.

mod common;

use common::{assert_close, from_above, glowing, lit, picture, plain, scene_of, square};
use core::f32::consts::PI;
use glam::{Vec2, Vec3};
use hemicube_radiosity::{GatherOptions, Gatherer, SolveOptions, solve};
use hemicube_raster::{Image, Rgb};
use hemicube_render::{RenderOptions, Shading};
use hemicube_scene::builtin::{SceneBuilder, furnace_with};
use hemicube_scene::{Camera, Material, Units, Wrap};
use std::sync::Arc;

#[test]
fn constant_irradiance_is_exact() {
    let reflectance = Rgb::new(0.3, 0.5, 0.7);
    let scene = scene_of(&[(Material::diffuse("grey", reflectance), square(0.0))]);
    let irradiance = Rgb::new(10.0, 20.0, 30.0);
    let solution = lit(scene, 0.3, |_| irradiance);
    for shading in [Shading::Flat, Shading::Gouraud] {
        let image = picture(&solution, &from_above(), &plain(16).with_shading(shading));
        for pixel in image.pixels() {
            let expected = reflectance * irradiance * (1.0 / PI);
            assert_close(*pixel, expected, 1e-6, shading.name());
        }
    }
}

#[test]
fn furnace_is_uniform_in_every_shading() {
    let scene = Arc::new(furnace_with(0.5, 1.0));
    let camera = scene.cameras[0].clone();
    let options = SolveOptions {
        tolerance: 1e-5,
        ..SolveOptions::default()
    };
    let solution = solve(scene, &options, |_, _| true).expect("a scene with light");
    for shading in Shading::ALL {
        let options = plain(12)
            .with_shading(shading)
            .with_samples(2)
            .with_gather_rays(16);
        // B = E / (1 - rho) = 2, and a closed room shows it everywhere.
        for pixel in picture(&solution, &camera, &options).pixels() {
            assert_close(*pixel, Rgb::splat(2.0 / PI), 1e-3, shading.name());
        }
    }
}

/// A floor from z = 0 to -16 whose irradiance grows linearly with the distance, seen along its length.
#[test]
fn interpolation_along_a_receding_floor_is_perspective_correct() {
    let floor = [
        Vec3::new(-2.0, 0.0, 0.0),
        Vec3::new(2.0, 0.0, 0.0),
        Vec3::new(2.0, 0.0, -16.0),
        Vec3::new(-2.0, 0.0, -16.0),
    ];
    let scene = scene_of(&[(Material::diffuse("white", Rgb::splat(0.9)), floor)]);
    let solution = lit(scene, 4.0, |centre| Rgb::splat(100.0 - centre.z));
    let eye = Vec3::new(0.3, 2.0, 1.0);
    let camera = Camera::looking_at("along", eye, Vec3::new(0.0, 0.0, -8.0), Vec3::Y, 0.9);
    let side = 61;
    let image = picture(&solution, &camera, &plain(side));
    let half = f32::tan(0.45);
    let mut compared = 0;
    for y in 0..side {
        for x in 0..side {
            let at = |k: usize| (k as f32 + 0.5) / side as f32 * 2.0 - 1.0;
            let ray = camera.forward + half * (at(x) * camera.right() - at(y) * camera.up);
            let point = eye - ray * (eye.y / ray.y);
            // Vertices at the rim average elements of one side only.
            if ray.y < 0.0 && point.x.abs() < 1.99 && (-11.9..-4.1).contains(&point.z) {
                let expected = Rgb::splat(0.9 / PI * (100.0 - point.z));
                assert_close(*image.pixel(x, y), expected, 1e-4, "floor");
                compared += 1;
            }
        }
    }
    assert!(compared > 100, "only {compared} pixels compared");
}

#[test]
fn textures_stay_crisp_within_an_element() {
    let mut builder = SceneBuilder::new("textured", Units::Radiometric);
    let halves = [[0, 0, 0, 255], [255, 255, 255, 255]].map(|c: [u8; 4]| vec![c; 8]);
    let row = halves.concat();
    let pixels = Image::from_pixels(16, 1, row).expect("16 pixels");
    let texture = builder.texture("halves", Wrap::ClampToEdge, pixels);
    let material = builder.textured("halves", texture, Vec2::ONE);
    builder.node("surface");
    builder.picture(material, square(0.0));
    let solution = lit(builder.finish(), 10.0, |_| Rgb::splat(PI));
    assert_eq!(solution.mesh().elements().len(), 1, "one element");
    let image = picture(&solution, &from_above(), &plain(32));
    assert_close(*image.pixel(14, 7), Rgb::BLACK, 1e-6, "left of the border");
    // White is lowered to the largest reflectance.
    assert_close(
        *image.pixel(17, 7),
        Rgb::splat(0.98),
        1e-6,
        "right of the border",
    );
}

#[test]
fn emission_is_added_and_dimmed() {
    let material =
        Material::diffuse("lamp", Rgb::splat(0.5)).with_emission(Rgb::new(1.0, 2.0, 4.0));
    let mut solution = lit(scene_of(&[(material, square(0.0))]), 1.0, |_| {
        Rgb::splat(PI)
    });
    let image = picture(&solution, &from_above(), &plain(4));
    assert_close(
        *image.pixel(1, 1),
        Rgb::new(1.5, 2.5, 4.5),
        1e-6,
        "as solved",
    );
    solution.set_dim(0, Rgb::new(0.5, 0.5, 0.0));
    let image = picture(&solution, &from_above(), &plain(4));
    assert_close(
        *image.pixel(1, 1),
        Rgb::new(0.75, 1.25, 0.0),
        1e-6,
        "dimmed",
    );
}

#[test]
fn gathered_pixel_is_the_gatherer_at_its_point() {
    let wall = [
        Vec3::new(1.0, -1.0, 0.0),
        Vec3::new(1.0, -1.0, 2.0),
        Vec3::new(1.0, 1.0, 2.0),
        Vec3::new(1.0, 1.0, 0.0),
    ]
    .map(|p| p + Vec3::X * 0.001);
    // Seen from the floor the wall turns to -x.
    let scene = scene_of(&[
        (Material::diffuse("floor", Rgb::splat(0.5)), square(0.0)),
        (
            glowing(Rgb::splat(1.0)),
            [wall[0], wall[1], wall[2], wall[3]],
        ),
    ]);
    let solution = lit(scene, 0.5, |_| Rgb::BLACK);
    let rays = 256;
    let options = plain(4)
        .with_shading(Shading::Gather)
        .with_gather_rays(rays);
    let image = picture(&solution, &from_above(), &options);
    let gather = GatherOptions {
        rays,
        ..GatherOptions::default()
    };
    let gatherer = Gatherer::new(&solution, gather);
    for (x, y) in [(0, 0), (2, 1), (3, 3)] {
        let at = |k: usize| (k as f32 + 0.5) / 2.0 - 1.0;
        let point = Vec3::new(at(x), -at(y), 0.0);
        let expected = gatherer.irradiance(point, Vec3::Z) * (0.5 / PI);
        assert!(expected.r > 0.01, "the wall lights the floor: {expected:?}");
        // The lamp is integrated exactly and nothing hides it, so sampling adds nothing.
        assert_close(*image.pixel(x, y), expected, 1e-4, "gathered");
    }
}

#[test]
fn sky_and_background_are_where_nothing_is_drawn() {
    let small = square(0.0).map(|p| p * 0.5);
    let mut scene = scene_of(&[(glowing(Rgb::splat(3.0)), small)]);
    let background = Rgb::new(0.1, 0.2, 0.3);
    let options = plain(8).with_background(background);
    let corner = |scene, options: &RenderOptions| {
        let solution = lit(scene, 1.0, |_| Rgb::BLACK);
        *picture(&solution, &from_above(), options).pixel(0, 0)
    };
    assert_eq!(corner(scene.clone(), &plain(8)), Rgb::BLACK, "nothing");
    assert_eq!(corner(scene.clone(), &options), background, "background");
    scene.sky = Rgb::splat(7.0);
    assert_eq!(
        corner(scene, &options),
        Rgb::splat(7.0),
        "the sky comes first"
    );
}
