//! What the worker shows.

use crate::session::History;
use hemicube_gpu::{ChannelFlux, DeviceLight};
use hemicube_radiosity::form_factor::hemicube::ItemBuffers;
use hemicube_radiosity::solution::BANDS;
use hemicube_radiosity::{PatchMesh, Progress, Solution, SolverKind};
use hemicube_raster::Rgb;
use std::borrow::Cow;
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
    /// Number of the last [`Command::Bring`](crate::session::Command::Bring) that was obeyed; 0 before the first.
    pub brought: u64,
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
    /// Its light; while a device keeps that, the light that last came from there.
    pub solution: Arc<Solution>,
    /// What is known of the light that a device keeps.
    pub on_device: Option<Arc<OnDevice>>,
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

impl LaneView {
    /// Whether `solution` has the newest light.
    pub fn has_light(&self) -> bool {
        let device = self.on_device.as_ref();
        device.is_none_or(|device| device.is_brought)
    }

    /// Flux that a light group brings to the surfaces, over bands and undimmed.
    pub fn received(&self, group: usize) -> f64 {
        if let Some(device) = self.on_device.as_ref().filter(|_| !self.has_light()) {
            let channels = device.fluxes.iter().skip(BANDS * group).take(BANDS);
            return channels.map(|flux| flux.received).sum();
        }
        let mesh = self.solution.mesh();
        let of_band = |band: usize| {
            let irradiance = self.solution.irradiance(group, band).iter().enumerate();
            irradiance
                .map(|(e, &h)| f64::from(h) * f64::from(mesh.exposed_area(e)))
                .sum::<f64>()
        };
        (0..BANDS).map(of_band).sum()
    }

    /// Irradiance of an element with factors on its light groups, if that is known here. Groups beyond `dims` count as they
    /// were solved.
    pub fn watched(&self, element: usize, dims: &[Rgb]) -> Option<Rgb> {
        let device = self.on_device.as_ref()?;
        let (_, light) = device.watched.iter().find(|(e, _)| *e == element)?;
        let mut sum = Rgb::BLACK;
        for (channel, &irradiance) in light.iter().enumerate() {
            let dim = dims.get(channel / BANDS).copied().unwrap_or(Rgb::WHITE);
            sum[channel % BANDS] += irradiance * dim[channel % BANDS];
        }
        Some(sum)
    }
}

/// What is known of light that a device keeps.
#[derive(Debug, Clone)]
pub struct OnDevice {
    /// Where it is, for pictures on that device.
    pub light: DeviceLight,
    /// Whether it has come here, too.
    pub is_brought: bool,
    /// Sums of each channel: `[group * 3 + band]`, undimmed.
    pub fluxes: Vec<ChannelFlux>,
    /// Irradiance of the elements that are watched, by channel.
    pub watched: Vec<(usize, Vec<f32>)>,
    /// Steps so far: submissions of several hemicubes.
    pub steps: u64,
    /// Hemicubes so far.
    pub hemicubes: u64,
    /// Bytes that came here after steps.
    pub step_bytes: u64,
    /// Bytes that came here with all light.
    pub light_bytes: u64,
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
    /// A scene or a finer mesh that is on its way.
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

/// A scene, or a finer mesh of the one that there is, that is on its way.
#[derive(Debug, Clone)]
pub struct Opening {
    /// What is done to it: `Opening` or `Refining`.
    pub what: &'static str,
    /// Its name.
    pub name: String,
    /// What is done right now.
    pub stage: Cow<'static, str>,
    /// Since when it is on its way.
    pub since: Instant,
}
