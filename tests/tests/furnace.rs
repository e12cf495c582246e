//! Closed boxes of uniform emission and reflectance: `B = E / (1 - ρ)` everywhere (the "furnace").

use hemicube::radiosity::{PatchOptions, SolveOptions, SolverKind, solve};
use hemicube::scene::builtin::furnace_with;
use std::sync::Arc;

/// Largest relative error of an element's radiosity against the exact value.
fn furnace_error(reflectance: f32, solver: SolverKind) -> f64 {
    let exitance = 1.0;
    let options = SolveOptions {
        mesh: PatchOptions::default().with_elements(400).with_patches(100),
        tolerance: 1e-7,
        solver,
        ..SolveOptions::default()
    };
    let scene = Arc::new(furnace_with(reflectance, exitance));
    let solution = solve(scene, &options, |_, _| true).expect("the furnace can be solved");
    let exact = f64::from(exitance) / (1.0 - f64::from(reflectance));
    let errors = (0..solution.mesh().elements().len())
        .map(|e| (f64::from(solution.element_radiosity(e).g) / exact - 1.0).abs());
    errors.fold(0.0, f64::max)
}

#[test]
fn radiosity_is_emission_over_one_minus_reflectance() {
    for reflectance in [0.0, 0.2, 0.5, 0.8, 0.9, 0.95] {
        let error = furnace_error(reflectance, SolverKind::SortedShooting);
        assert!(
            error < 1e-4,
            "reflectance {reflectance}: an element is off by {error:.2e}"
        );
    }
}

#[test]
fn the_order_of_shooting_does_not_matter() {
    let error = furnace_error(0.5, SolverKind::Shooting);
    assert!(error < 1e-4, "an element is off by {error:.2e}");
}

#[test]
fn nothing_absorbs_and_nothing_escapes_is_refused() {
    let mut scene = furnace_with(1.0, 1.0);
    scene.max_reflectance = 1.0;
    let error = solve(Arc::new(scene), &SolveOptions::default(), |_, _| true)
        .expect_err("it never settles");
    assert!(
        error.to_string().contains("never settles"),
        "the message says why: {error}"
    );
}
