//! Adaptive subdivision: elements are cut where light varies over them, and light is computed anew on those.

use hemicube::radiosity::adaptive::contrasts;
use hemicube::radiosity::export::lit_glb::{self, LitGlbOptions};
use hemicube::radiosity::form_factor::FormFactorKind;
use hemicube::radiosity::primary::primary_irradiance;
use hemicube::radiosity::{
    AdaptiveOptions, Grouping, PatchOptions, Quality, Solution, SolveOptions, SolverKind, resume,
    solve,
};
use hemicube_tests::solutions::{balance_error, built_in, irradiance_bits};

fn options(solver: SolverKind) -> SolveOptions {
    SolveOptions {
        mesh: PatchOptions::default().with_elements(150).with_patches(40),
        rays: 16,
        noise: 0.1,
        solver,
        adaptive: Some(
            AdaptiveOptions::default()
                .with_contrast(0.4)
                .with_smallest(60.0),
        ),
        ..Quality::Draft.into()
    }
}

fn solved(scene: &str, options: &SolveOptions) -> Solution {
    solve(built_in(scene), options, |_, _| true).expect("it can be solved")
}

/// Mean irradiance over the exposed areas, in green.
fn mean(solution: &Solution) -> f64 {
    let mesh = solution.mesh();
    let (mut flux, mut areas) = (0.0, 0.0);
    for (e, &h) in solution.irradiance(0, 1).iter().enumerate() {
        let area = f64::from(mesh.exposed_area(e));
        flux += area * f64::from(h);
        areas += area;
    }
    flux / areas
}

#[test]
fn every_solver_brings_light_to_refined_elements() {
    let coarse = solved(
        "cornell",
        &SolveOptions {
            adaptive: None,
            ..options(SolverKind::SortedShooting)
        },
    );
    for kind in SolverKind::ALL {
        let solution = solved("cornell", &options(kind));
        let name = kind.name();
        let (mesh, before) = (solution.mesh(), coarse.mesh());
        assert_eq!(mesh.patches(), before.patches(), "{name}: the same patches");
        assert_eq!(
            mesh.unrefined_elements(),
            before.elements().len(),
            "{name}: of the same mesh"
        );
        assert!(
            mesh.elements().len() > 2 * before.elements().len(),
            "{name}: {} elements",
            mesh.elements().len()
        );
        let error = balance_error(&solution);
        // Rays do not close it exactly.
        let bound = if kind == SolverKind::Hierarchical {
            1e-4
        } else {
            1e-5
        };
        assert!(error < bound, "{name}: the balance is off by {error:.1e}");
        let ratio = mean(&solution) / mean(&coarse);
        assert!(
            (ratio - 1.0).abs() < 0.08,
            "{name}: {ratio} times the light"
        );
        assert!(
            solution.unshot_fraction() <= options(kind).tolerance,
            "{name}: it is finished"
        );
    }
}

/// Differences between the light of a refined solution and one from nothing on the same mesh, relative to the mean: their
/// root mean square, weighted by area, and the largest.
fn off_from_new(kind: FormFactorKind, rays: u32) -> [f64; 2] {
    let fine = SolveOptions {
        form_factors: kind,
        rays,
        tolerance: 1e-5,
        ..options(SolverKind::SortedShooting)
    };
    let solution = solved("cornell", &fine);
    let mesh = solution.mesh().clone();
    let primary = primary_irradiance(&mesh, fine.rays, fine.seed);
    let unlit = Solution::new(mesh.clone(), &primary, Grouping::Together);
    let plain = SolveOptions {
        adaptive: None,
        ..fine
    };
    let anew = resume(unlit, &plain, |_, _| true).expect("it goes on");
    let (mut squares, mut areas, mut largest) = (0.0, 0.0, 0.0);
    for e in (0..mesh.elements().len()).filter(|&e| mesh.exposed_area(e) > 0.0) {
        let area = f64::from(mesh.exposed_area(e));
        let off = solution.element_irradiance(e).g - anew.element_irradiance(e).g;
        let off = f64::from(off) / mean(&anew);
        squares += area * off * off;
        areas += area;
        largest = f64::max(largest, off.abs());
    }
    [(squares / areas).sqrt(), largest]
}

#[test]
fn light_on_refined_elements_is_that_of_a_new_solution() {
    // All rows are asked for again: the same light up to what stays unshot.
    let [rms, largest] = off_from_new(FormFactorKind::Hemisphere, 16);
    assert!(largest < 1e-3, "rows: {rms}, largest {largest}");
    // Elements keep light or receive it by pairs that are drawn: the same but for the noise of rays, which is
    // mostly that of the old elements in penumbrae, whose light as a whole is kept.
    let [rms, largest] = off_from_new(FormFactorKind::RayCast, 256);
    println!("pairs: RMS {rms:.4}, largest {largest:.3}");
    assert!(
        rms < 0.03 && largest < 0.3,
        "pairs: {rms}, largest {largest}"
    );
}

#[test]
fn elements_with_contrast_are_cut_and_flat_ones_are_not() {
    let furnace = solved(
        "furnace",
        &SolveOptions {
            adaptive: Some(AdaptiveOptions::default().with_contrast(0.02)),
            ..options(SolverKind::SortedShooting)
        },
    );
    let mesh = furnace.mesh();
    assert_eq!(
        mesh.elements().len(),
        mesh.unrefined_elements(),
        "the same light everywhere"
    );

    let plain = options(SolverKind::SortedShooting);
    let adaptive = plain.adaptive.expect("it was asked for");
    let before = solved(
        "cornell",
        &SolveOptions {
            adaptive: None,
            ..plain
        },
    );
    let plan = adaptive.plan(&before).expect("there are shadows");
    let finer = before
        .mesh()
        .with_refinement(&plan.refinement, &|| false)
        .expect("it fits");
    let contrasts = contrasts(&before);
    let is_cut = |e: usize| finer.element_of_node(before.mesh().elements()[e]).is_none();
    let are_longer = before.mesh().are_longer(60.0);
    let (mut over, mut over_cut, mut flat, mut flat_cut) = (0, 0, 0, 0);
    for (e, &contrast) in contrasts.iter().enumerate() {
        if contrast > 0.4 {
            over += usize::from(are_longer[e]);
            over_cut += usize::from(are_longer[e] && is_cut(e));
        } else if contrast < 0.2 {
            flat += 1;
            flat_cut += usize::from(is_cut(e));
        }
    }
    let left = adaptive.left(&before);
    assert!(
        over_cut >= left.elements - left.smallest && over_cut * 2 > over,
        "{over_cut} of {over} elements with contrast are cut, {left:?}"
    );
    // Transitions next to what is cut.
    assert!(
        flat_cut * 2 < flat,
        "{flat_cut} of {flat} flat elements are cut"
    );
}

#[test]
fn the_same_on_any_number_of_threads() {
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .expect("threads");
        pool.install(|| solved("cornell", &options(SolverKind::AmbientShooting)))
    };
    let (one, three) = (run(1), run(3));
    assert_eq!(
        one.mesh().elements(),
        three.mesh().elements(),
        "the same elements"
    );
    assert_eq!(
        irradiance_bits(&one),
        irradiance_bits(&three),
        "the same light"
    );
}

#[test]
fn a_lit_file_keeps_the_mesh() {
    let solution = solved("cornell", &options(SolverKind::SortedShooting));
    let file = lit_glb::write(&solution, &LitGlbOptions::default()).expect("it can be written");
    let read = lit_glb::read(&file).expect("it can be read");
    assert_eq!(
        read.mesh().elements(),
        solution.mesh().elements(),
        "the same elements"
    );
    assert_eq!(
        irradiance_bits(&read),
        irradiance_bits(&solution),
        "the same light"
    );
    let further = SolveOptions {
        tolerance: 1e-5,
        adaptive: None,
        ..options(SolverKind::SortedShooting)
    };
    let [one, other] =
        [read, solution].map(|s| resume(s, &further, |_, _| true).expect("it goes on"));
    assert_eq!(
        irradiance_bits(&one),
        irradiance_bits(&other),
        "and goes on the same way"
    );
    let finer = SolveOptions {
        adaptive: Some(
            AdaptiveOptions::default()
                .with_contrast(0.3)
                .with_smallest(30.0),
        ),
        ..further
    };
    let elements = one.mesh().elements().len();
    let finer = resume(one, &finer, |_, _| true).expect("it goes on");
    assert!(finer.mesh().elements().len() > elements, "refined further");
}

#[test]
fn a_damaged_mesh_in_a_file_is_refused() {
    let solution = solved("cornell", &options(SolverKind::SortedShooting));
    let file = lit_glb::write(&solution, &LitGlbOptions::default()).expect("it can be written");
    let text = String::from_utf8_lossy(&file);
    let at = text.find("\"refinement\":").expect("it is kept");
    // Another buffer view in its place, of the same number of digits.
    let digits: String = text[at + 13..]
        .chars()
        .take_while(char::is_ascii_digit)
        .collect();
    let mut damaged = file.clone();
    let start = file
        .windows(13)
        .position(|w| w == b"\"refinement\":")
        .expect("it is kept")
        + 13;
    damaged[start..start + digits.len()].fill(b'0');
    damaged[start + digits.len() - 1] = b'1';
    let error = lit_glb::read(&damaged)
        .expect_err("it is damaged")
        .to_string();
    assert!(
        error.contains("solve the scene again") && !error.contains('\n'),
        "{error}"
    );
}

#[test]
fn limits_are_kept() {
    let few = SolveOptions {
        adaptive: Some(
            AdaptiveOptions::default()
                .with_contrast(0.1)
                .with_most_elements(900),
        ),
        ..options(SolverKind::SortedShooting)
    };
    let solution = solved("cornell", &few);
    let elements = solution.mesh().elements().len();
    assert!((600..=900).contains(&elements), "{elements} elements");
    let steps = SolveOptions {
        max_steps: Some(40),
        ..options(SolverKind::SortedShooting)
    };
    let solution = solved("cornell", &steps);
    assert_eq!(
        solution.provenance.steps, 40,
        "no round after the last step"
    );
    assert_eq!(
        solution.mesh().elements().len(),
        solution.mesh().unrefined_elements(),
        "of an unfinished light"
    );
}

#[test]
fn what_makes_no_sense_is_refused_before_the_work() {
    let adaptive = AdaptiveOptions::default();
    let refused = [
        adaptive.with_contrast(0.0),
        adaptive.with_contrast(-1.0),
        adaptive.with_contrast(1.0),
        adaptive.with_contrast(f32::NAN),
        adaptive.with_smallest(0.0),
        adaptive.with_smallest(f32::INFINITY),
        adaptive.with_most_elements(0),
    ];
    for adaptive in refused {
        let options = SolveOptions {
            adaptive: Some(adaptive),
            ..options(SolverKind::SortedShooting)
        };
        let mut steps = 0;
        let error = solve(built_in("cornell"), &options, |_, _| {
            steps += 1;
            true
        });
        let error = error.expect_err("it is refused").to_string();
        assert!(steps == 0 && !error.contains('\n'), "{adaptive:?}: {error}");
    }
}
