//! Reliefs on the GPU against those of the CPU.

mod common;

use common::{context, difference, lit, show};
use glam::{Vec2, Vec3};
use hemicube_gpu::pass::{DrawOptions, Interpolation, Smoothing, TextureFiltering, Walkthrough};
use hemicube_radiosity::Solution;
use hemicube_raster::texture::Minify;
use hemicube_raster::{Image, Rgb};
use hemicube_render::{RenderOptions, Shading, render};
use hemicube_scene::builtin::SceneBuilder;
use hemicube_scene::{Camera, Material, Relief, ReliefKind, TextureSlot, Units, Wrap};

const SIZE: [u32; 2] = [120, 90];

/// Normals of round bumps, as codes.
fn bumps() -> Image<[u8; 4]> {
    let texel = |i: usize| {
        let at = Vec2::new((i % 32) as f32, (i / 32) as f32) / 16.0 - 1.0 + 1.0 / 32.0;
        let slope = if at.length() < 0.9 {
            at * 0.8
        } else {
            Vec2::ZERO
        };
        let normal = Vec3::new(slope.x, -slope.y, 1.0).normalize();
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "codes of 8 bits"
        )]
        let [x, y, z] = normal.to_array().map(|n| ((n + 1.0) * 127.5).round() as u8);
        [x, y, z, 255]
    };
    Image::from_pixels(32, 32, (0..32 * 32).map(texel).collect()).expect("a picture")
}

/// Heights of the same bumps.
fn heights() -> Image<[u8; 4]> {
    let texel = |i: usize| {
        let at = Vec2::new((i % 32) as f32, (i / 32) as f32) / 16.0 - 1.0 + 1.0 / 32.0;
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "codes of 8 bits"
        )]
        let height = ((1.0 - at.length()).max(0.0) * 255.0) as u8;
        [height, height, height, 255]
    };
    Image::from_pixels(32, 32, (0..32 * 32).map(texel).collect()).expect("a picture")
}

/// A wall with a relief, lit from the right.
fn wall(pixels: Image<[u8; 4]>, kind: ReliefKind) -> Solution {
    let mut builder = SceneBuilder::new("relief", Units::Radiometric);
    let texture = builder.texture("bumps", Wrap::Repeat, pixels);
    let mut slot = TextureSlot::new(texture);
    slot.transform = glam::Affine2::from_scale(Vec2::splat(4.0));
    let material = builder.material(Material {
        relief: Some(Relief { slot, kind }),
        ..Material::diffuse("wall", Rgb::splat(0.5))
    });
    builder.node("wall");
    let at = |x: f32, y: f32| Vec3::new(x, y, 0.0);
    builder.picture(
        material,
        [at(-1.0, -1.0), at(1.0, -1.0), at(1.0, 1.0), at(-1.0, 1.0)],
    );
    let glow = Material::diffuse("glow", Rgb::BLACK).with_emission(Rgb::splat(30.0));
    let glow = builder.material(glow);
    builder.node("lamp");
    let at = |x: f32, y: f32| Vec3::new(2.2 + 0.4 * x, 0.4 * y, 1.2);
    builder.quad(
        glow,
        [at(-1.0, 1.0), at(1.0, 1.0), at(1.0, -1.0), at(-1.0, -1.0)],
    );
    lit(builder.finish(), 60)
}

fn camera() -> Camera {
    Camera::looking_at(
        "eye",
        Vec3::new(-0.8, -0.5, 1.6),
        Vec3::new(0.1, 0.1, 0.0),
        Vec3::Y,
        1.0,
    )
}

#[test]
fn bumps_are_those_of_the_cpu() {
    let Some(context) = context() else { return };
    for (name, pixels, kind) in [
        ("normals", bumps(), ReliefKind::Normal { scale: 1.0 }),
        ("strong", bumps(), ReliefKind::Normal { scale: -1.7 }),
        ("heights", heights(), ReliefKind::Height { depth: 0.3 }),
    ] {
        let solution = wall(pixels, kind);
        let mut gpu = Walkthrough::new(context.clone(), &solution).expect("a scene");
        gpu.gather_reliefs(&solution);
        for (interpolation, shading) in [
            (Interpolation::Gouraud, Shading::Gouraud),
            (Interpolation::Flat, Shading::Flat),
        ] {
            let options = RenderOptions::default()
                .with_size(120, 90)
                .with_samples(1)
                .with_shading(shading);
            let cpu = render(&solution, &camera(), &options).expect("CPU");
            let drawn = DrawOptions::default()
                .with_smoothing(Smoothing::None)
                .with_filtering(TextureFiltering::default().with_minify(Minify::Ewa))
                .with_interpolation(interpolation);
            let found = gpu.linear(&camera(), SIZE, &drawn).expect("GPU");
            let flat = gpu.linear(&camera(), SIZE, &drawn.clone().with_bumps(false));
            show(&format!("bump-{name}-{shading}"), &cpu, &found);
            let off = difference(&cpu, &found);
            let bumps = difference(&cpu, &flat.expect("GPU")).mean;
            println!("{name}, {shading}: {off:?}; bumps are {bumps:.3}");
            // Footprints are differences between neighbours instead of exact, samplers weigh texels in 256 steps.
            assert!(off.mean < 5e-3, "{name}: {off:?}");
            assert!(bumps > 20.0 * off.mean, "{name}: {bumps} without bumps");
        }
    }
}

/// Under a sky that is everywhere the same, half of which a wall sees, slopes are darker by half of what they lose.
#[test]
fn before_light_is_gathered_bumps_lie_under_a_uniform_sky() {
    let Some(context) = context() else { return };
    let tilted = Vec3::new(0.6, 0.0, 0.8);
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "codes of 8 bits"
    )]
    let [x, y, z] = tilted.to_array().map(|n| ((n + 1.0) * 127.5).round() as u8);
    let solution = wall(
        Image::filled(4, 4, [x, y, z, 255]),
        ReliefKind::Normal { scale: 1.0 },
    );
    let mut gpu = Walkthrough::new(context, &solution).expect("a scene");
    let drawn = DrawOptions::default().with_smoothing(Smoothing::None);
    let bumped = gpu.linear(&camera(), SIZE, &drawn).expect("GPU");
    let flat = gpu
        .linear(&camera(), SIZE, &drawn.with_bumps(false))
        .expect("GPU");
    let ratio = bumped.pixel(60, 45).g / flat.pixel(60, 45).g;
    // Light is linear in slopes between 20 and 40 degrees.
    assert!((ratio - 0.9).abs() < 1e-2, "{ratio}");
}
