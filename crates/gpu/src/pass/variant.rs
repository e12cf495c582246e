//! What shaders over surfaces are made for: a pipeline contains only what its surfaces have.

use crate::pass::material::slots;
use crate::pass::textured::TextureFiltering;
use hemicube_raster::texture::{Cubic, Magnify, Minify};
use hemicube_scene::{AlphaMode, Material, ReliefKind};
use hemicube_shaders::{Shader, surface as twins};

/// What a pipeline over surfaces is made for: values of the shaders' overrides.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) struct Variant {
    /// `ALPHA_*`.
    alpha: u8,
    /// Whether the material emits.
    emits: bool,
    /// Whether vertices have colours.
    colors: bool,
    /// Whether light is that of the element.
    flat: bool,
    /// Slots that have textures, a bit for each.
    slots: u8,
    /// `RELIEF_*`.
    relief: u8,
    /// Whether EWA is read from afar.
    ewa: bool,
    /// Whether the sampler's own filter is anisotropic.
    anisotropic: bool,
    /// `MAGNIFY_*`.
    magnify: u8,
}

impl Variant {
    /// Surfaces without textures.
    pub(crate) fn untextured(material: &Material, emits: bool, colors: bool, flat: bool) -> Self {
        Self {
            alpha: small(alpha(material)),
            emits,
            colors,
            flat,
            slots: 0,
            relief: 0,
            ewa: false,
            anisotropic: false,
            magnify: 0,
        }
    }

    /// The same with the textures of a material, and with its relief or without.
    pub(crate) fn with_textures(
        self,
        material: &Material,
        filtering: TextureFiltering,
        has_relief: bool,
    ) -> Self {
        let mut present = slots(material).map(|slot| u8::from(slot.is_some()));
        present[twins::SLOT_RELIEF as usize] &= u8::from(has_relief);
        Self {
            slots: (0..6).map(|slot| present[slot] << slot).sum(),
            relief: if has_relief {
                small(relief(material))
            } else {
                0
            },
            ewa: filtering.minify == Minify::Ewa,
            anisotropic: filtering.minify == Minify::Anisotropic,
            magnify: small(magnify(filtering)),
            ..self
        }
    }

    /// Values of the overrides of a shader, as far as it has them.
    pub(crate) fn constants(self, shader: &Shader) -> Vec<(&'static str, f64)> {
        let is = |flag: bool| f64::from(u8::from(flag));
        let all = [
            ("ALPHA", self.alpha.into()),
            ("EMITS", is(self.emits)),
            ("COLORS", is(self.colors)),
            ("FLAT", is(self.flat)),
            ("SLOTS", self.slots.into()),
            ("RELIEF", self.relief.into()),
            ("EWA", is(self.ewa)),
            ("ANISOTROPIC", is(self.anisotropic)),
            ("MAGNIFY", self.magnify.into()),
        ];
        let has = |name: &str| shader.source.contains(&format!("override {name}:"));
        all.into_iter().filter(|(name, _)| has(name)).collect()
    }
}

fn small(number: u32) -> u8 {
    u8::try_from(number).expect("a few")
}

fn alpha(material: &Material) -> u32 {
    match material.alpha_mode {
        AlphaMode::Opaque => twins::ALPHA_OPAQUE,
        AlphaMode::Mask { .. } => twins::ALPHA_MASK,
        AlphaMode::Blend => twins::ALPHA_BLEND,
    }
}

fn relief(material: &Material) -> u32 {
    match material.relief.map(|relief| relief.kind) {
        None => twins::RELIEF_NONE,
        Some(ReliefKind::Normal { .. }) => twins::RELIEF_NORMALS,
        Some(ReliefKind::Height { .. }) => twins::RELIEF_HEIGHTS,
    }
}

fn magnify(filtering: TextureFiltering) -> u32 {
    match filtering.magnify {
        Magnify::Point | Magnify::Bilinear => twins::MAGNIFY_SAMPLER,
        Magnify::Bicubic(Cubic::CatmullRom) => twins::MAGNIFY_CATMULL_ROM,
        Magnify::Bicubic(Cubic::BSpline) => twins::MAGNIFY_B_SPLINE,
        Magnify::Bicubic(Cubic::Mitchell) => twins::MAGNIFY_MITCHELL,
    }
}
