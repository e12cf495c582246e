//! Solutions to begin with, and what every solver's must keep.

use hemicube::radiosity::{
    PatchOptions, Quality, Solution, SolveOptions, Solver, SolverKind, resume, unlit,
};
use hemicube::scene::{Scene, builtin};
use std::sync::Arc;

/// A built-in scene.
///
/// # Panics
/// If there is none of this name.
pub fn built_in(name: &str) -> Arc<Scene> {
    Arc::new(builtin::scene(name).expect("it is built in"))
}

/// A scene before the first step, in about so many elements and patches.
///
/// # Panics
/// If it has no mesh.
pub fn start(scene: Arc<Scene>, elements: usize, patches: usize) -> Solution {
    let options = SolveOptions {
        mesh: PatchOptions::default()
            .with_elements(elements)
            .with_patches(patches),
        ..Quality::Draft.into()
    };
    unlit(scene, &options, &|| false).expect("a mesh")
}

/// Steps until a solver is exhausted.
pub fn exhausted<S: Solver>(mut solver: S) -> S {
    while !solver.is_exhausted() {
        solver.step();
    }
    solver
}

/// What sorted shooting leaves after 40 shots, and what it comes to.
///
/// # Panics
/// If it cannot go on.
pub fn begun_and_done(start: Solution) -> [Solution; 2] {
    let begun = SolveOptions {
        rays: 512,
        max_steps: Some(40),
        solver: SolverKind::SortedShooting,
        ..Quality::Draft.into()
    };
    let done = SolveOptions {
        max_steps: None,
        tolerance: 1e-5,
        ..begun
    };
    [begun, done].map(|options| resume(start.clone(), &options, |_, _| true).expect("it goes on"))
}

/// Largest share of the energy of a band that is not accounted for.
pub fn balance_error(solution: &Solution) -> f64 {
    let bands = (0..3).map(|band| {
        let unshot = solution.unshot_flux(band);
        solution.total_balance(band).relative_error(unshot)
    });
    bands.fold(0.0, f64::max)
}

/// The bits of the first group's irradiance.
pub fn irradiance_bits(solution: &Solution) -> Vec<u32> {
    let values = (0..3).flat_map(|band| solution.irradiance(0, band));
    values.map(|h| h.to_bits()).collect()
}
