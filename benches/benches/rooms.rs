//! Whole solutions of the reference rooms, measured at their points: time and error side by side.

use criterion::{Criterion, criterion_group, criterion_main};
use hemicube::radiosity::{PatchOptions, Quality, SolveOptions, SolverKind, solve};
use hemicube::scene::builtin;
use hemicube_benches::measured_error;
use hemicube_tests::reference_points;
use std::hint::black_box;
use std::sync::Arc;
use std::time::Duration;

fn finer() -> SolveOptions {
    SolveOptions {
        mesh: PatchOptions::default()
            .with_elements(8000)
            .with_patches(1200),
        tolerance: 2e-4,
        ..SolveOptions::default()
    }
}

/// The same elements, each as good as the other's: all form factors between patches, and links.
fn by(solver: SolverKind) -> SolveOptions {
    SolveOptions {
        mesh: PatchOptions::default()
            .with_elements(4000)
            .with_patches(1000),
        noise: 0.015,
        solver,
        ..SolveOptions::default()
    }
}

fn rooms(c: &mut Criterion) {
    let mut group = c.benchmark_group("solve and measure");
    group
        .sample_size(10)
        .measurement_time(Duration::from_secs(10));
    let settings = [
        ("draft", Quality::Draft.into()),
        ("normal", SolveOptions::default()),
        ("finer", finer()),
        ("full matrix", by(SolverKind::GaussSeidel)),
        ("links", by(SolverKind::Hierarchical)),
    ];
    for (scene, bound) in [("cornell", 0.02), ("two-rooms", 0.03)] {
        let points = reference_points(scene);
        let room = Arc::new(builtin::scene(scene).expect("it is built in"));
        for (name, options) in &settings {
            let work = || {
                let solution = solve(room.clone(), options, |_, _| true).expect("it can be solved");
                (measured_error(&solution, &points, 2048), solution)
            };
            // A fast wrong answer counts for nothing: the error is stated, and bounded from the default on.
            let (error, solution) = work();
            let rays = solution.provenance.rays;
            println!(
                "{scene}, {name}: RMS error {:.2} %, {rays} rays",
                100.0 * error
            );
            assert!(
                *name == "draft" || error < bound,
                "{scene}, {name}: RMS error {error:.4}"
            );
            group.bench_function(format!("{scene}, {name}"), |b| b.iter(|| black_box(work())));
        }
    }
    group.finish();
}

criterion_group!(benches, rooms);
criterion_main!(benches);
