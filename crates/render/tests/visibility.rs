//! What is seen: sides, holes, layers, edges.

mod common;

use common::{assert_close, from_above, glowing, lit, picture, plain, rectangle, scene_of, square};
use core::f32::consts::PI;
use glam::Vec3;
use hemicube_raster::tonemap::{Exposure, ToneMap};
use hemicube_raster::{Image, Rgb};
use hemicube_render::{render_display, tone_mapped};
use hemicube_scene::builtin::SceneBuilder;
use hemicube_scene::{AlphaMode, Camera, Material, Projection, Units, Wrap};

fn upside_down(corners: [Vec3; 4]) -> [Vec3; 4] {
    let [a, b, c, d] = corners;
    [d, c, b, a]
}

#[test]
fn the_nearer_surface_is_seen_in_any_order() {
    let (near, far) = (
        (glowing(Rgb::splat(1.0)), square(1.0)),
        (glowing(Rgb::splat(2.0)), square(0.0)),
    );
    for surfaces in [[near.clone(), far.clone()], [far, near]] {
        let solution = lit(scene_of(&surfaces), 1.0, |_| Rgb::BLACK);
        for pixel in picture(&solution, &from_above(), &plain(8)).pixels() {
            assert_close(*pixel, Rgb::splat(1.0), 1e-6, "nearer");
        }
    }
}

#[test]
fn one_sided_surfaces_are_not_seen_from_behind() {
    for (double_sided, expected) in [(false, 2.0), (true, 1.0)] {
        let above = Material {
            double_sided,
            ..glowing(Rgb::splat(1.0))
        };
        let floor = glowing(Rgb::splat(2.0));
        let scene = scene_of(&[(above, upside_down(square(1.0))), (floor, square(0.0))]);
        let solution = lit(scene, 1.0, |_| Rgb::BLACK);
        let image = picture(&solution, &from_above(), &plain(4));
        let what = format!("double sided {double_sided}");
        assert_close(*image.pixel(2, 2), Rgb::splat(expected), 1e-6, &what);
    }
}

#[test]
fn holes_of_a_mask_show_what_is_behind() {
    let mut builder = SceneBuilder::new("mask", Units::Radiometric);
    let pixels = (0..16)
        .map(|x| [255, 255, 255, if x < 8 { 0 } else { 255 }])
        .collect();
    let pixels = Image::from_pixels(16, 1, pixels).expect("16 pixels");
    let texture = builder.texture("mask", Wrap::ClampToEdge, pixels);
    let material = builder.textured("mask", texture, glam::Vec2::ONE);
    builder.node("mask");
    builder.picture(material, square(1.0));
    let floor = builder.material(glowing(Rgb::splat(2.0)));
    builder.node("floor");
    builder.quad(floor, square(0.0));
    let mut scene = builder.finish();
    scene.materials[material].alpha_mode = AlphaMode::Mask { cutoff: 0.5 };
    let solution = lit(scene, 1.0, |_| Rgb::splat(PI));
    let image = picture(&solution, &from_above(), &plain(8));
    for y in 0..8 {
        assert_close(
            *image.pixel(1, y),
            Rgb::splat(2.0),
            1e-6,
            "through the hole",
        );
        assert_close(
            *image.pixel(6, y),
            Rgb::splat(0.98),
            1e-6,
            "the mask itself",
        );
    }
}

#[test]
fn layers_are_blended_from_far_to_near() {
    let pane = |alpha: f32, radiance| Material {
        alpha,
        alpha_mode: AlphaMode::Blend,
        ..glowing(radiance)
    };
    let (red, blue) = (Rgb::new(4.0, 0.0, 0.0), Rgb::new(0.0, 0.0, 8.0));
    let tinted = Material {
        transmission: 1.0,
        ..Material::diffuse("glass", Rgb::new(0.5, 0.25, 1.0))
    };
    let floor = Rgb::new(1.0, 2.0, 3.0);
    // Neither in the order of depth nor against it.
    let scene = scene_of(&[
        (pane(0.25, blue), square(2.0)),
        (glowing(floor), square(0.0)),
        (tinted, square(1.0)),
        (pane(0.5, red), square(3.0)),
    ]);
    let solution = lit(scene, 1.0, |_| Rgb::BLACK);
    let through_glass = floor * Rgb::new(0.5, 0.25, 1.0);
    let through_blue = blue * 0.25 + through_glass * 0.75;
    let expected = red * 0.5 + through_blue * 0.5;
    for pixel in picture(&solution, &from_above(), &plain(8).with_samples(2)).pixels() {
        assert_close(*pixel, expected, 1e-6, "blended");
    }
}

#[test]
fn samples_are_averaged_over_the_pixel() {
    // The lamp covers three quarters of the third pixel of four.
    let scene = scene_of(&[(glowing(Rgb::splat(1.0)), rectangle(-1.0, 0.375, 0.0))]);
    let solution = lit(scene, 1.0, |_| Rgb::BLACK);
    let image = picture(&solution, &from_above(), &plain(4).with_samples(4));
    let row: Vec<f32> = (0..4).map(|x| image.pixel(x, 1).r).collect();
    assert_eq!(row, [1.0, 1.0, 0.75, 0.0], "coverage");
}

#[test]
fn edges_of_lamps_are_smooth_on_a_display() {
    let lamp = (glowing(Rgb::splat(1000.0)), rectangle(-1.0, 0.25, 0.0));
    let wall = (glowing(Rgb::splat(0.05)), square(-1.0));
    let solution = lit(scene_of(&[lamp, wall]), 1.0, |_| Rgb::BLACK);
    let (camera, options) = (from_above(), plain(4).with_samples(4));
    let (exposure, tone_map) = (Exposure::Ev(0.0), ToneMap::Reinhard);
    let display = render_display(&solution, &camera, &options, exposure, tone_map);
    let display = display.expect("valid options");
    let (lamp, edge, wall) = (
        *display.pixel(0, 1),
        *display.pixel(2, 1),
        *display.pixel(3, 1),
    );
    assert_close(lamp, Rgb::WHITE, 1e-6, "lamp");
    assert!(wall.r < 0.06, "wall {wall:?}");
    assert_close(edge, (lamp + wall) * 0.5, 1e-6, "edge after tone mapping");
    let linear = picture(&solution, &camera, &options);
    assert_close(
        *linear.pixel(2, 1),
        Rgb::splat(500.025),
        1e-5,
        "linear edge",
    );
    let late = tone_mapped(&linear, exposure, tone_map);
    assert_close(
        *late.pixel(2, 1),
        Rgb::WHITE,
        1e-6,
        "averaged first it would be white",
    );
}

#[test]
fn what_is_close_to_the_eye_and_far_away_is_sorted() {
    // Pictures a millimetre before a wall, 100 m away, with a thing 10 cm before the eye.
    let wall = (
        glowing(Rgb::splat(1.0)),
        square(-100.0).map(|p| p * Vec3::new(90.0, 90.0, 1.0)),
    );
    let frame = (
        glowing(Rgb::splat(2.0)),
        square(-99.99).map(|p| p * Vec3::new(90.0, 90.0, 1.0)),
    );
    let finger = (glowing(Rgb::splat(3.0)), rectangle(0.02, 0.05, -0.1));
    let solution = lit(scene_of(&[wall, frame, finger]), 50.0, |_| Rgb::BLACK);
    let camera = Camera::looking_at("eye", Vec3::ZERO, Vec3::NEG_Z, Vec3::Y, 1.0);
    let image = picture(&solution, &camera, &plain(64));
    for (i, pixel) in image.pixels().iter().enumerate() {
        assert!(pixel.r > 1.5, "pixel {i} shows the wall: {pixel:?}");
    }
}

#[test]
fn orthographic_views_fit_pictures_of_other_shapes() {
    let scene = scene_of(&[(glowing(Rgb::splat(1.0)), square(0.0))]);
    let solution = lit(scene, 1.0, |_| Rgb::BLACK);
    let camera = from_above();
    assert!(
        matches!(camera.projection, Projection::Orthographic { .. }),
        "parallel"
    );
    for (width, height) in [(16, 8), (8, 16)] {
        let image = picture(&solution, &camera, &plain(8).with_size(width, height));
        let covered = image.pixels().iter().filter(|p| p.r > 0.0).count();
        assert_eq!(covered, 64, "square in {width} x {height}");
    }
}

/// Along a slanted border one large surface meets many small ones; their corners fall on the screen's grid beside it.
#[test]
fn surfaces_that_meet_without_sharing_corners_leave_no_pinholes() {
    let (low, high) = (Vec3::new(-0.123, -1.1, 0.0), Vec3::new(0.234, 1.1, 0.0));
    let at = |i: u16| low.lerp(high, f32::from(i) / 100.0);
    let (left, right) = (Vec3::NEG_X * 2.0, Vec3::X * 2.0);
    let mut surfaces = vec![(glowing(Rgb::WHITE), [low + left, low, high, high + left])];
    for i in 0..100 {
        let (a, b) = (at(i), at(i + 1));
        surfaces.push((glowing(Rgb::WHITE), [a, a + right, b + right, b]));
    }
    let solution = lit(scene_of(&surfaces), 100.0, |_| Rgb::BLACK);
    let image = picture(&solution, &from_above(), &plain(2000));
    let holes = image.pixels().iter().filter(|p| p.is_black()).count();
    // The first and last row of a band have no neighbours to compare with.
    assert_eq!(holes, 0, "pixels that look through the border");
}
