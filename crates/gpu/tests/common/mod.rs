//! What tests of pictures share: a device, lit scenes, differences between pictures.
#![allow(dead_code, reason = "each test file uses a part of it")]

#[path = "../device/mod.rs"]
mod device;

pub use device::context;
use hemicube_radiosity::form_factor::hemicube::{Hemicube, HemicubeOptions};
use hemicube_radiosity::solve::shooting::{Order, Shooting};
use hemicube_radiosity::stop::NEVER;
use hemicube_radiosity::{Solution, SolveOptions, Solver, unlit};
use hemicube_raster::{Image, Rgb};
use hemicube_scene::{Camera, Scene, builtin};
use std::sync::Arc;

/// A few shots into a scene: enough light for a picture.
pub fn lit(scene: Scene, elements: usize) -> Solution {
    let mut options = SolveOptions::default();
    options.mesh = options
        .mesh
        .with_elements(elements)
        .with_patches(elements / 8);
    let start = unlit(Arc::new(scene), &options, NEVER).expect("a start");
    let hemicube = HemicubeOptions::default().with_resolution(32);
    let factors = Hemicube::new(start.mesh().clone(), hemicube).expect("factors");
    let mut solver = Shooting::new(&factors, start, Order::Sorted);
    for _ in 0..24 {
        solver.step();
    }
    solver.into_solution()
}

/// A built-in scene with a few shots.
pub fn lit_builtin(name: &str, elements: usize) -> Solution {
    lit(builtin::scene(name).expect("a built-in scene"), elements)
}

/// The scene's camera, or the automatic one.
pub fn camera(solution: &Solution) -> Camera {
    let cameras = &solution.mesh().scene().cameras;
    let first = cameras.first().cloned();
    first.unwrap_or_else(|| hemicube_render::choose_camera(solution.mesh()))
}

/// How two pictures differ, all numbers relative to the mean of the first.
#[derive(Debug, Clone, Copy)]
pub struct Difference {
    /// Mean of absolute differences.
    pub mean: f64,
    /// Difference that 99 of 100 pixels stay below.
    pub of_99: f64,
    /// Share of pixels that differ by more than 2 %.
    pub share: f64,
}

/// Compares pictures of one size.
pub fn difference(a: &Image<Rgb>, b: &Image<Rgb>) -> Difference {
    assert_eq!((a.width(), a.height()), (b.width(), b.height()), "sizes");
    let mean = |image: &Image<Rgb>| {
        let sum: f64 = image
            .pixels()
            .iter()
            .map(|c| f64::from(c.luminance()))
            .sum();
        sum / image.pixels().len() as f64
    };
    let scale = mean(a);
    let pairs = a.pixels().iter().zip(b.pixels());
    let mut all: Vec<f64> = pairs
        .map(|(a, b)| f64::from((*a - *b).map(f32::abs).max_band()) / scale)
        .collect();
    all.sort_by(f64::total_cmp);
    Difference {
        mean: all.iter().sum::<f64>() / all.len() as f64,
        of_99: all[all.len() * 99 / 100],
        share: all.iter().filter(|d| **d > 0.02).count() as f64 / all.len() as f64,
    }
}

/// Writes pictures side by side, and ten times their difference, where a folder for them is named.
pub fn show(name: &str, a: &Image<Rgb>, b: &Image<Rgb>) {
    let Ok(folder) = std::env::var("HEMICUBE_PICTURES") else {
        return;
    };
    let (width, height) = (a.width(), a.height());
    let mut all = Image::filled(3 * width, height, Rgb::BLACK);
    for y in 0..height {
        for x in 0..width {
            let (a, b) = (*a.pixel(x, y), *b.pixel(x, y));
            *all.pixel_mut(x, y) = a;
            *all.pixel_mut(width + x, y) = b;
            *all.pixel_mut(2 * width + x, y) = (a - b).map(|d| 10.0 * d.abs());
        }
    }
    let path = std::path::Path::new(&folder).join(format!("{name}.png"));
    let file = std::fs::File::create(&path).expect("a file");
    all.write_png(file).expect("a picture");
}
