//! Radiance of what a sample sees.

use crate::filtering::filtered_texel;
use crate::footprint::Footprint;
use crate::lens::Lens;
use crate::relief::bumped;
use crate::sight::{Sights, SurfaceHit};
use crate::stage::Stage;
use crate::surface::{corners, finest_texel, interpolated, mixed, place};
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
        let stage = self.stage;
        let footprint = self.footprint(hit, at);
        let surface = self.surface_at(hit, footprint.as_ref());
        let element = stage.triangle(hit).element as usize;
        let emission = surface.emission * stage.dims[element];
        if surface.reflectance.is_black() {
            return (emission, surface.transmittance);
        }
        let material = &stage.scene().materials[stage.material_of(hit)];
        let relief = material.relief.zip(footprint);
        let bump = relief.map(|(relief, footprint)| {
            let (_, flat) = place(stage, hit);
            let bumped = bumped(stage, hit, &footprint, relief, flat).normal;
            Bump { flat, bumped }
        });
        let reflected = surface.reflectance * self.irradiance(hit, bump, cache) * (1.0 / PI);
        (emission + reflected, surface.transmittance)
    }

    /// What a sample sees of textures, where the material has some.
    fn footprint(&self, hit: &SurfaceHit, at: DVec2) -> Option<Footprint> {
        let stage = self.stage;
        let material = &stage.scene().materials[stage.material_of(hit)];
        material.slots().next()?;
        let ray = self.lens.ray(at)?;
        Some(Footprint::new(stage, hit, &ray, self.spacing))
    }

    /// What the material does with light at a point; textures are filtered over what the sample sees of them.
    fn surface_at(&self, hit: &SurfaceHit, footprint: Option<&Footprint>) -> SurfaceSample {
        let stage = self.stage;
        let color = interpolated(stage, hit, &stage.drawn.colors);
        let texel = |slot, srgb| match footprint {
            Some(footprint) => filtered_texel(stage, hit, footprint, slot, srgb),
            None => finest_texel(stage, hit, slot, srgb),
        };
        stage
            .scene()
            .surface_with(stage.material_of(hit), color, texel)
    }

    /// Irradiance of the flat surface, or of what a relief makes of it.
    fn irradiance(&self, hit: &SurfaceHit, bump: Option<Bump>, cache: &mut BlockCache) -> Rgb {
        let stage = self.stage;
        let bump = bump.filter(|bump| bump.flat != bump.bumped);
        match &self.light {
            Light::Flat => {
                let element = stage.triangle(hit).element as usize;
                let solved = stage.solution.element_irradiance(element) + stage.extra;
                self.tilted(hit, [solved; 3], bump)
            }
            Light::Gouraud => {
                let solved = corners(stage.triangle(hit)).map(|c| stage.drawn.irradiance[c]);
                self.tilted(hit, solved, bump)
            }
            Light::Gather { gatherer, shared } => {
                let part = stage.triangle(hit).part;
                let (position, flat) = place(stage, hit);
                let normal = bump.map_or(flat, |bump| bump.bumped);
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

    /// Irradiances of a triangle's corners, tilted and interpolated.
    fn tilted(&self, hit: &SurfaceHit, solved: [Rgb; 3], bump: Option<Bump>) -> Rgb {
        let stage = self.stage;
        let (Some(Bump { flat, bumped }), Some(light)) = (bump, &stage.tilted) else {
            return mixed(solved, hit.weights);
        };
        let tilt = bumped - flat * flat.dot(bumped);
        let vertices = corners(stage.triangle(hit));
        let turned = |i: usize| solved[i] * light.factor(stage, vertices[i], tilt);
        mixed(core::array::from_fn(turned), hit.weights)
    }
}

/// A normal and what a relief makes of it.
#[derive(Debug, Clone, Copy)]
struct Bump {
    flat: Vec3,
    bumped: Vec3,
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
