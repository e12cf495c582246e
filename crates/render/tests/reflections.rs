//! Mirroring objects and surroundings from a picture.

mod common;

use common::{assert_close, glowing, lit, plain, scene_of, square};
use core::f32::consts::PI;
use glam::{Vec2, Vec3};
use hemicube_radiosity::Solution;
use hemicube_raster::environment::{self, EnvironmentMap};
use hemicube_raster::{Image, Rgb};
use hemicube_render::{Reflections, RenderOptions, Renderer};
use hemicube_scene::builtin::{SceneBuilder, Sides};
use hemicube_scene::{AlphaMode, Camera, Material, Projection, Scene, Units};

fn mirror(base: Rgb, metallic: f32, roughness: f32) -> Material {
    Material {
        metallic,
        roughness,
        ..Material::diffuse("mirror", base)
    }
}

/// A room of 4 m whose walls glow, with a ball in its middle.
fn room_with(ball: Material, walls: Rgb) -> Scene {
    let mut builder = SceneBuilder::new("room", Units::Radiometric);
    let wall = builder.material(glowing(walls));
    let material = builder.material(ball);
    builder.node("room");
    builder.room(wall, Vec3::splat(-2.0), Vec3::splat(2.0), Sides::ALL);
    builder.node("ball");
    builder.sphere(material, Vec3::ZERO, 0.6, 12);
    builder.finish()
}

fn eye() -> Camera {
    Camera::looking_at("eye", Vec3::new(0.2, 0.3, 1.7), Vec3::ZERO, Vec3::Y, 1.0)
}

fn drawn(solution: &Solution, camera: &Camera, reflections: &Reflections) -> Image<Rgb> {
    let renderer = Renderer::new(solution, camera, &plain(32)).expect("valid options");
    let small = reflections.clone().with_resolution(32);
    let renderer = renderer
        .with_reflections(&small)
        .expect("names that there are");
    assert!(renderer.mirror_count() > 0, "something mirrors");
    renderer.linear()
}

#[test]
fn mirror_in_a_furnace_is_invisible() {
    let radiance = Rgb::new(1.0, 2.0, 3.0);
    for roughness in [0.0, 0.25, 0.7, 1.0] {
        let scene = room_with(mirror(Rgb::WHITE, 1.0, roughness), radiance);
        let solution = lit(scene, 1.0, |_| radiance * PI);
        let named = Reflections::default().with_names(vec![String::from("mir*")]);
        for pixel in drawn(&solution, &eye(), &named).pixels() {
            assert_close(*pixel, radiance, 1e-3, "a perfect mirror");
        }
    }
}

#[test]
fn glossy_white_and_glass_in_a_furnace_are_invisible_too() {
    let radiance = Rgb::splat(2.0);
    let glass = Material {
        alpha_mode: AlphaMode::Blend,
        alpha: 0.5,
        ..mirror(Rgb::WHITE, 0.0, 0.1)
    };
    for material in [
        mirror(Rgb::WHITE, 0.0, 0.4),
        mirror(Rgb::WHITE, 0.5, 0.2),
        glass,
    ] {
        let mut scene = room_with(material, radiance);
        scene.max_reflectance = 1.0;
        let solution = lit(scene, 1.0, |_| radiance * PI);
        let named = Reflections::default().with_names(vec![String::from("ball")]);
        for pixel in drawn(&solution, &eye(), &named).pixels() {
            assert_close(*pixel, radiance, 1e-3, "no light is lost");
        }
    }
}

/// A small mirror in the middle of a room shows each wall where the mirrored ray ends.
#[test]
fn flat_mirror_shows_the_wall_that_the_ray_meets() {
    let mut builder = SceneBuilder::new("room", Units::Radiometric);
    let mut wall = |name: &str, r, g, b| {
        let radiance = Rgb::new(r, g, b);
        builder.material(Material {
            name: String::from(name),
            ..glowing(radiance)
        })
    };
    let (red, blue) = (wall("red", 1.0, 0.1, 0.1), wall("blue", 0.1, 0.1, 1.0));
    let metal = builder.material(mirror(Rgb::WHITE, 1.0, 0.0));
    builder.node("walls");
    builder.room(red, Vec3::splat(-2.0), Vec3::splat(2.0), Sides::ALL);
    builder.node("panel");
    // Before the wall at x = 2, turned inside.
    let at = |y: f32, z: f32| Vec3::new(1.9, y, z);
    builder.quad(
        blue,
        [at(-1.9, -1.9), at(-1.9, 1.9), at(1.9, 1.9), at(1.9, -1.9)],
    );
    builder.node("mirror");
    builder.quad(metal, square(0.0).map(|p| p * 0.3));
    let solution = lit(builder.finish(), 4.0, |_| Rgb::BLACK);
    let look = |eye: Vec3| {
        let camera = Camera::looking_at("eye", eye, Vec3::ZERO, Vec3::Y, 0.05);
        let image = drawn(&solution, &camera, &Reflections::default());
        *image.pixel(16, 16)
    };
    assert_close(
        look(Vec3::new(-1.5, 0.0, 0.5)),
        Rgb::new(0.1, 0.1, 1.0),
        0.01,
        "blue",
    );
    assert_close(
        look(Vec3::new(1.5, 0.0, 0.5)),
        Rgb::new(1.0, 0.1, 0.1),
        0.01,
        "red",
    );
}

#[test]
fn rough_metals_stay_matt_and_unknown_names_are_told() {
    let scene = room_with(mirror(Rgb::WHITE, 1.0, 0.8), Rgb::WHITE);
    let solution = lit(scene, 1.0, |_| Rgb::WHITE);
    let camera = eye();
    let renderer = || Renderer::new(&solution, &camera, &plain(8)).expect("valid options");
    let plain = renderer()
        .with_reflections(&Reflections::default())
        .expect("nothing named");
    assert_eq!(plain.mirror_count(), 0, "a rough metal");
    assert_eq!(plain.linear(), renderer().linear(), "the same bits");
    for wrong in [
        Reflections::default().with_names(vec![String::from("chrome*")]),
        Reflections::default().with_resolution(4),
    ] {
        let error = renderer()
            .with_reflections(&wrong)
            .expect_err("refused")
            .to_string();
        assert!(!error.contains('\n'), "{error}");
    }
}

#[test]
fn surroundings_are_behind_everything() {
    let map = |d: Vec3| Rgb::new(1.0 + d.x, 1.0 + d.y, 1.0 + d.z);
    let map = EnvironmentMap::from_fn(environment::Projection::LatLong, 128, 2, map);
    let solution = lit(
        scene_of(&[(glowing(Rgb::WHITE), square(-50.0))]),
        9.0,
        |_| Rgb::BLACK,
    );
    let camera = Camera {
        projection: Projection::Panorama,
        ..Camera::looking_at("all", Vec3::ZERO, Vec3::X, Vec3::Y, 1.0)
    };
    let options = RenderOptions::default().with_size(64, 32).with_samples(1);
    let renderer = Renderer::new(&solution, &camera, &options).expect("valid options");
    let image = renderer.with_surroundings(map).linear();
    for (x, y) in [(32, 15), (16, 16), (60, 8), (5, 30)] {
        let at = Vec2::new(x as f32 + 0.5, y as f32 + 0.5) / Vec2::new(64.0, 32.0);
        let (longitude, latitude) = ((at.x - 0.5) * 2.0 * PI, (0.5 - at.y) * PI);
        // Ahead is +x, so the right is +z.
        let d = Vec3::new(
            latitude.cos() * longitude.cos(),
            latitude.sin(),
            latitude.cos() * longitude.sin(),
        );
        let (seen, wanted) = (image.pixel(x, y), d + Vec3::ONE);
        let error = Vec3::from(seen.to_array()).distance(wanted);
        assert!(error < 0.02, "{x} {y}: {seen:?} instead of {wanted}");
    }
}
