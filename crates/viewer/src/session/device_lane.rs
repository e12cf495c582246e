//! Sorted shooting whose light stays on a device.
//!
//! Pictures are made of it there. What comes here after a step is progress, sums of each channel and the light of a few
//! elements; all light comes when somebody wants to have it: when the solver rests, is put away, or is asked.

use crate::session::snapshot::OnDevice;
use hemicube_gpu::{ChannelFlux, GpuShooting};
use hemicube_radiosity::solution::{BANDS, EnergyBalance};
use hemicube_radiosity::solve::AmbientTerm;
use hemicube_radiosity::{Progress, Solution, Solver};
use hemicube_raster::Rgb;
use std::sync::Arc;
use std::time::Duration;

/// How long a step may keep the device from drawing the window: half a frame of a usual display. Up to two of them lie
/// between two frames.
const STEP_TIME: Duration = Duration::from_millis(8);

/// A solver on a device, and what is known here of its light.
pub(super) struct DeviceLane {
    solver: GpuShooting,
    /// The light that last came from the device.
    brought: Arc<Solution>,
    ambient: AmbientTerm,
    steps: u64,
}

impl DeviceLane {
    pub fn new(solver: GpuShooting) -> Self {
        let brought = Arc::new(solver.solution().clone());
        Self {
            ambient: AmbientTerm::new(&brought),
            solver: solver.with_step_time(STEP_TIME),
            brought,
            steps: 0,
        }
    }

    pub fn step(&mut self) {
        self.solver.step();
        self.steps += 1;
    }

    pub fn progress(&self) -> Progress {
        self.solver.progress()
    }

    /// Whether the device has failed; the light is then that which last came from there.
    pub fn has_failed(&self) -> bool {
        self.solver.failure().is_some()
    }

    /// From the next step on the light of these elements is known.
    pub fn watch(&mut self, elements: impl IntoIterator<Item = usize>) {
        self.solver.watch(elements);
    }

    /// The light that last came from the device; all there is if that is wanted.
    pub fn light(&mut self, all: bool) -> Arc<Solution> {
        if all && self.solver.is_ahead() {
            self.solver.settle();
            self.brought = Arc::new(self.solver.solution().clone());
        }
        self.brought.clone()
    }

    pub fn into_solution(self) -> Solution {
        self.solver.into_solution()
    }

    /// What is known of the light.
    pub fn view(&self) -> OnDevice {
        let watched = self.solver.watched();
        OnDevice {
            light: self.solver.light(),
            is_brought: !self.solver.is_ahead(),
            fluxes: self.solver.fluxes().to_vec(),
            watched: watched.map(|(e, light)| (e, light.to_vec())).collect(),
            steps: self.steps,
            hemicubes: self.solver.hemicubes(),
            step_bytes: self.solver.step_bytes(),
            light_bytes: self.solver.light_bytes(),
        }
    }

    /// The estimate of the light to come.
    pub fn ambient(&self) -> Rgb {
        let bands = [0, 1, 2];
        let unshot = bands.map(|band| self.sum(band, |flux| flux.unshot));
        let balance = bands.map(|band| {
            let known = self.brought.total_balance(band);
            let escaped = known.escaped + self.sum(band, |flux| flux.escaped);
            EnergyBalance {
                emitted: known.emitted,
                absorbed: known.emitted - unshot[band] - escaped,
                escaped,
            }
        });
        self.ambient.irradiance(unshot, balance)
    }

    /// Mean irradiance of all surfaces.
    pub fn mean(&self) -> Rgb {
        let mean = |band| {
            #[expect(clippy::cast_possible_truncation, reason = "light is kept in f32")]
            let mean = (self.sum(band, |flux| flux.received) / self.ambient.area()) as f32;
            mean
        };
        Rgb::new(mean(0), mean(1), mean(2))
    }

    fn sum(&self, band: usize, of: fn(&ChannelFlux) -> f64) -> f64 {
        let channels = self.solver.fluxes().iter().skip(band).step_by(BANDS);
        channels.map(of).sum()
    }
}
