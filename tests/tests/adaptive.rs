//! Adaptive subdivision: light is computed anew on elements that are cut where it varies.

use hemicube::radiosity::form_factor::FormFactorKind;
use hemicube::radiosity::{AdaptiveOptions, PatchOptions, Quality, Solution, SolveOptions, solve};
use hemicube_tests::shown_light::ShownLight;
use hemicube_tests::solutions::built_in;
use hemicube_tests::{reference_points, rms_error};

fn shown_error(solution: &Solution, scene: &str) -> f64 {
    let shown = ShownLight::new(solution);
    let points = reference_points(scene);
    let found: Vec<_> = points
        .iter()
        .map(|p| shown.irradiance(p.point, p.normal).expect("a surface"))
        .collect();
    rms_error(&points, &found)
}

#[test]
fn proof() {
    for scene in ["cornell", "two-rooms"] {
        for elements in [4000, 16000] {
            let options = SolveOptions {
                mesh: PatchOptions::default()
                    .with_elements(elements)
                    .with_patches(400),
                ..SolveOptions::default()
            };
            let start = std::time::Instant::now();
            let solution = solve(built_in(scene), &options, |_, _| true).expect("solved");
            println!(
                "{scene} uniform {:6} {:5} patches error {:.4} {:.1?}",
                solution.mesh().elements().len(),
                solution.mesh().patches().len(),
                shown_error(&solution, scene),
                start.elapsed()
            );
        }
        for elements in [500] {
            for contrast in [0.2, 0.1] {
                let options = SolveOptions {
                    mesh: PatchOptions::default()
                        .with_elements(elements)
                        .with_patches(400),
                    adaptive: Some(AdaptiveOptions::default().with_contrast(contrast)),
                    ..SolveOptions::default()
                };
                let start = std::time::Instant::now();
                let solution = solve(built_in(scene), &options, |_, _| true).expect("solved");
                let balance = hemicube_tests::solutions::balance_error(&solution);
                println!(
                    "{scene} adaptive {contrast} {:6} of {} error {:.4} {:.1?} balance {balance:.1e} steps {} left {:?}",
                    solution.mesh().elements().len(),
                    elements,
                    shown_error(&solution, scene),
                    start.elapsed(),
                    solution.provenance.steps,
                    options.adaptive.unwrap().left(&solution)
                );
            }
        }
    }
}
