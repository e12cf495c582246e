//! The scene as a whole.

use crate::options::MAX_REFLECTANCE;
use crate::{
    Camera, Face, ImportReport, Instance, Light, LightKind, Material, Mesh, MetalsAs, SceneError,
    Texture, TextureImage,
};
use glam::Vec3;
use hemicube_raster::Rgb;
use serde::{Deserialize, Serialize};

/// Most radiance, irradiance or intensity of a source: a million times that of the sun. Fluxes of large sources stay in
/// the range of f32.
pub const MAX_LIGHT: f32 = 1e15;

/// A scene: geometry, materials, lights and cameras in one right-handed world, +Y up.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Scene {
    /// File stem or name of the built-in scene.
    pub name: String,
    /// What the numbers of light mean.
    pub units: Units,
    /// Geometry, each mesh once however often it is placed.
    pub meshes: Vec<Mesh>,
    /// Where meshes stand.
    pub instances: Vec<Instance>,
    /// Materials.
    pub materials: Vec<Material>,
    /// Pictures with rules for their borders.
    pub textures: Vec<Texture>,
    /// Pictures. Not serialised: an exported file holds them as files of their own.
    #[serde(skip)]
    pub images: Vec<TextureImage>,
    /// Lights without an area.
    pub lights: Vec<Light>,
    /// Uniform sky radiance from every direction in which nothing is hit.
    pub sky: Rgb,
    /// What metals do as long as nothing specular is solved.
    pub metals: MetalsAs,
    /// Bound to which [`surface_at`](Self::surface_at) lowers larger reflectances.
    pub max_reflectance: f32,
    /// Views.
    pub cameras: Vec<Camera>,
    /// What a file that was made for view factors asks of them; `None` for scenes made for light.
    pub view_factors: Option<ViewFactorRequest>,
    /// What happened on the way in.
    pub report: ImportReport,
}

/// What a file that was made for view factors asks of them. Its instances are the surfaces between which they are meant.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct ViewFactorRequest {
    /// Whether the surfaces are said to enclose a space, so that factors may be corrected until rows sum to 1.
    pub enclosure: bool,
    /// Error at which integration may stop, as a share of the smaller surface.
    pub error: Option<f64>,
    /// Covers that lie on a surface and face it.
    #[serde(default)]
    pub masks: Vec<Mask>,
    /// Names of the rows in their order, masks among them; empty if the order of the instances is that of the rows.
    #[serde(default)]
    pub rows: Vec<String>,
}

/// A cover that lies on a surface and faces it: all that leaves it arrives at the part of its base that it covers, and
/// all that leaves that part arrives at it.
///
/// The covered part is no face of the scene, since nothing else sees it; the cover is an instance that only blocks.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Mask {
    /// Node of the instance that covers. Its reflectance is that of its material, which is an obstruction otherwise.
    pub node: String,
    /// Node of the surface that is covered; no instance has it if nothing of the surface is seen.
    pub base: String,
    /// Material of that surface, an index into [`Scene::materials`].
    pub base_material: usize,
}

/// What the numbers of light mean.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum Units {
    /// L in cd/m², intensities in cd, irradiance in lx, as glTF says.
    #[default]
    Photometric,
    /// L in W/(m² sr), intensities in W/sr, irradiance in W/m².
    Radiometric,
}

impl Default for Scene {
    /// An empty scene with the usual rules for metals and bright reflectances.
    fn default() -> Self {
        Self {
            name: String::new(),
            units: Units::default(),
            meshes: Vec::new(),
            instances: Vec::new(),
            materials: Vec::new(),
            textures: Vec::new(),
            images: Vec::new(),
            lights: Vec::new(),
            sky: Rgb::BLACK,
            metals: MetalsAs::default(),
            max_reflectance: MAX_REFLECTANCE,
            cameras: Vec::new(),
            view_factors: None,
            report: ImportReport::default(),
        }
    }
}

impl Units {
    /// Illuminance in lx for an irradiance in these units: luminance weights, times 179 lm/W when radiometric.
    pub fn illuminance(self, irradiance: Rgb) -> f32 {
        match self {
            Self::Photometric => irradiance.luminance(),
            Self::Radiometric => 179.0 * irradiance.luminance(),
        }
    }
}

impl Scene {
    /// Whether anything in the scene gives light.
    pub fn has_light(&self) -> bool {
        self.sky.max_band() > 0.0
            || !self.lights.is_empty()
            || self
                .instances
                .iter()
                .any(|i| self.materials[self.meshes[i.mesh].material].emits())
    }

    /// Number of faces as placed (a mesh placed twice counts twice).
    pub fn face_count(&self) -> usize {
        self.instances
            .iter()
            .map(|i| self.meshes[i.mesh].faces.len())
            .sum()
    }

    /// Smallest and largest coordinates of all placed vertices that a face uses; `None` for an empty scene.
    pub fn bounds(&self) -> Option<(Vec3, Vec3)> {
        let mut bounds: Option<(Vec3, Vec3)> = None;
        for instance in &self.instances {
            let mesh = &self.meshes[instance.mesh];
            for &corner in mesh.faces.iter().flat_map(Face::corners) {
                let p = instance
                    .world_from_mesh
                    .transform_point3(mesh.positions[corner as usize]);
                bounds = Some(bounds.map_or((p, p), |(low, high)| (low.min(p), high.max(p))));
            }
        }
        bounds
    }

    /// The camera of a name; the message of the error lists what there is.
    pub fn camera(&self, name: &str) -> Result<&Camera, SceneError> {
        self.cameras.iter().find(|c| c.name == name).ok_or_else(|| {
            let names: Vec<&str> = self.cameras.iter().map(|c| c.name.as_str()).collect();
            SceneError::Check(match names.as_slice() {
                [] => format!("camera '{name}': the scene has no cameras; use --eye and --look-at"),
                _ => format!("camera '{name}': the scene has {}", names.join(", ")),
            })
        })
    }

    /// Checks what everything behind this door relies on: indices in range, arrays of equal length, finite numbers.
    ///
    /// # Errors
    /// Names the first thing that is wrong.
    pub fn check(&self) -> Result<(), SceneError> {
        let fail = |message: String| Err(SceneError::Check(message));
        for (i, texture) in self.textures.iter().enumerate() {
            if texture.image >= self.images.len() {
                return fail(format!(
                    "texture {i}: image {} of {}",
                    texture.image,
                    self.images.len()
                ));
            }
        }
        for material in &self.materials {
            self.check_material(material)?;
        }
        for mesh in &self.meshes {
            self.check_mesh(mesh)?;
        }
        let masks = self.view_factors.iter().flat_map(|asked| &asked.masks);
        for mask in masks {
            if mask.base_material >= self.materials.len() {
                return fail(format!(
                    "mask '{}': base material {} of {}",
                    mask.node,
                    mask.base_material,
                    self.materials.len()
                ));
            }
        }
        for instance in &self.instances {
            if instance.mesh >= self.meshes.len() {
                return fail(format!(
                    "node '{}': mesh {} of {}",
                    instance.node,
                    instance.mesh,
                    self.meshes.len()
                ));
            }
            if !instance.world_from_mesh.is_finite() {
                return fail(format!(
                    "node '{}': its transform is not finite",
                    instance.node
                ));
            }
        }
        for light in &self.lights {
            let strength = match light.kind {
                LightKind::Point { intensity, .. } | LightKind::Spot { intensity, .. } => intensity,
                LightKind::Directional { irradiance, .. } => irradiance,
            };
            check_light(strength, || format!("light '{}': intensity", light.name))?;
        }
        check_light(self.sky, || String::from("sky radiance"))
    }

    fn check_material(&self, material: &Material) -> Result<(), SceneError> {
        let name = &material.name;
        let numbers = [material.alpha, material.metallic, material.transmission];
        if !material.base_color.is_finite() || !numbers.iter().all(|x| x.is_finite()) {
            return Err(SceneError::Check(format!(
                "material '{name}': a factor is not finite"
            )));
        }
        check_light(material.emission, || format!("material '{name}': emission"))?;
        match material
            .slots()
            .find(|slot| slot.texture >= self.textures.len())
        {
            Some(slot) => {
                let count = self.textures.len();
                Err(SceneError::Check(format!(
                    "material '{name}': texture {} of {count}",
                    slot.texture
                )))
            }
            None => Ok(()),
        }
    }

    fn check_mesh(&self, mesh: &Mesh) -> Result<(), SceneError> {
        let (name, count) = (&mesh.name, mesh.positions.len());
        let fail = |message: String| Err(SceneError::Check(format!("mesh '{name}': {message}")));
        if mesh.material >= self.materials.len() {
            return fail(format!(
                "material {} of {}",
                mesh.material,
                self.materials.len()
            ));
        }
        let optional = |length: usize| length == 0 || length == count;
        if !optional(mesh.normals.len())
            || !optional(mesh.tangents.len())
            || !optional(mesh.colors.len())
            || mesh.texcoords.iter().any(|t| t.len() != count)
        {
            return fail(format!("its vertex arrays are not all {count} long"));
        }
        if let Some(i) = mesh.positions.iter().position(|p| !p.is_finite()) {
            return fail(format!("vertex {i} is not finite"));
        }
        for (i, face) in mesh.faces.iter().enumerate() {
            if let Some(corner) = face
                .corners()
                .iter()
                .find(|&&corner| corner as usize >= count)
            {
                return fail(format!("face {i} uses vertex {corner} of {count}"));
            }
        }
        Ok(())
    }
}

/// Refuses light that is negative, not finite or too much.
fn check_light(light: Rgb, what: impl Fn() -> String) -> Result<(), SceneError> {
    let bands = light.to_array();
    let problem = if bands.iter().any(|&band| band.is_nan() || band < 0.0) || !light.is_finite() {
        String::from("is negative or not finite")
    } else if light.max_band() > MAX_LIGHT {
        format!("is above {MAX_LIGHT:e}, the most that can be computed with")
    } else {
        return Ok(());
    };
    Err(SceneError::Check(format!("{} {bands:?} {problem}", what())))
}
