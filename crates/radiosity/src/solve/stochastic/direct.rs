//! Light that arrives straight from emitters: shadow rays from every element.
//!
//! Direct light has sharp shadows and comes from few places, so it is worth rays of its own at every element; what is
//! reflected is smooth and comes from everywhere. Emitting patches are chosen for a ray in proportion to a bound of what
//! they bring unoccluded (Shirley, Wang, Zimmerman 1996), the rays of an element evenly along their running sum. Emitters
//! that nearly touch a patch are taken by exact factors times what rays see of them, because the kernel of point and
//! point grows beyond all bounds there.

use super::source::Source;
use crate::form_factor::RayCastOptions;
use crate::form_factor::raycast::{RayCast, Shooter, kernel};
use crate::patch::{NodeId, PatchMesh};
use crate::sampling::{hash, point4};
use crate::solution::BANDS;
use core::f64::consts::PI;
use glam::Vec3;
use rayon::prelude::*;
use std::sync::Arc;

/// Shadow rays of an element in one batch.
pub(super) const RAYS: u32 = 16;
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

/// What a batch brought.
pub(super) struct Batch {
    /// Irradiance, `[element][channel]`.
    pub(super) irradiance: Vec<f32>,
    /// Rays that were cast.
    pub(super) rays: u64,
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
    pub(super) fn near(&self) -> Batch {
        let before = crate::form_factor::FormFactors::rays(&self.raycast);
        let irradiance = self.of_patches(|patch, out| self.near_patch(patch, out));
        let rays = crate::form_factor::FormFactors::rays(&self.raycast) - before;
        Batch { irradiance, rays }
    }

    /// Irradiance from the others, by a batch of rays. Different batches are independent.
    pub(super) fn batch(&self, number: u32) -> Batch {
        let seed = hash(self.seed, u64::from(number));
        let rays = core::sync::atomic::AtomicU64::new(0);
        let irradiance = self.of_patches(|patch, out| {
            let cast = self.far_patch(patch, seed, out);
            rays.fetch_add(cast, core::sync::atomic::Ordering::Relaxed);
        });
        Batch {
            irradiance,
            rays: rays.into_inner(),
        }
    }

    fn of_patches(&self, work: impl Fn(usize, &mut [f32]) + Sync) -> Vec<f32> {
        let mut irradiance = vec![0.0; self.mesh.elements().len() * self.channels];
        let mut slices = Vec::new();
        let mut rest = &mut irradiance[..];
        for patch in 0..self.mesh.patches().len() {
            let length = self.mesh.elements_of_patch(patch).len() * self.channels;
            let (slice, after) = rest.split_at_mut(length);
            slices.push(slice);
            rest = after;
        }
        slices
            .into_par_iter()
            .enumerate()
            .for_each(|(patch, slice)| work(patch, slice));
        irradiance
    }

    fn near_patch(&self, patch: usize, out: &mut [f32]) {
        let receiver = Place::of(&self.mesh, self.mesh.patches()[patch]);
        for emitter in &self.emitters {
            if emitter.patch == patch || !emitter.is_near(&receiver) {
                continue;
            }
            if receiver.bound(emitter) <= 0.0 {
                continue;
            }
            let from = Shooter::new(&self.mesh, emitter.id);
            for (i, e) in self.mesh.elements_of_patch(patch).enumerate() {
                let area = f64::from(self.mesh.exposed_area(e));
                if area <= 0.0 {
                    continue;
                }
                let factor = self.raycast.pair(&from, e, self.mesh.elements()[e], 1.0);
                let out = &mut out[i * self.channels..(i + 1) * self.channels];
                for (channel, (out, flux)) in out.iter_mut().zip(&emitter.flux).enumerate() {
                    let visible = f64::from(factor.visible[channel % BANDS]);
                    *out += super::to_f32(flux * factor.unoccluded * visible / area);
                }
            }
        }
    }

    fn far_patch(&self, patch: usize, seed: u64, out: &mut [f32]) -> u64 {
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
        let elements = self.mesh.elements_of_patch(patch);
        let count = elements.len() as u64;
        for (i, e) in elements.enumerate() {
            sums.fill(0.0);
            self.far_element(e, &lights, seed, &mut sums);
            let out = &mut out[i * self.channels..(i + 1) * self.channels];
            for (out, &sum) in out.iter_mut().zip(&sums) {
                *out = super::to_f32(sum);
            }
        }
        count * u64::from(RAYS)
    }

    fn far_element(&self, e: usize, lights: &Lights<'_>, seed: u64, sums: &mut [f64]) {
        let exposed = self.mesh.exposed(e);
        if exposed.area() <= 0.0 {
            return;
        }
        let elements = self.mesh.elements().len();
        let visibility = self.mesh.visibility();
        let normal = self.mesh.node(self.mesh.elements()[e]).normal;
        let seed = hash(seed, e as u64);
        let shift = (hash(seed, 2) >> 40) as f64 / f64::from(1 << 24);
        for ray in 0..RAYS {
            let [u, v, s, t] = point4(ray, seed);
            let (emitter, probability) =
                lights.choose((f64::from(ray) + shift) / f64::from(RAYS));
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
        let start = if index == 0 { 0.0 } else { self.sums[index - 1] };
        (self.far[index], (self.sums[index] - start) / total)
    }
}
