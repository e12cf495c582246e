//! Everything at once: the office with its textures, panes and mirrors, drawn by both.

mod common;

use common::{camera, context, difference, lit_builtin, show};
use hemicube_gpu::pass::{
    DrawOptions, Lookup, MeshLines, Smoothing, TextureFiltering, Walkthrough,
};
use hemicube_raster::antialias::Antialiasing;
use hemicube_raster::texture::Minify;
use hemicube_raster::tonemap::{Exposure, ToneMap};
use hemicube_render::{Reflections, RenderOptions, Renderer};

const SIZE: [u32; 2] = [240, 160];

#[test]
fn the_office_is_that_of_the_cpu() {
    let Some(context) = context() else { return };
    let solution = lit_builtin("office", 5000);
    let camera = camera(&solution);
    let antialiasing: Antialiasing = "2x2".parse().expect("a name");
    let options = RenderOptions::default()
        .with_size(240, 160)
        .with_antialias(antialiasing);
    let wanted = Reflections::default().with_resolution(64);
    let renderer = Renderer::new(&solution, &camera, &options).expect("good options");
    let renderer = renderer.with_reflections(&wanted).expect("metals");
    let exposure = renderer.exposure_factor(Exposure::Auto);
    let cpu = renderer.display(Exposure::Ev(exposure.log2()), ToneMap::Aces);
    let mut gpu = Walkthrough::new(context.clone(), &solution).expect("it fits");
    gpu.gather_reliefs(&solution);
    let count = gpu.set_reflections(&solution, &wanted, Lookup::Reflection);
    assert_eq!(count.expect("metals"), renderer.mirror_count(), "mirrors");
    let mut encoder = context.device.create_command_encoder(&Default::default());
    gpu.capture(&mut encoder, exposure).expect("maps");
    context.queue.submit([encoder.finish()]);
    let drawn = DrawOptions::default()
        .with_smoothing(Smoothing::Supersample(antialiasing))
        .with_filtering(TextureFiltering::default().with_minify(Minify::Ewa))
        .with_exposure(exposure)
        .with_tone_map(ToneMap::Aces);
    let found = gpu.display(&camera, SIZE, &drawn).expect("a picture");
    show("office", &cpu, &found);
    let off = difference(&cpu, &found);
    println!("{off:?}, {} mirrors", renderer.mirror_count());
    assert!(off.mean < 1e-2, "{off:?}");
    let lined = drawn.with_lines(MeshLines::default());
    let lined = gpu.display(&camera, SIZE, &lined).expect("a picture");
    show("office-lines", &found, &lined);
}
