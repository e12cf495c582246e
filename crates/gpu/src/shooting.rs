//! Sorted shooting with all its state on the device: twin of `radiosity/src/solve/shooting.rs`.
//!
//! Light, geometry and the choice of the next patch stay in GPU buffers; a step is one submission of several hemicubes,
//! after which a few numbers come back: where the solver is, sums of each channel, and the light of elements that somebody
//! [watches](GpuShooting::watch). [`GpuShooting::settle`] brings the light to the CPU when somebody wants to have it there;
//! [`GpuShooting::light`] is what pictures on the same device are made of meanwhile.

mod device;
mod light;
mod pace;

pub use light::{ChannelFlux, DeviceLight};

use crate::backend::Report;
use crate::buffer::{read, read_beside_others};
use crate::context::Context;
use crate::error::GpuError;
use crate::hemicube::count;
use device::OnDevice;
use hemicube_radiosity::form_factor::hemicube::{Hemicube, HemicubeOptions};
use hemicube_radiosity::{Progress, Solution, Solver};
use hemicube_shaders::shooting as twins;
use pace::{MOST_HEMICUBES, Pace, UNDER_WAY};
use std::collections::VecDeque;
use std::sync::Arc;
use std::time::{Duration, Instant};
use wgpu::{CommandEncoder, SubmissionIndex};

/// Sorted shooting on the GPU.
///
/// Receivers that cover few cells are counted as they are drawn. A step may end between two hemicubes of a patch; what
/// the patch has not yet spread then counts as unshot, and [`Self::settle`] ends its shot.
pub struct GpuShooting {
    context: Arc<Context>,
    solution: Solution,
    hemicubes_per_step: u32,
    /// What decides on the hemicubes of a step where it matters how long that takes.
    pace: Option<Pace>,
    /// Steps that were submitted and not read, in their order.
    under_way: VecDeque<UnderWay>,
    /// No patch begins to shoot after so many.
    most_shots: u32,
    submissions: u64,
    hemicubes: u64,
    /// Bytes that came to the CPU after steps, and with light.
    step_bytes: u64,
    light_bytes: u64,
    /// Elements whose light comes after every step.
    watched: Vec<u32>,
    /// The light of each of them, by channel.
    seen: Vec<Vec<f32>>,
    /// Sums of each channel after the last step.
    fluxes: Vec<ChannelFlux>,
    /// Whether the solution lags behind the device.
    is_ahead: bool,
    emitted: f64,
    /// Steps of the solution before this solver took it over.
    steps_before: u64,
    state: twins::ShotState,
    failure: Option<GpuError>,
    report: Option<Report>,
    device: OnDevice,
}

/// A submission that was not read.
struct UnderWay {
    submission: SubmissionIndex,
    submitted: Instant,
    hemicubes: u32,
    /// Which of the buffers to read it fills, and how far.
    place: usize,
    bytes: u64,
    /// Elements whose light comes with it.
    watched: Vec<u32>,
}

impl GpuShooting {
    /// Goes on from a solution; a new one starts with the light of its emitters.
    ///
    /// # Errors
    /// Options out of their range; a mesh or channels that do not fit the adapter's limits or its memory.
    pub fn new(
        context: Arc<Context>,
        solution: Solution,
        options: HemicubeOptions,
    ) -> Result<Self, GpuError> {
        let mesh = solution.mesh().clone();
        let cpu = Hemicube::new(mesh, options).map_err(|e| GpuError::Option(e.to_string()))?;
        let device = context.guard(|| OnDevice::new(&context, &solution, &cpu))?;
        let mut solver = Self {
            emitted: solution.reference_flux(),
            steps_before: solution.provenance.steps,
            // Enough that waiting for the device between submissions costs nothing, few enough that somebody who waits
            // for the next one does not notice.
            hemicubes_per_step: MOST_HEMICUBES,
            pace: None,
            under_way: VecDeque::new(),
            most_shots: u32::MAX,
            submissions: 0,
            hemicubes: 0,
            step_bytes: 0,
            light_bytes: 0,
            watched: Vec::new(),
            seen: Vec::new(),
            fluxes: Vec::new(),
            is_ahead: false,
            state: bytemuck::Zeroable::zeroed(),
            failure: None,
            report: None,
            context,
            solution,
            device,
        };
        solver.submit(0)?;
        solver.read_all()?;
        Ok(solver)
    }

    /// So many hemicubes in a step.
    pub fn with_hemicubes_per_step(self, hemicubes_per_step: u32) -> Self {
        Self {
            hemicubes_per_step: hemicubes_per_step.max(1),
            ..self
        }
    }

    /// As many hemicubes in a step as fit into so much time of the device, at least one and at most 32: for windows that
    /// draw on the same device, whose pictures wait behind a step. The first step has one. Where steps are that short the
    /// device has one while the one before is read, whose progress it then is; [`Solver::settle`] waits for both.
    pub fn with_step_time(self, step_time: Duration) -> Self {
        Self {
            pace: Some(Pace::new(&self.context, step_time)),
            ..self
        }
    }

    /// No more patches shoot than so many.
    pub(crate) fn with_most_shots(self, most: Option<u64>) -> Self {
        let most_shots = most.map_or(u32::MAX, |most| u32::try_from(most).unwrap_or(u32::MAX));
        Self { most_shots, ..self }
    }

    /// `report` hears what went wrong.
    pub(crate) fn with_report(self, report: Report) -> Self {
        Self {
            report: Some(report),
            ..self
        }
    }

    /// What went wrong, if something did. The solution is then the one last brought to the CPU.
    pub fn failure(&self) -> Option<&GpuError> {
        self.failure.as_ref()
    }

    /// The light where it lies, for pictures on the same device.
    pub fn light(&self) -> DeviceLight {
        let mesh = self.solution.mesh();
        let (elements, groups) = (mesh.elements().len(), self.solution.groups().len());
        let buffer = self.device.light.clone();
        DeviceLight::new(self.context.clone(), buffer, elements, groups)
    }

    /// From the next step on the light of these elements, the first four of them, comes to the CPU.
    pub fn watch(&mut self, elements: impl IntoIterator<Item = usize>) {
        let known = self.solution.mesh().elements().len();
        let elements = elements.into_iter().filter(|&e| e < known);
        let elements: Vec<u32> = elements
            .take(twins::MOST_WATCHED as usize)
            .map(count)
            .collect();
        if elements != self.watched {
            self.watched = elements;
            // What came for others would be taken for theirs.
            self.seen.clear();
        }
    }

    /// Elements that are watched, and the irradiance of each after the last step: `[group * 3 + band]`, undimmed. Empty
    /// before a step.
    pub fn watched(&self) -> impl Iterator<Item = (usize, &[f32])> {
        let elements = self.watched.iter().map(|&e| e as usize);
        elements.zip(self.seen.iter().map(Vec::as_slice))
    }

    /// Sums of each channel after the last step: `[group * 3 + band]`, undimmed.
    pub fn fluxes(&self) -> &[ChannelFlux] {
        &self.fluxes
    }

    /// Whether steps were done since the light came to the CPU.
    pub fn is_ahead(&self) -> bool {
        self.is_ahead
    }

    /// Bytes that come to the CPU after steps: progress, sums, what is watched, the device's clock. Steps under way count.
    pub fn step_bytes(&self) -> u64 {
        self.step_bytes
    }

    /// Bytes that came to the CPU because somebody wanted to have the light there.
    pub fn light_bytes(&self) -> u64 {
        self.light_bytes
    }

    /// Submissions so far, those that bring light to the CPU left out.
    pub fn submissions(&self) -> u64 {
        self.submissions
    }

    /// Hemicubes so far, those included that are still to be drawn.
    pub fn hemicubes(&self) -> u64 {
        self.hemicubes
    }

    /// Patches that have begun to shoot.
    pub fn shots(&self) -> u64 {
        self.state.shots.into()
    }

    /// Bytes on the device.
    pub fn bytes(&self) -> u64 {
        self.device.bytes()
    }

    /// Submits so many hemicubes, and what is to come to the CPU after them.
    fn submit(&mut self, hemicubes: u32) -> Result<(), GpuError> {
        self.context.check()?;
        let mut encoder = self.encoder("shooting");
        let clock = self.pace.as_ref().and_then(|pace| pace.clock.as_ref());
        self.device.rounds(&mut encoder, hemicubes, clock);
        let place = usize::try_from(self.submissions).unwrap_or(0) % UNDER_WAY;
        let mut bytes = self.device.copy_step(&mut encoder, &self.watched, place);
        if let Some(clock) = clock {
            bytes += clock.copy(&mut encoder, &self.device.read_steps[place], bytes);
        }
        self.under_way.push_back(UnderWay {
            submission: self.context.queue.submit([encoder.finish()]),
            submitted: Instant::now(),
            hemicubes,
            place,
            bytes,
            watched: self.watched.clone(),
        });
        self.step_bytes += bytes;
        self.submissions += 1;
        self.hemicubes += u64::from(hemicubes);
        Ok(())
    }

    /// Waits for the first step that is under way, and reads what came after it.
    fn read_first(&mut self) -> Result<(), GpuError> {
        let Some(step) = self.under_way.pop_front() else {
            return Ok(());
        };
        let buffer = &self.device.read_steps[step.place];
        let words = if self.pace.is_some() {
            read_beside_others(&self.context, buffer, step.bytes)?
        } else {
            read(&self.context, buffer, step.bytes, step.submission)?
        };
        let clock = self.take_step(&words, &step.watched);
        if let Some(pace) = &mut self.pace {
            pace.note(step.hemicubes, step.submitted, clock);
        }
        Ok(())
    }

    /// Waits for all that is under way.
    fn read_all(&mut self) -> Result<(), GpuError> {
        while !self.under_way.is_empty() {
            self.read_first()?;
        }
        Ok(())
    }

    /// Takes over what came after a step; returns how long that took by the device's clock.
    fn take_step(&mut self, words: &[u32], watched: &[u32]) -> Option<Duration> {
        let (state, rest) = words.split_at(size_of::<twins::ShotState>() / 4);
        self.state = *bytemuck::from_bytes(bytemuck::cast_slice(state));
        let channels = self.device.params.channels as usize;
        let numbers: &[f32] = bytemuck::cast_slice(rest);
        let (of_channels, numbers) = numbers.split_at(channels * twins::CHANNEL_WORDS as usize);
        let of_channels = of_channels.chunks(twins::CHANNEL_WORDS as usize);
        self.fluxes = of_channels.map(ChannelFlux::of_words).collect();
        let (of_watched, times) = numbers.split_at(watched.len() * channels);
        // Others may be watched by now.
        if watched == self.watched {
            self.seen = of_watched.chunks(channels).map(<[f32]>::to_vec).collect();
        }
        self.solution.provenance.steps = self.steps_before + u64::from(self.state.shots);
        let clock = self.pace.as_ref()?.clock.as_ref()?;
        clock.between(bytemuck::cast_slice(times))
    }

    fn encoder(&self, label: &str) -> CommandEncoder {
        let descriptor = wgpu::CommandEncoderDescriptor { label: Some(label) };
        self.context.device.create_command_encoder(&descriptor)
    }

    /// From now on no patch begins to shoot after so many.
    fn bound(&self, most_shots: u32) {
        let offset = core::mem::offset_of!(twins::ShotState, most_shots) as u64;
        let word = most_shots.to_ne_bytes();
        self.context
            .queue
            .write_buffer(&self.device.state, offset, &word);
    }

    fn shoot(&mut self) -> Result<(), GpuError> {
        self.bound(self.most_shots);
        self.is_ahead = true;
        let Some(pace) = &self.pace else {
            self.submit(self.hemicubes_per_step)?;
            return self.read_all();
        };
        let keeps = pace.keeps;
        self.submit(pace.hemicubes)?;
        while self.under_way.len() > keeps {
            self.read_first()?;
        }
        Ok(())
    }

    /// The patch that shoots ends its shot, so that all light is either unshot or has arrived.
    fn end_shot(&mut self) -> Result<(), GpuError> {
        self.read_all()?;
        let rest = self.state.views.saturating_sub(self.state.view + 1);
        if rest > 0 {
            self.bound(0);
            self.submit(rest)?;
            self.read_all()?;
        }
        Ok(())
    }

    fn fetch(&mut self) -> Result<(), GpuError> {
        self.end_shot()?;
        let bytes = self.device.read_light.size();
        let mut encoder = self.encoder("light to the CPU");
        let (from, to) = (&self.device.light, &self.device.read_light);
        encoder.copy_buffer_to_buffer(from, 0, to, 0, bytes);
        let submission = self.context.queue.submit([encoder.finish()]);
        let words = read(&self.context, to, bytes, submission)?;
        self.take_light(bytemuck::cast_slice(&words));
        self.light_bytes += bytes;
        self.is_ahead = false;
        Ok(())
    }

    /// Takes over all light; what was lost on the way is booked then, and forgotten on the device.
    fn take_light(&mut self, light: &[f32]) {
        let channels = self.device.params.channels as usize;
        let values = channels * self.device.params.elements as usize;
        let (irradiance, rest) = light.split_at(values);
        let (unshot, rest) = rest.split_at(values);
        let rest = &rest[..channels * twins::CHANNEL_WORDS as usize];
        let words = rest.chunks(twins::CHANNEL_WORDS as usize);
        let fluxes: Vec<ChannelFlux> = words.map(ChannelFlux::of_words).collect();
        let lost = |of: fn(&ChannelFlux) -> f64| -> Vec<f64> { fluxes.iter().map(of).collect() };
        let (backs, escaped) = (lost(|flux| flux.backs), lost(|flux| flux.escaped));
        self.solution
            .replace_light(irradiance, unshot, &backs, &escaped);
        let zeros = vec![0.0_f32; rest.len()];
        let zeros = bytemuck::cast_slice(&zeros);
        let queue = &self.context.queue;
        queue.write_buffer(&self.device.light, (2 * values * 4) as u64, zeros);
        for flux in &mut self.fluxes {
            (flux.backs, flux.escaped) = (0.0, 0.0);
        }
    }

    fn keep(&mut self, result: Result<(), GpuError>) {
        let Err(failure) = result else { return };
        if self.failure.is_none()
            && let Some(report) = &self.report
        {
            report(&failure);
        }
        self.failure.get_or_insert(failure);
    }
}

impl Solver for GpuShooting {
    fn step(&mut self) -> Progress {
        let shot = self.shoot();
        self.keep(shot);
        self.progress()
    }

    fn progress(&self) -> Progress {
        let emitted = if self.emitted > 0.0 {
            self.emitted
        } else {
            1.0
        };
        Progress {
            iteration: self.solution.provenance.steps,
            unshot: f64::from(self.state.unshot) / emitted,
            residual: f64::from(self.state.largest) / emitted,
            noise: None,
        }
    }

    fn is_exhausted(&self) -> bool {
        self.failure.is_some()
    }

    fn settle(&mut self) {
        if self.is_ahead && self.failure.is_none() {
            let fetched = self.fetch();
            self.keep(fetched);
        }
    }

    fn solution(&self) -> &Solution {
        &self.solution
    }

    fn into_solution(mut self) -> Solution {
        self.settle();
        self.solution
    }
}
