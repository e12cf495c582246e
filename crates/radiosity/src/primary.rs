//! Light that no surface emits: points, spots, the sun and the sky, with visibility.

use crate::band_sum::BandSum;
use crate::error::RadiosityError;
use crate::patch::PatchMesh;
use crate::patch::exposure::ExposedArea;
use crate::sampling::{cosine_direction, hash, point2, point4};
use crate::stop::{NEVER, Stop};
use crate::visibility::Visibility;
use core::f32::consts::PI;
use glam::Vec3;
use hemicube_raster::Rgb;
use hemicube_scene::LightKind;
use rayon::prelude::*;

/// Shadow rays of each element to each light.
const SHADOW_RAYS: u32 = 8;
/// Lights above which each takes fewer.
const MANY_LIGHTS: usize = 64;

/// Irradiance of each element from the scene's lights and sky, before any reflection: lx or W/m².
///
/// Each light takes eight shadow rays an element, two if there are more than 64 lights; the sky takes `sky_rays` over the hemisphere. What
/// panes let through is in it.
pub fn primary_irradiance(mesh: &PatchMesh, sky_rays: u32, seed: u64) -> Vec<Rgb> {
    primary_irradiance_until(mesh, sky_rays, seed, NEVER).expect("nobody stops it")
}

/// As [`primary_irradiance`], unless it is stopped.
///
/// # Errors
/// [`RadiosityError::Stopped`].
pub fn primary_irradiance_until(
    mesh: &PatchMesh,
    sky_rays: u32,
    seed: u64,
    stop: Stop<'_>,
) -> Result<Vec<Rgb>, RadiosityError> {
    let visibility = mesh.visibility();
    let scene = mesh.scene();
    if scene.lights.is_empty() && scene.sky.is_black() {
        return Ok(vec![Rgb::BLACK; mesh.elements().len()]);
    }
    let irradiance: Option<Vec<Rgb>> =
        mesh.elements()
            .par_iter()
            .enumerate()
            .map(|(e, &id)| {
                if stop() {
                    return None;
                }
                let area = mesh.exposed(e);
                let normal = mesh.node(id).normal;
                let seed = hash(u64::from(id.0), seed);
                let rays = if scene.lights.len() > MANY_LIGHTS {
                    2
                } else {
                    SHADOW_RAYS
                };
                let lights = scene.lights.iter().map(|light| {
                    light_on_element(visibility, &light.kind, &area, normal, rays, seed)
                });
                let mut irradiance: Rgb = lights.sum();
                if !scene.sky.is_black() {
                    let rays = sky_rays.max(1);
                    let mut open = BandSum::default();
                    for i in 0..rays {
                        let [u, v, s, t] = point4(i, seed);
                        open.add(sky_share(visibility, area.point([u, v]), normal, [s, t]));
                    }
                    irradiance += scene.sky * open.mean(rays) * PI;
                }
                Some(irradiance)
            })
            .collect();
    irradiance.ok_or(RadiosityError::Stopped("while first light fell"))
}

/// Mean irradiance of an element from one light, with visibility.
///
/// From a point the unoccluded mean is exact, `I Ω / A`, however near the light is; rays weighted by `cos / r²` tell the
/// share that arrives, and a spot's falloff.
fn light_on_element(
    visibility: &Visibility,
    light: &LightKind,
    area: &ExposedArea,
    normal: Vec3,
    rays: u32,
    seed: u64,
) -> Rgb {
    let (mut arriving, mut weights) = (Rgb::BLACK, 0.0);
    for i in 0..rays {
        let point = area.point(point2(i, seed));
        arriving += from_light(visibility, light, point, normal);
        let (_, to_light, distance) = light.arriving_at(point);
        weights += to_light.dot(normal).max(0.0) / (distance * distance);
    }
    match *light {
        LightKind::Directional { .. } => arriving / rays as f32,
        LightKind::Point { position, .. } | LightKind::Spot { position, .. } if weights > 0.0 => {
            arriving / weights * (solid_angle(area.polygon(), position) / area.whole_area())
        }
        _ => Rgb::BLACK,
    }
}

/// Solid angle of a planar convex polygon (Van Oosterom, Strackee 1983, over a fan of triangles).
#[expect(clippy::cast_possible_truncation, reason = "light is kept in f32")]
fn solid_angle(polygon: &[Vec3], from: Vec3) -> f32 {
    let corner = |i: usize| (polygon[i] - from).as_dvec3();
    let of_triangle = |i: usize| {
        let (a, b, c) = (corner(0), corner(i), corner(i + 1));
        let (la, lb, lc) = (a.length(), b.length(), c.length());
        let below = la * lb * lc + a.dot(b) * lc + a.dot(c) * lb + b.dot(c) * la;
        2.0 * a.dot(b.cross(c)).abs().atan2(below)
    };
    (1..polygon.len() - 1).map(of_triangle).sum::<f64>() as f32
}

/// Irradiance at a point of a surface from one light, with visibility.
pub fn from_light(visibility: &Visibility, light: &LightKind, point: Vec3, normal: Vec3) -> Rgb {
    let (facing, to_light, distance) = light.arriving_at(point);
    let cosine = to_light.dot(normal);
    if cosine <= 0.0 || facing.is_black() {
        return Rgb::BLACK;
    }
    let origin = visibility.off_surface(point, normal);
    let target = if distance.is_finite() {
        origin + to_light * (distance * 0.9999)
    } else {
        origin + to_light * (2.0 * visibility.diameter())
    };
    facing * visibility.transmittance(origin, target) * cosine
}

/// Share of the sky's light that one cosine-distributed ray brings.
pub fn sky_share(visibility: &Visibility, point: Vec3, normal: Vec3, sample: [f32; 2]) -> Rgb {
    let origin = visibility.off_surface(point, normal);
    visibility.transmittance(
        origin,
        origin + cosine_direction(normal, sample) * (2.0 * visibility.diameter()),
    )
}
