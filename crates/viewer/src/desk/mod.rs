//! Everything that the window shows and changes, without the window: panels read and write it, tests too.

mod dialogs;
mod errands;
mod files;
mod scene;
mod view;

pub use dialogs::{Answer, Dialogs, Pick};
pub use view::Motion;

use crate::display::{Display, Quantity};
use crate::document::{Document, EditedMaterial};
use crate::film_job::FilmJob;
use crate::frames::FrameTimes;
use crate::light::Light;
use crate::measure::{Grid, GridJob, GridOptions, Reading};
use crate::prefs::Prefs;
use crate::session::{Command, LaneView, Mixer, Session, Snapshot, Source, Status, Watch};
use crate::walk::{Body, Eye, EyeMode, Path};
use errands::Errand;
use glam::Vec3;
use hemicube_gpu::pass::Meter;
use hemicube_radiosity::Solution;
use hemicube_raster::Rgb;
use hemicube_scene::{Scene, SceneOptions};
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Called from any thread when there is something new to see.
pub type Wake = Arc<dyn Fn() + Send + Sync>;

/// Most lightings that are shown side by side.
const MOST_LIGHTINGS: usize = 4;
/// How long a notice stays.
const NOTICE: Duration = Duration::from_secs(6);

/// The state of the window.
pub struct Desk {
    /// The solver's thread.
    pub session: Session,
    /// What is remembered.
    pub prefs: Prefs,
    /// The newest light.
    pub snapshot: Option<Arc<Snapshot>>,
    /// What the solver is doing.
    pub status: Status,
    /// Pictures, one or several; empty without a scene.
    pub panes: Vec<Pane>,
    /// Grows whenever the light of a pane changes.
    pub light_serial: u64,
    /// Factor on all light that the picture shows.
    pub exposure: f32,
    /// Top of the scale of false colours, in lx.
    pub scale_top: f32,
    /// Where one looks from.
    pub eye: Eye,
    /// Speed downwards of one who falls.
    pub falling: f32,
    /// Who walks.
    pub body: Body,
    /// Levels and groups of light.
    pub mixer: Mixer,
    /// Whether kept lightings are shown side by side.
    pub compares_lightings: bool,
    /// The surface that was clicked.
    pub selection: Option<Reading>,
    /// What is under the pointer.
    pub hover: Option<Reading>,
    /// How fine the next grid is.
    pub grid_options: GridOptions,
    /// The last grid.
    pub grid: Option<Grid>,
    /// One that is being measured.
    pub grid_job: Option<GridJob>,
    /// The recorded way.
    pub path: Path,
    /// Seconds since the way is played.
    pub playing: Option<f32>,
    /// A film that is being drawn.
    pub film: Option<FilmJob>,
    /// Materials as they were edited, by name.
    pub edited: BTreeMap<String, EditedMaterial>,
    /// Whether the hemicube of the patch that shoots is shown.
    pub shows_hemicube: bool,
    /// Whether its section is to be unfolded in the next frame.
    pub unfolds_hemicube: bool,
    /// Whether the hemicube shows light instead of one colour for each patch.
    pub hemicube_lit: bool,
    /// Whether help is shown.
    pub shows_help: bool,
    /// Text of the field for paths.
    pub typed_path: String,
    /// A file that is typed because the system has no dialogs, and what for.
    pub typed_file: Option<(Pick, String)>,
    /// Name of the lighting that is about to be kept.
    pub typed_lighting: String,
    /// What was just done, or went wrong beside the solver.
    pub notice: Option<Notice>,
    /// File dialogs.
    pub dialogs: Dialogs,
    /// A picture that somebody wants as a file.
    pub wanted_picture: Option<PathBuf>,
    /// How long frames take.
    pub frames: FrameTimes,
    /// Whether the scene is on its way to the device that draws.
    pub waits_for_device: bool,
    /// A session that waits for its scene.
    pending: Option<Document>,
    /// Where the eye was in the last frame, and when it last moved.
    seen: Option<Eye>,
    moved: Option<Instant>,
    /// The scene as its file has it.
    original: Option<Arc<Scene>>,
    /// What the exposure and the scale were worked out for.
    exposed: Option<(u64, Display)>,
    /// How bright the light on the device is, and of which geometry.
    meter: Option<(u64, Meter)>,
    /// What waits for light from a device, and the number of the wish for it.
    errands: Vec<Errand>,
    wish: u64,
    /// The scene that one stands in, by what it was opened by.
    entered: Option<String>,
    watch: Watch,
    /// Between two times that new light is taken over, and what is left of it while such light waits.
    pause: Option<Pause>,
    pub(crate) due: Option<Duration>,
    /// Name of the camera that the next scene is entered by.
    pub camera: Option<String>,
    wake: Wake,
}

/// One picture.
#[derive(Debug, Clone)]
pub struct Pane {
    /// What it shows, in a few words; empty if it is the only one.
    pub title: String,
    /// Which of the snapshot's lanes.
    pub lane: usize,
    /// Factors of light groups.
    pub dims: Vec<Rgb>,
    /// The light as dimmed, as far as it is known here.
    pub light: Arc<Light>,
    /// What that is the light of.
    pub solution: Arc<Solution>,
}

impl Pane {
    /// Irradiance of an element in its lane's newest light, if that is known here.
    pub fn irradiance(&self, lane: &LaneView, element: usize) -> Option<Rgb> {
        if lane.has_light() {
            return Some(self.light.irradiance[element]);
        }
        lane.watched(element, &self.dims)
    }
}

/// Time that is left to input: new light is taken over for at most a fifth of the time, however large the scene is.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Pause {
    ends: Instant,
}

impl Pause {
    /// After something that began then and ends now.
    pub(crate) fn after(begin: Instant) -> Self {
        let now = Instant::now();
        Self {
            ends: now + 4 * (now - begin),
        }
    }

    /// What is left of it.
    pub(crate) fn left(self) -> Option<Duration> {
        let left = self.ends.saturating_duration_since(Instant::now());
        (!left.is_zero()).then_some(left)
    }
}

/// What was just done.
#[derive(Debug, Clone)]
pub struct Notice {
    /// In one line.
    pub text: String,
    /// Whether it went wrong.
    pub is_error: bool,
    since: Instant,
}

impl Desk {
    /// A desk without a scene.
    pub fn new(prefs: Prefs, wake: Wake) -> Self {
        let session = Session::start(prefs.settings);
        let awake = wake.clone();
        session.wake_by(move || awake());
        Self {
            session,
            prefs,
            snapshot: None,
            status: Status::default(),
            panes: Vec::new(),
            light_serial: 0,
            exposure: 1.0,
            scale_top: 1.0,
            eye: Eye {
                position: Vec3::ZERO,
                yaw: 0.0,
                pitch: 0.0,
                vertical_fov: 1.0,
                distance: 1.0,
                mode: EyeMode::Walk,
            },
            falling: 0.0,
            body: Body::in_scene(5.0),
            mixer: Mixer::default(),
            compares_lightings: false,
            selection: None,
            hover: None,
            grid_options: GridOptions::default(),
            grid: None,
            grid_job: None,
            path: Path::default(),
            playing: None,
            film: None,
            edited: BTreeMap::new(),
            shows_hemicube: false,
            unfolds_hemicube: false,
            hemicube_lit: false,
            shows_help: false,
            typed_path: String::new(),
            typed_file: None,
            typed_lighting: String::new(),
            notice: None,
            dialogs: Dialogs::default(),
            wanted_picture: None,
            frames: FrameTimes::default(),
            waits_for_device: false,
            pending: None,
            seen: None,
            moved: None,
            original: None,
            exposed: None,
            meter: None,
            errands: Vec::new(),
            wish: 0,
            entered: None,
            watch: Watch::default(),
            pause: None,
            due: None,
            camera: None,
            wake,
        }
    }

    /// Takes over what is new; to be called once a frame.
    pub fn refresh(&mut self) {
        self.status = self.session.status();
        let newest = self.session.snapshot();
        let serial = |snapshot: &Option<Arc<Snapshot>>| snapshot.as_ref().map(|s| s.serial);
        let is_other = serial(&newest) != serial(&self.snapshot);
        self.due = self.pause.filter(|_| is_other).and_then(Pause::left);
        let is_new = is_other && self.due.is_none();
        let begin = Instant::now();
        if let Some(snapshot) = newest.filter(|_| is_new) {
            self.take_over(snapshot);
        }
        self.refresh_panes(is_new);
        self.refresh_exposure();
        self.run_errands();
        if is_new {
            self.pause = Some(Pause::after(begin));
        }
        self.refresh_readings();
        self.finish_jobs();
        self.refresh_watch();
        if self
            .notice
            .as_ref()
            .is_some_and(|notice| notice.since.elapsed() > NOTICE)
        {
            self.notice = None;
        }
    }

    fn take_over(&mut self, snapshot: Arc<Snapshot>) {
        let is_other_mesh = self
            .snapshot
            .as_ref()
            .is_none_or(|old| old.geometry != snapshot.geometry);
        let names: Vec<String> = snapshot.lanes[0]
            .solution
            .groups()
            .iter()
            .map(|g| g.name.clone())
            .collect();
        self.mixer.follow(names.iter().map(String::as_str));
        self.snapshot = Some(snapshot);
        if is_other_mesh {
            self.enter();
        }
    }

    /// Works out what panes there are, and the light of each where it changed.
    fn refresh_panes(&mut self, is_new: bool) {
        let Some(snapshot) = &self.snapshot else {
            return;
        };
        let wanted = self.wanted_panes(snapshot);
        let is_same = wanted.len() == self.panes.len()
            && wanted
                .iter()
                .zip(&self.panes)
                .all(|((lane, dims, _), pane)| (*lane, dims) == (pane.lane, &pane.dims));
        if is_same && !is_new {
            return;
        }
        let before = &self.panes;
        let pane = |(lane, dims, title): (usize, Vec<Rgb>, String)| {
            let solution = &snapshot.lanes[lane].solution;
            // Light that a device keeps is not always new here.
            let is_same = |pane: &&Pane| Arc::ptr_eq(&pane.solution, solution) && pane.dims == dims;
            let known = before.iter().find(is_same).map(|pane| pane.light.clone());
            Pane {
                light: known.unwrap_or_else(|| Arc::new(Light::new(solution, &dims))),
                solution: solution.clone(),
                title,
                lane,
                dims,
            }
        };
        self.panes = wanted.into_iter().map(pane).collect();
        self.light_serial += 1;
    }

    fn wanted_panes(&self, snapshot: &Snapshot) -> Vec<(usize, Vec<Rgb>, String)> {
        let dims = self.mixer.dims();
        if snapshot.lanes.len() > 1 {
            let lane =
                |(i, lane): (usize, &LaneView)| (i, dims.clone(), lane.kind.name().to_owned());
            return snapshot.lanes.iter().enumerate().map(lane).collect();
        }
        if self.compares_lightings && !self.mixer.scenes.is_empty() {
            let scenes = self.mixer.scenes.iter().take(MOST_LIGHTINGS);
            return scenes
                .map(|scene| (0, self.mixer.dims_of(scene), scene.name.clone()))
                .collect();
        }
        vec![(0, dims, String::new())]
    }

    fn refresh_exposure(&mut self) {
        let wanted = Some((self.light_serial, self.prefs.display));
        if self.exposed != wanted {
            self.exposure = self.exposure_factor();
            self.scale_top = self.top_of_scale();
            self.exposed = wanted;
        }
    }

    /// Numbers of the selection follow the light.
    pub(super) fn refresh_readings(&mut self) {
        let (Some(snapshot), Some(pane)) = (&self.snapshot, self.panes.first()) else {
            return;
        };
        let (mesh, lane) = (snapshot.mesh(), &snapshot.lanes[pane.lane]);
        for reading in [&mut self.selection, &mut self.hover].into_iter().flatten() {
            let Some(e) = reading.element else { continue };
            let known = pane.irradiance(lane, e);
            reading.irradiance = known.unwrap_or(Rgb::splat(f32::NAN));
            reading.radiosity = pane.light.exitance[e] + mesh.reflectance()[e] * reading.irradiance;
            reading.illuminance = mesh.scene().units.illuminance(reading.irradiance);
        }
    }

    fn finish_jobs(&mut self) {
        if let Some(grid) = self.grid_job.as_ref().and_then(GridJob::take) {
            self.grid = Some(grid);
            self.grid_job = None;
        }
        if let Some(film) = self.film.as_ref().and_then(FilmJob::take) {
            self.film = None;
            match film {
                Ok(path) => self.tell(format!("wrote {}", path.display())),
                Err(why) => self.complain(why),
            }
        }
        while let Some(answer) = self.dialogs.answer() {
            match answer {
                Answer::Picked(pick, path) => self.picked(pick, path),
                Answer::Closed => {}
                Answer::NoDialog(pick, name) => self.typed_file = Some((pick, name)),
            }
        }
    }

    fn refresh_watch(&mut self) {
        let wants_row = self.prefs.display.quantity == Quantity::FormFactors;
        let watch = Watch {
            hemicube: self.shows_hemicube,
            row_of: self.selected_patch().filter(|_| wants_row),
            elements: [&self.selection, &self.hover]
                .map(|reading| reading.as_ref().and_then(|reading| reading.element)),
        };
        if watch != self.watch {
            self.watch = watch;
            self.session.send(Command::Watch(watch));
        }
    }

    /// The patch over the selected element.
    pub fn selected_patch(&self) -> Option<usize> {
        let element = self.selection.as_ref()?.element?;
        Some(self.snapshot.as_ref()?.mesh().patch_of_element(element))
    }

    /// Shows in a line what was done.
    pub fn tell(&mut self, text: impl Into<String>) {
        self.notice = Some(Notice {
            text: text.into(),
            is_error: false,
            since: Instant::now(),
        });
    }

    /// Shows in a line what went wrong.
    pub fn complain(&mut self, text: impl Into<String>) {
        self.notice = Some(Notice {
            text: text.into(),
            is_error: true,
            since: Instant::now(),
        });
    }

    /// Something that wakes the window from another thread.
    pub fn wake(&self) -> Wake {
        self.wake.clone()
    }

    /// Opens a file or a built-in scene, or goes on with a session.
    pub fn open(&mut self, name: &str) {
        self.open_changed(name, None);
    }

    /// Opens a file or a built-in scene with changes.
    pub fn open_changed(&mut self, name: &str, changes: Option<SceneOptions>) {
        if Document::is_named(name) && std::path::Path::new(name).is_file() {
            self.open_document(name);
            return;
        }
        self.pending = None;
        let name = name.to_owned();
        self.session.send(Command::Open(match changes {
            Some(changes) => Source::Adjusted(name, Box::new(changes)),
            None => Source::Named(name),
        }));
    }
}
