//! Exposed light into what a display shows: twin of `raster/src/tonemap.rs`.

use crate::buffer::{bind, binding, filled, uniform};
use crate::context::Context;
use crate::pass::pipeline::{Pipelines, for_every_pixel};
use hemicube_raster::tonemap::ToneMap;
use hemicube_shaders::surface as twins;
use wgpu::{
    BindGroupLayout, BindingType, BufferUsages, CommandEncoder, RenderPipeline, ShaderStages,
    TextureFormat, TextureSampleType, TextureView, TextureViewDimension,
};

/// What becomes of exposed light.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) enum Tones {
    /// It goes through a curve and is stored as sRGB.
    Display(ToneMap),
    /// It is a display's colour already and is stored as sRGB.
    Color,
    /// It is stored as it is.
    Linear,
}

impl Tones {
    fn curve(self) -> u32 {
        match self {
            Self::Display(ToneMap::Reinhard) => twins::CURVE_REINHARD,
            Self::Display(ToneMap::Aces) => twins::CURVE_ACES,
            Self::Display(ToneMap::None) | Self::Color => twins::CURVE_NONE,
            Self::Linear => twins::CURVE_LINEAR,
        }
    }
}

/// Draws a picture of light into a target that is shown.
#[derive(Debug)]
pub(crate) struct TonePass {
    pipelines: Pipelines<(TextureFormat, bool)>,
    /// Layouts for pictures of one sample a pixel, and of several.
    layouts: [BindGroupLayout; 2],
}

impl TonePass {
    pub(crate) fn new(context: &Context) -> Self {
        Self {
            pipelines: Pipelines::new(&twins::TONEMAP),
            layouts: [false, true].map(|multisampled| layout(context, multisampled)),
        }
    }

    /// Draws `source`, which has so many samples a pixel, over all of `target`.
    pub(crate) fn draw(
        &mut self,
        context: &Context,
        encoder: &mut CommandEncoder,
        (source, samples): (&TextureView, u32),
        (target, format): (&TextureView, TextureFormat),
        tones: Tones,
    ) {
        let device = &context.device;
        let params = filled(
            device,
            "tones",
            &[params(format, tones, samples)],
            BufferUsages::UNIFORM,
        );
        let is_multisampled = samples > 1;
        let resources = [
            params.as_entire_binding(),
            wgpu::BindingResource::TextureView(source),
        ];
        let layout = self.layouts[usize::from(is_multisampled)].clone();
        let bindings = if is_multisampled {
            bind_samples(device, &layout, &resources)
        } else {
            bind(device, "tones", &layout, &resources)
        };
        let pipeline = self.pipeline(context, format, is_multisampled);
        draw_screen(encoder, target, &pipeline, &bindings);
    }

    fn pipeline(
        &mut self,
        context: &Context,
        format: TextureFormat,
        is_multisampled: bool,
    ) -> RenderPipeline {
        let device = &context.device;
        let layout = &self.layouts[usize::from(is_multisampled)];
        let key = (format, is_multisampled);
        self.pipelines.get(device, key, |module| {
            let fragment = if is_multisampled {
                "tone_mapped_samples"
            } else {
                "tone_mapped"
            };
            for_every_pixel(device, module, fragment, layout, format)
        })
    }
}

/// What shaders need to know of tones.
pub(crate) fn params(format: TextureFormat, tones: Tones, samples: u32) -> twins::ToneParams {
    twins::ToneParams {
        curve: tones.curve(),
        encodes: u32::from(encodes(format, tones)),
        samples,
        padding: 0,
    }
}

/// Draws all of a target with a pipeline whose vertex stage is `screen`.
pub(crate) fn draw_screen(
    encoder: &mut CommandEncoder,
    target: &TextureView,
    pipeline: &RenderPipeline,
    bindings: &wgpu::BindGroup,
) {
    let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some("screen"),
        color_attachments: &[Some(wgpu::RenderPassColorAttachment {
            view: target,
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations {
                load: wgpu::LoadOp::Clear(wgpu::Color::BLACK),
                store: wgpu::StoreOp::Store,
            },
        })],
        ..Default::default()
    });
    pass.set_pipeline(pipeline);
    pass.set_bind_group(0, bindings, &[]);
    pass.draw(0..3, 0..1);
}

/// Whether numbers have to be encoded before they are stored: not where the format does it, nor where it keeps floats.
fn encodes(format: TextureFormat, tones: Tones) -> bool {
    let keeps_floats = matches!(
        format,
        TextureFormat::Rgba16Float | TextureFormat::Rgba32Float | TextureFormat::Rg11b10Ufloat
    );
    tones != Tones::Linear && !format.is_srgb() && !keeps_floats
}

fn layout(context: &Context, multisampled: bool) -> BindGroupLayout {
    let source = BindingType::Texture {
        sample_type: TextureSampleType::Float { filterable: false },
        view_dimension: TextureViewDimension::D2,
        multisampled,
    };
    let stages = ShaderStages::FRAGMENT;
    let at = if multisampled { 2 } else { 1 };
    let entries = [
        binding(0, stages, uniform(false)),
        binding(at, stages, source),
    ];
    context
        .device
        .create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("tones"),
            entries: &entries,
        })
}

/// As [`bind`], with the picture in the place for those of several samples.
fn bind_samples(
    device: &wgpu::Device,
    layout: &BindGroupLayout,
    [params, source]: &[wgpu::BindingResource<'_>; 2],
) -> wgpu::BindGroup {
    let entries = [(0, params), (2, source)].map(|(binding, resource)| wgpu::BindGroupEntry {
        binding,
        resource: resource.clone(),
    });
    device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some("tones"),
        layout,
        entries: &entries,
    })
}
