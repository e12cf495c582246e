//! A view from outside, for objects in free space and boxes with an open front.

use crate::auto_camera::{Bounds, look, looking};
use core::f32::consts::TAU;
use glam::Vec3;
use hemicube_radiosity::PatchMesh;
use hemicube_scene::Camera;
use rayon::prelude::*;

/// Vertical angle of view in degrees.
const FOV: f32 = 40.0;

/// The frame around the box, as a factor on the distance.
const MARGIN: f32 = 1.08;

/// Directions from the scene to the eye, in degrees above the horizon with a bonus: straight in front is for scenes that
/// are open to one side, a little above shows most things best.
const ELEVATIONS: [(f32, f32); 2] = [(22.0, 1.05), (0.0, 1.0)];
const AZIMUTHS: u32 = 24;

/// Bonus of directions well off the axes, which show two sides of things.
const OBLIQUE: f32 = 1.06;

/// Rays along each side of the imagined picture.
const RAYS: u32 = 40;

/// The view from outside that shows most.
pub(crate) fn find(mesh: &PatchMesh, object: &Bounds) -> Camera {
    // The first direction, which wins among equals, sees the front and the right side.
    let directions: Vec<(Vec3, f32)> = ELEVATIONS
        .iter()
        .flat_map(|&(elevation, bonus)| {
            (0..AZIMUTHS).map(move |k| {
                let step = (k + 2) % AZIMUTHS;
                let azimuth = TAU * step as f32 / AZIMUTHS as f32;
                let oblique = matches!(step % (AZIMUTHS / 4), 2..=4);
                let bonus = if oblique { bonus * OBLIQUE } else { bonus };
                (towards_eye(azimuth, elevation.to_radians()), bonus)
            })
        })
        .collect();
    let seen: Vec<f32> = directions
        .par_iter()
        .map(|(towards_eye, bonus)| bonus * seen_area(mesh, object, *towards_eye))
        .collect();
    // Of equal views the first counts; a view must be better by more than the rays' error to replace one.
    let mut best = 0;
    for (i, &area) in seen.iter().enumerate() {
        if area > 1.01 * seen[best] {
            best = i;
        }
    }
    framed(mesh, object, directions[best].0)
}

/// Azimuth 0 looks along -Z, the front view of most models.
fn towards_eye(azimuth: f32, elevation: f32) -> Vec3 {
    Vec3::new(
        azimuth.sin() * elevation.cos(),
        elevation.sin(),
        azimuth.cos() * elevation.cos(),
    )
}

/// Area of lit sides that is seen first in a parallel projection. What lies deep inside the box counts up to nine times:
/// one looks into things rather than at their backs. Dark sides, which pictures leave out, count against a view.
fn seen_area(mesh: &PatchMesh, object: &Bounds, towards_eye: Vec3) -> f32 {
    let camera = looking(object.centre() + towards_eye, object.centre(), FOV);
    let radius = 0.5 * object.diameter();
    let at = |k: u32| ((k as f32 + 0.5) / RAYS as f32 * 2.0 - 1.0) * radius;
    let ray = |i: u32| {
        let across = camera.right() * at(i % RAYS) + camera.up * at(i / RAYS);
        let origin = object.centre() + across + towards_eye * (1.1 * radius);
        match look(mesh, origin, -towards_eye) {
            Some((hit, true)) => 1.0 + 4.0 * depth_inside(object, hit.point, towards_eye) / radius,
            Some((_, false)) => -2.0,
            None => 0.0,
        }
    };
    (0..RAYS * RAYS).map(ray).sum()
}

/// Distance from a point in the box to its border in a direction.
fn depth_inside(object: &Bounds, point: Vec3, direction: Vec3) -> f32 {
    let to_border = |k: usize| {
        let border = if direction[k] > 0.0 {
            object.high[k]
        } else {
            object.low[k]
        };
        let distance = (border - point[k]) / direction[k];
        if direction[k].abs() < 1e-6 {
            f32::INFINITY
        } else {
            distance.max(0.0)
        }
    };
    to_border(0).min(to_border(1)).min(to_border(2))
}

/// A camera in this direction from which all faces fit into any picture that is at least as wide as high.
fn framed(mesh: &PatchMesh, object: &Bounds, towards_eye: Vec3) -> Camera {
    let view = looking(object.centre() + towards_eye, object.centre(), FOV);
    let corners = || mesh.faces().iter().flat_map(|face| face.polygon());
    // The middle of what is seen, not of the box, is the middle of the picture.
    let middle = |axis: Vec3| {
        let along = corners().map(|corner| corner.dot(axis));
        let (low, high) = along.fold((f32::INFINITY, f32::NEG_INFINITY), |(low, high), x| {
            (low.min(x), high.max(x))
        });
        axis * (0.5 * (low + high))
    };
    let target = middle(view.right()) + middle(view.up) + middle(towards_eye);
    let half = (0.5 * FOV.to_radians()).tan();
    let distance = corners().map(|&corner| {
        let offset = corner - target;
        let across = offset
            .dot(view.right())
            .abs()
            .max(offset.dot(view.up).abs());
        MARGIN * across / half + offset.dot(towards_eye)
    });
    let distance = distance.fold(0.0, f32::max).max(1e-3 * object.diameter());
    looking(target + towards_eye * distance, target, FOV)
}
