//! What is done with all light of the scene, and waits for it where a device keeps it.

use crate::desk::{Desk, Pick};
use crate::session::Command;
use std::path::PathBuf;

/// Something to be done when the light is here.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Errand {
    /// A file is written.
    Save(Pick, PathBuf),
    /// A grid is measured.
    Grid,
}

impl Desk {
    /// Does it now if the light is here, else as soon as it has come.
    pub(super) fn send_on(&mut self, errand: Errand) {
        if self.has_light() {
            return self.run(errand);
        }
        self.errands.push(errand);
        self.wish += 1;
        self.session.send(Command::Bring(self.wish));
    }

    /// Whether the newest light of the first pane is here, or there is none at all.
    pub fn has_light(&self) -> bool {
        let lane = |snapshot: &std::sync::Arc<crate::session::Snapshot>| {
            let lane = self.panes.first().map_or(0, |pane| pane.lane);
            snapshot.lanes.get(lane).is_none_or(|lane| lane.has_light())
        };
        self.snapshot.as_ref().is_none_or(lane)
    }

    /// Does what has waited, if its light has come.
    pub(super) fn run_errands(&mut self) {
        let snapshot = self.snapshot.as_ref();
        let has_come = snapshot.is_some_and(|snapshot| snapshot.brought >= self.wish);
        if has_come || self.has_light() {
            for errand in core::mem::take(&mut self.errands) {
                self.run(errand);
            }
        }
    }

    fn run(&mut self, errand: Errand) {
        match errand {
            Errand::Save(pick, path) => self.save(pick, path),
            Errand::Grid => self.start_grid(),
        }
    }
}
