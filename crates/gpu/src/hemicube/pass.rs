//! Pipelines of hemicubes and the order of their work.

use super::batch::Batch;
use super::counts::Probe;
use super::geometry::Geometry;
use crate::buffer::{compute, groups, layout, module, storage, uniform};
use crate::context::Context;
use hemicube_shaders::hemicube as twins;
use hemicube_shaders::memory::{DRAW_BYTES, STRIDE};
use wgpu::{
    BindGroupLayout, BindingType, CommandEncoder, ComputePipeline, RenderPipeline, ShaderModule,
    ShaderStages, TextureSampleType, TextureViewDimension,
};

/// Format of item buffers.
pub(super) const ITEMS: wgpu::TextureFormat = wgpu::TextureFormat::R32Uint;
/// Format of their depth.
pub(super) const DEPTH: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

/// Pipelines and layouts, made once.
#[derive(Debug)]
pub(crate) struct HemicubePass {
    pub(super) place_layout: BindGroupLayout,
    pub(super) arrange_layout: BindGroupLayout,
    pub(super) draw_layout: BindGroupLayout,
    pub(super) view_layout: BindGroupLayout,
    pub(super) sum_layout: BindGroupLayout,
    place: ComputePipeline,
    classify: ComputePipeline,
    scan: ComputePipeline,
    list: ComputePipeline,
    draw: RenderPipeline,
    sum: ComputePipeline,
    /// Where panes let light through.
    pub(super) peeling: Option<Peeling>,
}

/// Pipelines that look behind panes.
#[derive(Debug)]
pub(super) struct Peeling {
    pub(super) through_layout: BindGroupLayout,
    pub(super) peel_layout: BindGroupLayout,
    pub(super) layer_layout: BindGroupLayout,
    pub(super) gate_layout: BindGroupLayout,
    behind: RenderPipeline,
    peel: ComputePipeline,
    gate: ComputePipeline,
}

impl HemicubePass {
    /// Pipelines for meshes with panes, or for such without.
    pub(crate) fn new(context: &Context, peels: bool) -> Self {
        let device = &context.device;
        let (reads, writes) = (storage(true), storage(false));
        let params = uniform(false);
        let of_compute = |label, types: &[BindingType]| compute_layout(device, label, types);
        let place_types = [params, reads, reads, reads, reads, writes, writes, writes];
        let place_layout = of_compute("place hemicubes", &place_types);
        let arrange_types = [params, reads, writes, writes, writes];
        let arrange_layout = of_compute("arrange hemicubes", &arrange_types);
        let sum_layout = of_compute("sum hemicubes", &[params, items(), reads, writes]);
        let draw_layout = layout(
            device,
            "draw hemicubes",
            ShaderStages::VERTEX_FRAGMENT,
            &[uniform(false), reads, reads, reads, reads, reads],
        );
        let view_layout = layout(
            device,
            "face",
            ShaderStages::VERTEX_FRAGMENT,
            &[uniform(true)],
        );
        let place = module(device, &twins::PLACE);
        let arrange = module(device, &twins::ARRANGE);
        let draw = module(device, &twins::DRAW);
        let draw_layouts = [&draw_layout, &view_layout];
        Self {
            classify: compute(device, &place, "classify", &[&place_layout]),
            place: compute(device, &place, "place", &[&place_layout]),
            scan: compute(device, &arrange, "scan", &[&arrange_layout]),
            list: compute(device, &arrange, "list", &[&arrange_layout]),
            sum: compute(device, &module(device, &twins::SUM), "sum", &[&sum_layout]),
            draw: draw_pipeline(device, &draw, "fragment", &draw_layouts),
            peeling: peels.then(|| Peeling::new(device, &draw, draw_layouts)),
            place_layout,
            arrange_layout,
            draw_layout,
            view_layout,
            sum_layout,
        }
    }

    /// Everything from the viewpoints to the sums.
    pub(crate) fn encode(
        &self,
        encoder: &mut CommandEncoder,
        geometry: &Geometry,
        batch: &Batch,
        views: u32,
        probe: Option<&Probe>,
    ) {
        self.arrange(encoder, geometry, batch, views, probe);
        encoder.clear_buffer(&batch.sums, 0, None);
        match (&self.peeling, &batch.peeled) {
            (Some(peeling), Some(peeled)) => {
                encoder.clear_buffer(&peeled.waits, 0, None);
                for layer in 0..geometry.layers {
                    if layer > 0 {
                        peeling.gate(encoder, peeled, layer, views);
                    }
                    self.draw_all(encoder, geometry, batch, views, layer, probe);
                    peeling.peel(encoder, geometry, peeled, layer, views);
                }
            }
            _ => {
                self.draw_all(encoder, geometry, batch, views, 0, probe);
                self.sum(encoder, geometry, batch, views, probe);
            }
        }
    }

    /// The picture of the first viewpoint, panes as if they were opaque.
    pub(crate) fn encode_first_layer(
        &self,
        encoder: &mut CommandEncoder,
        geometry: &Geometry,
        batch: &Batch,
    ) {
        self.arrange(encoder, geometry, batch, 1, None);
        self.draw(encoder, geometry, batch, 0, 0, None);
    }

    /// Vertices into frames, and the lists of what each face may show.
    fn arrange(
        &self,
        encoder: &mut CommandEncoder,
        geometry: &Geometry,
        batch: &Batch,
        views: u32,
        probe: Option<&Probe>,
    ) {
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some("arrange hemicubes"),
            timestamp_writes: probe.and_then(Probe::of_arranging),
        });
        let receivers = groups(geometry.params.receivers, 64);
        for (pipeline, bindings, (x, z)) in [
            (
                &self.place,
                &batch.place,
                groups(geometry.params.vertices, 64),
            ),
            (&self.classify, &batch.place, receivers),
            (&self.scan, &batch.arrange, (twins::FACES, 1)),
            (&self.list, &batch.arrange, receivers),
        ] {
            pass.set_pipeline(pipeline);
            pass.set_bind_group(0, bindings, &[]);
            pass.dispatch_workgroups(x, views, z);
        }
    }

    fn draw_all(
        &self,
        encoder: &mut CommandEncoder,
        geometry: &Geometry,
        batch: &Batch,
        views: u32,
        layer: u32,
        probe: Option<&Probe>,
    ) {
        for view in 0..views {
            let is_last = layer + 1 == geometry.layers && view + 1 == views;
            let at = probe.map(|probe| (probe, layer * views + view, is_last));
            self.draw(encoder, geometry, batch, view, layer, at);
        }
    }

    /// One layer of one picture.
    fn draw(
        &self,
        encoder: &mut CommandEncoder,
        geometry: &Geometry,
        batch: &Batch,
        view: u32,
        layer: u32,
        probe: Option<(&Probe, u32, bool)>,
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
                view: batch.depth(view),
                depth_ops: Some(wgpu::Operations {
                    load: wgpu::LoadOp::Clear(1.0),
                    store: if batch.peeled.is_some() {
                        wgpu::StoreOp::Store
                    } else {
                        wgpu::StoreOp::Discard
                    },
                }),
                stencil_ops: None,
            }),
            timestamp_writes: probe
                .and_then(|(probe, number, is_last)| probe.of_drawing(number, is_last)),
            ..Default::default()
        });
        let statistics = probe.filter(|(probe, number, _)| probe.begin_drawing(&mut pass, *number));
        match (&self.peeling, &batch.peeled) {
            (Some(peeling), Some(peeled)) if layer > 0 => {
                pass.set_pipeline(&peeling.behind);
                pass.set_bind_group(2, &peeled.through_bindings, &[]);
            }
            _ => pass.set_pipeline(&self.draw),
        }
        pass.set_bind_group(0, &batch.draw, &[]);
        pass.set_index_buffer(geometry.indices.slice(..), wgpu::IndexFormat::Uint32);
        for (face, [x, y, width, height]) in (0..).zip(places(geometry.params.resolution)) {
            let number = view * twins::FACES + face;
            pass.set_bind_group(1, &batch.view, &[number * STRIDE]);
            pass.set_viewport(x as f32, y as f32, width as f32, height as f32, 0.0, 1.0);
            pass.set_scissor_rect(x, y, width, height);
            pass.draw_indexed_indirect(&batch.draws, u64::from(number) * DRAW_BYTES);
        }
        if statistics.is_some() {
            pass.end_pipeline_statistics_query();
        }
    }

    fn sum(
        &self,
        encoder: &mut CommandEncoder,
        geometry: &Geometry,
        batch: &Batch,
        views: u32,
        probe: Option<&Probe>,
    ) {
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some("sum hemicubes"),
            timestamp_writes: probe.and_then(Probe::of_summing),
        });
        pass.set_pipeline(&self.sum);
        pass.set_bind_group(0, &batch.sum, &[]);
        let [x, y] = segment_groups(geometry);
        pass.dispatch_workgroups(x, y, views);
    }
}

/// Where the faces lie in a picture: left, top, width, height.
pub(super) fn places(resolution: u32) -> [[u32; 4]; 5] {
    let (r, half) = (resolution, resolution / 2);
    [
        [0, 0, r, r],
        [r, 0, r, half],
        [r, half, r, half],
        [0, r, r, half],
        [r, r, r, half],
    ]
}

/// Workgroups over the segments of all rows.
fn segment_groups(geometry: &Geometry) -> [u32; 2] {
    let r = geometry.params.resolution;
    [r.div_ceil(twins::SEGMENT).div_ceil(8), (3 * r).div_ceil(8)]
}

impl Peeling {
    fn new(
        device: &wgpu::Device,
        draw: &ShaderModule,
        [scene, view]: [&BindGroupLayout; 2],
    ) -> Self {
        let (reads, writes) = (storage(true), storage(false));
        let depths = BindingType::Texture {
            sample_type: TextureSampleType::Depth,
            view_dimension: TextureViewDimension::D2Array,
            multisampled: false,
        };
        let through_layout = layout(device, "through", ShaderStages::FRAGMENT, &[reads]);
        let params = uniform(false);
        let peel_types = [
            params,
            items(),
            depths,
            reads,
            writes,
            writes,
            reads,
            writes,
        ];
        let peel_layout = compute_layout(device, "peel hemicubes", &peel_types);
        let layer_layout = compute_layout(device, "layer", &[uniform(true)]);
        let gate_layout = compute_layout(device, "gate", &[writes]);
        let shader = module(device, &twins::PEEL);
        Self {
            behind: draw_pipeline(device, draw, "behind", &[scene, view, &through_layout]),
            peel: compute(device, &shader, "peel", &[&peel_layout, &layer_layout]),
            gate: compute(
                device,
                &shader,
                "gate",
                &[&peel_layout, &layer_layout, &gate_layout],
            ),
            through_layout,
            peel_layout,
            layer_layout,
            gate_layout,
        }
    }

    /// Where nothing waits behind a layer, nothing is drawn.
    fn gate(
        &self,
        encoder: &mut CommandEncoder,
        peeled: &super::batch::Peeled,
        layer: u32,
        views: u32,
    ) {
        let mut pass = compute_pass(encoder, "gate");
        pass.set_pipeline(&self.gate);
        pass.set_bind_group(0, &peeled.peel, &[]);
        pass.set_bind_group(1, &peeled.layer, &[layer * STRIDE]);
        pass.set_bind_group(2, &peeled.gate, &[]);
        pass.dispatch_workgroups((views * twins::FACES).div_ceil(64), 1, 1);
    }

    /// Adds up a layer.
    fn peel(
        &self,
        encoder: &mut CommandEncoder,
        geometry: &Geometry,
        peeled: &super::batch::Peeled,
        layer: u32,
        views: u32,
    ) {
        let mut pass = compute_pass(encoder, "peel hemicubes");
        pass.set_pipeline(&self.peel);
        pass.set_bind_group(0, &peeled.peel, &[]);
        pass.set_bind_group(1, &peeled.layer, &[layer * STRIDE]);
        let [x, y] = segment_groups(geometry);
        pass.dispatch_workgroups(x, y, views);
    }
}

fn compute_layout(device: &wgpu::Device, label: &str, types: &[BindingType]) -> BindGroupLayout {
    layout(device, label, ShaderStages::COMPUTE, types)
}

/// Item buffers as shaders read them.
fn items() -> BindingType {
    BindingType::Texture {
        sample_type: TextureSampleType::Uint,
        view_dimension: TextureViewDimension::D2Array,
        multisampled: false,
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

fn draw_pipeline(
    device: &wgpu::Device,
    module: &ShaderModule,
    fragment: &str,
    layouts: &[&BindGroupLayout],
) -> RenderPipeline {
    let layouts: Vec<Option<&BindGroupLayout>> = layouts.iter().copied().map(Some).collect();
    let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: Some("hemicube"),
        bind_group_layouts: &layouts,
        immediate_size: 0,
    });
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some("hemicube"),
        layout: Some(&layout),
        vertex: wgpu::VertexState {
            module,
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
            module,
            entry_point: Some(fragment),
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
