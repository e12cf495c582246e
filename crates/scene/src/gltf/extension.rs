//! The extensions that are read, as their JSON says them.

use crate::ImportReport;
use crate::open::one_line;
use serde::Deserialize;
use serde::de::DeserializeOwned;
use serde_json::{Map, Value};

/// Reads an extension out of an object's `extensions`; a damaged one is left out with a warning.
pub fn read<T: DeserializeOwned>(
    others: Option<&Map<String, Value>>,
    name: &str,
    place: &str,
    report: &mut ImportReport,
) -> Option<T> {
    match T::deserialize(others?.get(name)?) {
        Ok(extension) => Some(extension),
        Err(error) => {
            report.warn(
                place,
                format!(
                    "{name} is damaged ({}); left out",
                    one_line(&error.to_string())
                ),
            );
            None
        }
    }
}

/// A reference to a texture inside an extension.
#[derive(Debug, Clone, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct TextureInfo {
    pub index: u32,
    #[serde(default)]
    pub tex_coord: u32,
    #[serde(default)]
    pub extensions: Map<String, Value>,
}

/// `KHR_texture_transform`.
#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase", default)]
pub struct TextureTransform {
    pub offset: [f32; 2],
    pub rotation: f32,
    pub scale: [f32; 2],
    pub tex_coord: Option<u32>,
}

impl Default for TextureTransform {
    fn default() -> Self {
        Self {
            offset: [0.0; 2],
            rotation: 0.0,
            scale: [1.0; 2],
            tex_coord: None,
        }
    }
}

/// `KHR_materials_emissive_strength`.
#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase", default)]
pub struct EmissiveStrength {
    pub emissive_strength: f32,
}

impl Default for EmissiveStrength {
    fn default() -> Self {
        Self {
            emissive_strength: 1.0,
        }
    }
}

/// `KHR_materials_transmission`.
#[derive(Debug, Default, Deserialize)]
#[serde(rename_all = "camelCase", default)]
pub struct Transmission {
    pub transmission_factor: f32,
    pub transmission_texture: Option<TextureInfo>,
}

/// `KHR_materials_pbrSpecularGlossiness`, its diffuse part.
#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase", default)]
pub struct SpecularGlossiness {
    pub diffuse_factor: [f32; 4],
    pub diffuse_texture: Option<TextureInfo>,
    pub glossiness_factor: f32,
}

impl Default for SpecularGlossiness {
    fn default() -> Self {
        Self {
            diffuse_factor: [1.0; 4],
            diffuse_texture: None,
            glossiness_factor: 1.0,
        }
    }
}

/// `KHR_lights_punctual` of the document.
#[derive(Debug, Default, Deserialize)]
pub struct Lights {
    #[serde(default)]
    pub lights: Vec<Value>,
}

/// A light of `KHR_lights_punctual`.
#[derive(Debug, Deserialize)]
pub struct Light {
    pub name: Option<String>,
    #[serde(default = "white")]
    pub color: [f32; 3],
    #[serde(default = "one")]
    pub intensity: f32,
    #[serde(rename = "type")]
    pub kind: String,
    #[serde(default)]
    pub spot: Spot,
}

/// The cone of a spot light, radians.
#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase", default)]
pub struct Spot {
    pub inner_cone_angle: f32,
    pub outer_cone_angle: f32,
}

impl Default for Spot {
    fn default() -> Self {
        Self {
            inner_cone_angle: 0.0,
            outer_cone_angle: core::f32::consts::FRAC_PI_4,
        }
    }
}

fn white() -> [f32; 3] {
    [1.0; 3]
}

fn one() -> f32 {
    1.0
}

/// `KHR_lights_punctual` of a node.
#[derive(Debug, Deserialize)]
pub struct LightOfNode {
    pub light: usize,
}

/// `KHR_node_visibility`.
#[derive(Debug, Deserialize)]
pub struct Visibility {
    #[serde(default = "yes")]
    pub visible: bool,
}

fn yes() -> bool {
    true
}

/// `EXT_mesh_gpu_instancing`.
#[derive(Debug, Deserialize)]
pub struct Instancing {
    pub attributes: InstancingAttributes,
}

/// Accessors of the placements.
#[derive(Debug, Deserialize)]
#[serde(rename_all = "UPPERCASE")]
pub struct InstancingAttributes {
    pub translation: Option<usize>,
    pub rotation: Option<usize>,
    pub scale: Option<usize>,
}
