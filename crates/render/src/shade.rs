//! Radiance of what a sample sees.

use crate::behind::Behind;
use crate::filtering::filtered_texel;
use crate::footprint::Footprint;
use crate::lens::{CameraRay, Lens};
use crate::mesh_lines::MeshLines;
use crate::options::MeshOverlay;
use crate::reflections::{Mirror, Mirrors};
use crate::relief::{Bumped, bumped};
use crate::sight::{Sights, SurfaceHit};
use crate::split_sum::mirrored_share;
use crate::stage::Stage;
use crate::surface::{corners, finest_texel, interpolated, mixed, place};
use core::f32::consts::PI;
use glam::{DVec2, Vec3};
use hemicube_radiosity::Gatherer;
use hemicube_raster::Rgb;
use hemicube_raster::bump::facing;
use hemicube_raster::environment::reflected;
use hemicube_scene::{SurfaceSample, TextureSlot};

/// Share of light that surfaces which are no metals mirror straight on, as glTF has it.
const DIELECTRIC: f32 = 0.04;

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
    behind: Behind<'a>,
    /// What objects mirror.
    mirrors: Option<&'a Mirrors>,
    /// Edges of the mesh.
    lines: Option<MeshLines<'a>>,
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
            behind: Behind::Uniform(stage.behind),
            mirrors: None,
            lines: None,
            lens,
            spacing,
        }
    }

    /// Whether points cost many rays.
    pub fn gathers(&self) -> bool {
        matches!(self.light, Light::Gather { .. })
    }

    /// With something else where nothing is drawn.
    pub fn with_behind(self, behind: Behind<'a>) -> Self {
        Self { behind, ..self }
    }

    /// With objects that mirror.
    pub fn with_mirrors(self, mirrors: Option<&'a Mirrors>) -> Self {
        Self { mirrors, ..self }
    }

    /// With edges of the mesh over a picture of so many rows.
    pub fn with_lines(self, overlay: Option<MeshOverlay>, rows: usize) -> Self {
        let lines = |overlay| MeshLines::new(self.stage, self.lens, overlay, rows, self.spacing);
        Self {
            lines: overlay.map(lines),
            ..self
        }
    }

    /// What a display shows of a sample's colour with the lines on the surface nearest to the eye.
    pub fn with_lines_over(&self, color: Rgb, sights: &Sights, sample: usize, at: DVec2) -> Rgb {
        let Some(lines) = &self.lines else {
            return color;
        };
        let nearest = sights.layers(sample).last().unwrap_or(sights.hit(sample));
        lines.over(color, nearest, at)
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
            self.behind.radiance(self.lens.ray(at), self.spacing)
        } else {
            Rgb::BLACK
        };
        for layer in sights.layers(sample) {
            let (own, transmittance) = self.surface_radiance(layer, at, cache);
            radiance = own + transmittance * radiance;
        }
        radiance
    }

    /// Radiance `L = emission + reflectance × H / π` that a surface itself sends to the eye, and its transmittance; of
    /// mirroring ones, with metallic share `m` and mirrored shares `S` of the metal and `s` of what is none (glTF 2.0,
    /// appendix B), `L = emission + (m S + (1 - m) s) L_mirrored + (1 - m) (1 - s) reflectance × H / π`.
    fn surface_radiance(&self, hit: &SurfaceHit, at: DVec2, cache: &mut BlockCache) -> (Rgb, Rgb) {
        let stage = self.stage;
        let footprint = self.footprint(hit, at);
        let surface = self.surface_at(hit, footprint.as_ref());
        let element = stage.triangle(hit).element as usize;
        let emission = surface.emission * stage.dims[element];
        let mirror = self
            .mirrors
            .and_then(|mirrors| mirrors.of_part(stage.triangle(hit).part));
        if surface.reflectance.is_black() && mirror.is_none() {
            return (emission, surface.transmittance);
        }
        let bump = self.bump(hit, footprint.as_ref());
        let Some((mirror, ray)) = mirror.zip(self.lens.ray(at)) else {
            let irradiance = self.irradiance(hit, bump, cache);
            let reflected = surface.reflectance * irradiance * (1.0 / PI);
            return (emission + reflected, surface.transmittance);
        };
        let gloss = self.gloss(hit, footprint.as_ref());
        let (mirrored, coat) = self.mirrored(hit, bump, &ray, mirror, gloss);
        let rest = Rgb::WHITE - coat;
        let matt = surface.reflectance * (1.0 - gloss.metallic) * rest;
        let mut radiance = emission + mirrored * surface.coverage;
        if !matt.is_black() {
            radiance += matt * self.irradiance(hit, bump, cache) * (1.0 / PI);
        }
        let beside = Rgb::splat(1.0 - surface.coverage);
        (radiance, beside + (surface.transmittance - beside) * rest)
    }

    /// What a relief does to the normal, where the material has one.
    fn bump(&self, hit: &SurfaceHit, footprint: Option<&Footprint>) -> Option<Bump> {
        let stage = self.stage;
        let relief = stage.scene().materials[stage.material_of(hit)].relief?;
        let (_, flat) = place(stage, hit);
        let Bumped { normal, variance } = bumped(stage, hit, footprint?, relief, flat);
        Some(Bump {
            flat,
            bumped: normal,
            variance,
        })
    }

    /// Colour, metallic share and roughness of a mirroring surface.
    fn gloss(&self, hit: &SurfaceHit, footprint: Option<&Footprint>) -> Gloss {
        let stage = self.stage;
        let material = &stage.scene().materials[stage.material_of(hit)];
        let texel = |slot: Option<TextureSlot>, srgb| match (slot, footprint) {
            (Some(slot), Some(footprint)) => filtered_texel(stage, hit, footprint, slot, srgb),
            _ => [1.0; 4],
        };
        let [r, g, b, _] = texel(material.base_color_texture, true);
        let tint = interpolated(stage, hit, &stage.drawn.colors);
        let color = material.base_color * Rgb::new(r * tint.x, g * tint.y, b * tint.z);
        Gloss {
            color: color.map(|band| band.clamp(0.0, 1.0)),
            metallic: (material.metallic * texel(material.metallic_texture, false)[2])
                .clamp(0.0, 1.0),
            roughness: (material.roughness * texel(material.roughness_texture, false)[1])
                .clamp(0.0, 1.0),
        }
    }

    /// Light that a surface mirrors to the eye, and which share what is no metal mirrors. Slopes too small to be seen one by one make
    /// it rougher: `α² + 2 variance`, as for microfacets of that variance.
    fn mirrored(
        &self,
        hit: &SurfaceHit,
        bump: Option<Bump>,
        ray: &CameraRay,
        mirror: &Mirror,
        gloss: Gloss,
    ) -> (Rgb, Rgb) {
        let (position, flat) = place(self.stage, hit);
        let (normal, variance) = bump.map_or((flat, 0.0), |b| (b.bumped, b.variance));
        let to_eye = -ray.direction.normalize().as_vec3();
        let normal = facing(normal, to_eye);
        let roughness = (gloss.roughness.powi(4) + 2.0 * variance)
            .powf(0.25)
            .min(1.0);
        let cosine = normal.dot(to_eye).max(0.0);
        let coat = mirrored_share(Rgb::splat(DIELECTRIC), cosine, roughness);
        let share = coat.lerp(
            mirrored_share(gloss.color, cosine, roughness),
            gloss.metallic,
        );
        let light = mirror.radiance(position, reflected(normal, to_eye), roughness);
        (share * light, coat)
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
        let (Some(Bump { flat, bumped, .. }), Some(light)) = (bump, &stage.tilted) else {
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
    /// Of slopes smaller than the sample.
    variance: f32,
}

/// What a surface's mirroring depends on.
#[derive(Debug, Clone, Copy)]
struct Gloss {
    color: Rgb,
    metallic: f32,
    roughness: f32,
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
