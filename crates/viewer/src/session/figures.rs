//! What the worker shows beside the light, and how often it shows anything.

use crate::session::Watch;
use crate::session::snapshot::{HemicubePicture, PatchRow};
use hemicube_radiosity::PatchMesh;
use hemicube_radiosity::form_factor::hemicube::{Hemicube, HemicubeOptions};
use hemicube_radiosity::form_factor::{FormFactors, Row};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Least time between two pictures of hemicubes.
const BETWEEN_HEMICUBES: Duration = Duration::from_millis(200);
/// Cells along an edge of hemicubes that are shown.
const SHOWN_RESOLUTION: u32 = 96;

/// Pictures beside the light.
pub(super) struct Figures {
    mesh: Arc<PatchMesh>,
    /// Made when first asked for.
    hemicubes: Option<Hemicube>,
    hemicube: Option<Arc<HemicubePicture>>,
    drawn: Option<Instant>,
    row: Option<Arc<PatchRow>>,
}

impl Figures {
    pub(super) fn new(mesh: Arc<PatchMesh>) -> Self {
        Self {
            mesh,
            hemicubes: None,
            hemicube: None,
            drawn: None,
            row: None,
        }
    }

    pub(super) fn hemicube(
        &mut self,
        watch: Watch,
        patch: Option<usize>,
        at_once: bool,
    ) -> Option<Arc<HemicubePicture>> {
        let patch = patch.filter(|_| watch.hemicube)?;
        let is_fresh = self
            .drawn
            .is_some_and(|drawn| drawn.elapsed() < BETWEEN_HEMICUBES);
        let is_same = self.hemicube.as_ref().is_some_and(|h| h.patch == patch);
        if is_same || (is_fresh && !at_once) {
            return self.hemicube.clone();
        }
        if self.hemicubes.is_none() {
            let options = HemicubeOptions::default()
                .with_resolution(SHOWN_RESOLUTION)
                .with_max_points(1);
            self.hemicubes = Hemicube::new(self.mesh.clone(), options).ok();
        }
        let buffers = self
            .hemicubes
            .as_ref()?
            .item_buffers(self.mesh.patches()[patch]);
        self.drawn = Some(Instant::now());
        self.hemicube = Some(Arc::new(HemicubePicture { patch, buffers }));
        self.hemicube.clone()
    }

    pub(super) fn row(&mut self, watch: Watch, factors: &dyn FormFactors) -> Option<Arc<PatchRow>> {
        let patch = watch
            .row_of
            .filter(|&patch| patch < self.mesh.patches().len())?;
        if self.row.as_ref().is_none_or(|row| row.patch != patch) {
            let mut row = Row::default();
            factors.fill_row(self.mesh.patches()[patch], &mut row);
            let mut fractions = vec![0.0; self.mesh.elements().len()];
            for (k, &e) in row.receivers.iter().enumerate() {
                fractions[e as usize] = (0..3).map(|band| row.band(band)[k]).sum::<f32>() / 3.0;
            }
            self.row = Some(Arc::new(PatchRow { patch, fractions }));
        }
        self.row.clone()
    }
}

/// When to show the light.
#[derive(Default)]
pub(super) struct Pace {
    last: Option<Instant>,
    /// What the last snapshot took.
    cost: Duration,
    /// Steps since the last snapshot.
    pub(super) steps: u64,
    /// Whether there is light that was not shown.
    pub(super) is_behind: bool,
}

impl Pace {
    pub(super) fn is_due(&self, between: Duration) -> bool {
        self.last
            .is_none_or(|last| last.elapsed() >= between.max(4 * self.cost))
    }

    pub(super) fn rate(&mut self) -> Option<f64> {
        let seconds = self.last?.elapsed().as_secs_f64();
        let steps = core::mem::take(&mut self.steps);
        (seconds > 0.0 && steps > 0).then_some(steps as f64 / seconds)
    }

    pub(super) fn shown(&mut self, begin: Instant) {
        self.cost = begin.elapsed();
        self.last = Some(Instant::now());
        self.is_behind = false;
    }
}
