//! What takes long, beside everything else: opening a scene (reading, meshing, first light), refining a mesh.

use crate::format::thousands;
use crate::session::snapshot::Opening;
use crate::session::{Board, Command, Inbox, Settings, Source, background_pool, waited_for_pool};
use hemicube_radiosity::export::lit_glb;
use hemicube_radiosity::{RadiosityError, Solution, SolveOptions, resume_until, unlit};
use hemicube_scene::{Scene, open, open_bytes};
use std::borrow::Cow;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

/// Largest file that is read.
const MAX_BYTES: u64 = 2 << 30;

/// Opens scenes and refines meshes, each on a thread of its own; a newer one makes the older ones void.
pub(super) struct Loader {
    inbox: Arc<Inbox>,
    board: Arc<Board>,
    newest: Arc<AtomicU64>,
    /// Whether something is on its way, and whether it is a refined mesh.
    is_busy: bool,
    refines: bool,
}

impl Loader {
    pub(super) fn new(inbox: Arc<Inbox>, board: Arc<Board>) -> Self {
        Self {
            inbox,
            board,
            newest: Arc::default(),
            is_busy: false,
            refines: false,
        }
    }

    /// Whether a result is still wanted.
    pub(super) fn is_newest(&self, ticket: u64) -> bool {
        self.newest.load(Ordering::Acquire) == ticket
    }

    /// Whether something is on its way.
    pub(super) fn is_busy(&self) -> bool {
        self.is_busy
    }

    /// Makes void what is on its way.
    pub(super) fn cancel(&mut self) {
        self.newest.fetch_add(1, Ordering::AcqRel);
        (self.is_busy, self.refines) = (false, false);
        self.board.set_status(|status| status.opening = None);
    }

    /// Makes void what is on its way if that is a refined mesh.
    pub(super) fn cancel_refinement(&mut self) {
        if self.refines {
            self.cancel();
        }
    }

    /// Starts to open a scene; [`Command::Loaded`] tells when it is there.
    pub(super) fn open(&mut self, source: Source, settings: Settings) {
        let name = match &source {
            Source::Named(name) | Source::Adjusted(name, _) => name.clone(),
            Source::Scene(scene) => scene.name.clone(),
        };
        let work = move |job: &Job| job.open(source, settings);
        self.start("Opening", name, work, Command::Loaded);
    }

    /// Starts to refine the mesh of a light that was found; [`Command::Refined`] tells when it is there.
    pub(super) fn refine(&mut self, solution: Arc<Solution>, settings: Settings) {
        let mesh = solution.mesh();
        let options = SolveOptions {
            solver: settings.solver_for(mesh.elements().len()),
            ..settings.solve_options()
        };
        let name = mesh.scene().name.clone();
        let work = move |job: &Job| job.refine(&solution, &options);
        self.start("Refining", name, work, Command::Refined);
        self.refines = true;
    }

    fn start(
        &mut self,
        what: &'static str,
        name: String,
        work: impl FnOnce(&Job) -> Result<Solution, String> + Send + 'static,
        tell: fn(u64, Result<Box<Solution>, String>) -> Command,
    ) {
        self.cancel();
        self.is_busy = true;
        let job = Job {
            ticket: self.newest.load(Ordering::Acquire),
            newest: self.newest.clone(),
            board: self.board.clone(),
            since: Instant::now(),
            what,
            name,
        };
        let inbox = self.inbox.clone();
        let work = move || {
            let done = std::panic::catch_unwind(core::panic::AssertUnwindSafe(|| work(&job)));
            let result = done.unwrap_or_else(|_| Err(job.broke()));
            if job.is_wanted() {
                inbox.send(tell(job.ticket, result.map(Box::new)));
            }
        };
        std::thread::Builder::new()
            .name(String::from("loader"))
            .spawn(work)
            .expect("a thread can be started");
    }
}

/// One scene or mesh on its way.
struct Job {
    ticket: u64,
    newest: Arc<AtomicU64>,
    board: Arc<Board>,
    since: Instant,
    what: &'static str,
    name: String,
}

impl Job {
    fn is_wanted(&self) -> bool {
        self.newest.load(Ordering::Acquire) == self.ticket
    }

    fn broke(&self) -> String {
        let Self { what, name, .. } = self;
        let what = what.to_lowercase();
        format!("{name}: the program broke while {what} it; please report it with the file")
    }

    fn at(&self, stage: impl Into<Cow<'static, str>>) {
        if self.is_wanted() {
            let opening = Opening {
                what: self.what,
                name: self.name.clone(),
                stage: stage.into(),
                since: self.since,
            };
            self.board
                .set_status(|status| status.opening = Some(opening));
        }
    }

    fn open(&self, source: Source, settings: Settings) -> Result<Solution, String> {
        self.at("reading");
        let scene = match source {
            Source::Scene(scene) => scene,
            Source::Named(name) => match read(&name)? {
                Input::Lit(solution) => return Ok(*solution),
                Input::Scene(scene) => Arc::new(*scene),
            },
            Source::Adjusted(name, changes) => {
                let mut scene = match read(&name)? {
                    Input::Lit(solution) => Scene::clone(solution.mesh().scene()),
                    Input::Scene(scene) => *scene,
                };
                scene.apply(&changes).map_err(|error| error.to_string())?;
                Arc::new(scene)
            }
        };
        if !self.is_wanted() {
            return Err(String::from("no longer wanted"));
        }
        self.at("meshing and first light");
        let stop = || !self.is_wanted();
        let made = waited_for_pool().install(|| unlit(scene, &settings.solve_options(), &stop));
        made.map_err(|error| match error {
            RadiosityError::NoLight(_) => format!(
                "{error} (open a scene with lights, or give a material an emission in its file)"
            ),
            _ => error.to_string(),
        })
    }
}

impl Job {
    /// The light on a mesh that is finer where it varies. The processor works at it, which leaves the window's device to
    /// the window.
    fn refine(&self, solution: &Solution, options: &SolveOptions) -> Result<Solution, String> {
        let stop = || !self.is_wanted();
        let mut told = 0;
        let mut tell = |light: &Solution| {
            let elements = light.mesh().elements().len();
            if elements != told {
                told = elements;
                self.at(format!("{} elements", thousands(elements as f64)));
            }
            self.is_wanted()
        };
        self.at("looking for contrast");
        let refined = || resume_until(solution.clone(), options, &stop, |_, light| tell(light));
        let refined = background_pool().install(refined);
        refined.map_err(|error| error.to_string())
    }
}

enum Input {
    Scene(Box<Scene>),
    Lit(Box<Solution>),
}

/// A scene, or a solved one, by path or built-in name.
fn read(name: &str) -> Result<Input, String> {
    let path = Path::new(name);
    if !path.is_file() {
        let scene = open(name).map_err(|error| error.to_string())?;
        return Ok(Input::Scene(Box::new(scene)));
    }
    let refused = |why: String| format!("{name}: {why}");
    let size = path
        .metadata()
        .map_err(|error| refused(error.to_string()))?
        .len();
    if size > MAX_BYTES {
        return Err(refused(format!(
            "it has {size} bytes, at most {MAX_BYTES} are read"
        )));
    }
    let bytes = std::fs::read(path).map_err(|error| refused(error.to_string()))?;
    if lit_glb::is_lit(&bytes) {
        let solution = lit_glb::read(&bytes).map_err(|error| refused(error.to_string()))?;
        return Ok(Input::Lit(Box::new(solution)));
    }
    let folder = path
        .parent()
        .filter(|folder| !folder.as_os_str().is_empty());
    let scene = open_bytes(&bytes, name, Some(folder.unwrap_or(Path::new("."))));
    Ok(Input::Scene(Box::new(
        scene.map_err(|error| error.to_string())?,
    )))
}
