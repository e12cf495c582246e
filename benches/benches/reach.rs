//! Seconds to an error: full matrices, links and rays on one mesh.
//!
//! Two errors are told. *Points*: RMS at the points of the reference rooms, gathered there, so that noise of single elements
//! averages out. *Elements*: RMS of the elements' own irradiance relative to the equilibrium on the same mesh, over those
//! that get more than a hundredth of the mean; the equilibrium is that of analytic form factors. Each way solves with ever
//! finer settings; its time to [`WANTED`] lies on the line between the two settings around it, in logarithms. Measuring is
//! not counted. Pictures of the curves are written beside the table. Names behind `--` choose ways by a part of theirs.

use hemicube::radiosity::form_factor::FormFactorKind;
use hemicube::radiosity::{PatchOptions, Solution, SolveOptions, SolverKind, solve};
use hemicube_benches::{element_error, measured_error};
use hemicube_chart::{Chart, Curve, Scale};
use hemicube_tests::solutions::built_in;
use hemicube_tests::{ReferencePoint, reference_points};
use std::time::Instant;

/// RMS error.
const WANTED: f64 = 0.01;
const ELEMENTS: usize = 8000;
/// Runs of each setting that take less than [`LONG`] together; the median counts.
const RUNS: usize = 3;
/// Seconds.
const LONG: f64 = 5.0;
const GATHERED_RAYS: u32 = 4096;
const TOLERANCE: f64 = 1e-4;

/// A solver, elements on its patches, and its settings.
struct Way {
    name: &'static str,
    solver: SolverKind,
    elements_of_patch: usize,
    settings: Settings,
}

enum Settings {
    /// Rays over a hemisphere.
    Rays(&'static [u32]),
    /// Rays of its first round, after which it stops.
    Round(&'static [u32]),
    /// Estimated errors.
    Noise(&'static [f64]),
}

const WAYS: [Way; 4] = [
    Way {
        name: "matrix of elements",
        solver: SolverKind::GaussSeidel,
        elements_of_patch: 1,
        settings: Settings::Rays(&[4, 64, 256, 1024, 4096]),
    },
    Way {
        name: "matrix of patches",
        solver: SolverKind::GaussSeidel,
        elements_of_patch: 8,
        settings: Settings::Rays(&[4, 64, 256, 1024]),
    },
    Way {
        name: "links",
        solver: SolverKind::Hierarchical,
        elements_of_patch: 8,
        settings: Settings::Noise(&[0.1, 0.05, 0.025, 0.0125, 0.006, 0.003]),
    },
    Way {
        name: "rays alone",
        solver: SolverKind::Stochastic,
        elements_of_patch: 8,
        settings: Settings::Round(&[16, 64, 256, 1024, 4096]),
    },
];

/// What a setting came to.
#[derive(Clone, Copy)]
struct Figure {
    seconds: f64,
    /// At the points, and of the elements.
    errors: [f64; 2],
}

const ERRORS: [&str; 2] = ["points", "elements"];

/// A room, and what is known of it.
struct Room {
    name: &'static str,
    points: Vec<ReferencePoint>,
    equilibrium: Solution,
}

fn main() {
    let asked: Vec<String> = std::env::args()
        .skip(1)
        .filter(|arg| !arg.starts_with('-'))
        .collect();
    let is_asked =
        |way: &&Way| asked.is_empty() || asked.iter().any(|part| way.name.contains(part));
    for name in ["cornell", "two-rooms"] {
        let start = Instant::now();
        let exact = SolveOptions {
            form_factors: FormFactorKind::Analytic,
            tolerance: 1e-6,
            ..options(SolverKind::GaussSeidel, 1)
        };
        let room = Room {
            name,
            points: reference_points(name),
            equilibrium: solve(built_in(name), &exact, |_, _| true).expect("it can be solved"),
        };
        let seconds = start.elapsed().as_secs_f64();
        let elements = room.equilibrium.mesh().elements().len();
        let error = 100.0 * measured_error(&room.equilibrium, &room.points, GATHERED_RAYS);
        println!(
            "{name}, {elements} elements; their equilibrium by analytic factors: {seconds:.1} s, points {error:.2} %"
        );
        let measured: Vec<(&str, Vec<Figure>)> = WAYS
            .iter()
            .filter(is_asked)
            .map(|way| (way.name, figures(&room, way)))
            .collect();
        for which in 0..ERRORS.len() {
            tell(&measured, which);
            draw(name, &measured, which);
        }
    }
}

fn options(solver: SolverKind, elements_of_patch: usize) -> SolveOptions {
    SolveOptions {
        mesh: PatchOptions::default()
            .with_elements(ELEMENTS)
            .with_patches(ELEMENTS / elements_of_patch),
        tolerance: TOLERANCE,
        solver,
        ..SolveOptions::default()
    }
}

fn figures(room: &Room, way: &Way) -> Vec<Figure> {
    let base = options(way.solver, way.elements_of_patch);
    let settings: Vec<(String, SolveOptions)> = match way.settings {
        Settings::Rays(counts) => counts
            .iter()
            .map(|&rays| (format!("{rays} rays"), SolveOptions { rays, ..base }))
            .collect(),
        Settings::Round(counts) => counts
            .iter()
            .map(|&rays| {
                let noise = 9.0;
                (
                    format!("{rays} rays"),
                    SolveOptions {
                        rays,
                        noise,
                        ..base
                    },
                )
            })
            .collect(),
        Settings::Noise(errors) => errors
            .iter()
            .map(|&noise| (format!("noise {noise}"), SolveOptions { noise, ..base }))
            .collect(),
    };
    settings
        .iter()
        .map(|(setting, options)| figure(room, way.name, setting, options))
        .collect()
}

fn figure(room: &Room, way: &str, setting: &str, options: &SolveOptions) -> Figure {
    let run = || {
        let start = Instant::now();
        let solution = solve(built_in(room.name), options, |_, _| true).expect("it can be solved");
        (start.elapsed().as_secs_f64(), solution)
    };
    // The same input gives the same light, however often.
    let (first, solution) = run();
    let mut seconds = vec![first];
    while seconds.len() < RUNS && seconds.iter().sum::<f64>() < LONG {
        seconds.push(run().0);
    }
    seconds.sort_by(f64::total_cmp);
    let seconds = seconds[seconds.len() / 2];
    let errors = [
        measured_error(&solution, &room.points, GATHERED_RAYS),
        element_error(&solution, &room.equilibrium),
    ];
    assert!(errors[0] < 0.5, "{way}, {setting}: errors {errors:?}");
    let [points, elements] = errors.map(|error| 100.0 * error);
    println!(
        "  {way:18} {setting:12} {seconds:7.2} s, points {points:5.2} %, elements {elements:5.2} %"
    );
    Figure { seconds, errors }
}

/// Says when each way was at the wanted error, and how much sooner than the first.
fn tell(measured: &[(&str, Vec<Figure>)], which: usize) {
    println!("  {:.0} % of the {}:", 100.0 * WANTED, ERRORS[which]);
    let first = measured
        .first()
        .and_then(|(_, figures)| reached(figures, which));
    for (way, figures) in measured {
        let text = match (reached(figures, which), first) {
            (Some(seconds), Some(first)) => {
                format!(
                    "{seconds:.2} s, {:.1} times as fast as the first",
                    first / seconds
                )
            }
            (Some(seconds), None) => format!("{seconds:.2} s"),
            (None, _) => String::from("not reached"),
        };
        println!("    {way:18} {text}");
    }
}

/// Seconds to the wanted error: of the first setting if that is good enough, else between the last that is not and the
/// first that is.
fn reached(figures: &[Figure], which: usize) -> Option<f64> {
    let first = figures
        .iter()
        .position(|figure| figure.errors[which] <= WANTED)?;
    let found = figures[first];
    let Some(before) = first.checked_sub(1).map(|i| figures[i]) else {
        return Some(found.seconds);
    };
    let (coarse, fine) = (before.errors[which], found.errors[which]);
    let along = (WANTED / coarse).ln() / (fine / coarse).ln();
    Some(before.seconds * (found.seconds / before.seconds).powf(along))
}

fn draw(scene: &str, measured: &[(&str, Vec<Figure>)], which: usize) {
    let error = ERRORS[which];
    let curve = |(way, figures): &(&str, Vec<Figure>)| {
        let points = figures
            .iter()
            .map(|figure| (figure.seconds, figure.errors[which]));
        Curve::new(*way, points.collect())
    };
    let chart = Chart {
        title: format!("{scene}: error of the {error}, {ELEMENTS} elements"),
        x_label: String::from("seconds"),
        y_label: String::from("RMS error"),
        x_scale: Scale::Logarithmic,
        y_scale: Scale::Logarithmic,
        curves: measured.iter().map(curve).collect(),
    };
    let path = std::env::temp_dir().join(format!("hemicube-reach-{scene}-{error}.png"));
    let picture = chart.draw(900, 540).png().expect("a picture");
    std::fs::write(&path, picture).expect("a file that can be written");
    println!("  wrote {}", path.display());
}
