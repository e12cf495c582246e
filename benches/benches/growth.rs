//! How the time of each solver grows with the number of elements: a table, fitted powers and a picture of the curves.
//!
//! Every solver solves one scene in meshes from 1000 elements on, until it takes longer than [`PATIENCE`] or wants too many.
//! Time counts from the scene to its light, the mesh included; the power is fitted through the sizes from [`FITTED_FROM`] on.
//! Names behind `--` choose scenes.

use hemicube::radiosity::{
    PatchOptions, Quality, Solution, SolveOptions, Solver, SolverKind, Stochastic, resume, unlit,
};
use hemicube::scene::{Scene, builtin};
use hemicube_chart::{Chart, Curve, Scale};
use hemicube_tests::solutions::balance_error;
use std::sync::Arc;
use std::time::Instant;

/// Seconds after which a solver is not asked for more elements.
const PATIENCE: f64 = 100.0;
/// Elements that are asked for, as far as a solver goes.
const SIZES: [usize; 7] = [1000, 3000, 10_000, 30_000, 100_000, 300_000, 1_000_000];
/// Below, what does not grow with the scene counts, too.
const FITTED_FROM: usize = 9000;
/// Elements on a patch, where it is for patches to shoot; and where they are for interreflected light that rays carry, as
/// the program has it.
const ELEMENTS_OF_PATCH: usize = 10;
const ELEMENTS_OF_GATHERING_PATCH: usize = 20;
/// What the solvers stop at: a share of the flux, and an estimated error.
const TOLERANCE: f64 = 1e-3;
const NOISE: f64 = 0.1;

/// A way to the light, the most elements it is asked for, and elements on its patches.
const WAYS: [(&str, SolverKind, usize, usize); 4] = [
    ("full matrix", SolverKind::GaussSeidel, 10_000, 1),
    (
        "shooting",
        SolverKind::AmbientShooting,
        300_000,
        ELEMENTS_OF_PATCH,
    ),
    (
        "links",
        SolverKind::Hierarchical,
        300_000,
        ELEMENTS_OF_PATCH,
    ),
    (
        "rays alone",
        SolverKind::Stochastic,
        1_000_000,
        ELEMENTS_OF_GATHERING_PATCH,
    ),
];

/// A solve that was timed.
struct Timed {
    elements: usize,
    seconds: f64,
}

fn main() {
    let asked: Vec<String> = std::env::args()
        .skip(1)
        .filter(|arg| !arg.starts_with('-'))
        .collect();
    let scenes = if asked.is_empty() {
        vec![String::from("cornell")]
    } else {
        asked
    };
    for name in scenes {
        let scene = builtin::scene(&name).expect("the name of a built-in scene");
        grow(&name, &Arc::new(scene));
    }
}

fn grow(name: &str, scene: &Arc<Scene>) {
    println!("{name}: tolerance {TOLERANCE}, noise {NOISE}");
    let mut curves = Vec::new();
    for (way, kind, most, elements_of_patch) in WAYS {
        let mut found: Vec<Timed> = Vec::new();
        for wanted in SIZES.into_iter().filter(|&wanted| wanted <= most) {
            if found.last().is_some_and(|timed| timed.seconds > PATIENCE) {
                break;
            }
            let timed = time(way, scene, kind, wanted, elements_of_patch);
            // Scenes of many faces have no coarser mesh than one element a face.
            let is_larger = found
                .last()
                .is_none_or(|last| timed.elements > last.elements + last.elements / 10);
            if is_larger {
                found.push(timed);
            }
        }
        let label = match power(&found) {
            Some(power) => format!("{way}, n^{power:.2}"),
            None => String::from(way),
        };
        println!("{label}");
        let points = found
            .iter()
            .map(|timed| (timed.elements as f64, timed.seconds));
        curves.push(Curve::new(label, points.collect()));
    }
    let chart = Chart {
        title: format!("{name}: time of a solve"),
        x_label: String::from("elements"),
        y_label: String::from("seconds"),
        x_scale: Scale::Logarithmic,
        y_scale: Scale::Octaves,
        curves,
    };
    let path = std::env::temp_dir().join(format!("hemicube-growth-{name}.png"));
    let picture = chart.draw(900, 540).png().expect("a picture");
    std::fs::write(&path, picture).expect("a file that can be written");
    println!("wrote {}", path.display());
}

/// Times a solve, and prints how it went.
fn time(
    way: &str,
    scene: &Arc<Scene>,
    solver: SolverKind,
    elements: usize,
    elements_of_patch: usize,
) -> Timed {
    let options = SolveOptions {
        mesh: PatchOptions::default()
            .with_elements(elements)
            .with_patches(elements / elements_of_patch),
        solver,
        tolerance: TOLERANCE,
        noise: NOISE,
        ..Quality::Normal.into()
    };
    let start = Instant::now();
    let unlit = unlit(scene.clone(), &options, &|| false).expect("a mesh");
    let elements = unlit.mesh().elements().len();
    let meshed = start.elapsed().as_secs_f64();
    let (note, error) = if solver == SolverKind::Stochastic {
        by_stages(unlit, &options)
    } else {
        let solution = resume(unlit, &options, |_, _| true).expect("it can be solved");
        let rays = solution.provenance.rays as f64 / 1e6;
        (format!("{rays:.1} M rays"), balance_error(&solution))
    };
    let seconds = start.elapsed().as_secs_f64();
    // A fast wrong answer counts for nothing.
    assert!(error < 1e-4, "{way}: {error:.1e} of the energy is lost");
    println!("{way}, {elements} elements: {seconds:.2} s, {meshed:.2} s of them the mesh, {note}");
    Timed { elements, seconds }
}

/// Solves by rays alone; says what its stages cost.
fn by_stages(unlit: Solution, options: &SolveOptions) -> (String, f64) {
    let mut solver =
        Stochastic::new(unlit, options.stochastic_options()).expect("options that it takes");
    while !solver.is_exhausted() {
        solver.step();
    }
    let rates = solver.stages().named().map(|(name, stage)| {
        let (rays, rate) = (stage.rays as f64 / 1e6, stage.rate() / 1e6);
        format!("{name} {rays:.1} M at {rate:.2} M/s")
    });
    let note = format!("noise {:.3}; rays: {}", solver.noise(), rates.join(", "));
    (note, balance_error(solver.solution()))
}

/// Exponent of a power law through the sizes that count, by least squares of their logarithms, if there are three.
fn power(found: &[Timed]) -> Option<f64> {
    let logs: Vec<(f64, f64)> = found
        .iter()
        .filter(|timed| timed.elements >= FITTED_FROM)
        .map(|timed| ((timed.elements as f64).ln(), timed.seconds.ln()))
        .collect();
    let n = logs.len() as f64;
    let (x, y) = logs
        .iter()
        .fold((0.0, 0.0), |(x, y), (a, b)| (x + a / n, y + b / n));
    let (up, across) = logs.iter().fold((0.0, 0.0), |(up, across), (a, b)| {
        (up + (a - x) * (b - y), across + (a - x).powi(2))
    });
    (logs.len() > 2).then(|| up / across)
}
