//! Materials as shaders read them.

use glam::Affine2;
use hemicube_raster::Rgb;
use hemicube_scene::{AlphaMode, Magnify, Material, ReliefKind, Scene, TextureSlot, Wrap};
use hemicube_shaders::surface as twins;

/// The material's textures in the order of the shader's slots.
pub(crate) fn slots(material: &Material) -> [Option<TextureSlot>; 6] {
    [
        material.base_color_texture,
        material.metallic_texture,
        material.roughness_texture,
        material.emission_texture,
        material.transmission_texture,
        material.relief.map(|relief| relief.slot),
    ]
}

/// All materials of a scene; one that is never used if there are none.
pub(crate) fn materials(scene: &Scene) -> Vec<twins::Material> {
    let fallback = Material::default();
    let none = scene.materials.is_empty().then_some(&fallback);
    scene
        .materials
        .iter()
        .chain(none)
        .map(|material| twin(scene, material))
        .collect()
}

fn twin(scene: &Scene, material: &Material) -> twins::Material {
    let cutoff = match material.alpha_mode {
        AlphaMode::Mask { cutoff } => cutoff,
        AlphaMode::Opaque | AlphaMode::Blend => 0.0,
    };
    let relief = match material.relief.map(|relief| relief.kind) {
        None => 0.0,
        Some(ReliefKind::Normal { scale }) => scale,
        Some(ReliefKind::Height { depth }) => depth,
    };
    let [r, g, b] = material.base_color.to_array();
    let emission = if material.emits() {
        material.emission
    } else {
        Rgb::BLACK
    };
    twins::Material {
        base_color: [r, g, b],
        alpha: material.alpha,
        emission: emission.to_array(),
        metallic: material.metallic,
        roughness: material.roughness,
        transmission: material.transmission,
        cutoff,
        relief,
        padding: [0; 4],
        slots: slots(material).map(|slot| slot_twin(scene, material, slot)),
    }
}

fn slot_twin(scene: &Scene, material: &Material, slot: Option<TextureSlot>) -> twins::Slot {
    let Some(slot) = slot else {
        return bytemuck::Zeroable::zeroed();
    };
    let texture = scene.textures[slot.texture];
    let Affine2 {
        matrix2,
        translation,
    } = slot.transform;
    let set = match slot.texcoord_set {
        0 => 0,
        1 => twins::SLOT_SECOND,
        _ => twins::SLOT_NOWHERE,
    };
    let rule = |wrap: Wrap| match wrap {
        Wrap::Repeat => 0,
        Wrap::MirroredRepeat => 1,
        Wrap::ClampToEdge => 2,
    };
    let mut flags = set;
    flags |= rule(texture.wrap[0]) << twins::SLOT_WRAP_U_SHIFT;
    flags |= rule(texture.wrap[1]) << twins::SLOT_WRAP_V_SHIFT;
    if texture.magnify == Magnify::Nearest {
        flags |= twins::SLOT_BLOCKS;
    }
    if is_premultiplied(material, slot) {
        flags |= twins::SLOT_PREMULTIPLIED;
    }
    twins::Slot {
        matrix: matrix2.to_cols_array(),
        offset: translation.to_array(),
        flags,
        size: size(scene, slot),
    }
}

/// Width and height of a slot's picture in 16 bits each; pictures that are larger do not fit an adapter.
fn size(scene: &Scene, slot: TextureSlot) -> u32 {
    let texture = scene.textures[slot.texture];
    let pixels = scene.images[texture.image].pixels();
    let bits = |side: usize| u32::from(u16::try_from(side).unwrap_or(u16::MAX));
    bits(pixels.width()) | bits(pixels.height()) << 16
}

/// Whether a slot's colours count with their alpha: those of a base colour whose alpha means something.
pub(crate) fn is_premultiplied(material: &Material, slot: TextureSlot) -> bool {
    material.alpha_mode != AlphaMode::Opaque && material.base_color_texture == Some(slot)
}
