//! What a point of a surface does with light.

use crate::{AlphaMode, MetalsAs, Scene, TextureSlot};
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
    /// Share of the point that is covered at all (1 unless alpha blends); the rest of the light passes untouched.
    pub coverage: f32,
    /// Whether a band of the reflectance was lowered to [`Scene::max_reflectance`].
    pub clamped: bool,
}

impl SurfaceSample {
    /// A hole: everything passes.
    const HOLE: Self = Self {
        reflectance: Rgb::BLACK,
        emission: Rgb::BLACK,
        transmittance: Rgb::WHITE,
        coverage: 0.0,
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
        self.surface_with(material, color, |slot, srgb| {
            let texture = &self.textures[slot.texture];
            let at = slot.coordinates(slot.texcoord(texcoords));
            self.images[texture.image].sample(at, texture.wrap, srgb)
        })
    }

    /// [`surface_at`](Self::surface_at) with the caller's way of reading textures: `texel` gives a slot's factors at the
    /// point, decoded from sRGB where it is told so.
    pub fn surface_with(
        &self,
        material: usize,
        color: Vec4,
        texel: impl Fn(TextureSlot, bool) -> [f32; 4],
    ) -> SurfaceSample {
        let material = &self.materials[material];
        let texel = |slot: Option<TextureSlot>, srgb| slot.map_or([1.0; 4], |s| texel(s, srgb));
        let base = texel(material.base_color_texture, true);
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

        // Read only where it matters.
        let metallic = if self.metals == MetalsAs::Black || material.transmission > 0.0 {
            factor(material.metallic, || {
                texel(material.metallic_texture, false)[2]
            })
        } else {
            0.0
        };
        let transmission = factor(material.transmission, || {
            texel(material.transmission_texture, false)[0]
        }) * (1.0 - metallic);
        let diffuse = match self.metals {
            MetalsAs::Diffuse => 1.0 - transmission,
            MetalsAs::Black => 1.0 - metallic - transmission,
        };
        let passing = if coverage < 1.0 || transmission > 0.0 {
            Rgb::splat(1.0 - coverage) + tint * (coverage * transmission)
        } else {
            Rgb::BLACK
        };
        let emission = match material.emission_texture {
            Some(_) if material.emits() => {
                let [r, g, b, _] = texel(material.emission_texture, true);
                material.emission * Rgb::new(r, g, b)
            }
            _ => material.emission,
        };
        SurfaceSample {
            reflectance: lowered * (coverage * diffuse),
            emission: emission * coverage,
            transmittance: passing,
            coverage,
            clamped: diffuse > 0.0 && lowered != tint,
        }
    }
}

/// A factor of the material times its texture's, which is not read for nothing.
fn factor(factor: f32, texel: impl FnOnce() -> f32) -> f32 {
    if factor > 0.0 {
        (factor * texel()).clamp(0.0, 1.0)
    } else {
        0.0
    }
}
