//! One way to the light, stepped.

use crate::session::device_lane::DeviceLane;
use crate::session::{History, LaneView, Moment, Watch};
use hemicube_gpu::Gpu;
use hemicube_radiosity::compare::{relative_error, shown_radiosity};
use hemicube_radiosity::form_factor::{FormFactors, MatrixOptions};
use hemicube_radiosity::solution::BANDS;
use hemicube_radiosity::solve::{
    ElementGathering, MatrixSolverKind, NotStarted, OnMatrix, Order, ambient_irradiance,
};
use hemicube_radiosity::stop::Stop;
use hemicube_radiosity::{
    Hierarchical, Progress, RadiosityError, Shooting, Solution, SolveOptions, Solver, SolverKind,
    Stochastic, Way,
};
use hemicube_raster::Rgb;
use std::sync::Arc;
use std::time::Instant;

/// Patches up to which a matrix method's light is looked at in the middle of a sweep.
const FEW_PATCHES: usize = 2000;

/// A way to the light as it is put aside: solvers come and go, this stays.
#[derive(Debug, Clone)]
pub(super) struct LaneState {
    pub kind: SolverKind,
    /// Light that any solver can go on from.
    pub solution: Solution,
    pub history: History,
    /// Seconds of stepping so far.
    pub seconds: f64,
}

/// A way to the light at work.
pub(super) struct Lane<'a> {
    kind: SolverKind,
    work: Work<'a>,
    history: History,
    seconds: f64,
    tolerance: f64,
}

enum Work<'a> {
    Shooting(Box<Shooting<'a>>),
    /// It keeps its light on a device.
    Device(Box<DeviceLane>),
    Gathering(Box<Gathering>),
    Matrix(Box<Priced<'a>>),
    Rays(Box<Stochastic>),
    Links(Box<Hierarchical>),
    /// It was told to stop before it could start.
    Waiting(Box<Solution>),
}

/// What lanes work with.
pub(super) struct Tools<'a> {
    pub factors: &'a dyn FormFactors,
    /// The device, where solvers may keep their light there.
    pub gpu: Option<&'a Gpu>,
    pub options: &'a SolveOptions,
    /// Whether a lane on a matrix does a sweep only when single shots have cost as much.
    pub in_step: bool,
    pub stop: Stop<'a>,
}

impl<'a> Lane<'a> {
    /// Goes on from where the state is.
    pub fn new(
        state: LaneState,
        tools: &Tools<'a>,
    ) -> Result<Self, Box<(RadiosityError, LaneState)>> {
        let LaneState {
            kind,
            mut solution,
            history,
            seconds,
        } = state;
        solution.provenance.solver = kind.name().into();
        let work = match start(kind, solution, tools) {
            Ok(work) => work,
            Err((error, solution)) => {
                let state = LaneState {
                    kind,
                    solution: *solution,
                    history,
                    seconds,
                };
                return Err(Box::new((error, state)));
            }
        };
        Ok(Self {
            kind,
            work,
            history,
            seconds,
            tolerance: tools.options.tolerance,
        })
    }

    /// Puts the solver away.
    pub fn into_state(self) -> LaneState {
        LaneState {
            kind: self.kind,
            solution: match self.work {
                Work::Shooting(solver) => solver.into_solution(),
                Work::Matrix(priced) => priced.solver.into_solution(),
                Work::Rays(solver) => solver.into_solution(),
                Work::Links(solver) => solver.into_solution(),
                Work::Device(lane) => lane.into_solution(),
                Work::Gathering(gathering) => gathering.base,
                Work::Waiting(solution) => *solution,
            },
            history: self.history,
            seconds: self.seconds,
        }
    }

    /// Whether it still waits to be started.
    pub fn is_waiting(&self) -> bool {
        matches!(self.work, Work::Waiting(_))
    }

    /// Does a step.
    pub fn step(&mut self) {
        let start = Instant::now();
        match &mut self.work {
            Work::Shooting(solver) => drop(solver.step()),
            Work::Device(lane) => lane.step(),
            Work::Gathering(gathering) => gathering.step(),
            Work::Rays(solver) => drop(solver.step()),
            Work::Links(solver) => drop(solver.step()),
            Work::Matrix(priced) => priced.step(),
            Work::Waiting(_) => {}
        }
        self.seconds += start.elapsed().as_secs_f64();
    }

    /// Where it is.
    pub fn progress(&self) -> Progress {
        match &self.work {
            Work::Shooting(solver) => solver.progress(),
            Work::Device(lane) => lane.progress(),
            Work::Gathering(gathering) => gathering.progress(),
            Work::Matrix(priced) => priced.solver.progress(),
            Work::Rays(solver) => solver.progress(),
            Work::Links(solver) => solver.progress(),
            Work::Waiting(solution) => Progress {
                iteration: solution.provenance.steps,
                unshot: 1.0,
                residual: 1.0,
                noise: None,
            },
        }
    }

    /// Whether further steps would change nothing that is seen.
    pub fn is_finished(&self) -> bool {
        let progress = self.progress();
        let is_exhausted = match &self.work {
            Work::Rays(solver) => return solver.is_finished(self.tolerance),
            Work::Links(solver) => return solver.is_finished(self.tolerance),
            Work::Shooting(solver) => solver.is_exhausted(),
            Work::Matrix(priced) => priced.solver.is_exhausted(),
            Work::Device(_) | Work::Gathering(_) | Work::Waiting(_) => false,
        };
        progress.unshot <= self.tolerance || progress.residual <= 0.0 || is_exhausted
    }

    /// Whether it has to be put away, because its device has failed.
    pub fn has_failed(&self) -> bool {
        matches!(&self.work, Work::Device(lane) if lane.has_failed())
    }

    /// What is wanted of its light while a device keeps it.
    pub fn watch(&mut self, watch: Watch) {
        if let Work::Device(lane) = &mut self.work {
            lane.watch(watch.elements.into_iter().flatten());
        }
    }

    /// The patch whose turn is next.
    pub fn shooter(&self) -> Option<usize> {
        match &self.work {
            Work::Shooting(solver) => Some(solver.next_patch()),
            Work::Gathering(gathering) => Some(gathering.next()),
            Work::Device(_)
            | Work::Matrix(_)
            | Work::Rays(_)
            | Work::Links(_)
            | Work::Waiting(_) => None,
        }
    }

    /// The light as it stands; if a device keeps it, as it last came from there unless all of it is wanted.
    pub fn shown(&mut self, all: bool) -> Arc<Solution> {
        Arc::new(match &mut self.work {
            Work::Device(lane) => return lane.light(all),
            Work::Shooting(solver) => solver.solution().clone(),
            Work::Gathering(gathering) => gathering.run.shown().clone(),
            Work::Matrix(priced) => priced.shown(),
            Work::Rays(solver) => solver.solution().clone(),
            Work::Links(solver) => solver.solution().clone(),
            Work::Waiting(solution) => (**solution).clone(),
        })
    }

    /// What can be said of the error while the light is not found.
    fn estimate(&self, solution: &Solution, progress: &Progress) -> Option<f64> {
        match &self.work {
            Work::Shooting(_) => Some(share_to_come(
                mean_irradiance(solution),
                ambient_irradiance(solution),
            )),
            Work::Device(lane) => Some(share_to_come(lane.mean(), lane.ambient())),
            // Before the second round nothing is known of it.
            Work::Rays(_) => progress.noise.filter(|noise| noise.is_finite()),
            Work::Gathering(_) | Work::Matrix(_) | Work::Links(_) | Work::Waiting(_) => None,
        }
    }

    fn ambient(&self, solution: &Solution) -> Rgb {
        match &self.work {
            _ if self.kind != SolverKind::AmbientShooting => Rgb::BLACK,
            Work::Device(lane) => lane.ambient(),
            _ => ambient_irradiance(solution),
        }
    }

    /// What the window sees of it, with all light if that is wanted; notes the moment in its history.
    pub fn view(&mut self, truth: Option<&Solution>, all: bool) -> LaneView {
        let solution = self.shown(all);
        let ambient = self.ambient(&solution);
        let on_device = match &self.work {
            Work::Device(lane) => Some(Arc::new(lane.view())),
            _ => None,
        };
        let is_here = on_device.as_ref().is_none_or(|device| device.is_brought);
        let error = truth
            .filter(|_| is_here)
            .map(|truth| relative_error(&shown_radiosity(&solution, self.kind), truth));
        let progress = self.progress();
        self.history.push(Moment {
            seconds: self.seconds,
            steps: progress.iteration,
            unshot: progress.unshot,
            error,
            estimate: self.estimate(&solution, &progress),
        });
        LaneView {
            kind: self.kind,
            solution,
            on_device,
            ambient,
            progress,
            shooter: self.shooter(),
            history: Arc::new(self.history.clone()),
            is_finished: self.is_finished(),
        }
    }
}

fn start<'a>(
    kind: SolverKind,
    solution: Solution,
    tools: &Tools<'a>,
) -> Result<Work<'a>, (RadiosityError, Box<Solution>)> {
    match kind.way() {
        Way::Shooting(order) => shooting(order, solution, tools),
        Way::OnMatrix(MatrixSolverKind::Gathering) => Ok(Work::Gathering(Box::new(
            Gathering::new(tools.factors, solution),
        ))),
        Way::Stochastic => {
            let kept = solution.clone();
            match Stochastic::new(solution, tools.options.stochastic_options()) {
                Ok(solver) => Ok(Work::Rays(Box::new(solver))),
                Err(error) => Err((error, Box::new(kept))),
            }
        }
        Way::Hierarchical => {
            let kept = solution.clone();
            match Hierarchical::new(solution, tools.options.hierarchical_options()) {
                Ok(solver) => Ok(Work::Links(Box::new(solver))),
                Err(error) => Err((error, Box::new(kept))),
            }
        }
        Way::OnMatrix(kind) => {
            let options = MatrixOptions {
                memory_limit: tools.options.memory_limit,
                ..MatrixOptions::default()
            };
            let kept = solution.clone();
            match OnMatrix::new_until(tools.factors, solution, kind, options, tools.stop) {
                Ok(solver) => Ok(Work::Matrix(Box::new(Priced::new(
                    solver,
                    kind,
                    tools.in_step,
                )))),
                Err(NotStarted::Stopped(solution)) => Ok(Work::Waiting(solution)),
                Err(NotStarted::Failed(error)) => Err((error, Box::new(kept))),
            }
        }
    }
}

fn shooting<'a>(
    order: Order,
    solution: Solution,
    tools: &Tools<'a>,
) -> Result<Work<'a>, (RadiosityError, Box<Solution>)> {
    // Side by side all shoot by the same rows.
    if tools.in_step {
        return Ok(Work::Shooting(Box::new(Shooting::new(
            tools.factors,
            solution,
            order,
        ))));
    }
    if let Some(gpu) = tools.gpu.filter(|_| order == Order::Sorted) {
        match gpu.shoot(solution.clone(), tools.options) {
            Ok(Some(solver)) => return Ok(Work::Device(Box::new(DeviceLane::new(solver)))),
            Ok(None) => {}
            Err(error) => return Err((error, Box::new(solution))),
        }
    }
    Ok(Work::Shooting(Box::new(Shooting::new(
        tools.factors,
        solution,
        order,
    ))))
}

/// Gathering as it looks. It has no balance of energy; what the last sweep still changed tells how far it is.
struct Gathering {
    run: ElementGathering,
    /// The light that it started from, which other solvers can go on from.
    base: Solution,
    /// Irradiance at the end of the last sweep, and what that sweep brought as a share of the emitted flux.
    before: Vec<f32>,
    change: f64,
    steps: u64,
}

impl Gathering {
    fn new(factors: &dyn FormFactors, base: Solution) -> Self {
        Self {
            run: ElementGathering::new(factors, base.clone()),
            before: irradiance(&base),
            base,
            change: 1.0,
            steps: 0,
        }
    }

    fn next(&self) -> usize {
        let patches = self.base.mesh().patches().len() as u64;
        usize::try_from(self.steps % patches.max(1)).unwrap_or(0)
    }

    fn step(&mut self) {
        self.run.step();
        self.steps += 1;
        if self.next() == 0 {
            let after = irradiance(self.run.shown());
            self.change = reflected_change(&self.base, &self.before, &after);
            self.before = after;
        }
    }

    fn progress(&self) -> Progress {
        Progress {
            iteration: self.run.shown().provenance.steps,
            unshot: self.change,
            residual: self.change,
            noise: None,
        }
    }
}

/// Share of all light on surfaces that the ambient estimate says is still to come: `A / (H + A)` with the ambient
/// irradiance A of Cohen et al. 1988 and the mean irradiance H so far, both as luminance.
fn share_to_come(mean: Rgb, ambient: Rgb) -> f64 {
    let [known, to_come] = [mean, ambient].map(|light| f64::from(light.luminance()));
    if known + to_come > 0.0 {
        (to_come / (known + to_come)).max(0.0)
    } else {
        0.0
    }
}

/// Mean irradiance of all surfaces.
fn mean_irradiance(solution: &Solution) -> Rgb {
    let mesh = solution.mesh();
    let (mut sum, mut area) = ([0.0; BANDS], 0.0);
    for e in 0..mesh.elements().len() {
        let (exposed, light) = (
            f64::from(mesh.exposed_area(e)),
            solution.element_irradiance(e),
        );
        area += exposed;
        for (sum, band) in sum.iter_mut().zip(light.to_array()) {
            *sum += exposed * f64::from(band);
        }
    }
    #[expect(clippy::cast_possible_truncation, reason = "light is kept in f32")]
    let mean = sum.map(|sum| (sum / area.max(f64::MIN_POSITIVE)) as f32);
    Rgb::from(mean)
}

fn channels(solution: &Solution) -> impl Iterator<Item = (usize, usize)> + use<> {
    let groups = solution.groups().len();
    (0..groups).flat_map(|group| (0..BANDS).map(move |band| (group, band)))
}

fn irradiance(solution: &Solution) -> Vec<f32> {
    let of = |(group, band)| solution.irradiance(group, band).iter().copied();
    channels(solution).flat_map(of).collect()
}

/// `Σ A ρ |ΔH|` as a share of the emitted flux.
fn reflected_change(solution: &Solution, before: &[f32], after: &[f32]) -> f64 {
    let mesh = solution.mesh();
    let elements = mesh.elements().len();
    let mut change = 0.0;
    for (i, (_, band)) in channels(solution).enumerate() {
        let range = i * elements..(i + 1) * elements;
        for (e, (a, b)) in before[range.clone()].iter().zip(&after[range]).enumerate() {
            let reflected = (a - b).abs() * mesh.reflectance()[e][band];
            change += f64::from(reflected) * f64::from(mesh.exposed_area(e));
        }
    }
    let emitted = solution.reference_flux();
    if emitted > 0.0 { change / emitted } else { 0.0 }
}

/// A method on a matrix, and what one of its rounds costs in single shots.
struct Priced<'a> {
    solver: OnMatrix<'a>,
    price: u64,
    /// Shots of the other lanes that are not used up.
    credit: u64,
}

impl<'a> Priced<'a> {
    fn new(solver: OnMatrix<'a>, kind: MatrixSolverKind, in_step: bool) -> Self {
        let patches = solver.solution().mesh().patches().len() as u64;
        let price = match kind {
            _ if !in_step => 1,
            MatrixSolverKind::Jacobi | MatrixSolverKind::GaussSeidel => patches,
            MatrixSolverKind::ConjugateGradient => 2 * patches,
            _ => 1,
        };
        Self {
            solver,
            price,
            credit: 0,
        }
    }

    fn step(&mut self) {
        self.credit += 1;
        if self.credit >= self.price {
            self.credit = 0;
            self.solver.step();
        }
    }

    fn shown(&self) -> Solution {
        let solution = self.solver.solution();
        if self.solver.is_pending() && solution.mesh().patches().len() <= FEW_PATCHES {
            self.solver.snapshot()
        } else {
            solution.clone()
        }
    }
}
