//! A view from inside a room.

use crate::auto_camera::{Bounds, look, looking};
use core::f32::consts::{PI, TAU};
use glam::{Vec2, Vec3};
use hemicube_radiosity::PatchMesh;
use hemicube_scene::Camera;
use rayon::prelude::*;
use std::collections::BTreeSet;

/// Vertical angle of view in degrees.
const FOV: f32 = 65.0;

/// Width by height of the picture that is imagined.
const ASPECT: f32 = 1.5;

/// Heights of eyes as shares of the box's height.
const HEIGHTS: [f32; 3] = [0.55, 0.4, 0.7];

/// Places along each horizontal side of the box.
const PLACES: u32 = 13;

/// Rays around an eye.
const RAYS: u32 = 1500;

/// Directions of view around an eye, level or a little down.
const AZIMUTHS: u32 = 24;
const TILTS: [f32; 3] = [-4.0, -10.0, -18.0];

/// Share of rays from an eye that must meet something, and of those that meet a lit side.
const ENCLOSED: f32 = 0.8;
const LIT: f32 = 0.8;

/// Share of a side of the box through which one looks into it from outside; with more the scene is no room.
const OPEN: f32 = 0.4;

/// Least height of a room as a share of the box's diagonal; what is lower is a slab: from inside one sees two stripes.
const LOWEST: f32 = 0.02;

/// Least distance from an eye to anything, as a share of the box's smallest side.
const CLEARANCE: f32 = 0.06;

/// What rays around an eye meet.
struct Surroundings {
    eye: Vec3,
    /// Direction, distance (infinite: nothing), lit side, instance.
    rays: Vec<Sight>,
}

struct Sight {
    direction: Vec3,
    distance: f32,
    lit: bool,
    instance: u32,
}

/// The best view from inside; `None` if there is no inside.
pub(crate) fn find(mesh: &PatchMesh, room: &Bounds) -> Option<Camera> {
    let is_flat = room.size().min_element() <= 1e-3 * room.diameter();
    let is_low = room.size().y < LOWEST * room.diameter();
    if is_flat || is_low || is_open(mesh, room) {
        return None;
    }
    let places: Vec<Vec3> = HEIGHTS
        .iter()
        .flat_map(|&height| grid(PLACES).map(move |p| Vec3::new(p.x, height, p.y)))
        .map(|shares| room.at(shares))
        .collect();
    let best_of_place = |eye: &Vec3| {
        let around = Surroundings::of(mesh, *eye);
        around
            .is_inside(CLEARANCE * room.size().min_element())
            .then(|| around.best_view(room))
    };
    let views: Vec<(f32, Camera)> = places.par_iter().filter_map(best_of_place).collect();
    views.into_iter().reduce(better).map(|(_, camera)| camera)
}

/// The view of the higher score; of equals the first.
fn better(first: (f32, Camera), second: (f32, Camera)) -> (f32, Camera) {
    if second.0 > first.0 { second } else { first }
}

/// The centres of `n × n` cells of the unit square.
fn grid(n: u32) -> impl Iterator<Item = Vec2> {
    let at = move |k: u32| (k as f32 + 0.5) / n as f32;
    (0..n * n).map(move |i| Vec2::new(at(i % n), at(i / n)))
}

/// Whether one looks through one of the upright sides of the box far into it, as into a box without a front, or past a
/// piece of furniture.
fn is_open(mesh: &PatchMesh, room: &Bounds) -> bool {
    let sides = [
        (Vec3::X, Vec3::Z),
        (Vec3::NEG_X, Vec3::Z),
        (Vec3::Z, Vec3::X),
        (Vec3::NEG_Z, Vec3::X),
    ];
    sides.into_iter().any(|(inward, along)| {
        let depth = room.size().dot(inward.abs());
        let n = 16;
        let through = |at: &Vec2| {
            let across = along * at.x + Vec3::Y * at.y;
            let start = if inward.max_element() > 0.0 { 0.0 } else { 1.0 };
            let origin = room.at(across + inward.abs() * start) - inward * (0.01 * depth);
            match look(mesh, origin, inward) {
                Some((hit, lit)) => lit && hit.distance > 0.3 * depth,
                None => true,
            }
        };
        grid(n).filter(through).count() as f32 > OPEN * (n * n) as f32
    })
}

impl Surroundings {
    fn of(mesh: &PatchMesh, eye: Vec3) -> Self {
        let sight = |i| {
            let direction = spherical_fibonacci(i, RAYS);
            match look(mesh, eye, direction) {
                Some((hit, lit)) => Sight {
                    direction,
                    distance: hit.distance,
                    lit,
                    instance: mesh.faces()[hit.face].instance,
                },
                None => Sight {
                    direction,
                    distance: f32::INFINITY,
                    lit: false,
                    instance: u32::MAX,
                },
            }
        };
        Self {
            eye,
            rays: (0..RAYS).map(sight).collect(),
        }
    }

    /// Whether the eye is in a room and not in a wall, nor right before one.
    fn is_inside(&self, clearance: f32) -> bool {
        let count = |matches: &dyn Fn(&Sight) -> bool| {
            self.rays.iter().filter(|s| matches(s)).count() as f32 / self.rays.len() as f32
        };
        let met = count(&|s| s.distance.is_finite());
        let lit = count(&|s| s.lit);
        let nearest = self
            .rays
            .iter()
            .map(|s| s.distance)
            .fold(f32::INFINITY, f32::min);
        met >= ENCLOSED && lit >= LIT * met && nearest >= clearance
    }

    fn best_view(&self, room: &Bounds) -> (f32, Camera) {
        let directions = TILTS.iter().flat_map(|tilt| {
            (0..AZIMUTHS)
                .map(move |k| direction(TAU * k as f32 / AZIMUTHS as f32, tilt.to_radians()))
        });
        let view = |forward: Vec3| {
            let camera = looking(self.eye, self.eye + forward, FOV);
            (self.score(&camera, room), camera)
        };
        directions
            .map(view)
            .reduce(better)
            .expect("there are directions")
    }

    /// Mean of `ln(1 + distance / near)` over the rays in the picture, 0 for those that see nothing or a dark side, less
    /// for what stands in the way, a little more for each thing that is seen.
    fn score(&self, camera: &Camera, room: &Bounds) -> f32 {
        let near = 0.05 * room.diameter();
        let half = (0.5 * FOV.to_radians()).tan();
        let (mut sum, mut count) = (0.0, 0.0);
        let mut things = BTreeSet::new();
        for sight in &self.rays {
            let along = sight.direction.dot(camera.forward);
            let x = sight.direction.dot(camera.right()) / along;
            let y = sight.direction.dot(camera.up) / along;
            if along <= 0.0 || x.abs() > half * ASPECT || y.abs() > half {
                continue;
            }
            count += 1.0;
            if sight.lit {
                sum += (1.0 + sight.distance / near).ln();
                things.insert(sight.instance);
            }
            if sight.distance < near {
                sum -= 1.0;
            }
        }
        sum / f32::max(count, 1.0) + 0.15 * (1.0 + things.len() as f32).ln()
    }
}

fn direction(azimuth: f32, tilt: f32) -> Vec3 {
    Vec3::new(
        azimuth.cos() * tilt.cos(),
        tilt.sin(),
        azimuth.sin() * tilt.cos(),
    )
}

/// Point `i` of `n` that are spread evenly over the unit sphere (Swinbank and Purser 2006).
fn spherical_fibonacci(i: u32, n: u32) -> Vec3 {
    let golden = 0.618_034 * TAU;
    let y = 1.0 - (2 * i + 1) as f32 / n as f32;
    // The angle is reduced first: far turns would cost the sine its digits.
    let azimuth = (i as f32 * golden) % TAU - PI;
    let radius = (1.0 - y * y).max(0.0).sqrt();
    Vec3::new(radius * azimuth.cos(), y, radius * azimuth.sin())
}
