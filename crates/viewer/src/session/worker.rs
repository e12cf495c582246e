//! The thread that solves.
//!
//! ```text
//! until the end
//!     obey all commands; what changes light or settings finds the solvers put away
//!     start solvers (lanes) where the light is
//!     until a command wants them put away
//!         obey commands that do not
//!         step all lanes for a short while, or sleep if there is nothing to do
//!         show the light, as long as showing takes less than a fifth of the time
//! ```

use crate::session::figures::{Figures, Pace};
use crate::session::lane::{Lane, LaneState, Tools};
use crate::session::loader::Loader;
use crate::session::{
    Board, Command, FactorsBy, History, Inbox, LaneView, Phase, Settings, Snapshot, Source, Watch,
};
use hemicube_gpu::{Context, Gpu, GpuError};
use hemicube_radiosity::backend::{Backend, Cpu};
use hemicube_radiosity::form_factor::{Cached, FormFactors};
use hemicube_radiosity::{
    Grouping, MaterialEdit, RadiosityError, Solution, SolveOptions, SolverKind,
};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// How long solvers step before somebody looks at the inbox.
const BURST: Duration = Duration::from_millis(15);
/// Memory for rows of form factors.
const ROW_BUDGET: usize = 256 << 20;

/// The thread's state.
pub(super) struct Worker {
    inbox: Arc<Inbox>,
    board: Arc<Board>,
    loader: Loader,
    settings: Settings,
    is_running: bool,
    /// Single steps that are still to be done.
    steps_wanted: u64,
    watch: Watch,
    /// Numbers of the last wish for light that a device keeps, and of the last that came true.
    asked_for_light: u64,
    brought: u64,
    job: Option<Job>,
    gpu: Option<Arc<Context>>,
    serial: u64,
    geometry: u64,
    /// What the scene that is on its way was asked for by.
    asked: Option<String>,
}

/// A scene and its light while no solver works on it.
struct Job {
    /// Before the first step.
    start: Solution,
    lanes: Vec<LaneState>,
    factors: Option<(FactorsBy, Arc<dyn FormFactors>)>,
    source_of_material: Arc<Vec<Option<usize>>>,
    /// The light that all ways come to, once one has.
    truth: Option<Arc<Solution>>,
}

enum Next {
    GoOn,
    End,
}

impl Worker {
    pub fn new(inbox: Arc<Inbox>, board: Arc<Board>, settings: Settings) -> Self {
        Self {
            loader: Loader::new(inbox.clone(), board.clone()),
            inbox,
            board,
            settings,
            is_running: true,
            steps_wanted: 0,
            watch: Watch::default(),
            asked_for_light: 0,
            brought: 0,
            job: None,
            gpu: None,
            serial: 0,
            geometry: 0,
            asked: None,
        }
    }

    /// Works until it is told to end. A bug in a solver costs the light, not the window.
    pub fn run(mut self) {
        loop {
            let work = core::panic::AssertUnwindSafe(|| self.work());
            if std::panic::catch_unwind(work).is_ok() {
                return;
            }
            self.board.set_status(|status| {
                status.error = Some(String::from(
                    "the solver broke, which is a bug: please report it; open the scene again to go on",
                ));
                status.phase = Phase::Empty;
            });
        }
    }

    fn work(&mut self) {
        loop {
            for command in self.inbox.take() {
                if matches!(self.obey(command), Next::End) {
                    self.loader.cancel();
                    return;
                }
            }
            match self.job.take() {
                Some(job) => self.job = Some(self.drive(job)),
                None => self.inbox.wait(),
            }
        }
    }

    /// Obeys a command; solvers are put away unless it is a light one.
    fn obey(&mut self, command: Command) -> Next {
        match command {
            Command::Open(source) => {
                if let Source::Named(name) | Source::Adjusted(name, _) = &source {
                    self.asked = Some(name.clone());
                }
                self.loader.open(source, self.settings);
            }
            Command::Cancel => self.loader.cancel(),
            Command::Run => self.is_running = true,
            Command::Pause => self.is_running = false,
            Command::Step => {
                self.is_running = false;
                self.steps_wanted += 1;
            }
            Command::Restart => self.restart(),
            Command::Configure(settings) => self.configure(settings),
            Command::Edit(edit) => self.edit(&edit),
            Command::Watch(watch) => self.watch = watch,
            Command::Bring(number) => self.asked_for_light = number,
            Command::Loaded(ticket, result) if self.loader.is_newest(ticket) => {
                self.loader.cancel();
                self.take_over(result);
            }
            Command::Loaded(..) => {}
            Command::Quit => return Next::End,
        }
        Next::GoOn
    }

    fn take_over(&mut self, result: Result<Box<Solution>, String>) {
        let solution = match result {
            Ok(solution) => *solution,
            Err(why) => return self.fail(&why),
        };
        self.geometry += 1;
        self.is_running = true;
        let scene = solution.mesh().scene().clone();
        let warnings = scene
            .report
            .warnings
            .iter()
            .chain(&solution.mesh().report().warnings);
        let warnings: Vec<String> = warnings.map(ToString::to_string).collect();
        let asked = self.asked.clone();
        self.board.set_status(|status| {
            status.scene.clone_from(&scene.name);
            status.source = asked;
            status.warnings = warnings;
            status.error = None;
        });
        self.job = Some(Job::new(solution, &self.settings));
    }

    fn restart(&mut self) {
        if let Some(job) = &mut self.job {
            job.lanes = lanes_at(&job.start, &self.settings);
        }
        self.is_running = true;
    }

    fn configure(&mut self, settings: Settings) {
        let before = core::mem::replace(&mut self.settings, settings);
        let Some(job) = &mut self.job else { return };
        if settings.wants_other_mesh(&before) {
            let scene = job.start.mesh().scene().clone();
            self.loader.open(Source::Scene(scene), settings);
        } else if settings.side_by_side || before.side_by_side {
            // Only from the same start the figure is fair.
            job.lanes = lanes_at(&job.start, &settings);
        } else {
            job.lanes[0].kind = settings.solver_for(job.elements());
        }
    }

    fn edit(&mut self, edit: &MaterialEdit) {
        let Some(job) = &mut self.job else { return };
        match job.edit(edit, self.settings.by_source) {
            Ok(()) => self.is_running = true,
            Err(error) => self.fail(&error.to_string()),
        }
    }

    fn fail(&self, why: &str) {
        let line = why.split_whitespace().collect::<Vec<_>>().join(" ");
        self.board.set_status(|status| status.error = Some(line));
    }

    /// Steps until a command wants the solvers put away.
    fn drive(&mut self, mut job: Job) -> Job {
        self.board
            .set_status(|status| status.phase = Phase::Preparing);
        let options = self.settings.solve_options();
        let gpu = self.gpu();
        let backend: &dyn Backend = gpu.as_ref().map_or(&Cpu, |gpu| gpu);
        let factors = match job.factors(self.settings.factors, backend, &options) {
            Ok(factors) => factors,
            Err(error) => return self.give_up(job, &error),
        };
        let inbox = self.inbox.clone();
        let stop = move || inbox.is_full();
        let tools = Tools {
            factors: &*factors,
            gpu: gpu.as_ref(),
            options: &options,
            in_step: self.settings.side_by_side,
            stop: &stop,
        };
        let mut states = core::mem::take(&mut job.lanes);
        let mut lanes = Vec::new();
        while !states.is_empty() {
            let state = states.remove(0);
            match Lane::new(state, &tools) {
                Ok(lane) => lanes.push(lane),
                Err(failed) => {
                    let (error, state) = *failed;
                    job.lanes = lanes.into_iter().map(Lane::into_state).collect();
                    job.lanes.push(state);
                    job.lanes.extend(states);
                    return self.give_up(job, &error);
                }
            }
        }
        self.step_until_put_away(&mut lanes, &mut job, &factors);
        job.lanes = lanes.into_iter().map(Lane::into_state).collect();
        job
    }

    /// What these settings cannot do; the usual ones can.
    fn give_up(&mut self, mut job: Job, error: &RadiosityError) -> Job {
        self.fail(&error.to_string());
        let usual = Settings::default();
        self.settings = self
            .settings
            .with_solver(usual.solver())
            .with_factors(usual.factors)
            .with_side_by_side(false);
        job.lanes.truncate(1);
        let kind = self.settings.solver_for(job.elements());
        for lane in &mut job.lanes {
            lane.kind = kind;
        }
        job
    }

    fn step_until_put_away(
        &mut self,
        lanes: &mut [Lane<'_>],
        job: &mut Job,
        factors: &Arc<dyn FormFactors>,
    ) {
        let mut figures = Figures::new(job.start.mesh().clone());
        let mut pace = Pace::default();
        self.show(lanes, job, &mut figures, factors, &mut pace, true);
        loop {
            let light = self.inbox.take_while(Command::is_light);
            let is_changed = !light.is_empty();
            for command in light {
                self.obey(command);
            }
            let is_stuck = |lane: &Lane<'_>| lane.is_waiting() || lane.has_failed();
            if self.inbox.is_full() || lanes.iter().any(is_stuck) {
                return;
            }
            lanes.iter_mut().for_each(|lane| lane.watch(self.watch));
            let is_done = lanes.iter().all(Lane::is_finished);
            if is_done && job.truth.is_none() && lanes.len() == 1 {
                job.truth = Some(lanes[0].shown(true));
            }
            let goes_on = !is_done && (self.is_running || self.steps_wanted > 0);
            if goes_on {
                self.set_phase(Phase::Solving);
                pace.steps += self.burst(lanes);
                self.show(lanes, job, &mut figures, factors, &mut pace, false);
                continue;
            }
            self.steps_wanted = 0;
            if pace.is_behind || is_changed {
                self.show(lanes, job, &mut figures, factors, &mut pace, true);
            }
            self.set_phase(if is_done {
                Phase::Finished
            } else {
                Phase::Paused
            });
            if !self.inbox.is_full() {
                self.inbox.wait();
            }
        }
    }

    /// Steps for a short while; each lane does as many.
    fn burst(&mut self, lanes: &mut [Lane<'_>]) -> u64 {
        let start = Instant::now();
        let mut steps = 0;
        while (self.is_running || self.steps_wanted > 0) && start.elapsed() < BURST {
            for lane in lanes.iter_mut().filter(|lane| !lane.is_finished()) {
                lane.step();
            }
            steps += 1;
            self.steps_wanted = self.steps_wanted.saturating_sub(1);
            if self.inbox.is_full() || lanes.iter().all(Lane::is_finished) {
                break;
            }
        }
        steps
    }

    fn set_phase(&self, phase: Phase) {
        // Each change wakes the window, so only changes are told.
        self.board.set_phase(phase);
    }

    /// Shows the light if it is time to.
    fn show(
        &mut self,
        lanes: &mut [Lane<'_>],
        job: &Job,
        figures: &mut Figures,
        factors: &Arc<dyn FormFactors>,
        pace: &mut Pace,
        at_once: bool,
    ) {
        pace.is_behind = true;
        let is_asked = self.asked_for_light != self.brought;
        if !at_once && !is_asked && !pace.is_due(self.board.pace()) {
            return;
        }
        let begin = Instant::now();
        let truth = job.truth.as_deref();
        // Light that a device keeps comes when somebody wants it, and when the solver rests.
        let all = at_once || is_asked;
        let view = |lane: &mut Lane<'_>| lane.view(truth, all);
        let views: Vec<LaneView> = lanes.iter_mut().map(view).collect();
        self.brought = self.asked_for_light;
        let is_whole = views.iter().all(LaneView::has_light);
        let shooter = views[0].shooter;
        let hemicube = figures.hemicube(self.watch, shooter, at_once);
        let row = figures.row(self.watch, &**factors);
        self.serial += 1;
        self.board.show(Snapshot {
            serial: self.serial,
            geometry: self.geometry,
            lanes: views,
            source_of_material: job.source_of_material.clone(),
            hemicube,
            row,
            brought: self.brought,
        });
        if let Some(rate) = pace.rate() {
            self.board
                .set_status(|status| status.steps_per_second = rate);
        }
        pace.shown(begin);
        pace.is_behind = !is_whole;
    }

    /// The device that makes form factors, if the settings want one and the machine has it.
    fn gpu(&mut self) -> Option<Gpu> {
        if self.settings.factors != FactorsBy::Gpu {
            return None;
        }
        let board = self.board.clone();
        let tell = move |why: String| {
            let note = format!("{why}; going on with the CPU's hemicubes");
            board.set_status(|status| status.note = Some(note));
        };
        match self.device() {
            Ok(context) => {
                Some(Gpu::new(context).with_report(move |error| tell(error.to_string())))
            }
            Err(error) => {
                tell(error.to_string());
                None
            }
        }
    }

    /// The device of the window, which can then draw from the solver's buffers; one of its own where there is no window.
    fn device(&mut self) -> Result<Arc<Context>, GpuError> {
        if let Some(shared) = self.board.device() {
            return shared.failure().map_or(Ok(shared), Err);
        }
        if let Some(own) = self.gpu.clone().filter(|gpu| gpu.failure().is_none()) {
            return Ok(own);
        }
        let new = Arc::new(Context::headless(None)?);
        self.gpu = Some(new.clone());
        Ok(new)
    }
}

impl Board {
    fn set_phase(&self, phase: Phase) {
        if crate::session::lock(&self.status).phase != phase {
            self.set_status(|status| status.phase = phase);
        }
    }
}

impl Job {
    fn new(solution: Solution, settings: &Settings) -> Self {
        Self {
            lanes: lanes_at(&solution, settings),
            source_of_material: Arc::new(source_of_material(&solution)),
            factors: None,
            truth: None,
            start: solution,
        }
    }

    fn elements(&self) -> usize {
        self.start.mesh().elements().len()
    }

    /// Form factors of the mesh; what an edit changes leaves them as they are.
    fn factors(
        &mut self,
        by: FactorsBy,
        backend: &dyn Backend,
        options: &SolveOptions,
    ) -> Result<Arc<dyn FormFactors>, RadiosityError> {
        if let Some((known, factors)) = &self.factors
            && *known == by
        {
            return Ok(factors.clone());
        }
        let made = backend.form_factors(self.start.mesh().clone(), options)?;
        let factors: Arc<dyn FormFactors> = Arc::new(Cached::new(made, ROW_BUDGET));
        self.factors = Some((by, factors.clone()));
        Ok(factors)
    }

    /// Changes a material in the light of all lanes. What starts to emit gets a light group of its own.
    fn edit(&mut self, edit: &MaterialEdit, by_source: bool) -> Result<(), RadiosityError> {
        let mesh = Arc::new(self.start.mesh().edited(edit)?);
        let material = &mesh.scene().materials[edit.material];
        let mut sources = (*self.source_of_material).clone();
        let is_new = sources[edit.material].is_none() && material.emits();
        let is_alone = by_source && self.start.groups().len() > 1;
        if is_new && is_alone {
            let name = material.name.clone();
            self.change(|solution| solution.with_dark_group(name.clone()).0);
            sources[edit.material] = Some(self.start.groups().len() - 2);
        }
        let group = sources[edit.material].unwrap_or(self.start.groups().len() - 1);
        self.change(|solution| solution.relit(mesh.clone(), |_| group));
        self.source_of_material = Arc::new(sources);
        self.truth = None;
        Ok(())
    }

    fn change(&mut self, change: impl Fn(Solution) -> Solution) {
        let all =
            core::iter::once(&mut self.start).chain(self.lanes.iter_mut().map(|l| &mut l.solution));
        for solution in all {
            *solution = change(solution.clone());
        }
    }
}

fn lanes_at(start: &Solution, settings: &Settings) -> Vec<LaneState> {
    let lane = |kind: SolverKind| LaneState {
        kind,
        solution: start.clone(),
        history: History::default(),
        seconds: 0.0,
    };
    let elements = start.mesh().elements().len();
    settings.solvers(elements).into_iter().map(lane).collect()
}

/// The light group of each material, where materials have groups of their own.
fn source_of_material(solution: &Solution) -> Vec<Option<usize>> {
    let mesh = solution.mesh();
    let (names, _) = Grouping::ByMaterial.groups(mesh);
    let known = solution.groups().iter().map(|group| &group.name);
    let is_by_material = names.len() > 1 && known.eq(&names);
    let mut next = 0;
    let mut of = |material: &hemicube_scene::Material| {
        if !material.emits() {
            return None;
        }
        next += 1;
        Some(if is_by_material { next - 1 } else { 0 })
    };
    mesh.scene().materials.iter().map(&mut of).collect()
}
