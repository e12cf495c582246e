//! Radiosity by links: exact light within the error that it states, energy kept, links in proportion to the elements.

use hemicube::radiosity::form_factor::FormFactorKind;
use hemicube::radiosity::{
    Hierarchical, HierarchicalOptions, MaterialEdit, PatchOptions, Quality, RadiosityError,
    Solution, SolveOptions, Solver, SolverKind, resume, solve,
};
use hemicube::raster::Rgb;
use hemicube::scene::{Material, Scene, builtin};
use hemicube_tests::enclosures::room_with_cube;
use hemicube_tests::solutions::{
    balance_error, begun_and_done, built_in, exhausted, irradiance_bits, start,
};
use std::sync::Arc;

fn with_error(error: f64) -> HierarchicalOptions {
    HierarchicalOptions {
        error,
        ..HierarchicalOptions::default()
    }
}

fn solved(start: &Solution, options: HierarchicalOptions) -> Hierarchical {
    exhausted(Hierarchical::new(start.clone(), options).expect("good options"))
}

/// Root mean square over the area, relative to each element's irradiance or a twentieth of the mean.
fn relative_difference(a: &Solution, b: &Solution) -> f64 {
    let mesh = a.mesh();
    let elements = 0..mesh.elements().len();
    let area = |e: usize| f64::from(mesh.exposed_area(e));
    let total = |s: &Solution, e: usize| -> f64 {
        let h = s.element_irradiance(e).to_array();
        h.iter().map(|&x| f64::from(x)).sum()
    };
    let all: f64 = elements.clone().map(area).sum();
    let mean = elements.clone().map(|e| total(b, e) * area(e)).sum::<f64>() / all;
    let square = |e: usize| {
        let least = total(b, e).max(0.05 * mean);
        ((total(a, e) - total(b, e)) / least).powi(2) * area(e)
    };
    (elements.map(square).sum::<f64>() / all).sqrt()
}

/// The full matrix on the same mesh, each element a patch.
fn by_matrix(start: &Solution) -> Solution {
    let options = SolveOptions {
        form_factors: FormFactorKind::Analytic,
        tolerance: 1e-6,
        solver: SolverKind::GaussSeidel,
        ..Quality::Draft.into()
    };
    resume(start.clone(), &options, |_, _| true).expect("it can be solved")
}

#[test]
fn a_furnace_is_as_bright_everywhere_as_it_must_be() {
    for reflectance in [0.0, 0.5, 0.8] {
        let start = start(Arc::new(builtin::furnace_with(reflectance, 1.0)), 200, 50);
        let solver = solved(&start, with_error(0.01));
        let exact = 1.0 / (1.0 - reflectance);
        let solution = solver.solution();
        for e in 0..solution.mesh().elements().len() {
            let b = solution.element_radiosity(e).g;
            let error = (b / exact - 1.0).abs();
            assert!(
                error < 0.01,
                "ρ {reflectance}, element {e}: {b} for {exact}"
            );
        }
        let error = balance_error(solution);
        assert!(
            error < 1e-6,
            "ρ {reflectance}: {error:.1e} of the energy is lost"
        );
    }
}

#[test]
fn plates_exchange_what_the_closed_form_says() {
    for name in ["parallel-plates", "perpendicular-plates"] {
        // Each plate cut finely, so that links between parts have to sum to the whole.
        let start = start(built_in(name), 300, 300);
        let exact = by_matrix(&start);
        let solver = solved(&start, with_error(0.005));
        for band in 0..3 {
            let flux = |s: &Solution| -> f64 {
                let h = s.irradiance(0, band).iter().enumerate();
                h.map(|(e, &h)| f64::from(h) * f64::from(s.mesh().exposed_area(e)))
                    .sum()
            };
            let (found, wanted) = (flux(solver.solution()), flux(&exact));
            assert!(
                (found / wanted - 1.0).abs() < 2e-3,
                "{name}, band {band}: {found} arrives, {wanted} by closed form"
            );
        }
        let error = relative_difference(solver.solution(), &exact);
        assert!(error < 0.015, "{name}: elements differ by {error:.4}");
    }
}

/// A room with a glowing cube that floats in it and hides half of the room from the other.
fn room_with_lamp() -> Arc<Scene> {
    let mut scene = room_with_cube(3, 1);
    scene.materials.push(Material {
        name: String::from("lamp"),
        emission: Rgb::WHITE,
        ..Material::default()
    });
    scene.meshes[1].material = 1;
    Arc::new(scene)
}

#[test]
fn the_error_falls_with_its_limit_and_is_about_the_stated_one() {
    // Where boxes stand on floors, exact factors of large elements are another thing than those of sampled points.
    for (scene, most) in [(room_with_lamp(), 0.01), (built_in("cornell"), 0.08)] {
        let start = start(scene, 200, 200);
        let exact = by_matrix(&start);
        let name = &start.mesh().scene().name;
        let mut errors = Vec::new();
        for limit in [0.4, 0.1, 0.03] {
            let solver = solved(&start, with_error(limit));
            let (error, stated) = (
                relative_difference(solver.solution(), &exact),
                solver.error(),
            );
            println!("{name}: wanted {limit}, stated {stated:.4}, is {error:.4}");
            assert!(stated <= limit, "{name}: it ends at its error");
            assert!(
                error < 1.5 * stated + most,
                "{name}: error {error:.4}, stated {stated:.4}"
            );
            errors.push(error);
        }
        assert!(errors[2] < 0.6 * errors[0], "{name}: {errors:.4?}");
    }
}

#[test]
fn every_step_keeps_the_energy() {
    // Open, with panes, lit by sun and sky, by points, with light groups.
    for name in ["cornell", "chapel", "office", "two-rooms"] {
        let start = start(built_in(name), 250, 100);
        let mut solver = Hierarchical::new(start, with_error(0.1)).expect("good options");
        for step in 0..7 {
            solver.step();
            let error = balance_error(solver.solution());
            assert!(error < 1e-5, "{name}, step {step}: {error:.1e} is lost");
        }
    }
}

#[test]
fn links_grow_with_the_elements_and_not_with_their_square() {
    let mut last: Option<(usize, usize)> = None;
    for elements in [400, 1600, 6400] {
        let start = start(built_in("cornell"), elements, elements);
        let links = solved(&start, with_error(0.1)).links().all;
        let elements = start.mesh().elements().len();
        println!("{elements} elements, {links} links");
        assert!(
            links < 30 * elements,
            "{links} links of {elements} elements"
        );
        if let Some((elements_before, links_before)) = last {
            let growth = (links as f64 / links_before as f64).ln()
                / (elements as f64 / elements_before as f64).ln();
            assert!(
                growth < 1.1,
                "links grow with the power {growth:.2} of the elements"
            );
        }
        last = Some((elements, links));
    }
}

#[test]
fn many_small_faces_begin_with_one_link() {
    let start = start(built_in("conference-room"), 100, 100);
    let faces = start.mesh().faces().len();
    let mut solver = Hierarchical::new(start, with_error(0.3)).expect("good options");
    assert_eq!(solver.links().all, 1, "from the root to itself");
    let mut before = 1;
    for _ in 0..3 {
        solver.step();
        let links = solver.links().all;
        assert!(links >= before, "{links} links after {before}");
        assert!(links < faces * 10, "{links} links between {faces} faces");
        before = links;
    }
}

#[test]
fn same_bits_on_one_and_three_threads() {
    let start = start(built_in("two-rooms"), 400, 100);
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        let pool = pool.expect("threads");
        let solver = pool.install(|| solved(&start, with_error(0.1)));
        let solution = solver.solution();
        irradiance_bits(solution)
    };
    assert!(run(1) == run(3), "three threads give other bits");
}

#[test]
fn what_another_solver_left_is_spread() {
    let start = start(built_in("cornell"), 400, 400);
    let [half, truth] = begun_and_done(start);
    let by_links = SolveOptions {
        solver: SolverKind::Hierarchical,
        noise: 0.02,
        tolerance: 1e-4,
        ..Quality::Draft.into()
    };
    let end = resume(half, &by_links, |_, _| true).expect("it goes on");
    assert!(end.unshot_fraction() <= by_links.tolerance, "all is spread");
    let difference = relative_difference(&end, &truth);
    assert!(difference < 0.05, "it differs by {difference:.4}");
    let error = balance_error(&end);
    assert!(error < 1e-5, "{error:.1e} of the energy is lost");
    assert_eq!(
        end.provenance.noise, None,
        "of light of others it knows no error"
    );
}

#[test]
fn it_goes_on_where_it_stopped() {
    let options = SolveOptions {
        mesh: PatchOptions::default().with_elements(400),
        solver: SolverKind::Hierarchical,
        ..Quality::Draft.into()
    };
    let some = SolveOptions {
        max_steps: Some(4),
        ..options
    };
    let part = solve(built_in("cornell"), &some, |_, _| true).expect("it is solved");
    assert_eq!(part.provenance.steps, 4, "steps");
    let left = part.unshot_fraction();
    let end = resume(part, &options, |_, _| true).expect("it goes on");
    assert!(end.provenance.steps > 4, "steps are counted on");
    assert!(
        end.unshot_fraction() <= options.tolerance && left > options.tolerance,
        "{left} was left"
    );
    let error = balance_error(&end);
    assert!(error < 1e-5, "{error:.1e} of the energy is lost");
}

#[test]
fn a_lamp_that_is_dimmed_takes_its_light_back() {
    let room = built_in("cornell");
    let start = start(room.clone(), 300, 300);
    let bright = solved(&start, with_error(0.02)).into_solution();
    let materials = &room.materials;
    let lamp = materials.iter().position(|m| m.emits()).expect("a lamp");
    let dark = materials[lamp].emission * 0.25;
    let edit = MaterialEdit::new(lamp).with_emission(dark);
    let mesh = Arc::new(bright.mesh().edited(&edit).expect("it can be edited"));
    let dimmed = solved(&bright.relit(mesh, |_| 0), with_error(0.02)).into_solution();
    let bright = solved(&start, with_error(0.02)).into_solution();
    for e in (0..dimmed.mesh().elements().len()).step_by(7) {
        let (h, before) = (
            dimmed.element_irradiance(e).g,
            bright.element_irradiance(e).g,
        );
        assert!(
            // Links are refined for the whole room: a small dark part of an element may be off by more than the rest.
            (h - 0.25 * before).abs() <= 0.08 * before,
            "element {e}: {h} of {before}"
        );
    }
}

#[test]
fn built_in_scenes_come_to_an_end() {
    for builtin in builtin::list() {
        // Meshes of the largest take longer than tests may; the bench solves them.
        if ["theatre", "steel-mill"].contains(&builtin.name) {
            continue;
        }
        let start = start(built_in(builtin.name), 150, 50);
        let solver = solved(&start, with_error(0.5));
        let (name, error) = (builtin.name, solver.error());
        assert!(error <= 0.5, "{name}: ends at {error}");
        let solution = solver.solution();
        assert!(
            solution.unshot_fraction() < 1e-3,
            "{name}: little is unshot"
        );
        let brightest = solution
            .irradiance(0, 1)
            .iter()
            .fold(0.0, |a: f32, &b| a.max(b));
        assert!(
            brightest > 0.0 && brightest.is_finite(),
            "{name}: {brightest}"
        );
    }
}

#[test]
fn options_that_are_none_and_meshes_that_do_not_fit_are_refused() {
    let start = start(built_in("cornell"), 100, 50);
    let good = HierarchicalOptions::default();
    let wrong = [
        HierarchicalOptions { rays: 0, ..good },
        with_error(0.0),
        with_error(f64::NAN),
        with_error(-1.0),
    ];
    for options in wrong {
        let refused = Hierarchical::new(start.clone(), options).is_err();
        assert!(refused, "{options:?}");
    }
    let small = HierarchicalOptions {
        memory_limit: 10_000,
        ..good
    };
    let error = Hierarchical::new(start.clone(), small).expect_err("refused");
    assert!(
        matches!(&error, RadiosityError::Option(m) if m.contains("use at most")),
        "{error}"
    );
    // What fits is refined until it does not fit any more.
    let some = HierarchicalOptions {
        memory_limit: 100_000,
        error: 1e-6,
        ..good
    };
    let solver = solved(&start, some);
    assert!(solver.is_at_limit(), "it ends where links fill the memory");
    let bytes = solver.links().all * 24;
    assert!(bytes < 100_000, "{bytes} bytes");
}

#[test]
fn the_strongest_links_begin_at_the_lamp() {
    let start = start(built_in("cornell"), 300, 100);
    let solver = solved(&start, with_error(0.1));
    let links = solver.strongest_links(20);
    assert_eq!(links.len(), 20, "as many as were asked for");
    for pair in links.windows(2) {
        assert!(pair[0].flux >= pair[1].flux, "in their order");
    }
    // The box is 548.8 high, and the lamp hangs under its ceiling.
    assert!(links[0].from.y > 540.0, "{:?}", links[0]);
}
