//! Filtered textures against exact means over what pixels see.

mod common;

use common::{assert_close, from_above, lit, picture, plain, square};
use core::f32::consts::PI;
use glam::{Vec2, Vec3};
use hemicube_radiosity::Solution;
use hemicube_raster::{Image, Rgb};
use hemicube_render::TextureFilter;
use hemicube_scene::builtin::SceneBuilder;
use hemicube_scene::{AlphaMode, Camera, Magnify, Units, Wrap};

/// A floor with a checkerboard of two greys, so fine that `tiles` fit on a side of 2, under light of radiance 1.
fn checkerboard(tiles: f32) -> Solution {
    let mut builder = SceneBuilder::new("checks", Units::Radiometric);
    let check = |i: usize| {
        if (i / 8 + i).is_multiple_of(2) {
            [255, 255, 255, 255]
        } else {
            [0, 0, 0, 255]
        }
    };
    let pixels = Image::from_pixels(8, 8, (0..64).map(check).collect()).expect("64 texels");
    let texture = builder.texture("checks", Wrap::Repeat, pixels);
    let material = builder.textured("checks", texture, Vec2::splat(2.0 / tiles));
    builder.node("floor");
    builder.picture(material, square(0.0));
    let mut scene = builder.finish();
    let slot = scene.materials[0]
        .base_color_texture
        .as_mut()
        .expect("a texture");
    slot.transform = glam::Affine2::from_scale(Vec2::splat(tiles));
    scene.max_reflectance = 1.0;
    lit(scene, 10.0, |_| Rgb::splat(PI))
}

/// Texels of a fifth of a pixel: every pixel is the mean of white and black in linear light.
#[test]
fn fine_checkerboard_is_grey_from_above() {
    let solution = checkerboard(20.0);
    for (filter, tolerance) in [(TextureFilter::Trilinear, 0.01), (TextureFilter::Ewa, 0.01)] {
        let options = plain(32).with_texture_filter(filter);
        let camera = from_above();
        for pixel in picture(&solution, &camera, &options).pixels() {
            assert_close(*pixel, Rgb::splat(0.5), tolerance, filter.name());
        }
    }
}

/// Root of the mean squared error against many samples, for a plane seen along.
fn error(filter: TextureFilter) -> f32 {
    let solution = checkerboard(16.0);
    let eye = Vec3::new(0.0, -1.3, 0.25);
    let camera = Camera::looking_at("along", eye, Vec3::new(0.0, 0.3, 0.0), Vec3::Z, 0.7);
    let options = plain(64).with_size(96, 48);
    let exact = options
        .with_samples(16)
        .with_texture_filter(TextureFilter::Bilinear);
    let exact = picture(&solution, &camera, &exact);
    let found = picture(&solution, &camera, &options.with_texture_filter(filter));
    let pairs = found.pixels().iter().zip(exact.pixels());
    let square: f32 = pairs.map(|(a, b)| (a.g - b.g).powi(2)).sum();
    (square / (96.0 * 48.0)).sqrt()
}

#[test]
fn filters_come_nearer_to_the_mean_in_their_order() {
    let errors = TextureFilter::ALL.map(error);
    println!("point, bilinear, trilinear, ewa: {errors:?}");
    let [point, bilinear, trilinear, ewa] = errors;
    assert!(bilinear < point && trilinear < 0.6 * bilinear, "{errors:?}");
    assert!(ewa < trilinear, "{errors:?}");
}

#[test]
fn magnification_is_what_the_file_asks_for() {
    let solution = checkerboard(0.25);
    let blocks = |solution: &Solution| {
        let image = picture(solution, &from_above(), &plain(40));
        image
            .pixels()
            .iter()
            .filter(|p| p.g > 0.01 && p.g < 0.99)
            .count()
    };
    assert!(blocks(&solution) > 800, "interpolated");
    let mut scene = (**solution.mesh().scene()).clone();
    scene.textures[0].magnify = Magnify::Nearest;
    let solution = lit(scene, 10.0, |_| Rgb::splat(PI));
    assert_eq!(blocks(&solution), 0, "blocks");
}

/// Opaque materials ignore alpha: transparent black texels do not darken them, and keep their colour.
#[test]
fn alpha_of_opaque_materials_means_nothing() {
    let mut builder = SceneBuilder::new("opaque", Units::Radiometric);
    let pixels = Image::filled(4, 4, [255, 255, 255, 0]);
    let texture = builder.texture("clear", Wrap::Repeat, pixels);
    let material = builder.textured("clear", texture, Vec2::ONE);
    builder.node("plate");
    builder.picture(material, square(0.0));
    let mut scene = builder.finish();
    scene.max_reflectance = 1.0;
    for mode in [AlphaMode::Opaque, AlphaMode::Blend] {
        scene.materials[0].alpha_mode = mode;
        let solution = lit(scene.clone(), 1.0, |_| Rgb::splat(PI));
        let wanted = if mode == AlphaMode::Opaque { 1.0 } else { 0.0 };
        for pixel in picture(&solution, &from_above(), &plain(4)).pixels() {
            assert_close(*pixel, Rgb::splat(wanted), 1e-5, "alpha");
        }
    }
}
