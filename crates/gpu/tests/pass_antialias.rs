//! Samples of the GPU, and how they become pixels, against those of the CPU.

mod common;

use common::{camera, context, difference, lit_builtin, show};
use hemicube_gpu::pass::{DrawOptions, Smoothing, Walkthrough};
use hemicube_raster::antialias::Antialiasing;
use hemicube_raster::tonemap::{Exposure, ToneMap};
use hemicube_render::{RenderOptions, render, render_display};

const SIZE: [u32; 2] = [160, 120];

fn drawn(name: &str) -> DrawOptions {
    let antialiasing: Antialiasing = name.parse().expect(name);
    DrawOptions::default().with_smoothing(Smoothing::Supersample(antialiasing))
}

fn options(name: &str) -> RenderOptions {
    let antialiasing: Antialiasing = name.parse().expect(name);
    RenderOptions::default()
        .with_size(160, 120)
        .with_antialias(antialiasing)
}

#[test]
fn filters_are_those_of_the_cpu() {
    let Some(context) = context() else { return };
    let solution = lit_builtin("cornell", 400);
    let camera = camera(&solution);
    let mut gpu = Walkthrough::new(context, &solution).expect("a scene");
    for name in [
        "1x1",
        "3x3",
        "2x2:bartlett",
        "3x3:bartlett",
        "4x4:bartlett",
        "2x2:gaussian",
        "3x3:mitchell",
        "2x2:blackman-harris",
        "2x2:lanczos",
    ] {
        let exposure = Exposure::Ev(1.0);
        let tones = ToneMap::Reinhard;
        let cpu = render_display(&solution, &camera, &options(name), exposure, tones);
        let cpu = cpu
            .expect("CPU")
            .map(|c| c.map(|band| band.clamp(0.0, 1.0)));
        let gpu = gpu
            .display(&camera, SIZE, &drawn(name).with_exposure(2.0))
            .expect("GPU");
        let gpu = gpu.map(|c| c.map(|band| band.clamp(0.0, 1.0)));
        show(&format!("antialias-{}", name.replace(':', "-")), &cpu, &gpu);
        let off = difference(&cpu, &gpu);
        println!("{name}: {off:?}");
        // 16 bits of light; samples on edges may fall to either side.
        assert!(off.mean < 2e-3, "{name}: {off:?}");
        assert!(off.share < 2e-2, "{name}: {off:?}");
    }
}

#[test]
fn linear_pictures_are_filtered_too() {
    let Some(context) = context() else { return };
    let solution = lit_builtin("cornell", 400);
    let camera = camera(&solution);
    let mut gpu = Walkthrough::new(context, &solution).expect("a scene");
    let cpu = render(&solution, &camera, &options("2x2")).expect("CPU");
    let gpu = gpu.linear(&camera, SIZE, &drawn("2x2")).expect("GPU");
    let off = difference(&cpu, &gpu);
    assert!(off.mean < 2e-3, "{off:?}");
}

/// Of each picture, how far it is from one of 8 x 8 samples.
#[test]
fn four_samples_for_edges_are_better_than_one_and_near_those_of_a_grid() {
    let Some(context) = context() else { return };
    let solution = lit_builtin("cornell", 400);
    let camera = camera(&solution);
    let mut gpu = Walkthrough::new(context, &solution).expect("a scene");
    let exposed = |options: DrawOptions| options.with_exposure(2.0);
    let mut picture = |options| {
        gpu.display(&camera, SIZE, &exposed(options))
            .expect("a picture")
    };
    let truth = picture(drawn("8x8"));
    let smoothed = |smoothing| DrawOptions::default().with_smoothing(smoothing);
    let one = difference(&truth, &picture(smoothed(Smoothing::None))).mean;
    let four = difference(&truth, &picture(smoothed(Smoothing::Multisample))).mean;
    let grid = difference(&truth, &picture(drawn("2x2"))).mean;
    println!("one sample: {one:.4}, four on edges: {four:.4}, 2 x 2: {grid:.4}");
    assert!(four < 0.6 * one, "{four} {one}");
    assert!(four < 1.3 * grid, "{four} {grid}");
}

#[test]
fn jitter_is_refused_in_words() {
    let Some(context) = context() else { return };
    let solution = lit_builtin("cornell", 300);
    let camera = camera(&solution);
    let mut gpu = Walkthrough::new(context, &solution).expect("a scene");
    let error = gpu
        .display(&camera, SIZE, &drawn("2x2-jittered"))
        .expect_err("jitter");
    assert!(error.to_string().contains("regular"), "{error}");
}
