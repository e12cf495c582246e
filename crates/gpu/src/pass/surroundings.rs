//! A picture of the surroundings behind everything.

use crate::buffer::{bind, filled, layout, uniform};
use crate::context::Context;
use crate::pass::lit::Pixels;
use crate::pass::map::DeviceMap;
use crate::pass::pipeline::{Blend, Depth, PipelineOptions, Pipelines, render};
use crate::pass::view::Window;
use glam::Vec3;
use hemicube_scene::{Camera, Projection};
use hemicube_shaders::surface as twins;
use wgpu::{
    BindGroup, BindGroupLayout, BindingResource, BufferUsages, RenderPipeline, ShaderStages,
};

/// Draws what is behind everything.
#[derive(Debug)]
pub(crate) struct SurroundingsPass {
    pipelines: Pipelines<Pixels>,
    layout: BindGroupLayout,
}

impl SurroundingsPass {
    pub(crate) fn new(context: &Context) -> Self {
        let [cube, flat, sampler] = DeviceMap::types();
        let types = [uniform(false), cube, flat, sampler];
        let stages = ShaderStages::FRAGMENT;
        Self {
            pipelines: Pipelines::new(&twins::SURROUNDINGS),
            layout: layout(&context.device, "surroundings", stages, &types),
        }
    }

    pub(crate) fn pipeline(&mut self, context: &Context, pixels: Pixels) -> RenderPipeline {
        let (device, layout) = (&context.device, &self.layout);
        self.pipelines.get(device, pixels, |module| {
            let options = PipelineOptions {
                label: "surroundings",
                module,
                vertex: "screen",
                fragment: "surroundings",
                constants: &[],
                layouts: &[layout],
                buffers: &[],
                is_strip: false,
                culls: false,
                depth: Depth::Test,
                blend: Blend::Replace,
                format: pixels.format,
                samples: pixels.samples,
            };
            render(device, &options)
        })
    }

    /// The surroundings as a camera sees them.
    pub(crate) fn bindings(
        &self,
        context: &Context,
        map: &DeviceMap,
        camera: &Camera,
        (aspect, window, view): (f64, Window, &twins::View),
    ) -> BindGroup {
        let [right, up] = half_sides(camera, aspect);
        #[expect(clippy::cast_precision_loss, reason = "a side has at most 16 bits")]
        let map_size = map.size.map(|side| side as f32);
        let params = twins::Surroundings {
            right: right.to_array(),
            projection: map.projection,
            up: up.to_array(),
            scale: map.scale * view.exposure,
            forward: camera.forward.normalize_or(Vec3::NEG_Z).to_array(),
            padding_0: 0,
            size: view.size,
            map_size,
            window_scale: window.scale.as_vec2().to_array(),
            window_offset: window.offset.as_vec2().to_array(),
        };
        let device = &context.device;
        let params = filled(device, "surroundings", &[params], BufferUsages::UNIFORM);
        let resources = [
            params.as_entire_binding(),
            BindingResource::TextureView(&map.cube),
            BindingResource::TextureView(&map.flat),
            BindingResource::Sampler(&map.sampler),
        ];
        bind(device, "surroundings", &self.layout, &resources)
    }
}

/// Half the picture's width and height at distance 1; 0 for parallel projections, which see one direction.
fn half_sides(camera: &Camera, aspect: f64) -> [Vec3; 2] {
    let Projection::Perspective { vertical_fov, .. } = camera.projection else {
        return [Vec3::ZERO; 2];
    };
    let forward = camera.forward.normalize_or(Vec3::NEG_Z);
    let up = camera
        .up
        .reject_from_normalized(forward)
        .normalize_or_zero();
    let half = (0.5 * vertical_fov).tan();
    #[expect(
        clippy::cast_possible_truncation,
        reason = "directions are kept in f32"
    )]
    let aspect = aspect as f32;
    [forward.cross(up) * (half * aspect), up * half]
}
