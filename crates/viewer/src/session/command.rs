//! What the window asks of the worker.

use crate::session::{Refinement, Settings};
use hemicube_radiosity::{MaterialEdit, Solution};
use hemicube_scene::{Scene, SceneOptions};
use std::sync::Arc;

/// What the window asks of the worker.
#[derive(Debug, Clone)]
pub enum Command {
    /// Another scene; the light of the one before goes on until it is there.
    Open(Source),
    /// No other scene after all; what is solved goes on.
    Cancel,
    /// Steps, one after the other.
    Run,
    /// No steps.
    Pause,
    /// One step, then a pause.
    Step,
    /// Back to the light before the first step, edits included.
    Restart,
    /// Other ways to the light; goes on from the one that there is where the mesh stays.
    Configure(Settings),
    /// Whether the mesh is refined once the light is found, and how. It gets no coarser.
    Refine(Option<Refinement>),
    /// Another material; only the difference is shot.
    Edit(MaterialEdit),
    /// What else is shown.
    Watch(Watch),
    /// Light that a device keeps is wanted here, too; the snapshot with it has this number as [`Snapshot::brought`].
    ///
    /// [`Snapshot::brought`]: crate::session::Snapshot::brought
    Bring(u64),
    /// Scene or light are here; from the loader.
    Loaded(u64, Result<Box<Solution>, String>),
    /// A refined mesh and its light are here; from the loader.
    Refined(u64, Result<Box<Solution>, String>),
    /// The end.
    Quit,
}

impl Command {
    /// Whether solvers may go on through it as they are.
    pub(crate) fn is_light(&self) -> bool {
        matches!(
            self,
            Self::Run
                | Self::Pause
                | Self::Step
                | Self::Watch(_)
                | Self::Bring(_)
                | Self::Refine(_)
                | Self::Cancel
                | Self::Open(_)
        )
    }
}

/// Where a scene comes from.
#[derive(Debug, Clone)]
pub enum Source {
    /// A file, lit or not, or the name of a built-in scene.
    Named(String),
    /// The same with changes; the light of a lit file is lost.
    Adjusted(String, Box<SceneOptions>),
    /// One that is here already, for another mesh.
    Scene(Arc<Scene>),
}

/// Figures beside the light.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Watch {
    /// Whether the hemicube of the patch that shoots next is wanted. Default value: no.
    pub hemicube: bool,
    /// The patch whose form factors are wanted. Default value: none.
    pub row_of: Option<usize>,
    /// Elements whose light is wanted while a device keeps it. Default value: none.
    pub elements: [Option<usize>; 2],
}
