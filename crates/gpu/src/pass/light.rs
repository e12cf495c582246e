//! Light of elements on the device, and what it is at vertices: twin of `radiosity/src/drawn.rs`.
//!
//! Geometry stays as it is while light changes from frame to frame. The light is either uploaded from a [`Solution`] or
//! read where [`GpuShooting`](crate::GpuShooting) keeps it.

use crate::buffer::{bind, compute, empty, filled, groups, layout, module, storage, uniform};
use crate::context::Context;
use crate::error::GpuError;
use crate::hemicube::{compute_pass, count};
use hemicube_radiosity::Solution;
use hemicube_radiosity::solution::BANDS;
use hemicube_raster::Rgb;
use hemicube_shaders::surface as twins;
use wgpu::{
    BindGroup, BindGroupLayout, Buffer, BufferUsages, CommandEncoder, ComputePipeline, ShaderStages,
};

/// Adds groups up and takes means around vertices.
#[derive(Debug)]
pub(crate) struct LightPass {
    layout: BindGroupLayout,
    /// Groups of luminaires added up, element by element.
    elements: ComputePipeline,
    /// Means around vertices.
    vertices: ComputePipeline,
}

impl LightPass {
    pub(crate) fn new(context: &Context) -> Self {
        let device = &context.device;
        let (reads, writes) = (storage(true), storage(false));
        let layout = layout(
            device,
            "vertex light",
            ShaderStages::COMPUTE,
            &[
                uniform(false),
                reads,
                reads,
                writes,
                reads,
                reads,
                reads,
                writes,
            ],
        );
        let shader = module(device, &twins::VERTEX_LIGHT);
        Self {
            elements: compute(device, &shader, "elements", &[&layout]),
            vertices: compute(device, &shader, "vertices", &[&layout]),
            layout,
        }
    }
}

/// Light of one mesh.
#[derive(Debug)]
pub(crate) struct SurfaceLight {
    params: twins::LightParams,
    /// The same on the device.
    params_buffer: Buffer,
    /// `[group][band][element]`, where light is uploaded.
    solved: Buffer,
    /// Factors of groups.
    dims: Buffer,
    /// Irradiance of each element, all groups as dimmed.
    pub(crate) element_light: Buffer,
    /// What dimming makes of each element's emission.
    pub(crate) element_dims: Buffer,
    /// Weights of `sources`.
    weights: Buffer,
    /// The part of `sources` that belongs to each vertex.
    ranges: Buffer,
    /// Elements around vertices.
    sources: Buffer,
    /// Irradiance of each vertex.
    pub(crate) vertex_light: Buffer,
    bindings: BindGroup,
    /// Whether light has come since vertices were made of it.
    is_new: bool,
}

/// Which elements vertices take their light from.
#[derive(Debug, Default)]
pub(crate) struct VertexSources {
    pub(crate) ranges: Vec<[u32; 2]>,
    pub(crate) elements: Vec<u32>,
    pub(crate) weights: Vec<f32>,
}

impl SurfaceLight {
    pub(crate) fn new(
        context: &Context,
        pass: &LightPass,
        solution: &Solution,
        from: &VertexSources,
    ) -> Result<Self, GpuError> {
        let (device, mesh) = (&context.device, solution.mesh());
        let elements = mesh.elements().len();
        let channels = solution.groups().len() * BANDS;
        let largest = context.limits.max_storage_buffer_binding_size;
        let bytes = |items: usize, size: usize| (items * size) as u64;
        context.allow(
            "light of elements",
            bytes(channels * elements, 4),
            largest,
            "bytes",
        )?;
        context.allow("vertices", bytes(from.ranges.len(), 16), largest, "bytes")?;
        context.allow(
            "elements around vertices",
            bytes(from.elements.len(), 4),
            largest,
            "bytes",
        )?;
        let params = twins::LightParams {
            elements: count(elements),
            vertices: count(from.ranges.len()),
            groups: count(solution.groups().len()),
            padding: 0,
            extra: [0.0; 4],
        };
        let written = BufferUsages::STORAGE | BufferUsages::COPY_DST;
        let per_element = bytes(elements, 16);
        let buffer = |label, bytes| empty(device, label, bytes, written);
        let solved = buffer("solved light", bytes(channels * elements, 4));
        let dims = buffer("dims of groups", bytes(solution.groups().len(), 16));
        let element_light = buffer("light of elements", per_element);
        let params_buffer = filled(
            device,
            "light parameters",
            &[params],
            BufferUsages::UNIFORM | BufferUsages::COPY_DST,
        );
        let read_only = |label, data: &[u32]| filled(device, label, data, BufferUsages::STORAGE);
        let weights = filled(
            device,
            "weights of sources",
            &from.weights,
            BufferUsages::STORAGE,
        );
        let ranges = read_only("ranges of sources", from.ranges.as_flattened());
        let sources = read_only("sources", &from.elements);
        let vertex_light = empty(
            device,
            "light of vertices",
            bytes(from.ranges.len(), 16),
            BufferUsages::STORAGE | BufferUsages::VERTEX | BufferUsages::COPY_SRC,
        );
        let all = [
            &params_buffer,
            &solved,
            &dims,
            &element_light,
            &weights,
            &ranges,
            &sources,
            &vertex_light,
        ];
        let light = Self {
            bindings: bind(
                device,
                "vertex light",
                &pass.layout,
                &all.map(Buffer::as_entire_binding),
            ),
            element_dims: buffer("dims of elements", per_element),
            params,
            params_buffer,
            solved,
            dims,
            element_light,
            weights,
            ranges,
            sources,
            vertex_light,
            is_new: true,
        };
        Ok(light)
    }

    /// Light that is added everywhere, an estimate of what is still to come.
    pub(crate) fn set_extra(&mut self, context: &Context, extra: Rgb) {
        self.params.extra = [extra.r, extra.g, extra.b, 0.0];
        context
            .queue
            .write_buffer(&self.params_buffer, 0, bytemuck::bytes_of(&self.params));
        self.is_new = true;
    }

    /// Takes over the light of a solution on the same mesh, and its dims.
    ///
    /// # Errors
    /// The solution has other elements or groups.
    pub(crate) fn upload(
        &mut self,
        context: &Context,
        pass: &LightPass,
        solution: &Solution,
    ) -> Result<(), GpuError> {
        self.check(size_of(solution))?;
        self.read_from(context, pass, &self.solved.clone());
        let elements = self.params.elements as usize;
        for group in 0..solution.groups().len() {
            for band in 0..BANDS {
                let offset = ((group * BANDS + band) * elements * 4) as u64;
                let values = bytemuck::cast_slice(solution.irradiance(group, band));
                context.queue.write_buffer(&self.solved, offset, values);
            }
        }
        self.upload_dims(context, solution)
    }

    /// Takes over how a solution dims its groups.
    ///
    /// # Errors
    /// The solution has other elements or groups.
    pub(crate) fn upload_dims(
        &mut self,
        context: &Context,
        solution: &Solution,
    ) -> Result<(), GpuError> {
        self.check(size_of(solution))?;
        let padded = |c: Rgb| [c.r, c.g, c.b, 0.0];
        let dims: Vec<[f32; 4]> = solution.groups().iter().map(|g| padded(g.dim)).collect();
        let of_elements: Vec<[f32; 4]> = emission_dims(solution).map(padded).collect();
        let queue = &context.queue;
        queue.write_buffer(&self.dims, 0, bytemuck::cast_slice(&dims));
        queue.write_buffer(&self.element_dims, 0, bytemuck::cast_slice(&of_elements));
        self.is_new = true;
        Ok(())
    }

    /// Reads light where a solver keeps it from now on.
    pub(crate) fn read_from(&mut self, context: &Context, pass: &LightPass, solved: &Buffer) {
        let all = [
            &self.params_buffer,
            solved,
            &self.dims,
            &self.element_light,
            &self.weights,
            &self.ranges,
            &self.sources,
            &self.vertex_light,
        ];
        let bindings = all.map(Buffer::as_entire_binding);
        self.bindings = bind(&context.device, "vertex light", &pass.layout, &bindings);
        self.is_new = true;
    }

    /// Refuses light of so many elements and groups if they are others.
    ///
    /// # Errors
    /// They are.
    pub(crate) fn check(&self, found: [usize; 2]) -> Result<(), GpuError> {
        let wanted = [self.params.elements, self.params.groups].map(|n| n as usize);
        if found == wanted {
            return Ok(());
        }
        Err(GpuError::Option(format!(
            "light of {} elements in {} groups for a picture of {} elements in {} groups; make the picture anew",
            found[0], found[1], wanted[0], wanted[1]
        )))
    }

    /// Brings new light to the vertices, if some has come.
    pub(crate) fn update(&mut self, encoder: &mut CommandEncoder, pass: &LightPass) {
        if !core::mem::take(&mut self.is_new) {
            return;
        }
        let mut run = compute_pass(encoder, "vertex light");
        run.set_bind_group(0, &self.bindings, &[]);
        for (pipeline, invocations) in [
            (&pass.elements, self.params.elements),
            (&pass.vertices, self.params.vertices),
        ] {
            let (x, z) = groups(invocations, 64);
            run.set_pipeline(pipeline);
            run.dispatch_workgroups(x, 1, z);
        }
    }
}

/// Elements and groups of a solution.
fn size_of(solution: &Solution) -> [usize; 2] {
    [solution.mesh().elements().len(), solution.groups().len()]
}

/// Dimmed by undimmed exitance of each element; 1 where one emits nothing.
fn emission_dims(solution: &Solution) -> impl Iterator<Item = Rgb> {
    let emission = solution.mesh().emission().iter().enumerate();
    emission.map(|(e, emission)| {
        let dimmed = solution.element_exitance(e);
        let ratio = |band: usize| {
            if emission[band] > 0.0 {
                dimmed[band] / emission[band]
            } else {
                1.0
            }
        };
        Rgb::new(ratio(0), ratio(1), ratio(2))
    })
}
