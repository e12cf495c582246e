//! Mirrors and surroundings of the GPU against those of the CPU.

mod common;

use common::{context, difference, lit, show};
use glam::Vec3;
use hemicube_gpu::Context;
use hemicube_gpu::pass::{DrawOptions, Lookup, Smoothing, Walkthrough};
use hemicube_radiosity::{DrawnMesh, Solution};
use hemicube_raster::environment::{
    ConvertOptions, EnvironmentMap, EnvironmentPyramid, PrefilterOptions, PrefilteredEnvironment,
    Projection, convert,
};
use hemicube_raster::{Image, Rgb};
use hemicube_render::{Reflections, RenderOptions, Renderer};
use hemicube_scene::builtin::{SceneBuilder, Sides};
use hemicube_scene::{Camera, Material, Units};
use std::sync::Arc;

const SIZE: [u32; 2] = [120, 90];

/// A room with painted walls, a lamp and a ball.
fn room(ball: Material) -> Solution {
    let mut builder = SceneBuilder::new("room", Units::Radiometric);
    let colors = [
        Rgb::new(0.7, 0.2, 0.1),
        Rgb::new(0.1, 0.3, 0.7),
        Rgb::splat(0.6),
        Rgb::new(0.2, 0.6, 0.2),
    ];
    builder.node("room");
    for (i, color) in colors.into_iter().enumerate() {
        let wall = builder.material(Material::diffuse(format!("wall {i}"), color));
        let turn = glam::Quat::from_rotation_y(i as f32 * core::f32::consts::FRAC_PI_2);
        let at = |x: f32, y: f32| turn * Vec3::new(x, y, -2.0);
        builder.quad(
            wall,
            [at(-2.0, -2.0), at(2.0, -2.0), at(2.0, 2.0), at(-2.0, 2.0)],
        );
    }
    let floor = builder.material(Material::diffuse("floor", Rgb::splat(0.5)));
    let flat = |y: f32| {
        [(-2.0, 2.0), (2.0, 2.0), (2.0, -2.0), (-2.0, -2.0)].map(|(x, z)| Vec3::new(x, y, z))
    };
    builder.quad(floor, flat(-2.0));
    let mut ceiling = flat(2.0);
    ceiling.reverse();
    builder.quad(floor, ceiling);
    let glow = Material::diffuse("glow", Rgb::BLACK).with_emission(Rgb::splat(20.0));
    let glow = builder.material(glow);
    builder.node("lamp");
    let at = |x: f32, z: f32| Vec3::new(0.5 * x, 1.9, 0.5 * z);
    builder.quad(
        glow,
        [at(-1.0, -1.0), at(1.0, -1.0), at(1.0, 1.0), at(-1.0, 1.0)],
    );
    let ball = builder.material(ball);
    builder.node("ball");
    builder.sphere(ball, Vec3::new(0.2, -0.4, 0.0), 0.7, 16);
    lit(builder.finish(), 500)
}

fn mirror(base: Rgb, metallic: f32, roughness: f32) -> Material {
    Material {
        metallic,
        roughness,
        ..Material::diffuse("mirror", base)
    }
}

fn eye() -> Camera {
    Camera::looking_at(
        "eye",
        Vec3::new(0.4, 0.3, 1.9),
        Vec3::new(0.1, -0.3, 0.0),
        Vec3::Y,
        1.1,
    )
}

fn wanted() -> Reflections {
    Reflections::default()
        .with_names(vec![String::from("ball")])
        .with_resolution(64)
}

fn captured(gpu: &mut Walkthrough, context: &Context) {
    let mut encoder = context.device.create_command_encoder(&Default::default());
    gpu.capture(&mut encoder, 1.0).expect("maps");
    context.queue.submit([encoder.finish()]);
}

fn drawn() -> DrawOptions {
    DrawOptions::default().with_smoothing(Smoothing::None)
}

fn options() -> RenderOptions {
    RenderOptions::default().with_size(120, 90).with_samples(1)
}

#[test]
fn objects_mirror_what_is_around_them_as_on_the_cpu() {
    let Some(context) = context() else { return };
    for (name, material, most) in [
        ("metal", mirror(Rgb::splat(0.95), 1.0, 0.0), 1.2e-2),
        ("glossy", mirror(Rgb::new(0.4, 0.5, 0.9), 0.0, 0.25), 1e-2),
        // The CPU has eight levels of roughness, the device as many as halves of 64 down to 8.
        ("rough", mirror(Rgb::splat(0.9), 1.0, 0.6), 2e-2),
    ] {
        let solution = room(material);
        let camera = eye();
        let renderer = Renderer::new(&solution, &camera, &options()).expect("CPU");
        let renderer = renderer.with_reflections(&wanted()).expect("a ball");
        let cpu = renderer.linear();
        let mut gpu = Walkthrough::new(context.clone(), &solution).expect("a scene");
        let count = gpu.set_reflections(&solution, &wanted(), Lookup::Reflection);
        assert_eq!(count.expect("a ball"), 1);
        captured(&mut gpu, &context);
        let found = gpu.linear(&camera, SIZE, &drawn()).expect("GPU");
        let matt = gpu
            .linear(&camera, SIZE, &drawn().with_reflections(false))
            .expect("GPU");
        let bounded = |image: &Image<Rgb>| image.map(|c| c.map(|band| band.min(1.0)));
        show(&format!("mirror-{name}"), &bounded(&cpu), &bounded(&found));
        let off = difference(&bounded(&cpu), &bounded(&found));
        let mirrored = difference(&bounded(&cpu), &bounded(&matt)).mean;
        println!("{name}: {off:?}, mirrored {mirrored:.3}");
        assert!(off.mean < most, "{name}: {off:?}");
        assert!(mirrored > 2.0 * off.mean, "{name}: {mirrored}");
    }
}

#[test]
fn mirrors_in_a_furnace_are_invisible() {
    let Some(context) = context() else { return };
    let radiance = Rgb::new(1.0, 2.0, 3.0);
    for roughness in [0.0, 0.3, 1.0] {
        let mut builder = SceneBuilder::new("furnace", Units::Radiometric);
        let glow = Material::diffuse("glow", Rgb::BLACK).with_emission(radiance);
        let wall = builder.material(glow);
        let ball = builder.material(mirror(Rgb::WHITE, 1.0, roughness));
        builder.node("room");
        builder.room(wall, Vec3::splat(-2.0), Vec3::splat(2.0), Sides::ALL);
        builder.node("ball");
        builder.sphere(ball, Vec3::ZERO, 0.6, 12);
        let solution = lit(builder.finish(), 100);
        let mut gpu = Walkthrough::new(context.clone(), &solution).expect("a scene");
        gpu.set_reflections(&solution, &wanted(), Lookup::Reflection)
            .expect("a ball");
        captured(&mut gpu, &context);
        let camera = Camera::looking_at("eye", Vec3::new(0.2, 0.3, 1.7), Vec3::ZERO, Vec3::Y, 1.0);
        let found = gpu.linear(&camera, SIZE, &drawn()).expect("GPU");
        for pixel in found.pixels() {
            let off = (*pixel - radiance).map(f32::abs).max_band();
            // Each of the ways into faces, halves, levels and the picture rounds to 11 digits.
            assert!(off < 1e-2, "roughness {roughness}: {pixel:?}");
        }
    }
}

/// Colours that change smoothly with the direction, and a lamp.
fn sky() -> EnvironmentMap {
    EnvironmentMap::from_fn(Projection::LatLong, 64, 2, |d| {
        let lamp = if d.dot(Vec3::new(0.6, 0.6, -0.5).normalize()) > 0.97 {
            4.0
        } else {
            0.0
        };
        Rgb::new(0.5 + 0.4 * d.x, 0.5 + 0.4 * d.y, 0.5 + 0.4 * d.z) + Rgb::splat(lamp)
    })
}

/// A ball under the open sky.
fn open(ball: Material) -> Solution {
    let mut builder = SceneBuilder::new("open", Units::Radiometric);
    let ball = builder.material(ball);
    builder.node("ball");
    builder.sphere(ball, Vec3::ZERO, 1.0, 24);
    let glow = Material::diffuse("glow", Rgb::BLACK).with_emission(Rgb::WHITE);
    let glow = builder.material(glow);
    builder.node("lamp");
    let at = |x: f32, z: f32| Vec3::new(x, 30.0, z);
    builder.quad(
        glow,
        [at(-1.0, -1.0), at(1.0, -1.0), at(1.0, 1.0), at(-1.0, 1.0)],
    );
    lit(builder.finish(), 300)
}

fn levels(projection: Projection) -> Vec<EnvironmentMap> {
    let (map, _) = convert(&sky(), projection, &ConvertOptions::default().with_rows(64));
    let options = PrefilterOptions::default()
        .with_rows(64)
        .with_levels(4)
        .with_samples(64)
        .with_projection(projection);
    let map = EnvironmentPyramid::new(map);
    PrefilteredEnvironment::new(&map, &options)
        .levels()
        .to_vec()
}

/// What a perfect mirror shows: the map itself, looked up on the CPU.
#[test]
fn maps_of_all_projections_are_looked_up_as_on_the_cpu() {
    let Some(context) = context() else { return };
    let solution = open(mirror(Rgb::WHITE, 1.0, 0.0));
    let camera = Camera::looking_at("eye", Vec3::new(1.0, 0.8, 3.0), Vec3::ZERO, Vec3::Y, 0.8);
    let mut gpu = Walkthrough::new(context, &solution).expect("a scene");
    let elements = gpu.elements(&camera, SIZE).expect("elements");
    let seen = normals(&solution, &camera, &elements);
    for projection in Projection::ALL {
        let levels = levels(projection);
        for lookup in [Lookup::Reflection, Lookup::Normal] {
            gpu.set_reflected_map(&solution, &wanted(), &levels, lookup)
                .expect("a map");
            let found = gpu.linear(&camera, SIZE, &drawn()).expect("GPU");
            let shown = |&(normal, to_eye): &(Vec3, Vec3)| {
                if normal == Vec3::ZERO {
                    return Rgb::BLACK;
                }
                let facing = hemicube_raster::bump::facing(normal, to_eye);
                levels[0].radiance(match lookup {
                    Lookup::Reflection => hemicube_raster::environment::reflected(facing, to_eye),
                    Lookup::Normal => facing,
                })
            };
            let expected = seen.map(shown);
            show(&format!("map-{projection}-{lookup:?}"), &expected, &found);
            let off = difference(&expected, &found);
            println!("{projection}, {lookup:?}: {off:?}");
            // Normals are interpolated by the GPU and recomputed here; 16 bits; cubes by the sampler's 8 bits.
            assert!(off.mean < 2e-3 && off.share < 2e-2, "{projection}: {off:?}");
        }
    }
}

/// For each pixel the interpolated normal, and the direction to the eye; no normal where nothing is.
fn normals(solution: &Solution, camera: &Camera, elements: &Image<u32>) -> Image<(Vec3, Vec3)> {
    let drawn = DrawnMesh::new(solution, Rgb::BLACK);
    let mut of_elements = vec![Vec::new(); solution.mesh().elements().len()];
    for part in &drawn.parts {
        for (triangle, &element) in part.triangles.iter().zip(&part.elements) {
            of_elements[element as usize].push(triangle.map(|v| v as usize));
        }
    }
    let half = 0.4_f32.tan();
    let normal = |i: usize| {
        let (x, y) = (i % 120, i / 120);
        let right = ((x as f32 + 0.5) / 60.0 - 1.0) * half * 4.0 / 3.0;
        let up = (1.0 - (y as f32 + 0.5) / 45.0) * half;
        let ray = camera.forward + camera.right() * right + camera.up * up;
        let element = elements.pixel(x, y).checked_sub(1);
        let triangles = element.map(|e| of_elements[e as usize].as_slice());
        let met = triangles
            .unwrap_or(&[])
            .iter()
            .map(|t| met(&drawn, t, camera.eye, ray));
        let best = met.max_by(|a, b| a.0.total_cmp(&b.0));
        (
            best.map_or(Vec3::ZERO, |(_, normal)| normal),
            -ray.normalize(),
        )
    };
    let pixels = (0..120 * 90).map(normal).collect();
    Image::from_pixels(120, 90, pixels).expect("a picture")
}

/// How far inside of a triangle a ray meets its plane, and the normal there.
fn met(drawn: &DrawnMesh, triangle: &[usize; 3], eye: Vec3, ray: Vec3) -> (f32, Vec3) {
    let [a, b, c] = triangle.map(|v| drawn.positions[v]);
    let (e1, e2, offset) = (b - a, c - a, eye - a);
    let p = ray.cross(e2);
    let determinant = e1.dot(p);
    let v = offset.dot(p) / determinant;
    let w = ray.dot(offset.cross(e1)) / determinant;
    let [n0, n1, n2] = triangle.map(|v| drawn.normals[v]);
    let normal = n0 * (1.0 - v - w) + n1 * v + n2 * w;
    (v.min(w).min(1.0 - v - w), normal.normalize())
}

#[test]
fn surroundings_are_those_of_the_cpu() {
    let Some(context) = context() else { return };
    let solution = open(Material::diffuse("matt", Rgb::splat(0.5)));
    let camera = Camera::looking_at("eye", Vec3::new(1.0, 0.8, 3.0), Vec3::Y, Vec3::Y, 1.4);
    let mut gpu = Walkthrough::new(context, &solution).expect("a scene");
    for projection in [
        Projection::Cube,
        Projection::LatLong,
        Projection::Octahedral,
        Projection::Sphere,
    ] {
        let (map, _) = convert(
            &sky(),
            projection,
            &ConvertOptions::default().with_rows(256),
        );
        let renderer = Renderer::new(&solution, &camera, &options()).expect("CPU");
        let cpu = renderer.with_surroundings(map.clone()).linear();
        gpu.set_surroundings(Some(map)).expect("a map");
        let found = gpu.linear(&camera, SIZE, &drawn()).expect("GPU");
        show(&format!("around-{projection}"), &cpu, &found);
        let off = difference(&cpu, &found);
        println!("{projection}: {off:?}");
        // Levels are chosen by a step between neighbours instead of derivatives.
        assert!(off.mean < 4e-3, "{projection}: {off:?}");
    }
}

/// A pane before a wall: what is behind is tinted and dimmed as on the CPU.
#[test]
fn panes_let_light_through_as_on_the_cpu() {
    let Some(context) = context() else { return };
    let mut builder = SceneBuilder::new("panes", Units::Radiometric);
    let glow = Material::diffuse("glow", Rgb::BLACK).with_emission(Rgb::new(1.0, 0.8, 0.6));
    let wall = builder.material(glow);
    builder.node("wall");
    let square = |z: f32, side: f32| {
        [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]
            .map(|(x, y)| Vec3::new(x * side, y * side, z))
    };
    builder.quad(wall, square(0.0, 1.0));
    for (i, color) in [Rgb::new(0.9, 0.3, 0.3), Rgb::new(0.3, 0.9, 0.4)]
        .into_iter()
        .enumerate()
    {
        let pane = builder.material(Material {
            transmission: 0.8,
            ..Material::diffuse(format!("pane {i}"), color)
        });
        builder.node("pane");
        let x = i as f32 * 0.5 - 0.25;
        builder.quad(
            pane,
            square(0.5 + i as f32 * 0.3, 0.4).map(|p| p + Vec3::X * x),
        );
    }
    let solution = Arc::new(lit(builder.finish(), 60));
    let camera = Camera::looking_at("eye", Vec3::new(0.3, 0.2, 3.0), Vec3::ZERO, Vec3::Y, 0.7);
    let cpu = Renderer::new(&solution, &camera, &options())
        .expect("CPU")
        .linear();
    let mut gpu = Walkthrough::new(context, &solution).expect("a scene");
    let found = gpu.linear(&camera, SIZE, &drawn()).expect("GPU");
    show("panes", &cpu, &found);
    let off = difference(&cpu, &found);
    println!("{off:?}");
    assert!(off.of_99 < 4e-3 && off.share < 5e-3, "{off:?}");
}
