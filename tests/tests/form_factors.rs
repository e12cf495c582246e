//! Rows of form factors against exact values, by every method that fills rows.

use hemicube::radiosity::form_factor::hemicube::{Hemicube, HemicubeOptions};
use hemicube::radiosity::form_factor::raycast::Strategy;
use hemicube::radiosity::form_factor::{Analytic, AnalyticOptions};
use hemicube::radiosity::{
    FormFactors, NodeId, PatchMesh, PatchOptions, RayCast, RayCastOptions, Row,
};
use hemicube::scene::{Scene, builtin};
use hemicube_tests::gpu;
use std::sync::Arc;

/// Every way to a row, with the standard error or bias that it may have on a factor near 0.2.
fn methods(mesh: &Arc<PatchMesh>) -> Vec<(&'static str, f64, Box<dyn FormFactors>)> {
    let raycast = |strategy, rays| {
        let options = RayCastOptions {
            rays,
            strategy,
            seed: 0,
            shot_rays: None,
        };
        Box::new(RayCast::new(mesh.clone(), options)) as Box<dyn FormFactors>
    };
    let options = HemicubeOptions::default().with_resolution(256);
    let hemicube = Hemicube::new(mesh.clone(), options).expect("an even resolution");
    let analytic =
        Analytic::new(mesh.clone(), AnalyticOptions::default()).expect("an error in range");
    let error_of_rays = |rays: u32| 4.0 * (0.2_f64 * 0.8 / f64::from(rays)).sqrt();
    // A device that draws in software takes its time.
    let rays = RayCastOptions {
        rays: 4096,
        strategy: Strategy::Shots,
        seed: 0,
        shot_rays: None,
    };
    let cells_error = 8.0 / 256.0;
    let mut all = vec![
        // Nothing hides anything, so pairs are as exact as their quadrature.
        ("pairs", 2e-5, raycast(Strategy::Pairs, 256)),
        ("analytic", 1e-6, Box::new(analytic)),
        // Cells at an outline are all right or all wrong: at most 8 outlines' worth of cells of 1/256.
        (
            "hemicube",
            cells_error,
            Box::new(hemicube) as Box<dyn FormFactors>,
        ),
        // 65,536 directions of a low-discrepancy sequence: the bound is four standard errors of random ones.
        (
            "shots",
            error_of_rays(65_536),
            raycast(Strategy::Shots, 65_536),
        ),
    ];
    // Twins of the last two.
    let twins = gpu::ways(mesh, options, rays).into_iter();
    all.extend(
        twins
            .zip([cells_error, error_of_rays(4096)])
            .map(|((name, factors), error)| (name, error, factors)),
    );
    all
}

fn mesh_of(scene: Scene, options: PatchOptions) -> Arc<PatchMesh> {
    Arc::new(PatchMesh::build(Arc::new(scene), options).expect("the scene can be cut"))
}

fn one_element_a_face() -> PatchOptions {
    PatchOptions::default().with_element_size(100.0)
}

fn row(factors: &dyn FormFactors, source: NodeId) -> Row {
    let mut row = Row::default();
    factors.fill_row(source, &mut row);
    row
}

#[test]
fn unit_squares_have_their_known_factors() {
    for (scene, exact) in [
        ("parallel-plates", 0.199_824_895_698),
        ("perpendicular-plates", 0.200_043_776_075),
    ] {
        let mesh = mesh_of(
            builtin::scene(scene).expect("it is built in"),
            one_element_a_face(),
        );
        for (name, bound, factors) in methods(&mesh) {
            let row = row(&*factors, mesh.patches()[0]);
            assert_eq!(
                row.receivers,
                [1],
                "{scene}, {name}: only the other square receives"
            );
            let found = f64::from(row.fractions[0]);
            assert!(
                (found - exact).abs() < bound,
                "{scene}, {name}: {found} is not {exact}"
            );
        }
    }
}

#[test]
fn what_leaves_is_accounted_for() {
    for scene in ["cornell", "two-rooms", "office"] {
        let options = PatchOptions::default().with_elements(300);
        let mesh = mesh_of(builtin::scene(scene).expect("it is built in"), options);
        for (name, _, factors) in methods(&mesh) {
            if name.starts_with("gpu") {
                // They are asked with fewer rays and cells in row_methods.rs.
                continue;
            }
            for patch in mesh.patches().iter().step_by(mesh.patches().len() / 20) {
                let row = row(&*factors, *patch);
                for band in 0..3 {
                    let sum = row.sum(&mesh, band);
                    assert!(
                        (sum - 1.0).abs() < 1e-5,
                        "{scene}, {name}, {patch:?}, band {band}: {sum}"
                    );
                }
                assert!(
                    row.fractions.iter().all(|&f| (0.0..=1.0).contains(&f)),
                    "{scene}, {name}: in [0, 1]"
                );
                assert!(
                    row.receivers.is_sorted(),
                    "{scene}, {name}: receivers ascend"
                );
            }
        }
    }
}

#[test]
fn factors_to_parts_add_up_to_the_factor_to_the_whole() {
    let scene = || builtin::scene("perpendicular-plates").expect("it is built in");
    let whole = mesh_of(scene(), one_element_a_face());
    let parts = mesh_of(
        scene(),
        PatchOptions::default()
            .with_element_size(0.13)
            .with_patch_size(2.0),
    );
    assert!(
        parts.elements().len() >= 128,
        "{} elements",
        parts.elements().len()
    );
    for ((name, bound, coarse), (_, _, fine)) in methods(&whole).into_iter().zip(methods(&parts)) {
        let one = f64::from(row(&*coarse, whole.patches()[0]).fractions[0]);
        let sum: f64 = row(&*fine, parts.patches()[0])
            .fractions
            .iter()
            .map(|&f| f64::from(f))
            .sum();
        assert!(
            (one - sum).abs() < 2.0 * bound,
            "{name}: {one} as a whole, {sum} in parts"
        );
    }
}

#[test]
fn an_occluder_casts_its_share_of_shadow() {
    // A square half way between two unit squares, as large as they are: what gets past it goes over its edges.
    let mut scene = builtin::scene("parallel-plates").expect("it is built in");
    let mut blocker = scene.meshes[1].clone();
    blocker.positions.iter_mut().for_each(|p| p.y = 0.5);
    scene.meshes.push(blocker);
    let mut instance = scene.instances[1].clone();
    instance.mesh = scene.meshes.len() - 1;
    instance.node = "blocker".into();
    scene.instances.push(instance);
    let mesh = mesh_of(
        scene,
        PatchOptions::default()
            .with_element_size(0.13)
            .with_patch_size(0.13),
    );
    let pairs = RayCast::new(
        mesh.clone(),
        RayCastOptions {
            rays: 4096,
            strategy: Strategy::Pairs,
            seed: 0,
            shot_rays: None,
        },
    );
    let shots = RayCast::new(
        mesh.clone(),
        RayCastOptions {
            rays: 65_536,
            strategy: Strategy::Shots,
            seed: 1,
            shot_rays: None,
        },
    );
    let far = |e: u32| mesh.node(mesh.elements()[e as usize]).centroid.y > 0.9;
    let total = |factors: &dyn FormFactors| -> f64 {
        let sources = mesh
            .patches()
            .iter()
            .filter(|&&p| mesh.node(p).centroid.y < 0.1);
        let of_row = |p: &NodeId| -> f64 {
            let row = row(factors, *p);
            row.receivers
                .iter()
                .zip(&row.fractions)
                .filter(|(e, _)| far(**e))
                .map(|(_, &f)| f64::from(f))
                .sum()
        };
        sources
            .map(|p| of_row(p) * f64::from(mesh.node(*p).area))
            .sum()
    };
    let (by_pairs, by_shots) = (total(&pairs), total(&shots));
    assert!(
        (by_pairs - by_shots).abs() < 2e-4,
        "pairs {by_pairs}, shots {by_shots}"
    );
    assert!(
        by_shots < 1e-3,
        "a blocker as large as both squares hides nearly all: {by_shots}"
    );
}
