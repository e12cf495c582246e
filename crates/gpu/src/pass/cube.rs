//! Cube maps that are taken and blurred on the device.

use crate::buffer::{binding, filled, module, storage, uniform};
use crate::context::Context;
use crate::hemicube::{compute_pass, count};
use crate::pass::map::{DeviceMap, MAP, map_texture, smooth};
use hemicube_raster::environment::{Lobe, Projection, lobe_samples};
use hemicube_shaders::surface as twins;
use wgpu::{
    BindGroupEntry, BindGroupLayout, BindGroupLayoutEntry, BindingResource, BindingType,
    BufferUsages, CommandEncoder, ComputePipeline, Sampler, SamplerBindingType, ShaderStages,
    Texture, TextureSampleType, TextureUsages, TextureView, TextureViewDescriptor,
    TextureViewDimension,
};

/// Texels of a side of the roughest level.
const LEAST_SIDE: u32 = 8;
/// Samples of each texel of a blurred level.
const BLUR_SAMPLES: u32 = 64;

/// Fills, halves and blurs cubes.
#[derive(Debug)]
pub(crate) struct CubePass {
    face: Step,
    halve: Step,
    blur: Step,
    sampler: Sampler,
}

/// A pipeline and what is bound to it.
#[derive(Debug)]
struct Step {
    layout: BindGroupLayout,
    pipeline: ComputePipeline,
}

/// A cube that is taken on the device: as it was seen, and blurred.
#[derive(Debug)]
pub(crate) struct Cube {
    pub(crate) side: u32,
    seen: Texture,
    blurred: Texture,
}

impl Cube {
    /// Black. A side that is no power of two is rounded down to one.
    pub(crate) fn new(context: &Context, side: usize) -> Self {
        let side: u32 = 1 << count(side).clamp(LEAST_SIDE, 1024).ilog2();
        let usage = TextureUsages::STORAGE_BINDING | TextureUsages::TEXTURE_BINDING;
        let levels = 1 + side.ilog2();
        let blurred = levels - LEAST_SIDE.ilog2();
        Self {
            side,
            seen: map_texture(context, [side; 2], 6, levels, usage),
            blurred: map_texture(context, [side; 2], 6, blurred, usage),
        }
    }

    /// The blurred levels, where a stored 1 is this radiance.
    pub(crate) fn map(&self, context: &Context, scale: f32) -> DeviceMap {
        DeviceMap::of_texture(context, &self.blurred, Projection::Cube, scale)
    }
}

impl CubePass {
    pub(crate) fn new(context: &Context) -> Self {
        let module = module(&context.device, &twins::PREFILTER);
        let read = |view_dimension| BindingType::Texture {
            sample_type: TextureSampleType::Float { filterable: true },
            view_dimension,
            multisampled: false,
        };
        let step = |name, inputs: &[(u32, BindingType)]| step(context, &module, name, inputs);
        let sampler = BindingType::Sampler(SamplerBindingType::Filtering);
        Self {
            face: step("face", &[(2, read(TextureViewDimension::D2))]),
            halve: step("halve", &[(3, read(TextureViewDimension::D2Array))]),
            blur: step(
                "blur",
                &[
                    (4, read(TextureViewDimension::Cube)),
                    (5, sampler),
                    (6, storage(true)),
                ],
            ),
            sampler: smooth(context),
        }
    }

    /// Takes a picture of twice the cube's side as one of its faces.
    pub(crate) fn take_face(
        &self,
        context: &Context,
        encoder: &mut CommandEncoder,
        cube: &Cube,
        face: u32,
        picture: &TextureView,
    ) {
        let params = twins::CubeParams {
            side: cube.side,
            face,
            samples: 0,
            source_side: cube.side,
        };
        let written = level_view(&cube.seen, 0);
        let inputs = [(2, BindingResource::TextureView(picture))];
        self.face
            .run(context, encoder, params, &written, &inputs, 1);
    }

    /// Makes the levels of a cube whose faces were taken.
    pub(crate) fn blur(&self, context: &Context, encoder: &mut CommandEncoder, cube: &Cube) {
        for level in 1..cube.seen.mip_level_count() {
            let params = params(cube, level, 0);
            let (written, finer) = (
                level_view(&cube.seen, level),
                level_view(&cube.seen, level - 1),
            );
            let inputs = [(3, BindingResource::TextureView(&finer))];
            self.halve
                .run(context, encoder, params, &written, &inputs, 6);
        }
        let source = cube.seen.create_view(&TextureViewDescriptor {
            dimension: Some(TextureViewDimension::Cube),
            ..Default::default()
        });
        let levels = cube.blurred.mip_level_count();
        for level in 0..levels {
            #[expect(clippy::cast_precision_loss, reason = "a few levels")]
            let roughness = level as f32 / (levels - 1).max(1) as f32;
            let samples = lobe(roughness);
            let lobe = filled(&context.device, "lobe", &samples, BufferUsages::STORAGE);
            let used = if roughness > 0.0 {
                count(samples.len())
            } else {
                0
            };
            let params = params(cube, level, used);
            let inputs = [
                (4, BindingResource::TextureView(&source)),
                (5, BindingResource::Sampler(&self.sampler)),
                (6, lobe.as_entire_binding()),
            ];
            let written = level_view(&cube.blurred, level);
            self.blur
                .run(context, encoder, params, &written, &inputs, 6);
        }
    }
}

impl Step {
    /// Writes so many faces of a level.
    fn run(
        &self,
        context: &Context,
        encoder: &mut CommandEncoder,
        params: twins::CubeParams,
        written: &TextureView,
        inputs: &[(u32, BindingResource<'_>)],
        faces: u32,
    ) {
        let device = &context.device;
        let groups = params.side.div_ceil(8);
        let params = filled(device, "cube", &[params], BufferUsages::UNIFORM);
        let always = [
            (0, params.as_entire_binding()),
            (1, BindingResource::TextureView(written)),
        ];
        let all = always.iter().chain(inputs);
        let entries: Vec<BindGroupEntry<'_>> = all
            .map(|(binding, resource)| BindGroupEntry {
                binding: *binding,
                resource: resource.clone(),
            })
            .collect();
        let bindings = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("cube"),
            layout: &self.layout,
            entries: &entries,
        });
        let mut pass = compute_pass(encoder, "cube");
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &bindings, &[]);
        pass.dispatch_workgroups(groups, groups, faces);
    }
}

fn step(
    context: &Context,
    module: &wgpu::ShaderModule,
    name: &str,
    inputs: &[(u32, BindingType)],
) -> Step {
    let stages = ShaderStages::COMPUTE;
    let written = BindingType::StorageTexture {
        access: wgpu::StorageTextureAccess::WriteOnly,
        format: MAP,
        view_dimension: TextureViewDimension::D2Array,
    };
    let always = [(0, uniform(false)), (1, written)];
    let entries: Vec<BindGroupLayoutEntry> = always
        .iter()
        .chain(inputs)
        .map(|&(at, ty)| binding(at, stages, ty))
        .collect();
    let device = &context.device;
    let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: Some(name),
        entries: &entries,
    });
    let pipeline = crate::buffer::compute(device, module, name, &[&layout]);
    Step { layout, pipeline }
}

fn params(cube: &Cube, level: u32, samples: u32) -> twins::CubeParams {
    twins::CubeParams {
        side: cube.side >> level,
        face: 0,
        samples,
        source_side: cube.side,
    }
}

/// All faces of a level.
fn level_view(texture: &Texture, level: u32) -> TextureView {
    texture.create_view(&TextureViewDescriptor {
        dimension: Some(TextureViewDimension::D2Array),
        base_mip_level: level,
        mip_level_count: Some(1),
        ..Default::default()
    })
}

/// Samples of a lobe; one that is not used for a mirror.
fn lobe(roughness: f32) -> Vec<twins::LobeSample> {
    let samples = lobe_samples(Lobe::Ggx, roughness, BLUR_SAMPLES);
    let twin = |sample: &hemicube_raster::environment::LobeSample| twins::LobeSample {
        direction: sample.direction.to_array(),
        solid_angle: sample.solid_angle,
        weight: sample.weight,
        ..bytemuck::Zeroable::zeroed()
    };
    if samples.is_empty() {
        return vec![bytemuck::Zeroable::zeroed()];
    }
    samples.iter().map(twin).collect()
}
