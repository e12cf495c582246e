//! Lit surfaces without textures, and what all passes over surfaces have in common.

use crate::buffer::{layout, storage, uniform};
use crate::context::Context;
use crate::pass::geometry::surface_buffers;
use crate::pass::pipeline::{Blend, Depth, PipelineOptions, Pipelines, render};
use crate::pass::variant::Variant;
use hemicube_shaders::{Shader, surface as twins};
use wgpu::{BindGroupLayout, RenderPipeline, ShaderStages, TextureFormat};

/// What of a surface is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) enum Stage {
    /// All of one that hides what is behind.
    Opaque,
    /// The same, except in holes.
    Masked,
    /// Of one that lets light through: its transmittance, by which what is behind is multiplied,
    Through,
    /// then its own radiance, which is added.
    Own,
}

/// What a target stores.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) struct Pixels {
    pub(crate) format: TextureFormat,
    pub(crate) samples: u32,
}

/// The first bindings of all passes over surfaces: view, one material of many, light and dims of elements.
pub(crate) fn scene_layout(context: &Context) -> BindGroupLayout {
    layout(
        &context.device,
        "surfaces",
        ShaderStages::VERTEX_FRAGMENT,
        &[uniform(false), uniform(true), storage(true), storage(true)],
    )
}

/// Pipelines of one shader over surfaces, whose entry points are `own`, `masked` and `through`.
#[derive(Debug)]
pub(crate) struct SurfacePass {
    label: &'static str,
    shader: &'static Shader,
    pipelines: Pipelines<(Stage, Pixels, Variant)>,
    layouts: Vec<BindGroupLayout>,
}

impl SurfacePass {
    pub(crate) fn new(
        label: &'static str,
        shader: &'static Shader,
        layouts: &[&BindGroupLayout],
    ) -> Self {
        Self {
            label,
            shader,
            pipelines: Pipelines::new(shader),
            layouts: layouts.iter().copied().cloned().collect(),
        }
    }

    /// Surfaces without textures.
    pub(crate) fn lit(scene: &BindGroupLayout) -> Self {
        Self::new("lit surfaces", &twins::LIT, &[scene])
    }

    /// The pipeline of a stage; depth is written by what hides.
    pub(crate) fn pipeline(
        &mut self,
        context: &Context,
        stage: Stage,
        pixels: Pixels,
        variant: Variant,
    ) -> RenderPipeline {
        let (fragment, depth, blend) = match stage {
            Stage::Opaque => ("own", Depth::TestAndWrite, Blend::Replace),
            Stage::Masked => ("masked", Depth::TestAndWrite, Blend::Replace),
            Stage::Through => ("through", Depth::Test, Blend::Multiply),
            Stage::Own => ("own", Depth::Test, Blend::Add),
        };
        let (label, device) = (self.label, &context.device);
        let layouts: Vec<&BindGroupLayout> = self.layouts.iter().collect();
        let shader = self.shader;
        let key = (stage, pixels, variant);
        self.pipelines.get(device, key, |module| {
            let constants = variant.constants(shader);
            let options = PipelineOptions {
                label,
                module,
                vertex: "vertex",
                fragment,
                constants: &constants,
                layouts: &layouts,
                buffers: &surface_buffers(),
                is_strip: false,
                culls: true,
                depth,
                blend,
                format: pixels.format,
                samples: pixels.samples,
            };
            render(device, &options)
        })
    }
}
