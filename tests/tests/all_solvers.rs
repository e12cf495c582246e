//! Every solver by its name: the same light, energy kept, resumable by any other, stopped in time.

use hemicube::radiosity::compare::{converged, relative_error, shown_radiosity, variant};
use hemicube::radiosity::form_factor::hemicube::HemicubeOptions;
use hemicube::radiosity::form_factor::{Cached, FormFactorKind, MatrixOptions};
use hemicube::radiosity::solve::ambient_irradiance;
use hemicube::radiosity::stop::NEVER;
use hemicube::radiosity::{
    PatchOptions, RadiosityError, RayCast, RayCastOptions, Solution, SolveOptions, SolverKind, Way,
    resume, resume_until, solve, solve_until, unlit,
};
use hemicube::scene::{Scene, builtin};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

fn small(solver: SolverKind) -> SolveOptions {
    SolveOptions {
        mesh: PatchOptions::default().with_elements(300).with_patches(80),
        hemicube: HemicubeOptions::default()
            .with_resolution(64)
            .with_max_points(1),
        rays: 64,
        tolerance: 1e-6,
        solver,
        ..SolveOptions::default()
    }
}

/// Those that come to the same numbers; what ends at an error has tests of its own.
fn exact() -> impl Iterator<Item = SolverKind> {
    let all = SolverKind::ALL.into_iter();
    all.filter(|kind| ![Way::Stochastic, Way::Hierarchical].contains(&kind.way()))
}

fn scene(name: &str) -> Arc<Scene> {
    Arc::new(builtin::scene(name).expect("it is built in"))
}

fn solved(options: &SolveOptions) -> Solution {
    solve(scene("cornell"), options, |_, _| true).expect("it can be solved")
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

/// Largest difference of an element's radiosity, over the brightest.
fn difference(a: &Solution, b: &Solution) -> f64 {
    let elements = 0..a.mesh().elements().len();
    let of = |s: &Solution, e: usize, band: usize| f64::from(s.element_radiosity(e)[band]);
    let all = elements.flat_map(|e| (0..3).map(move |band| (e, band)));
    let most = all
        .clone()
        .map(|(e, band)| of(b, e, band))
        .fold(0.0, f64::max);
    let errors = all.map(|(e, band)| (of(a, e, band) - of(b, e, band)).abs());
    errors.fold(0.0, f64::max) / most
}

#[test]
fn all_come_to_the_same_light_and_say_who_they_were() {
    for form_factors in FormFactorKind::ALL {
        let truth = solved(&SolveOptions {
            form_factors,
            ..small(SolverKind::SortedShooting)
        });
        for kind in exact() {
            let who = format!("{}, {}", kind.name(), form_factors.name());
            let options = SolveOptions {
                form_factors,
                ..small(kind)
            };
            let solution = solved(&options);
            assert_balanced(&solution, &who);
            assert!(solution.unshot_fraction() <= 1e-6, "{who}: finished");
            let error = difference(&solution, &truth);
            // What is unshot may be on one element and be reflected once more.
            assert!(error < 1e-5, "{who}: an element is off by {error:.1e}");
            let from = &solution.provenance;
            assert_eq!(from.solver, kind.name(), "the solver's name");
            assert_eq!(from.form_factors, form_factors.name(), "the way's name");
            assert!(from.steps > 0, "{who}: steps are counted");
        }
    }
}

/// Every solver with a GPU's form factors comes to the light of the CPU's hemicubes, but for cells at outlines.
#[cfg(feature = "gpu")]
#[test]
fn all_come_to_the_same_light_on_a_gpu() {
    use hemicube::gpu::Gpu;
    use hemicube::radiosity::solve_on;
    let Some(context) = hemicube_tests::gpu::context() else {
        return;
    };
    let backend = Gpu::new(context).with_required(true);
    // Without joints: shooting on the device counts their small parts as it draws them, to some percent.
    let with_hemicubes = |solver| SolveOptions {
        form_factors: FormFactorKind::Hemicube,
        mesh: small(solver).mesh.with_joints(false),
        ..small(solver)
    };
    let truth = solved(&with_hemicubes(SolverKind::SortedShooting));
    for kind in exact() {
        let options = with_hemicubes(kind);
        let solution = solve_on(scene("cornell"), &options, &backend, NEVER, |_, _| true)
            .expect("it can be solved");
        let who = format!("{} on the GPU", kind.name());
        for band in 0..3 {
            let unshot = solution.unshot_flux(band);
            let error = solution.total_balance(band).relative_error(unshot);
            // Where the light stays on the device, its sums are of f32.
            assert!(error < 1e-4, "{who}, band {band}: {error:.1e} is lost");
        }
        assert!(solution.unshot_fraction() <= 1e-6, "{who}: finished");
        let error = difference(&solution, &truth);
        println!("{who}: an element is off by {error:.1e}");
        // Shooting on the device counts small receivers, which others integrate.
        let bound = match kind {
            SolverKind::SortedShooting | SolverKind::AmbientShooting => 5e-3,
            _ => 1e-4,
        };
        assert!(error < bound, "{who}: an element is off by {error:.1e}");
        let from = &solution.provenance;
        assert_eq!(from.form_factors, "gpu", "{who}: the way's name");
    }
}

#[test]
fn any_goes_on_where_another_stopped() {
    let truth = solved(&small(SolverKind::SortedShooting));
    let mut solution = solved(&SolveOptions {
        max_steps: Some(10),
        ..small(SolverKind::SortedShooting)
    });
    for kind in exact() {
        let before = solution.clone();
        let options = SolveOptions {
            max_steps: Some(30),
            ..small(kind)
        };
        solution = resume(solution, &options, |_, _| true).expect("it goes on");
        assert_balanced(&solution, kind.name());
        let (left, was) = (solution.unshot_fraction(), before.unshot_fraction());
        assert!(
            left <= was * 1.01,
            "{}: {left:.1e} unshot of {was:.1e}",
            kind.name()
        );
        let done = small(kind);
        let end = resume(before, &done, |_, _| true).expect("it goes on");
        let error = difference(&end, &truth);
        assert!(
            error < 1e-5,
            "{} to the end: off by {error:.1e}",
            kind.name()
        );
    }
}

#[test]
fn limits_end_them_all_with_energy_kept() {
    for kind in SolverKind::ALL {
        for most in [1, 7] {
            let mut seen = 0;
            let options = SolveOptions {
                max_steps: Some(most),
                tolerance: 0.0,
                ..small(kind)
            };
            let solution = solve(scene("cornell"), &options, |progress, _| {
                seen = progress.iteration;
                true
            })
            .expect("it can be solved");
            assert_eq!(solution.provenance.steps, most, "{}", kind.name());
            assert_eq!(seen, most, "{}: the last state is told", kind.name());
            assert_balanced(&solution, kind.name());
        }
    }
}

#[test]
fn on_a_matrix_they_end_where_only_rounding_is_left() {
    for kind in SolverKind::ALL {
        let Way::OnMatrix(_) = kind.way() else {
            continue;
        };
        let options = SolveOptions {
            tolerance: 0.0,
            ..small(kind)
        };
        let mut steps = 0;
        let solution = solve(scene("cornell"), &options, |_, _| {
            steps += 1;
            steps < 100_000
        })
        .expect("it can be solved");
        let (name, left) = (kind.name(), solution.unshot_fraction());
        assert!(steps < 100_000, "{name} goes on with {left:.1e} unshot");
        assert!(left < 1e-6, "{name} gives up at {left:.1e}");
    }
}

#[test]
fn same_bits_on_one_and_two_threads() {
    for kind in SolverKind::ALL {
        let run = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
            let options = SolveOptions {
                max_steps: Some(150),
                ..small(kind)
            };
            let solution = pool
                .expect("threads can be started")
                .install(|| solved(&options));
            let bands = (0..3).flat_map(|band| solution.irradiance(0, band).to_vec());
            bands.map(f32::to_bits).collect::<Vec<u32>>()
        };
        assert!(
            run(1) == run(2),
            "{}: two threads give other bits",
            kind.name()
        );
    }
}

#[test]
fn light_that_never_settles_is_refused_by_all() {
    for kind in SolverKind::ALL {
        let mut closed = builtin::furnace_with(1.0, 1.0);
        closed.max_reflectance = 1.0;
        let error = solve(Arc::new(closed), &small(kind), |_, _| true).expect_err("refused");
        assert!(
            error.to_string().contains("never settles"),
            "{}: {error}",
            kind.name()
        );
    }
}

#[test]
fn matrices_beyond_the_limit_are_refused_with_what_fits() {
    let calls = AtomicUsize::new(0);
    for kind in SolverKind::ALL {
        let Way::OnMatrix(_) = kind.way() else {
            continue;
        };
        let options = SolveOptions {
            memory_limit: 20_000,
            ..small(kind)
        };
        let error = solve(scene("cornell"), &options, |_, _| {
            calls.fetch_add(1, Ordering::Relaxed);
            true
        })
        .expect_err("refused");
        let message = error.to_string();
        assert!(
            message.contains("MiB are allowed; use at most ") && message.contains("patches"),
            "{}: {message}",
            kind.name()
        );
        // What is said to fit does fit.
        let fits = message
            .split("at most ")
            .nth(1)
            .and_then(|rest| rest.split(' ').next());
        let fits: usize = fits.and_then(|n| n.parse().ok()).expect("a number");
        assert!((1..=99).contains(&fits), "{}: {message}", kind.name());
    }
    assert_eq!(calls.into_inner(), 0, "before any step");
}

#[test]
fn stopping_leaves_no_half_built_mesh_and_no_half_built_matrix() {
    let options = small(SolverKind::GaussSeidel);
    let error = solve_until(scene("cornell"), &options, &|| true, |_, _| true);
    let error = error.expect_err("there is nothing yet");
    assert!(matches!(error, RadiosityError::Stopped(_)), "{error}");
    // The sky's light takes rays, too.
    let mut lit = builtin::scene("cornell").expect("it is built in");
    lit.sky = hemicube::raster::Rgb::WHITE;
    let lit = Arc::new(lit);
    let asked = AtomicUsize::new(0);
    let count = || asked.fetch_add(1, Ordering::Relaxed) + 1;
    let started = unlit(lit.clone(), &options, &|| count() == 0);
    assert!(started.is_ok(), "nobody stops it");
    let all = asked.swap(0, Ordering::Relaxed);
    let Err(error) = unlit(lit, &options, &|| count() > all - 10) else {
        panic!("it is asked until the end, {all} times");
    };
    assert!(error.to_string().contains("first light"), "{error}");
    // While rows are computed, the light before is kept.
    let start = unlit(scene("cornell"), &options, NEVER).expect("a start");
    for kind in SolverKind::ALL {
        let stopped = resume_until(start.clone(), &small(kind), &|| true, |_, _| true);
        let stopped = stopped.unwrap_or_else(|e| panic!("{}: {e}", kind.name()));
        assert_eq!(stopped.unshot(0, 0), start.unshot(0, 0), "{}", kind.name());
        assert_balanced(&stopped, kind.name());
    }
}

#[test]
fn ambient_estimate_is_near_the_mean_of_what_is_missing() {
    for (name, most) in [("cornell", 0.1), ("two-rooms", 0.1), ("furnace", 0.01)] {
        let scene = scene(name);
        let at = |max_steps| {
            let options = SolveOptions {
                max_steps,
                ..small(SolverKind::SortedShooting)
            };
            solve(scene.clone(), &options, |_, _| true).expect("it can be solved")
        };
        let (part, whole) = (at(Some(40)), at(None));
        let (mut missing, mut area) = (0.0, 0.0);
        for e in 0..whole.mesh().elements().len() {
            let a = whole.mesh().exposed_area(e);
            missing += a * (whole.element_irradiance(e).g - part.element_irradiance(e).g);
            area += a;
        }
        let (estimate, missing) = (ambient_irradiance(&part).g, missing / area);
        println!("{name}: {estimate} for {missing}");
        assert!(
            (estimate / missing - 1.0).abs() < most,
            "{name}: {estimate} for {missing}"
        );
    }
}

#[test]
fn compared_variants_start_alike_and_those_that_shoot_well_are_ahead() {
    let options = small(SolverKind::default());
    let start = unlit(scene("cornell"), &options, NEVER).expect("a start");
    let factors = Cached::new(
        RayCast::new(start.mesh().clone(), RayCastOptions::default()),
        64 << 20,
    );
    let truth = converged(&factors, &start, 1e-7, |_, _| true);
    assert!(
        relative_error(&shown_radiosity(&truth, SolverKind::Shooting), &truth) < 1e-9,
        "itself"
    );
    let patches = start.mesh().patches().len();
    let of = |kind: SolverKind, steps: u64| {
        let matrix = MatrixOptions::default();
        let made = variant(&factors, &start, kind, steps, &truth, matrix, NEVER);
        made.expect("it can be done")
            .expect("nobody stops it")
            .errors
    };
    let mut after_30 = Vec::new();
    for kind in SolverKind::ALL {
        let errors = of(kind, 30);
        assert_eq!(errors.len(), 31, "{}: one for each step", kind.name());
        if kind != SolverKind::AmbientShooting {
            assert!(
                (errors[0] - 1.0).abs() < 1e-6,
                "{}: only lamps shine",
                kind.name()
            );
        }
        after_30.push((kind, errors[30]));
    }
    let error = |kind: SolverKind| {
        after_30
            .iter()
            .find(|a| a.0 == kind)
            .expect("it is there")
            .1
    };
    let (sorted, ambient) = (
        error(SolverKind::SortedShooting),
        error(SolverKind::AmbientShooting),
    );
    assert!(
        ambient < sorted,
        "the ambient term helps: {ambient} and {sorted}"
    );
    assert!(
        sorted < error(SolverKind::Shooting),
        "order helps: {after_30:?}"
    );
    assert!(
        sorted < error(SolverKind::Gathering),
        "shooting beats gathering: {after_30:?}"
    );
    let southwell = error(SolverKind::Southwell);
    assert!(
        (southwell - sorted).abs() < 0.02 * sorted,
        "Southwell is sorted shooting: {southwell} and {sorted}"
    );
    // Gathering, sweep by sweep, comes to the same light.
    let gathered = of(SolverKind::Gathering, 12 * patches as u64);
    let last = gathered[gathered.len() - 1];
    assert!(last < 1e-4, "gathering ends at {last:.1e}");
    let seidel = of(SolverKind::GaussSeidel, 2 * patches as u64);
    assert_eq!(
        seidel[patches - 1],
        seidel[0],
        "a sweep is paid before it is shown"
    );
    assert!(seidel[patches] < 0.5 * seidel[0], "then all of it");
}
