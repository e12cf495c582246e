//! Textures on the GPU against the samplers of the CPU.

mod common;

use common::{context, difference, lit, show};
use glam::{Affine3A, Vec2, Vec3};
use hemicube_gpu::pass::{DrawOptions, Smoothing, TextureFiltering, Walkthrough};
use hemicube_radiosity::Solution;
use hemicube_raster::texture::{Cubic, Magnify, Minify};
use hemicube_raster::{Image, Rgb};
use hemicube_render::{RenderOptions, TextureFilter, render};
use hemicube_scene::{
    Camera, Face, Instance, Material, Mesh, Scene, Texture, TextureImage, TextureSlot, Wrap,
};

const SIZE: [u32; 2] = [120, 90];

/// A floor to the horizon with a picture on it, under a uniform sky.
fn plane(wrap: Wrap, repeats: f32) -> Solution {
    let checks = (0..64 * 64).map(|i| {
        let (x, y) = (i % 64, i / 64);
        let is_light = (x / 8 + y / 8) % 2 == 0;
        let [r, g, b] = if is_light {
            [250, 230, 200]
        } else {
            [20, 30, 60]
        };
        [r, g, b - u8::try_from(y / 2).expect("small"), 255]
    });
    let image = Image::from_pixels(64, 64, checks.collect()).expect("a picture");
    let half = 100.0;
    let corner = |x: f32, z: f32| Vec3::new(x * half, 0.0, z * half);
    let mesh = Mesh {
        name: String::from("floor"),
        positions: vec![
            corner(-1.0, 1.0),
            corner(1.0, 1.0),
            corner(1.0, -1.0),
            corner(-1.0, -1.0),
        ],
        normals: vec![],
        tangents: vec![],
        texcoords: vec![
            [(0.0, 1.0), (1.0, 1.0), (1.0, 0.0), (0.0, 0.0)]
                .map(|(u, v)| (Vec2::new(u, v) - 0.3) * repeats)
                .to_vec(),
        ],
        colors: vec![],
        faces: vec![Face::Quad([0, 1, 2, 3])],
        material: 0,
    };
    let material = Material {
        base_color_texture: Some(TextureSlot::new(0)),
        ..Material::diffuse("floor", Rgb::WHITE)
    };
    lit(
        Scene {
            name: String::from("plane"),
            meshes: vec![mesh],
            instances: vec![Instance {
                node: String::from("floor"),
                mesh: 0,
                world_from_mesh: Affine3A::IDENTITY,
                flipped: false,
            }],
            materials: vec![material],
            textures: vec![Texture::new(0, [wrap; 2])],
            images: vec![TextureImage::from_pixels("checks", image)],
            sky: Rgb::WHITE,
            ..Scene::default()
        },
        64,
    )
}

fn camera(height: f32) -> Camera {
    Camera::looking_at(
        "eye",
        Vec3::new(3.0, height, 20.0),
        Vec3::new(0.0, 0.0, -10.0),
        Vec3::Y,
        0.9,
    )
}

fn compare(wrap: Wrap, repeats: f32, filter: (TextureFilter, Minify), name: &str) -> f64 {
    let Some(context) = context() else { return 0.0 };
    let solution = plane(wrap, repeats);
    let mut gpu = Walkthrough::new(context, &solution).expect("a scene");
    let options = RenderOptions::default()
        .with_size(120, 90)
        .with_samples(1)
        .with_texture_filter(filter.0);
    let cpu = render(&solution, &camera(4.0), &options).expect("CPU");
    let drawn = DrawOptions::default()
        .with_filtering(TextureFiltering::default().with_minify(filter.1))
        .with_smoothing(Smoothing::None);
    let gpu = gpu.linear(&camera(4.0), SIZE, &drawn).expect("GPU");
    show(name, &cpu, &gpu);
    let off = difference(&cpu, &gpu);
    println!("{name}: {off:?}");
    off.mean
}

#[test]
fn filters_from_afar_are_those_of_the_cpu() {
    // Derivatives are differences between neighbours instead of exact; samplers take logarithms and weights in few bits.
    for (filter, minify, most) in [
        (TextureFilter::Point, Minify::Point, 4e-3),
        (TextureFilter::Bilinear, Minify::Bilinear, 4e-3),
        (TextureFilter::Trilinear, Minify::Trilinear, 1.5e-2),
        (TextureFilter::Ewa, Minify::Ewa, 6e-3),
    ] {
        let name = format!("texture-{}", filter.name());
        let off = compare(Wrap::Repeat, 40.0, (filter, minify), &name);
        assert!(off < most, "{name}: {off}");
    }
}

#[test]
fn borders_follow_their_rules() {
    for (wrap, name) in [
        (Wrap::ClampToEdge, "clamp"),
        (Wrap::MirroredRepeat, "mirror"),
    ] {
        for (filter, minify) in [
            (TextureFilter::Ewa, Minify::Ewa),
            (TextureFilter::Bilinear, Minify::Bilinear),
        ] {
            let name = format!("wrap-{name}-{}", filter.name());
            let off = compare(wrap, 9.0, (filter, minify), &name);
            assert!(off < 6e-3, "{name}: {off}");
        }
    }
}

/// Close up the picture is known: the sampler's value times the light.
#[test]
fn kernels_close_up_are_those_of_the_cpu() {
    let Some(context) = context() else { return };
    let solution = plane(Wrap::Repeat, 1.0);
    let scene = solution.mesh().scene().clone();
    let mut gpu = Walkthrough::new(context, &solution).expect("a scene");
    let above = Camera {
        up: Vec3::NEG_Z,
        ..Camera::looking_at(
            "above",
            Vec3::new(5.0, 30.0, -7.0),
            Vec3::new(5.0, 0.0, -7.0),
            Vec3::NEG_Z,
            0.5,
        )
    };
    let usage = hemicube_scene::TextureUse::Color;
    let chain = scene.images[0].chain([Wrap::Repeat; 2], usage);
    for magnify in [
        Magnify::Point,
        Magnify::Bilinear,
        Magnify::Bicubic(Cubic::CatmullRom),
        Magnify::Bicubic(Cubic::BSpline),
        Magnify::Bicubic(Cubic::Mitchell),
    ] {
        let drawn = DrawOptions::default()
            .with_filtering(TextureFiltering::default().with_magnify(magnify))
            .with_smoothing(Smoothing::None);
        let found = gpu.linear(&above, SIZE, &drawn).expect("GPU");
        let sampler = hemicube_raster::texture::Sampler::default().with_magnify(magnify);
        let half = 30.0 * 0.25_f32.tan();
        let color = |x: usize, y: usize| {
            let s = (x as f32 + 0.5) / 120.0 * 2.0 - 1.0;
            let t = (y as f32 + 0.5) / 90.0 * 2.0 - 1.0;
            let place = Vec2::new(5.0 + s * half * 4.0 / 3.0, -7.0 + t * half);
            let uv = (place + 100.0) / 200.0 - 0.3;
            let texel = sampler.sample(chain, uv);
            // The surface lies under the whole sky: all of its light comes back, up to the largest reflectance.
            Rgb::new(texel.x, texel.y, texel.z).map(|band| band.clamp(0.0, 0.98))
        };
        let pixels = (0..120 * 90).map(|i| color(i % 120, i / 120)).collect();
        let expected = Image::from_pixels(120, 90, pixels).expect("a picture");
        show(&format!("magnify-{magnify:?}"), &expected, &found);
        let off = difference(&expected, &found);
        println!("{magnify:?}: {off:?}");
        // Samplers weigh texels of 8 bits in 256 steps, light has 11 digits; single texels may fall to either side.
        assert!(off.mean < 4e-3, "{magnify:?}: {off:?}");
    }
}

#[test]
fn anisotropic_samplers_blur_less_than_trilinear_ones() {
    let Some(context) = context() else { return };
    let solution = plane(Wrap::Repeat, 40.0);
    let mut gpu = Walkthrough::new(context, &solution).expect("a scene");
    let options = RenderOptions::default().with_size(120, 90).with_samples(4);
    let truth = render(&solution, &camera(4.0), &options).expect("CPU");
    let mut off = |minify| {
        let drawn = DrawOptions::default()
            .with_filtering(TextureFiltering::default().with_minify(minify))
            .with_smoothing(Smoothing::None);
        let found = gpu.linear(&camera(4.0), SIZE, &drawn).expect("GPU");
        show(&format!("minify-{minify:?}"), &truth, &found);
        difference(&truth, &found).mean
    };
    let [trilinear, anisotropic, ewa] =
        [Minify::Trilinear, Minify::Anisotropic, Minify::Ewa].map(&mut off);
    println!("trilinear {trilinear:.4}, anisotropic {anisotropic:.4}, EWA {ewa:.4}");
    assert!(ewa < trilinear, "{ewa} {trilinear}");
}
