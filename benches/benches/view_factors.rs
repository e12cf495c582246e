//! View-factor matrices: time and error of the enclosures that other programs were measured on.
//!
//! No criterion here: a matrix takes seconds, and its error matters as much. CPU seconds are those of the process.

use hemicube::radiosity::form_factor::matrix::DenseRows;
use hemicube::radiosity::form_factor::{Analytic, AnalyticOptions};
use hemicube::radiosity::stop::NEVER;
use hemicube::radiosity::{FormFactors, PatchMesh, PatchOptions};
use hemicube::scene::Scene;
use hemicube_tests::enclosures::{cube, room_with_cube};
use std::sync::Arc;
use std::time::Instant;

/// What another program took, measured on a machine of the same kind.
struct Peer {
    name: &'static str,
    cpu_seconds: f64,
    error: &'static str,
}

const fn peer(name: &'static str, cpu_seconds: f64, error: &'static str) -> Peer {
    Peer {
        name,
        cpu_seconds,
        error,
    }
}

fn main() {
    println!("threads {}", rayon::current_num_threads());
    println!(
        "enclosure                    patches  CPU s  ns a pair  RMS error  largest  rows sum to 1 within"
    );
    // The exact matrix of 9600 patches would take as much memory again.
    let view3d = [peer(
        "View3D 4.0.0, eps 1e-4",
        0.02,
        "RMS 2.8e-6, largest 6.9e-5",
    )];
    row("cube", cube(10), Some(1e-9), &view3d);
    let peers = [
        peer("View3D 4.0.0, eps 1e-4", 0.46, "RMS 9.5e-7, largest 6.8e-5"),
        peer("pyviewfactor 1.1.0", 38.3, "RMS 1.0e-9, largest 9.2e-8"),
    ];
    row("cube", cube(20), Some(1e-9), &peers);
    let view3d = [peer(
        "View3D 4.0.0, eps 1e-4",
        13.4,
        "RMS 3.4e-7, largest 6.8e-5",
    )];
    row("cube", cube(40), None, &view3d);
    let view3d = [peer("View3D 4.0.0, eps 1e-4", 2.1, "RMS below 1.6e-5")];
    row(
        "room with a floating cube",
        room_with_cube(12, 5),
        Some(3e-7),
        &view3d,
    );
    let peers = [
        peer("View3D 4.0.0, eps 1e-4", 26.4, "RMS about 2e-6"),
        peer("pyviewfactor 1.1.0", 91.6, "RMS 1e-5, largest 6e-4"),
    ];
    row(
        "room with a floating cube",
        room_with_cube(25, 8),
        Some(3e-7),
        &peers,
    );
}

/// Computes a matrix with default options and compares it with one of a far smaller error.
fn row(name: &str, scene: Scene, exact: Option<f64>, peers: &[Peer]) {
    let mesh = Arc::new(
        PatchMesh::build(Arc::new(scene), PatchOptions::whole_faces()).expect("it can be cut"),
    );
    let n = mesh.patches().len();
    let matrix = |options: AnalyticOptions| -> DenseRows {
        let factors = Analytic::new(mesh.clone(), options).expect("an error in range");
        factors.dense_rows(NEVER).expect("patches are elements")
    };
    let (start, cpu) = (Instant::now(), cpu_time::ProcessTime::now());
    let found = matrix(AnalyticOptions::default());
    let (wall, cpu) = (start.elapsed().as_secs_f64(), cpu.elapsed().as_secs_f64());
    let sums = found
        .values
        .chunks(n)
        .map(|row| row.iter().map(|&f| f64::from(f)).sum::<f64>());
    let closure = sums.map(|sum| (sum - 1.0).abs()).fold(0.0, f64::max);
    assert!(
        closure < 1e-3,
        "{name}: rows sum to 1 within {closure:.1e} only"
    );
    let errors = exact.map_or_else(String::new, |error| {
        let exact = matrix(AnalyticOptions::default().with_error(error));
        let (mut squares, mut largest) = (0.0, 0.0_f64);
        for (a, b) in found.values.iter().zip(&exact.values) {
            let difference = f64::from((a - b).abs());
            squares += difference * difference;
            largest = largest.max(difference);
        }
        format!("{:.1e}   {largest:.1e}", (squares / (n * n) as f64).sqrt())
    });
    let pairs = (n * (n - 1) / 2) as f64;
    println!(
        "{name:28} {n:7} {cpu:6.2} {:10.0}  {errors:20} {closure:.1e}  ({wall:.2} s of wall clock)",
        1e9 * cpu / pairs
    );
    for Peer {
        name,
        cpu_seconds,
        error,
    } in peers
    {
        let times = cpu_seconds / cpu;
        println!(
            "    {name:32} {cpu_seconds:6.2} {:10.0}  {error}: {times:.1} times as long",
            1e9 * cpu_seconds / pairs
        );
    }
}
