//! Lit surfaces with textures.

use crate::buffer::{bind, layout};
use crate::context::Context;
use crate::error::GpuError;
use crate::pass::lit::SurfacePass;
use crate::pass::textures::Textures;
use hemicube_raster::texture::{Magnify, Minify};
use hemicube_scene::Scene;
use hemicube_shaders::surface as twins;
use std::collections::HashMap;
use wgpu::{
    BindGroup, BindGroupLayout, BindingResource, BindingType, SamplerBindingType, ShaderStages,
    TextureSampleType, TextureViewDimension,
};

/// How textures are read; twins of [`hemicube_raster::texture::Sampler`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TextureFiltering {
    /// What is read from afar: [`Minify::Ewa`] by the shader, everything else by the adapter's sampler, which has its own way
    /// of [`Minify::Anisotropic`]. Default value: trilinear.
    pub minify: Minify,
    /// What is read close up; textures that ask for single texels show those. Default value: bilinear.
    pub magnify: Magnify,
}

impl Default for TextureFiltering {
    fn default() -> Self {
        Self {
            minify: Minify::Trilinear,
            magnify: Magnify::Bilinear,
        }
    }
}

impl TextureFiltering {
    /// Another way of reading from afar.
    pub fn with_minify(self, minify: Minify) -> Self {
        Self { minify, ..self }
    }

    /// Another way of reading close up.
    pub fn with_magnify(self, magnify: Magnify) -> Self {
        Self { magnify, ..self }
    }

    /// Tells a view about itself.
    pub(crate) fn tell(view: &mut twins::View) {
        let defaults = hemicube_raster::texture::Sampler::default();
        view.max_anisotropy = defaults.max_anisotropy;
        view.ewa_radius = defaults.ewa_radius;
    }
}

/// Surfaces with textures.
#[derive(Debug)]
pub(crate) struct TexturedPass {
    pub(crate) pipelines: SurfacePass,
    pub(crate) layout: BindGroupLayout,
}

impl TexturedPass {
    pub(crate) fn new(context: &Context, scene: &BindGroupLayout) -> Self {
        let layout = texture_layout(context);
        Self {
            pipelines: SurfacePass::new("textured surfaces", &twins::TEXTURED, &[scene, &layout]),
            layout,
        }
    }
}

/// Six textures and their samplers.
fn texture_layout(context: &Context) -> BindGroupLayout {
    let picture = BindingType::Texture {
        sample_type: TextureSampleType::Float { filterable: true },
        view_dimension: TextureViewDimension::D2,
        multisampled: false,
    };
    let sampler = BindingType::Sampler(SamplerBindingType::Filtering);
    let types = [[picture; 6], [sampler; 6]];
    layout(
        &context.device,
        "textures",
        ShaderStages::FRAGMENT,
        types.as_flattened(),
    )
}

/// The textures of a scene's materials, bound as they are asked for.
#[derive(Debug)]
pub(crate) struct MaterialTextures {
    textures: Textures,
    bound: HashMap<(usize, Minify, bool), BindGroup>,
}

impl MaterialTextures {
    /// All textures of a scene, on the device.
    ///
    /// # Errors
    /// A picture that is larger than the adapter allows.
    pub(crate) fn new(context: &Context, scene: &Scene) -> Result<Self, GpuError> {
        let mut textures = Textures::new(context);
        for material in &scene.materials {
            textures.load(context, scene, material)?;
        }
        Ok(Self {
            textures,
            bound: HashMap::new(),
        })
    }

    /// The textures of a material under a filter.
    pub(crate) fn of(
        &mut self,
        context: &Context,
        layout: &BindGroupLayout,
        scene: &Scene,
        material: usize,
        filtering: TextureFiltering,
    ) -> BindGroup {
        let is_point = filtering.magnify == Magnify::Point;
        let key = (material, filtering.minify, is_point);
        let textures = &mut self.textures;
        let make = || {
            let of = &scene.materials[material];
            let pictures = textures.pictures(scene, of);
            let samplers = textures.samplers(context, scene, of, filtering.minify, is_point);
            let pictures = pictures.iter().map(BindingResource::TextureView);
            let samplers = samplers.iter().map(BindingResource::Sampler);
            let all: Vec<BindingResource<'_>> = pictures.chain(samplers).collect();
            bind(&context.device, "textures", layout, &all)
        };
        self.bound.entry(key).or_insert_with(make).clone()
    }
}
