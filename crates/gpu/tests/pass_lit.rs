//! Lit surfaces of the GPU against those of the CPU.

mod common;

use common::{camera, context, difference, lit_builtin, show};
use hemicube_gpu::pass::{DrawOptions, Interpolation, MeshLines, Smoothing, Target, Walkthrough};
use hemicube_gpu::{Context, GpuShooting};
use hemicube_radiosity::form_factor::hemicube::HemicubeOptions;
use hemicube_radiosity::stop::NEVER;
use hemicube_radiosity::{DrawnMesh, SolveOptions, Solver, unlit};
use hemicube_raster::tonemap::{Exposure, ToneMap};
use hemicube_raster::{Image, Rgb};
use hemicube_render::{RenderOptions, Shading, render, render_display};
use hemicube_scene::builtin;
use std::sync::Arc;

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
    let means = sources.means(&values);
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
fn light_that_is_solved_on_the_device_is_drawn_from_there() {
    let Some(context) = context() else { return };
    let scene = Arc::new(builtin::scene("cornell").expect("a built-in scene"));
    let mut options = SolveOptions::default();
    options.mesh = options.mesh.with_elements(600).with_patches(100);
    let start = unlit(scene, &options, NEVER).expect("a start");
    let camera = camera(&start);
    let mut gpu = Walkthrough::new(context.clone(), &start).expect("a scene");
    let hemicube = HemicubeOptions::default().with_resolution(64);
    let mut solver = GpuShooting::new(context, start, hemicube).expect("a solver");
    let drawn = DrawOptions::default().with_smoothing(Smoothing::None);
    gpu.set_light_of(&solver.light()).expect("the same mesh");
    let dark = gpu.linear(&camera, SIZE, &drawn).expect("a picture");
    for _ in 0..4 {
        solver.step();
    }
    // Ends the shot that is under way.
    solver.settle();
    gpu.set_light_of(&solver.light()).expect("the same mesh");
    let found = gpu.linear(&camera, SIZE, &drawn).expect("a picture");
    gpu.set_light(solver.solution()).expect("the same mesh");
    let expected = gpu.linear(&camera, SIZE, &drawn).expect("a picture");
    let off = difference(&expected, &found);
    assert!(off.of_99 < 1e-6, "{off:?}");
    assert!(difference(&expected, &dark).mean > 0.3, "light has come");
}

#[test]
fn light_of_another_mesh_is_refused() {
    let Some(context) = context() else { return };
    let mut gpu = Walkthrough::new(context, &lit_builtin("cornell", 300)).expect("a scene");
    let error = gpu
        .set_light(&lit_builtin("cornell", 600))
        .expect_err("other elements");
    assert!(error.to_string().contains("anew"), "{error}");
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
    let found = gpu
        .exposure_factor(&camera, SIZE, Exposure::Auto)
        .expect("a factor");
    let renderer = hemicube_render::Renderer::new(&solution, &camera, &options()).expect("CPU");
    let expected = renderer.exposure_factor(Exposure::Auto);
    // Both are taken from small pictures, of different sizes.
    assert!(
        (found / expected - 1.0).abs() < 0.02,
        "{found}, not {expected}"
    );
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
    let lines = plain
        .clone()
        .with_lines(MeshLines::default().with_opacity(1.0));
    let without = gpu.display(&camera, SIZE, &plain).expect("a picture");
    let with = gpu.display(&camera, SIZE, &lines).expect("a picture");
    show("lines", &without, &with);
    let elements = gpu.elements(&camera, SIZE).expect("elements");
    let is_border = |x: usize, y: usize| {
        let own = *elements.pixel(x, y);
        let around = (x - 2..=x + 2).flat_map(|x| (y - 2..=y + 2).map(move |y| (x, y)));
        around
            .into_iter()
            .any(|(x, y)| *elements.pixel(x, y) != own)
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
    for size in [[0, 4], [1 << 20, 1 << 8]] {
        let error = gpu.display(&camera, size, &options).expect_err("a size");
        assert!(!error.to_string().contains('\n'), "{error}");
    }
    camera.projection = hemicube_scene::Projection::Panorama;
    let error = gpu
        .display(&camera, SIZE, &options)
        .expect_err("a panorama");
    assert!(error.to_string().contains("CPU"), "{error}");
    camera.forward = glam::Vec3::ZERO;
    gpu.display(&camera, SIZE, &options)
        .expect_err("no direction");
}

#[test]
fn a_lost_device_is_an_error() {
    let Some(context) = context() else { return };
    let solution = lit_builtin("cornell", 300);
    let camera = camera(&solution);
    let mut gpu = Walkthrough::new(context.clone(), &solution).expect("a scene");
    context.device.destroy();
    let options = DrawOptions::default();
    let error = gpu.display(&camera, SIZE, &options).expect_err("no device");
    assert!(error.to_string().contains("lost"), "{error}");
    gpu.pick(&camera, SIZE, [3, 4]).expect_err("no device");
}

/// The same picture in targets of other formats: encoded here where the format does not do it, in the bytes' order.
#[test]
fn formats_show_the_same_colours() {
    let Some(context) = context() else { return };
    let solution = lit_builtin("cornell", 300);
    let camera = camera(&solution);
    // A device that somebody else has made.
    let (device, queue) = (context.device.clone(), context.queue.clone());
    let context = Arc::new(Context::from_wgpu("window", device, queue).expect("good limits"));
    let mut gpu = Walkthrough::new(context.clone(), &solution).expect("a scene");
    let options = DrawOptions::default().with_smoothing(Smoothing::None);
    let linear = gpu.display(&camera, SIZE, &options).expect("a picture");
    let encoded = |c: Rgb| c.to_array().map(hemicube_raster::color::srgb8_from_linear);
    let expected: Vec<[u8; 3]> = linear.pixels().iter().map(|&c| encoded(c)).collect();
    use wgpu::TextureFormat::{Bgra8Unorm, Bgra8UnormSrgb, Rgba8Unorm, Rgba8UnormSrgb};
    for format in [Rgba8Unorm, Rgba8UnormSrgb, Bgra8Unorm, Bgra8UnormSrgb] {
        let bytes = drawn_in(&context, &mut gpu, (&camera, &options), format);
        let is_turned = [Bgra8Unorm, Bgra8UnormSrgb].contains(&format);
        for (texel, expected) in bytes.chunks_exact(4).zip(&expected) {
            let [r, g, b] = if is_turned { [2, 1, 0] } else { [0, 1, 2] }.map(|i| texel[i]);
            let off = [
                r.abs_diff(expected[0]),
                g.abs_diff(expected[1]),
                b.abs_diff(expected[2]),
            ];
            // Encoders of drivers round on their own.
            assert!(
                off.iter().all(|&o| o <= 2),
                "{format:?}: {texel:?}, not {expected:?}"
            );
        }
    }
}

/// Draws into a texture of a format and reads its bytes.
fn drawn_in(
    context: &Context,
    gpu: &mut Walkthrough,
    (camera, options): (&hemicube_scene::Camera, &DrawOptions),
    format: wgpu::TextureFormat,
) -> Vec<u8> {
    // Rows of 256 bytes need no filling.
    let (width, height) = (SIZE[0].next_multiple_of(64), SIZE[1]);
    let size = wgpu::Extent3d {
        width: SIZE[0],
        height,
        depth_or_array_layers: 1,
    };
    let texture = context.device.create_texture(&wgpu::TextureDescriptor {
        label: None,
        size,
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC,
        view_formats: &[],
    });
    let buffer = context.device.create_buffer(&wgpu::BufferDescriptor {
        label: None,
        size: u64::from(4 * width * height),
        usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    let mut encoder = context.device.create_command_encoder(&Default::default());
    let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
    let target = Target {
        view: &view,
        format,
        size: SIZE,
    };
    gpu.draw(&mut encoder, target, camera, options)
        .expect("a picture");
    let layout = wgpu::TexelCopyBufferLayout {
        offset: 0,
        bytes_per_row: Some(4 * width),
        rows_per_image: None,
    };
    let to = wgpu::TexelCopyBufferInfo {
        buffer: &buffer,
        layout,
    };
    encoder.copy_texture_to_buffer(texture.as_image_copy(), to, size);
    context.queue.submit([encoder.finish()]);
    buffer.map_async(wgpu::MapMode::Read, .., |mapped| {
        mapped.expect("it can be read");
    });
    context.wait().expect("the device works");
    let view = buffer.get_mapped_range(..).expect("it is mapped");
    let rows = view.chunks_exact(4 * width as usize);
    rows.flat_map(|row| &row[..4 * SIZE[0] as usize])
        .copied()
        .collect()
}
