//! Lit surfaces of the GPU against those of the CPU.

mod common;

use common::{camera, context, difference, lit_builtin, show};
use hemicube_gpu::pass::{DrawOptions, Interpolation, MeshLines, Smoothing, Walkthrough};
use hemicube_radiosity::DrawnMesh;
use hemicube_raster::tonemap::{Exposure, ToneMap};
use hemicube_raster::{Image, Rgb};
use hemicube_render::{RenderOptions, Shading, render, render_display};

const SIZE: [u32; 2] = [240, 180];

fn options() -> RenderOptions {
    RenderOptions::default().with_size(240, 180).with_samples(1)
}

#[test]
fn light_at_vertices_is_the_mean_of_the_elements_around_them() {
    let solution = lit_builtin("cornell", 600);
    let drawn = DrawnMesh::new(&solution, Rgb::BLACK);
    let values: Vec<Rgb> = (0..solution.mesh().elements().len())
        .map(|e| solution.element_irradiance(e))
        .collect();
    let sources = drawn.light_sources(solution.mesh());
    let means = sources.means(solution.mesh(), &values);
    assert_eq!(means, drawn.irradiance, "the same to the bit");
}

#[test]
fn pictures_are_those_of_the_cpu() {
    let Some(context) = context() else { return };
    let solution = lit_builtin("cornell", 1200);
    let camera = camera(&solution);
    let mut gpu = Walkthrough::new(context, &solution).expect("a scene");
    for (interpolation, shading) in [
        (Interpolation::Flat, Shading::Flat),
        (Interpolation::Gouraud, Shading::Gouraud),
    ] {
        let cpu = render(&solution, &camera, &options().with_shading(shading)).expect("CPU");
        let drawn = DrawOptions::default()
            .with_interpolation(interpolation)
            .with_smoothing(Smoothing::None);
        let gpu = gpu.linear(&camera, SIZE, &drawn).expect("GPU");
        let bounded = |image: &Image<Rgb>| image.map(|c| c.map(|band| band.min(1.0)));
        show(&format!("lit-{shading}"), &bounded(&cpu), &bounded(&gpu));
        let off = difference(&cpu, &gpu);
        println!("{shading}: {off:?}");
        // 16 bits keep 11 binary digits: 5e-4 of the brightest; pixels on edges may fall to either side.
        assert!(off.share < 6e-3, "{shading}: {off:?}");
        assert!(off.of_99 < 2e-3, "{shading}: {off:?}");
    }
}

#[test]
fn tones_are_those_of_the_cpu() {
    let Some(context) = context() else { return };
    let solution = lit_builtin("cornell", 600);
    let camera = camera(&solution);
    let mut gpu = Walkthrough::new(context, &solution).expect("a scene");
    for tone_map in ToneMap::ALL {
        let exposure = Exposure::Ev(1.0);
        let cpu = render_display(&solution, &camera, &options(), exposure, tone_map).expect("CPU");
        let drawn = DrawOptions::default()
            .with_exposure(exposure.factor([]))
            .with_smoothing(Smoothing::None)
            .with_tone_map(tone_map);
        let gpu = gpu.display(&camera, SIZE, &drawn).expect("GPU");
        show(&format!("tones-{tone_map}"), &cpu, &gpu);
        let off = difference(&cpu, &gpu);
        println!("{tone_map}: {off:?}");
        // As above, where curves are steep.
        assert!(off.share < 2e-3 && off.of_99 < 8e-3, "{tone_map}: {off:?}");
    }
}

#[test]
fn automatic_exposure_is_nearly_that_of_the_cpu() {
    let Some(context) = context() else { return };
    let solution = lit_builtin("cornell", 600);
    let camera = camera(&solution);
    let mut gpu = Walkthrough::new(context, &solution).expect("a scene");
    let found = gpu.exposure_factor(&camera, SIZE, Exposure::Auto).expect("a factor");
    let renderer = hemicube_render::Renderer::new(&solution, &camera, &options()).expect("CPU");
    let expected = renderer.exposure_factor(Exposure::Auto);
    // Both are taken from small pictures, of different sizes.
    assert!((found / expected - 1.0).abs() < 0.02, "{found}, not {expected}");
}

#[test]
fn picked_elements_are_those_that_are_seen() {
    let Some(context) = context() else { return };
    let solution = lit_builtin("cornell", 600);
    let camera = camera(&solution);
    let mut gpu = Walkthrough::new(context, &solution).expect("a scene");
    let all = gpu.elements(&camera, SIZE).expect("elements");
    let (mut wrong, mut looked) = (0, 0);
    for pixel in [[20, 30], [120, 90], [200, 150], [60, 170], [119, 40]] {
        let picked = gpu.pick(&camera, SIZE, pixel).expect("an element");
        let [x, y] = pixel.map(|i| i as usize);
        let expected = (*all.pixel(x, y) as usize).checked_sub(1);
        wrong += usize::from(picked != expected);
        looked += 1;
        if let (Some(element), Some(ray)) = (picked, ray_through(&camera, pixel)) {
            let mesh = solution.mesh();
            let hit = mesh.visibility().first_hit(camera.eye, ray, f32::INFINITY);
            let hit = hit.expect("a surface");
            let expected = mesh.element_at(hit.face, hit.side, hit.point);
            assert_eq!(Some(element), expected, "pixel {pixel:?}");
        }
    }
    assert_eq!(wrong, 0, "of {looked}");
}

/// Direction through the middle of a pixel.
fn ray_through(camera: &hemicube_scene::Camera, pixel: [u32; 2]) -> Option<glam::Vec3> {
    let hemicube_scene::Projection::Perspective { vertical_fov, .. } = camera.projection else {
        return None;
    };
    let [x, y] = [0, 1].map(|i| (pixel[i] as f32 + 0.5) / SIZE[i] as f32 * 2.0 - 1.0);
    let half = (0.5 * vertical_fov).tan();
    let aspect = SIZE[0] as f32 / SIZE[1] as f32;
    Some(camera.forward + camera.right() * (x * half * aspect) - camera.up * (y * half))
}

#[test]
fn lines_lie_on_edges_of_elements_only() {
    let Some(context) = context() else { return };
    let solution = lit_builtin("cornell", 300);
    let camera = camera(&solution);
    let mut gpu = Walkthrough::new(context, &solution).expect("a scene");
    let plain = DrawOptions::default().with_smoothing(Smoothing::None);
    let lines = plain.clone().with_lines(MeshLines::default().with_opacity(1.0));
    let without = gpu.display(&camera, SIZE, &plain).expect("a picture");
    let with = gpu.display(&camera, SIZE, &lines).expect("a picture");
    show("lines", &without, &with);
    let elements = gpu.elements(&camera, SIZE).expect("elements");
    let is_border = |x: usize, y: usize| {
        let own = *elements.pixel(x, y);
        let around = (x - 2..=x + 2).flat_map(|x| (y - 2..=y + 2).map(move |y| (x, y)));
        around.into_iter().any(|(x, y)| *elements.pixel(x, y) != own)
    };
    let (mut darker, mut stray, mut borders) = (0, 0, 0);
    for y in 2..178 {
        for x in 2..238 {
            let is_darker = without.pixel(x, y).luminance() - with.pixel(x, y).luminance() > 0.02;
            darker += usize::from(is_darker);
            stray += usize::from(is_darker && !is_border(x, y));
            borders += usize::from(is_border(x, y));
        }
    }
    println!("{darker} pixels of lines, {stray} of them astray, {borders} beside borders");
    assert!(darker * 8 > borders, "{darker} of {borders}");
    assert!(stray * 200 < darker, "{stray} of {darker}");
}

#[test]
fn sizes_and_cameras_that_cannot_be_drawn_are_refused() {
    let Some(context) = context() else { return };
    let solution = lit_builtin("cornell", 300);
    let mut camera = camera(&solution);
    let mut gpu = Walkthrough::new(context, &solution).expect("a scene");
    let options = DrawOptions::default();
    for size in [[0, 4], [1 << 20, 4]] {
        let error = gpu.display(&camera, size, &options).expect_err("a size");
        assert!(!error.to_string().contains('\n'), "{error}");
    }
    camera.projection = hemicube_scene::Projection::Panorama;
    let error = gpu.display(&camera, SIZE, &options).expect_err("a panorama");
    assert!(error.to_string().contains("CPU"), "{error}");
    camera.forward = glam::Vec3::ZERO;
    gpu.display(&camera, SIZE, &options).expect_err("no direction");
}
