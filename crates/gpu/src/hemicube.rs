//! Form factors by hemicubes on the GPU: twin of `radiosity/src/form_factor/hemicube.rs`.
//!
//! ```text
//! for each batch of hemicubes, one submission:
//!     place:    vertices into their frames            compute, vertices × hemicubes
//!     classify: what each receiver may be seen as     compute, receivers × hemicubes
//!     draw:     item buffers, five faces in a picture  one render pass a hemicube
//!     sum:      delta form factors by item            compute, segments of rows × hemicubes
//!     read one number for each element and hemicube
//! ```
//!
//! Where hemicubes stand, how many a patch gets and what is done about receivers of few cells is decided by the CPU's
//! [`Hemicube`], whose row this is but for who draws it. Delta form factors are rounded to multiples of 2⁻³¹, so that sums
//! are exact and every run gives the same bits.

use crate::backend::Report;
use crate::buffer::{bind, compute, empty, filled, groups, layout, module, storage, uniform};
use crate::context::Context;
use crate::error::GpuError;
use bytemuck::Zeroable;
use core::fmt;
use hemicube_radiosity::form_factor::hemicube::{
    Hemicube, HemicubeOptions, ItemBuffers, Projection, Sums, Viewpoint,
};
use hemicube_radiosity::form_factor::{FormFactors, Row};
use hemicube_radiosity::patch::face::Side;
use hemicube_radiosity::patch::subdivide::Cell;
use hemicube_radiosity::patch::{NodeId, NodeKind, PatchMesh};
use hemicube_shaders::hemicube as twins;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};
use wgpu::{
    BindGroup, BindGroupLayout, Buffer, BufferUsages, CommandEncoder, ComputePipeline,
    RenderPipeline, ShaderStages, Texture, TextureView,
};

/// What all the light of a hemicube is in whole numbers.
pub(crate) const ALL: f64 = 2_147_483_648.0;
/// Most hemicubes of a submission.
const MOST_VIEWS: u64 = 16;
/// Most memory of the pictures of a submission, in bytes.
const MOST_PICTURES: u64 = 64 << 20;
/// Format of item buffers.
const ITEMS: wgpu::TextureFormat = wgpu::TextureFormat::R32Uint;
/// Format of their depth.
const DEPTH: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;
/// Distance of the parameters of two draw calls in their buffer: the most that an adapter may ask for.
const STRIDE: usize = 256;

/// Form factors by hemicubes on the GPU.
///
/// When the device is lost or its memory runs out, rows go on with the CPU's hemicubes; [`GpuHemicube::failure`] says so.
pub struct GpuHemicube {
    context: Arc<Context>,
    cpu: Hemicube,
    pass: HemicubePass,
    geometry: Geometry,
    batch: Mutex<Batch>,
    failure: OnceLock<GpuError>,
    report: Option<Report>,
}

impl fmt::Debug for GpuHemicube {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("GpuHemicube")
            .field("context", &self.context)
            .field("failure", &self.failure)
            .finish_non_exhaustive()
    }
}

impl GpuHemicube {
    /// Factors between the nodes of a mesh.
    ///
    /// # Errors
    /// Options out of their range, another projection than the hemicube, or a mesh or a resolution that does not fit the
    /// adapter's limits.
    pub fn new(
        context: Arc<Context>,
        mesh: Arc<PatchMesh>,
        options: HemicubeOptions,
    ) -> Result<Self, GpuError> {
        if options.projection != Projection::Hemicube {
            return Err(GpuError::Option(String::from(
                "the GPU draws hemicubes only; use the CPU for other projections",
            )));
        }
        let cpu = Hemicube::new(mesh, options).map_err(|e| GpuError::Option(e.to_string()))?;
        let geometry = Geometry::new(&context, &cpu)?;
        let pass = HemicubePass::new(&context);
        let batch = Batch::new(&context, &pass, &geometry, MOST_VIEWS)?;
        context.wait()?;
        Ok(Self {
            batch: Mutex::new(batch),
            failure: OnceLock::new(),
            report: None,
            context,
            cpu,
            pass,
            geometry,
        })
    }

    /// `report` hears why rows come from the CPU.
    pub(crate) fn with_report(self, report: Report) -> Self {
        Self {
            report: Some(report),
            ..self
        }
    }

    /// Why rows come from the CPU since then, if they do.
    pub fn failure(&self) -> Option<&GpuError> {
        self.failure.get()
    }

    /// Hemicubes of one submission.
    pub fn batch_size(&self) -> usize {
        self.batch
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .views
    }

    /// The item buffers of a node's first hemicube, as [`Hemicube::item_buffers`] gives them.
    ///
    /// # Errors
    /// The device was lost or its memory ran out.
    pub fn item_buffers(&self, source: NodeId) -> Result<ItemBuffers, GpuError> {
        let batch = self.batch.lock().unwrap_or_else(PoisonError::into_inner);
        let views = &self.cpu.viewpoints(source)[..1];
        self.draw(&batch, views, |_| {});
        let picture = batch.read_picture(&self.context)?;
        let resolution = self.cpu.options().resolution as usize;
        let public = |item: u32| match item {
            twins::ITEM_EMPTY => ItemBuffers::NOTHING,
            back if back & 1 == 1 => ItemBuffers::ABSORBED,
            front => front >> 1,
        };
        let half = resolution / 2;
        let places = [
            (0, 0, resolution),
            (resolution, 0, half),
            (resolution, half, half),
            (0, resolution, half),
            (resolution, resolution, half),
        ];
        let face = |(left, top, height): (usize, usize, usize)| {
            let cell = |y: usize, x: usize| public(picture[(top + y) * 2 * resolution + left + x]);
            (0..height)
                .flat_map(|y| (0..resolution).map(move |x| (y, x)))
                .map(|(y, x)| cell(y, x))
                .collect()
        };
        Ok(ItemBuffers {
            resolution,
            faces: places.into_iter().map(face).collect(),
        })
    }

    /// What some hemicubes see.
    fn sums(&self, views: &[Viewpoint]) -> Result<Vec<Sums>, GpuError> {
        let batch = self.batch.lock().unwrap_or_else(PoisonError::into_inner);
        let mut sums = Vec::with_capacity(views.len());
        for views in views.chunks(batch.views) {
            self.draw(&batch, views, |encoder| {
                batch.copy_sums(encoder, views.len());
            });
            sums.extend(batch.read_sums(&self.context, views.len())?);
        }
        Ok(sums)
    }

    /// Submits everything from the viewpoints to the sums, and what `then` adds.
    fn draw(&self, batch: &Batch, views: &[Viewpoint], then: impl FnOnce(&mut CommandEncoder)) {
        let mesh = self.cpu.mesh();
        let twins: Vec<twins::Viewpoint> = views.iter().map(|view| viewpoint(mesh, view)).collect();
        self.context
            .queue
            .write_buffer(&batch.viewpoints, 0, bytemuck::cast_slice(&twins));
        let descriptor = wgpu::CommandEncoderDescriptor {
            label: Some("hemicubes"),
        };
        let mut encoder = self.context.device.create_command_encoder(&descriptor);
        let count = u32::try_from(views.len()).expect("a batch of a few");
        self.pass.place(&mut encoder, &self.geometry, batch, count);
        for view in 0..count {
            self.pass.draw(&mut encoder, &self.geometry, batch, view);
        }
        self.pass.sum(&mut encoder, &self.geometry, batch, count);
        then(&mut encoder);
        self.context.queue.submit([encoder.finish()]);
    }
}

impl FormFactors for GpuHemicube {
    fn mesh(&self) -> &Arc<PatchMesh> {
        self.cpu.mesh()
    }

    fn fill_row(&self, source: NodeId, row: &mut Row) {
        if self.cpu.is_layered() || self.failure.get().is_some() {
            return self.cpu.fill_row(source, row);
        }
        let views = self.cpu.viewpoints(source);
        match self.sums(&views) {
            Ok(sums) => self.cpu.row_of_sums(source, &views, &sums, row),
            Err(failure) => {
                // Another thread may have been first; either reason is true.
                if let (Ok(()), Some(report)) = (self.failure.set(failure.clone()), &self.report) {
                    report(&failure);
                }
                self.cpu.fill_row(source, row);
            }
        }
    }
}

/// A viewpoint as the shaders know it.
pub(crate) fn viewpoint(mesh: &PatchMesh, view: &Viewpoint) -> twins::Viewpoint {
    let [tangent, bitangent, normal] = view.axes.map(|axis| axis.to_array());
    twins::Viewpoint {
        origin: view.origin.to_array(),
        least_near: mesh.visibility().offset(view.origin),
        tangent,
        farthest: mesh.visibility().diameter(),
        bitangent,
        normal,
        ..twins::Viewpoint::zeroed()
    }
}

/// The mesh on the device.
#[derive(Debug)]
pub(crate) struct Geometry {
    pub(crate) params: twins::HemicubeParams,
    params_buffer: Buffer,
    vertices: Buffer,
    receivers: Buffer,
    /// Two triangles for each receiver.
    indices: Buffer,
    /// Running sums of delta form factors, see [`hemicube_shaders::hemicube::SUM`].
    deltas: Buffer,
}

impl Geometry {
    pub(crate) fn new(context: &Context, cpu: &Hemicube) -> Result<Self, GpuError> {
        let mesh = cpu.mesh();
        let vertices: Vec<[f32; 4]> = mesh
            .vertices()
            .iter()
            .map(|v| v.extend(0.0).to_array())
            .collect();
        let receivers = receivers(cpu);
        // Items are numbers of 31 bits.
        context.allow("elements", receivers.len() as u64, (1 << 30) - 1, "places")?;
        let largest = context.limits.max_storage_buffer_binding_size;
        let bytes = (receivers.len() * size_of::<twins::Receiver>()) as u64;
        context.allow("elements", bytes, largest, "bytes")?;
        context.allow("vertices", (vertices.len() * 16) as u64, largest, "bytes")?;
        context.allow(
            "indices",
            (receivers.len() * 24) as u64,
            context.limits.max_buffer_size,
            "bytes",
        )?;
        let resolution = cpu.options().resolution;
        let side = u64::from(2 * resolution);
        let longest = u64::from(context.limits.max_texture_dimension_2d);
        context.allow(
            "hemicubes of this resolution",
            side,
            longest,
            "pixels a side",
        )?;
        let params = twins::HemicubeParams {
            receivers: count(receivers.len()),
            vertices: count(vertices.len()),
            elements: count(mesh.elements().len()),
            resolution,
        };
        let device = &context.device;
        let buffer = |label, usage| move |data: &[u8]| filled(device, label, data, usage);
        let indices: Vec<u32> = (0..params.receivers)
            .flat_map(|r| [0, 1, 2, 0, 2, 3].map(|k| 4 * r + k))
            .collect();
        Ok(Self {
            params_buffer: buffer("parameters", BufferUsages::UNIFORM)(bytemuck::bytes_of(&params)),
            vertices: buffer("vertices", BufferUsages::STORAGE)(bytemuck::cast_slice(&vertices)),
            receivers: buffer("receivers", BufferUsages::STORAGE)(bytemuck::cast_slice(&receivers)),
            indices: buffer("indices", BufferUsages::INDEX)(bytemuck::cast_slice(&indices)),
            deltas: buffer("delta factors", BufferUsages::STORAGE)(bytemuck::cast_slice(
                &whole_sums(cpu),
            )),
            params,
        })
    }
}

pub(crate) fn count(n: usize) -> u32 {
    u32::try_from(n).expect("checked against the adapter's limits")
}

/// Elements, then obstructions.
fn receivers(cpu: &Hemicube) -> Vec<twins::Receiver> {
    let mesh = cpu.mesh();
    let four = |corners: &[u32]| [0, 1, 2, 3].map(|k: usize| corners[k.min(corners.len() - 1)]);
    let element = |(element, &id): (usize, &NodeId)| {
        let node = mesh.node(id);
        let NodeKind::Surface { face, .. } = node.kind else {
            unreachable!("elements are surfaces")
        };
        let both = mesh.visibility().receives(face as usize, Side::Back);
        let exposed = mesh.exposed_area(element) > 0.0;
        twins::Receiver {
            corners: four(mesh.corners(id)),
            normal: node.normal.to_array(),
            flags: if both { twins::RECEIVER_BOTH_SIDES } else { 0 }
                | if exposed { twins::RECEIVER_EXPOSED } else { 0 },
            centroid: node.centroid.to_array(),
            radius: cpu.radius(element),
        }
    };
    let obstruction = |(face, cell): &(u32, Cell)| {
        let corners = four(cell.corners());
        let places = corners.map(|c| mesh.vertices()[c as usize]);
        let centroid = places.iter().sum::<glam::Vec3>() / 4.0;
        twins::Receiver {
            corners,
            normal: mesh.faces()[*face as usize].normal.to_array(),
            flags: twins::RECEIVER_OBSTRUCTION,
            centroid: centroid.to_array(),
            radius: places
                .iter()
                .map(|p| p.distance(centroid))
                .fold(0.0, f32::max),
        }
    };
    let elements = mesh.elements().iter().enumerate().map(element);
    elements
        .chain(mesh.obstructions().iter().map(obstruction))
        .collect()
}

/// Running sums of delta form factors as whole numbers.
fn whole_sums(cpu: &Hemicube) -> Vec<u32> {
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a share of 1 times 2^31"
    )]
    cpu.delta_factors()
        .running_sums()
        .map(|sum| (sum * ALL).round() as u32)
        .collect()
}

/// Pipelines and layouts, made once.
#[derive(Debug)]
pub(crate) struct HemicubePass {
    place_layout: BindGroupLayout,
    draw_layout: BindGroupLayout,
    view_layout: BindGroupLayout,
    sum_layout: BindGroupLayout,
    place: ComputePipeline,
    classify: ComputePipeline,
    draw: RenderPipeline,
    sum: ComputePipeline,
}

impl HemicubePass {
    pub(crate) fn new(context: &Context) -> Self {
        let device = &context.device;
        let (reads, writes) = (storage(true), storage(false));
        let place_layout = layout(
            device,
            "place hemicubes",
            ShaderStages::COMPUTE,
            &[uniform(false), reads, reads, reads, writes, writes, writes],
        );
        let draw_layout = layout(
            device,
            "draw hemicubes",
            ShaderStages::VERTEX,
            &[uniform(false), reads, reads, reads, reads, reads],
        );
        let view_layout = layout(device, "hemicube", ShaderStages::VERTEX, &[uniform(true)]);
        let items = wgpu::BindingType::Texture {
            sample_type: wgpu::TextureSampleType::Uint,
            view_dimension: wgpu::TextureViewDimension::D2Array,
            multisampled: false,
        };
        let sum_layout = layout(
            device,
            "sum hemicubes",
            ShaderStages::COMPUTE,
            &[uniform(false), items, reads, writes],
        );
        let place = module(device, &twins::PLACE);
        Self {
            classify: compute(device, &place, "classify", &[&place_layout]),
            place: compute(device, &place, "place", &[&place_layout]),
            draw: draw_pipeline(device, [&draw_layout, &view_layout]),
            sum: compute(device, &module(device, &twins::SUM), "sum", &[&sum_layout]),
            place_layout,
            draw_layout,
            view_layout,
            sum_layout,
        }
    }

    pub(crate) fn place(
        &self,
        encoder: &mut CommandEncoder,
        geometry: &Geometry,
        batch: &Batch,
        views: u32,
    ) {
        let mut pass = compute_pass(encoder, "place hemicubes");
        pass.set_bind_group(0, &batch.place, &[]);
        for (pipeline, invocations) in [
            (&self.place, geometry.params.vertices),
            (&self.classify, geometry.params.receivers),
        ] {
            let (x, z) = groups(invocations, 64);
            pass.set_pipeline(pipeline);
            pass.dispatch_workgroups(x, views, z);
        }
    }

    pub(crate) fn draw(
        &self,
        encoder: &mut CommandEncoder,
        geometry: &Geometry,
        batch: &Batch,
        view: u32,
    ) {
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("hemicube"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &batch.pictures[view as usize],
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(wgpu::Color {
                        r: f64::from(twins::ITEM_EMPTY),
                        ..wgpu::Color::TRANSPARENT
                    }),
                    store: wgpu::StoreOp::Store,
                },
            })],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &batch.depth,
                depth_ops: Some(wgpu::Operations {
                    load: wgpu::LoadOp::Clear(1.0),
                    store: wgpu::StoreOp::Discard,
                }),
                stencil_ops: None,
            }),
            ..Default::default()
        });
        pass.set_pipeline(&self.draw);
        pass.set_bind_group(0, &batch.draw, &[]);
        let offset = u32::try_from(STRIDE).expect("small") * view;
        pass.set_bind_group(1, &batch.view, &[offset]);
        pass.set_index_buffer(geometry.indices.slice(..), wgpu::IndexFormat::Uint32);
        let (r, half) = (geometry.params.resolution, geometry.params.resolution / 2);
        let places = [
            (0, 0, r),
            (r, 0, half),
            (r, half, half),
            (0, r, half),
            (r, r, half),
        ];
        for (face, (x, y, height)) in (0..).zip(places) {
            pass.set_viewport(x as f32, y as f32, r as f32, height as f32, 0.0, 1.0);
            pass.set_scissor_rect(x, y, r, height);
            pass.draw_indexed(0..6 * geometry.params.receivers, 0, face..face + 1);
        }
    }

    pub(crate) fn sum(
        &self,
        encoder: &mut CommandEncoder,
        geometry: &Geometry,
        batch: &Batch,
        views: u32,
    ) {
        encoder.clear_buffer(&batch.sums, 0, None);
        let mut pass = compute_pass(encoder, "sum hemicubes");
        pass.set_pipeline(&self.sum);
        pass.set_bind_group(0, &batch.sum, &[]);
        let r = geometry.params.resolution;
        let segments = r.div_ceil(twins::SEGMENT);
        pass.dispatch_workgroups(segments.div_ceil(8), (3 * r).div_ceil(8), views);
    }
}

pub(crate) fn compute_pass<'a>(
    encoder: &'a mut CommandEncoder,
    label: &str,
) -> wgpu::ComputePass<'a> {
    encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
        label: Some(label),
        timestamp_writes: None,
    })
}

fn draw_pipeline(device: &wgpu::Device, layouts: [&BindGroupLayout; 2]) -> RenderPipeline {
    let module = module(device, &twins::DRAW);
    let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: Some("hemicube"),
        bind_group_layouts: &layouts.map(Some),
        immediate_size: 0,
    });
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some("hemicube"),
        layout: Some(&layout),
        vertex: wgpu::VertexState {
            module: &module,
            entry_point: Some("vertex"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            buffers: &[],
        },
        primitive: wgpu::PrimitiveState::default(),
        depth_stencil: Some(wgpu::DepthStencilState {
            format: DEPTH,
            depth_write_enabled: Some(true),
            depth_compare: Some(wgpu::CompareFunction::Less),
            stencil: wgpu::StencilState::default(),
            bias: wgpu::DepthBiasState::default(),
        }),
        multisample: wgpu::MultisampleState::default(),
        fragment: Some(wgpu::FragmentState {
            module: &module,
            entry_point: Some("fragment"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            targets: &[Some(wgpu::ColorTargetState {
                format: ITEMS,
                blend: None,
                write_mask: wgpu::ColorWrites::ALL,
            })],
        }),
        multiview_mask: None,
        cache: None,
    })
}

/// Memory for the hemicubes of one submission.
#[derive(Debug)]
pub(crate) struct Batch {
    views: usize,
    elements: usize,
    pub(crate) viewpoints: Buffer,
    pub(crate) sums: Buffer,
    /// Where the CPU reads the sums.
    read: Buffer,
    items: Texture,
    /// One picture for each hemicube.
    pictures: Vec<TextureView>,
    depth: TextureView,
    place: BindGroup,
    draw: BindGroup,
    view: BindGroup,
    sum: BindGroup,
}

impl Batch {
    /// Memory for at most `most` hemicubes at once.
    pub(crate) fn new(
        context: &Context,
        pass: &HemicubePass,
        geometry: &Geometry,
        most: u64,
    ) -> Result<Self, GpuError> {
        let (device, params) = (&context.device, geometry.params);
        let bins = u64::from(params.elements) + 2;
        let picture = 3 * u64::from(params.resolution).pow(2) * 4;
        let per_view = [
            16 * u64::from(params.vertices),
            4 * u64::from(params.receivers),
            4 * bins,
        ];
        let largest = context.limits.max_storage_buffer_binding_size;
        let views = per_view
            .iter()
            .map(|bytes| largest / bytes.max(&1))
            .chain([
                most,
                (MOST_PICTURES / picture).max(1),
                u64::from(context.limits.max_texture_array_layers),
            ])
            .min()
            .unwrap_or(1)
            .max(1);
        context.allow("vertices", per_view[0], largest, "bytes")?;
        let layers = u32::try_from(views).expect("a few");
        let (storage, copied) = (
            BufferUsages::STORAGE,
            BufferUsages::COPY_SRC | BufferUsages::COPY_DST,
        );
        let viewpoint_bytes = views * size_of::<twins::Viewpoint>() as u64;
        let viewpoints = empty(
            device,
            "viewpoints",
            viewpoint_bytes,
            storage | BufferUsages::COPY_DST,
        );
        let placed = empty(device, "placed vertices", views * per_view[0], storage);
        let seen = empty(device, "seen receivers", views * per_view[1], storage);
        let nearest = empty(device, "nearest", 4 * views, storage);
        let sums = empty(device, "sums", views * per_view[2], storage | copied);
        let read = empty(
            device,
            "sums to read",
            views * per_view[2],
            BufferUsages::MAP_READ | BufferUsages::COPY_DST,
        );
        let draws: Vec<u32> = (0..layers)
            .flat_map(|viewpoint| {
                let mut words = [0; STRIDE / 4];
                words[0] = viewpoint;
                words
            })
            .collect();
        let draws = filled(device, "draw parameters", &draws, BufferUsages::UNIFORM);
        let items = picture_texture(device, "item buffers", params.resolution, layers, ITEMS);
        let depth = picture_texture(device, "depth", params.resolution, 1, DEPTH);
        let layer = |base_array_layer| {
            items.create_view(&wgpu::TextureViewDescriptor {
                dimension: Some(wgpu::TextureViewDimension::D2),
                base_array_layer,
                array_layer_count: Some(1),
                ..Default::default()
            })
        };
        let all = items.create_view(&wgpu::TextureViewDescriptor {
            dimension: Some(wgpu::TextureViewDimension::D2Array),
            ..Default::default()
        });
        let [parameters, vertices, receivers, deltas] = [
            &geometry.params_buffer,
            &geometry.vertices,
            &geometry.receivers,
            &geometry.deltas,
        ]
        .map(Buffer::as_entire_binding);
        let [viewpoint, place, see, near, sum] =
            [&viewpoints, &placed, &seen, &nearest, &sums].map(Buffer::as_entire_binding);
        let one = wgpu::BindingResource::Buffer(wgpu::BufferBinding {
            buffer: &draws,
            offset: 0,
            size: wgpu::BufferSize::new(size_of::<twins::DrawParams>() as u64),
        });
        Ok(Self {
            views: layers as usize,
            elements: params.elements as usize,
            place: bind(
                device,
                "place hemicubes",
                &pass.place_layout,
                &[
                    parameters.clone(),
                    vertices,
                    receivers.clone(),
                    viewpoint.clone(),
                    place.clone(),
                    see.clone(),
                    near.clone(),
                ],
            ),
            draw: bind(
                device,
                "draw hemicubes",
                &pass.draw_layout,
                &[parameters.clone(), receivers, viewpoint, place, see, near],
            ),
            view: bind(device, "hemicube", &pass.view_layout, &[one]),
            sum: bind(
                device,
                "sum hemicubes",
                &pass.sum_layout,
                &[
                    parameters,
                    wgpu::BindingResource::TextureView(&all),
                    deltas,
                    sum,
                ],
            ),
            pictures: (0..layers).map(layer).collect(),
            depth: depth.create_view(&wgpu::TextureViewDescriptor::default()),
            items,
            viewpoints,
            sums,
            read,
        })
    }

    fn copy_sums(&self, encoder: &mut CommandEncoder, views: usize) {
        let bytes = (views * (self.elements + 2) * 4) as u64;
        encoder.copy_buffer_to_buffer(&self.sums, 0, &self.read, 0, bytes);
    }

    fn read_sums(&self, context: &Context, views: usize) -> Result<Vec<Sums>, GpuError> {
        let bins = self.elements + 2;
        let words = read(context, &self.read, (views * bins * 4) as u64)?;
        let share = |word: &u32| f64::from(*word) / ALL;
        let sums = |words: &[u32]| Sums {
            received: words[..self.elements].iter().map(share).collect(),
            absorbed: share(&words[self.elements]),
            escaped: share(&words[self.elements + 1]),
        };
        Ok(words.chunks(bins).map(sums).collect())
    }

    /// The first picture, row by row.
    fn read_picture(&self, context: &Context) -> Result<Vec<u32>, GpuError> {
        let size = wgpu::Extent3d {
            depth_or_array_layers: 1,
            ..self.items.size()
        };
        let row = (size.width * 4).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
        let bytes = u64::from(row) * u64::from(size.height);
        let usage = BufferUsages::MAP_READ | BufferUsages::COPY_DST;
        let buffer = empty(&context.device, "picture to read", bytes, usage);
        let mut encoder = context
            .device
            .create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        encoder.copy_texture_to_buffer(
            self.items.as_image_copy(),
            wgpu::TexelCopyBufferInfo {
                buffer: &buffer,
                layout: wgpu::TexelCopyBufferLayout {
                    offset: 0,
                    bytes_per_row: Some(row),
                    rows_per_image: None,
                },
            },
            size,
        );
        context.queue.submit([encoder.finish()]);
        let words = read(context, &buffer, bytes)?;
        let rows = words.chunks(row as usize / 4);
        Ok(rows
            .flat_map(|row| &row[..size.width as usize])
            .copied()
            .collect())
    }
}

/// A texture for pictures of hemicubes.
fn picture_texture(
    device: &wgpu::Device,
    label: &str,
    resolution: u32,
    layers: u32,
    format: wgpu::TextureFormat,
) -> Texture {
    device.create_texture(&wgpu::TextureDescriptor {
        label: Some(label),
        size: wgpu::Extent3d {
            width: 2 * resolution,
            height: 3 * resolution / 2,
            depth_or_array_layers: layers,
        },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: if format == ITEMS {
            wgpu::TextureUsages::RENDER_ATTACHMENT
                | wgpu::TextureUsages::TEXTURE_BINDING
                | wgpu::TextureUsages::COPY_SRC
        } else {
            wgpu::TextureUsages::RENDER_ATTACHMENT
        },
        view_formats: &[],
    })
}

/// Waits for the device and reads the words of a mappable buffer.
pub(crate) fn read(context: &Context, buffer: &Buffer, bytes: u64) -> Result<Vec<u32>, GpuError> {
    let (send, receive) = std::sync::mpsc::channel();
    buffer.map_async(wgpu::MapMode::Read, 0..bytes, move |result| {
        // The receiver is there until the result has come or the device is lost.
        let _ = send.send(result);
    });
    context.wait()?;
    let lost = |why: String| GpuError::Lost {
        adapter: context.name.clone(),
        why,
    };
    match receive.try_recv() {
        Ok(Ok(())) => {}
        Ok(Err(e)) => return Err(lost(e.to_string())),
        Err(_) => return Err(lost(String::from("nothing came back"))),
    }
    let words = {
        let view = buffer
            .get_mapped_range(0..bytes)
            .map_err(|e| lost(e.to_string()))?;
        bytemuck::pod_collect_to_vec(&view)
    };
    buffer.unmap();
    Ok(words)
}
