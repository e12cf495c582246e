//! The thread that solves.
//!
//! ```text
//! until the end
//!     obey all commands; what changes light or settings finds the solvers put away
//!     start solvers (lanes) where the light is
//!     until a command wants them put away
//!         obey commands that do not
//!         step all lanes for a short while, or sleep if there is nothing to do
//!         have the mesh refined if the light on it is found
//!         show the light, as long as showing takes less than a fifth of the time
//! ```

use crate::session::figures::{Figures, Pace};
use crate::session::job::Job;
use crate::session::lane::{Lane, Tools};
use crate::session::loader::Loader;
use crate::session::{
    Board, Command, FactorsBy, Inbox, LaneView, Phase, Settings, Snapshot, Source, Watch,
};
use hemicube_gpu::{Context, Gpu, GpuError};
use hemicube_radiosity::backend::{Backend, Cpu};
use hemicube_radiosity::form_factor::FormFactors;
use hemicube_radiosity::{MaterialEdit, RadiosityError, Solution};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// How long solvers step before somebody looks at the inbox.
const BURST: Duration = Duration::from_millis(15);

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
            Command::Refine(refinement) => {
                self.loader.cancel_refinement();
                self.settings.refinement = refinement;
            }
            Command::Edit(edit) => self.edit(&edit),
            Command::Watch(watch) => self.watch = watch,
            Command::Bring(number) => self.asked_for_light = number,
            Command::Loaded(ticket, result) if self.loader.is_newest(ticket) => {
                self.loader.cancel();
                self.take_over(result);
            }
            Command::Refined(ticket, result) if self.loader.is_newest(ticket) => {
                self.loader.cancel();
                self.take_refined(result);
            }
            Command::Loaded(..) | Command::Refined(..) => {}
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

    /// The light is the same, its mesh is finer.
    fn take_refined(&mut self, result: Result<Box<Solution>, String>) {
        let refined = match result {
            Ok(refined) => refined,
            Err(why) => return self.fail(&why),
        };
        if let Some(job) = &mut self.job
            && refined.mesh().elements().len() > job.elements()
        {
            self.geometry += 1;
            job.refine(*refined);
        }
    }

    fn restart(&mut self) {
        self.loader.cancel_refinement();
        if let Some(job) = &mut self.job {
            self.geometry += u64::from(job.restart(&self.settings));
        }
        self.is_running = true;
    }

    fn configure(&mut self, settings: Settings) {
        self.loader.cancel_refinement();
        let before = core::mem::replace(&mut self.settings, settings);
        let Some(job) = &mut self.job else { return };
        if settings.wants_other_mesh(&before) {
            let scene = job.start.mesh().scene().clone();
            self.loader.open(Source::Scene(scene), settings);
        } else if settings.side_by_side || before.side_by_side {
            // Only from the same start the figure is fair.
            self.geometry += u64::from(job.restart(&settings));
        } else {
            job.lanes[0].kind = settings.solver_for(job.elements());
            job.refined = None;
        }
    }

    fn edit(&mut self, edit: &MaterialEdit) {
        self.loader.cancel_refinement();
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
            if is_done {
                self.refine(lanes, job);
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

    /// Has the mesh refined where the light that was found varies, if that is wanted and was not done.
    fn refine(&mut self, lanes: &mut [Lane<'_>], job: &mut Job) {
        let wanted = self.settings.refinement;
        let is_wanted = wanted.is_some() && wanted != job.refined && self.is_running;
        let [lane] = lanes else { return };
        if is_wanted && !self.loader.is_busy() {
            job.refined = wanted;
            self.loader.refine(lane.shown(true), self.settings);
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
