//! The way to a solution: a table, or curves.

use crate::failure::Failure;
use crate::output::Target;

use hemicube::radiosity::compare::relative_error;
use hemicube::radiosity::{Progress, Solution};
use hemicube::raster::Rgb;
use hemicube_chart::{Chart, Curve, Scale};
use std::fmt::Write as _;
use std::time::Instant;

/// Endings of histories that can be written.
pub const ENDINGS: &[&str] = &["csv", "png", "svg"];

/// Pixels of a plot.
const SIZE: (usize, usize) = (800, 500);

/// Steps grow by this between two states that are kept to be compared with the end.
const NEXT_STATE: f64 = 1.1;
/// Most memory of those states, in bytes.
const MAX_STATES: usize = 128 << 20;

/// What a solver had reached after each step.
#[derive(Debug)]
pub struct History {
    start: Instant,
    entries: Vec<Entry>,
    /// States to be compared with the end: entry and radiosity of each element.
    states: Vec<(usize, Vec<Rgb>)>,
    /// Step from which the next state is kept.
    next_state: f64,
    growth: f64,
}

/// A solver after one step.
#[derive(Debug, Clone, Copy)]
struct Entry {
    progress: Progress,
    /// Since the program's start.
    seconds: f64,
    error: Option<f64>,
}

impl History {
    /// Nothing yet; seconds count from here.
    pub fn new(start: Instant) -> Self {
        Self {
            start,
            entries: Vec::new(),
            states: Vec::new(),
            next_state: 0.0,
            growth: NEXT_STATE,
        }
    }

    /// Notes where the solver is.
    pub fn record(&mut self, progress: &Progress, solution: &Solution) {
        let first = self
            .entries
            .first()
            .map_or(progress.iteration, |e| e.progress.iteration);
        self.entries.push(Entry {
            progress: *progress,
            seconds: self.start.elapsed().as_secs_f64(),
            error: None,
        });
        let step = (progress.iteration - first) as f64;
        // Solvers on a matrix bring light up to date only now and then.
        let is_current = || {
            let kept = solution.unshot_fraction();
            (kept - progress.unshot).abs() <= 1e-3 * kept
        };
        if step >= self.next_state && is_current() {
            self.next_state = (step * self.growth).max(step + 1.0);
            let elements = 0..solution.mesh().elements().len();
            let state: Vec<Rgb> = elements.map(|e| solution.element_radiosity(e)).collect();
            // States on a mesh that was refined since cannot be compared with the end.
            self.states
                .retain(|(_, earlier)| earlier.len() == state.len());
            self.states.push((self.entries.len() - 1, state));
            self.thin_out();
        }
    }

    /// Keeps every second state where they take too much memory.
    fn thin_out(&mut self) {
        let each = self
            .states
            .first()
            .map_or(0, |(_, state)| size_of_val(&state[..]));
        if each * self.states.len() > MAX_STATES {
            let mut number = 0;
            self.states.retain(|_| {
                number += 1;
                number % 2 == 1
            });
            self.growth *= self.growth;
        }
    }

    /// Compares the states that were kept with the end.
    pub fn close(&mut self, end: &Solution) {
        let elements = end.mesh().elements().len();
        self.states.retain(|(_, state)| state.len() == elements);
        for (entry, state) in self.states.drain(..) {
            let error = relative_error(&state, end);
            self.entries[entry].error = error.is_finite().then_some(error);
        }
    }

    /// Writes a table or a picture of curves, as the file's ending says.
    pub fn write(&self, solution: &Solution, target: &Target) -> Result<(), Failure> {
        if target.ends_in("csv") {
            return target.write(self.csv().as_bytes());
        }
        let drawing = self.chart(solution).draw(SIZE.0, SIZE.1);
        if target.ends_in("svg") {
            target.write(drawing.svg().as_bytes())
        } else {
            target.write(&drawing.png()?)
        }
    }

    fn csv(&self) -> String {
        let mut text = String::from("step,seconds,unshot,residual,error_to_end,noise\n");
        for entry in &self.entries {
            let Progress {
                iteration,
                unshot,
                residual,
                noise,
            } = entry.progress;
            let error = entry.error.map(|e| e.to_string()).unwrap_or_default();
            let is_known = |noise: &f64| noise.is_finite();
            let noise = noise
                .filter(is_known)
                .map(|n| n.to_string())
                .unwrap_or_default();
            let _ = writeln!(
                text,
                "{iteration},{:.6},{unshot},{residual},{error},{noise}",
                entry.seconds
            );
        }
        text
    }

    fn chart(&self, solution: &Solution) -> Chart {
        let curve = |name: &str, of: &dyn Fn(&Entry) -> Option<f64>| {
            let points = self.entries.iter().filter_map(|entry| {
                of(entry).map(|share| (entry.progress.iteration as f64, share))
            });
            Curve::new(name, points.collect())
        };
        let provenance = &solution.provenance;
        Chart {
            title: format!(
                "{}: {}, {}",
                solution.mesh().scene().name,
                provenance.solver,
                provenance.form_factors
            ),
            x_label: String::from("steps"),
            y_label: String::from("share of emitted light; error: of reflected light"),
            x_scale: Scale::Linear,
            y_scale: Scale::Logarithmic,
            curves: [
                curve("unshot", &|e| Some(e.progress.unshot)),
                curve("largest patch", &|e| Some(e.progress.residual)),
                curve("RMS error to end", &|e| e.error),
            ]
            .into_iter()
            .filter(|curve| curve.is_visible(Scale::Logarithmic))
            .collect(),
        }
    }
}
