//! What a point of a surface does with light.

use crate::{AlphaMode, Material, MetalsAs, Scene, TextureSlot};
use glam::{Vec2, Vec4};
use hemicube_raster::Rgb;

/// What a point of a surface does with light; in every band `reflectance + transmittance` is at most 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SurfaceSample {
    /// Diffuse reflectance, already without the share that passes straight through.
    pub reflectance: Rgb,
    /// Emitted radiance L: cd/m² (photometric) or W/(m² sr) (radiometric).
    pub emission: Rgb,
    /// Share of light that passes straight through.
    pub transmittance: Rgb,
    /// Whether a band of the reflectance was lowered to [`Scene::max_reflectance`].
    pub clamped: bool,
}

impl SurfaceSample {
    /// A hole: everything passes.
    const HOLE: Self = Self {
        reflectance: Rgb::BLACK,
        emission: Rgb::BLACK,
        transmittance: Rgb::WHITE,
        clamped: false,
    };
}

impl Scene {
    /// What a point of a surface of this material does with light.
    ///
    /// `texcoords` are the mesh's coordinates at the point, one per set (a missing set reads as 0), `color` its vertex
    /// colour (linear, [`Vec4::ONE`] without). With colour `c = base colour × texture × vertex colour`, lowered to
    /// [`max_reflectance`](Self::max_reflectance), metallic share `m`, transmission `t` and opacity `α` (1 unless
    /// alpha blends):
    ///
    /// - reflectance `α (1 - t) (1 - m) c`, and `+ α m c` if [metals](Self::metals) count as diffuse (for `t = 0` that
    ///   is the base colour in full);
    /// - transmittance `(1 - α) + α t (1 - m) c`: what alpha lets through is not tinted, and metals do not transmit;
    /// - emission `α L`.
    ///
    /// A hole of an alpha mask transmits everything and does nothing else. Panics if there is no such material.
    pub fn surface_at(&self, material: usize, texcoords: &[Vec2], color: Vec4) -> SurfaceSample {
        let material = &self.materials[material];
        let base = self.texel(material.base_color_texture, texcoords, true);
        let coverage = match material.alpha_mode {
            AlphaMode::Opaque => 1.0,
            mode => {
                let alpha = (material.alpha * base[3] * color.w).clamp(0.0, 1.0);
                match mode {
                    AlphaMode::Mask { cutoff } if alpha < cutoff => return SurfaceSample::HOLE,
                    AlphaMode::Blend => alpha,
                    _ => 1.0,
                }
            }
        };
        let tint = Rgb::new(
            material.base_color.r * base[0] * color.x,
            material.base_color.g * base[1] * color.y,
            material.base_color.b * base[2] * color.z,
        )
        .map(|band| band.clamp(0.0, 1.0));
        let lowered = tint.map(|band| band.min(self.max_reflectance));

        let metallic = self.metallic_at(material, texcoords);
        let transmission = self.transmission_at(material, texcoords) * (1.0 - metallic);
        let diffuse = match self.metals {
            MetalsAs::Diffuse => 1.0 - transmission,
            MetalsAs::Black => 1.0 - metallic - transmission,
        };
        let passing = if coverage < 1.0 || transmission > 0.0 {
            Rgb::splat(1.0 - coverage) + tint * (coverage * transmission)
        } else {
            Rgb::BLACK
        };
        SurfaceSample {
            reflectance: lowered * (coverage * diffuse),
            emission: self.emission_at(material, texcoords) * coverage,
            transmittance: passing,
            clamped: diffuse > 0.0 && lowered != tint,
        }
    }

    /// Metallic share, read only where it matters.
    fn metallic_at(&self, material: &Material, texcoords: &[Vec2]) -> f32 {
        let matters = self.metals == MetalsAs::Black || material.transmission > 0.0;
        if !matters || material.metallic <= 0.0 {
            return 0.0;
        }
        let texel = self.texel(material.metallic_texture, texcoords, false);
        (material.metallic * texel[2]).clamp(0.0, 1.0)
    }

    fn transmission_at(&self, material: &Material, texcoords: &[Vec2]) -> f32 {
        if material.transmission <= 0.0 {
            return 0.0;
        }
        let texel = self.texel(material.transmission_texture, texcoords, false);
        (material.transmission * texel[0]).clamp(0.0, 1.0)
    }

    fn emission_at(&self, material: &Material, texcoords: &[Vec2]) -> Rgb {
        if material.emission_texture.is_none() || !material.emits() {
            return material.emission;
        }
        let texel = self.texel(material.emission_texture, texcoords, true);
        material.emission * Rgb::new(texel[0], texel[1], texel[2])
    }

    /// The texture's factors at a point; all 1 without a texture.
    fn texel(&self, slot: Option<TextureSlot>, texcoords: &[Vec2], srgb: bool) -> [f32; 4] {
        let Some(slot) = slot else {
            return [1.0; 4];
        };
        let texture = &self.textures[slot.texture];
        let texcoord = texcoords
            .get(slot.texcoord_set)
            .copied()
            .unwrap_or(Vec2::ZERO);
        self.images[texture.image].sample(slot.coordinates(texcoord), texture.wrap, srgb)
    }
}
