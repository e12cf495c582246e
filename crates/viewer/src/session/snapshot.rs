//! What the worker shows.

use crate::session::History;
use hemicube_radiosity::form_factor::hemicube::ItemBuffers;
use hemicube_radiosity::{PatchMesh, Progress, Solution, SolverKind};
use hemicube_raster::Rgb;
use std::sync::Arc;
use std::time::Instant;

/// The light at one time. Nothing in it changes any more.
#[derive(Debug, Clone)]
pub struct Snapshot {
    /// Grows with each snapshot.
    pub serial: u64,
    /// Snapshots with the same number have the same patches, elements and vertices.
    pub geometry: u64,
    /// What runs, one or several side by side; never empty.
    pub lanes: Vec<LaneView>,
    /// The light group of each material that emits.
    pub source_of_material: Arc<Vec<Option<usize>>>,
    /// The hemicube that was asked for.
    pub hemicube: Option<Arc<HemicubePicture>>,
    /// The form factors that were asked for.
    pub row: Option<Arc<PatchRow>>,
}

impl Snapshot {
    /// The mesh of all lanes.
    pub fn mesh(&self) -> &Arc<PatchMesh> {
        self.lanes[0].solution.mesh()
    }
}

/// One way to the light.
#[derive(Debug, Clone)]
pub struct LaneView {
    /// Which.
    pub kind: SolverKind,
    /// Its light.
    pub solution: Arc<Solution>,
    /// The estimate of the light to come, for display; black where the way has none.
    pub ambient: Rgb,
    /// Where it is.
    pub progress: Progress,
    /// The patch whose turn is next.
    pub shooter: Option<usize>,
    /// How it came there.
    pub history: Arc<History>,
    /// Whether it is at its end.
    pub is_finished: bool,
}

/// What a patch sees through the five faces of its hemicube.
#[derive(Debug, Clone)]
pub struct HemicubePicture {
    /// Position among the mesh's patches.
    pub patch: usize,
    /// The elements in each cell.
    pub buffers: ItemBuffers,
}

/// Form factors of one patch.
#[derive(Debug, Clone)]
pub struct PatchRow {
    /// Position among the mesh's patches.
    pub patch: usize,
    /// Factor to each element, the mean over bands.
    pub fractions: Vec<f32>,
}

/// What the worker is doing.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Phase {
    /// Nothing: there is no scene.
    #[default]
    Empty,
    /// What steps need before the first of them.
    Preparing,
    /// Steps.
    Solving,
    /// Nothing, since it was told to.
    Paused,
    /// Nothing, since the light is found.
    Finished,
}

impl Phase {
    /// As the status bar shows it.
    pub fn label(self) -> &'static str {
        match self {
            Self::Empty => "no scene",
            Self::Preparing => "preparing",
            Self::Solving => "solving",
            Self::Paused => "paused",
            Self::Finished => "finished",
        }
    }
}

/// What the worker is doing, in words.
#[derive(Debug, Clone, Default)]
pub struct Status {
    /// In one word.
    pub phase: Phase,
    /// Name of the scene that is solved.
    pub scene: String,
    /// What it was opened by: a path or a built-in name.
    pub source: Option<String>,
    /// A scene that is on its way.
    pub opening: Option<Opening>,
    /// What went wrong, in one line, until somebody has read it.
    pub error: Option<String>,
    /// What a user should know.
    pub note: Option<String>,
    /// Warnings from the scene's file.
    pub warnings: Vec<String>,
    /// Steps done in the last second.
    pub steps_per_second: f64,
}

/// A scene that is on its way.
#[derive(Debug, Clone)]
pub struct Opening {
    /// Its name.
    pub name: String,
    /// What is done right now.
    pub stage: &'static str,
    /// Since when it is on its way.
    pub since: Instant,
}
