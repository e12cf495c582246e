//! Panoramas, fisheyes and jittered samples against what perspective pictures and formulas say.

mod common;

use common::{assert_close, from_above, glowing, lit, picture, plain, scene_of, square};
use core::f32::consts::{FRAC_PI_2, PI, TAU};
use glam::Vec3;
use hemicube_radiosity::Solution;
use hemicube_raster::antialias::Antialiasing;
use hemicube_raster::{Image, Rgb};
use hemicube_render::{RenderOptions, Shading};
use hemicube_scene::builtin::{SceneBuilder, Sides};
use hemicube_scene::{AlphaMode, Camera, FisheyeMapping, Material, Projection, Units};

fn with(camera: &Camera, projection: Projection) -> Camera {
    Camera {
        projection,
        ..camera.clone()
    }
}

/// A room whose walls' light changes from place to place, with a pane of glass in the way on one side.
fn room() -> Solution {
    let mut builder = SceneBuilder::new("room", Units::Radiometric);
    let wall = builder.material(Material::diffuse("wall", Rgb::splat(0.5)));
    let glass = builder.material(Material {
        alpha_mode: AlphaMode::Blend,
        alpha: 0.25,
        double_sided: true,
        ..Material::diffuse("glass", Rgb::splat(0.8))
    });
    builder.node("room");
    builder.room(wall, Vec3::splat(-2.0), Vec3::splat(2.0), Sides::ALL);
    builder.node("pane");
    builder.quad(glass, square(-1.0));
    lit(builder.finish(), 0.4, |c| {
        Rgb::new(3.0 + c.x, 3.0 + c.y, 3.0 + c.z)
    })
}

fn eye() -> Camera {
    let eye = Vec3::new(0.1, -0.2, 0.3);
    Camera::looking_at("eye", eye, eye + Vec3::NEG_Z, Vec3::Y, FRAC_PI_2)
}

/// Pixel of a panorama of `width` columns, looking along -z with +y up, that holds a direction.
fn panorama_place(direction: Vec3, width: usize) -> (f32, f32) {
    let d = direction.normalize();
    let longitude = d.x.atan2(-d.z);
    let x = (longitude / TAU + 0.5) * width as f32;
    (x, (0.5 - d.y.asin() / PI) * 0.5 * width as f32)
}

#[expect(
    clippy::cast_possible_truncation,
    reason = "columns and rows of a small picture"
)]
fn bilinear(image: &Image<Rgb>, (x, y): (f32, f32)) -> Rgb {
    let (x, y) = (x - 0.5, y - 0.5);
    let at = |i: f32, j: f32| {
        let column = (i as isize).rem_euclid(image.width() as isize) as usize;
        *image.pixel(column, (j as usize).min(image.height() - 1))
    };
    let (i, j) = (x.floor(), y.floor().max(0.0));
    let top = at(i, j).lerp(at(i + 1.0, j), x - i);
    let bottom = at(i, j + 1.0).lerp(at(i + 1.0, j + 1.0), x - i);
    top.lerp(bottom, y - j)
}

#[test]
fn panorama_shows_what_the_faces_of_a_cube_show() {
    let solution = room();
    let camera = eye();
    let options = plain(8).with_size(512, 256);
    let panorama = picture(&solution, &with(&camera, Projection::Panorama), &options);
    let side = 16;
    for (forward, up) in [
        (Vec3::X, Vec3::Y),
        (Vec3::NEG_X, Vec3::Y),
        (Vec3::Y, Vec3::Z),
        (Vec3::NEG_Y, Vec3::NEG_Z),
        (Vec3::Z, Vec3::Y),
        (Vec3::NEG_Z, Vec3::Y),
    ] {
        let face = Camera::looking_at("face", camera.eye, camera.eye + forward, up, FRAC_PI_2);
        let image = picture(&solution, &face, &plain(side));
        let (mut worst, mut sum) = (0.0_f32, 0.0);
        for y in 0..side {
            for x in 0..side {
                let at = |k: usize| (k as f32 + 0.5) / side as f32 * 2.0 - 1.0;
                let direction = forward + at(x) * face.right() - at(y) * up;
                let seen = bilinear(&panorama, panorama_place(direction, 512));
                let error = (seen.g / image.pixel(x, y).g - 1.0).abs();
                (worst, sum) = (worst.max(error), sum + error);
            }
        }
        // The panorama is interpolated between pixels, also across the edges of the pane, which one face sees.
        let mean = sum / (side * side) as f32;
        let edges = if forward == Vec3::NEG_Z { 2.0 } else { 1.0 };
        assert!(
            mean < 2e-3 * edges && worst < 0.1 * edges,
            "{forward}: {mean} {worst}"
        );
    }
}

#[test]
fn rays_and_triangles_give_the_same_picture() {
    let solution = room();
    for camera in [eye(), from_above()] {
        let plain = plain(40);
        let drawn = picture(&solution, &camera, &plain);
        // Jitter by nothing: the same places, found by rays.
        let traced = Antialiasing::NONE.with_pattern(
            "1x1-jittered@0"
                .parse::<Antialiasing>()
                .expect("a name")
                .pattern,
        );
        let traced = picture(&solution, &camera, &plain.with_antialias(traced));
        let close = |a: &Rgb, b: &Rgb| (a.g / b.g - 1.0).abs() < 1e-3;
        let pairs = drawn.pixels().iter().zip(traced.pixels());
        let differing = pairs.filter(|(a, b)| !close(a, b)).count();
        // A sample on an edge may fall to either side.
        assert!(differing <= 3, "{}: {differing} of 1600", camera.name);
    }
}

#[test]
fn uniform_sky_fills_a_fisheyes_disc() {
    let mut scene = scene_of(&[(glowing(Rgb::WHITE), square(-5.0).map(|p| p * 1e-3))]);
    scene.sky = Rgb::new(1.0, 2.0, 3.0);
    let sky = scene.sky;
    let solution = lit(scene, 1.0, |_| Rgb::BLACK);
    let camera = Camera::looking_at("up", Vec3::ZERO, Vec3::Y, Vec3::Z, 1.0);
    for (mapping, angle) in [
        (FisheyeMapping::Equidistant, PI),
        (FisheyeMapping::Equisolid, 1.5 * PI),
    ] {
        let camera = with(&camera, Projection::Fisheye { angle, mapping });
        let image = picture(&solution, &camera, &plain(64));
        let share = image.pixels().iter().filter(|p| **p == sky).count() as f32 / 4096.0;
        assert!((share - PI / 4.0).abs() < 0.01, "{mapping:?}: {share}");
        assert_eq!(*image.pixel(0, 0), Rgb::BLACK, "outside of the disc");
    }
}

#[test]
fn flat_stays_flat_under_every_antialiasing() {
    let scene = scene_of(&[(
        Material::diffuse("grey", Rgb::splat(0.5)),
        square(0.0).map(|p| p * 3.0),
    )]);
    let solution = lit(scene, 10.0, |_| Rgb::splat(PI));
    for name in [
        "1",
        "3",
        "4x4:bartlett",
        "2x2:bartlett-3x3",
        "3:mitchell",
        "2-jittered:gaussian",
        "4:lanczos",
        "3:blackman-harris",
    ] {
        let antialias = name.parse().expect(name);
        let options = plain(13).with_antialias(antialias);
        for pixel in picture(&solution, &from_above(), &options).pixels() {
            assert_close(*pixel, Rgb::splat(0.5), 1e-5, name);
        }
    }
}

#[test]
fn threads_change_nothing() {
    let solution = room();
    let fisheye = Projection::Fisheye {
        angle: PI,
        mapping: FisheyeMapping::Equidistant,
    };
    let cameras = [
        eye(),
        with(&eye(), Projection::Panorama),
        with(&eye(), fisheye),
    ];
    for camera in &cameras {
        for name in ["3", "2-jittered:mitchell"] {
            for shading in [Shading::Gouraud, Shading::Gather] {
                let options = RenderOptions::default()
                    .with_size(24, 20)
                    .with_antialias(name.parse().expect(name))
                    .with_shading(shading)
                    .with_gather_rays(8);
                let on = |threads| {
                    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
                    let pool = pool.expect("threads");
                    pool.install(|| picture(&solution, camera, &options))
                };
                assert_eq!(on(1), on(8), "{name} {shading}");
            }
        }
    }
}

#[test]
fn masks_have_their_holes_for_rays_too() {
    let mask = Material {
        alpha_mode: AlphaMode::Mask { cutoff: 0.5 },
        alpha: 0.25,
        ..glowing(Rgb::splat(9.0))
    };
    let scene = scene_of(&[
        (glowing(Rgb::splat(2.0)), square(0.0)),
        (mask, square(1.0)),
        (
            glowing(Rgb::splat(5.0)),
            square(2.0).map(|p| Vec3::new(p.x, -p.y, p.z)),
        ),
    ]);
    let solution = lit(scene, 1.0, |_| Rgb::BLACK);
    let jittered: Antialiasing = "2-jittered".parse().expect("a name");
    let image = picture(&solution, &from_above(), &plain(4).with_antialias(jittered));
    for pixel in image.pixels() {
        // The mask is one hole, and the uppermost square turns its back.
        assert_close(*pixel, Rgb::splat(2.0), 1e-6, "through the hole");
    }
}
