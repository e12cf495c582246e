//! Places where rounding and sampling go wrong first: near the origin, far from it, grazing, next to lamps.

use core::f32::consts::PI;
use glam::{Affine3A, Vec3};
use hemicube::radiosity::form_factor::raycast::Strategy;
use hemicube::radiosity::primary::primary_irradiance;
use hemicube::radiosity::{
    FormFactors, GatherOptions, Gatherer, PatchMesh, PatchOptions, Quality, RayCast,
};
use hemicube::radiosity::{RayCastOptions, Row, Solution, SolveOptions, solve};
use hemicube::raster::Rgb;
use hemicube::scene::builtin::{self, SceneBuilder};
use hemicube::scene::{AlphaMode, Light, LightKind, Material, Scene, Units};
use std::sync::Arc;

fn quad_scene(name: &str, material: Material, corners: [Vec3; 4]) -> Scene {
    let mut builder = SceneBuilder::new(name, Units::Photometric);
    let material = builder.material(material);
    builder.node(name);
    builder.quad(material, corners);
    builder.finish()
}

fn solved(scene: Scene, options: &SolveOptions) -> Solution {
    solve(Arc::new(scene), options, |_, _| true).expect("it can be solved")
}

/// A square through the origin, tilted, of this half size; and its normal.
fn tilted(half: f32) -> ([Vec3; 4], Vec3) {
    let normal = Vec3::new(0.3, 0.8, 0.52).normalize();
    let (u, v) = normal.any_orthonormal_pair();
    (
        [-u - v, u - v, u + v, v - u].map(|corner| corner * half),
        normal,
    )
}

#[test]
fn a_tilted_plane_near_the_origin_does_not_hide_itself() {
    for half in [1.0, 10.0, 1000.0] {
        let (corners, normal) = tilted(half);
        let mut scene = quad_scene("plane", Material::diffuse("grey", Rgb::splat(0.5)), corners);
        scene.sky = Rgb::splat(1.0 / PI);
        let solution = solved(scene, &Quality::Draft.into());
        let gatherer = Gatherer::new(&solution, GatherOptions { rays: 64, seed: 0 });
        for distance in [0.0, 1e-3, 0.01, 0.1, 0.5] {
            let point = corners[1] * (distance / corners[1].length())
                + corners[2] * (0.3 * distance / half);
            let open = gatherer.irradiance(point, normal).g;
            assert!(
                (open - 1.0).abs() < 1e-5,
                "half size {half}, {distance} from the origin: {open} of the sky"
            );
        }
        let dark = (0..solution.mesh().elements().len())
            .find(|&e| (solution.element_irradiance(e).g - 1.0).abs() > 1e-5);
        assert_eq!(
            dark, None,
            "half size {half}: an element does not see the whole sky"
        );
    }
}

#[test]
fn a_ray_crosses_a_pane_once_however_grazing() {
    let (corners, normal) = tilted(100.0);
    let veil = Material {
        alpha: 0.5,
        alpha_mode: AlphaMode::Blend,
        double_sided: true,
        ..Material::diffuse("veil", Rgb::BLACK)
    };
    let mesh = PatchMesh::build(
        Arc::new(quad_scene("pane", veil, corners)),
        PatchOptions::default().with_elements(1),
    );
    let mesh = mesh.expect("it can be cut");
    let along = normal.any_orthonormal_vector();
    for degrees in [60.0_f32, 10.0, 1.0, 0.5] {
        let (sine, cosine) = degrees.to_radians().sin_cos();
        for i in 0..200_u8 {
            let start = Vec3::splat(f32::from(i) * 0.013);
            let direction = along * cosine - normal * sine;
            let origin = start - normal * start.dot(normal) - direction * 5.0;
            let mut meetings = 0;
            let through = mesh
                .visibility()
                .follow(origin, direction, |_, _, _| meetings += 1);
            assert_eq!(meetings, 1, "{degrees}° from the pane, ray {i}");
            assert!(
                (through.g - 0.5).abs() < 1e-6,
                "{degrees}° from the pane, ray {i}: {} passes",
                through.g
            );
        }
    }
}

#[test]
fn a_point_light_keeps_its_flux_close_to_a_wall() {
    for distance in [0.5, 0.1, 0.03, 0.01] {
        let mut scene = builtin::furnace_with(0.0, 0.0);
        let (low, high) = scene.bounds().expect("the furnace has walls");
        let position = Vec3::new(
            low.x + distance,
            0.5 * (low.y + high.y) + 0.13,
            0.5 * (low.z + high.z) + 0.07,
        );
        let intensity = Rgb::splat(10.0);
        scene.lights.push(Light {
            name: "lamp".into(),
            kind: LightKind::Point {
                position,
                intensity,
            },
        });
        let solution = solved(scene, &Quality::Draft.into());
        let (emitted, exact) = (solution.total_balance(1).emitted, 40.0 * f64::from(PI));
        assert!(
            (emitted / exact - 1.0).abs() < 1e-3,
            "{distance} m from the wall: {emitted} of {exact} lm arrive"
        );
    }
}

/// Irradiance at the points of the Cornell box, the whole scene moved and scaled.
fn moved_cornell(scale: f32, shift: f32) -> Vec<Rgb> {
    let mut scene = builtin::scene("cornell").expect("it is built in");
    let moved = Affine3A::from_scale_rotation_translation(
        Vec3::splat(scale),
        glam::Quat::IDENTITY,
        Vec3::splat(shift),
    );
    scene
        .instances
        .iter_mut()
        .for_each(|instance| instance.world_from_mesh = moved * instance.world_from_mesh);
    let mesh = PatchOptions::default()
        .with_element_size(60.0 * scale)
        .with_patch_size(180.0 * scale);
    let solution = solved(
        scene,
        &SolveOptions {
            mesh,
            tolerance: 1e-4,
            ..Quality::Draft.into()
        },
    );
    let gatherer = Gatherer::new(
        &solution,
        GatherOptions {
            rays: 4096,
            seed: 0,
        },
    );
    let points = hemicube_tests::reference_points("cornell");
    points
        .iter()
        .map(|p| gatherer.irradiance(moved.transform_point3(p.point), p.normal))
        .collect()
}

#[test]
fn size_and_place_do_not_matter() {
    let rms = |a: &[Rgb], b: &[Rgb]| {
        let squares: f32 = a
            .iter()
            .zip(b)
            .map(|(a, b)| ((a.g - b.g) / a.g).powi(2))
            .sum();
        (squares / a.len() as f32).sqrt()
    };
    let here = moved_cornell(1.0, 0.0);
    for (scale, shift, bound) in [(1e-4, 0.0, 0.01), (1e4, 0.0, 0.01), (1.0, 20_000.0, 0.025)] {
        let error = rms(&here, &moved_cornell(scale, shift));
        assert!(
            error < bound,
            "scaled by {scale}, moved by {shift}: differs by {error:.4}"
        );
    }
}

#[test]
fn floor_under_a_one_sided_roof_is_not_buried() {
    let mut builder = SceneBuilder::new("roof", Units::Photometric);
    let grey = builder.diffuse("grey", 0.5, 0.5, 0.5);
    let square = |height: f32, half: f32| {
        [(-half, half), (half, half), (half, -half), (-half, -half)]
            .map(|(x, z)| Vec3::new(x, height, z))
    };
    builder.node("floor");
    builder.quad(grey, square(0.0, 5.0));
    builder.node("roof");
    builder.quad(grey, square(0.5, 2.0));
    let mut scene = builder.finish();
    scene.sky = Rgb::WHITE;
    let mesh = PatchMesh::build(Arc::new(scene), PatchOptions::default().with_elements(300))
        .expect("it can be cut");
    let open = primary_irradiance(&mesh, 4096, 0);
    let lost =
        (0..mesh.elements().len()).find(|&e| mesh.exposed_area(e) == 0.0 && open[e].g > 0.03 * PI);
    assert_eq!(lost, None, "an element that sees the sky counts as buried");
}

#[test]
fn pairs_and_shots_lose_the_same() {
    let mesh = PatchMesh::build(
        Arc::new(builtin::scene("cornell").expect("it is built in")),
        PatchOptions::default().with_elements(400),
    );
    let mesh = Arc::new(mesh.expect("it can be cut"));
    let factors = |strategy, rays| {
        RayCast::new(
            mesh.clone(),
            RayCastOptions {
                rays,
                strategy,
                seed: 0,
                shot_rays: None,
            },
        )
    };
    let (pairs, shots) = (
        factors(Strategy::Pairs, 256),
        factors(Strategy::Shots, 20_000),
    );
    let (mut by_pairs, mut by_shots) = (Row::default(), Row::default());
    let mut sum = 0.0;
    for &patch in mesh.patches() {
        pairs.fill_row(patch, &mut by_pairs);
        shots.fill_row(patch, &mut by_shots);
        let lost = |row: &Row| row.escaped[0] + row.absorbed[0];
        let error = (lost(&by_pairs) - lost(&by_shots)).abs();
        // A standard error of 256 random rays is 0.03; low discrepancy keeps theirs below.
        assert!(
            error < 0.06,
            "{patch:?}: {} and {}",
            lost(&by_pairs),
            lost(&by_shots)
        );
        sum += error;
    }
    let mean = sum / mesh.patches().len() as f32;
    assert!(mean < 0.01, "mean difference {mean}");
}
