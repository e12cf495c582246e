//! Light that arrives straight from emitters: shadow rays from every element.
//!
//! Direct light has sharp shadows and comes from few places, so it is worth rays of its own at every element; what is
//! reflected is smooth and comes from everywhere. The emitters of a ray are chosen from a cut of a [tree](super::lights)
//! in proportion to a bound of what they bring unoccluded (Shirley, Wang, Zimmerman 1996), and to the root of the share
//! of earlier rays of the patch and its [cell](super::cells) that found them: of all probabilities that know visibility
//! as a share only, those make the variance least. Emitters that nearly touch a patch are taken by exact factors times what rays see of them, because the kernel
//! of point and point grows beyond all bounds there.

use super::cells::{Cell, Cells, Tries};
use super::lights::{Lamp, Lights, Part, Place};
use super::shoot::REPLICATES;
use super::source::Source;
use crate::form_factor::raycast::{RayCast, Shooter, kernel};
use crate::form_factor::{FormFactors, RayCastOptions};
use crate::patch::{NodeId, PatchMesh};
use crate::sampling::hash;
use crate::sobol::Sobol4;
use crate::solution::BANDS;
use core::f64::consts::PI;
use rayon::prelude::*;
use std::sync::Arc;

/// Shadow rays of an element in one round of one replicate, powers of two: in the first round, which finds out what is
/// in the way, and in the others.
const FIRST_RAYS: u32 = 4;
const RAYS: u32 = 16;
/// Rays of the first round as a share of those of another.
pub(super) const FIRST_SHARE: f32 = FIRST_RAYS as f32 / RAYS as f32;
/// Rays of a cell for which its share counts in that of a patch.
const TRUST: f32 = 2.0;
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
    lights: Lights,
    cells: Cells,
    /// What rays of each patch have found at the parts of its cell's cut.
    found: Vec<Vec<Found>>,
    seed: u64,
    raycast: RayCast,
}

struct Emitter {
    patch: usize,
    id: NodeId,
    place: Place,
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

/// Rays to a part of a cut, and those that brought light. Halved where they would not fit.
#[derive(Debug, Clone, Copy, Default)]
struct Found {
    rays: u8,
    lit: u8,
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
        let emitters: Vec<Emitter> = (0..mesh.patches().len())
            .into_par_iter()
            .filter_map(|patch| Emitter::new(&mesh, patch, &exitance, channels))
            .collect();
        let lamps: Vec<Lamp> = emitters.iter().map(Emitter::lamp).collect();
        let lights = Lights::new(&lamps);
        let places: Vec<Place> = mesh
            .patches()
            .par_iter()
            .map(|&id| place_of(&mesh, id))
            .collect();
        let options = RayCastOptions {
            rays: PAIR_RAYS,
            seed,
            ..RayCastOptions::default()
        };
        Self {
            raycast: RayCast::new(mesh.clone(), options),
            found: vec![Vec::new(); mesh.patches().len()],
            cells: Cells::new(&places, &lights, NEAR),
            lights,
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
        let patches = vec![(); self.mesh.patches().len()];
        let (mut brought, _) = self.of_patches(patches, |patch, (), slots| {
            self.near_patch(patch, slots);
            ((), 0)
        });
        brought.rays = self.raycast.rays() - before;
        brought
    }

    /// Irradiance from the others, by one more round of rays of the elements for which `wanted` tells how many rounds
    /// they have had. The rays of a round are those of all replicates; each goes on with a sequence of its own.
    pub(super) fn round(&mut self, wanted: impl Fn(usize) -> Option<u32> + Sync) -> Brought {
        let found = core::mem::take(&mut self.found);
        let (brought, found) = self.of_patches(found, |patch, mut found, slots| {
            let rays = self.far_patch(patch, &wanted, &mut found, slots);
            (found, rays)
        });
        self.found = found;
        self.sum_up();
        brought
    }

    /// Tells the cells what their patches have found.
    fn sum_up(&mut self) {
        let found = &self.found;
        self.cells.cells.par_iter_mut().for_each(|cell| {
            cell.tries = vec![Tries::default(); cell.cut.len()];
            for &patch in &cell.patches {
                for (sum, found) in cell.tries.iter_mut().zip(&found[patch as usize]) {
                    sum.rays += u32::from(found.rays);
                    sum.lit += u32::from(found.lit);
                }
            }
        });
    }

    /// Does something for each patch with what is known of it and the slots of its elements; it returns what is known
    /// then, and the number of rays.
    fn of_patches<T: Send>(
        &self,
        known: Vec<T>,
        work: impl Fn(usize, T, &mut [Slot<'_>]) -> (T, u64) + Sync,
    ) -> (Brought, Vec<T>) {
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
        let of_patches: Vec<(T, Vec<Slot<'_>>)> = known
            .into_iter()
            .enumerate()
            .map(|(patch, known)| {
                let count = self.mesh.elements_of_patch(patch).len();
                (known, slots.by_ref().take(count).collect())
            })
            .collect();
        let (known, rays): (Vec<T>, Vec<u64>) = of_patches
            .into_par_iter()
            .enumerate()
            .map(|(patch, (known, mut slots))| work(patch, known, &mut slots))
            .unzip();
        let brought = Brought {
            irradiance,
            replicates,
            rays: rays.iter().sum(),
        };
        (brought, known)
    }

    fn near_patch(&self, patch: usize, slots: &mut [Slot<'_>]) {
        let receiver = place_of(&self.mesh, self.mesh.patches()[patch]);
        let mut near = Vec::new();
        self.lights.visit_near(&receiver, NEAR, |i| near.push(i));
        near.retain(|&i| {
            let emitter = &self.emitters[i];
            emitter.patch != patch && emitter.is_near(&receiver)
        });
        near.sort_unstable();
        for emitter in near.into_iter().map(|i| &self.emitters[i]) {
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
        found: &mut Vec<Found>,
        slots: &mut [Slot<'_>],
    ) -> u64 {
        let elements = self.mesh.elements_of_patch(patch);
        if elements.clone().all(|e| wanted(e).is_none()) {
            return 0;
        }
        let receiver = place_of(&self.mesh, self.mesh.patches()[patch]);
        let cell = self.cells.of(patch);
        found.resize(cell.cut.len(), Found::default());
        let Some(chances) = self.chances(patch, &receiver, cell, found) else {
            return 0;
        };
        let mut sums = vec![0.0; self.channels];
        let mut rays = 0;
        for (slot, e) in slots.iter_mut().zip(elements) {
            let Some(rounds) = wanted(e) else { continue };
            sums.fill(0.0);
            for replicate in 0..REPLICATES {
                let before: f64 = sums.iter().sum();
                self.far_element(e, &chances, replicate, rounds, found, &mut sums);
                let brought = sums.iter().sum::<f64>() - before;
                slot.replicates[replicate] = super::to_f32(brought);
            }
            for (out, sum) in slot.irradiance.iter_mut().zip(&sums) {
                *out = super::to_f32(sum / REPLICATES as f64);
            }
            rays += u64::from(rays_of_round(rounds)) * REPLICATES as u64;
        }
        rays
    }

    /// Where the rays of a patch go; none if no emitter lights it, but those that nearly touch.
    fn chances(
        &self,
        patch: usize,
        receiver: &Place,
        cell: &Cell,
        found: &[Found],
    ) -> Option<Chances> {
        let is_taken_otherwise = |emitter: usize| {
            let emitter = &self.emitters[emitter];
            emitter.patch == patch || emitter.is_near(receiver)
        };
        let mut chances = Chances::default();
        for (slot, &part) in cell.cut.iter().enumerate() {
            let bound = self.lights.bound(part, receiver);
            if bound <= 0.0 || self.lights.lamp(part).is_some_and(is_taken_otherwise) {
                continue;
            }
            let in_cell = cell.tries.get(slot).map_or(0.5, |tries| tries.share());
            chances.push(slot, part, bound * found[slot].share(in_cell).sqrt());
        }
        (!chances.parts.is_empty()).then_some(chances)
    }

    /// Adds what the rays of a replicate in a round bring.
    fn far_element(
        &self,
        e: usize,
        chances: &Chances,
        replicate: usize,
        round: u32,
        found: &mut [Found],
        sums: &mut [f64],
    ) {
        let exposed = self.mesh.exposed(e);
        if exposed.area() <= 0.0 {
            return;
        }
        let normal = self.mesh.node(self.mesh.elements()[e]).normal;
        let seed = hash(hash(self.seed, e as u64), replicate as u64);
        let (towards, from) = (Sobol4::new(seed), Sobol4::new(hash(seed, 2)));
        let rays = rays_of_round(round);
        for ray in 0..rays {
            let index = round.wrapping_mul(RAYS).wrapping_add(ray);
            let [wanted, u, v, _] = towards.point(index);
            let [s, t, ..] = from.point(index);
            let (slot, part, probability, rest) = chances.choose(wanted);
            let to = Place::point(exposed.point([s, t]), normal);
            let is_lit =
                self.lights
                    .choose(part, &to, rest)
                    .is_some_and(|(emitter, of_part, _)| {
                        let scale = 1.0 / (f64::from(probability * of_part) * f64::from(rays));
                        self.cast(&self.emitters[emitter], &to, [u, v], scale, sums)
                    });
            found[slot].count(is_lit);
        }
    }

    /// Adds what a ray brings from a point of an emitter; whether it brings any light.
    fn cast(
        &self,
        emitter: &Emitter,
        to: &Place,
        [u, v]: [f32; 2],
        scale: f64,
        sums: &mut [f64],
    ) -> bool {
        let visibility = self.mesh.visibility();
        let choice = emitter.source.choose(u);
        let light = self.mesh.exposed(choice.element);
        let from = light.point([choice.rest, v]);
        let normals = [emitter.place.normal, to.normal];
        let kernel = f64::from(kernel(to.centroid - from, normals));
        if kernel <= 0.0 {
            return false;
        }
        let visible = visibility.transmittance(
            visibility.off_surface(to.centroid, to.normal),
            visibility.off_surface(from, emitter.place.normal),
        );
        if visible.is_black() {
            return false;
        }
        let weight = scale * kernel * f64::from(light.area()) / (PI * choice.probability);
        let elements = self.mesh.elements().len();
        for (channel, sum) in sums.iter_mut().enumerate() {
            let exitance = self.exitance[channel * elements + choice.element];
            *sum += weight * f64::from(exitance * visible[channel % BANDS]);
        }
        true
    }
}

/// Which parts of a cut rays go to, by running sums.
#[derive(Default)]
struct Chances {
    /// With their positions in the cut.
    parts: Vec<(usize, Part)>,
    sums: Vec<f32>,
}

impl Chances {
    fn push(&mut self, slot: usize, part: Part, chance: f32) {
        let sum = self.sums.last().copied().unwrap_or(0.0);
        self.parts.push((slot, part));
        self.sums.push(sum + chance);
    }

    /// Position, part, probability, and what is left of a number in [0, 1).
    fn choose(&self, sample: f32) -> (usize, Part, f32, f32) {
        let total = self.sums[self.sums.len() - 1];
        let wanted = sample * total;
        let index = self.sums.partition_point(|&sum| sum <= wanted);
        let index = index.min(self.sums.len() - 1);
        let start = if index == 0 {
            0.0
        } else {
            self.sums[index - 1]
        };
        let share = self.sums[index] - start;
        let rest = ((wanted - start) / share).clamp(0.0, 0.999_999_94);
        let (slot, part) = self.parts[index];
        (slot, part, share / total, rest)
    }
}

/// Rays of an element in a round of a replicate.
fn rays_of_round(round: u32) -> u32 {
    if round == 0 { FIRST_RAYS } else { RAYS }
}

impl Tries {
    /// Share of rays that bring light, between none and all as long as little is known.
    fn share(self) -> f32 {
        (self.lit as f32 + 0.25) / (self.rays as f32 + 0.5)
    }
}

impl Found {
    fn count(&mut self, is_lit: bool) {
        if self.rays == u8::MAX {
            self.rays /= 2;
            self.lit /= 2;
        }
        self.rays += 1;
        self.lit += u8::from(is_lit);
    }

    /// Share of rays that bring light, that of the cell as long as little is known.
    fn share(self, in_cell: f32) -> f32 {
        (f32::from(self.lit) + TRUST * in_cell) / (f32::from(self.rays) + TRUST)
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
        Some(Self {
            patch,
            id,
            place: place_of(mesh, id),
            source,
            flux: (0..channels).map(flux).collect(),
        })
    }

    fn is_near(&self, receiver: &Place) -> bool {
        let reach = NEAR * (self.place.radius + receiver.radius);
        self.place.centroid.distance_squared(receiver.centroid) < reach * reach
    }

    fn lamp(&self) -> Lamp {
        Lamp {
            centroid: self.place.centroid,
            normal: self.place.normal,
            radius: self.place.radius,
            flux: super::to_f32(self.source.total()),
        }
    }
}

/// Where a patch is.
fn place_of(mesh: &PatchMesh, id: NodeId) -> Place {
    let node = mesh.node(id);
    let corners = mesh.polygon(id);
    let distances = corners.iter().map(|c| c.distance(node.centroid));
    Place::disc(node.centroid, node.normal, distances.fold(0.0, f32::max))
}
