//! Reflected light by gathering: rays from a receiver meet the surfaces that light it.
//!
//! A shot finds a receiver in proportion to its area, so what arrives at small ones is uncertain for long. Here each
//! receiver has as many rays as another, and those alone that are uncertain can have more. What rays find is the
//! radiosity of elements without what they emit, direct light comes by rays of its own, and without what is left to
//! [highlights](super::highlights), but for those that nearly touch.

use super::emitters::place_of;
use super::estimates::{Brought, LEAST_RAYS, Round};
use super::guides::{Drawn, Guide, Guides, Learnt, in_order_of_cells};
use super::highlights::Highlights;
use super::lights::Place;
use super::receivers::{Start, by_patch};
use crate::patch::PatchMesh;
use crate::sampling::{cosine_direction, hash};
use crate::sobol::Sobol4;
use crate::solution::BANDS;
use rayon::prelude::*;

/// Independent parts of a round, whose differences tell the error.
const REPLICATES: usize = 2;
/// Rays of a patch that are put in order together, about.
const RAYS_AT_ONCE: usize = 1 << 16;
/// Backs that only absorb count as so many times nearer than they are: an element that sees them is in a body or under one,
/// where the others of its patch may be out in the open.
const BEHIND: f32 = 8.0;
const _: () = assert!(
    (LEAST_RAYS as usize).is_multiple_of(REPLICATES),
    "each has rays"
);

/// What rays find.
pub(super) struct Scenery<'a> {
    pub(super) mesh: &'a PatchMesh,
    /// What is left to shadow rays, if anything is.
    pub(super) highlights: Option<&'a Highlights>,
    /// `[element][channel]`.
    pub(super) radiosity: &'a [f32],
    pub(super) channels: usize,
}

/// Where goes what the elements of a patch gather.
struct Slots<'a> {
    /// `[element][channel]`.
    irradiance: &'a mut [f32],
    /// Squared errors of the means, all channels together.
    squares: &'a mut [f32],
    nearness: &'a mut [f32],
}

/// A ray to be cast.
#[derive(Debug, Clone, Copy)]
struct Ray {
    /// Position among the elements of the patch, and which part of its rays it is one of.
    element: usize,
    replicate: usize,
    drawn: Drawn,
    /// Chooses the point that it starts from.
    sample: [f32; 2],
}

/// What the elements of a patch gather.
struct Gathering<'a> {
    place: Place,
    guide: Guide,
    learnt: &'a mut Learnt,
    /// `[element][replicate][channel]`.
    sums: Vec<f64>,
    starts: Vec<Option<Start>>,
    rays: Vec<Ray>,
}

/// What a ray met.
struct Met {
    /// Inverse distance of the first surface.
    nearness: f32,
    /// Light, summed over channels.
    brought: f32,
}

/// What the rays of a round found.
pub(super) struct Found {
    pub(super) light: Brought,
    /// Sums of the inverse distances of what each element's rays met first.
    pub(super) nearness: Vec<f32>,
}

impl Scenery<'_> {
    /// One more round of rays from elements, by what is known of where light comes from, to which they add.
    pub(super) fn gather(&self, round: Round<'_>, seed: u64, guides: &mut Guides) -> Found {
        let mut light = Brought::nothing(round.wanted.len(), self.channels);
        let mut nearness = vec![0.0; round.wanted.len()];
        let slots = by_patch(self.mesh, &mut light.irradiance, self.channels)
            .into_par_iter()
            .zip(by_patch(self.mesh, &mut light.squares, 1))
            .zip(by_patch(self.mesh, &mut nearness, 1));
        light.rays = slots
            .zip(guides.of_patches())
            .enumerate()
            .map(|(patch, (((irradiance, squares), nearness), learnt))| {
                let to = Slots {
                    irradiance,
                    squares,
                    nearness,
                };
                self.gather_at(patch, round, seed, learnt, to)
            })
            .sum();
        Found { light, nearness }
    }

    /// Gathers what arrives at the elements of a patch; the rays it took.
    fn gather_at(
        &self,
        patch: usize,
        round: Round<'_>,
        seed: u64,
        learnt: &mut Learnt,
        to: Slots<'_>,
    ) -> u64 {
        let elements = self.mesh.elements_of_patch(patch);
        let wanted = &round.wanted[elements.clone()];
        if wanted.iter().all(|&rays| rays == 0) {
            return 0;
        }
        let mut gathering = Gathering {
            place: place_of(self.mesh, self.mesh.patches()[patch]),
            guide: learnt.guide(),
            learnt,
            sums: vec![0.0; wanted.len() * REPLICATES * self.channels],
            starts: elements.clone().map(|e| Start::new(self.mesh, e)).collect(),
            rays: Vec::new(),
        };
        let mut cast = 0;
        for (i, element) in elements.enumerate() {
            let seed = hash(seed, element as u64);
            let seed = hash(seed, u64::from(round.before[element]));
            gathering.aim(i, wanted[i], seed);
            if gathering.rays.len() >= RAYS_AT_ONCE || i + 1 == wanted.len() {
                cast += gathering.rays.len() as u64;
                self.cast(&mut gathering, to.nearness);
            }
        }
        gathering.write(wanted, self.channels, to);
        cast
    }

    /// Casts the rays that were aimed, those of a cell after each other: they meet nearly the same, which the processor
    /// then has at hand. Of a few rays of each element a fifth more are cast in a second.
    fn cast(&self, gathering: &mut Gathering<'_>, nearness: &mut [f32]) {
        let rays = in_order_of_cells(&gathering.rays, |ray| ray.drawn.cell);
        gathering.rays.clear();
        for ray in rays {
            let Some(start) = &gathering.starts[ray.element] else {
                continue;
            };
            let sums = (ray.element * REPLICATES + ray.replicate) * self.channels;
            let sums = &mut gathering.sums[sums..sums + self.channels];
            let met = self.find(start, &gathering.place, &ray, sums);
            nearness[ray.element] += met.nearness * ray.drawn.weight;
            gathering.learnt.add(ray.drawn.cell, met.brought);
        }
    }

    /// Adds what a ray finds by its weight.
    fn find(&self, start: &Start, place: &Place, ray: &Ray, sums: &mut [f64]) -> Met {
        let visibility = self.mesh.visibility();
        let (point, normal) = start.point(ray.sample);
        let origin = visibility.off_surface(point, normal);
        let direction = cosine_direction(normal, ray.drawn.place);
        let mut nearness = None;
        let mut brought = 0.0;
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
                let light = rest * arriving[channel % BANDS];
                *sum += f64::from(light * ray.drawn.weight);
                brought += light;
            }
        });
        Met {
            nearness: nearness.unwrap_or(0.0),
            brought,
        }
    }
}

impl Gathering<'_> {
    /// So many rays from an element, if any of it is exposed.
    fn aim(&mut self, element: usize, rays: u32, seed: u64) {
        if self.starts[element].is_none() {
            return;
        }
        for replicate in 0..REPLICATES {
            let sequence = Sobol4::new(hash(seed, replicate as u64));
            for ray in 0..rays / crate::index32(REPLICATES) {
                let [s, t, u, v] = sequence.point(ray);
                self.rays.push(Ray {
                    element,
                    replicate,
                    drawn: self.guide.draw([s, t]),
                    sample: [u, v],
                });
            }
        }
    }

    /// Means over as many rays as were wanted, and what their parts say of the error.
    fn write(&self, wanted: &[u32], channels: usize, to: Slots<'_>) {
        let sums = self.sums.chunks_exact(REPLICATES * channels);
        let slots = to.irradiance.chunks_exact_mut(channels).zip(to.squares);
        for ((sums, (irradiance, square)), &rays) in sums.zip(slots).zip(wanted) {
            let rays = f64::from(rays.max(1));
            let each = rays / REPLICATES as f64;
            let mean = |replicate: usize| {
                let sums = &sums[replicate * channels..][..channels];
                sums.iter().sum::<f64>() / each
            };
            *square = super::to_f32(square_of_mean(core::array::from_fn(mean)));
            for (channel, out) in irradiance.iter_mut().enumerate() {
                let sum: f64 = sums.iter().skip(channel).step_by(channels).sum();
                *out = super::to_f32(sum / rays);
            }
        }
    }
}

/// Squared standard error of the mean of independent estimates.
fn square_of_mean(values: [f64; REPLICATES]) -> f64 {
    let n = REPLICATES as f64;
    let mean = values.iter().sum::<f64>() / n;
    values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n * (n - 1.0))
}
