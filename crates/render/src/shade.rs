//! Radiance of what a sample sees.

use crate::filtering::filtered_texel;
use crate::footprint::Footprint;
use crate::lens::Lens;
use crate::sight::{Sights, SurfaceHit};
use crate::stage::Stage;
use crate::surface::{finest_texel, interpolated, place};
use core::f32::consts::PI;
use glam::{DVec2, Vec3};
use hemicube_radiosity::Gatherer;
use hemicube_raster::Rgb;
use hemicube_scene::SurfaceSample;

/// Points of a block share a gathered irradiance if the cosine between their normals is above this.
const SAME_NORMAL: f32 = 0.98;

/// And if the line between them leaves the surface by no more than this sine.
const SAME_PLANE: f32 = 0.2;

/// Evaluates light at surface points.
#[derive(Debug)]
pub(crate) struct Shader<'a> {
    pub stage: &'a Stage<'a>,
    light: Light<'a>,
    /// Radiance where nothing is drawn.
    behind: Rgb,
    /// Where the picture's places look,
    lens: Lens,
    /// and the distance of its samples in pixels: so much each of them sees.
    spacing: f64,
}

/// Where irradiance comes from.
#[derive(Debug)]
pub(crate) enum Light<'a> {
    /// The element's value.
    Flat,
    /// Interpolated between vertices.
    Gouraud,
    /// Gathered at the point.
    Gather {
        /// From the solution.
        gatherer: Gatherer<'a>,
        /// Whether nearby points of a block share one gathering.
        shared: bool,
    },
}

/// An irradiance gathered in a block, and where.
#[derive(Debug)]
struct Gathered {
    part: u32,
    position: Vec3,
    normal: Vec3,
    irradiance: Rgb,
}

/// What was gathered for a block of samples, about a pixel, so far.
#[derive(Debug, Default)]
pub(crate) struct BlockCache(Vec<Gathered>);

impl<'a> Shader<'a> {
    /// Shades with this light what a lens shows in samples of this distance.
    pub fn new(stage: &'a Stage<'a>, light: Light<'a>, lens: Lens, spacing: f64) -> Self {
        Self {
            stage,
            light,
            behind: stage.behind,
            lens,
            spacing,
        }
    }

    /// Whether points cost many rays.
    pub fn gathers(&self) -> bool {
        matches!(self.light, Light::Gather { .. })
    }

    /// With another radiance where nothing is drawn.
    pub fn with_behind(self, behind: Rgb) -> Self {
        Self { behind, ..self }
    }

    /// Radiance that arrives at a sample, which lies at a place in pixels: `L = L_surface + transmittance × L_behind`
    /// from the farthest surface on.
    pub fn radiance(
        &self,
        sights: &Sights,
        sample: usize,
        at: DVec2,
        cache: &mut BlockCache,
    ) -> Rgb {
        let hit = sights.hit(sample);
        let mut radiance = if hit.exists() {
            self.surface_radiance(hit, at, cache).0
        } else if hit.is_inside() {
            self.behind
        } else {
            Rgb::BLACK
        };
        for layer in sights.layers(sample) {
            let (own, transmittance) = self.surface_radiance(layer, at, cache);
            radiance = own + transmittance * radiance;
        }
        radiance
    }

    /// Radiance `L = emission + reflectance × H / π` that a surface itself sends to the eye, and its transmittance.
    fn surface_radiance(&self, hit: &SurfaceHit, at: DVec2, cache: &mut BlockCache) -> (Rgb, Rgb) {
        let surface = self.surface_at(hit, at);
        let element = self.stage.triangle(hit).element as usize;
        let emission = surface.emission * self.stage.dims[element];
        if surface.reflectance.is_black() {
            return (emission, surface.transmittance);
        }
        let reflected = surface.reflectance * self.irradiance(hit, cache) * (1.0 / PI);
        (emission + reflected, surface.transmittance)
    }

    /// What the material does with light at a point; textures are filtered over what the sample sees of them.
    fn surface_at(&self, hit: &SurfaceHit, at: DVec2) -> SurfaceSample {
        let stage = self.stage;
        let material = stage.material_of(hit);
        let color = interpolated(stage, hit, &stage.drawn.colors);
        let scene = stage.scene();
        let is_textured = scene.materials[material].slots().next().is_some();
        let ray = if is_textured { self.lens.ray(at) } else { None };
        match ray {
            None => scene.surface_with(material, color, |slot, srgb| {
                finest_texel(stage, hit, slot, srgb)
            }),
            Some(ray) => {
                let footprint = Footprint::new(stage, hit, &ray, self.spacing);
                scene.surface_with(material, color, |slot, srgb| {
                    filtered_texel(stage, hit, &footprint, slot, srgb)
                })
            }
        }
    }

    fn irradiance(&self, hit: &SurfaceHit, cache: &mut BlockCache) -> Rgb {
        let stage = self.stage;
        match &self.light {
            Light::Flat => {
                let element = stage.triangle(hit).element as usize;
                stage.solution.element_irradiance(element) + stage.extra
            }
            Light::Gouraud => interpolated(stage, hit, &stage.drawn.irradiance),
            Light::Gather { gatherer, shared } => {
                let part = stage.triangle(hit).part;
                let (position, normal) = place(stage, hit);
                let same = |g: &&Gathered| *shared && g.is_beside(part, position, normal);
                if let Some(known) = cache.0.iter().find(same) {
                    return known.irradiance;
                }
                let irradiance = gatherer.irradiance(position, normal);
                cache.0.push(Gathered {
                    part,
                    position,
                    normal,
                    irradiance,
                });
                irradiance
            }
        }
    }
}

impl Gathered {
    /// Whether a point lies on the same smooth surface, as far as a block can tell.
    fn is_beside(&self, part: u32, position: Vec3, normal: Vec3) -> bool {
        let way = position - self.position;
        self.part == part
            && self.normal.dot(normal) > SAME_NORMAL
            && way.dot(self.normal).abs() <= SAME_PLANE * way.length()
    }
}
