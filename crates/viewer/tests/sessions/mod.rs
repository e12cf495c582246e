//! Sessions without a window, for tests.

use hemicube_gpu::Context;
use hemicube_viewer::session::{Command, Session, Settings, Snapshot, Source, Status};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// A session that opens a scene, and solves on a device if one is given.
pub fn opened(settings: Settings, scene: &str, device: Option<Arc<Context>>) -> Session {
    let session = Session::start(settings);
    if let Some(device) = device {
        session.solve_on(device);
    }
    session.send(Command::Open(Source::Named(scene.to_owned())));
    session
}

/// The first snapshot and status that are as wanted.
pub fn wait(
    session: &Session,
    what: &str,
    wanted: impl Fn(&Snapshot, &Status) -> bool,
) -> Arc<Snapshot> {
    let begin = Instant::now();
    loop {
        let status = session.status();
        let snapshot = session.snapshot().filter(|snap| wanted(snap, &status));
        if let Some(snapshot) = snapshot {
            return snapshot;
        }
        let time = begin.elapsed();
        assert!(time < Duration::from_secs(90), "{what}: {status:?}");
        std::thread::sleep(Duration::from_millis(2));
    }
}
