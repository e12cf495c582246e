//! Radiosity by rays: the exact light within the error that it states, energy kept, the same bits on any number of threads.

use hemicube::radiosity::form_factor::FormFactorKind;
use hemicube::radiosity::{
    PatchMesh, PatchOptions, Quality, Solution, SolveOptions, Solver, SolverKind, Stochastic,
    StochasticOptions, resume, solve,
};
use hemicube::scene::builtin;
use hemicube_tests::solutions::{
    balance_error, begun_and_done, built_in, exhausted, irradiance_bits, start,
};
use std::sync::Arc;

fn solved(start: &Solution, options: StochasticOptions) -> Stochastic {
    exhausted(Stochastic::new(start.clone(), options).expect("good options"))
}

/// Root mean square over the elements that get more than a hundredth of the mean.
fn relative_difference(a: &Solution, b: &Solution) -> f64 {
    let elements = 0..a.mesh().elements().len();
    let total = |s: &Solution, e: usize| -> f64 {
        let h = s.element_irradiance(e).to_array();
        h.iter().map(|&x| f64::from(x)).sum()
    };
    let mean = elements.clone().map(|e| total(b, e)).sum::<f64>() / elements.len() as f64;
    let squares: Vec<f64> = elements
        .filter(|&e| total(b, e) > 0.01 * mean)
        .map(|e| ((total(a, e) - total(b, e)) / total(b, e)).powi(2))
        .collect();
    (squares.iter().sum::<f64>() / squares.len() as f64).sqrt()
}

/// As [`relative_difference`], each element by its area: rows of form factors leave much noise on the slivers that joints cut
/// off.
fn difference_by_area(a: &Solution, b: &Solution) -> f64 {
    let mesh = a.mesh();
    let (mut squares, mut areas) = (0.0, 0.0);
    for e in (0..mesh.elements().len()).filter(|&e| mesh.exposed_area(e) > 0.0) {
        let [a, b] = [a, b].map(|s| f64::from(s.element_irradiance(e).luminance()));
        let area = f64::from(mesh.exposed_area(e));
        squares += area * ((a - b) / b.max(f64::MIN_POSITIVE)).powi(2);
        areas += area;
    }
    (squares / areas).sqrt()
}

/// Of the flux that all elements receive.
fn relative_bias(a: &Solution, b: &Solution) -> f64 {
    let flux = |s: &Solution| -> f64 {
        let of = |e: usize| {
            let h = s.element_irradiance(e).to_array();
            let area = f64::from(s.mesh().exposed_area(e));
            h.iter().map(|&x| f64::from(x)).sum::<f64>() * area
        };
        (0..s.mesh().elements().len()).map(of).sum()
    };
    flux(a) / flux(b) - 1.0
}

#[test]
fn a_furnace_is_as_bright_everywhere_as_it_must_be() {
    for reflectance in [0.0, 0.5, 0.8] {
        let start = start(Arc::new(builtin::furnace_with(reflectance, 1.0)), 200, 50);
        let options = StochasticOptions {
            noise: 0.005,
            ..StochasticOptions::default()
        };
        let solver = solved(&start, options);
        let exact = 1.0 / (1.0 - reflectance);
        let solution = solver.solution();
        for e in 0..solution.mesh().elements().len() {
            let b = solution.element_radiosity(e).g;
            let error = (b / exact - 1.0).abs();
            assert!(
                error < 0.02,
                "ρ {reflectance}, element {e}: {b} for {exact}"
            );
        }
        let error = balance_error(solution);
        assert!(
            error < 1e-5,
            "ρ {reflectance}: {error:.1e} of the energy is lost"
        );
    }
}

#[test]
fn the_stated_error_is_the_error_there_is() {
    for (name, counting_elements) in [("cornell", 50_000), ("cornell", 0), ("two-rooms", 50_000)] {
        let start = start(built_in(name), 500, 80);
        let options = StochasticOptions {
            noise: 0.05,
            counting_elements,
            ..StochasticOptions::default()
        };
        let coarse = solved(&start, options);
        let fine = StochasticOptions {
            noise: 0.015,
            seed: 77,
            ..options
        };
        let fine = solved(&start, fine);
        let error = relative_difference(coarse.solution(), fine.solution());
        let stated = coarse.noise();
        assert!(stated <= 0.05, "{name}: ended at {stated}");
        assert!(
            error < 1.6 * stated && error > 0.3 * stated,
            "{name}, {counting_elements}: error {error:.4}, stated {stated:.4}"
        );
    }
}

#[test]
fn rays_and_rows_of_form_factors_come_to_the_same_light() {
    let start = start(built_in("cornell"), 500, 500);
    let options = StochasticOptions {
        noise: 0.02,
        ..StochasticOptions::default()
    };
    let by_rays = solved(&start, options);
    let shooting = SolveOptions {
        rays: 1024,
        tolerance: 1e-5,
        solver: SolverKind::SortedShooting,
        ..Quality::Draft.into()
    };
    let by_rows = resume(start, &shooting, |_, _| true).expect("it goes on");
    // Rows of form factors have noise of their own.
    let difference = relative_difference(by_rays.solution(), &by_rows);
    assert!(difference < 0.05, "they differ by {difference:.4}");
    let bias = relative_bias(by_rays.solution(), &by_rows);
    assert!(bias.abs() < 0.004, "all in all they differ by {bias:.4}");
}

#[test]
fn coarse_patches_leave_no_error_of_their_own() {
    // Half of a patch is under a block or in its shadow: its mean is off by up to the whole light there.
    let start = start(built_in("cornell"), 500, 40);
    let exact = SolveOptions {
        mesh: PatchOptions::default().with_elements(500).with_patches(500),
        form_factors: FormFactorKind::Analytic,
        tolerance: 1e-6,
        solver: SolverKind::GaussSeidel,
        ..SolveOptions::default()
    };
    let exact = solve(built_in("cornell"), &exact, |_, _| true).expect("it is solved");
    for noise in [0.04, 0.02] {
        let options = StochasticOptions {
            noise,
            rays: 64,
            counting_elements: 0,
            ..StochasticOptions::default()
        };
        let solver = solved(&start, options);
        let error = relative_difference(solver.solution(), &exact);
        assert!(error < 1.5 * noise, "{noise} asked, {error:.4} found");
    }
}

#[test]
fn noise_falls_with_the_rays() {
    let start = start(built_in("cornell"), 600, 100);
    let mut last = None;
    for noise in [0.08, 0.04, 0.02] {
        let options = StochasticOptions {
            noise,
            rays: 64,
            ..StochasticOptions::default()
        };
        let solver = solved(&start, options);
        let rays = solver.rays();
        if let Some((rays_before, noise_before)) = last {
            let steps = rays as f64 / rays_before as f64;
            let expected: f64 = noise_before / steps.sqrt();
            let found = solver.noise();
            assert!(
                found < 1.5 * expected,
                "{steps:.1} times the rays: noise {found:.4}, by the root {expected:.4}"
            );
        }
        last = Some((rays, solver.noise()));
    }
}

#[test]
fn every_step_keeps_the_energy() {
    let start = start(built_in("cornell"), 600, 100);
    for counting_elements in [0, 50_000] {
        let options = StochasticOptions {
            counting_elements,
            ..StochasticOptions::default()
        };
        let mut solver = Stochastic::new(start.clone(), options).expect("good options");
        let mut steps = 0;
        while !solver.is_exhausted() {
            solver.step();
            steps += 1;
            let error = balance_error(solver.solution());
            assert!(error < 1e-6, "step {steps}: {error:.1e} is lost");
        }
    }
}

#[test]
fn same_bits_on_one_and_four_threads() {
    let start = start(built_in("two-rooms"), 400, 100);
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        let options = StochasticOptions {
            noise: 0.1,
            counting_elements: 0,
            ..StochasticOptions::default()
        };
        let solver = pool.expect("threads").install(|| solved(&start, options));
        let solution = solver.solution();
        irradiance_bits(solution)
    };
    assert!(run(1) == run(4), "four threads give other bits");
}

#[test]
fn what_another_solver_left_is_spread() {
    let start = start(built_in("cornell"), 600, 600);
    let [half, truth] = begun_and_done(start);
    let by_rays = SolveOptions {
        solver: SolverKind::Stochastic,
        rays: 2048,
        tolerance: 1e-4,
        ..Quality::Draft.into()
    };
    let end = resume(half, &by_rays, |_, _| true).expect("it goes on");
    assert!(end.unshot_fraction() <= by_rays.tolerance, "all is spread");
    let difference = difference_by_area(&end, &truth);
    // Noise, mostly of the rows.
    assert!(difference < 0.08, "it differs by {difference:.4}");
    let bias = relative_bias(&end, &truth);
    assert!(bias.abs() < 0.003, "all in all it differs by {bias:.4}");
    let error = balance_error(&end);
    assert!(error < 1e-5, "{error:.1e} of the energy is lost");
}

#[test]
fn no_rays_and_no_noise_are_refused() {
    let start = start(built_in("cornell"), 100, 50);
    for (rays, noise) in [(0, 0.1), (16, 0.0), (16, f64::NAN), (16, -1.0)] {
        let options = StochasticOptions {
            rays,
            noise,
            ..StochasticOptions::default()
        };
        let refused = Stochastic::new(start.clone(), options).is_err();
        assert!(refused, "{rays} rays to a noise of {noise}");
    }
}

#[test]
fn sunlight_alone_is_reflected() {
    // No surface emits: what the sky brings is all there is to reflect.
    let mut room = builtin::furnace_with(0.5, 0.0);
    room.sky = hemicube::raster::Rgb::WHITE;
    let closed = solve(Arc::new(room.clone()), &by_rays(), |_, _| true);
    // No sky comes into a closed box.
    assert!(
        closed.is_ok_and(|s| s.element_irradiance(0).g == 0.0),
        "dark"
    );
}

fn by_rays() -> SolveOptions {
    SolveOptions {
        mesh: PatchOptions::default().with_elements(100),
        solver: SolverKind::Stochastic,
        ..Quality::Draft.into()
    }
}

#[test]
fn its_name_and_its_noise_are_kept() {
    let solution = solve(built_in("cornell"), &by_rays(), |_, _| true).expect("it is solved");
    assert_eq!(
        solution.provenance.solver, "stochastic",
        "the solver's name"
    );
    let noise = solution.provenance.noise.expect("it is known");
    assert!(noise > 0.0 && noise <= 0.1, "noise {noise}");
    let rays = solution.provenance.rays;
    assert!(rays > 10_000, "{rays} rays are counted");
    let _: &PatchMesh = solution.mesh();
}

#[test]
fn a_check_finds_the_noise_and_changes_nothing() {
    for (name, counting_elements) in [("cornell", 50_000), ("cornell", 0), ("two-rooms", 50_000)] {
        let start = start(built_in(name), 300, 80);
        let options = StochasticOptions {
            noise: 0.08,
            rays: 64,
            counting_elements,
            ..StochasticOptions::default()
        };
        let mut solver = solved(&start, options);
        let before = irradiance_bits(solver.solution());
        let check = solver.check_noise(usize::MAX, 32);
        assert!(check.elements > 200, "{name}: {check:?}");
        assert!(
            check.found < 1.6 * check.stated && check.found > 0.4 * check.stated,
            "{name}, {counting_elements}: {check:?}"
        );
        assert!(
            irradiance_bits(solver.solution()) == before,
            "{name}: a check must not change the light"
        );
    }
}
