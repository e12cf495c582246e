//! The textures of a scene on the device: the mip chains of the CPU, byte by byte, and samplers for them.

use crate::context::Context;
use crate::error::GpuError;
use crate::hemicube::count;
use crate::pass::material::{is_premultiplied, slots};
use hemicube_raster::texture as cpu;
use hemicube_raster::texture::Minify;
use hemicube_scene::{Magnify, Material, Scene, Texture, TextureSlot, TextureUse, Wrap};
use std::collections::HashMap;
use std::collections::hash_map::Entry;
use wgpu::{
    AddressMode, FilterMode, MipmapFilterMode, Sampler, TextureFormat, TextureUsages, TextureView,
    TextureViewDescriptor,
};

/// A picture as materials use it: image, rules for its borders, what its numbers mean.
type PictureKey = (usize, [u8; 2], TextureUse);
/// What tells samplers apart: rules along u and v, whether single texels are shown, the filter from afar.
type SamplerKey = ([u8; 2], bool, Minify);

/// Textures and samplers, each made once.
#[derive(Debug)]
pub(crate) struct Textures {
    pictures: HashMap<PictureKey, TextureView>,
    samplers: HashMap<SamplerKey, Sampler>,
    /// Stands where a material has no texture: 1.
    white: TextureView,
}

impl Textures {
    /// None yet.
    pub(crate) fn new(context: &Context) -> Self {
        let white = texture(context, TextureFormat::Rgba8Unorm, &[([1, 1], &[[255; 4]])]);
        Self {
            pictures: HashMap::new(),
            samplers: HashMap::new(),
            white,
        }
    }

    /// Puts the textures of a material on the device, those that are not there yet.
    ///
    /// # Errors
    /// A picture that is larger than the adapter allows.
    pub(crate) fn load(
        &mut self,
        context: &Context,
        scene: &Scene,
        material: &Material,
    ) -> Result<(), GpuError> {
        for (number, slot) in slots(material).into_iter().enumerate() {
            let Some(slot) = slot else { continue };
            let key = key(scene, material, number, slot);
            if let Entry::Vacant(vacant) = self.pictures.entry(key) {
                let texture = &scene.textures[slot.texture];
                let chain = scene.images[texture.image].chain(texture.wrap, key.2);
                vacant.insert(upload(context, chain, key.2)?);
            }
        }
        Ok(())
    }

    /// The six pictures of a material whose textures were loaded.
    pub(crate) fn pictures(&self, scene: &Scene, material: &Material) -> [TextureView; 6] {
        let slots = slots(material);
        core::array::from_fn(|number| {
            let picture = slots[number]
                .and_then(|slot| self.pictures.get(&key(scene, material, number, slot)));
            picture.unwrap_or(&self.white).clone()
        })
    }

    /// The six samplers of a material for a filter from afar; close up they show single texels if `is_point`.
    pub(crate) fn samplers(
        &mut self,
        context: &Context,
        scene: &Scene,
        material: &Material,
        minify: Minify,
        is_point: bool,
    ) -> [Sampler; 6] {
        slots(material).map(|slot| {
            let texture = slot.map_or(Texture::new(0, [Wrap::Repeat; 2]), |slot| {
                scene.textures[slot.texture]
            });
            self.sampler(context, texture, minify, is_point)
        })
    }

    fn sampler(
        &mut self,
        context: &Context,
        texture: Texture,
        minify: Minify,
        is_point: bool,
    ) -> Sampler {
        let is_nearest = is_point || texture.magnify == Magnify::Nearest || minify == Minify::Point;
        let key = (texture.wrap.map(|wrap| wrap as u8), is_nearest, minify);
        let make = || sampler(context, texture.wrap, is_nearest, minify);
        self.samplers.entry(key).or_insert_with(make).clone()
    }
}

fn key(scene: &Scene, material: &Material, number: usize, slot: TextureSlot) -> PictureKey {
    let texture = &scene.textures[slot.texture];
    let is_color = [0, 3].contains(&number);
    let usage = match (is_color, is_premultiplied(material, slot) && number == 0) {
        (false, _) => TextureUse::Data,
        (true, true) => TextureUse::ColorAndAlpha,
        (true, false) => TextureUse::Color,
    };
    (texture.image, texture.wrap.map(|wrap| wrap as u8), usage)
}

fn sampler(context: &Context, wrap: [Wrap; 2], is_nearest: bool, minify: Minify) -> Sampler {
    let rule = |wrap: Wrap| match wrap {
        Wrap::Repeat => AddressMode::Repeat,
        Wrap::MirroredRepeat => AddressMode::MirrorRepeat,
        Wrap::ClampToEdge => AddressMode::ClampToEdge,
    };
    let (min_filter, mipmap_filter, levels) = match minify {
        Minify::Point => (FilterMode::Nearest, MipmapFilterMode::Nearest, 0.0),
        Minify::Bilinear => (FilterMode::Linear, MipmapFilterMode::Nearest, 0.0),
        Minify::NearestMipmap => (FilterMode::Linear, MipmapFilterMode::Nearest, 32.0),
        _ => (FilterMode::Linear, MipmapFilterMode::Linear, 32.0),
    };
    // Only filters that are linear throughout may be anisotropic.
    let is_anisotropic = minify == Minify::Anisotropic && !is_nearest;
    context.device.create_sampler(&wgpu::SamplerDescriptor {
        label: Some("texture"),
        address_mode_u: rule(wrap[0]),
        address_mode_v: rule(wrap[1]),
        mag_filter: if is_nearest {
            FilterMode::Nearest
        } else {
            FilterMode::Linear
        },
        min_filter,
        mipmap_filter,
        lod_max_clamp: levels,
        anisotropy_clamp: if is_anisotropic { 16 } else { 1 },
        ..Default::default()
    })
}

/// A mip chain in bytes as it is.
fn upload(
    context: &Context,
    chain: &cpu::Texture,
    usage: TextureUse,
) -> Result<TextureView, GpuError> {
    let (width, height) = chain.size();
    let longest = width.max(height) as u64;
    let allowed = u64::from(context.limits.max_texture_dimension_2d);
    context.allow("texels of a texture's side", longest, allowed, "texels")?;
    let format = match usage {
        TextureUse::Data => TextureFormat::Rgba8Unorm,
        TextureUse::Color | TextureUse::ColorAndAlpha => TextureFormat::Rgba8UnormSrgb,
    };
    let level = |level: usize| {
        let (width, height) = chain.level_size(level);
        let texels = chain
            .level_bytes(level)
            .expect("decoded pictures are bytes");
        ([count(width), count(height)], texels)
    };
    let levels: Vec<([u32; 2], &[[u8; 4]])> = (0..chain.levels()).map(level).collect();
    Ok(texture(context, format, &levels))
}

/// A texture of levels of bytes, the largest first.
fn texture(
    context: &Context,
    format: TextureFormat,
    levels: &[([u32; 2], &[[u8; 4]])],
) -> TextureView {
    let extent = |[width, height]: [u32; 2]| wgpu::Extent3d {
        width,
        height,
        depth_or_array_layers: 1,
    };
    let texture = context.device.create_texture(&wgpu::TextureDescriptor {
        label: Some("texture"),
        size: extent(levels[0].0),
        mip_level_count: count(levels.len()),
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: TextureUsages::TEXTURE_BINDING | TextureUsages::COPY_DST,
        view_formats: &[],
    });
    for (level, (size, texels)) in (0..).zip(levels) {
        let place = wgpu::TexelCopyTextureInfo {
            texture: &texture,
            mip_level: level,
            origin: wgpu::Origin3d::ZERO,
            aspect: wgpu::TextureAspect::All,
        };
        let layout = wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(4 * size[0]),
            rows_per_image: None,
        };
        let bytes = texels.as_flattened();
        context
            .queue
            .write_texture(place, bytes, layout, extent(*size));
    }
    texture.create_view(&TextureViewDescriptor::default())
}
