//! Materials as radiosity sees them (diffuse reflectance, emission, what passes straight through), and what only
//! pictures use: roughness and relief.

use glam::{Affine2, Vec2};
use hemicube_raster::Rgb;
use serde::{Deserialize, Serialize};

/// How a surface treats light. Textures multiply the factor beside them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Material {
    /// Name by which options find it.
    pub name: String,
    /// Base colour: linear, per band in [0, 1].
    pub base_color: Rgb,
    /// Base opacity in [0, 1]; [`AlphaMode`] says what it means.
    pub alpha: f32,
    /// Multiplies base colour (rgb, sRGB-encoded) and alpha (a).
    pub base_color_texture: Option<TextureSlot>,
    /// 0 for dielectrics, 1 for metals.
    pub metallic: f32,
    /// Multiplies `metallic` by its blue channel (linear).
    pub metallic_texture: Option<TextureSlot>,
    /// Perceptual roughness in [0, 1]; kept for pictures, the diffuse solution does not use it.
    pub roughness: f32,
    /// Multiplies `roughness` by its green channel (linear).
    pub roughness_texture: Option<TextureSlot>,
    /// Turns the normals of pictures; the diffuse solution does not use it.
    pub relief: Option<Relief>,
    /// Emitted radiance L: cd/m² (photometric) or W/(m² sr) (radiometric). Exitance is π L.
    pub emission: Rgb,
    /// Multiplies `emission` (rgb, sRGB-encoded).
    pub emission_texture: Option<TextureSlot>,
    /// Share of light that passes straight through, tinted by the base colour (`KHR_materials_transmission`).
    pub transmission: f32,
    /// Multiplies `transmission` by its red channel (linear).
    pub transmission_texture: Option<TextureSlot>,
    /// Meaning of alpha.
    pub alpha_mode: AlphaMode,
    /// Whether the back side receives, reflects and emits like the front.
    pub double_sided: bool,
    /// The file wants it drawn without light; radiosity treats it as diffuse.
    pub unlit: bool,
    /// Only in the way: both sides block and absorb, neither receives, reflects or emits, whatever the other fields
    /// say. Such faces get no elements and no row of a matrix, and pictures do not show them.
    pub obstruction: bool,
}

/// Meaning of alpha, as in glTF.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub enum AlphaMode {
    /// Alpha is ignored.
    Opaque,
    /// Where alpha is below the cutoff there is a hole.
    Mask {
        /// Smallest alpha that is still surface.
        cutoff: f32,
    },
    /// `1 - alpha` of the light passes straight through.
    Blend,
}

/// A texture that makes a flat surface look uneven (Blinn 1978): it turns normals and moves nothing.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Relief {
    /// The picture, not colour-encoded.
    pub slot: TextureSlot,
    /// What its channels mean.
    pub kind: ReliefKind,
}

/// What the channels of a [`Relief`] mean.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub enum ReliefKind {
    /// A unit normal `2 rgb - 1` in tangent space: x along the tangent, y upwards in the picture, z off the surface.
    Normal {
        /// Factor on x and y.
        scale: f32,
    },
    /// A height, the mean of red, green and blue.
    Height {
        /// How far white lies above black, as a share of the picture's extent on the surface.
        depth: f32,
    },
}

/// A texture as a material uses it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct TextureSlot {
    /// Index into [`Scene::textures`](crate::Scene::textures).
    pub texture: usize,
    /// Which of the mesh's sets of texture coordinates.
    pub texcoord_set: usize,
    /// `KHR_texture_transform`: texture_from_mesh coordinates.
    pub transform: Affine2,
}

impl TextureSlot {
    /// The texture with the mesh's first coordinates as they are.
    pub fn new(texture: usize) -> Self {
        Self {
            texture,
            texcoord_set: 0,
            transform: Affine2::IDENTITY,
        }
    }

    /// The mesh's coordinates of the set that it uses; 0 where the mesh lacks it.
    pub fn texcoord(&self, sets: &[Vec2]) -> Vec2 {
        sets.get(self.texcoord_set).copied().unwrap_or(Vec2::ZERO)
    }

    /// The texture's coordinates for the mesh's.
    pub fn coordinates(&self, texcoord: Vec2) -> Vec2 {
        self.transform.transform_point2(texcoord)
    }
}

impl Default for Material {
    fn default() -> Self {
        Self {
            name: String::from("default"),
            base_color: Rgb::WHITE,
            alpha: 1.0,
            base_color_texture: None,
            metallic: 0.0,
            metallic_texture: None,
            roughness: 1.0,
            roughness_texture: None,
            relief: None,
            emission: Rgb::BLACK,
            emission_texture: None,
            transmission: 0.0,
            transmission_texture: None,
            alpha_mode: AlphaMode::Opaque,
            double_sided: false,
            unlit: false,
            obstruction: false,
        }
    }
}

impl Material {
    /// A matt, opaque, one-sided material.
    pub fn diffuse(name: impl Into<String>, reflectance: Rgb) -> Self {
        Self {
            name: name.into(),
            base_color: reflectance,
            ..Self::default()
        }
    }

    /// What only blocks and absorbs; see [`obstruction`](Self::obstruction).
    pub fn blocking(name: impl Into<String>) -> Self {
        Self {
            obstruction: true,
            ..Self::diffuse(name, Rgb::BLACK)
        }
    }

    /// The same material emitting radiance `L`.
    pub fn with_emission(self, radiance: Rgb) -> Self {
        Self {
            emission: radiance,
            ..self
        }
    }

    /// Every texture it uses.
    pub fn slots(&self) -> impl Iterator<Item = TextureSlot> + use<> {
        let relief = self.relief.map(|relief| relief.slot);
        let slots = [
            self.base_color_texture,
            self.metallic_texture,
            self.roughness_texture,
            self.emission_texture,
            self.transmission_texture,
            relief,
        ];
        slots.into_iter().flatten()
    }

    /// Whether any part of a surface of this material may let light through (holes, glass).
    pub fn may_transmit(&self) -> bool {
        !self.obstruction && (self.transmission > 0.0 || self.alpha_mode != AlphaMode::Opaque)
    }

    /// Whether it emits anything at all.
    pub fn emits(&self) -> bool {
        !self.obstruction && self.emission.max_band() > 0.0
    }

    /// How many sides of a face receive and radiate: 2 if double-sided, none of an obstruction, else 1.
    pub fn lit_sides(&self) -> usize {
        match (self.obstruction, self.double_sided) {
            (true, _) => 0,
            (false, false) => 1,
            (false, true) => 2,
        }
    }
}
