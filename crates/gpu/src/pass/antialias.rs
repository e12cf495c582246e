//! Fine grids of samples, and how they become pixels: twin of `raster/src/antialias`.

use crate::buffer::{bind, filled, layout, storage, uniform};
use crate::context::Context;
use crate::error::GpuError;
use crate::hemicube::count;
use crate::pass::lit::Pixels;
use crate::pass::pipeline::{Pipelines, for_every_pixel};
use crate::pass::target::texture;
use crate::pass::tonemap::{Tones, draw_screen, params};
use crate::pass::view::Window;
use glam::DVec2;
use hemicube_raster::antialias::{Antialiasing, Pattern, Supersampler};
use hemicube_shaders::surface as twins;
use wgpu::{
    BindGroupLayout, BindingType, BufferUsages, CommandEncoder, RenderPipeline, ShaderStages,
    TextureFormat, TextureSampleType, TextureUsages, TextureView, TextureViewDescriptor,
    TextureViewDimension,
};

/// Format of pictures that are filtered in one direction only.
const HALF_DONE: TextureFormat = TextureFormat::Rgba32Float;

/// A grid of samples for a picture of so many pixels.
#[derive(Debug)]
pub(crate) struct Grid {
    sampler: Supersampler,
    /// Pixels.
    size: [u32; 2],
}

impl Grid {
    /// # Errors
    /// Samples that are jittered: triangles are drawn on rows and columns.
    pub(crate) fn new(size: [u32; 2], antialiasing: Antialiasing) -> Result<Self, GpuError> {
        if antialiasing.pattern != Pattern::Regular {
            return Err(GpuError::Option(format!(
                "antialias {antialiasing}: the GPU samples on a regular grid; leave the jitter out, or use the CPU"
            )));
        }
        let [width, height] = size.map(|side| side as usize);
        let sampler = Supersampler::new(width, height, antialiasing);
        Ok(Self { sampler, size })
    }

    /// Samples in a row, and rows.
    pub(crate) fn samples(&self) -> [u32; 2] {
        let rows = self.sampler.rows(0..self.size[1] as usize).end;
        [count(self.sampler.columns()), count(rows)]
    }

    /// Weights of a pixel in each direction.
    pub(crate) fn taps(&self) -> u32 {
        count(self.sampler.weights().len())
    }

    /// Samples of a pixel in each direction.
    pub(crate) fn factor(&self) -> u32 {
        count(self.sampler.factor())
    }

    /// What of the picture's plane the grid sees: a little more than the picture, so that its outermost samples have their
    /// place.
    pub(crate) fn window(&self) -> Window {
        let vector = |[x, y]: [u32; 2]| DVec2::new(x.into(), y.into());
        let (samples, pixels) = (vector(self.samples()), vector(self.size));
        let k = f64::from(self.factor());
        let offset = (pixels * k - 2.0 * self.sampler.origin() * k + 1.0) / samples - 1.0;
        Window {
            scale: pixels * k / samples,
            offset: DVec2::new(offset.x, -offset.y),
        }
    }
}

/// Weighs the samples of grids.
#[derive(Debug)]
pub(crate) struct FilterPass {
    pipelines: Pipelines<(&'static str, TextureFormat)>,
    layout: BindGroupLayout,
}

impl FilterPass {
    pub(crate) fn new(context: &Context) -> Self {
        let source = BindingType::Texture {
            sample_type: TextureSampleType::Float { filterable: false },
            view_dimension: TextureViewDimension::D2,
            multisampled: false,
        };
        let types = [uniform(false), source, uniform(false), storage(true)];
        Self {
            pipelines: Pipelines::new(&twins::ANTIALIAS),
            layout: layout(&context.device, "filter", ShaderStages::FRAGMENT, &types),
        }
    }

    /// Draws `source`, all samples of a grid, over all of `target`.
    pub(crate) fn draw(
        &mut self,
        context: &Context,
        encoder: &mut CommandEncoder,
        (source, grid): (&TextureView, &Grid),
        (target, format): (&TextureView, TextureFormat),
        tones: Tones,
    ) {
        let pixels = Pixels {
            format: HALF_DONE,
            samples: 1,
        };
        let usage = TextureUsages::RENDER_ATTACHMENT | TextureUsages::TEXTURE_BINDING;
        let size = [grid.size[0], grid.samples()[1]];
        let half_done = texture(context, "rows filtered", size, pixels, usage);
        let half_done = half_done.create_view(&TextureViewDescriptor::default());
        for (entry, source, target, format) in [
            ("along_rows", source, &half_done, HALF_DONE),
            ("down_columns", &half_done, target, format),
        ] {
            let bindings = self.bindings(context, source, grid, params(format, tones, 1));
            let pipeline = self.pipeline(context, entry, format);
            draw_screen(encoder, target, &pipeline, &bindings);
        }
    }

    fn bindings(
        &self,
        context: &Context,
        source: &TextureView,
        grid: &Grid,
        tones: twins::ToneParams,
    ) -> wgpu::BindGroup {
        let device = &context.device;
        let weights = grid.sampler.weights();
        let filter = twins::FilterParams {
            factor: grid.factor(),
            taps: count(weights.len()),
            padding_0: 0,
            padding_1: 0,
        };
        let tones = filled(device, "tones", &[tones], BufferUsages::UNIFORM);
        let filter = filled(device, "filter", &[filter], BufferUsages::UNIFORM);
        let weights = filled(device, "weights", weights, BufferUsages::STORAGE);
        let resources = [
            tones.as_entire_binding(),
            wgpu::BindingResource::TextureView(source),
            filter.as_entire_binding(),
            weights.as_entire_binding(),
        ];
        bind(device, "filter", &self.layout, &resources)
    }

    fn pipeline(
        &mut self,
        context: &Context,
        fragment: &'static str,
        format: TextureFormat,
    ) -> RenderPipeline {
        let (device, layout) = (&context.device, &self.layout);
        self.pipelines.get(device, (fragment, format), |module| {
            for_every_pixel(device, module, fragment, layout, format)
        })
    }
}
