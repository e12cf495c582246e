//! Seconds to an error: the full matrix, links and rays on one mesh, measured at the points of the reference rooms.
//!
//! Each way solves with ever finer settings; its time to [`WANTED`] lies on the line between the two settings around it,
//! in logarithms. Measuring is not counted. A picture of the curves is written beside the table.

use hemicube::radiosity::{PatchOptions, SolveOptions, SolverKind, solve};
use hemicube_benches::measured_error;
use hemicube_chart::{Chart, Curve, Scale};
use hemicube_tests::solutions::built_in;
use hemicube_tests::{ReferencePoint, reference_points};
use std::time::Instant;

/// RMS error at the points.
const WANTED: f64 = 0.01;
const ELEMENTS: usize = 8000;
/// Runs of each setting; the median counts.
const RUNS: usize = 3;
const GATHERED_RAYS: u32 = 4096;

/// A solver, its patches, and what its settings are called.
struct Way {
    name: &'static str,
    solver: SolverKind,
    patches: usize,
    settings: Settings,
}

enum Settings {
    /// Rays over a hemisphere, at a tolerance that adds no error of its own.
    Rays(&'static [u32]),
    /// Estimated errors.
    Noise(&'static [f64]),
}

const WAYS: [Way; 4] = [
    Way {
        name: "matrix of elements",
        solver: SolverKind::GaussSeidel,
        patches: ELEMENTS,
        settings: Settings::Rays(&[4, 16, 64, 256]),
    },
    Way {
        name: "matrix of patches",
        solver: SolverKind::GaussSeidel,
        patches: ELEMENTS / 8,
        settings: Settings::Rays(&[4, 16, 64, 256]),
    },
    Way {
        name: "links",
        solver: SolverKind::Hierarchical,
        patches: ELEMENTS / 8,
        settings: Settings::Noise(&[0.2, 0.1, 0.05, 0.025, 0.0125]),
    },
    Way {
        name: "rays alone",
        solver: SolverKind::Stochastic,
        patches: ELEMENTS / 8,
        settings: Settings::Noise(&[0.2, 0.1, 0.05, 0.025, 0.0125]),
    },
];

/// Seconds and error of a setting.
type Figure = (f64, f64);

fn main() {
    for scene in ["cornell", "two-rooms"] {
        let points = reference_points(scene);
        println!("{scene}, {ELEMENTS} elements asked: seconds to an RMS error at the points");
        let mut curves = Vec::new();
        let mut slowest = None;
        for way in &WAYS {
            let figures = figures(scene, way, &points);
            let reached = reached(&figures);
            let text = reached.map_or(String::from("not reached"), |seconds| {
                let base: f64 = *slowest.get_or_insert(seconds);
                format!(
                    "{seconds:.2} s, {:.1} times as fast as the first",
                    base / seconds
                )
            });
            println!("  {:18} {:.0} %: {text}", way.name, 100.0 * WANTED);
            curves.push(Curve::new(way.name, figures));
        }
        draw(scene, curves);
    }
}

fn figures(scene: &str, way: &Way, points: &[ReferencePoint]) -> Vec<Figure> {
    let base = SolveOptions {
        mesh: PatchOptions::default()
            .with_elements(ELEMENTS)
            .with_patches(way.patches),
        tolerance: 1e-4,
        solver: way.solver,
        ..SolveOptions::default()
    };
    match way.settings {
        Settings::Rays(counts) => counts
            .iter()
            .map(|&rays| {
                figure(
                    scene,
                    way.name,
                    &format!("{rays} rays"),
                    SolveOptions { rays, ..base },
                    points,
                )
            })
            .collect(),
        Settings::Noise(errors) => errors
            .iter()
            .map(|&noise| {
                figure(
                    scene,
                    way.name,
                    &format!("noise {noise}"),
                    SolveOptions { noise, ..base },
                    points,
                )
            })
            .collect(),
    }
}

fn figure(
    scene: &str,
    way: &str,
    setting: &str,
    options: SolveOptions,
    points: &[ReferencePoint],
) -> Figure {
    let room = built_in(scene);
    let mut runs: Vec<(f64, f64, usize)> = (0..RUNS)
        .map(|_| {
            let start = Instant::now();
            let solution = solve(room.clone(), &options, |_, _| true).expect("it can be solved");
            let seconds = start.elapsed().as_secs_f64();
            let error = measured_error(&solution, points, GATHERED_RAYS);
            (seconds, error, solution.mesh().elements().len())
        })
        .collect();
    runs.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (seconds, error, elements) = runs[RUNS / 2];
    assert!(error < 0.5, "{scene}, {way}, {setting}: error {error}");
    println!(
        "  {way:18} {setting:12} {elements:6} elements {seconds:7.2} s, error {:5.2} %",
        100.0 * error
    );
    (seconds, error)
}

/// Seconds to the wanted error: of the first setting if that is good enough, else between the last that is not and the
/// first that is.
fn reached(figures: &[Figure]) -> Option<f64> {
    let first = figures.iter().position(|&(_, error)| error <= WANTED)?;
    let (seconds, error) = figures[first];
    let Some(&(before, coarse)) = first.checked_sub(1).map(|i| &figures[i]) else {
        return Some(seconds);
    };
    let along = (WANTED / coarse).ln() / (error / coarse).ln();
    Some(before * (seconds / before).powf(along))
}

fn draw(scene: &str, curves: Vec<Curve>) {
    let chart = Chart {
        title: format!("{scene}: error after so many seconds, {ELEMENTS} elements"),
        x_label: String::from("seconds"),
        y_label: String::from("RMS error at the reference points"),
        x_scale: Scale::Logarithmic,
        y_scale: Scale::Logarithmic,
        curves,
    };
    let path = std::env::temp_dir().join(format!("hemicube-reach-{scene}.png"));
    let picture = chart.draw(900, 540).png().expect("a picture");
    std::fs::write(&path, picture).expect("a file that can be written");
    println!("wrote {}", path.display());
}
