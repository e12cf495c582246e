//! Normal maps and height maps on lit surfaces.

mod common;

use common::{assert_close, from_above, glowing, lit, picture, plain, scene_of, square};
use core::f32::consts::PI;
use glam::{Vec2, Vec3};
use hemicube_radiosity::{Solution, SolveOptions, solve};
use hemicube_raster::{Image, Rgb};
use hemicube_render::{RenderOptions, Shading};
use hemicube_scene::builtin::SceneBuilder;
use hemicube_scene::{Camera, Material, Relief, ReliefKind, Scene, TextureSlot, Units, Wrap};
use std::sync::Arc;

/// A square, white in texture terms, with a picture as its relief, and whatever else.
fn with_relief(
    pixels: Image<[u8; 4]>,
    kind: ReliefKind,
    others: &[(Material, [Vec3; 4])],
) -> Scene {
    let mut builder = SceneBuilder::new("relief", Units::Radiometric);
    let texture = builder.texture("bumps", Wrap::Repeat, pixels);
    let material = builder.material(Material {
        relief: Some(Relief {
            slot: TextureSlot::new(texture),
            kind,
        }),
        ..Material::diffuse("wall", Rgb::splat(0.5))
    });
    builder.node("wall");
    builder.picture(material, square(0.0));
    for (material, corners) in others {
        let material = builder.material(material.clone());
        builder.node("other");
        builder.quad(material, *corners);
    }
    builder.finish()
}

const NORMALS: ReliefKind = ReliefKind::Normal { scale: 1.0 };

/// A lamp above the square's right side, turned down.
fn lamp() -> (Material, [Vec3; 4]) {
    let at = |x: f32, y: f32| Vec3::new(2.5 + 0.4 * x, 0.4 * y, 1.8);
    (
        glowing(Rgb::splat(30.0)),
        [at(-1.0, 1.0), at(1.0, 1.0), at(1.0, -1.0), at(-1.0, -1.0)],
    )
}

fn solved(scene: Scene) -> Solution {
    solved_with(scene, 200)
}

fn solved_with(scene: Scene, elements: usize) -> Solution {
    let options = SolveOptions {
        tolerance: 1e-3,
        rays: 128,
        mesh: hemicube_radiosity::PatchOptions::default().with_elements(elements),
        ..SolveOptions::default()
    };
    solve(Arc::new(scene), &options, |_, _| true).expect("a scene with light")
}

/// Texel of a normal, x to the right and y up in the picture.
#[expect(clippy::cast_possible_truncation, reason = "codes of 8 bits")]
fn texel(normal: Vec3) -> [u8; 4] {
    let n = normal.normalize();
    let code = |x: f32| ((x + 1.0) * 127.5).round() as u8;
    [code(n.x), code(n.y), code(n.z), 255]
}

#[test]
fn flat_relief_changes_no_bit() {
    for code in [127, 128] {
        let flat = |kind| with_relief(Image::filled(8, 8, [code, code, 255, 255]), kind, &[lamp()]);
        let bumpy = solved(flat(NORMALS));
        let level = solved(flat(ReliefKind::Height { depth: 0.3 }));
        let mut plain_scene = flat(NORMALS);
        plain_scene.materials[0].relief = None;
        let bare = solved(plain_scene);
        for shading in Shading::ALL {
            let options = plain(24).with_shading(shading).with_gather_rays(16);
            let wanted = picture(&bare, &from_above(), &options);
            assert_eq!(
                wanted,
                picture(&bumpy, &from_above(), &options),
                "{shading}"
            );
            assert_eq!(
                wanted,
                picture(&level, &from_above(), &options),
                "{shading}"
            );
        }
    }
}

/// Red towards the lamp is brighter, away from it darker; the same for heights that rise away from the lamp.
#[test]
fn slopes_that_face_the_lamp_are_brighter() {
    let tilted = |x: f32, y: f32| {
        let texel = texel(Vec3::new(x, y, 1.0));
        let solution = solved(with_relief(Image::filled(4, 4, texel), NORMALS, &[lamp()]));
        let light = |shading| {
            let options = plain(16).with_shading(shading);
            let image = picture(&solution, &from_above(), &options);
            image.pixels().iter().map(|p| p.g).sum::<f32>() / 256.0
        };
        [light(Shading::Gouraud), light(Shading::Gather)]
    };
    let [flat, towards, away, up, down] = [
        tilted(0.0, 0.0),
        tilted(0.4, 0.0),
        tilted(-0.4, 0.0),
        tilted(0.0, 0.4),
        tilted(0.0, -0.4),
    ];
    for i in 0..2 {
        assert!(towards[i] > 1.15 * flat[i], "{towards:?} {flat:?}");
        assert!(away[i] < 0.85 * flat[i], "{away:?} {flat:?}");
        // The lamp stands in the middle of the other direction.
        assert!((up[i] / down[i] - 1.0).abs() < 0.03, "{up:?} {down:?}");
    }
    let ramp = (0..64 * 4)
        .map(|i| [u8::try_from((i % 64) * 4).unwrap_or(u8::MAX); 3])
        .map(|[r, g, b]| [r, g, b, 255]);
    let ramp = Image::from_pixels(64, 4, ramp.collect()).expect("256 texels");
    // Heights grow to the right: slopes face left, away from the lamp.
    let kind = ReliefKind::Height { depth: 0.4 };
    let solution = solved(with_relief(ramp, kind, &[lamp()]));
    let image = picture(&solution, &from_above(), &plain(16));
    let sum: f32 = (0..16).map(|y| image.pixel(7, y).g).sum::<f32>() / 16.0;
    let solution = solved(with_relief(
        Image::filled(4, 4, texel(Vec3::Z)),
        NORMALS,
        &[lamp()],
    ));
    let image = picture(&solution, &from_above(), &plain(16));
    let flat: f32 = (0..16).map(|y| image.pixel(7, y).g).sum::<f32>() / 16.0;
    assert!(sum < 0.9 * flat, "{sum} of {flat}");
}

/// A lamp at the upper edge lights what leans up in the picture, on mirrored instances too; from behind bumps are dents.
#[test]
fn up_in_the_picture_is_up_in_the_world() {
    let sun = |to_light: Vec3| hemicube_scene::Light {
        name: String::from("sun"),
        kind: hemicube_scene::LightKind::Directional {
            direction: -to_light.normalize(),
            irradiance: Rgb::splat(3.0),
        },
    };
    let light = |y: f32, mirrored: bool, behind: bool| {
        let texel = texel(Vec3::new(0.0, y, 1.0));
        let mut scene = with_relief(Image::filled(4, 4, texel), NORMALS, &[]);
        scene.materials[0].double_sided = true;
        if mirrored {
            let flip = glam::Affine3A::from_scale(Vec3::new(-1.0, 1.0, 1.0));
            scene.instances[0].world_from_mesh = flip;
        }
        let side = if behind { -1.0 } else { 1.0 };
        scene.lights.push(sun(Vec3::new(0.0, 0.6, side)));
        let camera = if behind {
            Camera {
                forward: Vec3::Z,
                eye: Vec3::Z * -5.0,
                ..from_above()
            }
        } else {
            from_above()
        };
        let solution = solved(scene);
        let image = picture(&solution, &camera, &plain(4));
        image.pixel(2, 2).g
    };
    for mirrored in [false, true] {
        let [flat, up, down] = [0.0, 0.4, -0.4].map(|y| light(y, mirrored, false));
        assert!(up > 1.08 * flat && down < 0.8 * flat, "{up} {flat} {down}");
        let [flat, up, down] = [0.0, 0.4, -0.4].map(|y| light(y, mirrored, true));
        assert!(down > 1.08 * flat && up < 0.8 * flat, "{up} {flat} {down}");
    }
}

/// The approximation that is stated: fitted at vertices against gathered at each point.
#[test]
fn tilted_light_is_near_to_gathered_light() {
    // Bumps of up to 40 degrees.
    let side = 32;
    let bumps = (0..side * side).map(|i| {
        let (x, y) = ((i % side) as f32, (i / side) as f32);
        let turn = core::f32::consts::TAU / side as f32 * 2.0;
        let slope = Vec2::new((x * turn).sin(), (y * turn).cos()) * 0.6;
        texel(Vec3::new(slope.x, slope.y, 1.0))
    });
    let bumps = Image::from_pixels(side, side, bumps.collect()).expect("all texels");
    let ceiling = [
        Vec3::new(-3.0, 3.0, 4.0),
        Vec3::new(3.0, 3.0, 4.0),
        Vec3::new(3.0, -3.0, 4.0),
        Vec3::new(-3.0, -3.0, 4.0),
    ];
    let white = Material::diffuse("ceiling", Rgb::splat(0.8));
    let scene = with_relief(bumps, NORMALS, &[lamp(), (white, ceiling)]);
    // Root of the mean squared error of interpolated light, and of the light's own variation, over its mean.
    let errors = |scene: Scene| {
        let solution = solved_with(scene, 2000);
        let options = plain(32).with_gather_rays(256);
        let tilted = picture(&solution, &from_above(), &options);
        let options = options.with_shading(Shading::Gather);
        let gathered = picture(&solution, &from_above(), &options);
        let pairs = || tilted.pixels().iter().zip(gathered.pixels());
        let mean = gathered.pixels().iter().map(|p| p.g).sum::<f32>() / 1024.0;
        let square: f32 = pairs().map(|(a, b)| (a.g - b.g).powi(2)).sum();
        let spread: f32 = pairs().map(|(_, b)| (b.g - mean).powi(2)).sum();
        [square, spread].map(|sum| (sum / 1024.0).sqrt() / mean)
    };
    let mut flat = scene.clone();
    flat.materials[0].relief = None;
    let ([flat, _], [bumpy, spread]) = (errors(flat), errors(scene));
    println!("error {bumpy}, without bumps {flat}; spread of light {spread}");
    assert!(spread > 0.5, "the bumps are seen: {spread}");
    assert!(bumpy < 0.025 && flat < 0.01, "{bumpy} and {flat}");
}

#[test]
fn uniform_light_is_hardly_changed_by_bumps() {
    let mut scene = with_relief(
        Image::filled(2, 2, texel(Vec3::new(0.5, 0.0, 1.0))),
        NORMALS,
        &[],
    );
    scene.sky = Rgb::splat(1.0);
    let solution = lit(scene, 0.5, |_| Rgb::splat(PI));
    let image = picture(&solution, &from_above(), &plain(8));
    // (1 + cos θ) / 2 of the sky, and the surface's own radiosity 0.5 from below.
    let cos = 1.0 / 1.25_f32.sqrt();
    let factor = 0.5 * (1.0 + cos) + 0.5 * 0.5 * (1.0 - cos);
    for pixel in image.pixels() {
        assert_close(
            *pixel,
            Rgb::splat(0.5 * factor),
            0.02,
            "tilted under the sky",
        );
    }
}

#[test]
fn scenes_without_texture_coordinates_or_tangents_are_drawn() {
    let mut scene = scene_of(&[(Material::diffuse("bare", Rgb::splat(0.5)), square(0.0))]);
    let image = Image::filled(2, 2, texel(Vec3::new(0.5, 0.2, 1.0)));
    scene
        .images
        .push(hemicube_scene::TextureImage::from_pixels("n", image));
    scene
        .textures
        .push(hemicube_scene::Texture::new(0, [Wrap::Repeat; 2]));
    scene.materials[0].relief = Some(Relief {
        slot: TextureSlot::new(0),
        kind: NORMALS,
    });
    scene.sky = Rgb::WHITE;
    let solution = lit(scene, 0.5, |_| Rgb::splat(1.0));
    for pixel in picture(
        &solution,
        &from_above(),
        &RenderOptions::default().with_size(6, 6),
    )
    .pixels()
    {
        assert!(pixel.is_finite() && pixel.g > 0.0, "{pixel:?}");
    }
}
