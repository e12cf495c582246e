//! Which element a pixel shows.

use crate::context::Context;
use crate::pass::geometry::surface_buffers;
use crate::pass::pipeline::{Blend, Depth, PipelineOptions, Pipelines, render};
use hemicube_shaders::surface as twins;
use wgpu::{BindGroupLayout, RenderPipeline, TextureFormat};

/// Format of pictures of elements.
pub(crate) const ELEMENTS: TextureFormat = TextureFormat::R32Uint;

/// Draws numbers of elements.
#[derive(Debug)]
pub(crate) struct PickPass {
    pipelines: Pipelines<()>,
    scene: BindGroupLayout,
}

impl PickPass {
    pub(crate) fn new(scene: &BindGroupLayout) -> Self {
        Self {
            pipelines: Pipelines::new(&twins::PICK),
            scene: scene.clone(),
        }
    }

    pub(crate) fn pipeline(&mut self, context: &Context) -> RenderPipeline {
        let (device, scene) = (&context.device, &self.scene);
        self.pipelines.get(device, (), |module| {
            let options = PipelineOptions {
                label: "pick",
                module,
                vertex: "vertex",
                fragment: "pick",
                constants: &[],
                layouts: &[scene],
                buffers: &surface_buffers(),
                is_strip: false,
                culls: true,
                depth: Depth::TestAndWrite,
                blend: Blend::Replace,
                format: ELEMENTS,
                samples: 1,
            };
            render(device, &options)
        })
    }
}
