//! Pictures drawn by a GPU beside those of the CPU: milliseconds of a picture by the clock and as CPU time of the process,
//! which is what counts for adapters that draw in software, and how the two differ.
//!
//! Without an adapter the program says that it skips. An argument names one part: `scenes` or `passes`.

use cpu_time::ProcessTime;
use hemicube::radiosity::form_factor::hemicube::{Hemicube, HemicubeOptions};
use hemicube::radiosity::stop::NEVER;
use hemicube::radiosity::{Order, Shooting, Solution, SolveOptions, Solver, unlit};
use hemicube::raster::texture::{Cubic, Magnify, Minify};
use hemicube::raster::{Image, Rgb};
use hemicube::render::{Reflections, RenderOptions, Renderer, TextureFilter, choose_camera};
use hemicube::scene::{Camera, builtin};
use hemicube_gpu::Context;
use hemicube_gpu::pass::{
    DrawOptions, Interpolation, Lookup, MeshLines, Smoothing, Style, Target, TextureFiltering,
    Walkthrough,
};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Pixels: those of a window.
const SIZE: [u32; 2] = [1280, 720];
/// How long pictures of each kind are drawn, about.
const TIME: Duration = Duration::from_millis(1500);

fn main() {
    let context = match Context::headless(None) {
        Ok(context) => Arc::new(context),
        Err(error) => return println!("skipped: {error}"),
    };
    println!("{}, {} x {} pixels\n", context.name, SIZE[0], SIZE[1]);
    let only = std::env::args().nth(1).filter(|arg| !arg.starts_with('-'));
    let wanted = |part: &str| only.as_deref().is_none_or(|only| only == part);
    if wanted("scenes") {
        scenes(&context);
    }
    if wanted("passes") {
        passes(&context);
    }
}

/// A few shots into a scene.
fn lit(scene: &str, elements: usize) -> Solution {
    let mut options = SolveOptions::default();
    options.mesh = options.mesh.with_elements(elements).with_patches(400);
    let scene = builtin::scene(scene).expect("it is built in");
    let start = unlit(Arc::new(scene), &options, NEVER).expect("it can be cut");
    let hemicube = HemicubeOptions::default().with_resolution(64);
    let factors = Hemicube::new(start.mesh().clone(), hemicube).expect("good options");
    let mut solver = Shooting::new(&factors, start, Order::Sorted);
    for _ in 0..40 {
        solver.step();
    }
    solver.into_solution()
}

fn camera(solution: &Solution) -> Camera {
    let cameras = &solution.mesh().scene().cameras;
    cameras
        .first()
        .cloned()
        .unwrap_or_else(|| choose_camera(solution.mesh()))
}

/// One sample a pixel and four texels a sample on both sides, so that both do the same work.
fn scenes(context: &Arc<Context>) {
    println!("one sample a pixel, trilinear textures: ms of a picture by the clock, by CPU time");
    println!("scene     elements        CPU               GPU          difference");
    for (scene, elements) in [("cornell", 1000), ("cornell", 30_000), ("office", 30_000)] {
        let solution = lit(scene, elements);
        let camera = camera(&solution);
        let cpu = RenderOptions::default()
            .with_size(SIZE[0] as usize, SIZE[1] as usize)
            .with_samples(1)
            .with_texture_filter(TextureFilter::Trilinear);
        let renderer = Renderer::new(&solution, &camera, &cpu).expect("good options");
        let mut gpu = Walkthrough::new(context.clone(), &solution).expect("it fits");
        gpu.gather_reliefs(&solution);
        let options = DrawOptions::default()
            .with_smoothing(Smoothing::None)
            .with_filtering(TextureFiltering::default().with_minify(Minify::Trilinear));
        let drawn = gpu.linear(&camera, SIZE, &options).expect("a picture");
        let off = difference(&renderer.linear(), &drawn);
        assert!(off < 0.02, "{scene}: pictures differ by {off}");
        let a = timed(|| drop(renderer.linear()));
        let b = timed(|| draw(&mut gpu, context, &camera, &options));
        let elements = solution.mesh().elements().len();
        println!("{scene:8} {elements:9} {a} {b} {off:11.5}");
    }
    println!();
}

/// What each technique costs in the office.
fn passes(context: &Arc<Context>) {
    let solution = lit("office", 10_000);
    let camera = camera(&solution);
    let mut gpu = Walkthrough::new(context.clone(), &solution).expect("it fits");
    gpu.gather_reliefs(&solution);
    let one = DrawOptions::default().with_smoothing(Smoothing::None);
    let filtered = |minify, magnify| {
        let filtering = TextureFiltering::default()
            .with_minify(minify)
            .with_magnify(magnify);
        one.clone().with_filtering(filtering)
    };
    let bilinear = Magnify::Bilinear;
    let trilinear = filtered(Minify::Trilinear, bilinear);
    let grid = |name: &str| Smoothing::Supersample(name.parse().expect(name));
    println!("office, 10,000 elements: ms of a picture by the clock, by CPU time");
    for (name, options) in [
        ("plain", one.clone().with_style(Style::Plain(Rgb::WHITE))),
        ("trilinear", trilinear.clone()),
        (
            "flat",
            trilinear.clone().with_interpolation(Interpolation::Flat),
        ),
        ("nearest", filtered(Minify::Point, Magnify::Point)),
        ("anisotropic", filtered(Minify::Anisotropic, bilinear)),
        ("EWA", filtered(Minify::Ewa, bilinear)),
        (
            "EWA, bicubic",
            filtered(Minify::Ewa, Magnify::Bicubic(Cubic::CatmullRom)),
        ),
        ("without bumps", trilinear.clone().with_bumps(false)),
        (
            "with edges",
            trilinear.clone().with_lines(MeshLines::default()),
        ),
        (
            "4 samples on edges",
            trilinear.clone().with_smoothing(Smoothing::Multisample),
        ),
        ("2x2", trilinear.clone().with_smoothing(grid("2x2"))),
        (
            "3x3:bartlett",
            trilinear.clone().with_smoothing(grid("3x3:bartlett")),
        ),
    ] {
        let time = timed(|| draw(&mut gpu, context, &camera, &options));
        println!("{name:20} {time}");
    }
    let wanted = Reflections::default();
    let count = gpu.set_reflections(&solution, &wanted, Lookup::Reflection);
    let count = count.expect("names that there are");
    let time = timed(|| {
        let mut encoder = context.device.create_command_encoder(&Default::default());
        gpu.capture(&mut encoder, 1.0).expect("maps");
        context.queue.submit([encoder.finish()]);
        context.wait().expect("the device works");
    });
    println!("{:20} {time}", format!("{count} maps of mirrors"));
    let time = timed(|| draw(&mut gpu, context, &camera, &trilinear));
    println!("{:20} {time}", "with mirrors");
    let time = timed(|| {
        gpu.set_light(&solution).expect("the same mesh");
        draw(&mut gpu, context, &camera, &trilinear);
    });
    println!("{:20} {time}", "with new light");
}

/// Draws a picture and waits for it.
fn draw(gpu: &mut Walkthrough, context: &Context, camera: &Camera, options: &DrawOptions) {
    let format = wgpu::TextureFormat::Rgba8UnormSrgb;
    let texture = context.device.create_texture(&wgpu::TextureDescriptor {
        label: Some("window"),
        size: wgpu::Extent3d {
            width: SIZE[0],
            height: SIZE[1],
            depth_or_array_layers: 1,
        },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT,
        view_formats: &[],
    });
    let target = Target {
        view: &texture.create_view(&wgpu::TextureViewDescriptor::default()),
        format,
        size: SIZE,
    };
    let mut encoder = context.device.create_command_encoder(&Default::default());
    gpu.draw(&mut encoder, target, camera, options)
        .expect("a picture");
    context.queue.submit([encoder.finish()]);
    context.wait().expect("the device works");
}

/// Milliseconds by the clock and by CPU time, printed side by side.
struct Milliseconds(f64, f64);

impl core::fmt::Display for Milliseconds {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(f, "{:8.1} {:8.1}", self.0, self.1)
    }
}

/// Means over as many pictures as fit into the time, after a first one.
fn timed(mut draw: impl FnMut()) -> Milliseconds {
    draw();
    let (clock, cpu) = (Instant::now(), ProcessTime::now());
    let mut pictures = 0.0;
    while clock.elapsed() < TIME {
        draw();
        pictures += 1.0;
    }
    let of = |time: Duration| 1e3 * time.as_secs_f64() / pictures;
    Milliseconds(of(clock.elapsed()), of(cpu.elapsed()))
}

/// Mean of absolute differences, relative to the mean; what is brighter than ten times that counts as that.
fn difference(a: &Image<Rgb>, b: &Image<Rgb>) -> f64 {
    let luminances = || a.pixels().iter().map(|c| f64::from(c.luminance()));
    let mean = luminances().sum::<f64>() / a.pixels().len() as f64;
    let bounded = |c: &Rgb| f64::from(c.luminance()).min(10.0 * mean);
    let pairs = a.pixels().iter().zip(b.pixels());
    let off = |(a, b): (&Rgb, &Rgb)| (bounded(a) - bounded(b)).abs();
    pairs.map(off).sum::<f64>() / a.pixels().len() as f64 / mean
}
