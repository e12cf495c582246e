//! Light from many emitters by shadow rays.
//!
//! What emitters bring is expected by their [view](super::view) from the receiver and by the share of earlier rays of the
//! patch and its [cell](super::cells) that got through; rays find what differs from that, and go where it is uncertain
//! (Shirley, Wang, Zimmerman 1996, on choosing lamps). The first rays of a cell only learn. One sequence for all rays of a
//! receiver takes the emitters in turn, neighbours after each other. Emitters that nearly touch a receiver are left out,
//! because the kernel of point and point grows beyond all bounds there.

use super::cells::{Cell, Found, cells};
use super::emitters::{Elements, Emitter, NEAR, place_of};
use super::estimates::{Brought, Round};
use super::lights::{Lamp, Lights, Place};
use super::receivers::Start;
use super::strata::{Spread, Stratum};
use super::view::{Choice, Sight, View};
use crate::form_factor::raycast::kernel;
use crate::patch::PatchMesh;
use crate::sampling::hash;
use crate::sobol::Sobol4;
use crate::solution::BANDS;
use core::f32::consts::PI;
use glam::Vec3;
use hemicube_raster::Rgb;
use rayon::prelude::*;
use std::sync::Arc;

/// Most rays of every other receiver by which a cell begins.
const FIRST_RAYS: u32 = 64;
/// Marks patches that emit nothing.
const DARK: u32 = u32::MAX;

/// Emitters, and what is known of what hides them.
pub(super) struct ShadowRays {
    mesh: Arc<PatchMesh>,
    channels: usize,
    emitters: Vec<Emitter>,
    elements: Elements,
    /// Of each patch, or [`DARK`].
    emitter_of_patch: Vec<u32>,
    lights: Lights,
    cells: Vec<Cell>,
    seed: u64,
    rounds: u64,
}

/// A ray on its way.
#[derive(Debug, Clone, Copy)]
struct Ray {
    /// Its position in the numbers of its receiver, from the first of those of the patch.
    position: u32,
    /// Position in the cut.
    part: u32,
    /// Among those of all emitters.
    element: u32,
    /// What it brings for an exitance of 1 if nothing is in the way.
    weight: f32,
}

/// The rays of a patch, and room for their answers.
#[derive(Default)]
struct Rays {
    rays: Vec<Ray>,
    segments: Vec<(Vec3, Vec3)>,
    through: Vec<Rgb>,
    /// What each brought beyond what was expected, summed over channels.
    numbers: Vec<f32>,
    /// The same by channel and what was expected at all, `[receiver][channel]`.
    sums: Vec<f64>,
    /// What a receiver sees.
    sight: Sight,
    /// Shares of the parts that are visible.
    shares: Vec<f32>,
    /// Of all receivers, one after the other, and where those of each end.
    strata: Vec<Stratum>,
    ends: Vec<usize>,
}

/// What was brought to the receivers of a cell, one after the other.
#[derive(Default)]
struct ToCell {
    irradiance: Vec<f32>,
    /// Squared deviations of parts with one ray only, as they are thought to be.
    singles: Vec<f32>,
    /// Squared deviations of the rays of parts with several: as found, and as thought.
    deviations: [f64; 2],
    squares: Vec<f32>,
    rays: u64,
}

impl ToCell {
    /// Adds what the rays of a receiver say of its error.
    fn add(&mut self, spread: &Spread) {
        self.squares.push(spread.square);
        self.singles.push(spread.singles);
        for (sum, square) in self.deviations.iter_mut().zip(spread.deviations) {
            *sum += f64::from(square);
        }
    }

    /// Parts that one ray went to, which says nothing of its error, are taken for as uncertain as those of several rays
    /// are in all the cell, compared with what was thought of them.
    fn close(&mut self) {
        let [found, thought] = self.deviations;
        // As thought, if there is nothing to go by.
        let prior = 1e-3 * thought + f64::from(f32::MIN_POSITIVE);
        let ratio = super::to_f32((found + prior) / (thought + prior));
        for (square, single) in self.squares.iter_mut().zip(&self.singles) {
            *square += ratio * single;
        }
    }
}

impl ShadowRays {
    /// Emitters by their exitance, `[channel][element]`.
    pub(super) fn new(mesh: Arc<PatchMesh>, exitance: &[f32], seed: u64) -> Self {
        let channels = exitance.len() / mesh.elements().len();
        let emitters: Vec<Emitter> = (0..mesh.patches().len())
            .into_par_iter()
            .filter_map(|patch| Emitter::new(&mesh, patch, exitance, channels))
            .collect();
        let mut emitter_of_patch = vec![DARK; mesh.patches().len()];
        for (number, emitter) in (0..).zip(&emitters) {
            emitter_of_patch[emitter.patch] = number;
        }
        let lamps: Vec<Lamp> = emitters.iter().map(Emitter::lamp).collect();
        let lights = Lights::new(&lamps);
        let patches = mesh.patches().par_iter();
        let places: Vec<Place> = patches.map(|&id| place_of(&mesh, id)).collect();
        let is_dark = emitters.is_empty();
        Self {
            cells: if is_dark {
                Vec::new()
            } else {
                cells(&places, &lights)
            },
            lights,
            channels,
            elements: Elements::of(&mesh, &emitters, exitance),
            emitters,
            emitter_of_patch,
            mesh,
            seed,
            rounds: 0,
        }
    }

    /// Whether nothing emits.
    pub(super) fn is_dark(&self) -> bool {
        self.emitters.is_empty()
    }

    /// Whether a patch emits and is not left out at the receivers of another one.
    pub(super) fn is_far(&self, patch: usize, receiver: &Place) -> bool {
        let emitter = self.emitter_of_patch[patch];
        emitter != DARK && !self.emitters[emitter as usize].is_near(receiver)
    }

    /// The emitters that are left out at the receivers of a patch, but for itself.
    pub(super) fn left_out(&self, patch: usize) -> Vec<&Emitter> {
        let near = self.near(patch).into_iter().map(|i| &self.emitters[i]);
        near.filter(|emitter| emitter.patch != patch).collect()
    }

    /// Irradiance from the others, by one more round of rays.
    pub(super) fn round(&mut self, round: Round<'_>) -> Brought {
        let mut cells = core::mem::take(&mut self.cells);
        let found: Vec<ToCell> = cells
            .par_iter_mut()
            .map(|cell| self.light_cell(cell, round))
            .collect();
        let mut brought = Brought::nothing(round.wanted.len(), self.channels);
        for (cell, found) in cells.iter().zip(found) {
            brought.rays += found.rays;
            let mut light = found.irradiance.chunks_exact(self.channels);
            let mut squares = found.squares.iter();
            for &patch in &cell.patches {
                for receiver in self.mesh.elements_of_patch(patch as usize) {
                    // A cell that had no rays brings nothing.
                    if let (Some(light), Some(&square)) = (light.next(), squares.next()) {
                        let start = receiver * self.channels;
                        brought.irradiance[start..start + self.channels].copy_from_slice(light);
                        brought.squares[receiver] = square;
                    }
                }
            }
        }
        self.cells = cells;
        self.rounds += 1;
        brought
    }

    fn light_cell(&self, cell: &mut Cell, round: Round<'_>) -> ToCell {
        let mut to_cell = ToCell::default();
        let receivers = |&patch: &u32| self.mesh.elements_of_patch(patch as usize);
        let mut all = cell.patches.iter().flat_map(receivers);
        if all.all(|receiver| round.wanted[receiver] == 0) {
            return to_cell;
        }
        let mut view = View::new(&self.lights, &cell.around, &cell.cut, NEAR);
        if cell.found.is_empty() {
            let found = view.part_count() * cell.patches.len();
            cell.found.resize(found, Found::default());
            let mut learnt = ToCell::default();
            // They only learn: what they bring is so uncertain that it would spoil what later ones know better. Half of
            // the receivers know what the others need to.
            let every_other = |receiver: usize| {
                let rays = round.wanted[receiver].saturating_mul(2).min(FIRST_RAYS);
                rays * u32::from(receiver.is_multiple_of(2))
            };
            self.pass(cell, &mut view, &every_other, 0, &mut learnt);
            to_cell.rays += learnt.rays;
        }
        let seed = self.rounds + 1;
        self.pass(cell, &mut view, &|r| round.wanted[r], seed, &mut to_cell);
        to_cell
    }

    /// Casts so many rays from each receiver of a cell.
    fn pass(
        &self,
        cell: &mut Cell,
        view: &mut View,
        wanted: &dyn Fn(usize) -> u32,
        seed: u64,
        to_cell: &mut ToCell,
    ) {
        let width = view.part_count();
        let mut found = core::mem::take(&mut cell.found);
        let mut rays = Rays::default();
        for (i, &patch) in cell.patches.iter().enumerate() {
            let patch = patch as usize;
            let of_patch = &mut found[i * width..(i + 1) * width];
            rays.clear();
            rays.shares.extend(
                of_patch
                    .iter()
                    .enumerate()
                    .map(|(part, &found)| cell.share(part, found)),
            );
            let near = self.near(patch);
            let positions = near.iter().map(|&emitter| self.lights.position(emitter));
            view.leave_out(&self.lights, positions);
            for receiver in self.mesh.elements_of_patch(patch) {
                self.aim(patch, receiver, wanted(receiver), seed, view, &mut rays);
                rays.ends.push(rays.strata.len());
            }
            self.mesh
                .visibility()
                .transmittances(&rays.segments, &mut rays.through);
            to_cell.rays += rays.segments.len() as u64;
            self.collect(patch, wanted, of_patch, &mut rays, to_cell);
        }
        to_cell.close();
        cell.found = found;
        cell.sum_up();
    }

    /// Emitters that nearly touch a patch, itself among them.
    fn near(&self, patch: usize) -> Vec<usize> {
        let receiver = place_of(&self.mesh, self.mesh.patches()[patch]);
        let mut near = Vec::new();
        self.lights.visit_near(&receiver, NEAR, |i| near.push(i));
        near.retain(|&i| self.emitters[i].patch == patch || self.emitters[i].is_near(&receiver));
        near.sort_unstable();
        near
    }

    /// Chooses the rays of a receiver.
    fn aim(
        &self,
        patch: usize,
        receiver: usize,
        count: u32,
        seed: u64,
        view: &View,
        rays: &mut Rays,
    ) {
        let first = rays.numbers.len();
        let start_of_sums = rays.sums.len();
        rays.numbers.resize(first + count as usize, 0.0);
        rays.sums.resize(start_of_sums + self.channels, 0.0);
        let start = Start::new(&self.mesh, receiver);
        let Some(start) = start.filter(|_| count > 0) else {
            return;
        };
        let place = place_of(&self.mesh, self.mesh.elements()[receiver]);
        view.look(&place, &rays.shares, &mut rays.sight);
        let sums = &mut rays.sums[start_of_sums..];
        for (sum, expected) in sums.iter_mut().zip(rays.sight.total()) {
            *sum = expected * f64::from(count);
        }
        let seed = hash(hash(self.seed, receiver as u64), seed);
        let (towards, from) = (Sobol4::new(seed), Sobol4::new(hash(seed, 2)));
        let mut index = 0;
        for stratum in rays.sight.strata(count, unit(hash(seed, 3))) {
            let weight = count as f32 / stratum.expected_rays;
            for ray in 0..stratum.rays {
                let [sample, u, v, _] = towards.point(index);
                let sample = (ray as f32 + sample) / stratum.rays as f32;
                let Some(choice) = rays.sight.choose(stratum.part, sample) else {
                    break;
                };
                let position = first + index as usize;
                let weight = weight / choice.probability;
                let expected = view.expected(&choice, &rays.sight);
                for (sum, expected) in sums.iter_mut().zip(expected) {
                    *sum -= f64::from(expected * weight);
                    rays.numbers[position] -= expected * weight;
                }
                let [s, t, ..] = from.point(index);
                index += 1;
                let (ray, ends) = self.sample(patch, &start, view, &choice, [u, v, s, t]);
                if ray.weight > 0.0 {
                    rays.segments.push(ends);
                    rays.rays.push(Ray {
                        position: crate::index32(position),
                        part: crate::index32(stratum.part),
                        weight: ray.weight * weight,
                        ..ray
                    });
                }
            }
            rays.strata.push(stratum);
        }
    }

    /// A ray to a point of a receiver on a patch from one of an emitter, and its ends.
    #[inline]
    fn sample(
        &self,
        patch: usize,
        start: &Start,
        view: &View,
        choice: &Choice,
        [u, v, s, t]: [f32; 4],
    ) -> (Ray, (Vec3, Vec3)) {
        let (emitter, of_emitter) = self.lights.choose(view.node(choice), choice.rest);
        let (element, of_element, u) = self.choose_element(emitter, u);
        let (area, light_normal) = &self.elements.areas[element];
        let (to, normal) = start.point([s, t]);
        let from = area.point([u, v]);
        let kernel = kernel(to - from, [*light_normal, normal]);
        let visibility = self.mesh.visibility();
        let is_left_out = of_emitter < 1.0 && self.is_left_out(patch, emitter);
        let ray = Ray {
            position: 0,
            part: 0,
            element: crate::index32(element),
            weight: if is_left_out {
                0.0
            } else {
                kernel * area.area() / (PI * of_emitter * of_element)
            },
        };
        let ends = (
            visibility.off_surface(to, normal),
            visibility.off_surface(from, *light_normal),
        );
        (ray, ends)
    }

    /// Whether an emitter is the patch itself or nearly touches it.
    fn is_left_out(&self, patch: usize, emitter: usize) -> bool {
        let emitter = &self.emitters[emitter];
        let receiver = place_of(&self.mesh, self.mesh.patches()[patch]);
        emitter.patch == patch || emitter.is_near(&receiver)
    }

    /// An element of an emitter for a number in [0, 1), its probability, and what is left of the number.
    fn choose_element(&self, emitter: usize, sample: f32) -> (usize, f32, f32) {
        let range = self.elements.firsts[emitter]..self.elements.firsts[emitter + 1];
        if range.len() == 1 {
            return (range.start as usize, 1.0, sample);
        }
        let source = &self.emitters[emitter].source;
        let choice = source.choose(sample);
        let element = range.start as usize + choice.element - source.first;
        (element, super::to_f32(choice.probability), choice.rest)
    }

    /// Sums up what the rays of a patch brought to each of its receivers.
    fn collect(
        &self,
        patch: usize,
        wanted: &dyn Fn(usize) -> u32,
        found: &mut [Found],
        rays: &mut Rays,
        to_cell: &mut ToCell,
    ) {
        let mut answers = rays.rays.iter().zip(&rays.through).peekable();
        let (mut first, mut done) = (0, 0);
        let (mut strata_left, mut ends) = (rays.strata.as_slice(), rays.ends.iter());
        let receivers = self.mesh.elements_of_patch(patch);
        for (receiver, sums) in receivers.zip(rays.sums.chunks_exact_mut(self.channels)) {
            let count = wanted(receiver);
            let end = first + count;
            while let Some((ray, through)) = answers.next_if(|(ray, _)| ray.position < end) {
                found[ray.part as usize].count(!through.is_black());
                let number = &mut rays.numbers[ray.position as usize];
                let exitance = self.elements.exitance_of(ray.element, self.channels);
                for (channel, (sum, exitance)) in sums.iter_mut().zip(exitance).enumerate() {
                    let brought = ray.weight * exitance * through[channel % BANDS];
                    *sum += f64::from(brought);
                    *number += brought;
                }
            }
            let n = f64::from(count.max(1));
            let light = sums.iter().map(|sum| super::to_f32(sum / n));
            to_cell.irradiance.extend(light);
            let (strata, others) = strata_left.split_at(ends.next().map_or(0, |end| end - done));
            (strata_left, done) = (others, done + strata.len());
            let numbers = &rays.numbers[first as usize..end as usize];
            let spread = Spread::of(numbers, strata);
            to_cell.add(&spread);
            first = end;
        }
    }
}

impl Rays {
    fn clear(&mut self) {
        self.rays.clear();
        self.segments.clear();
        self.numbers.clear();
        self.sums.clear();
        self.shares.clear();
        self.strata.clear();
        self.ends.clear();
    }
}

/// A number in [0, 1) of random bits.
fn unit(bits: u64) -> f32 {
    (bits >> 40) as f32 / (1_u32 << 24) as f32
}
