//! Solving under a progress bar, a clock and Ctrl-C.

use crate::args::{MeshArgs, SolveArgs};
use crate::backend::{FORM_FACTORS, FactorsOf, chosen};
use crate::failure::Failure;
use crate::history::History;
use crate::interrupt;
use crate::links::LinksOf;
use crate::progress::Bar;
use crate::report::counted;
use hemicube::radiosity::backend::Backend;
use hemicube::radiosity::solve::DrawnLink;
use hemicube::radiosity::{self, Progress, Solution, SolveOptions};
use hemicube::scene::Scene;
use serde::Serialize;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Why the solver stopped.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Stop {
    /// What is unshot is within the tolerance.
    Finished,
    /// `--iterations`
    Iterations,
    /// `--time`
    Time,
    /// Ctrl-C
    Interrupt,
}

/// A solution and how it ended.
#[derive(Debug)]
pub struct Solved {
    /// The light.
    pub solution: Solution,
    /// What it was asked for.
    pub options: SolveOptions,
    /// Why the solver stopped.
    pub stop: Stop,
    /// The way there, if it was asked for.
    pub history: Option<History>,
    /// The strongest links of a hierarchical solver, if they were asked for.
    pub links: Vec<DrawnLink>,
}

/// When to stop, and what to show until then.
#[derive(Debug)]
pub struct Watch {
    start: Instant,
    limit: Option<Duration>,
    quiet: bool,
    keeps_history: bool,
    keeps_links: bool,
    mesh: MeshArgs,
}

impl Watch {
    /// The clock of `--time` runs since the program's start.
    pub fn new(args: &SolveArgs, quiet: bool, start: Instant) -> Self {
        Self {
            start,
            limit: args.time,
            quiet,
            keeps_history: false,
            keeps_links: false,
            mesh: args.mesh.clone(),
        }
    }

    /// Whether the way to the solution is kept.
    pub fn with_history(self, keeps_history: bool) -> Self {
        Self {
            keeps_history,
            ..self
        }
    }

    /// Whether the links of a hierarchical solver are kept.
    pub fn with_links(self, keeps_links: bool) -> Self {
        Self {
            keeps_links,
            ..self
        }
    }

    /// Solves a scene from nothing.
    pub fn solve(&self, scene: Scene, options: SolveOptions) -> Result<Solved, Failure> {
        let backend = self.backend(self.mesh.uses_gpu(None))?;
        let stepped = self.stepped(&*backend);
        self.linked(&*stepped, |backend| {
            self.work(0, options, |stop, go_on| {
                let scene = Arc::new(scene);
                radiosity::solve_on(scene, &options, backend, stop, go_on)
            })
        })
    }

    /// Goes on with a solution.
    pub fn resume(&self, solution: Solution, options: SolveOptions) -> Result<Solved, Failure> {
        let steps = solution.provenance.steps;
        let uses_gpu = self.mesh.uses_gpu(Some(&solution.provenance));
        let backend = self.backend(uses_gpu)?;
        let stepped = self.stepped(&*backend);
        self.linked(&*stepped, |backend| {
            self.work(steps, options, |stop, go_on| {
                radiosity::resume_on(solution, &options, backend, stop, go_on)
            })
        })
    }

    /// Works with a backend, and keeps the links if they are wanted.
    fn linked(
        &self,
        backend: &dyn Backend,
        work: impl FnOnce(&dyn Backend) -> Result<Solved, Failure>,
    ) -> Result<Solved, Failure> {
        if !self.keeps_links {
            return work(backend);
        }
        let keeper = LinksOf::new(backend);
        let solved = work(&keeper)?;
        Ok(Solved {
            links: keeper.into_links(),
            ..solved
        })
    }

    fn backend(&self, uses_gpu: bool) -> Result<Box<dyn Backend>, Failure> {
        chosen(&self.mesh.gpu, uses_gpu, FORM_FACTORS, self.quiet)
    }

    /// A backend whose solver brings along every step's light if the way to the solution is kept.
    fn stepped<'a>(&self, backend: &'a dyn Backend) -> Box<dyn Backend + 'a> {
        if self.keeps_history {
            Box::new(FactorsOf(backend))
        } else {
            Box::new(backend)
        }
    }

    /// Why the work should end now, if it should.
    fn reason(&self) -> Option<Stop> {
        if interrupt::asked() {
            return Some(Stop::Interrupt);
        }
        let is_late = self
            .limit
            .is_some_and(|limit| self.start.elapsed() >= limit);
        is_late.then_some(Stop::Time)
    }

    fn work(
        &self,
        steps_before: u64,
        options: SolveOptions,
        work: impl FnOnce(
            radiosity::stop::Stop<'_>,
            &mut dyn FnMut(&Progress, &Solution) -> bool,
        ) -> Result<Solution, radiosity::RadiosityError>,
    ) -> Result<Solved, Failure> {
        let bar = Bar::new("solving", self.quiet);
        let has_begun = AtomicBool::new(false);
        let stop = || {
            if !has_begun.load(Ordering::Relaxed) {
                bar.show(0.0, || String::from("getting ready"));
            }
            self.reason().is_some()
        };
        let mut first = None;
        let mut history = self.keeps_history.then(|| History::new(self.start));
        let solution = work(&stop, &mut |progress, solution| {
            has_begun.store(true, Ordering::Relaxed);
            if let Some(history) = &mut history {
                history.record(progress, solution);
            }
            let elapsed = self.start.elapsed();
            let first = *first.get_or_insert(progress.unshot);
            let steps = progress.iteration - steps_before;
            let done = match progress.noise {
                // It falls with the root of the work.
                Some(noise) => (options.noise / noise).powi(2),
                None => {
                    let wanted = options.tolerance.max(1e-6);
                    (first / progress.unshot).ln() / (first / wanted).ln()
                }
            };
            bar.show(self.share_done(done, steps, elapsed, &options), || {
                on_mesh(options, solution) + &state(progress)
            });
            self.reason().is_none()
        })
        .map_err(|error| self.failure(error))?;
        let stop = self.why(&solution, steps_before, &options)?;
        if let Some(history) = &mut history {
            history.close(&solution);
        }
        Ok(Solved {
            solution,
            options,
            stop,
            history,
            links: Vec::new(),
        })
    }

    /// Why a solver has stopped.
    fn why(
        &self,
        solution: &Solution,
        steps_before: u64,
        options: &SolveOptions,
    ) -> Result<Stop, Failure> {
        let unshot = solution.unshot_fraction();
        if !unshot.is_finite() {
            let name = &solution.mesh().scene().name;
            return Err(Failure::Failed(format!(
                "scene '{name}': the light came out as no number, which is a bug; please report it with the scene"
            )));
        }
        let steps = solution.provenance.steps - steps_before;
        let limited = options.max_steps.is_some_and(|most| steps >= most);
        Ok(match self.reason() {
            // Elements were still to be cut, whatever the light on those there are.
            Some(reason) if options.adaptive.is_some() => reason,
            _ if unshot <= options.tolerance => Stop::Finished,
            _ if limited => Stop::Iterations,
            reason => reason.unwrap_or(Stop::Finished),
        })
    }

    /// What to tell where there is no light to go on with.
    fn failure(&self, error: radiosity::RadiosityError) -> Failure {
        match (&error, self.reason()) {
            (radiosity::RadiosityError::Stopped(_), Some(Stop::Interrupt)) => Failure::Interrupted,
            (radiosity::RadiosityError::Stopped(when), _) => Failure::Failed(format!(
                "--time: time was up {when}, before there was light to keep; allow more time, or ask for fewer --elements"
            )),
            _ => error.into(),
        }
    }

    /// Share of the work that is done: what is unshot falls exponentially, and the first limit ends the work.
    fn share_done(
        &self,
        of_light: f64,
        steps: u64,
        elapsed: Duration,
        options: &SolveOptions,
    ) -> f64 {
        let of_steps = options
            .max_steps
            .map_or(0.0, |most| steps as f64 / most.max(1) as f64);
        let of_time = self
            .limit
            .map_or(0.0, |limit| elapsed.as_secs_f64() / limit.as_secs_f64());
        of_light.max(of_steps).max(of_time)
    }
}

/// How far a mesh is refined, where it is.
fn on_mesh(options: SolveOptions, solution: &Solution) -> String {
    match options.adaptive {
        Some(_) => format!(
            "{}, ",
            counted(solution.mesh().elements().len() as u64, "element")
        ),
        None => String::new(),
    }
}

/// A solver's state for people who wait.
fn state(progress: &Progress) -> String {
    let left = match progress.noise {
        Some(noise) if noise.is_finite() => format!("noise {}", percent(noise)),
        Some(_) => String::from("direct light"),
        None => format!("{} unshot", percent(progress.unshot)),
    };
    format!("step {}, {left}", progress.iteration)
}

/// A share in percent with two significant digits.
pub fn percent(share: f64) -> String {
    let percent = 100.0 * share;
    match percent.abs() {
        0.0 => String::from("0 %"),
        x if x >= 10.0 => format!("{percent:.0} %"),
        x if x >= 1.0 => format!("{percent:.1} %"),
        x if x >= 0.1 => format!("{percent:.2} %"),
        x if x >= 0.01 => format!("{percent:.3} %"),
        x if x >= 0.001 => format!("{percent:.4} %"),
        _ => format!("{percent:.1e} %"),
    }
}
