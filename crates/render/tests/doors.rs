//! What is refused, and what does not depend on the machine.

mod common;

use common::{from_above, glowing, lit, plain, scene_of, square};
use glam::Vec3;
use hemicube_radiosity::{PatchOptions, Solution, SolveOptions, solve};
use hemicube_raster::tonemap::{Exposure, ToneMap};
use hemicube_raster::{Image, Rgb};
use hemicube_render::{RenderError, RenderOptions, Renderer, Shading, render};
use hemicube_scene::{Camera, Projection, builtin};
use std::sync::Arc;
use std::sync::Mutex;

fn two_rooms() -> Solution {
    let scene = builtin::scene("two-rooms").expect("built in");
    let options = SolveOptions {
        mesh: PatchOptions::default().with_elements(300).with_patches(60),
        rays: 32,
        tolerance: 0.05,
        ..SolveOptions::default()
    };
    solve(Arc::new(scene), &options, |_, _| true).expect("a scene with light")
}

#[test]
fn threads_do_not_change_a_bit() {
    let solution = two_rooms();
    let camera = solution.mesh().scene().cameras[0].clone();
    let options = RenderOptions::default().with_size(61, 47);
    for options in [
        options,
        options.with_shading(Shading::Gather).with_gather_rays(2),
    ] {
        let on = |threads: usize| -> [Image<Rgb>; 2] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
            pool.expect("a pool").install(|| {
                let renderer = Renderer::new(&solution, &camera, &options).expect("valid options");
                let display = renderer.display(Exposure::Auto, ToneMap::Aces);
                [renderer.linear(), display]
            })
        };
        let one = on(1);
        for threads in [2, 8] {
            assert!(on(threads) == one, "{threads} threads, {}", options.shading);
        }
    }
}

#[test]
fn supersampling_averages_the_finer_picture() {
    let solution = two_rooms();
    let camera = &solution.mesh().scene().cameras[0];
    let fine = plain(1).with_size(3 * 40, 3 * 30);
    let fine = render(&solution, camera, &fine).expect("valid options");
    let coarse = plain(1).with_size(40, 30).with_samples(3);
    let coarse = render(&solution, camera, &coarse).expect("valid options");
    for y in 0..30 {
        for x in 0..40 {
            let samples = (0..9).map(|i| *fine.pixel(3 * x + i % 3, 3 * y + i / 3));
            let mean = samples.sum::<Rgb>() / 9.0;
            common::assert_close(*coarse.pixel(x, y), mean, 1e-5, &format!("pixel {x} {y}"));
        }
    }
}

#[test]
fn progress_ends_at_one() {
    let solution = lit(scene_of(&[(glowing(Rgb::WHITE), square(0.0))]), 1.0, |_| {
        Rgb::BLACK
    });
    let shares = Mutex::new(Vec::new());
    let report = |share| shares.lock().expect("not poisoned").push(share);
    let camera = from_above();
    let options = plain(64);
    let renderer = Renderer::new(&solution, &camera, &options).expect("valid options");
    renderer.with_progress(&report).linear();
    let shares = shares.into_inner().expect("not poisoned");
    let last = shares.iter().copied().fold(0.0, f64::max);
    assert_eq!(last, 1.0, "{shares:?}");
}

#[test]
fn impossible_pictures_are_refused_in_one_line() {
    let solution = lit(scene_of(&[(glowing(Rgb::WHITE), square(0.0))]), 1.0, |_| {
        Rgb::BLACK
    });
    let camera = from_above();
    let with = |options: RenderOptions| render(&solution, &camera, &options).expect_err("refused");
    let plain = plain(8);
    let errors = [
        with(plain.with_size(0, 8)),
        with(plain.with_size(8, 16_385)),
        with(plain.with_size(16_384, 8).with_samples(5)),
        with(plain.with_shading(Shading::Gather).with_gather_rays(0)),
        with(plain.with_background(Rgb::splat(f32::NAN))),
        with(plain.with_background(Rgb::splat(-1.0))),
    ];
    for error in errors {
        let text = error.to_string();
        assert!(!text.is_empty() && !text.contains('\n'), "{text:?}");
    }
}

#[test]
fn impossible_cameras_are_refused_by_name() {
    let solution = lit(scene_of(&[(glowing(Rgb::WHITE), square(0.0))]), 1.0, |_| {
        Rgb::BLACK
    });
    let good = from_above();
    let fov = |vertical_fov| Projection::Perspective {
        vertical_fov,
        aspect: None,
    };
    let size = |half_width, half_height| Projection::Orthographic {
        half_width,
        half_height,
    };
    let cameras = [
        Camera {
            eye: Vec3::splat(f32::NAN),
            ..good.clone()
        },
        Camera {
            forward: Vec3::ZERO,
            ..good.clone()
        },
        Camera {
            up: good.forward,
            ..good.clone()
        },
        Camera {
            projection: fov(0.0),
            ..good.clone()
        },
        Camera {
            projection: fov(f32::NAN),
            ..good.clone()
        },
        Camera {
            projection: fov(3.2),
            ..good.clone()
        },
        Camera {
            projection: size(0.0, 1.0),
            ..good.clone()
        },
        Camera {
            projection: size(1.0, f32::INFINITY),
            ..good.clone()
        },
    ];
    for camera in cameras {
        let error = render(&solution, &camera, &plain(8)).expect_err("refused");
        assert!(matches!(error, RenderError::Camera { .. }), "{error}");
        assert!(error.to_string().starts_with("camera 'above': "), "{error}");
    }
    let away = Camera::looking_at("away", Vec3::Z * 5.0, Vec3::Z * 9.0, Vec3::Y, 1.0);
    let image = render(&solution, &away, &plain(8)).expect("it sees nothing, which is allowed");
    assert!(
        image.pixels().iter().all(|p| p.is_black()),
        "nothing is there"
    );
}

#[test]
fn pictures_that_would_fill_the_memory_are_refused() {
    let solution = lit(scene_of(&[(glowing(Rgb::WHITE), square(0.0))]), 1.0, |_| {
        Rgb::BLACK
    });
    let camera = from_above();
    let options = plain(1).with_size(16_384, 16_384);
    let error = render(&solution, &camera, &options).expect_err("refused");
    assert!(matches!(error, RenderError::Pixels { .. }), "{error}");
    assert!(error.to_string().contains("7680 x 4320"), "{error}");
}

#[test]
fn shadings_have_names() {
    for shading in Shading::ALL {
        assert_eq!(shading.to_string().parse(), Ok(shading), "round trip");
    }
    let error = "phong".parse::<Shading>().expect_err("not known");
    assert!(error.to_string().contains("gouraud"), "{error}");
}
