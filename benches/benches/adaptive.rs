//! Adaptive subdivision against uniform meshes: elements to the same error of what pictures show.
//!
//! The truth is light that is gathered from a fine solution at places spread over all surfaces.

use cpu_time::ProcessTime;
use hemicube::radiosity::{AdaptiveOptions, PatchOptions, Solution, SolveOptions, solve};
use hemicube_tests::shown_light::{Gathered, gathered, shown_error};
use hemicube_tests::solutions::built_in;

const UNIFORM: [usize; 4] = [1000, 4000, 16_000, 64_000];
const CONTRASTS: [f32; 3] = [0.4, 0.2, 0.1];
/// Elements before any refinement.
const FIRST: usize = 1000;
const PLACES: usize = 4000;
const GATHERED_RAYS: u32 = 2048;

/// Elements and error of a mesh.
type Figure = (f64, f64);

fn main() {
    for scene in ["cornell", "two-rooms"] {
        let truth = gathered(&solved(scene, 16_000, None), PLACES, GATHERED_RAYS);
        println!("{scene}: RMS error of {PLACES} places, relative to the mean");
        let uniform: Vec<Figure> = UNIFORM
            .iter()
            .map(|&elements| figure(scene, "uniform", elements, None, &truth))
            .collect();
        for contrast in CONTRASTS {
            let adaptive = AdaptiveOptions::default().with_contrast(contrast);
            let name = format!("contrast {contrast}");
            let (elements, error) = figure(scene, &name, FIRST, Some(adaptive), &truth);
            println!("  {}", compared(&uniform, elements, error));
        }
    }
}

fn solved(scene: &str, elements: usize, adaptive: Option<AdaptiveOptions>) -> Solution {
    let options = SolveOptions {
        mesh: PatchOptions::default()
            .with_elements(elements)
            .with_patches(400),
        adaptive,
        ..SolveOptions::default()
    };
    solve(built_in(scene), &options, |_, _| true).expect("it can be solved")
}

fn figure(
    scene: &str,
    name: &str,
    elements: usize,
    adaptive: Option<AdaptiveOptions>,
    truth: &[Gathered],
) -> Figure {
    let start = ProcessTime::now();
    let solution = solved(scene, elements, adaptive);
    let seconds = start.elapsed().as_secs_f64();
    let error = shown_error(&solution, truth);
    assert!(error < 0.5, "{scene}, {name}: error {error}");
    let count = solution.mesh().elements().len();
    println!(
        "  {name:14} {count:7} elements, error {:5.2} %, {seconds:5.1} CPU seconds",
        100.0 * error
    );
    (count as f64, error)
}

/// How many elements a uniform mesh of the same error would have, by the line through the last figures that it lies
/// between or beyond, in logarithms.
fn compared(uniform: &[Figure], elements: f64, error: f64) -> String {
    let last = uniform.len() - 2;
    let i = (0..last)
        .find(|&i| uniform[i + 1].1 < error)
        .unwrap_or(last);
    let ((n0, e0), (n1, e1)) = (uniform[i], uniform[i + 1]);
    let exponent = (n1 / n0).ln() / (e1 / e0).ln();
    let same = n0 * (error / e0).powf(exponent);
    let beyond = if error < uniform[last + 1].1 {
        ", beyond what was measured"
    } else {
        ""
    };
    format!(
        "a uniform mesh of this error has {same:.0} elements, {:.1} times as many{beyond}",
        same / elements
    )
}
