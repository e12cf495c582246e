//! Form factors: unoccluded pairs, rows by pairs and by shots, visibility rays.

use criterion::{BatchSize, Criterion, Throughput, criterion_group, criterion_main};
use glam::Vec3;
use hemicube::radiosity::form_factor::analytic::unoccluded::Rules;
use hemicube::radiosity::form_factor::polygon::FlatPolygon;
use hemicube::radiosity::form_factor::raycast::Strategy;
use hemicube::radiosity::form_factor::{FormFactorKind, FormFactorOptions};
use hemicube::radiosity::{FormFactors, PatchMesh, PatchOptions, RayCastOptions, Row};
use hemicube::scene::builtin;
use std::hint::black_box;
use std::sync::Arc;

fn mesh(scene: &str, elements: usize) -> Arc<PatchMesh> {
    let scene = Arc::new(builtin::scene(scene).expect("it is built in"));
    let options = PatchOptions::default()
        .with_elements(elements)
        .with_patches(elements / 10);
    Arc::new(PatchMesh::build(scene, options).expect("it can be cut"))
}

fn pairs(c: &mut Criterion) {
    let mut group = c.benchmark_group("exchange area of unit squares");
    let square = |origin: Vec3, u: Vec3, v: Vec3| {
        FlatPolygon::new(
            &[origin, origin + u, origin + u + v, origin + v],
            u.cross(v),
        )
    };
    let rules = Rules::default();
    let below = square(Vec3::ZERO, Vec3::X, Vec3::Y);
    for distance in [1.0, 3.0, 10.0, 100.0] {
        let above = square(Vec3::Z * distance, Vec3::Y, Vec3::X);
        group.bench_function(format!("{distance} m apart"), |b| {
            b.iter(|| rules.exchange_of_polygons(black_box(&below), black_box(&above)));
        });
    }
    group.finish();
}

/// Every way to a row, with its default settings; rays both ways, with those of a normal solution.
fn ways(mesh: &Arc<PatchMesh>) -> Vec<(&'static str, Box<dyn FormFactors>)> {
    let rays = |strategy| RayCastOptions {
        rays: 256,
        strategy,
        seed: 0,
        shot_rays: None,
    };
    let built = |kind: FormFactorKind, raycast| {
        let options = FormFactorOptions {
            raycast,
            ..FormFactorOptions::default()
        };
        let factors = kind.build(mesh.clone(), &options);
        factors.expect("the options are good")
    };
    let mut ways = vec![
        (
            "pairs",
            built(FormFactorKind::RayCast, rays(Strategy::Pairs)),
        ),
        (
            "shots",
            built(FormFactorKind::RayCast, rays(Strategy::Shots)),
        ),
    ];
    let others = FormFactorKind::ALL
        .into_iter()
        .filter(|&kind| kind != FormFactorKind::RayCast);
    ways.extend(others.map(|kind| (kind.name(), built(kind, RayCastOptions::default()))));
    ways
}

fn rows(c: &mut Criterion) {
    let mut group = c.benchmark_group("rows of cornell");
    for elements in [1000, 10_000] {
        let mesh = mesh("cornell", elements);
        for (name, factors) in ways(&mesh) {
            let patches = mesh.patches();
            let mut next = 0;
            let mut row = Row::default();
            factors.fill_row(patches[patches.len() / 2], &mut row);
            let sum = row.sum(&mesh, 0);
            assert!((sum - 1.0).abs() < 1e-5, "{name}: the row sums to {sum}");
            group.throughput(Throughput::Elements(mesh.elements().len() as u64));
            group.bench_function(format!("{name}, {} elements", mesh.elements().len()), |b| {
                b.iter_batched(
                    || {
                        next = (next + 7) % patches.len();
                        patches[next]
                    },
                    |patch| factors.fill_row(patch, &mut row),
                    BatchSize::SmallInput,
                );
            });
        }
    }
    group.finish();
}

fn rays(c: &mut Criterion) {
    let mut group = c.benchmark_group("visibility in the office");
    let mesh = mesh("office", 4000);
    let centres: Vec<Vec3> = mesh
        .elements()
        .iter()
        .map(|&id| {
            let node = mesh.node(id);
            node.centroid + node.normal * 1e-3
        })
        .collect();
    // Pairs far from each other in the list: incoherent segments, one thread.
    let pairs: Vec<(Vec3, Vec3)> = (0..10_000)
        .map(|i| {
            (
                centres[i * 7919 % centres.len()],
                centres[i * 104_729 % centres.len()],
            )
        })
        .collect();
    group.throughput(Throughput::Elements(pairs.len() as u64));
    group.bench_function("segments, any hit", |b| {
        b.iter(|| {
            pairs
                .iter()
                .filter(|(from, to)| !mesh.visibility().transmittance(*from, *to).is_black())
                .count()
        });
    });
    group.finish();
}

criterion_group!(benches, pairs, rows, rays);
criterion_main!(benches);
