//! Sky, sun, point and spot lights against closed forms, and light through panes and holes.

use core::f32::consts::PI;
use glam::{Vec2, Vec3};
use hemicube::radiosity::{GatherOptions, Gatherer, PatchOptions, SolveOptions, solve};
use hemicube::raster::{Image, Rgb};
use hemicube::scene::builtin::{SceneBuilder, Sides};
use hemicube::scene::{AlphaMode, Light, LightKind, Material, Scene, Units, Wrap};
use std::sync::Arc;

/// A grey floor of 4 x 4 m at y = 0, facing up.
fn floor() -> SceneBuilder {
    let mut builder = SceneBuilder::new("floor", Units::Photometric);
    let grey = builder.diffuse("grey", 0.5, 0.5, 0.5);
    builder.node("floor");
    let corners = [(-2.0, 2.0), (2.0, 2.0), (2.0, -2.0), (-2.0, -2.0)];
    builder.quad(grey, corners.map(|(x, z)| Vec3::new(x, 0.0, z)));
    builder
}

/// A square pane of 12 x 12 m, 1 m above the floor, seen from both sides.
fn pane(builder: &mut SceneBuilder, material: Material) {
    let glass = builder.material(Material {
        double_sided: true,
        ..material
    });
    builder.node("pane");
    let corners = [(-6.0, 6.0), (6.0, 6.0), (6.0, -6.0), (-6.0, -6.0)];
    builder.quad(glass, corners.map(|(x, z)| Vec3::new(x, 1.0, z)));
}

fn with_light(mut scene: Scene, kind: LightKind) -> Scene {
    scene.lights.push(Light {
        name: "light".into(),
        kind,
    });
    scene
}

/// Irradiance in the middle of the floor, by gathering and as the element there has it.
fn in_the_middle(scene: Scene) -> (Rgb, Rgb) {
    let options = SolveOptions {
        mesh: PatchOptions::default()
            .with_element_size(0.05)
            .with_patch_size(0.5),
        tolerance: 1e-3,
        ..SolveOptions::default()
    };
    let solution = solve(Arc::new(scene), &options, |_, _| true).expect("it can be solved");
    let at = Vec3::new(0.01, 0.0, 0.012);
    let gathered = Gatherer::new(
        &solution,
        GatherOptions {
            rays: 16_384,
            seed: 0,
        },
    )
    .irradiance(at, Vec3::Y);
    let mesh = solution.mesh();
    let distance = |e: &usize| mesh.node(mesh.elements()[*e]).centroid.distance_squared(at);
    let nearest = (0..mesh.elements().len()).min_by(|a, b| distance(a).total_cmp(&distance(b)));
    (
        gathered,
        solution.element_irradiance(nearest.expect("there are elements")),
    )
}

#[track_caller]
fn assert_close(found: (Rgb, Rgb), exact: Rgb, relative: f32) {
    for (name, value) in [("gathered", found.0), ("element", found.1)] {
        for band in 0..3 {
            let error = (value[band] / exact[band] - 1.0).abs();
            assert!(
                error < relative,
                "{name}, band {band}: {} is not {}",
                value[band],
                exact[band]
            );
        }
    }
}

#[test]
fn an_open_sky_gives_pi_times_its_radiance() {
    let mut scene = floor().finish();
    scene.sky = Rgb::new(100.0, 200.0, 300.0);
    assert_close(in_the_middle(scene.clone()), scene.sky * PI, 1e-5);
}

#[test]
fn the_sun_gives_its_irradiance_times_the_cosine() {
    let direction = Vec3::new(1.0, -2.0, 0.5).normalize();
    let scene = with_light(
        floor().finish(),
        LightKind::Directional {
            direction,
            irradiance: Rgb::splat(1000.0),
        },
    );
    assert_close(
        in_the_middle(scene),
        Rgb::splat(1000.0 * -direction.y),
        1e-5,
    );
}

#[test]
fn a_point_light_gives_intensity_over_distance_squared() {
    let position = Vec3::new(0.01, 2.0, 0.012);
    let scene = with_light(
        floor().finish(),
        LightKind::Point {
            position,
            intensity: Rgb::new(40.0, 80.0, 120.0),
        },
    );
    // The element averages over 6 cm, where 1/d² and the cosine change by about 1e-3.
    assert_close(in_the_middle(scene), Rgb::new(10.0, 20.0, 30.0), 2e-3);
}

#[test]
fn a_spot_light_ends_at_its_outer_angle() {
    let spot = |x: f32| LightKind::Spot {
        position: Vec3::new(x, 2.0, 0.0),
        direction: Vec3::NEG_Y,
        intensity: Rgb::splat(100.0),
        inner_angle: 0.2,
        outer_angle: 0.4,
    };
    assert_close(
        in_the_middle(with_light(floor().finish(), spot(0.0))),
        Rgb::splat(25.0),
        2e-3,
    );
    let (gathered, element) = in_the_middle(with_light(floor().finish(), spot(1.5)));
    assert!(
        gathered.is_black() && element.is_black(),
        "outside the cone it is dark: {gathered:?}, {element:?}"
    );
}

#[test]
fn a_roof_hides_the_sun() {
    let mut builder = floor();
    let grey = builder.diffuse("roof", 0.0, 0.0, 0.0);
    builder.node("roof");
    builder.cuboid(
        grey,
        Vec3::new(-1.0, 0.5, -1.0),
        Vec3::new(1.0, 0.6, 1.0),
        Sides::ALL,
    );
    let direction = Vec3::new(0.1, -1.0, 0.1).normalize();
    let scene = with_light(
        builder.finish(),
        LightKind::Directional {
            direction,
            irradiance: Rgb::WHITE,
        },
    );
    let (gathered, element) = in_the_middle(scene);
    assert!(
        gathered.is_black() && element.is_black(),
        "shadow: {gathered:?}, {element:?}"
    );
}

#[test]
fn glass_tints_and_blend_dims_what_passes() {
    let sun = LightKind::Directional {
        direction: Vec3::NEG_Y,
        irradiance: Rgb::splat(100.0),
    };
    let mut builder = floor();
    // Nothing but transmission, so that nothing comes back from the pane.
    let glass = Material {
        transmission: 1.0,
        ..Material::diffuse("glass", Rgb::new(0.9, 0.5, 0.2))
    };
    pane(&mut builder, glass);
    assert_close(
        in_the_middle(with_light(builder.finish(), sun)),
        Rgb::new(90.0, 50.0, 20.0),
        1e-4,
    );

    let mut builder = floor();
    let veil = Material {
        alpha: 0.25,
        alpha_mode: AlphaMode::Blend,
        ..Material::diffuse("veil", Rgb::BLACK)
    };
    pane(&mut builder, veil);
    assert_close(
        in_the_middle(with_light(builder.finish(), sun)),
        Rgb::splat(75.0),
        1e-4,
    );
}

#[test]
fn a_mask_lets_light_through_its_holes() {
    let mut builder = floor();
    // Every other texel is a hole; nearest rows of texels run across the pane.
    let texel = |i: usize| {
        if i.is_multiple_of(2) {
            [255, 255, 255, 0]
        } else {
            [255, 255, 255, 255]
        }
    };
    let stripes = Image::from_pixels(1, 256, (0..256).map(texel).collect()).expect("256 texels");
    let texture = builder.texture("stripes", Wrap::Repeat, stripes);
    let material = builder.textured("mask", texture, Vec2::ONE);
    builder.node("pane");
    let corners = [(-6.0, 6.0), (6.0, 6.0), (6.0, -6.0), (-6.0, -6.0)];
    builder.picture(material, corners.map(|(x, z)| Vec3::new(x, 1.0, z)));
    let mut scene = builder.finish();
    for material in &mut scene.materials {
        if material.name == "mask" {
            material.alpha_mode = AlphaMode::Mask { cutoff: 0.5 };
            material.base_color = Rgb::BLACK;
        }
    }
    scene.sky = Rgb::splat(100.0);
    // Alpha is interpolated between texels, so a stripe is a hole as wide as a texel: half of the sky shows through,
    // and 2.7 % of it around the pane. 256 rays an element see that to 4 %.
    assert_close(in_the_middle(scene), Rgb::splat(51.4 * PI), 0.06);
}
