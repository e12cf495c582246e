//! Light that no surface emits: points, spots, the sun and the sky, with visibility.

use crate::band_sum::BandSum;
use crate::patch::PatchMesh;
use crate::sampling::{cosine_direction, hash, point2, point4};
use crate::visibility::Visibility;
use core::f32::consts::PI;
use glam::Vec3;
use hemicube_raster::Rgb;
use hemicube_scene::LightKind;
use rayon::prelude::*;

/// Shadow rays of each element to each light.
const SHADOW_RAYS: u32 = 8;

/// Irradiance of each element from the scene's lights and sky, before any reflection: lx or W/m².
///
/// Points and suns take eight shadow rays an element and light; the sky takes `sky_rays` over the hemisphere. What
/// panes let through is in it.
pub fn primary_irradiance(mesh: &PatchMesh, sky_rays: u32, seed: u64) -> Vec<Rgb> {
    let visibility = mesh.visibility();
    let scene = mesh.scene();
    if scene.lights.is_empty() && scene.sky.is_black() {
        return vec![Rgb::BLACK; mesh.elements().len()];
    }
    mesh.elements()
        .par_iter()
        .enumerate()
        .map(|(e, &id)| {
            let area = mesh.exposed(e);
            let normal = mesh.node(id).normal;
            let seed = hash(u64::from(id.0), seed);
            let lights = scene.lights.iter().map(|light| {
                let rays = if scene.lights.len() > 64 {
                    2
                } else {
                    SHADOW_RAYS
                };
                let sum: Rgb = (0..rays)
                    .map(|i| {
                        from_light(visibility, &light.kind, area.point(point2(i, seed)), normal)
                    })
                    .sum();
                sum / rays as f32
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
            irradiance
        })
        .collect()
}

/// Irradiance at a point of a surface from one light, with visibility.
pub fn from_light(visibility: &Visibility, light: &LightKind, point: Vec3, normal: Vec3) -> Rgb {
    let (facing, to_light, distance) = light.arriving_at(point);
    let cosine = to_light.dot(normal);
    if cosine <= 0.0 || facing.is_black() {
        return Rgb::BLACK;
    }
    let origin = point + normal * Visibility::offset(point);
    let target = if distance.is_finite() {
        origin + to_light * (distance * 0.9999)
    } else {
        origin + to_light * (2.0 * visibility.diameter())
    };
    facing * visibility.transmittance(origin, target) * cosine
}

/// Share of the sky's light that one cosine-distributed ray brings.
pub fn sky_share(visibility: &Visibility, point: Vec3, normal: Vec3, sample: [f32; 2]) -> Rgb {
    let origin = point + normal * Visibility::offset(point);
    visibility.transmittance(
        origin,
        origin + cosine_direction(normal, sample) * (2.0 * visibility.diameter()),
    )
}
