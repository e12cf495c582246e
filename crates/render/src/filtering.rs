//! Textures of a scene, read through a filter.

use crate::footprint::Footprint;
use crate::options::TextureFilter;
use crate::sight::SurfaceHit;
use crate::stage::Stage;
use crate::surface::{finest_texel, texcoords};
use glam::{Vec2, Vec4};
use hemicube_raster::texture::{self, Sampler, Shape, straight};
use hemicube_scene::{AlphaMode, Magnify, Texture, TextureSlot, Wrap};

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
    let uv = slot.coordinates(slot.texcoord(&texcoords(stage, hit)));
    let steps = footprint.of_texture(stage, hit, slot);
    let texel = sample(stage, slot, uv, steps, srgb);
    let mut texel = if srgb { straight(texel) } else { texel }.to_array();
    let material = &stage.scene().materials[stage.material_of(hit)];
    if srgb && matches!(material.alpha_mode, AlphaMode::Mask { .. }) {
        texel[3] = finest_texel(stage, hit, slot, srgb)[3];
    }
    texel
}

/// A texture at a place; colours come premultiplied.
pub(crate) fn sample(
    stage: &Stage<'_>,
    slot: TextureSlot,
    uv: Vec2,
    [right, down]: [Vec2; 2],
    srgb: bool,
) -> Vec4 {
    let scene = stage.scene();
    let texture = &scene.textures[slot.texture];
    let chain = scene.images[texture.image].chain(texture.wrap, srgb);
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
        .with_wrap(texture.wrap.map(raster_wrap))
        .with_magnify(magnify)
        .with_minify(minify)
        .with_shape(Shape::Ellipse)
}

fn raster_wrap(wrap: Wrap) -> texture::Wrap {
    hemicube_scene::texture::raster_wrap(wrap)
}
