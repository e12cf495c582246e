//! Light of new elements from the patches that shot it, a few hundred pairs for each.
//!
//! An element receives `H = Σ_p Φ_p F_pe / A_e` from what each patch has shot, `Φ_p`. Emitters are all asked. Of the
//! others some are drawn, with probability `q = min(1, g / τ)` by the guess `g = Φ cos cos / (π d² + A)` at the middles of
//! both, and count `1 / q` times: in mean that is the sum over all of them, and patches that matter are not left to
//! chance. What is drawn is spread evenly over the list of patches (systematic sampling), in which neighbours stand
//! together, and from the same start for all elements: neighbouring elements draw nearly the same patches, so that what is
//! wrong is wrong for all of them and makes no grain.

use crate::form_factor::RayCast;
use crate::form_factor::raycast::Shooter;
use crate::patch::{NodeId, PatchMesh};
use crate::sampling::point2;
use crate::solution::BANDS;
use crate::stop::Stop;
use core::f32::consts::PI;
use glam::Vec3;
use rayon::prelude::*;

/// How many times more rays go from an emitter to a new element at most: where a mesh is refined there are its shadows, and
/// their noise would look like contrast.
pub(super) const EMITTER_BOOST: f32 = 32.0;

/// How much is asked for the light of an element.
#[derive(Debug, Clone, Copy)]
pub(super) struct Effort {
    /// Patches that do not emit, on average.
    pub(super) pairs: f32,
    /// How many times more rays go from an emitter than from others.
    pub(super) emitter_boost: f64,
}

/// Patches that have shot something.
struct Sources {
    /// In a list of their own: each element runs through all of them.
    places: Vec<Place>,
    shooters: Vec<Shooter>,
    /// What each has shot in each channel.
    fluxes: Vec<Vec<f64>>,
}

/// Where a node is, roughly.
#[derive(Debug, Clone, Copy)]
struct Place {
    middle: Vec3,
    normal: Vec3,
    radius: f32,
    area: f32,
    /// What it has shot, over all channels.
    power: f32,
    is_emitter: bool,
}

impl Place {
    fn of(mesh: &PatchMesh, id: NodeId, power: f64) -> Self {
        let node = mesh.node(id);
        let polygon = mesh.polygon(id);
        let distances = polygon.iter().map(|c| c.distance(node.centroid));
        Self {
            middle: node.centroid,
            normal: node.normal,
            radius: distances.fold(0.0, f32::max),
            area: node.area,
            power: super::to_f32(power),
            is_emitter: false,
        }
    }

    /// About the irradiance that it brings to another place.
    fn guess_to(&self, other: &Self) -> f32 {
        let offset = other.middle - self.middle;
        // As far as any part of one is before the other.
        let heights = [
            self.normal.dot(offset) + other.radius,
            self.radius - other.normal.dot(offset),
        ];
        if heights[0] <= 0.0 || heights[1] <= 0.0 {
            return 0.0;
        }
        let squared = offset.length_squared();
        let distance = squared.sqrt();
        let cosine = |height: f32, radius: f32| (height / (distance + radius)).min(1.0);
        let cosines = cosine(heights[0], other.radius) * cosine(heights[1], self.radius);
        self.power * cosines / (PI * squared + self.area)
    }
}

/// Irradiance of some elements from what patches have shot, `[element][channel]`; `shot` holds the flux of each patch in
/// each channel. `None` if it was stopped.
pub(super) fn received(
    rays: &RayCast,
    elements: &[u32],
    shot: &[Vec<f64>],
    effort: Effort,
    seed: u64,
    stop: Stop<'_>,
) -> Option<Vec<Vec<f64>>> {
    let sources = Sources::new(rays.mesh_ref(), shot);
    let start = point2(0, seed)[0];
    let at = |&e: &u32| (!stop()).then(|| sources.bring_to(rays, e as usize, effort, start));
    elements.par_iter().map(at).collect()
}

impl Sources {
    fn new(mesh: &PatchMesh, shot: &[Vec<f64>]) -> Self {
        let power = |patch: usize| shot[patch].iter().map(|flux| flux.abs()).sum::<f64>();
        let patches: Vec<usize> = (0..shot.len()).filter(|&p| power(p) > 0.0).collect();
        let place = |&patch: &usize| Place {
            is_emitter: mesh
                .elements_of_patch(patch)
                .any(|e| !mesh.emission()[e].is_black()),
            ..Place::of(mesh, mesh.patches()[patch], power(patch))
        };
        let shooter = |&patch: &usize| Shooter::new(mesh, mesh.patches()[patch]);
        Self {
            places: patches.iter().map(place).collect(),
            shooters: patches.par_iter().map(shooter).collect(),
            fluxes: patches.iter().map(|&patch| shot[patch].clone()).collect(),
        }
    }

    /// Irradiance of an element in each channel.
    fn bring_to(&self, rays: &RayCast, e: usize, effort: Effort, start: f32) -> Vec<f64> {
        let mesh = rays.mesh_ref();
        let id = mesh.elements()[e];
        let area = f64::from(mesh.exposed_area(e));
        let mut light = vec![0.0; self.fluxes.first().map_or(0, Vec::len)];
        for (i, chance) in self.drawn(&Place::of(mesh, id, 0.0), effort.pairs, start) {
            let boost = if self.places[i].is_emitter {
                effort.emitter_boost
            } else {
                1.0
            };
            let factor = rays.pair_at_points(&self.shooters[i], e, id, boost);
            let scale = factor.unoccluded / (area * f64::from(chance));
            for (channel, (light, flux)) in light.iter_mut().zip(&self.fluxes[i]).enumerate() {
                *light += flux * scale * f64::from(factor.visible[channel % BANDS]);
            }
        }
        light
    }

    /// Those to ask for the light at a place, with the chance that each had.
    fn drawn(&self, place: &Place, pairs: f32, start: f32) -> Vec<(usize, f32)> {
        let guesses: Vec<f32> = self.places.iter().map(|p| p.guess_to(place)).collect();
        let pairs_of = || self.places.iter().zip(&guesses);
        let others = pairs_of().filter(|(source, _)| !source.is_emitter);
        let tau = others.map(|(_, guess)| guess).sum::<f32>() / pairs;
        let mut drawn = Vec::new();
        let mut ticks = start;
        for (i, (source, &guess)) in pairs_of().enumerate().filter(|(_, (_, g))| **g > 0.0) {
            if source.is_emitter {
                drawn.push((i, 1.0));
                continue;
            }
            let chance = (guess / tau).min(1.0);
            ticks += chance;
            if ticks >= 1.0 {
                ticks -= 1.0;
                drawn.push((i, chance));
            }
        }
        drawn
    }
}
