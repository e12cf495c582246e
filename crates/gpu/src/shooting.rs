//! Sorted shooting with all its state on the device: twin of `radiosity/src/solve/shooting.rs`.
//!
//! Light, geometry and the choice of the next patch stay in GPU buffers; a step is one submission of several hemicubes,
//! after which only eight numbers come back. [`GpuShooting::settle`] brings the light to the CPU when somebody wants to
//! see it.

use crate::backend::Report;
use crate::buffer::{bind, compute, empty, filled, groups, layout, module, read, storage, uniform};
use crate::context::Context;
use crate::error::GpuError;
use crate::hemicube::{Batch, Geometry, HemicubePass, compute_pass, count};
use hemicube_radiosity::form_factor::hemicube::{Hemicube, HemicubeOptions};
use hemicube_radiosity::solution::BANDS;
use hemicube_radiosity::{Progress, Solution, Solver};
use hemicube_shaders::shooting as twins;
use std::sync::Arc;
use wgpu::{BindGroup, Buffer, BufferUsages, CommandEncoder, ComputePipeline, ShaderStages};

/// Hemicubes of a submission unless something else is asked for: enough that waiting for the device between submissions
/// costs nothing, few enough that somebody who waits for the next one does not notice.
const HEMICUBES_PER_STEP: u32 = 32;

/// Sorted shooting on the GPU.
///
/// Receivers that cover few cells are counted as they are drawn. A step may end between two hemicubes of a patch; what
/// the patch has not yet spread then counts as unshot, and [`Self::settle`] ends its shot.
pub struct GpuShooting {
    context: Arc<Context>,
    solution: Solution,
    hemicubes_per_step: u32,
    /// No patch begins to shoot after so many.
    most_shots: u32,
    submissions: u64,
    emitted: f64,
    /// Steps of the solution before this solver took it over.
    steps_before: u64,
    state: twins::ShotState,
    failure: Option<GpuError>,
    report: Option<Report>,
    device: OnDevice,
}

/// What lies on the device.
struct OnDevice {
    hemicube: HemicubePass,
    geometry: Geometry,
    batch: Batch,
    params: twins::ShootingParams,
    choose: ComputePipeline,
    spread: ComputePipeline,
    measure: ComputePipeline,
    survey: ComputePipeline,
    shooting: BindGroup,
    seen: BindGroup,
    state: Buffer,
    light: Buffer,
    read_state: Buffer,
    read_light: Buffer,
    /// Of the buffers that shooting itself needs.
    bytes: u64,
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
            hemicubes_per_step: HEMICUBES_PER_STEP,
            most_shots: u32::MAX,
            submissions: 0,
            state: bytemuck::Zeroable::zeroed(),
            failure: None,
            report: None,
            context,
            solution,
            device,
        };
        solver.submit(0)?;
        Ok(solver)
    }

    /// So many hemicubes in a step.
    pub fn with_hemicubes_per_step(self, hemicubes_per_step: u32) -> Self {
        Self {
            hemicubes_per_step: hemicubes_per_step.max(1),
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

    /// Light as it lies on the device: `[group][band][element]` irradiance, then what only this solver understands.
    pub(crate) fn light(&self) -> &Buffer {
        &self.device.light
    }

    /// Submissions so far, those that bring light to the CPU left out.
    pub fn submissions(&self) -> u64 {
        self.submissions
    }

    /// Patches that have begun to shoot.
    pub fn shots(&self) -> u64 {
        self.state.shots.into()
    }

    /// Bytes on the device.
    pub fn bytes(&self) -> u64 {
        self.device.bytes()
    }

    /// Submits so many hemicubes and reads the state after them.
    fn submit(&mut self, hemicubes: u32) -> Result<(), GpuError> {
        self.context.check()?;
        let device = &self.device;
        let descriptor = wgpu::CommandEncoderDescriptor {
            label: Some("shooting"),
        };
        let mut encoder = self.context.device.create_command_encoder(&descriptor);
        device.rounds(&mut encoder, hemicubes);
        device.run(&mut encoder, &device.survey, (1, 1));
        let bytes = size_of::<twins::ShotState>() as u64;
        encoder.copy_buffer_to_buffer(&device.state, 0, &device.read_state, 0, bytes);
        self.context.queue.submit([encoder.finish()]);
        let words = read(&self.context, &device.read_state, bytes)?;
        self.state = *bytemuck::from_bytes(bytemuck::cast_slice(&words));
        self.solution.provenance.steps = self.steps_before + u64::from(self.state.shots);
        self.submissions += 1;
        Ok(())
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
        self.submit(self.hemicubes_per_step)
    }

    /// The patch that shoots ends its shot, so that all light is either unshot or has arrived.
    fn end_shot(&mut self) -> Result<(), GpuError> {
        let rest = self.state.views.saturating_sub(self.state.view + 1);
        if rest > 0 {
            self.bound(0);
            self.submit(rest)?;
        }
        Ok(())
    }

    fn fetch(&mut self) -> Result<(), GpuError> {
        self.end_shot()?;
        let device = &self.device;
        let bytes = device.read_light.size();
        let descriptor = wgpu::CommandEncoderDescriptor {
            label: Some("light to the CPU"),
        };
        let mut encoder = self.context.device.create_command_encoder(&descriptor);
        encoder.copy_buffer_to_buffer(&device.light, 0, &device.read_light, 0, bytes);
        self.context.queue.submit([encoder.finish()]);
        let words = read(&self.context, &device.read_light, bytes)?;
        let light: &[f32] = bytemuck::cast_slice(&words);
        let channels = device.params.channels as usize;
        let values = channels * device.params.elements as usize;
        let (irradiance, rest) = light.split_at(values);
        let (unshot, rest) = rest.split_at(values);
        let words = twins::CHANNEL_WORDS as usize;
        let lost = |at: usize| -> Vec<f64> {
            rest.chunks(words)
                .map(|c| f64::from(c[at]) - f64::from(c[at + 1]))
                .collect()
        };
        self.solution
            .replace_light(irradiance, unshot, &lost(1), &lost(3));
        // They are booked.
        let zeros = vec![0.0_f32; channels * words];
        let offset = (2 * values * 4) as u64;
        self.context
            .queue
            .write_buffer(&device.light, offset, bytemuck::cast_slice(&zeros));
        Ok(())
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
        let fetched = self.fetch();
        self.keep(fetched);
    }

    fn solution(&self) -> &Solution {
        &self.solution
    }

    fn into_solution(mut self) -> Solution {
        self.settle();
        self.solution
    }
}

impl OnDevice {
    fn new(context: &Context, solution: &Solution, cpu: &Hemicube) -> Result<Self, GpuError> {
        let device = &context.device;
        let mesh = solution.mesh();
        let geometry = Geometry::new(context, cpu)?;
        let hemicube = HemicubePass::new(context, geometry.layers > 1);
        let batch = Batch::new(context, &hemicube, &geometry, 1)?;
        let params = twins::ShootingParams {
            elements: count(mesh.elements().len()),
            patches: count(mesh.patches().len()),
            channels: count(solution.groups().len() * BANDS),
            bands: count(usize::try_from(geometry.size.bands()).expect("one or three")),
            farthest: mesh.visibility().diameter(),
            padding_0: 0,
            padding_1: 0,
            padding_2: 0,
        };
        let start = light(solution);
        let largest = context.limits.max_storage_buffer_binding_size;
        context.allow(
            "elements in all light groups",
            (start.len() * 4) as u64,
            largest,
            "bytes",
        )?;
        let (patches, views) = patches(cpu);
        context.allow("hemicubes", size_of_val(&*views) as u64, largest, "bytes")?;
        let storage_from = BufferUsages::STORAGE | BufferUsages::COPY_SRC | BufferUsages::COPY_DST;
        let to_read = BufferUsages::MAP_READ | BufferUsages::COPY_DST;
        let state_bytes = size_of::<twins::ShotState>() as u64;
        let light = filled(device, "light", &start, storage_from);
        let state = empty(device, "shooting state", state_bytes, storage_from);
        let buffers = [
            filled(
                device,
                "shooting parameters",
                &[params],
                BufferUsages::UNIFORM,
            ),
            filled(
                device,
                "elements",
                &elements(solution),
                BufferUsages::STORAGE,
            ),
            filled(device, "patches", &patches, BufferUsages::STORAGE),
            filled(device, "hemicubes", &views, BufferUsages::STORAGE),
            state.clone(),
            empty(
                device,
                "unshot of patches",
                4 * u64::from(params.patches),
                BufferUsages::STORAGE,
            ),
            light.clone(),
        ];
        let (reads, writes) = (storage(true), storage(false));
        let shooting_layout = layout(
            device,
            "shooting",
            ShaderStages::COMPUTE,
            &[uniform(false), reads, reads, reads, writes, writes, writes],
        );
        let seen_layout = layout(device, "seen", ShaderStages::COMPUTE, &[writes, writes]);
        let shader = module(device, &twins::SHOOTING);
        let pipeline = |name| compute(device, &shader, name, &[&shooting_layout, &seen_layout]);
        let bindings = buffers.each_ref().map(Buffer::as_entire_binding);
        let seen = [&batch.viewpoints, &batch.sums].map(Buffer::as_entire_binding);
        let on_device = Self {
            choose: pipeline("choose"),
            spread: pipeline("spread"),
            measure: pipeline("measure"),
            survey: pipeline("survey"),
            shooting: bind(device, "shooting", &shooting_layout, &bindings),
            seen: bind(device, "seen", &seen_layout, &seen),
            read_state: empty(device, "state to read", state_bytes, to_read),
            read_light: empty(device, "light to read", light.size(), to_read),
            bytes: buffers.iter().map(Buffer::size).sum(),
            hemicube,
            geometry,
            batch,
            params,
            state,
            light,
        };
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        on_device.run(&mut encoder, &on_device.measure, groups(params.patches, 64));
        context.queue.submit([encoder.finish()]);
        Ok(on_device)
    }

    fn run(&self, encoder: &mut CommandEncoder, pipeline: &ComputePipeline, (x, z): (u32, u32)) {
        let mut pass = compute_pass(encoder, "shooting");
        pass.set_pipeline(pipeline);
        pass.set_bind_group(0, &self.shooting, &[]);
        pass.set_bind_group(1, &self.seen, &[]);
        pass.dispatch_workgroups(x, 1, z);
    }

    /// So many hemicubes, one after the other.
    fn rounds(&self, encoder: &mut CommandEncoder, hemicubes: u32) {
        for _ in 0..hemicubes {
            self.run(encoder, &self.choose, (1, 1));
            self.hemicube
                .encode(encoder, &self.geometry, &self.batch, 1, None);
            self.run(
                encoder,
                &self.spread,
                groups(self.params.elements.max(self.params.channels), 64),
            );
            self.run(encoder, &self.measure, groups(self.params.patches, 64));
        }
    }

    fn bytes(&self) -> u64 {
        let own = self.bytes + self.read_state.size() + self.read_light.size();
        own + self.geometry.bytes() + self.batch.bytes()
    }
}

/// Light as the shader keeps it, see `shooting.wgsl`.
fn light(solution: &Solution) -> Vec<f32> {
    let channels =
        || (0..solution.groups().len()).flat_map(|g| (0..BANDS).map(move |band| (g, band)));
    let irradiance = channels().flat_map(|(g, band)| solution.irradiance(g, band));
    let unshot = channels().flat_map(|(g, band)| solution.unshot(g, band));
    let rest = channels().count() * twins::CHANNEL_WORDS as usize;
    irradiance
        .chain(unshot)
        .copied()
        .chain(core::iter::repeat_n(0.0, rest))
        .collect()
}

fn elements(solution: &Solution) -> Vec<twins::ElementLight> {
    let mesh = solution.mesh();
    let element = |e: usize| {
        let area = mesh.exposed_area(e);
        twins::ElementLight {
            area,
            inverse_area: if area > 0.0 { 1.0 / area } else { 0.0 },
            padding_0: 0,
            padding_1: 0,
            reflectance: mesh.reflectance()[e].to_array(),
            padding_2: 0,
        }
    };
    (0..mesh.elements().len()).map(element).collect()
}

/// Patches, and where the hemicubes of all of them stand.
fn patches(cpu: &Hemicube) -> (Vec<twins::ShootingPatch>, Vec<twins::ShotView>) {
    use hemicube_radiosity::form_factor::FormFactors;
    let mesh = cpu.mesh();
    let (mut patches, mut all) = (Vec::new(), Vec::new());
    for (p, &id) in mesh.patches().iter().enumerate() {
        let elements = mesh.elements_of_patch(p);
        let first_view = count(all.len());
        #[expect(clippy::cast_possible_truncation, reason = "weights are kept in f32")]
        all.extend(cpu.viewpoints(id).iter().map(|view| twins::ShotView {
            origin: view.origin.to_array(),
            weight: view.weight as f32,
            tangent: view.axes[0].to_array(),
            least_near: mesh.visibility().offset(view.origin),
        }));
        patches.push(twins::ShootingPatch {
            first_element: count(elements.start),
            elements: count(elements.len()),
            first_view,
            views: count(all.len()) - first_view,
            normal: mesh.node(id).normal.to_array(),
            padding: 0,
        });
    }
    (patches, all)
}
