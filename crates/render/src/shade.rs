//! Radiance of what a sample sees.

use crate::band::{Band, SurfaceHit};
use crate::options::Shading;
use crate::stage::Stage;
use core::f32::consts::PI;
use core::ops::{Add, Mul, Sub};
use glam::Vec3;
use hemicube_radiosity::Gatherer;
use hemicube_raster::Rgb;
use hemicube_scene::SurfaceSample;

/// Points of a pixel share a gathered irradiance if the cosine between their normals is above this.
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
}

/// Where irradiance comes from.
#[derive(Debug)]
enum Light<'a> {
    Flat,
    Gouraud,
    Gather {
        gatherer: Gatherer<'a>,
        /// Whether nearby points of a pixel share one gathering.
        shared: bool,
    },
}

/// An irradiance gathered in a pixel, and where.
#[derive(Debug)]
struct Gathered {
    part: u32,
    position: Vec3,
    normal: Vec3,
    irradiance: Rgb,
}

/// What was gathered for a pixel so far.
#[derive(Debug, Default)]
pub(crate) struct PixelCache(Vec<Gathered>);

impl<'a> Shader<'a> {
    /// Shades by the elements' values or by interpolating them.
    pub fn of_values(stage: &'a Stage<'a>, shading: Shading) -> Self {
        let light = if shading == Shading::Flat {
            Light::Flat
        } else {
            Light::Gouraud
        };
        Self::new(stage, light)
    }

    /// Shades by gathering; with `shared`, points of one pixel that lie on the same surface share a gathering.
    pub fn gathering(stage: &'a Stage<'a>, gatherer: Gatherer<'a>, shared: bool) -> Self {
        Self::new(stage, Light::Gather { gatherer, shared })
    }

    fn new(stage: &'a Stage<'a>, light: Light<'a>) -> Self {
        Self {
            stage,
            light,
            behind: stage.behind,
        }
    }

    /// With another radiance where nothing is drawn.
    pub fn with_behind(self, behind: Rgb) -> Self {
        Self { behind, ..self }
    }

    /// Radiance that arrives at a sample: `L = L_surface + transmittance × L_behind` from the farthest surface on.
    pub fn radiance(&self, band: &Band, sample: usize, cache: &mut PixelCache) -> Rgb {
        let hit = band.hit(sample);
        let mut radiance = if hit.exists() {
            self.surface_radiance(hit, cache).0
        } else {
            self.behind
        };
        for layer in band.layers(sample) {
            let (own, transmittance) = self.surface_radiance(layer, cache);
            radiance = own + transmittance * radiance;
        }
        radiance
    }

    /// Radiance `L = emission + reflectance × H / π` that a surface itself sends to the eye, and its transmittance.
    fn surface_radiance(&self, hit: &SurfaceHit, cache: &mut PixelCache) -> (Rgb, Rgb) {
        let surface = surface_at(self.stage, hit);
        let element = self.stage.triangles[hit.triangle as usize].element as usize;
        let emission = surface.emission * self.stage.dims[element];
        if surface.reflectance.is_black() {
            return (emission, surface.transmittance);
        }
        let reflected = surface.reflectance * self.irradiance(hit, cache) * (1.0 / PI);
        (emission + reflected, surface.transmittance)
    }

    fn irradiance(&self, hit: &SurfaceHit, cache: &mut PixelCache) -> Rgb {
        let stage = self.stage;
        match &self.light {
            Light::Flat => {
                let element = stage.triangles[hit.triangle as usize].element as usize;
                stage.solution.element_irradiance(element) + stage.extra
            }
            Light::Gouraud => interpolated(stage, hit, &stage.drawn.irradiance),
            Light::Gather { gatherer, shared } => {
                let part = stage.triangles[hit.triangle as usize].part;
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
    /// Whether a point lies on the same smooth surface, as far as a pixel can tell.
    fn is_beside(&self, part: u32, position: Vec3, normal: Vec3) -> bool {
        let way = position - self.position;
        self.part == part
            && self.normal.dot(normal) > SAME_NORMAL
            && way.dot(self.normal).abs() <= SAME_PLANE * way.length()
    }
}

/// World position and unit normal of a point.
pub(crate) fn place(stage: &Stage<'_>, hit: &SurfaceHit) -> (Vec3, Vec3) {
    let position = interpolated(stage, hit, &stage.drawn.positions);
    let normal = interpolated(stage, hit, &stage.drawn.normals);
    let element = stage.triangles[hit.triangle as usize].element as usize;
    let mesh = stage.solution.mesh();
    let flat = mesh.node(mesh.elements()[element]).normal;
    (position, normal.try_normalize().unwrap_or(flat))
}

/// What the material does with light at a point.
fn surface_at(stage: &Stage<'_>, hit: &SurfaceHit) -> SurfaceSample {
    let texcoords = [0, 1].map(|set| {
        let corners = corners(stage, hit).map(|c| stage.drawn.texcoords[c][set]);
        mixed(corners, hit.weights)
    });
    let color = interpolated(stage, hit, &stage.drawn.colors);
    let part = stage.triangles[hit.triangle as usize].part as usize;
    let material = stage.drawn.parts[part].material;
    stage.scene().surface_at(material, &texcoords, color)
}

/// Whether a point lies in a hole of an alpha mask.
pub(crate) fn is_hole(stage: &Stage<'_>, hit: &SurfaceHit) -> bool {
    surface_at(stage, hit).transmittance == Rgb::WHITE
}

fn corners(stage: &Stage<'_>, hit: &SurfaceHit) -> [usize; 3] {
    stage.triangles[hit.triangle as usize]
        .corners
        .map(|c| c as usize)
}

/// A vertex attribute at a point.
fn interpolated<T>(stage: &Stage<'_>, hit: &SurfaceHit, values: &[T]) -> T
where
    T: Copy + Add<Output = T> + Sub<Output = T> + Mul<f32, Output = T>,
{
    mixed(corners(stage, hit).map(|c| values[c]), hit.weights)
}

/// `a + v (b - a) + w (c - a)`: three equal values stay what they are, to the bit.
fn mixed<T>([a, b, c]: [T; 3], [v, w]: [f32; 2]) -> T
where
    T: Copy + Add<Output = T> + Sub<Output = T> + Mul<f32, Output = T>,
{
    a + (b - a) * v + (c - a) * w
}
