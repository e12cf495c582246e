//! Light from many emitters by shadow rays.
//!
//! The emitters of a ray are chosen from a cut of a [tree](super::lights) in proportion to a bound of what they bring
//! unoccluded (Shirley, Wang, Zimmerman 1996), and to the root of the share of earlier rays of the patch and its
//! [cell](super::cells) that found them: of all probabilities that know visibility as a share only, those make the
//! variance least. One sequence for all rays of a receiver takes the emitters in turn, neighbours after each other, so
//! what is all visible or all hidden makes no error, however many emitters there are. Emitters that nearly touch a
//! receiver are left out, because the kernel of point and point grows beyond all bounds there.

use super::cells::{Cell, Found, cells};
use super::estimates::{Brought, Round, square_by_pairs};
use super::lights::{Lamp, Lights, Place, Table, choose};
use super::receivers::{Receivers, Start};
use super::source::Source;
use crate::form_factor::raycast::kernel;
use crate::patch::exposure::ExposedArea;
use crate::patch::{NodeId, PatchMesh};
use crate::sampling::hash;
use crate::sobol::Sobol4;
use crate::solution::BANDS;
use core::f32::consts::PI;
use glam::Vec3;
use hemicube_raster::Rgb;
use rayon::prelude::*;
use std::sync::Arc;

/// Emitters nearer than so many radii of both are left out.
const NEAR: f32 = 2.0;
/// Marks patches that emit nothing.
const DARK: u32 = u32::MAX;

/// Emitters, and what is known of what hides them.
pub(super) struct ShadowRays {
    mesh: Arc<PatchMesh>,
    receivers: Receivers,
    channels: usize,
    emitters: Vec<Emitter>,
    elements: Elements,
    /// Of each patch, or [`DARK`].
    emitter_of_patch: Vec<u32>,
    lights: Lights,
    cells: Vec<Cell>,
    seed: u64,
}

/// A patch that emits.
pub(super) struct Emitter {
    pub(super) patch: usize,
    pub(super) id: NodeId,
    place: Place,
    source: Source,
    /// By channel.
    pub(super) flux: Vec<f64>,
}

/// The elements of all emitters, side by side: rays take them in no order.
struct Elements {
    /// The first of each emitter.
    firsts: Vec<u32>,
    /// With their normals.
    areas: Vec<(ExposedArea, Vec3)>,
    /// `[element][channel]`.
    exitance: Vec<f32>,
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
    /// What each of them brought, of a receiver.
    numbers: Vec<f32>,
    /// By channel.
    sums: Vec<f64>,
}

/// What was brought to the receivers of a cell, one after the other.
#[derive(Default)]
struct ToCell {
    irradiance: Vec<f32>,
    squares: Vec<f32>,
    rays: u64,
}

impl ShadowRays {
    /// Emitters by their exitance, `[channel][element]`.
    pub(super) fn new(
        mesh: Arc<PatchMesh>,
        receivers: Receivers,
        exitance: &[f32],
        seed: u64,
    ) -> Self {
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
                cells(&places, &lights, NEAR)
            },
            lights,
            receivers,
            channels,
            elements: Elements::of(&mesh, &emitters, exitance),
            emitters,
            emitter_of_patch,
            mesh,
            seed,
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
        let receiver = place_of(&self.mesh, self.mesh.patches()[patch]);
        let mut near = Vec::new();
        self.lights.visit_near(&receiver, NEAR, |i| near.push(i));
        near.sort_unstable();
        let emitters = near.into_iter().map(|i| &self.emitters[i]);
        emitters
            .filter(|emitter| emitter.patch != patch && emitter.is_near(&receiver))
            .collect()
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
                for receiver in self.receivers.of_patch(&self.mesh, patch as usize) {
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
        brought
    }

    fn light_cell(&self, cell: &mut Cell, round: Round<'_>) -> ToCell {
        let mut to_cell = ToCell::default();
        let receivers = |&patch: &u32| self.receivers.of_patch(&self.mesh, patch as usize);
        let mut all = cell.patches.iter().flat_map(receivers);
        if all.all(|receiver| round.wanted[receiver] == 0) {
            return to_cell;
        }
        let parts = cell.cut.iter();
        let tables: Vec<Table> = parts
            .map(|&part| self.lights.table(part, &cell.around))
            .collect();
        let width = cell.cut.len();
        let mut found = core::mem::take(&mut cell.found);
        found.resize(width * cell.patches.len(), Found::default());
        let mut rays = Rays::default();
        for (i, &patch) in cell.patches.iter().enumerate() {
            let of_patch = &mut found[i * width..(i + 1) * width];
            let chances = self.chances(patch as usize, cell, &tables, of_patch);
            rays.clear();
            if !chances.slots.is_empty() {
                self.aim(
                    patch as usize,
                    &chances,
                    &tables,
                    round,
                    of_patch,
                    &mut rays,
                );
            }
            self.mesh
                .visibility()
                .transmittances(&rays.segments, &mut rays.through);
            to_cell.rays += rays.segments.len() as u64;
            self.collect(patch as usize, round, of_patch, &mut rays, &mut to_cell);
        }
        cell.found = found;
        cell.sum_up();
        to_cell
    }

    /// How often the parts of a cut are chosen for a patch.
    fn chances(&self, patch: usize, cell: &Cell, tables: &[Table], found: &[Found]) -> Chances {
        let receiver = place_of(&self.mesh, self.mesh.patches()[patch]);
        let is_left_out = |emitter: usize| {
            let emitter = &self.emitters[emitter];
            emitter.patch == patch || emitter.is_near(&receiver)
        };
        let mut chances = Chances::default();
        for (slot, &part) in cell.cut.iter().enumerate() {
            let bound = self.lights.bound(part, &receiver);
            let is_lit = bound > 0.0 && tables[slot].total() > 0.0;
            if is_lit && !self.lights.lamp(part).is_some_and(is_left_out) {
                chances.push(slot, bound * cell.share(slot, found[slot]).sqrt());
            }
        }
        chances
    }

    /// Chooses the rays of a patch.
    fn aim(
        &self,
        patch: usize,
        chances: &Chances,
        tables: &[Table],
        round: Round<'_>,
        found: &mut [Found],
        rays: &mut Rays,
    ) {
        let mut first = 0;
        for receiver in self.receivers.of_patch(&self.mesh, patch) {
            let count = round.wanted[receiver];
            let start = Start::new(&self.mesh, self.receivers, receiver);
            if let Some(start) = start.filter(|_| count > 0) {
                let seed = hash(self.seed, receiver as u64);
                let seed = hash(seed, u64::from(round.before[receiver]));
                let (towards, from) = (Sobol4::new(seed), Sobol4::new(hash(seed, 2)));
                for index in 0..count {
                    let samples = [towards.point(index), from.point(index)];
                    let (slot, ray, ends) = self.sample(&start, chances, tables, samples);
                    if ray.weight > 0.0 {
                        let position = first + index;
                        rays.segments.push(ends);
                        rays.rays.push(Ray { position, ..ray });
                    } else {
                        found[slot].count(false);
                    }
                }
            }
            first += count;
        }
    }

    /// A ray to a point of a receiver from one of an emitter, with the part of the cut that it belongs to, and its ends.
    #[inline]
    fn sample(
        &self,
        start: &Start,
        chances: &Chances,
        tables: &[Table],
        [[wanted, u, v, _], [s, t, ..]]: [[f32; 4]; 2],
    ) -> (usize, Ray, (Vec3, Vec3)) {
        let (slot, of_part, rest) = chances.choose(wanted);
        let (emitter, of_emitter) = tables[slot].choose(rest);
        let (element, of_element, u) = self.choose_element(emitter, u);
        let (area, light_normal) = &self.elements.areas[element];
        let (to, normal) = start.point([s, t]);
        let from = area.point([u, v]);
        let kernel = kernel(to - from, [*light_normal, normal]);
        let visibility = self.mesh.visibility();
        let ray = Ray {
            position: 0,
            part: crate::index32(slot),
            element: crate::index32(element),
            weight: kernel * area.area() / (PI * of_part * of_emitter * of_element),
        };
        let ends = (
            visibility.off_surface(to, normal),
            visibility.off_surface(from, *light_normal),
        );
        (slot, ray, ends)
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
        round: Round<'_>,
        found: &mut [Found],
        rays: &mut Rays,
        to_cell: &mut ToCell,
    ) {
        let receivers = self.receivers.of_patch(&self.mesh, patch);
        let mut answers = rays.rays.iter().zip(&rays.through).peekable();
        let mut first = 0;
        for receiver in receivers {
            let count = round.wanted[receiver];
            let end = first + count;
            rays.numbers.clear();
            rays.numbers.resize(count as usize, 0.0);
            rays.sums.clear();
            rays.sums.resize(self.channels, 0.0);
            while let Some((ray, through)) = answers.next_if(|(ray, _)| ray.position < end) {
                found[ray.part as usize].count(!through.is_black());
                let number = &mut rays.numbers[(ray.position - first) as usize];
                let exitance = self.elements.exitance_of(ray.element, self.channels);
                for (channel, (sum, exitance)) in rays.sums.iter_mut().zip(exitance).enumerate() {
                    let brought = ray.weight * exitance * through[channel % BANDS];
                    *sum += f64::from(brought);
                    *number += brought;
                }
            }
            let n = f64::from(count.max(1));
            let light = rays.sums.iter().map(|sum| super::to_f32(sum / n));
            to_cell.irradiance.extend(light);
            to_cell.squares.push(square_by_pairs(&rays.numbers));
            first = end;
        }
    }
}

impl Rays {
    fn clear(&mut self) {
        self.rays.clear();
        self.segments.clear();
    }
}

impl Elements {
    /// Of emitters by their exitance, `[channel][element]`.
    fn of(mesh: &PatchMesh, emitters: &[Emitter], exitance: &[f32]) -> Self {
        let mut elements = Self {
            firsts: vec![0],
            areas: Vec::new(),
            exitance: Vec::new(),
        };
        let count = mesh.elements().len();
        for emitter in emitters {
            for e in mesh.elements_of_patch(emitter.patch) {
                let normal = mesh.node(mesh.elements()[e]).normal;
                elements.areas.push((mesh.exposed(e), normal));
                elements
                    .exitance
                    .extend(exitance[e..].iter().step_by(count));
            }
            elements.firsts.push(crate::index32(elements.areas.len()));
        }
        elements
    }

    /// By channel.
    fn exitance_of(&self, element: u32, channels: usize) -> &[f32] {
        let start = element as usize * channels;
        &self.exitance[start..start + channels]
    }
}

/// Which parts of a cut rays go to, by running sums.
#[derive(Default)]
struct Chances {
    /// Their positions in the cut.
    slots: Vec<usize>,
    sums: Vec<f32>,
}

impl Chances {
    fn push(&mut self, slot: usize, chance: f32) {
        let sum = self.sums.last().copied().unwrap_or(0.0);
        self.slots.push(slot);
        self.sums.push(sum + chance);
    }

    /// Position of a part in the cut, its probability, and what is left of a number in [0, 1).
    fn choose(&self, sample: f32) -> (usize, f32, f32) {
        let (index, probability, rest) = choose(&self.sums, sample);
        (self.slots[index], probability, rest)
    }
}

impl Emitter {
    /// None if the patch emits nothing.
    fn new(mesh: &PatchMesh, patch: usize, exitance: &[f32], channels: usize) -> Option<Self> {
        let count = mesh.elements().len();
        let exitance = |e: usize, channel: usize| exitance[channel * count + e];
        let source = Source::new(mesh, patch, |e| {
            let sum: f32 = (0..channels).map(|channel| exitance(e, channel)).sum();
            f64::from(sum * mesh.exposed_area(e))
        });
        if source.total() <= 0.0 {
            return None;
        }
        let id = mesh.patches()[patch];
        let elements = mesh.elements_of_patch(patch);
        let flux = |channel: usize| {
            let of = |e: usize| f64::from(exitance(e, channel)) * f64::from(mesh.exposed_area(e));
            elements.clone().map(of).sum()
        };
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
pub(super) fn place_of(mesh: &PatchMesh, id: NodeId) -> Place {
    let node = mesh.node(id);
    let corners = mesh.polygon(id);
    let distances = corners.iter().map(|c| c.distance(node.centroid));
    Place::disc(node.centroid, node.normal, distances.fold(0.0, f32::max))
}
