//! Illuminance as colours with lines of equal value, or all surfaces in one colour: twin of `raster/src/colormap`.

use crate::buffer::{bind, filled, layout, storage, uniform};
use crate::context::Context;
use crate::pass::geometry::surface_buffers;
use crate::pass::lit::Pixels;
use crate::pass::pipeline::{Blend, Depth, PipelineOptions, Pipelines, render};
use hemicube_raster::Rgb;
use hemicube_raster::colormap::FieldPaint;
use hemicube_scene::Units;
use hemicube_shaders::surface as twins;
use wgpu::{BindGroup, BindGroupLayout, BufferUsages, RenderPipeline, ShaderStages};

/// Steps of the table on the device: those of the CPU's.
const STEPS: u16 = 256;

/// Draws numbers as colours.
#[derive(Debug)]
pub(crate) struct FalseColourPass {
    pipelines: Pipelines<(&'static str, bool, Pixels)>,
    scene: BindGroupLayout,
    field: BindGroupLayout,
}

/// What is drawn.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Field<'a> {
    /// Illuminance; lines are as many times wider as a pixel has samples.
    Illuminance(&'a FieldPaint, Units, f32),
    /// One colour.
    Plain(Rgb),
}

impl Field<'_> {
    const fn entry(&self) -> &'static str {
        match self {
            Self::Illuminance(..) => "falsecolour",
            Self::Plain(_) => "plain",
        }
    }
}

impl FalseColourPass {
    pub(crate) fn new(context: &Context, scene: &BindGroupLayout) -> Self {
        let types = [uniform(false), storage(true)];
        Self {
            pipelines: Pipelines::new(&twins::FALSECOLOUR),
            scene: scene.clone(),
            field: layout(&context.device, "field", ShaderStages::FRAGMENT, &types),
        }
    }

    /// The pipeline for a field, of elements or between vertices.
    pub(crate) fn pipeline(
        &mut self,
        context: &Context,
        field: Field<'_>,
        is_flat: bool,
        pixels: Pixels,
    ) -> RenderPipeline {
        let (device, layouts) = (&context.device, [&self.scene, &self.field]);
        let fragment = field.entry();
        let key = (fragment, is_flat, pixels);
        self.pipelines.get(device, key, |module| {
            let options = PipelineOptions {
                label: fragment,
                module,
                vertex: "vertex",
                fragment,
                constants: &[("FLAT", f64::from(u8::from(is_flat)))],
                layouts: &layouts,
                buffers: &surface_buffers(),
                is_strip: false,
                culls: true,
                depth: Depth::TestAndWrite,
                blend: Blend::Replace,
                format: pixels.format,
                samples: pixels.samples,
            };
            render(device, &options)
        })
    }

    /// Its bindings.
    pub(crate) fn bindings(&self, context: &Context, field: Field<'_>) -> BindGroup {
        let (params, colors) = match field {
            Field::Illuminance(paint, units, scale) => (params(paint, units, scale), table(paint)),
            Field::Plain(color) => {
                let params = twins::FieldParams {
                    missing: padded(color),
                    ..bytemuck::Zeroable::zeroed()
                };
                (params, vec![padded(color); 2])
            }
        };
        let device = &context.device;
        let params = filled(device, "field", &[params], BufferUsages::UNIFORM);
        let colors = filled(device, "colours", &colors, BufferUsages::STORAGE);
        let resources = [params.as_entire_binding(), colors.as_entire_binding()];
        bind(device, "field", &self.field, &resources)
    }
}

fn padded(color: Rgb) -> [f32; 4] {
    [color.r, color.g, color.b, 1.0]
}

fn params(paint: &FieldPaint, units: Units, scale: f32) -> twins::FieldParams {
    let lines = paint.isolines.unwrap_or_default();
    let weight = |band: Rgb| units.illuminance(band);
    twins::FieldParams {
        line_color: padded(lines.color),
        missing: padded(paint.missing),
        weights: [
            weight(Rgb::new(1.0, 0.0, 0.0)),
            weight(Rgb::new(0.0, 1.0, 0.0)),
            weight(Rgb::new(0.0, 0.0, 1.0)),
            0.0,
        ],
        low: paint.range[0],
        high: paint.range[1],
        spacing: paint.isolines.map_or(0.0, |lines| lines.spacing),
        start: lines.start,
        width: lines.width * scale,
        ..bytemuck::Zeroable::zeroed()
    }
}

fn table(paint: &FieldPaint) -> Vec<[f32; 4]> {
    let color = |step: u16| padded(paint.colormap.color(f32::from(step) / f32::from(STEPS)));
    (0..=STEPS).map(color).collect()
}
