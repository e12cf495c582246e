//! Steps a solver by hand and watches the unshot energy: `cargo run --release --example step`.

use hemicube::radiosity::form_factor::Cached;
use hemicube::radiosity::solve::ambient_irradiance;
use hemicube::radiosity::{
    Grouping, Order, PatchMesh, PatchOptions, RadiosityError, RayCast, RayCastOptions,
};
use hemicube::radiosity::{Shooting, Solution, Solver, primary::primary_irradiance};
use hemicube::scene;
use std::sync::Arc;

/// The unshot share of the emitted flux after each of `steps` shots.
pub fn unshot_history(name: &str, order: Order, steps: usize) -> Result<Vec<f64>, RadiosityError> {
    let scene = Arc::new(scene::open(name)?);
    let mesh = Arc::new(PatchMesh::build(
        scene,
        PatchOptions::default()
            .with_elements(2000)
            .with_patches(300),
    )?);
    // Rows are kept, so a patch that shoots again costs no rays.
    let factors = Cached::new(
        RayCast::new(mesh.clone(), RayCastOptions::default()),
        64 << 20,
    );
    let primary = primary_irradiance(&mesh, 256, 0);
    let mut solver = Shooting::new(
        &factors,
        Solution::new(mesh, &primary, Grouping::Together),
        order,
    );
    let history = (0..steps).map(|_| solver.step().unshot).collect();
    println!(
        "ambient estimate of what is missing: {:.4?}",
        ambient_irradiance(solver.solution()).to_array()
    );
    Ok(history)
}

fn main() -> Result<(), RadiosityError> {
    for order in [Order::Cyclic, Order::Sorted] {
        println!("{order:?}:");
        for (step, unshot) in unshot_history("cornell", order, 100)?
            .iter()
            .enumerate()
            .step_by(10)
        {
            println!("  step {:3}: {:5.1} % unshot", step + 1, 100.0 * unshot);
        }
    }
    Ok(())
}
