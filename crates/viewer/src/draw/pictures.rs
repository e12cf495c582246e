//! Pictures on the window's device, and how they come into the window.
//!
//! egui could show them as images, but its shader mixes, samples and tints: where the processor draws, that takes more
//! time than the picture itself. Here a pixel is copied.

use crate::draw::Shown;
use egui::PaintCallbackInfo;
use egui_wgpu::{CallbackResources, CallbackTrait, RenderState};
use hemicube_gpu::Context;
use hemicube_shaders::window::PANE;
use wgpu::{
    BindGroup, BindGroupEntry, BindGroupLayout, BindGroupLayoutEntry, BindingResource, BindingType,
    RenderPass, RenderPipeline, Sampler, ShaderStages, Texture, TextureFormat, TextureUsages,
    TextureView, TextureViewDescriptor,
};

/// Pictures hold sRGB-encoded values that no sampler decodes.
pub const SHOWN: TextureFormat = TextureFormat::Rgba8Unorm;

/// What brings pictures into the window.
pub struct PaneShow {
    layout: BindGroupLayout,
    sampler: Sampler,
    /// For pictures as large as their place.
    exact: RenderPipeline,
    /// For others.
    stretched: RenderPipeline,
}

/// A pane's picture, and what it shows.
pub struct Picture {
    texture: Texture,
    /// How it comes into the window.
    pub paint: PanePaint,
    pub shows: Option<Shown>,
}

/// Shows a picture where egui puts it.
#[derive(Debug, Clone)]
pub struct PanePaint {
    pipeline: RenderPipeline,
    bindings: BindGroup,
}

impl CallbackTrait for PanePaint {
    fn paint(&self, _: PaintCallbackInfo, pass: &mut RenderPass<'static>, _: &CallbackResources) {
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &self.bindings, &[]);
        pass.draw(0..3, 0..1);
    }
}

impl PaneShow {
    /// For windows on a device.
    pub fn new(window: &RenderState) -> Self {
        let device = &window.device;
        let entry = |binding, ty| BindGroupLayoutEntry {
            binding,
            visibility: ShaderStages::FRAGMENT,
            ty,
            count: None,
        };
        let texture = BindingType::Texture {
            sample_type: wgpu::TextureSampleType::Float { filterable: true },
            view_dimension: wgpu::TextureViewDimension::D2,
            multisampled: false,
        };
        let sampler = BindingType::Sampler(wgpu::SamplerBindingType::Filtering);
        let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("pane"),
            entries: &[entry(0, texture), entry(1, sampler)],
        });
        let sampler = device.create_sampler(&wgpu::SamplerDescriptor {
            label: Some("pane"),
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            ..Default::default()
        });
        Self {
            exact: pipeline(device, &layout, "exact", window.target_format),
            stretched: pipeline(device, &layout, "stretched", window.target_format),
            layout,
            sampler,
        }
    }

    /// Not yet drawn; `is_stretched` tells whether its place has another size.
    pub fn picture(&self, context: &Context, size: [u32; 2], is_stretched: bool) -> Picture {
        let texture = texture(context, size);
        let view = texture.create_view(&TextureViewDescriptor::default());
        let entry = |binding, resource| BindGroupEntry { binding, resource };
        let bindings = context
            .device
            .create_bind_group(&wgpu::BindGroupDescriptor {
                label: Some("pane"),
                layout: &self.layout,
                entries: &[
                    entry(0, BindingResource::TextureView(&view)),
                    entry(1, BindingResource::Sampler(&self.sampler)),
                ],
            });
        let pipeline = if is_stretched {
            &self.stretched
        } else {
            &self.exact
        };
        Picture {
            texture,
            paint: PanePaint {
                pipeline: pipeline.clone(),
                bindings,
            },
            shows: None,
        }
    }
}

impl Picture {
    /// Width and height in pixels.
    pub fn size(&self) -> [u32; 2] {
        let size = self.texture.size();
        [size.width, size.height]
    }

    /// As something to draw into.
    pub fn view(&self) -> TextureView {
        self.texture.create_view(&TextureViewDescriptor::default())
    }
}

fn pipeline(
    device: &wgpu::Device,
    layout: &BindGroupLayout,
    fragment: &str,
    format: TextureFormat,
) -> RenderPipeline {
    let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some(PANE.name),
        source: wgpu::ShaderSource::Wgsl(PANE.source.into()),
    });
    let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: Some("pane"),
        bind_group_layouts: &[Some(layout)],
        immediate_size: 0,
    });
    let decodes = f64::from(u8::from(format.is_srgb()));
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some("pane"),
        layout: Some(&layout),
        vertex: wgpu::VertexState {
            module: &module,
            entry_point: Some("cover"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            buffers: &[],
        },
        primitive: wgpu::PrimitiveState::default(),
        depth_stencil: None,
        multisample: wgpu::MultisampleState::default(),
        fragment: Some(wgpu::FragmentState {
            module: &module,
            entry_point: Some(fragment),
            compilation_options: wgpu::PipelineCompilationOptions {
                constants: &[("decodes", decodes)],
                ..Default::default()
            },
            targets: &[Some(format.into())],
        }),
        multiview_mask: None,
        cache: None,
    })
}

fn texture(context: &Context, [width, height]: [u32; 2]) -> Texture {
    context.device.create_texture(&wgpu::TextureDescriptor {
        label: Some("pane"),
        size: wgpu::Extent3d {
            width,
            height,
            depth_or_array_layers: 1,
        },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: SHOWN,
        usage: TextureUsages::RENDER_ATTACHMENT | TextureUsages::TEXTURE_BINDING,
        view_formats: &[],
    })
}
