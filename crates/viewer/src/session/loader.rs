//! Opening a scene beside everything else: reading, meshing, first light.

use crate::session::snapshot::Opening;
use crate::session::{Board, Command, Inbox, Settings, Source, waited_for_pool};
use hemicube_radiosity::export::lit_glb;
use hemicube_radiosity::{RadiosityError, Solution, unlit};
use hemicube_scene::{Scene, open, open_bytes};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

/// Largest file that is read.
const MAX_BYTES: u64 = 2 << 30;

/// Opens scenes, each on a thread of its own; a newer one makes the older ones void.
pub(super) struct Loader {
    inbox: Arc<Inbox>,
    board: Arc<Board>,
    newest: Arc<AtomicU64>,
}

impl Loader {
    pub(super) fn new(inbox: Arc<Inbox>, board: Arc<Board>) -> Self {
        Self {
            inbox,
            board,
            newest: Arc::default(),
        }
    }

    /// Whether a result is still wanted.
    pub(super) fn is_newest(&self, ticket: u64) -> bool {
        self.newest.load(Ordering::Acquire) == ticket
    }

    /// Makes void what is on its way.
    pub(super) fn cancel(&self) {
        self.newest.fetch_add(1, Ordering::AcqRel);
        self.board.set_status(|status| status.opening = None);
    }

    /// Starts to open a scene; [`Command::Loaded`] tells when it is there.
    pub(super) fn open(&self, source: Source, settings: Settings) {
        self.cancel();
        let ticket = self.newest.load(Ordering::Acquire);
        let job = Job {
            ticket,
            newest: self.newest.clone(),
            board: self.board.clone(),
            since: Instant::now(),
            name: match &source {
                Source::Named(name) | Source::Adjusted(name, _) => name.clone(),
                Source::Scene(scene) => scene.name.clone(),
            },
        };
        let inbox = self.inbox.clone();
        let work = move || {
            let opened = std::panic::catch_unwind(core::panic::AssertUnwindSafe(|| {
                job.open(source, settings)
            }));
            let result = opened.unwrap_or_else(|_| {
                Err(format!(
                    "{}: the program broke while it was opened; please report it with the file",
                    job.name
                ))
            });
            if job.is_wanted() {
                inbox.send(Command::Loaded(ticket, result.map(Box::new)));
            }
        };
        std::thread::Builder::new()
            .name(String::from("loader"))
            .spawn(work)
            .expect("a thread can be started");
    }
}

/// One scene on its way.
struct Job {
    ticket: u64,
    newest: Arc<AtomicU64>,
    board: Arc<Board>,
    since: Instant,
    name: String,
}

impl Job {
    fn is_wanted(&self) -> bool {
        self.newest.load(Ordering::Acquire) == self.ticket
    }

    fn at(&self, stage: &'static str) {
        if self.is_wanted() {
            let opening = Opening {
                name: self.name.clone(),
                stage,
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
