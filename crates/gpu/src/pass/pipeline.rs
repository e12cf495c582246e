//! Render pipelines in few words.

use crate::buffer;
use hemicube_shaders::Shader;
use std::collections::HashMap;
use std::hash::Hash;
use wgpu::{
    BindGroupLayout, BlendComponent, BlendFactor, BlendOperation, BlendState, Device,
    RenderPipeline, TextureFormat, VertexBufferLayout,
};

/// Format of depth. Depth is reversed, 1 near and 0 far, which floats resolve evenly.
pub(crate) const DEPTH: TextureFormat = TextureFormat::Depth32Float;

/// What becomes of what is in the target already.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) enum Blend {
    /// It is replaced.
    Replace,
    /// The new one is added.
    Add,
    /// It is multiplied by the new one.
    Multiply,
    /// It is covered by as much as the new one's alpha, which its colour was multiplied by.
    Over,
}

impl Blend {
    fn state(self) -> Option<BlendState> {
        let (src_factor, dst_factor) = match self {
            Self::Replace => return None,
            Self::Add => (BlendFactor::One, BlendFactor::One),
            Self::Multiply => (BlendFactor::Zero, BlendFactor::Src),
            Self::Over => (BlendFactor::One, BlendFactor::OneMinusSrcAlpha),
        };
        let color = BlendComponent {
            src_factor,
            dst_factor,
            operation: BlendOperation::Add,
        };
        Some(BlendState {
            color,
            alpha: color,
        })
    }
}

/// What a pipeline does with depth.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) enum Depth {
    /// There is none.
    None,
    /// What is farther away is not drawn.
    Test,
    /// Nor is it when the next thing is drawn.
    TestAndWrite,
}

/// Everything that tells pipelines apart.
#[derive(Debug)]
pub(crate) struct PipelineOptions<'a> {
    pub(crate) label: &'a str,
    pub(crate) module: &'a wgpu::ShaderModule,
    pub(crate) vertex: &'a str,
    pub(crate) fragment: &'a str,
    /// Values of the fragment stage's overrides.
    pub(crate) constants: &'a [(&'a str, f64)],
    pub(crate) layouts: &'a [&'a BindGroupLayout],
    pub(crate) buffers: &'a [VertexBufferLayout<'a>],
    pub(crate) is_strip: bool,
    pub(crate) culls: bool,
    pub(crate) depth: Depth,
    pub(crate) blend: Blend,
    pub(crate) format: TextureFormat,
    pub(crate) samples: u32,
}

/// A pipeline of a vertex and a fragment stage.
pub(crate) fn render(device: &Device, options: &PipelineOptions<'_>) -> RenderPipeline {
    let layouts: Vec<Option<&BindGroupLayout>> =
        options.layouts.iter().copied().map(Some).collect();
    let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: Some(options.label),
        bind_group_layouts: &layouts,
        immediate_size: 0,
    });
    let buffers: Vec<Option<VertexBufferLayout<'_>>> =
        options.buffers.iter().cloned().map(Some).collect();
    let depth_stencil = (options.depth != Depth::None).then(|| wgpu::DepthStencilState {
        format: DEPTH,
        depth_write_enabled: Some(options.depth == Depth::TestAndWrite),
        depth_compare: Some(wgpu::CompareFunction::GreaterEqual),
        stencil: wgpu::StencilState::default(),
        bias: wgpu::DepthBiasState::default(),
    });
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some(options.label),
        layout: Some(&layout),
        vertex: wgpu::VertexState {
            module: options.module,
            entry_point: Some(options.vertex),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            buffers: &buffers,
        },
        primitive: wgpu::PrimitiveState {
            topology: if options.is_strip {
                wgpu::PrimitiveTopology::TriangleStrip
            } else {
                wgpu::PrimitiveTopology::TriangleList
            },
            cull_mode: options.culls.then_some(wgpu::Face::Back),
            ..Default::default()
        },
        depth_stencil,
        multisample: wgpu::MultisampleState {
            count: options.samples,
            ..Default::default()
        },
        fragment: Some(wgpu::FragmentState {
            module: options.module,
            entry_point: Some(options.fragment),
            compilation_options: wgpu::PipelineCompilationOptions {
                constants: options.constants,
                ..Default::default()
            },
            targets: &[Some(wgpu::ColorTargetState {
                format: options.format,
                blend: options.blend.state(),
                write_mask: wgpu::ColorWrites::ALL,
            })],
        }),
        multiview_mask: None,
        cache: None,
    })
}

/// A pipeline that draws every pixel of a target with a shader whose vertex stage is `screen`.
pub(crate) fn for_every_pixel(
    device: &Device,
    module: &wgpu::ShaderModule,
    fragment: &str,
    layout: &BindGroupLayout,
    format: TextureFormat,
) -> RenderPipeline {
    let options = PipelineOptions {
        label: fragment,
        module,
        vertex: "screen",
        fragment,
        constants: &[],
        layouts: &[layout],
        buffers: &[],
        is_strip: false,
        culls: false,
        depth: Depth::None,
        blend: Blend::Replace,
        format,
        samples: 1,
    };
    render(device, &options)
}

/// A shader that becomes a module when it is first asked for, and the pipelines made of it.
#[derive(Debug)]
pub(crate) struct Pipelines<K> {
    shader: &'static Shader,
    module: Option<wgpu::ShaderModule>,
    made: HashMap<K, RenderPipeline>,
}

impl<K: Copy + Eq + Hash> Pipelines<K> {
    /// None yet.
    pub(crate) fn new(shader: &'static Shader) -> Self {
        Self {
            shader,
            module: None,
            made: HashMap::new(),
        }
    }

    /// The pipeline of a key, made of the module at its first use. wgpu counts references: a copy costs nothing.
    pub(crate) fn get(
        &mut self,
        device: &Device,
        key: K,
        make: impl FnOnce(&wgpu::ShaderModule) -> RenderPipeline,
    ) -> RenderPipeline {
        let module = self
            .module
            .get_or_insert_with(|| buffer::module(device, self.shader));
        self.made.entry(key).or_insert_with(|| make(module)).clone()
    }
}
