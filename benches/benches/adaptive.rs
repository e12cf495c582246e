//! Adaptive subdivision against uniform meshes: elements to the same error of what pictures show.
//!
//! The truth is light that is gathered from a fine solution at places spread over all surfaces.

use cpu_time::ProcessTime;
use hemicube::radiosity::{AdaptiveOptions, PatchOptions, Solution, SolveOptions, solve};
use hemicube_tests::shown_light::{Gathered, gathered, shown_error};
use hemicube_tests::solutions::built_in;

/// What is compared in a scene.
struct Room {
    name: &'static str,
    /// Elements asked for of uniform meshes; the last but one is what the truth is gathered from.
    uniform: &'static [usize],
    /// Most elements of adaptive ones.
    limits: &'static [usize],
}

const ROOMS: [Room; 3] = [
    Room {
        name: "cornell",
        uniform: &[1000, 4000, 16_000, 64_000],
        limits: &[2000, 4000, 8000],
    },
    Room {
        name: "two-rooms",
        uniform: &[1000, 4000, 16_000, 64_000],
        limits: &[2000, 4000, 8000],
    },
    // Its faces have 13,093 lit sides.
    Room {
        name: "office",
        uniform: &[1000, 16_000, 64_000],
        limits: &[20_000, 40_000],
    },
];
/// Low enough that the number of elements decides.
const CONTRAST: f32 = 0.02;
/// Contrasts that decide where there is no limit of elements.
const CONTRASTS: [f32; 2] = [0.2, 0.1];
/// Elements asked for before any refinement.
const FIRST: usize = 1000;
const PLACES: usize = 4000;
const GATHERED_RAYS: u32 = 2048;

/// Elements and error of a mesh.
type Figure = (f64, f64);

fn main() {
    let only = std::env::args().skip(1).find(|arg| !arg.starts_with('-'));
    for room in ROOMS {
        let scene = room.name;
        if only.as_ref().is_some_and(|only| only != scene) {
            continue;
        }
        let fine = room.uniform[room.uniform.len() - 2];
        let truth = gathered(&solved(scene, fine, None), PLACES, GATHERED_RAYS);
        println!("{scene}: RMS error of {PLACES} places, relative to the mean");
        let uniform: Vec<Figure> = room
            .uniform
            .iter()
            .map(|&elements| figure(scene, "uniform", elements, None, &truth))
            .collect();
        for &limit in room.limits {
            let adaptive = AdaptiveOptions::default()
                .with_contrast(CONTRAST)
                .with_most_elements(limit);
            let (elements, error) = figure(scene, "adaptive", FIRST, Some(adaptive), &truth);
            println!("  {}", compared(&uniform, elements, error));
        }
        for contrast in CONTRASTS {
            let adaptive = AdaptiveOptions::default().with_contrast(contrast);
            let name = format!("{contrast}");
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
        "  {name:8} {count:7} elements, error {:5.2} %, {seconds:5.1} CPU seconds",
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
