//! Matrices of form factors, and the solvers that work on them.

use hemicube::radiosity::form_factor::{Cached, MatrixOptions, Storage, ViewFactorMatrix};
use hemicube::radiosity::solve::system::{Channel, MatrixMethod, System};
use hemicube::radiosity::solve::{Gauss, MatrixRun, MatrixSolverKind, OnMatrix, run, solve_matrix};
use hemicube::radiosity::stop::NEVER;
use hemicube::radiosity::{
    FormFactors, Order, PatchMesh, PatchOptions, RayCast, RayCastOptions, Shooting, Solution,
    SolveOptions, Solver, SolverKind, unlit,
};
use hemicube::raster::Rgb;
use hemicube::scene::{Scene, builtin};
use std::sync::Arc;

const CACHE: usize = 256 << 20;

fn mesh_of(scene: Scene, patches: usize) -> Arc<PatchMesh> {
    let options = PatchOptions::default()
        .with_patches(patches)
        .with_elements(3 * patches);
    Arc::new(PatchMesh::build(Arc::new(scene), options).expect("it can be cut"))
}

fn cornell(patches: usize) -> Arc<PatchMesh> {
    mesh_of(builtin::scene("cornell").expect("it is built in"), patches)
}

fn factors_of(mesh: &Arc<PatchMesh>) -> Cached<RayCast> {
    let options = RayCastOptions::default();
    Cached::new(RayCast::new(mesh.clone(), options), CACHE)
}

fn emitters_only(mesh: &Arc<PatchMesh>) -> Solution {
    let dark = vec![Rgb::BLACK; mesh.elements().len()];
    Solution::new(mesh.clone(), &dark, Default::default())
}

fn matrix_of(factors: &dyn FormFactors, options: MatrixOptions) -> ViewFactorMatrix {
    let mut matrices = ViewFactorMatrix::build(factors, options).expect("it fits");
    assert_eq!(matrices.len(), 1, "nothing is tinted");
    matrices.remove(0)
}

fn stored(storage: Storage) -> MatrixOptions {
    MatrixOptions {
        storage,
        ..MatrixOptions::default()
    }
}

/// A solution by a matrix solver, down to a residual share.
fn solved(factors: &dyn FormFactors, kind: MatrixSolverKind, tolerance: f64) -> Solution {
    let start = emitters_only(factors.mesh());
    let mut solver =
        OnMatrix::new(factors, start, kind, MatrixOptions::default()).expect("it fits");
    let progress = run(&mut solver, tolerance, |p, _| p.iteration < 200_000);
    assert!(
        progress.unshot <= tolerance,
        "{} stops at {:.1e}",
        kind.name(),
        progress.unshot
    );
    solver.into_solution()
}

fn assert_balanced(solution: &Solution, who: &str) {
    for band in 0..3 {
        let unshot = solution.unshot_flux(band);
        let error = solution.total_balance(band).relative_error(unshot);
        assert!(
            error < 1e-5,
            "{who}, band {band}: {error:.1e} of the energy is lost"
        );
    }
}

#[test]
fn all_solvers_agree_on_the_same_factors() {
    let mesh = cornell(300);
    let factors = factors_of(&mesh);
    let mut shooting = Shooting::new(&factors, emitters_only(&mesh), Order::Sorted);
    run(&mut shooting, 1e-7, |_, _| true);
    let truth = shooting.into_solution();
    for kind in MatrixSolverKind::ALL {
        let solution = solved(&factors, kind, 1e-7);
        assert_balanced(&solution, kind.name());
        for band in 0..3 {
            let of = |s: &Solution, e: usize| f64::from(s.element_radiosity(e)[band]);
            let elements = 0..mesh.elements().len();
            let most = elements.clone().map(|e| of(&truth, e)).fold(0.0, f64::max);
            let error = elements.map(|e| (of(&solution, e) - of(&truth, e)).abs());
            let error = error.fold(0.0, f64::max) / most;
            println!("{} band {band}: {error:.2e}", kind.name());
            assert!(
                error < 1e-5,
                "{}, band {band}: an element is off by {error:.1e} of the brightest",
                kind.name()
            );
        }
    }
}

/// Channels of a system over a matrix: some share their reflectances, some do not.
fn channels(n: usize) -> Vec<Channel> {
    let noise = |i: usize, k: usize| ((i * 7919 + k * 104_729) % 1009) as f64 / 1009.0;
    let channel = |k: usize| Channel {
        matrix: 0,
        reflectance: (0..n).map(|i| 0.9 * noise(i, k % 2)).collect(),
        emission: (0..n).map(|i| noise(i, k + 5)).collect(),
        radiosity: vec![0.0; n],
    };
    (0..4).map(channel).collect()
}

#[test]
fn elimination_by_blocks_equals_the_readable_one() {
    // 128 columns are a block, 64 a strip, 16 are eliminated one by one: sizes on both sides of each.
    for patches in [20, 60, 150, 400] {
        let matrix = matrix_of(&factors_of(&cornell(patches)), MatrixOptions::default());
        let n = matrix.size();
        let solve = |readable_up_to| {
            let mut channels = channels(n);
            let entries = core::slice::from_ref(matrix.entries());
            let mut system = System::new(entries, matrix.areas(), &mut channels);
            let mut gauss = Gauss::readable_up_to(readable_up_to);
            let mut steps = 1;
            while !gauss.step(&mut system) {
                steps += 1;
            }
            (channels, steps)
        };
        let ((readable, columns), (blocked, blocks)) = (solve(n), solve(0));
        assert_eq!(
            (columns, blocks),
            (n, n.div_ceil(128)),
            "columns and blocks are steps"
        );
        for (a, b) in readable.iter().zip(&blocked) {
            for (a, b) in a.radiosity.iter().zip(&b.radiosity) {
                assert!((a - b).abs() < 1e-12 * a.abs(), "{n} patches: {a} and {b}");
            }
        }
    }
}

#[test]
fn channels_gathered_together_are_those_gathered_alone() {
    let matrix = matrix_of(&factors_of(&cornell(100)), MatrixOptions::default());
    let entries = core::slice::from_ref(matrix.entries());
    for kind in MatrixSolverKind::ALL {
        let step = |channels: &mut [Channel]| {
            let mut system = System::new(entries, matrix.areas(), channels);
            let mut method = kind.method();
            (0..3).for_each(|_| {
                method.step(&mut system);
            });
        };
        let mut together = channels(matrix.size());
        step(&mut together);
        let mut alone = channels(matrix.size());
        alone.chunks_mut(1).for_each(step);
        let is_as_alone = match kind {
            // They choose one patch for all channels.
            MatrixSolverKind::Southwell | MatrixSolverKind::Overshooting => continue,
            // Several right sides are solved in another order than one.
            MatrixSolverKind::Gauss => {
                let radiosity =
                    |c: &[Channel]| c.iter().flat_map(|c| c.radiosity.clone()).collect();
                let (a, b): (Vec<f64>, Vec<f64>) = (radiosity(&together), radiosity(&alone));
                a.iter().zip(&b).all(|(a, b)| (a - b).abs() <= 1e-13 * b)
            }
            _ => together == alone,
        };
        assert!(is_as_alone, "{}: the same light", kind.name());
    }
}

#[test]
fn overshooting_owes_and_pays() {
    let mesh = mesh_of(builtin::scene("two-rooms").expect("it is built in"), 200);
    let factors = factors_of(&mesh);
    let shots = |order, tolerance| {
        let mut solver = Shooting::new(&factors, emitters_only(&mesh), order);
        let mut least = 0.0_f32;
        let progress = run(&mut solver, tolerance, |_, solution| {
            least = solution.unshot(0, 1).iter().copied().fold(least, f32::min);
            true
        });
        let solution = solver.into_solution();
        assert_balanced(&solution, &format!("{order:?}"));
        (progress.iteration, least, solution)
    };
    let (sorted, owed, truth) = shots(Order::Sorted, 1e-6);
    assert_eq!(owed, 0.0, "sorted shooting owes nothing");
    let (ahead, owed, solution) = shots(Order::Overshooting, 1e-6);
    assert!(owed < 0.0, "what is shot ahead is owed");
    println!("{sorted} shots, {ahead} with overshooting");
    assert!(ahead < sorted, "{ahead} shots instead of {sorted}");
    for e in 0..mesh.elements().len() {
        let (a, b) = (
            solution.element_irradiance(e).g,
            truth.element_irradiance(e).g,
        );
        assert!(
            (a - b).abs() < 1e-4 * b.max(1e-2),
            "element {e}: {a} and {b}"
        );
    }
}

/// Patches that vary within, and panes that tint: the matrix is then only near to the truth, sweeps correct it.
#[test]
fn textures_and_tinted_panes_come_to_the_same_light() {
    let mut mottled = builtin::scene("cornell").expect("it is built in");
    for mesh in &mut mottled.meshes {
        let shades = (0..mesh.positions.len()).map(|i| [0.3, 1.0, 0.6][i % 3]);
        mesh.colors = shades.map(|s| glam::Vec4::new(s, s, s, 1.0)).collect();
    }
    let mut tinted = builtin::scene("cornell").expect("it is built in");
    for material in &mut tinted.materials {
        if !material.emits() {
            material.transmission = 0.3;
        }
    }
    for (scene, bands) in [(mottled, 1), (tinted, 3)] {
        let name = scene.name.clone();
        let mesh = mesh_of(scene, 200);
        let factors = factors_of(&mesh);
        let matrices =
            ViewFactorMatrix::build(&factors, MatrixOptions::default()).expect("it fits");
        assert_eq!(
            matrices.len(),
            bands,
            "{name}: a matrix for each band that differs"
        );
        for matrix in &matrices {
            let closure = matrix.closure_error();
            assert!(closure < 1e-5, "{name}: rows close, not {closure:.1e}");
        }
        let mut shooting = Shooting::new(&factors, emitters_only(&mesh), Order::Sorted);
        run(&mut shooting, 1e-7, |_, _| true);
        let truth = shooting.into_solution();
        for kind in [
            MatrixSolverKind::GaussSeidel,
            MatrixSolverKind::Southwell,
            MatrixSolverKind::Gauss,
        ] {
            let solution = solved(&factors, kind, 1e-7);
            assert_balanced(&solution, kind.name());
            let of = |s: &Solution, e: usize| f64::from(s.element_irradiance(e).g);
            let elements = 0..mesh.elements().len();
            let most = elements.clone().map(|e| of(&truth, e)).fold(0.0, f64::max);
            let error = elements.map(|e| (of(&solution, e) - of(&truth, e)).abs());
            let error = error.fold(0.0, f64::max) / most;
            println!(
                "{name}, {} matrices, {}: {error:.1e}",
                matrices.len(),
                kind.name()
            );
            assert!(error < 1e-5, "{name}, {}: {error:.1e}", kind.name());
        }
    }
}

#[test]
fn matrix_methods_agree_on_plain_vectors() {
    let mesh = cornell(300);
    let matrix = matrix_of(&factors_of(&mesh), MatrixOptions::default());
    let emission: Vec<f64> = (0..matrix.size())
        .map(|p| f64::from(mesh.emission()[mesh.elements_of_patch(p).start].r))
        .collect();
    let reflectance: Vec<f64> = (0..matrix.size())
        .map(|p| f64::from(mesh.reflectance()[mesh.elements_of_patch(p).start].r))
        .collect();
    let all = MatrixSolverKind::ALL.map(|kind| {
        let solution = solve_matrix(&matrix, &emission, &reflectance, kind, 1e-10, 1000)
            .expect("it is solvable");
        let (last, sweeps) = (solution.history.last(), solution.history.len() - 1);
        println!("{}: {sweeps} sweeps, {last:?}", kind.name());
        assert!(
            last.is_some_and(|&share| share <= 1e-10),
            "{} ends at {last:?}",
            kind.name()
        );
        solution.radiosity
    });
    let most = all[0].iter().copied().fold(0.0, f64::max);
    for (kind, radiosity) in MatrixSolverKind::ALL.iter().zip(&all) {
        let errors = radiosity.iter().zip(&all[0]).map(|(a, b)| (a - b).abs());
        let error = errors.fold(0.0, f64::max) / most;
        assert!(
            error < 1e-8,
            "{} is {error:.1e} away from gauss",
            kind.name()
        );
    }
}

#[test]
fn furnace_radiosity_is_emission_over_one_minus_reflectance() {
    for reflectance in [0.0_f32, 0.5, 0.9, 0.95] {
        let mesh = mesh_of(builtin::furnace_with(reflectance, 1.0), 60);
        let factors = factors_of(&mesh);
        let exact = 1.0 / (1.0 - f64::from(reflectance));
        for kind in MatrixSolverKind::ALL {
            let solution = solved(&factors, kind, 1e-6);
            assert_balanced(&solution, kind.name());
            // Rows close, but reciprocity of sampled factors is not exact: patches differ, their mean does not.
            let (mut flux, mut area) = (0.0, 0.0);
            for e in 0..mesh.elements().len() {
                let a = f64::from(mesh.exposed_area(e));
                flux += a * f64::from(solution.element_radiosity(e).g);
                area += a;
            }
            let error = (flux / area / exact - 1.0).abs();
            assert!(
                error < 1e-4,
                "{}, reflectance {reflectance}: off by {error:.1e}",
                kind.name()
            );
        }
        let matrix = matrix_of(&factors, MatrixOptions::default()).enclosure_corrected();
        let n = matrix.size();
        let rho = vec![f64::from(reflectance); n];
        for kind in MatrixSolverKind::ALL {
            let solution =
                solve_matrix(&matrix, &vec![1.0; n], &rho, kind, 1e-9, 2000).expect("solvable");
            let errors = solution.radiosity.iter().map(|b| (b / exact - 1.0).abs());
            let error = errors.fold(0.0, f64::max);
            // A closure error of 1e-6 in f32 grows by 1 / (1 - ρ).
            assert!(
                error < 2e-5,
                "{}, reflectance {reflectance}: a patch is off by {error:.1e}",
                kind.name()
            );
        }
    }
}

fn numbers(value: &serde_json::Value) -> Vec<f64> {
    let values = value.as_array().expect("a list").iter();
    values.map(|x| x.as_f64().expect("a number")).collect()
}

/// Area of a rectangle by its corners.
fn rectangle_area(corners: &serde_json::Value) -> f64 {
    let corner = |i: usize| numbers(&corners[i]);
    let edge = |a: usize, b: usize| -> f64 {
        let squares = corner(a).into_iter().zip(corner(b));
        squares.map(|(x, y)| (x - y).powi(2)).sum::<f64>().sqrt()
    };
    edge(0, 1) * edge(1, 2)
}

fn assert_close(found: &[f64], expected: &[f64], what: &str) {
    let most = expected.iter().copied().fold(0.0, f64::max);
    for (i, (a, b)) in found.iter().zip(expected).enumerate() {
        assert!(
            (a - b).abs() <= 1e-6 * most,
            "{what}, patch {i}: {a} instead of {b}"
        );
    }
}

#[test]
fn zonal_boxes_and_their_iterates_are_those_of_the_reference() {
    let root: serde_json::Value =
        serde_json::from_str(include_str!("../data/zonal_boxes.json")).expect("it is JSON");
    for case in root["cases"].as_array().expect("cases") {
        let id = case["id"].as_str().expect("an id");
        let surfaces = case["surfaces"].as_array().expect("surfaces");
        let of = |key: &str| -> Vec<f64> {
            let values = surfaces.iter().map(|s| s[key].as_f64().expect("a number"));
            values.collect()
        };
        let (rho, emission) = (of("rho"), of("exitance"));
        let names: Vec<String> = surfaces
            .iter()
            .map(|s| s["id"].as_str().expect("a name").into())
            .collect();
        let areas = surfaces
            .iter()
            .map(|s| rectangle_area(&s["verts"]))
            .collect();
        let reference = &case["reference"];
        let rows = reference["F"].as_array().expect("rows");
        let factors: Vec<f64> = rows.iter().flat_map(numbers).collect();
        let matrix = ViewFactorMatrix::from_rows(areas, names.clone(), &factors).expect("a matrix");
        matrix.check(1e-6).expect("its factors are possible");
        assert!(matrix.closure_error() < 1e-6, "{id} is closed");

        let exact: Vec<f64> = names
            .iter()
            .map(|name| reference["B"][name].as_f64().expect("a radiosity"))
            .collect();
        for kind in MatrixSolverKind::ALL {
            let found = solve_matrix(&matrix, &emission, &rho, kind, 1e-9, 1000).expect("solvable");
            assert_close(&found.radiosity, &exact, &format!("{id}, {}", kind.name()));
        }
        for (kind, key) in [
            (MatrixSolverKind::Jacobi, "jacobi_sweeps_1_to_5"),
            (MatrixSolverKind::GaussSeidel, "gauss_seidel_sweeps_1_to_3"),
        ] {
            let mut run = MatrixRun::new(&matrix, &emission, &rho, kind).expect("solvable");
            for (sweep, expected) in reference[key]
                .as_array()
                .expect("sweeps")
                .iter()
                .enumerate()
            {
                run.step();
                let what = format!("{id}, {} sweep {}", kind.name(), sweep + 1);
                assert_close(run.radiosity(), &numbers(expected), &what);
            }
        }
        let southwell = MatrixSolverKind::Southwell;
        let mut run = MatrixRun::new(&matrix, &emission, &rho, southwell).expect("solvable");
        let shots = reference["shooting_sorted_first_6"].as_array();
        for (shot, expected) in shots.expect("shots").iter().enumerate() {
            run.step();
            let unshot = run.residuals();
            let shown: Vec<f64> = run
                .radiosity()
                .iter()
                .zip(&unshot)
                .map(|(b, r)| b + r)
                .collect();
            let what = format!("{id}, shot {}", shot + 1);
            assert_close(&shown, &numbers(&expected["B"]), &what);
            let most = numbers(&expected["B"]).into_iter().fold(0.0, f64::max);
            for (a, b) in unshot.iter().zip(numbers(&expected["unshot"])) {
                assert!(
                    (a - b).abs() < 1e-6 * most,
                    "{what}: {a} unshot instead of {b}"
                );
            }
        }
    }
}

#[test]
fn rows_close_and_correction_adds_reciprocity() {
    let matrix = matrix_of(&factors_of(&cornell(300)), MatrixOptions::default());
    let (closure, reciprocity) = (matrix.closure_error(), matrix.reciprocity_error());
    println!("cast: closure {closure:.1e}, {reciprocity:?}");
    assert!(closure < 1e-5, "rows of rays close: {closure:.1e}");
    let corrected = matrix.enclosure_corrected();
    let (closure, reciprocity) = (corrected.closure_error(), corrected.reciprocity_error());
    println!("corrected: closure {closure:.1e}, {reciprocity:?}");
    assert!(closure < 1e-6, "corrected rows close: {closure:.1e}");
    assert!(
        reciprocity.error < 1e-6,
        "corrected factors are reciprocal: {reciprocity:?}"
    );
    corrected
        .check(1e-6)
        .expect("corrected factors are possible");
    let sky = |m: &ViewFactorMatrix| m.sky().iter().copied().fold(0.0, f64::max);
    assert!(sky(&corrected) > 0.1, "the front is open and stays so");
}

#[test]
fn patches_buried_under_a_box_do_not_spoil_the_correction() {
    let mesh = cornell(1200);
    let matrix = matrix_of(&factors_of(&mesh), MatrixOptions::default());
    let buried = matrix.areas().iter().filter(|&&a| a == 0.0).count();
    assert!(buried > 0, "some of the floor lies wholly under a box");
    let corrected = matrix.enclosure_corrected();
    let (closure, reciprocity) = (corrected.closure_error(), corrected.reciprocity_error());
    assert!(closure < 1e-6, "corrected rows close: {closure:.1e}");
    assert!(
        reciprocity.error < 1e-6,
        "corrected factors are reciprocal: {reciprocity:?}"
    );
}

#[test]
fn sparse_equals_dense() {
    let factors = factors_of(&cornell(200));
    let dense = matrix_of(&factors, stored(Storage::Dense));
    let sparse = matrix_of(&factors, stored(Storage::Sparse));
    assert!(
        sparse.entries().is_sparse() && !dense.entries().is_sparse(),
        "each is stored as asked"
    );
    let compare = |a: &ViewFactorMatrix, b: &ViewFactorMatrix, tolerance: f32| {
        for i in 0..a.size() {
            for j in 0..a.size() {
                let (a, b) = (a.get(i, j), b.get(i, j));
                assert!((a - b).abs() <= tolerance, "({i}, {j}): {a} and {b}");
            }
        }
    };
    compare(&dense, &sparse, 0.0);
    assert_eq!(dense.sky(), sparse.sky(), "skies are the same");
    // Sums over the same entries, zeros left out.
    compare(
        &dense.enclosure_corrected(),
        &sparse.enclosure_corrected(),
        1e-7,
    );
    let n = dense.size();
    let emission: Vec<f64> = (0..n).map(|i| f64::from(u8::from(i == 3))).collect();
    for kind in MatrixSolverKind::ALL {
        let solve = |m| {
            solve_matrix(m, &emission, &vec![0.5; n], kind, 1e-12, 200).expect("it is solvable")
        };
        let (a, b) = (solve(&dense), solve(&sparse));
        for (a, b) in a.radiosity.iter().zip(&b.radiosity) {
            assert!((a - b).abs() < 1e-10, "{}: {a} and {b}", kind.name());
        }
    }
}

#[test]
fn boxes_apart_make_a_sparse_matrix() {
    let mut scene = builtin::furnace_with(0.5, 1.0);
    let one = scene.instances.clone();
    for k in 1..6_u8 {
        for instance in &one {
            let mut moved = instance.clone();
            moved.world_from_mesh.translation.x += 10.0 * f32::from(k);
            scene.instances.push(moved);
        }
    }
    let factors = factors_of(&mesh_of(scene, 300));
    let matrix = matrix_of(&factors, MatrixOptions::default());
    let n = matrix.size();
    assert!(
        matrix.entries().is_sparse(),
        "a patch sees at most a sixth of all"
    );
    assert!(
        matrix.entries().bytes() < 2 * n * n,
        "it is smaller than a dense one of {n} patches"
    );
    let corrected = matrix.enclosure_corrected();
    let (closure, reciprocity) = (corrected.closure_error(), corrected.reciprocity_error());
    assert!(closure < 1e-6, "corrected rows close: {closure:.1e}");
    assert!(
        reciprocity.error < 1e-6,
        "corrected factors are reciprocal: {reciprocity:?}"
    );
    for kind in MatrixSolverKind::ALL {
        let solution = solve_matrix(&corrected, &vec![1.0; n], &vec![0.5; n], kind, 1e-9, 100);
        for b in solution.expect("it is solvable").radiosity {
            assert!((b - 2.0).abs() < 1e-5, "{}: {b} instead of 2", kind.name());
        }
    }
}

#[test]
fn too_much_memory_is_refused_before_the_work() {
    let factors = factors_of(&cornell(300));
    for storage in [Storage::Auto, Storage::Dense, Storage::Sparse] {
        let options = MatrixOptions {
            memory_limit: 1000,
            storage,
        };
        let error = ViewFactorMatrix::build(&factors, options).expect_err("1000 bytes are too few");
        let message = error.to_string();
        assert!(
            message.contains("patches take about") && message.contains("MiB are allowed"),
            "the message has both numbers: {message}"
        );
    }
    let n = factors.mesh().patches().len();
    let options = MatrixOptions {
        memory_limit: 4 * n * n + 1000,
        storage: Storage::Dense,
    };
    let start = emitters_only(factors.mesh());
    let Err(error) = OnMatrix::new(&factors, start, MatrixSolverKind::Gauss, options) else {
        panic!("elimination needs more than the factors");
    };
    let message = error.to_string();
    assert!(message.contains("solver gauss"), "it says who: {message}");
    assert!(message.contains("or gauss-seidel"), "what fits: {message}");
    let start = emitters_only(factors.mesh());
    let advised = OnMatrix::new(&factors, start, MatrixSolverKind::GaussSeidel, options);
    assert!(advised.is_ok(), "what is advised does fit");
    let smaller = MatrixOptions {
        memory_limit: 4 * n * n - 1,
        ..options
    };
    let start = emitters_only(factors.mesh());
    let Err(error) = OnMatrix::new(&factors, start, MatrixSolverKind::Gauss, smaller) else {
        panic!("not even the factors fit");
    };
    let message = error.to_string();
    assert!(
        message.contains("solver gauss on")
            && message.contains("a solver that shoots")
            && !message.contains("gauss-seidel"),
        "what would be refused next is no advice: {message}"
    );
}

/// The sky's light would take a ray for each of 256 from each element.
#[test]
fn a_solver_that_does_not_fit_is_refused_before_light_falls() {
    let mut scene = builtin::scene("cornell").expect("it is built in");
    scene.sky = Rgb::WHITE;
    let options = SolveOptions {
        solver: SolverKind::GaussSeidel,
        memory_limit: 1000,
        ..SolveOptions::default()
    };
    let error = unlit(Arc::new(scene), &options, NEVER).expect_err("nothing fits");
    let message = error.to_string();
    assert!(
        message.contains("MiB are allowed") && message.contains("pairs that were tried"),
        "numbers, and where from: {message}"
    );
}

#[test]
fn a_solution_is_handed_from_one_solver_to_the_next() {
    let mesh = cornell(150);
    let factors = factors_of(&mesh);
    let whole = solved(&factors, MatrixSolverKind::Gauss, 1e-7);
    let mut shooting = Shooting::new(&factors, emitters_only(&mesh), Order::Sorted);
    (0..20).for_each(|_| {
        shooting.step();
    });
    let mut solution = shooting.into_solution();
    for kind in [
        MatrixSolverKind::Gathering,
        MatrixSolverKind::Southwell,
        MatrixSolverKind::Jacobi,
        MatrixSolverKind::GaussSeidel,
    ] {
        let options = MatrixOptions::default();
        let mut solver = OnMatrix::new(&factors, solution, kind, options).expect("it fits");
        (0..40).for_each(|_| {
            solver.step();
        });
        solution = solver.into_solution();
        assert_balanced(&solution, kind.name());
    }
    for e in 0..mesh.elements().len() {
        let (a, b) = (
            solution.element_irradiance(e).g,
            whole.element_irradiance(e).g,
        );
        assert!(
            (a - b).abs() < 1e-4 * b.max(1e-2),
            "element {e}: {a} and {b}"
        );
    }
}

#[test]
fn matrices_and_solutions_have_the_same_bits_on_any_number_of_threads() {
    let work = || {
        let factors = factors_of(&cornell(120));
        let matrix = matrix_of(&factors, MatrixOptions::default()).enclosure_corrected();
        let solutions = MatrixSolverKind::ALL.map(|kind| {
            let solution = solved(&factors, kind, 1e-5);
            solution.irradiance(0, 1).to_vec()
        });
        (matrix, solutions)
    };
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        pool.expect("threads can be started").install(work)
    };
    let one = on(1);
    for threads in [2, 8] {
        assert!(
            on(threads) == one,
            "{threads} threads give other bits than one"
        );
    }
}
