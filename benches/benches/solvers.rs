//! Solvers on a matrix: what a sweep costs, and from which size elimination by blocks is worth it.

use criterion::{BatchSize, BenchmarkId, Criterion, criterion_group, criterion_main};
use hemicube::radiosity::form_factor::ViewFactorMatrix;
use hemicube::radiosity::solve::system::{Channel, MatrixMethod, System};
use hemicube::radiosity::solve::{Gauss, MatrixSolverKind};
use std::hint::black_box;
use std::time::Duration;

/// Factors of a closed enclosure of n patches: positive, no two alike, rows that close.
fn enclosure(n: usize) -> ViewFactorMatrix {
    let weight = |k: usize| 1.0 + (k * 7919 % 1009) as f64 / 1009.0;
    let mut factors = vec![0.0; n * n];
    for (i, row) in factors.chunks_mut(n).enumerate() {
        for (j, f) in row.iter_mut().enumerate() {
            *f = if i == j { 0.0 } else { weight(i + j) };
        }
        let sum: f64 = row.iter().sum();
        row.iter_mut().for_each(|f| *f /= sum);
    }
    let names = (0..n).map(|i| i.to_string()).collect();
    ViewFactorMatrix::from_rows(vec![1.0; n], names, &factors).expect("factors")
}

/// Red, green and blue of one light.
fn channels(n: usize) -> Vec<Channel> {
    let channel = |k: usize| Channel {
        matrix: 0,
        reflectance: (0..n).map(|i| 0.3 + 0.2 * ((i + k) % 4) as f64).collect(),
        emission: (0..n).map(|i| f64::from(u8::from(i % 50 == 0))).collect(),
        radiosity: vec![0.5; n],
    };
    (0..3).map(channel).collect()
}

fn sweeps(c: &mut Criterion) {
    let mut group = c.benchmark_group("sweep of three channels");
    group.sample_size(10);
    let n = 3000;
    let matrix = enclosure(n);
    let entries = core::slice::from_ref(matrix.entries());
    let share =
        |channels: &mut [Channel]| System::new(entries, matrix.areas(), channels).residual_share();
    for kind in [
        MatrixSolverKind::Jacobi,
        MatrixSolverKind::GaussSeidel,
        MatrixSolverKind::ConjugateGradient,
    ] {
        let sweep = |channels: &mut [Channel]| {
            let mut system = System::new(entries, matrix.areas(), channels);
            kind.method().step(&mut system);
        };
        let mut checked = channels(n);
        let before = share(&mut checked);
        sweep(&mut checked);
        let after = share(&mut checked);
        assert!(after < before, "{}: {after} after {before}", kind.name());
        for (how, size) in [("together", 3), ("one by one", 1)] {
            group.bench_function(format!("{}, {how}", kind.name()), |b| {
                let work = |mut channels: Vec<Channel>| {
                    channels.chunks_mut(size).for_each(sweep);
                    channels
                };
                b.iter_batched(|| channels(n), work, BatchSize::LargeInput);
            });
        }
    }
    group.finish();
}

fn elimination(c: &mut Criterion) {
    let mut group = c.benchmark_group("gauss");
    group
        .sample_size(10)
        .measurement_time(Duration::from_secs(2));
    for n in [32, 100, 500, 1000, 2000] {
        let matrix = enclosure(n);
        let entries = core::slice::from_ref(matrix.entries());
        let solve = |readable_up_to: usize| {
            let mut channels = channels(n);
            let mut system = System::new(entries, matrix.areas(), &mut channels);
            let mut gauss = Gauss::readable_up_to(readable_up_to);
            while !gauss.step(&mut system) {}
            let left = system.residual_share();
            assert!(left < 1e-10, "{n} patches: {left:e} is left");
            channels
        };
        for (how, readable_up_to) in [("column by column", n), ("by blocks", 0)] {
            group.bench_with_input(BenchmarkId::new(how, n), &readable_up_to, |b, &most| {
                b.iter(|| black_box(solve(most)));
            });
        }
    }
    group.finish();
}

criterion_group!(benches, sweeps, elimination);
criterion_main!(benches);
