//! Solids under lamps: which is seen along a ray, and how bright it is.
//!
//! Whitted, *An improved illumination model for shaded display* (CACM 1980): at the first surface that a ray meets,
//! lamps that nothing hides and the sky give their light, and what the surface mirrors is asked with a new ray.

use crate::bounds::Bounds;
use crate::leaf::Leaf;
use crate::light::{Light, Sky};
use crate::material::Material;
use crate::pattern::Pattern;
use crate::ray::Ray;
use crate::solid::{Solid, longest_axis};
use crate::span::Boundaries;
use core::ops::Range;
use glam::DVec3;
use hemicube_raster::Rgb;
use std::sync::Arc;

/// Solids, lamps and sky.
#[derive(Debug, Clone)]
pub struct Scene {
    bounded: Option<Branch>,
    unbounded: Vec<Solid>,
    lights: Vec<Light>,
    sky: Sky,
    /// Of what has no material.
    default_material: Arc<Material>,
    reflections: u32,
}

/// A binary tree of boxes around solids.
#[derive(Debug, Clone)]
struct Branch {
    bounds: Bounds,
    kind: Kind,
}

#[derive(Debug, Clone)]
enum Kind {
    Solid(Box<Solid>),
    Pair(Box<[Branch; 2]>),
}

/// Where a ray meets a surface.
#[derive(Debug, Clone, Copy)]
pub struct Hit {
    /// Distance from the origin of the ray.
    pub t: f64,
    /// The point.
    pub point: DVec3,
    /// Unit normal on the ray's side of the surface.
    pub normal: DVec3,
}

/// How far from a surface a ray starts that leaves it, relative to its distance from the world's origin: beyond
/// rounding, below what is seen.
const OFFSET: f64 = 1e-7;

/// Mirrored rays that count less than this are not cast: half a step of an 8-bit picture's darkest shades.
const NEGLIGIBLE: f32 = 1e-4;

impl Scene {
    /// These solids under an even white sky of radiance 1. Each counts for itself: put together what overlaps by
    /// [`Solid::union`] if it shall look the same from inside.
    pub fn new(solids: impl IntoIterator<Item = Solid>) -> Self {
        let (bounded, unbounded): (Vec<Solid>, Vec<Solid>) = solids
            .into_iter()
            .filter(|s| !s.bounds().is_empty())
            .partition(|s| s.bounds().is_bounded());
        let grey = Pattern::plain(Rgb::splat(0.5)).expect("grey is a colour");
        Self {
            bounded: Branch::new(bounded),
            unbounded,
            lights: Vec::new(),
            sky: Sky::even(Rgb::WHITE).expect("white is a radiance"),
            default_material: Arc::new(Material::matte(grey)),
            reflections: 6,
        }
    }

    /// With these lamps. Default value: none.
    pub fn with_lights(mut self, lights: impl IntoIterator<Item = Light>) -> Self {
        self.lights = lights.into_iter().collect();
        self
    }

    /// With another sky. Default value: radiance 1 everywhere.
    pub fn with_sky(mut self, sky: Sky) -> Self {
        self.sky = sky;
        self
    }

    /// With at most so many mirrors between the eye and what it sees; behind the last one a mirror shows the sky. More than
    /// 256 count as 256: each takes a place on the stack.
    /// Default value: 6.
    pub fn with_reflections(mut self, most: u32) -> Self {
        self.reflections = most.min(256);
        self
    }

    /// The first surface in front of the ray's origin.
    pub fn hit(&self, ray: &Ray) -> Option<Hit> {
        let mut list = Vec::new();
        let found = self.nearest(ray, &mut list)?;
        let point = ray.at(found.t);
        Some(Hit {
            t: found.t,
            point,
            normal: facing(found.leaf.normal(point), ray),
        })
    }

    /// Radiance that arrives at the ray's origin along it.
    pub fn radiance(&self, ray: &Ray) -> Rgb {
        let mut list = Vec::new();
        self.follow(ray, self.reflections, Rgb::WHITE, &mut list)
    }

    /// Follows a ray whose light counts `weight` in the end.
    fn follow<'a>(
        &'a self,
        ray: &Ray,
        mirrors: u32,
        weight: Rgb,
        list: &mut Boundaries<'a>,
    ) -> Rgb {
        let Some(found) = self.nearest(ray, list) else {
            return self.sky.radiance(ray.direction());
        };
        let surface = self.surface(ray, &found);
        let mirrored = surface
            .material
            .mirrored(-surface.normal.dot(ray.direction()));
        let below = (Rgb::WHITE - mirrored) * self.lit(ray, &surface, list);
        let weight = weight * mirrored;
        if weight.max_band() < NEGLIGIBLE {
            return below;
        }
        let direction = ray.direction().reflect(surface.normal);
        let light = if mirrors == 0 {
            self.sky.radiance(direction)
        } else {
            let mirror = Ray::new(surface.outside(direction), direction);
            self.follow(&mirror, mirrors - 1, weight, list)
        };
        below + mirrored * light
    }

    /// Light below the coat: of the sky and of the lamps that are not hidden.
    fn lit<'a>(&'a self, ray: &Ray, surface: &Surface<'a>, list: &mut Boundaries<'a>) -> Rgb {
        let diffuse = surface.material.color(surface.place);
        let mut light = surface.material.albedo(diffuse) * self.sky.radiance(surface.normal);
        for lamp in &self.lights {
            let arriving = lamp.at(surface.point);
            let cosine = surface.normal.dot(arriving.towards);
            // The bent normal says how bright, the true one which side.
            if cosine <= 0.0 || surface.true_normal.dot(arriving.towards) <= 0.0 {
                continue;
            }
            let shadow = Ray::new(surface.outside(arriving.towards), arriving.towards);
            if self.is_hidden(&shadow, arriving.distance, list) {
                continue;
            }
            let half = (arriving.towards - ray.direction()).normalize_or_zero();
            let brdf = surface.material.brdf(diffuse, surface.normal.dot(half));
            #[expect(clippy::cast_possible_truncation, reason = "a cosine")]
            let cosine = cosine as f32;
            light += brdf * arriving.irradiance * cosine;
        }
        light
    }

    fn surface<'a>(&'a self, ray: &Ray, found: &Found<'a>) -> Surface<'a> {
        let leaf = found.leaf;
        let point = ray.at(found.t);
        let true_normal = facing(leaf.normal(point), ray);
        let material = leaf.material.as_deref().unwrap_or(&self.default_material);
        let place = leaf.material_from_world.transform_point3(point);
        let normal = match material.bump_gradient(place) {
            Some(gradient) => bent(true_normal, leaf.world_gradient(gradient), ray),
            None => true_normal,
        };
        Surface {
            point,
            place,
            normal,
            true_normal,
            material,
        }
    }

    fn nearest<'a>(&'a self, ray: &Ray, list: &mut Boundaries<'a>) -> Option<Found<'a>> {
        let mut found = None;
        if !ray.is_cast() {
            return found;
        }
        let mut range = 0.0..f64::INFINITY;
        for solid in &self.unbounded {
            look_at(solid, ray, &mut range, list, &mut found);
        }
        if let Some(tree) = &self.bounded {
            tree.look(ray, &mut range, list, &mut found);
        }
        found
    }

    /// Whether there is anything before `distance`.
    fn is_hidden<'a>(&'a self, ray: &Ray, distance: f64, list: &mut Boundaries<'a>) -> bool {
        let range = 0.0..distance;
        let mut hides = |solid: &'a Solid| {
            let (mut range, mut found) = (range.clone(), None);
            look_at(solid, ray, &mut range, list, &mut found);
            found.is_some()
        };
        self.unbounded.iter().any(&mut hides)
            || self
                .bounded
                .as_ref()
                .is_some_and(|tree| tree.any(ray, &range, &mut hides))
    }
}

/// The nearest boundary so far.
#[derive(Debug, Clone, Copy)]
struct Found<'a> {
    t: f64,
    leaf: &'a Leaf,
}

/// What is to be shaded.
#[derive(Debug, Clone, Copy)]
struct Surface<'a> {
    point: DVec3,
    /// The point where the pattern is.
    place: DVec3,
    normal: DVec3,
    /// Without bumps.
    true_normal: DVec3,
    material: &'a Material,
}

impl Surface<'_> {
    /// A point just off the surface on the side of a direction.
    fn outside(&self, direction: DVec3) -> DVec3 {
        let side = self.true_normal.dot(direction).signum();
        let size = 1.0 + self.point.abs().max_element();
        self.point + self.true_normal * (side * OFFSET * size)
    }
}

/// The normal turned to the side that the ray comes from.
fn facing(normal: DVec3, ray: &Ray) -> DVec3 {
    if normal.dot(ray.direction()) > 0.0 {
        -normal
    } else {
        normal
    }
}

/// The normal of a surface raised by a height whose gradient in space is given: only its part along the surface
/// counts. Mikkelsen, *Bump mapping unparametrized surfaces on the GPU* (2010). It stays on the eye's side.
fn bent(normal: DVec3, gradient: DVec3, ray: &Ray) -> DVec3 {
    let along = gradient - normal * normal.dot(gradient);
    let bent = (normal - along).normalize_or(normal);
    let behind = bent.dot(ray.direction());
    if behind < 0.0 {
        return bent;
    }
    (bent - ray.direction() * (behind + 1e-3)).normalize_or(normal)
}

/// Looks for a boundary of a solid within `range` and, if there is one, shortens the range to it.
fn look_at<'a>(
    solid: &'a Solid,
    ray: &Ray,
    range: &mut Range<f64>,
    list: &mut Boundaries<'a>,
    found: &mut Option<Found<'a>>,
) {
    list.clear();
    solid.push_boundaries(ray, range, list);
    let first = list.iter().find(|b| b.t > range.start);
    if let Some(boundary) = first
        && let Some(leaf) = boundary.leaf
        && boundary.t < range.end
    {
        range.end = boundary.t;
        *found = Some(Found {
            t: boundary.t,
            leaf,
        });
    }
}

impl Branch {
    fn new(mut solids: Vec<Solid>) -> Option<Self> {
        if solids.len() < 2 {
            return solids.pop().map(|solid| Self {
                bounds: solid.bounds(),
                kind: Kind::Solid(Box::new(solid)),
            });
        }
        let axis = longest_axis(solids.iter().map(|s| s.bounds().centre()));
        let place = |s: &Solid| s.bounds().centre()[axis];
        solids.sort_by(|a, b| place(a).total_cmp(&place(b)));
        let upper = Self::new(solids.split_off(solids.len() / 2))?;
        let lower = Self::new(solids)?;
        Some(Self {
            bounds: lower.bounds.union(&upper.bounds),
            kind: Kind::Pair(Box::new([lower, upper])),
        })
    }

    fn look<'a>(
        &'a self,
        ray: &Ray,
        range: &mut Range<f64>,
        list: &mut Boundaries<'a>,
        found: &mut Option<Found<'a>>,
    ) {
        if !self.bounds.is_hit(ray, range) {
            return;
        }
        match &self.kind {
            Kind::Solid(solid) => look_at(solid, ray, range, list, found),
            Kind::Pair(pair) => {
                let way = pair[1].bounds.centre() - pair[0].bounds.centre();
                let nearer = usize::from(way.dot(ray.direction()) < 0.0);
                pair[nearer].look(ray, range, list, found);
                pair[1 - nearer].look(ray, range, list, found);
            }
        }
    }

    fn any<'a>(
        &'a self,
        ray: &Ray,
        range: &Range<f64>,
        is_found: &mut impl FnMut(&'a Solid) -> bool,
    ) -> bool {
        self.bounds.is_hit(ray, range)
            && match &self.kind {
                Kind::Solid(solid) => is_found(solid),
                Kind::Pair(pair) => pair.iter().any(|part| part.any(ray, range, is_found)),
            }
    }
}
