//! The model behind the window: a thread that owns scene, mesh and solvers, and what it shows of them.
//!
//! The window sends [`Command`]s and reads the newest [`Snapshot`]; neither ever waits for the other. Commands that a
//! later one makes void are dropped ([`Inbox`]), snapshots that nobody looked at are replaced, histories thin out: nothing grows with
//! time. Opening a scene is the work of yet another thread, so the light that is there goes on being refined meanwhile and
//! stays if the new scene cannot be used.

mod command;
mod device_lane;
mod figures;
mod history;
mod inbox;
mod job;
mod lane;
mod loader;
mod mixer;
mod settings;
mod snapshot;
mod worker;

pub use command::{Command, Source, Watch};
pub use history::{History, Moment};
pub use inbox::Inbox;
pub use mixer::{Mix, MixGroup, MixSource, Mixer};
pub use settings::{Asked, FactorsBy, MeshSizes, Refinement, Settings, VARIANTS};
pub use snapshot::{HemicubePicture, LaneView, OnDevice, PatchRow, Phase, Snapshot, Status};

use hemicube_gpu::Context;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

/// A worker thread and what it says.
#[derive(Clone)]
pub struct Session {
    inbox: Arc<Inbox>,
    board: Arc<Board>,
    /// The last handle that is dropped ends the thread.
    _end: Arc<EndOnDrop>,
}

impl core::fmt::Debug for Session {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("Session")
            .field("status", &self.status())
            .finish_non_exhaustive()
    }
}

/// What the worker shows and the window reads.
pub(crate) struct Board {
    snapshot: Mutex<Option<Arc<Snapshot>>>,
    status: Mutex<Status>,
    /// Least microseconds between two snapshots.
    pace: AtomicU64,
    wake: Mutex<Box<dyn Fn() + Send>>,
    /// The device that the window draws with.
    device: Mutex<Option<Arc<Context>>>,
}

struct EndOnDrop {
    inbox: Arc<Inbox>,
    _threads: rayon::ThreadPool,
}

impl Drop for EndOnDrop {
    fn drop(&mut self) {
        self.inbox.send(Command::Quit);
    }
}

impl Session {
    /// Starts the thread; it waits for commands.
    pub fn start(settings: Settings) -> Self {
        let inbox = Arc::new(Inbox::default());
        let board = Arc::new(Board {
            snapshot: Mutex::new(None),
            status: Mutex::new(Status::default()),
            pace: AtomicU64::new(33_000),
            wake: Mutex::new(Box::new(|| {})),
            device: Mutex::new(None),
        });
        let worker = worker::Worker::new(inbox.clone(), board.clone(), settings);
        // It is one of the threads that it computes with.
        let threads = background_pool();
        threads.spawn(move || worker.run());
        Self {
            _end: Arc::new(EndOnDrop {
                inbox: inbox.clone(),
                _threads: threads,
            }),
            inbox,
            board,
        }
    }

    /// `wake` is called, from the worker's thread, when there is something new to see.
    pub fn wake_by(&self, wake: impl Fn() + Send + 'static) {
        *lock(&self.board.wake) = Box::new(wake);
    }

    /// Where solvers use a GPU they use this device, whose window can then draw from their buffers. To be told before
    /// anything is opened.
    pub fn solve_on(&self, device: Arc<Context>) {
        *lock(&self.board.device) = Some(device);
    }

    /// Least time between two states of the light while it is solved: as often as the window can show it. At first 33 ms.
    pub fn set_pace(&self, pace: Duration) {
        let micros = u64::try_from(pace.as_micros()).unwrap_or(u64::MAX);
        self.board.pace.store(micros, Ordering::Relaxed);
    }

    /// Asks for something; returns at once.
    pub fn send(&self, command: Command) {
        self.inbox.send(command);
    }

    /// The newest state of the light.
    pub fn snapshot(&self) -> Option<Arc<Snapshot>> {
        lock(&self.board.snapshot).clone()
    }

    /// What the worker is doing.
    pub fn status(&self) -> Status {
        lock(&self.board.status).clone()
    }

    /// The message that is shown was read.
    pub fn dismiss_error(&self) {
        lock(&self.board.status).error = None;
    }
}

impl Board {
    pub(crate) fn show(&self, snapshot: Snapshot) {
        *lock(&self.snapshot) = Some(Arc::new(snapshot));
        self.wake();
    }

    pub(crate) fn set_status(&self, change: impl FnOnce(&mut Status)) {
        change(&mut lock(&self.status));
        self.wake();
    }

    /// The device that the window draws with.
    pub(crate) fn device(&self) -> Option<Arc<Context>> {
        lock(&self.device).clone()
    }

    /// Least time between two snapshots.
    pub(crate) fn pace(&self) -> Duration {
        Duration::from_micros(self.pace.load(Ordering::Relaxed))
    }

    fn wake(&self) {
        (lock(&self.wake))();
    }
}

/// What a panic left behind is still what was last shown.
pub(crate) fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Threads for work in the background: all cores but one, which the window draws with. Where the processor draws, it
/// draws with all cores; therefore these threads let it go first.
pub(crate) fn background_pool() -> rayon::ThreadPool {
    pool("background", stand_back)
}

/// Threads for what the window waits for.
pub(crate) fn waited_for_pool() -> rayon::ThreadPool {
    pool("loader", || {})
}

fn pool(name: &'static str, begin: impl Fn() + Send + Sync + 'static) -> rayon::ThreadPool {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    rayon::ThreadPoolBuilder::new()
        .num_threads(cores.saturating_sub(1).max(1))
        .thread_name(move |i| format!("{name} {i}"))
        .start_handler(move |_| begin())
        .build()
        .expect("threads can be started")
}

/// How much a thread stands back: it gets a third of what the window gets while both want the processor, and all that
/// is left.
#[cfg(target_os = "linux")]
const NICENESS: i32 = 5;

/// Lets the window go first. Only Linux has priorities of single threads that need no rights.
fn stand_back() {
    #[cfg(target_os = "linux")]
    {
        // Where that is refused the thread works as it is.
        let _ = rustix::process::nice(NICENESS);
    }
}
