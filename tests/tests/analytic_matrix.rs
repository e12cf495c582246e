//! Analytic form factors between all patches of enclosures.

use hemicube::radiosity::form_factor::matrix::DenseRows;
use hemicube::radiosity::form_factor::raycast::Strategy;
use hemicube::radiosity::form_factor::{
    Analytic, AnalyticOptions, MatrixOptions, Storage, ViewFactorMatrix,
};
use hemicube::radiosity::stop::NEVER;
use hemicube::radiosity::{FormFactors, PatchMesh, PatchOptions, RayCast, RayCastOptions, Row};
use hemicube::scene::{Scene, builtin};
use hemicube_tests::enclosures::{cube, room_with_cube};
use std::sync::Arc;

fn mesh(scene: Scene, options: PatchOptions) -> Arc<PatchMesh> {
    Arc::new(PatchMesh::build(Arc::new(scene), options).expect("the scene can be cut"))
}

/// Each face of the scene is one element.
fn uncut(scene: Scene) -> Arc<PatchMesh> {
    mesh(scene, PatchOptions::default().with_element_size(100.0))
}

fn analytic(mesh: &Arc<PatchMesh>, error: f64) -> Analytic {
    let options = AnalyticOptions::default().with_error(error);
    Analytic::new(mesh.clone(), options).expect("an error in range")
}

fn matrix(factors: &Analytic) -> ViewFactorMatrix {
    let options = MatrixOptions {
        storage: Storage::Dense,
        ..MatrixOptions::default()
    };
    ViewFactorMatrix::build(factors, options)
        .expect("it fits")
        .remove(0)
}

fn dense(factors: &Analytic) -> DenseRows {
    factors.dense_rows(NEVER).expect("patches are elements")
}

/// RMS and largest difference of two matrices.
fn differences(one: &DenseRows, two: &DenseRows) -> (f64, f64) {
    let differences = one
        .values
        .iter()
        .zip(&two.values)
        .map(|(a, b)| f64::from(a - b));
    let (squares, largest) = differences.fold((0.0, 0.0), |(sum, most), d| {
        (sum + d * d, f64::max(most, d.abs()))
    });
    ((squares / one.values.len() as f64).sqrt(), largest)
}

#[test]
fn a_cube_is_closed_and_as_exact_as_wanted() {
    let mesh = uncut(cube(10));
    let exact = dense(&analytic(&mesh, 1e-9));
    for error in [1e-3, 1e-5] {
        let factors = analytic(&mesh, error);
        let (rms, largest) = differences(&dense(&factors), &exact);
        println!("error {error:.0e}: RMS {rms:.1e}, largest {largest:.1e}");
        assert!(largest < error, "wanted {error:.0e}: {largest:.1e}");
        let matrix = matrix(&factors);
        assert!(
            matrix.closure_error() < error,
            "{:.1e}",
            matrix.closure_error()
        );
        // Both sides are the same number, rounded to f32.
        assert!(
            matrix.reciprocity_error().error < 1e-7,
            "{:?}",
            matrix.reciprocity_error()
        );
        matrix.check(1e-6).expect("factors are possible");
        assert!(matrix.sky().iter().all(|&s| s == 0.0), "nothing escapes");
    }
}

#[test]
fn an_occluding_box_leaves_the_rows_closed() {
    let mesh = uncut(room_with_cube(5, 2));
    let exact = dense(&analytic(&mesh, 1e-6));
    let factors = analytic(&mesh, 1e-5);
    let (rms, largest) = differences(&dense(&factors), &exact);
    println!("RMS {rms:.1e}, largest {largest:.1e}");
    // The error of a pair is estimated; single ones are off by several times that.
    assert!(
        rms < 5e-6 && largest < 1e-4,
        "RMS {rms:.1e}, largest {largest:.1e}"
    );
    let matrix = matrix(&factors);
    // A patch has some 50 partly hidden ones, each off by about 1e-5.
    let closure = matrix.closure_error();
    assert!(closure < 1e-3, "closure {closure:.1e}");
    matrix.check(1e-6).expect("factors are possible");
}

/// The box hides something, and nothing gets more than in the empty room.
#[test]
fn obstructed_factors_are_never_above_unobstructed_ones() {
    let full = uncut(room_with_cube(6, 2));
    let mut scene = room_with_cube(6, 2);
    scene.instances.truncate(1);
    let empty = uncut(scene);
    let (full, empty) = (
        matrix(&analytic(&full, 1e-5)),
        matrix(&analytic(&empty, 1e-5)),
    );
    let mut hidden = 0;
    for i in 0..empty.size() {
        for j in 0..empty.size() {
            let (with, without) = (full.get(i, j), empty.get(i, j));
            assert!(with <= without, "{i}, {j}: {with} above {without}");
            hidden += usize::from(with == 0.0 && without > 0.0);
        }
    }
    assert!(hidden > 100, "{hidden} pairs are hidden");
}

#[test]
fn rows_and_matrix_agree() {
    let mesh = uncut(room_with_cube(5, 2));
    let factors = analytic(&mesh, 1e-6);
    let matrix = matrix(&factors);
    let mut row = Row::default();
    for (i, &patch) in mesh.patches().iter().enumerate() {
        factors.fill_row(patch, &mut row);
        let mut dense = vec![0.0; mesh.patches().len()];
        for (&e, &f) in row.receivers.iter().zip(row.band(0)) {
            dense[e as usize] = f;
        }
        for (j, &f) in dense.iter().enumerate() {
            let difference = (f - matrix.get(i, j)).abs();
            // Rows are scaled to close.
            assert!(
                difference < 1e-5 + 2e-5 * f,
                "{i}, {j}: {f} and {}",
                matrix.get(i, j)
            );
        }
    }
}

#[test]
fn threads_do_not_change_a_bit() {
    let mesh = uncut(room_with_cube(5, 2));
    let with = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        pool.expect("threads")
            .install(|| dense(&analytic(&mesh, 1e-5)))
    };
    assert_eq!(with(1), with(4), "one thread and four");
}

/// Everything in a furnished room against rays: panes, tiny faces, contacts.
#[test]
fn rows_agree_with_rays() {
    for (name, elements) in [("two-rooms", 400), ("cornell", 300), ("office", 1500)] {
        let scene = builtin::scene(name).expect("it is built in");
        // Without joints: of the small parts along them rays know too little.
        let options = PatchOptions::default().with_elements(elements);
        let mesh = mesh(scene, options.with_joints(false));
        let factors = analytic(&mesh, 1e-4);
        let options = RayCastOptions {
            rays: 65_536,
            strategy: Strategy::Shots,
            seed: 1,
            shot_rays: None,
        };
        let rays = RayCast::new(mesh.clone(), options);
        let (mut one, mut two) = (Row::default(), Row::default());
        let patches = mesh.patches();
        let (mut squares, mut count) = (0.0, 0_u32);
        // Rays know contacts with solids to a sixteenth of an element only.
        let is_exposed = |e: usize| mesh.exposed_area(e) == mesh.node(mesh.elements()[e]).area;
        let exposed = |p: &usize| mesh.elements_of_patch(*p).all(is_exposed);
        let chosen: Vec<usize> = (0..patches.len()).filter(exposed).collect();
        for &p in chosen.iter().step_by(chosen.len().div_ceil(8)) {
            let patch = patches[p];
            factors.fill_row(patch, &mut one);
            let before = rays.rays();
            rays.fill_row(patch, &mut two);
            // Small patches get few.
            let cast = (rays.rays() - before) as f64;
            let sum = one.sum(&mesh, 0);
            assert!(
                (sum - 1.0).abs() < 1e-5,
                "{name}, {patch:?}: the row sums to {sum}"
            );
            let mut difference = vec![0.0_f64; mesh.elements().len()];
            let mut variance = vec![1.0 / cast.powi(2); mesh.elements().len()];
            for (&e, &f) in one.receivers.iter().zip(one.band(0)) {
                difference[e as usize] += f64::from(f);
                variance[e as usize] += 0.5 * f64::from(f) / cast;
            }
            for (&e, &f) in two.receivers.iter().zip(two.band(0)) {
                difference[e as usize] -= f64::from(f);
                variance[e as usize] += 0.5 * f64::from(f) / cast;
            }
            for (e, (d, v)) in difference.iter().zip(&variance).enumerate() {
                // A factor above what rays can tell counts by its z-score.
                if *v > 16.0 / cast.powi(2) && is_exposed(e) {
                    // In the office many pairs lie behind panes and curtains: 3 % by sampling.
                    let sampled = 0.03 * v * cast;
                    squares += d * d / (v + sampled * sampled);
                    count += 1;
                }
            }
        }
        let z = (squares / f64::from(count)).sqrt();
        println!("{name}: RMS z-score {z:.2} of {count} factors");
        // Low-discrepancy rays are better than random ones.
        assert!(z < 1.5, "{name}: RMS z-score {z:.2}");
    }
}
