//! What shooting keeps on the device, and what it runs there.

use crate::buffer::{bind, compute, empty, filled, groups, layout, module, storage, uniform};
use crate::context::Context;
use crate::error::GpuError;
use crate::hemicube::{Batch, Geometry, HemicubePass, count};
use crate::shooting::pace::{CLOCK_BYTES, Clock, UNDER_WAY};
use hemicube_radiosity::Solution;
use hemicube_radiosity::form_factor::FormFactors;
use hemicube_radiosity::form_factor::hemicube::{Hemicube, Viewpoint};
use hemicube_radiosity::patch::NodeId;
use hemicube_radiosity::solution::BANDS;
use hemicube_shaders::shooting as twins;
use rayon::prelude::*;
use wgpu::{
    BindGroup, Buffer, BufferUsages, CommandEncoder, ComputePassTimestampWrites, ComputePipeline,
    ShaderStages,
};

/// What lies on the device.
pub(super) struct OnDevice {
    hemicube: HemicubePass,
    geometry: Geometry,
    batch: Batch,
    pub(super) params: twins::ShootingParams,
    choose: ComputePipeline,
    spread: ComputePipeline,
    measure: ComputePipeline,
    survey: ComputePipeline,
    tally: ComputePipeline,
    shooting: BindGroup,
    seen: BindGroup,
    pub(super) state: Buffer,
    pub(super) light: Buffer,
    /// State, the channels' words, the light of watched elements, and the times of a step, of one step each.
    pub(super) read_steps: [Buffer; UNDER_WAY],
    pub(super) read_light: Buffer,
    /// Of the buffers that shooting itself needs.
    bytes: u64,
}

impl OnDevice {
    pub(super) fn new(
        context: &Context,
        solution: &Solution,
        cpu: &Hemicube,
    ) -> Result<Self, GpuError> {
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
        let of_channel = twins::CHANNEL_WORDS + twins::MOST_WATCHED;
        let step_bytes = state_bytes + 4 * u64::from(params.channels * of_channel) + CLOCK_BYTES;
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
            tally: pipeline("tally"),
            shooting: bind(device, "shooting", &shooting_layout, &bindings),
            seen: bind(device, "seen", &seen_layout, &seen),
            read_steps: [(); UNDER_WAY]
                .map(|()| empty(device, "step to read", step_bytes, to_read)),
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
        on_device.run(
            &mut encoder,
            &on_device.measure,
            groups(params.patches, 64),
            None,
        );
        context.queue.submit([encoder.finish()]);
        Ok(on_device)
    }

    fn run(
        &self,
        encoder: &mut CommandEncoder,
        pipeline: &ComputePipeline,
        (x, z): (u32, u32),
        timestamp_writes: Option<ComputePassTimestampWrites<'_>>,
    ) {
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some("shooting"),
            timestamp_writes,
        });
        pass.set_pipeline(pipeline);
        pass.set_bind_group(0, &self.shooting, &[]);
        pass.set_bind_group(1, &self.seen, &[]);
        pass.dispatch_workgroups(x, 1, z);
    }

    /// So many hemicubes, one after the other, and what is left after them.
    pub(super) fn rounds(
        &self,
        encoder: &mut CommandEncoder,
        hemicubes: u32,
        clock: Option<&Clock>,
    ) {
        for round in 0..hemicubes {
            let begin = clock.filter(|_| round == 0).map(Clock::at_begin);
            self.run(encoder, &self.choose, (1, 1), begin);
            self.hemicube
                .encode(encoder, &self.geometry, &self.batch, 1, None);
            let receivers = self.params.elements.max(self.params.channels);
            self.run(encoder, &self.spread, groups(receivers, 64), None);
            let patches = groups(self.params.patches, 64);
            self.run(encoder, &self.measure, patches, None);
        }
        self.run(encoder, &self.survey, (1, 1), None);
        let channels = groups(self.params.channels, 1);
        self.run(encoder, &self.tally, channels, clock.map(Clock::at_end));
    }

    /// Copies what comes to the CPU after every step to one of the places for that; returns its bytes.
    pub(super) fn copy_step(
        &self,
        encoder: &mut CommandEncoder,
        watched: &[u32],
        place: usize,
    ) -> u64 {
        let mut end = 0;
        let mut copy = |from: &Buffer, at: u64, bytes: u64| {
            encoder.copy_buffer_to_buffer(from, at, &self.read_steps[place], end, bytes);
            end += bytes;
        };
        copy(&self.state, 0, size_of::<twins::ShotState>() as u64);
        let channels = u64::from(self.params.channels);
        let elements = u64::from(self.params.elements);
        let words = channels * u64::from(twins::CHANNEL_WORDS);
        copy(&self.light, 4 * self.values() * 2, 4 * words);
        for &element in watched {
            for channel in 0..channels {
                let at = channel * elements + u64::from(element);
                copy(&self.light, 4 * at, 4);
            }
        }
        end
    }

    /// Numbers of irradiance, and as many of what is unshot.
    pub(super) fn values(&self) -> u64 {
        u64::from(self.params.channels) * u64::from(self.params.elements)
    }

    pub(super) fn bytes(&self) -> u64 {
        let to_read: u64 = self.read_steps.iter().map(Buffer::size).sum();
        let own = self.bytes + to_read + self.read_light.size();
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
    let mesh = cpu.mesh();
    let of_patches: Vec<Vec<twins::ShotView>> = mesh
        .patches()
        .par_iter()
        .map(|&id| views(cpu, id))
        .collect();
    let mut first_view = 0;
    let patch = |(p, (&id, views)): (usize, (&NodeId, &Vec<twins::ShotView>))| {
        let elements = mesh.elements_of_patch(p);
        let patch = twins::ShootingPatch {
            first_element: count(elements.start),
            elements: count(elements.len()),
            first_view,
            views: count(views.len()),
            normal: mesh.node(id).normal.to_array(),
            padding: 0,
        };
        first_view += patch.views;
        patch
    };
    let patches = mesh.patches().iter().zip(&of_patches).enumerate();
    (patches.map(patch).collect(), of_patches.concat())
}

/// Where the hemicubes of a patch stand.
fn views(cpu: &Hemicube, patch: NodeId) -> Vec<twins::ShotView> {
    let visibility = cpu.mesh().visibility();
    let view = |view: &Viewpoint| {
        #[expect(clippy::cast_possible_truncation, reason = "weights are kept in f32")]
        let weight = view.weight as f32;
        twins::ShotView {
            origin: view.origin.to_array(),
            weight,
            tangent: view.axes[0].to_array(),
            least_near: visibility.offset(view.origin),
        }
    };
    cpu.viewpoints(patch).iter().map(view).collect()
}
