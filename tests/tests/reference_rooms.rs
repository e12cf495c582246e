//! Rooms whose irradiance two independent path tracers agree on.

use hemicube::radiosity::{
    GatherOptions, Gatherer, PatchOptions, Quality, Solution, SolveOptions, solve,
};
use hemicube::scene::builtin;
use hemicube_tests::{reference_points, rms_error};
use std::sync::Arc;

fn solved(scene: &str, options: &SolveOptions) -> Solution {
    let scene = builtin::scene(scene).expect("it is built in");
    solve(Arc::new(scene), options, |_, _| true).expect("a reference room can be solved")
}

fn room_error(scene: &str, options: &SolveOptions) -> f64 {
    let solution = solved(scene, options);
    let gatherer = Gatherer::new(&solution, GatherOptions::default());
    let points = reference_points(scene);
    let found: Vec<_> = points
        .iter()
        .map(|p| gatherer.irradiance(p.point, p.normal))
        .collect();
    rms_error(&points, &found)
}

#[test]
fn cornell_within_two_percent_by_default() {
    let error = room_error("cornell", &SolveOptions::default());
    assert!(error < 0.02, "RMS error {error:.4}");
}

#[test]
fn two_rooms_within_three_percent_by_default() {
    let error = room_error("two-rooms", &SolveOptions::default());
    assert!(
        error < 0.03,
        "RMS error {error:.4}, although room B is lit only indirectly"
    );
}

#[test]
fn a_finer_mesh_is_closer() {
    let finer = SolveOptions {
        mesh: PatchOptions::default()
            .with_elements(8000)
            .with_patches(1200),
        tolerance: 2e-4,
        ..SolveOptions::default()
    };
    for (scene, bound) in [("cornell", 0.01), ("two-rooms", 0.015)] {
        let error = room_error(scene, &finer);
        assert!(error < bound, "{scene}: RMS error {error:.4}");
    }
}

#[test]
fn light_is_accounted_for_at_every_step() {
    let scene = Arc::new(builtin::scene("cornell").expect("it is built in"));
    let mut steps = 0;
    solve(scene, &Quality::Draft.into(), |_, solution| {
        for band in 0..3 {
            let error = solution
                .total_balance(band)
                .relative_error(solution.unshot_flux(band));
            assert!(
                error < 1e-6,
                "band {band} after {steps} steps: the balance is off by {error:.1e}"
            );
        }
        steps += 1;
        true
    })
    .expect("the box can be solved");
    assert!(steps > 100, "the balance was looked at {steps} times");
}
