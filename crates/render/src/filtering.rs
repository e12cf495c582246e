//! Textures of a scene, read through a filter.

use crate::footprint::Footprint;
use crate::options::TextureFilter;
use crate::sight::SurfaceHit;
use crate::stage::Stage;
use crate::surface::{finest_texel, texcoords};
use glam::{Vec2, Vec4};
use hemicube_raster::texture::{self, Sampler, Shape, straight};
use hemicube_scene::{AlphaMode, Magnify, Texture, TextureSlot, TextureUse};

/// A texture's factors as a sample sees them.
///
/// Opacity under an alpha mask comes from the finest level, as that of the hit did.
pub(crate) fn filtered_texel(
    stage: &Stage<'_>,
    hit: &SurfaceHit,
    footprint: &Footprint,
    slot: TextureSlot,
    srgb: bool,
) -> [f32; 4] {
    let material = &stage.scene().materials[stage.material_of(hit)];
    let is_base = material.base_color_texture == Some(slot);
    let usage = match (srgb, material.alpha_mode) {
        (false, _) => TextureUse::Data,
        (true, AlphaMode::Blend | AlphaMode::Mask { .. }) if is_base => TextureUse::ColorAndAlpha,
        (true, _) => TextureUse::Color,
    };
    let uv = slot.coordinates(slot.texcoord(&texcoords(stage, hit)));
    let steps = footprint.of_texture(stage, hit, slot);
    let texel = sample(stage, slot, usage, uv, steps);
    if usage != TextureUse::ColorAndAlpha {
        return texel.to_array();
    }
    let mut texel = straight(texel).to_array();
    if matches!(material.alpha_mode, AlphaMode::Mask { .. }) {
        texel[3] = finest_texel(stage, hit, slot, srgb)[3];
    }
    texel
}

/// A texture at a place.
pub(crate) fn sample(
    stage: &Stage<'_>,
    slot: TextureSlot,
    usage: TextureUse,
    uv: Vec2,
    [right, down]: [Vec2; 2],
) -> Vec4 {
    let scene = stage.scene();
    let texture = &scene.textures[slot.texture];
    let chain = scene.images[texture.image].chain(texture.wrap, usage);
    sampler(texture, stage.filter).sample_grad(chain, uv, right, down)
}

fn sampler(texture: &Texture, filter: TextureFilter) -> Sampler {
    let magnify = match (texture.magnify, filter) {
        (Magnify::Nearest, _) | (_, TextureFilter::Point) => texture::Magnify::Point,
        _ => texture::Magnify::Bilinear,
    };
    let minify = match filter {
        TextureFilter::Point => texture::Minify::Point,
        TextureFilter::Bilinear => texture::Minify::Bilinear,
        TextureFilter::Trilinear => texture::Minify::Trilinear,
        TextureFilter::Ewa => texture::Minify::Ewa,
    };
    Sampler::default()
        .with_wrap(texture.wrap.map(texture::Wrap::from))
        .with_magnify(magnify)
        .with_minify(minify)
        .with_shape(Shape::Ellipse)
}
