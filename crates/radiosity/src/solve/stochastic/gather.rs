//! Reflected light by gathering: rays from a receiver meet the surfaces that light it.
//!
//! A shot finds a receiver in proportion to its area, so what arrives at small ones is uncertain for long. Here each
//! receiver has as many rays as another, and those alone that are uncertain can have more. What rays find is the
//! radiosity of elements without what they emit, direct light comes by rays of its own, and without what is left to
//! [highlights](super::highlights), but for those that nearly touch.

use super::emitters::place_of;
use super::estimates::{Brought, LEAST_RAYS, Round};
use super::highlights::Highlights;
use super::lights::Place;
use super::receivers::Start;
use crate::patch::PatchMesh;
use crate::sampling::{cosine_direction, hash};
use crate::sobol::Sobol4;
use crate::solution::BANDS;
use rayon::prelude::*;

/// Independent parts of a round, whose differences tell the error.
const REPLICATES: u32 = 2;
/// Backs that only absorb count as so many times nearer than they are: an element that sees them is in a body or under one,
/// where the others of its patch may be out in the open.
const BEHIND: f32 = 8.0;
const _: () = assert!(LEAST_RAYS.is_multiple_of(REPLICATES), "each has rays");

/// What rays find.
pub(super) struct Scenery<'a> {
    pub(super) mesh: &'a PatchMesh,
    /// What is left to shadow rays, if anything is.
    pub(super) highlights: Option<&'a Highlights>,
    /// `[element][channel]`.
    pub(super) radiosity: &'a [f32],
    pub(super) channels: usize,
}

/// What the rays of a round found.
pub(super) struct Found {
    pub(super) light: Brought,
    /// Sums of the inverse distances of what each element's rays met first.
    pub(super) nearness: Vec<f32>,
}

impl Scenery<'_> {
    /// One more round of rays from elements.
    pub(super) fn gather(&self, round: Round<'_>, seed: u64) -> Found {
        let mut light = Brought::nothing(round.wanted.len(), self.channels);
        let mut nearness = vec![0.0; round.wanted.len()];
        light.rays = light
            .irradiance
            .par_chunks_exact_mut(self.channels)
            .zip(&mut light.squares)
            .zip(&mut nearness)
            .enumerate()
            .map(|(element, ((irradiance, square), nearness))| {
                let rays = round.wanted[element];
                let start = Start::new(self.mesh, element);
                let Some(start) = start.filter(|_| rays > 0) else {
                    return 0;
                };
                let seed = hash(seed, element as u64);
                let seed = hash(seed, u64::from(round.before[element]));
                let mut sums = vec![0.0; self.channels];
                (*square, *nearness) = self.gather_at(element, &start, rays, seed, &mut sums);
                let pairs = irradiance.iter_mut().zip(&sums);
                pairs.for_each(|(out, sum)| *out = super::to_f32(sum / f64::from(rays)));
                u64::from(rays)
            })
            .sum();
        Found { light, nearness }
    }

    /// Adds what arrives at an element by each of its rays; the squared error of the mean, all channels together, and the
    /// sum of inverse distances.
    fn gather_at(
        &self,
        element: usize,
        start: &Start,
        rays: u32,
        seed: u64,
        sums: &mut [f64],
    ) -> (f32, f32) {
        let patch = self.mesh.patch_of_element(element);
        let place = place_of(self.mesh, self.mesh.patches()[patch]);
        let each = rays / REPLICATES;
        let mut nearness = 0.0;
        let replicates = core::array::from_fn(|replicate| {
            let sequence = Sobol4::new(hash(seed, replicate as u64));
            let before: f64 = sums.iter().sum();
            for ray in 0..each {
                nearness += self.find(&place, start, sequence.point(ray), sums);
            }
            (sums.iter().sum::<f64>() - before) / f64::from(each)
        });
        (super::to_f32(square_of_mean(replicates)), nearness)
    }

    /// Adds what a ray finds; the inverse distance of what it meets first.
    fn find(&self, place: &Place, start: &Start, [s, t, u, v]: [f32; 4], sums: &mut [f64]) -> f32 {
        let visibility = self.mesh.visibility();
        let (point, normal) = start.point([u, v]);
        let origin = visibility.off_surface(point, normal);
        let direction = cosine_direction(normal, [s, t]);
        let mut nearness = None;
        visibility.follow(origin, direction, |hit, arriving, _| {
            let met = self.mesh.element_at(hit.face, hit.side, hit.point);
            let weight = if met.is_some() { 1.0 } else { BEHIND };
            let distance = origin.distance(hit.point).max(f32::MIN_POSITIVE);
            nearness.get_or_insert(weight / distance);
            let Some(met) = met else {
                return;
            };
            let range = met * self.channels..(met + 1) * self.channels;
            let taken = self.highlights;
            let taken = taken.map_or(&[][..], |taken| taken.of_element(self.mesh, met, place));
            for (channel, (sum, b)) in sums.iter_mut().zip(&self.radiosity[range]).enumerate() {
                let rest = b - taken.get(channel).copied().unwrap_or(0.0);
                *sum += f64::from(rest * arriving[channel % BANDS]);
            }
        });
        nearness.unwrap_or(0.0)
    }
}

/// Squared standard error of the mean of independent estimates.
fn square_of_mean(values: [f64; REPLICATES as usize]) -> f64 {
    let n = f64::from(REPLICATES);
    let mean = values.iter().sum::<f64>() / n;
    values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n * (n - 1.0))
}
