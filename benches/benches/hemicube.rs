//! Hemicubes a second of one thread, and where the time goes.
//!
//! The stages are timed by [`Hemicube::stage_times`] in wall-clock time; the figures are lower deciles over many
//! hemicubes, which load by others disturbs least.

use hemicube::radiosity::form_factor::hemicube::{Hemicube, HemicubeOptions, StageTimes};
use hemicube::radiosity::{FormFactors, PatchMesh, PatchOptions, Row};
use hemicube::scene::builtin;
use std::sync::Arc;

const HEMICUBES: usize = 200;

fn main() {
    println!("ms a hemicube (of one thread): transform, raster, sum; hemicubes per second");
    for scene in ["cornell", "office"] {
        let scene_mesh = mesh(scene);
        for resolution in [128, 256, 512, 1024] {
            let factors = hemicubes(&scene_mesh, resolution);
            check(&factors);
            let [transform, raster, sum] = times(&factors);
            println!(
                "{scene}, {} elements, {resolution}: {transform:6.3} {raster:6.3} {sum:6.3}; {:.0}",
                scene_mesh.elements().len(),
                1e3 / (transform + raster + sum)
            );
        }
    }
}

fn mesh(scene: &str) -> Arc<PatchMesh> {
    let scene = Arc::new(builtin::scene(scene).expect("it is built in"));
    let options = PatchOptions::default()
        .with_elements(10_000)
        .with_patches(1000);
    Arc::new(PatchMesh::build(scene, options).expect("it can be cut"))
}

fn hemicubes(mesh: &Arc<PatchMesh>, resolution: u32) -> Hemicube {
    let options = HemicubeOptions::default()
        .with_resolution(resolution)
        .with_max_points(1);
    Hemicube::new(mesh.clone(), options).expect("the options are good")
}

fn check(factors: &Hemicube) {
    let mesh = factors.mesh();
    let mut row = Row::default();
    for patch in mesh.patches().iter().step_by(mesh.patches().len() / 8) {
        factors.fill_row(*patch, &mut row);
        let sum = row.sum(mesh, 0);
        assert!(
            (sum - 1.0).abs() < 1e-5,
            "the row of {patch:?} sums to {sum}"
        );
    }
}

/// Milliseconds of the three stages.
fn times(factors: &Hemicube) -> [f64; 3] {
    let patches = factors.mesh().patches();
    let times: Vec<StageTimes> = (0..HEMICUBES)
        .map(|i| factors.stage_times(patches[i * 7919 % patches.len()]))
        .collect();
    let stages: [fn(&StageTimes) -> f64; 3] = [
        |t| t.transform.as_secs_f64() / t.hemicubes as f64,
        |t| t.raster.as_secs_f64() / t.hemicubes as f64,
        |t| t.sum.as_secs_f64() / t.hemicubes as f64,
    ];
    stages.map(|stage| {
        let mut seconds: Vec<f64> = times.iter().map(stage).collect();
        seconds.sort_by(f64::total_cmp);
        seconds[HEMICUBES / 10] * 1e3
    })
}
