//! One step of Jacobi's iteration by rays: everything that patches shoot is carried to where it arrives.
//!
//! Each patch casts rays in proportion to the flux that it shoots, from its elements in proportion to theirs, in
//! cosine-distributed directions; all rays of a patch carry the same magnitude, so bright patches are followed more
//! closely. A ray needs its first hit and no form factor.

use super::receivers::Receivers;
use super::source::Source;
use super::tally::Tally;
use crate::patch::PatchMesh;
use crate::sampling::{cosine_direction, hash};
use crate::sobol::Sobol4;
use crate::solution::BANDS;
use hemicube_raster::Rgb;
use rayon::prelude::*;

/// Rays of a patch that are one piece of work.
const RAYS_AT_ONCE: u32 = 4096;
/// Panes that keep less of the light than this receive nothing.
const LEAST_KEPT: f32 = 1.0 / 1024.0;
/// Most rays of one patch in one step.
const MOST_RAYS_OF_PATCH: f64 = (1_u32 << 28) as f64;

/// What arrived.
pub(super) struct Arrived {
    /// Flux to each receiver, `[channel][receiver]`, divided by what it keeps.
    pub(super) received: Vec<f64>,
    /// Flux to sides that only absorb, by channel.
    pub(super) backs: Vec<f64>,
    /// Flux that met nothing, by channel.
    pub(super) escaped: Vec<f64>,
    /// Rays that were cast.
    pub(super) rays: u64,
}

impl Arrived {
    /// Adds what constant radiosities, by channel, bring to receivers of such areas where nothing is lost.
    pub(super) fn add_constants(&mut self, areas: &[f64], constants: &[f32]) {
        for (channel, &constant) in constants.iter().enumerate() {
            let received = self.received[channel * areas.len()..].iter_mut().zip(areas);
            received.for_each(|(flux, area)| *flux += f64::from(constant) * area);
        }
    }
}

/// Casts rays, and goes on with the sequences of the patches from step to step.
pub(super) struct Shooter {
    receivers: Receivers,
    /// Exposed areas of the receivers.
    areas: Vec<f64>,
    seed: u64,
    /// Rays that each patch has cast.
    cast: Vec<u32>,
}

/// A piece of work: some rays of a patch.
struct Job<'a> {
    patch: usize,
    source: &'a Source,
    /// What each ray carries: this share of the patch's magnitude.
    share: f64,
    rays: core::ops::Range<u32>,
}

impl Job<'_> {
    fn count(&self) -> u64 {
        u64::from(self.rays.end.wrapping_sub(self.rays.start))
    }
}

impl Shooter {
    pub(super) fn new(mesh: &PatchMesh, receivers: Receivers, seed: u64) -> Self {
        Self {
            receivers,
            areas: receivers.areas(mesh),
            seed,
            cast: vec![0; mesh.patches().len()],
        }
    }

    /// Shoots a radiosity, `[channel][element]`, by about so many rays and at least one of each patch that shoots.
    /// It may be negative. What arrives is made to be what left to the last bit, channel by channel: rays of an element of
    /// one colour do not carry exactly its share.
    pub(super) fn shoot(&mut self, mesh: &PatchMesh, radiosity: &[f32], rays: u64) -> Arrived {
        let elements = mesh.elements().len();
        let channels = radiosity.len() / elements;
        let magnitude = |e: usize| {
            let sum: f32 = (0..channels)
                .map(|c| radiosity[c * elements + e].abs())
                .sum();
            f64::from(sum) * f64::from(mesh.exposed_area(e))
        };
        let patches = 0..mesh.patches().len();
        let sources: Vec<Source> = patches
            .into_par_iter()
            .map(|patch| Source::new(mesh, patch, magnitude))
            .collect();
        let total: f64 = sources.iter().map(Source::total).sum();
        let jobs = self.jobs(&sources, total, rays);
        let receivers = self.areas.len();
        let bound = total / f64::from(LEAST_KEPT);
        let sums = Sums {
            received: Tally::new(channels * receivers, bound),
            lost: Tally::new(2 * channels, total),
        };
        let carried: Vec<Vec<f64>> = jobs
            .par_iter()
            .map(|job| self.cast(mesh, radiosity, job, &sums))
            .collect();
        let number = |tally: &Tally, count: usize| (0..count).map(|i| tally.get(i)).collect();
        let lost: Vec<f64> = number(&sums.lost, 2 * channels);
        let mut arrived = Arrived {
            received: number(&sums.received, channels * receivers),
            backs: lost[..channels].to_vec(),
            escaped: lost[channels..].to_vec(),
            rays: jobs.iter().map(Job::count).sum(),
        };
        for channel in 0..channels {
            let values = &radiosity[channel * elements..(channel + 1) * elements];
            let flux = |(e, &b): (usize, &f32)| f64::from(b) * f64::from(mesh.exposed_area(e));
            let left: f64 = values.iter().enumerate().map(flux).sum();
            let carried: f64 = carried.iter().map(|of_job| of_job[channel]).sum();
            let is_positive = values.iter().all(|&b| b >= 0.0);
            self.balance(&mut arrived, channel, left, carried, is_positive);
        }
        arrived
    }

    /// Scales what a channel brought to what left; where it has both signs, adds the rest evenly.
    fn balance(
        &self,
        arrived: &mut Arrived,
        channel: usize,
        left: f64,
        carried: f64,
        is_positive: bool,
    ) {
        let receivers = self.areas.len();
        let received = &mut arrived.received[channel * receivers..(channel + 1) * receivers];
        if is_positive {
            let scale = if carried > 0.0 { left / carried } else { 1.0 };
            received.iter_mut().for_each(|flux| *flux *= scale);
            arrived.backs[channel] *= scale;
            arrived.escaped[channel] *= scale;
        } else {
            let total: f64 = self.areas.iter().sum();
            let rest = (left - carried) / total;
            let pairs = received.iter_mut().zip(&self.areas);
            pairs.for_each(|(flux, area)| *flux += rest * area);
        }
    }

    /// Splits the rays among patches and pieces.
    fn jobs<'a>(&mut self, sources: &'a [Source], total: f64, rays: u64) -> Vec<Job<'a>> {
        let mut jobs = Vec::new();
        for (patch, source) in sources.iter().enumerate() {
            let magnitude = source.total();
            if magnitude <= 0.0 {
                continue;
            }
            let wanted = magnitude / total * rays as f64;
            let each = ray_count(wanted);
            let first = self.cast[patch];
            self.cast[patch] = first.wrapping_add(each);
            for start in (0..each).step_by(RAYS_AT_ONCE as usize) {
                let end = (start + RAYS_AT_ONCE).min(each);
                jobs.push(Job {
                    patch,
                    source,
                    share: 1.0 / f64::from(each),
                    rays: first.wrapping_add(start)..first.wrapping_add(end),
                });
            }
        }
        jobs
    }

    /// Casts a job's rays; returns what they carried, by channel.
    fn cast(&self, mesh: &PatchMesh, radiosity: &[f32], job: &Job<'_>, sums: &Sums) -> Vec<f64> {
        let elements = mesh.elements().len();
        let channels = radiosity.len() / elements;
        let receivers = self.areas.len();
        let visibility = mesh.visibility();
        let sequence = Sobol4::new(hash(self.seed, job.patch as u64));
        let mut carried = vec![0.0; channels];
        let mut total = vec![0.0; channels];
        let mut ray = job.rays.start;
        while ray != job.rays.end {
            let [s, t, u, v] = sequence.point(ray);
            ray = ray.wrapping_add(1);
            let choice = job.source.choose(u);
            let e = choice.element;
            let scale = f64::from(mesh.exposed_area(e)) * job.share / choice.probability;
            for (channel, (flux, total)) in carried.iter_mut().zip(&mut total).enumerate() {
                *flux = f64::from(radiosity[channel * elements + e]) * scale;
                *total += *flux;
            }
            let normal = mesh.node(mesh.elements()[e]).normal;
            let point = mesh.exposed(e).point([choice.rest, v]);
            let origin = visibility.off_surface(point, normal);
            let escaped = visibility.follow(
                origin,
                cosine_direction(normal, [s, t]),
                |hit, arriving, passing| {
                    let taken = arriving * (Rgb::WHITE - passing);
                    let receiver = self
                        .receivers
                        .at(mesh, hit.face, hit.side, hit.point)
                        .filter(|&receiver| self.areas[receiver] > 0.0);
                    match receiver {
                        Some(receiver) => {
                            let kept =
                                Rgb::WHITE - mean_transmittance(mesh, self.receivers, receiver);
                            sums.receive(&carried, taken, kept, receiver, receivers);
                        }
                        None => sums.lose(&carried, taken, 0),
                    }
                },
            );
            sums.lose(&carried, escaped, channels);
        }
        total
    }
}

/// Of a pane; patches are panes all over.
fn mean_transmittance(mesh: &PatchMesh, receivers: Receivers, receiver: usize) -> Rgb {
    let element = match receivers {
        Receivers::Elements => receiver,
        Receivers::Patches => mesh.elements_of_patch(receiver).start,
    };
    mesh.transmittance()[element]
}

struct Sums {
    received: Tally,
    /// To backs, then to nowhere.
    lost: Tally,
}

impl Sums {
    fn receive(&self, carried: &[f64], taken: Rgb, kept: Rgb, receiver: usize, receivers: usize) {
        for (channel, flux) in carried.iter().enumerate() {
            let band = channel % BANDS;
            if kept[band] < LEAST_KEPT {
                continue;
            }
            let flux = flux * f64::from(taken[band] / kept[band]);
            self.received
                .add(channel * receivers + receiver, self.received.units(flux));
        }
    }

    fn lose(&self, carried: &[f64], share: Rgb, first: usize) {
        if share.is_black() {
            return;
        }
        for (channel, flux) in carried.iter().enumerate() {
            let flux = flux * f64::from(share[channel % BANDS]);
            self.lost.add(first + channel, self.lost.units(flux));
        }
    }
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "clamped to a range of u32"
)]
fn ray_count(wanted: f64) -> u32 {
    wanted.ceil().clamp(1.0, MOST_RAYS_OF_PATCH) as u32
}
