//! Light that arrives straight from emitters: shadow rays from every element.
//!
//! Direct light has sharp shadows and comes from few places, so it is worth rays of its own at every element; what is
//! reflected is smooth and comes from everywhere. Emitting patches are chosen for a ray in proportion to a bound of what
//! they bring unoccluded (Shirley, Wang, Zimmerman 1996), the rays of an element evenly along their running sum. Emitters
//! that nearly touch a patch are taken by exact factors times what rays see of them, because the kernel of point and
//! point grows beyond all bounds there.

use super::shoot::REPLICATES;
use super::source::Source;
use crate::form_factor::raycast::{RayCast, Shooter, kernel};
use crate::form_factor::{FormFactors, RayCastOptions};
use crate::patch::{NodeId, PatchMesh};
use crate::sampling::{hash, point4};
use crate::solution::BANDS;
use core::f64::consts::PI;
use glam::Vec3;
use rayon::prelude::*;
use std::sync::Arc;

/// Shadow rays of an element in one round of one replicate.
const RAYS: u32 = 16;
/// Emitters nearer than so many radii of both are taken by exact factors.
const NEAR: f32 = 2.0;
/// Rays over the hemisphere, of which pairs take their share.
const PAIR_RAYS: u32 = 4096;

/// Emitting patches, and what they shoot.
pub(super) struct Direct {
    mesh: Arc<PatchMesh>,
    /// `[channel][element]`.
    exitance: Vec<f32>,
    channels: usize,
    emitters: Vec<Emitter>,
    seed: u64,
    raycast: RayCast,
}

struct Emitter {
    patch: usize,
    id: NodeId,
    normal: Vec3,
    centroid: Vec3,
    radius: f32,
    source: Source,
    /// By channel.
    flux: Vec<f64>,
}

/// What some rays brought.
pub(super) struct Brought {
    /// Irradiance, `[element][channel]`.
    pub(super) irradiance: Vec<f32>,
    /// The same summed over channels, of each replicate alone.
    pub(super) replicates: Vec<[f32; REPLICATES]>,
    /// Rays that were cast.
    pub(super) rays: u64,
}

/// Room for what an element gets.
struct Slot<'a> {
    irradiance: &'a mut [f32],
    replicates: &'a mut [f32; REPLICATES],
}

impl Direct {
    /// Emitters by their exitance, `[channel][element]`.
    pub(super) fn new(mesh: Arc<PatchMesh>, exitance: Vec<f32>, seed: u64) -> Self {
        let elements = mesh.elements().len();
        let channels = exitance.len() / elements;
        let emitters = (0..mesh.patches().len())
            .into_par_iter()
            .filter_map(|patch| Emitter::new(&mesh, patch, &exitance, channels))
            .collect();
        let options = RayCastOptions {
            rays: PAIR_RAYS,
            seed,
            ..RayCastOptions::default()
        };
        Self {
            raycast: RayCast::new(mesh.clone(), options),
            mesh,
            exitance,
            channels,
            emitters,
            seed,
        }
    }

    /// Whether there is anything to do.
    pub(super) fn is_dark(&self) -> bool {
        self.emitters.is_empty()
    }

    /// What is emitted, `[channel][element]`.
    pub(super) fn exitance(&self) -> &[f32] {
        &self.exitance
    }

    /// Irradiance from emitters that nearly touch.
    pub(super) fn near(&self) -> Brought {
        let before = self.raycast.rays();
        let mut brought = self.of_patches(|patch, slots| {
            self.near_patch(patch, slots);
            0
        });
        brought.rays = self.raycast.rays() - before;
        brought
    }

    /// Irradiance from the others, by one more round of rays of the elements for which `wanted` tells how many rounds
    /// they have had. The rays of a round are those of all replicates; each goes on with a sequence of its own.
    pub(super) fn round(&self, wanted: impl Fn(usize) -> Option<u32> + Sync) -> Brought {
        self.of_patches(|patch, slots| self.far_patch(patch, &wanted, slots))
    }

    /// Does something for each patch with the slots of its elements; it returns the number of rays.
    fn of_patches(&self, work: impl Fn(usize, &mut [Slot<'_>]) -> u64 + Sync) -> Brought {
        let elements = self.mesh.elements().len();
        let mut irradiance = vec![0.0; elements * self.channels];
        let mut replicates = vec![[0.0; REPLICATES]; elements];
        let slots = irradiance
            .chunks_exact_mut(self.channels)
            .zip(&mut replicates);
        let mut slots = slots.map(|(irradiance, replicates)| Slot {
            irradiance,
            replicates,
        });
        let of_patches: Vec<Vec<Slot<'_>>> = (0..self.mesh.patches().len())
            .map(|patch| {
                slots
                    .by_ref()
                    .take(self.mesh.elements_of_patch(patch).len())
                    .collect()
            })
            .collect();
        let rays = of_patches
            .into_par_iter()
            .enumerate()
            .map(|(patch, mut slots)| work(patch, &mut slots))
            .sum();
        Brought {
            irradiance,
            replicates,
            rays,
        }
    }

    fn near_patch(&self, patch: usize, slots: &mut [Slot<'_>]) {
        let receiver = Place::of(&self.mesh, self.mesh.patches()[patch]);
        for emitter in &self.emitters {
            if emitter.patch == patch || !emitter.is_near(&receiver) {
                continue;
            }
            if receiver.bound(emitter) <= 0.0 {
                continue;
            }
            let from = Shooter::new(&self.mesh, emitter.id);
            for (slot, e) in slots.iter_mut().zip(self.mesh.elements_of_patch(patch)) {
                let area = f64::from(self.mesh.exposed_area(e));
                if area <= 0.0 {
                    continue;
                }
                let factor = self.raycast.pair(&from, e, self.mesh.elements()[e], 1.0);
                let pairs = slot.irradiance.iter_mut().zip(&emitter.flux);
                for (channel, (out, flux)) in pairs.enumerate() {
                    let visible = f64::from(factor.visible[channel % BANDS]);
                    *out += super::to_f32(flux * factor.unoccluded * visible / area);
                }
            }
        }
    }

    fn far_patch(
        &self,
        patch: usize,
        wanted: &impl Fn(usize) -> Option<u32>,
        slots: &mut [Slot<'_>],
    ) -> u64 {
        let elements = self.mesh.elements_of_patch(patch);
        if elements.clone().all(|e| wanted(e).is_none()) {
            return 0;
        }
        let receiver = Place::of(&self.mesh, self.mesh.patches()[patch]);
        let mut sum = 0.0;
        let (mut far, mut sums) = (Vec::new(), Vec::new());
        for emitter in &self.emitters {
            if emitter.patch == patch || emitter.is_near(&receiver) {
                continue;
            }
            let bound = receiver.bound(emitter);
            if bound > 0.0 {
                sum += bound;
                far.push(emitter);
                sums.push(sum);
            }
        }
        if far.is_empty() {
            return 0;
        }
        let lights = Lights { far, sums };
        let mut sums = vec![0.0; self.channels];
        let mut rays = 0;
        for (slot, e) in slots.iter_mut().zip(elements) {
            let Some(rounds) = wanted(e) else { continue };
            sums.fill(0.0);
            for replicate in 0..REPLICATES {
                let before: f64 = sums.iter().sum();
                self.far_element(e, &lights, replicate, rounds, &mut sums);
                let brought = sums.iter().sum::<f64>() - before;
                slot.replicates[replicate] = super::to_f32(brought);
            }
            for (out, sum) in slot.irradiance.iter_mut().zip(&sums) {
                *out = super::to_f32(sum / REPLICATES as f64);
            }
            rays += u64::from(RAYS) * REPLICATES as u64;
        }
        rays
    }

    /// Adds what the rays of a replicate in a round bring.
    fn far_element(
        &self,
        e: usize,
        lights: &Lights<'_>,
        replicate: usize,
        round: u32,
        sums: &mut [f64],
    ) {
        let exposed = self.mesh.exposed(e);
        if exposed.area() <= 0.0 {
            return;
        }
        let elements = self.mesh.elements().len();
        let visibility = self.mesh.visibility();
        let normal = self.mesh.node(self.mesh.elements()[e]).normal;
        let seed = hash(hash(self.seed, e as u64), replicate as u64);
        // Which emitter: evenly within a round, and by van der Corput's sequence from round to round.
        let shift = (hash(seed, 2) >> 40) as f64 / f64::from(1 << 24);
        let shift = (shift + f64::from(round.reverse_bits()) / 4_294_967_296.0).fract();
        for ray in 0..RAYS {
            let [u, v, s, t] = point4(round.wrapping_mul(RAYS).wrapping_add(ray), seed);
            let (emitter, probability) = lights.choose((f64::from(ray) + shift) / f64::from(RAYS));
            let choice = emitter.source.choose(u);
            let light = self.mesh.exposed(choice.element);
            let from = light.point([choice.rest, v]);
            let to = exposed.point([s, t]);
            let kernel = f64::from(kernel(to - from, [emitter.normal, normal]));
            if kernel <= 0.0 {
                continue;
            }
            let visible = visibility.transmittance(
                visibility.off_surface(to, normal),
                visibility.off_surface(from, emitter.normal),
            );
            if visible.is_black() {
                continue;
            }
            let density = probability * choice.probability / f64::from(light.area());
            let weight = kernel / (PI * density * f64::from(RAYS));
            for (channel, sum) in sums.iter_mut().enumerate() {
                let exitance = self.exitance[channel * elements + choice.element];
                *sum += weight * f64::from(exitance * visible[channel % BANDS]);
            }
        }
    }
}

impl Emitter {
    /// None if the patch emits nothing.
    fn new(mesh: &PatchMesh, patch: usize, exitance: &[f32], channels: usize) -> Option<Self> {
        let elements = mesh.elements().len();
        let area = |e: usize| f64::from(mesh.exposed_area(e));
        let exitance = |channel: usize, e: usize| f64::from(exitance[channel * elements + e]);
        let source = Source::new(mesh, patch, |e| {
            (0..channels).map(|c| exitance(c, e)).sum::<f64>() * area(e)
        });
        if source.total() <= 0.0 {
            return None;
        }
        let flux = |channel: usize| {
            let of = |e: usize| exitance(channel, e) * area(e);
            mesh.elements_of_patch(patch).map(of).sum()
        };
        let id = mesh.patches()[patch];
        let place = Place::of(mesh, id);
        Some(Self {
            patch,
            id,
            normal: place.normal,
            centroid: place.centroid,
            radius: place.radius,
            source,
            flux: (0..channels).map(flux).collect(),
        })
    }

    fn is_near(&self, receiver: &Place) -> bool {
        let reach = NEAR * (self.radius + receiver.radius);
        self.centroid.distance_squared(receiver.centroid) < reach * reach
    }
}

/// Where a patch is.
struct Place {
    centroid: Vec3,
    normal: Vec3,
    radius: f32,
}

impl Place {
    fn of(mesh: &PatchMesh, id: NodeId) -> Self {
        let node = mesh.node(id);
        let corners = mesh.polygon(id);
        let distances = corners.iter().map(|c| c.distance(node.centroid));
        Self {
            centroid: node.centroid,
            normal: node.normal,
            radius: distances.fold(0.0, f32::max),
        }
    }

    /// What an emitter brings at most, about: its flux, the largest cosines, the mean distance.
    fn bound(&self, emitter: &Emitter) -> f64 {
        let offset = self.centroid - emitter.centroid;
        let distance = offset.length().max(f32::MIN_POSITIVE);
        let reach = (self.radius + emitter.radius) / distance;
        let direction = offset / distance;
        let leaving = direction.dot(emitter.normal) + reach;
        let arriving = -direction.dot(self.normal) + reach;
        if leaving <= 0.0 || arriving <= 0.0 {
            return 0.0;
        }
        let cosines = f64::from(leaving.min(1.0) * arriving.min(1.0));
        emitter.source.total() * cosines / f64::from(distance * distance)
    }
}

/// The emitters that a patch may see, by running sums of what they bring.
struct Lights<'a> {
    far: Vec<&'a Emitter>,
    sums: Vec<f64>,
}

impl Lights<'_> {
    /// One of them, for a number in [0, 1), and its probability.
    fn choose(&self, sample: f64) -> (&Emitter, f64) {
        let total = self.sums[self.sums.len() - 1];
        let wanted = sample * total;
        let found = self.sums.partition_point(|&sum| sum <= wanted);
        let index = found.min(self.sums.len() - 1);
        let start = if index == 0 {
            0.0
        } else {
            self.sums[index - 1]
        };
        (self.far[index], (self.sums[index] - start) / total)
    }
}
