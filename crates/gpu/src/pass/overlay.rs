//! Edges of elements over a picture.

use crate::buffer::{bind, filled, layout, uniform};
use crate::context::Context;
use crate::pass::geometry::edge_buffers;
use crate::pass::lit::Pixels;
use crate::pass::pipeline::{Blend, Depth, PipelineOptions, Pipelines, render};
use crate::pass::tonemap::Tones;
use hemicube_raster::Rgb;
use hemicube_raster::tonemap::ToneMap;
use hemicube_shaders::surface as twins;
use wgpu::{BindGroup, BindGroupLayout, BufferUsages, RenderPipeline, ShaderStages};

/// Lines along the edges of elements.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeshLines {
    /// As the display shows it, linear. Default value: black.
    pub color: Rgb,
    /// Share of the surface that a line hides. Default value: 0.6.
    pub opacity: f32,
    /// Pixels, at least 0.1 and at most 64. Default value: 1.
    pub width: f32,
}

impl Default for MeshLines {
    fn default() -> Self {
        Self {
            color: Rgb::BLACK,
            opacity: 0.6,
            width: 1.0,
        }
    }
}

impl MeshLines {
    /// Another colour.
    pub fn with_color(self, color: Rgb) -> Self {
        Self { color, ..self }
    }

    /// More or less of the surface to be seen through them.
    pub fn with_opacity(self, opacity: f32) -> Self {
        Self { opacity, ..self }
    }

    /// Wider or narrower.
    pub fn with_width(self, width: f32) -> Self {
        Self { width, ..self }
    }
}

/// Share of its distance by which a line comes nearer than its element.
const LIFT: f32 = 1e-3;

/// Draws edges of elements.
#[derive(Debug)]
pub(crate) struct OverlayPass {
    pipelines: Pipelines<Pixels>,
    scene: BindGroupLayout,
    line: BindGroupLayout,
}

impl OverlayPass {
    pub(crate) fn new(context: &Context, scene: &BindGroupLayout) -> Self {
        let stages = ShaderStages::VERTEX_FRAGMENT;
        Self {
            pipelines: Pipelines::new(&twins::MESH_LINES),
            scene: scene.clone(),
            line: layout(&context.device, "mesh lines", stages, &[uniform(false)]),
        }
    }

    pub(crate) fn pipeline(&mut self, context: &Context, pixels: Pixels) -> RenderPipeline {
        let (device, layouts) = (&context.device, [&self.scene, &self.line]);
        self.pipelines.get(device, pixels, |module| {
            let options = PipelineOptions {
                label: "mesh lines",
                module,
                vertex: "line_vertex",
                fragment: "line_fragment",
                constants: &[],
                layouts: &layouts,
                buffers: &edge_buffers(),
                is_strip: true,
                culls: false,
                depth: Depth::Test,
                blend: Blend::Over,
                format: pixels.format,
                samples: pixels.samples,
            };
            render(device, &options)
        })
    }

    /// Lines of a picture whose tones are mapped afterwards; `scale` is the number of the target's pixels in one that is
    /// seen.
    pub(crate) fn bindings(
        &self,
        context: &Context,
        lines: MeshLines,
        tones: Tones,
        scale: f32,
    ) -> BindGroup {
        let color = match tones {
            Tones::Display(curve) => exposed_for(lines.color, curve),
            Tones::Color | Tones::Linear => lines.color,
        };
        let params = twins::LineParams {
            color: [color.r, color.g, color.b, lines.opacity.clamp(0.0, 1.0)],
            width: lines.width.clamp(0.1, 64.0) * scale,
            lift: LIFT,
            padding_0: 0,
            padding_1: 0,
        };
        let usage = BufferUsages::UNIFORM;
        let buffer = filled(&context.device, "mesh lines", &[params], usage);
        let resources = [buffer.as_entire_binding()];
        bind(&context.device, "mesh lines", &self.line, &resources)
    }
}

/// The exposed light that a tone curve shows as a colour, or nearly so: of the same hue, found by bisection.
fn exposed_for(color: Rgb, tones: ToneMap) -> Rgb {
    let wanted = color.luminance().clamp(0.0, 0.999);
    if color.is_black() {
        return Rgb::BLACK;
    }
    let (mut low, mut high) = (0.0_f32, 64.0_f32);
    for _ in 0..32 {
        let middle = 0.5 * (low + high);
        if tones.apply(color * middle, 1.0).luminance() < wanted {
            low = middle;
        } else {
            high = middle;
        }
    }
    color * high
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_come_out_as_they_were_asked_for() {
        for tones in ToneMap::ALL {
            for color in [
                Rgb::BLACK,
                Rgb::splat(0.2),
                Rgb::new(0.5, 0.2, 0.1),
                Rgb::splat(0.9),
            ] {
                let shown = tones.apply(exposed_for(color, tones), 1.0);
                let off = (shown - color).map(f32::abs).max_band();
                assert!(off < 2e-3, "{tones}: {color:?} comes out as {shown:?}");
            }
        }
    }
}
