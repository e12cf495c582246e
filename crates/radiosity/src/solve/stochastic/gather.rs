//! Reflected light by gathering: rays from a receiver meet the surfaces that light it.
//!
//! A shot finds a receiver in proportion to its area, so what arrives at small ones is uncertain for long. Here each
//! receiver has as many rays as another, and those alone that are uncertain can have more. What rays find is the
//! radiosity of elements without what they emit: direct light comes by rays of its own.

use super::receivers::Receivers;
use super::shoot::REPLICATES;
use super::source::Source;
use crate::patch::PatchMesh;
use crate::sampling::{cosine_direction, hash};
use crate::sobol::Sobol4;
use crate::solution::BANDS;
use rayon::prelude::*;

/// What rays found.
pub(super) struct Gathered {
    /// Irradiance, `[receiver][channel]`.
    pub(super) irradiance: Vec<f32>,
    /// The same summed over channels, of each replicate alone.
    pub(super) replicates: Vec<[f32; REPLICATES]>,
    /// Rays that were cast.
    pub(super) rays: u64,
}

/// Casts rays from receivers.
pub(super) struct Gatherer {
    receivers: Receivers,
    /// Of a round in a replicate.
    rays: u32,
    seed: u64,
}

impl Gatherer {
    /// With about so many rays of a receiver in a round.
    pub(super) fn new(receivers: Receivers, rays: u32, seed: u64) -> Self {
        Self {
            receivers,
            rays: rays
                .div_ceil(crate::index32(REPLICATES))
                .next_power_of_two(),
            seed,
        }
    }

    /// Rays of a receiver in a round.
    pub(super) fn rays_of_round(&self) -> u64 {
        u64::from(self.rays) * REPLICATES as u64
    }

    /// One more round for the receivers of which `wanted` tells how many rounds they have had. Radiosity is
    /// `[element][channel]`.
    pub(super) fn round(
        &self,
        mesh: &PatchMesh,
        radiosity: &[f32],
        receivers: usize,
        wanted: impl Fn(usize) -> Option<u32> + Sync,
    ) -> Gathered {
        let channels = radiosity.len() / mesh.elements().len();
        let mut irradiance = vec![0.0; receivers * channels];
        let mut replicates = vec![[0.0; REPLICATES]; receivers];
        let cast = irradiance
            .par_chunks_exact_mut(channels)
            .zip(&mut replicates)
            .enumerate()
            .filter_map(|(receiver, (irradiance, replicates))| {
                let round = wanted(receiver)?;
                let first = round.wrapping_mul(self.rays);
                let place = Place::new(mesh, self.receivers, receiver)?;
                let mut sums = vec![0.0; channels];
                for (replicate, out) in replicates.iter_mut().enumerate() {
                    let seed = hash(hash(self.seed, receiver as u64), replicate as u64);
                    let sequence = Sobol4::new(seed);
                    let before: f64 = sums.iter().sum();
                    for ray in 0..self.rays {
                        let sample = sequence.point(first.wrapping_add(ray));
                        find(mesh, radiosity, &place, sample, &mut sums);
                    }
                    let found = sums.iter().sum::<f64>() - before;
                    *out = super::to_f32(found / f64::from(self.rays));
                }
                let count = f64::from(self.rays) * REPLICATES as f64;
                let pairs = irradiance.iter_mut().zip(&sums);
                pairs.for_each(|(out, sum)| *out = super::to_f32(sum / count));
                Some(self.rays_of_round())
            })
            .sum();
        Gathered {
            irradiance,
            replicates,
            rays: cast,
        }
    }
}

/// Adds what a ray finds.
fn find(
    mesh: &PatchMesh,
    radiosity: &[f32],
    place: &Place,
    [s, t, u, v]: [f32; 4],
    sums: &mut [f64],
) {
    let visibility = mesh.visibility();
    let channels = sums.len();
    let (element, rest) = place.choose(u);
    let normal = mesh.node(mesh.elements()[element]).normal;
    let point = mesh.exposed(element).point([rest, v]);
    let origin = visibility.off_surface(point, normal);
    let direction = cosine_direction(normal, [s, t]);
    visibility.follow(origin, direction, |hit, arriving, _| {
        let Some(met) = mesh.element_at(hit.face, hit.side, hit.point) else {
            return;
        };
        let radiosity = &radiosity[met * channels..(met + 1) * channels];
        for (channel, (sum, b)) in sums.iter_mut().zip(radiosity).enumerate() {
            *sum += f64::from(b * arriving[channel % BANDS]);
        }
    });
}

/// Where the rays of a receiver start.
enum Place {
    Element(usize),
    Patch(Source),
}

impl Place {
    /// None if nothing of it is exposed.
    fn new(mesh: &PatchMesh, receivers: Receivers, receiver: usize) -> Option<Self> {
        let area = |e: usize| f64::from(mesh.exposed_area(e));
        match receivers {
            Receivers::Elements => (area(receiver) > 0.0).then_some(Self::Element(receiver)),
            Receivers::Patches => {
                let source = Source::new(mesh, receiver, area);
                (source.total() > 0.0).then_some(Self::Patch(source))
            }
        }
    }

    /// An element in proportion to its area, and what is left of the number that chose it.
    fn choose(&self, sample: f32) -> (usize, f32) {
        match self {
            &Self::Element(element) => (element, sample),
            Self::Patch(source) => {
                let choice = source.choose(sample);
                (choice.element, choice.rest)
            }
        }
    }
}
