//! Environment mapping: surfaces that mirror what is around their object.

use crate::error::RenderError;
use crate::stage::Stage;
use glam::Vec3;
use hemicube_raster::Rgb;
use hemicube_raster::environment::{Bounds, PrefilteredEnvironment};
use hemicube_scene::{Material, Scene, Texture, TextureSlot, TextureUse};
use wildmatch::WildMatch;

/// Which surfaces mirror their surroundings, and how well.
///
/// A mirroring object gets a map of what is seen from the middle of its bounding box, itself left out; it is blurred by
/// roughness and weighted by Fresnel's law. The map shows light as the solution has it, so mirrors in mirrors are matt. In
/// the solution mirroring objects reflect diffusely: they cast no caustics.
#[derive(Debug, Clone, PartialEq)]
pub struct Reflections {
    /// Metals mirror if their mean roughness is below this. Default value: 0.3.
    pub metals_below: f32,
    /// Materials and nodes that mirror, whatever they are made of; names may be globs. Default value: none.
    pub names: Vec<String>,
    /// Pixels of a side of the maps' six faces, from 8 to 1024. Default value: 128.
    pub resolution: usize,
    /// Most objects with maps of their own; smaller ones share that of the nearest. Default value: 32.
    pub maps: usize,
    /// Whether the box around the scene stands for what the maps show, in scenes that are closed around the object; else
    /// everything is taken to be far away. Default value: true.
    pub box_projected: bool,
}

impl Default for Reflections {
    fn default() -> Self {
        Self {
            metals_below: 0.3,
            names: Vec::new(),
            resolution: 128,
            maps: 32,
            box_projected: true,
        }
    }
}

impl Reflections {
    /// Another bound for metals; 0 leaves them matt.
    pub fn with_metals_below(self, metals_below: f32) -> Self {
        Self {
            metals_below,
            ..self
        }
    }

    /// Materials and nodes by name.
    pub fn with_names(self, names: Vec<String>) -> Self {
        Self { names, ..self }
    }

    /// Finer maps, or coarser ones.
    pub fn with_resolution(self, resolution: usize) -> Self {
        Self { resolution, ..self }
    }

    /// More maps, or fewer.
    pub fn with_maps(self, maps: usize) -> Self {
        Self { maps, ..self }
    }

    /// With or without parallax.
    pub fn with_box_projected(self, box_projected: bool) -> Self {
        Self {
            box_projected,
            ..self
        }
    }

    /// Whether they can be had in a scene; [`Renderer::with_reflections`](crate::Renderer::with_reflections) asks this too.
    ///
    /// # Errors
    /// A name that matches nothing in the scene, a resolution out of range.
    pub fn check(&self, scene: &Scene) -> Result<(), RenderError> {
        if !(8..=1024).contains(&self.resolution) {
            return Err(RenderError::Resolution(self.resolution));
        }
        let nodes = || scene.instances.iter().map(|i| i.node.as_str());
        let materials = || scene.materials.iter().map(|m| m.name.as_str());
        for name in &self.names {
            let pattern = WildMatch::new(name);
            if !nodes()
                .chain(materials())
                .any(|known| pattern.matches(known))
            {
                return Err(RenderError::Mirror(name.clone()));
            }
        }
        Ok(())
    }

    /// For each part of the drawn mesh whether it mirrors.
    pub(crate) fn mirroring_parts(&self, stage: &Stage<'_>) -> Vec<bool> {
        let scene = stage.scene();
        let patterns: Vec<WildMatch> = self.names.iter().map(|n| WildMatch::new(n)).collect();
        let named = |name: &str| patterns.iter().any(|p| p.matches(name));
        let mirrors = |part: &hemicube_radiosity::drawn::DrawnPart| {
            let material = &scene.materials[part.material];
            named(&material.name)
                || named(&scene.instances[part.instance].node)
                || is_smooth_metal(scene, material, self.metals_below)
        };
        stage.drawn.parts.iter().map(mirrors).collect()
    }
}

/// Whether a material is mostly metal, and its mean roughness below a bound.
fn is_smooth_metal(scene: &Scene, material: &Material, below: f32) -> bool {
    let metallic = material.metallic * mean_of(scene, material.metallic_texture)[2];
    metallic > 0.5 && material.roughness * mean_of(scene, material.roughness_texture)[1] < below
}

/// Mean of a texture of data; 1 without one.
fn mean_of(scene: &Scene, slot: Option<TextureSlot>) -> [f32; 4] {
    let Some(slot) = slot else {
        return [1.0; 4];
    };
    let Texture { image, wrap, .. } = scene.textures[slot.texture];
    let chain = scene.images[image].chain(wrap, TextureUse::Data);
    *chain.level(chain.levels() - 1).pixel(0, 0)
}

/// A blurred map, and where it was taken.
#[derive(Debug)]
pub(crate) struct Mirror {
    pub position: Vec3,
    pub map: PrefilteredEnvironment,
    /// The room that the map shows, if it is one.
    pub room: Option<Bounds>,
}

impl Mirror {
    /// Light that a point mirrors from around a direction of unit length; in a room box-projected.
    pub fn radiance(&self, point: Vec3, direction: Vec3, roughness: f32) -> Rgb {
        let seen = self.room.map_or(direction, |room| {
            room.projected(self.position, point, direction)
        });
        self.map.radiance(seen, roughness)
    }
}

/// The maps of a picture's mirrors.
#[derive(Debug)]
pub(crate) struct Mirrors {
    /// For each part of the drawn mesh the map that it shows.
    pub of_parts: Vec<Option<usize>>,
    pub mirrors: Vec<Mirror>,
}

impl Mirrors {
    /// The map that a part shows.
    pub fn of_part(&self, part: u32) -> Option<&Mirror> {
        let map = self.of_parts[part as usize]?;
        self.mirrors.get(map)
    }
}
