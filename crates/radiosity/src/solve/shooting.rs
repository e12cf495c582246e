//! Progressive refinement by shooting (Cohen, Chen, Wallace, Greenberg 1988).
//!
//! A step takes one patch, spreads its unshot radiosity over all elements by its row of form factors, and leaves it
//! with nothing unshot. Energy is kept at every step: what leaves is received, absorbed or escapes.

use crate::form_factor::{FormFactors, Row};
use crate::patch::NodeId;
use crate::solution::{BANDS, Solution};
use crate::solve::max_tree::MaxTree;
use crate::solve::overshooting::Estimate;
use crate::solve::shot::{Surfaces, to_f32};
use crate::solve::{Progress, Solver};
use rayon::prelude::*;

/// Which patch shoots next, and how much.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Order {
    /// One after the other, round and round.
    Cyclic,
    /// Always the one with most unshot flux.
    Sorted,
    /// The one with most unshot flux, what it will get back counted in; it shoots both
    /// ([`overshooting`](super::overshooting)).
    Overshooting,
}

/// Patches above which several shoot in one step, so that small rows keep all threads busy.
const BATCH_FROM_PATCHES: usize = 20_000;
const BATCH: usize = 64;

/// Shooting, in any order.
pub struct Shooting<'a> {
    factors: &'a dyn FormFactors,
    solution: Solution,
    order: Order,
    /// Unshot flux of each patch, over channels.
    unshot: MaxTree,
    surfaces: Surfaces,
    /// Only where more is shot than is there.
    estimate: Option<Estimate>,
    emitted: f64,
    next: usize,
    batch: usize,
    rows: Vec<Row>,
}

impl<'a> Shooting<'a> {
    /// Goes on from a solution; a new one starts with the light of its emitters.
    pub fn new(factors: &'a dyn FormFactors, solution: Solution, order: Order) -> Self {
        let patches = solution.mesh().patches().len();
        let emitted = solution.reference_flux();
        let batch = if patches > BATCH_FROM_PATCHES {
            BATCH
        } else {
            1
        };
        let mut solver = Self {
            factors,
            order,
            unshot: MaxTree::new(&[]),
            surfaces: Surfaces::new(solution.mesh()),
            estimate: (order == Order::Overshooting).then(|| Estimate::new(solution.mesh())),
            emitted,
            next: usize::try_from(solution.provenance.steps).unwrap_or(0) % patches.max(1),
            batch,
            rows: Vec::new(),
            solution,
        };
        let fluxes: Vec<f64> = (0..patches)
            .map(|p| unshot_magnitude(&solver.solution, p))
            .collect();
        solver.unshot = MaxTree::new(&fluxes);
        solver
    }

    /// The patch, by its position in the mesh's patches, that shoots in the next step.
    pub fn next_patch(&self) -> usize {
        match (self.order, &self.estimate) {
            (Order::Cyclic, _) => self.next,
            (_, None) => self.unshot.largest().0,
            (_, Some(estimate)) => estimate.clone().refreshed(&self.solution).largest().0,
        }
    }

    /// The patches of the next step, without those that have nothing to shoot.
    fn choose(&mut self) -> Vec<usize> {
        if let Some(estimate) = &mut self.estimate {
            let mut shots = estimate.refreshed(&self.solution);
            let chosen: Vec<usize> = core::iter::repeat_with(|| take_largest(&mut shots))
                .map_while(|patch| patch)
                .take(self.batch)
                .collect();
            if !chosen.is_empty() {
                return chosen;
            }
            estimate.forget();
        }
        let mut chosen = Vec::with_capacity(self.batch);
        let patches = self.solution.mesh().patches().len();
        for _ in 0..self.batch {
            let patch = match self.order {
                Order::Sorted | Order::Overshooting => self.unshot.largest().0,
                Order::Cyclic => {
                    let found = (0..patches)
                        .map(|i| (self.next + i) % patches)
                        .find(|&p| self.unshot.get(p) > 0.0);
                    let patch = found.unwrap_or(self.next);
                    self.next = (patch + 1) % patches;
                    patch
                }
            };
            if self.unshot.get(patch) <= 0.0 {
                break;
            }
            self.unshot.set(patch, 0.0);
            chosen.push(patch);
        }
        chosen
    }

    /// Spreads what a patch has unshot, and what it is expected to get back.
    fn shoot(&mut self, patch: usize, row: &Row) {
        let fluxes = self.take_unshot(patch);
        let mesh = self.solution.mesh().clone();
        let elements = mesh.elements().len();
        let (irradiance, unshot, balance) = self.solution.channels_mut();
        for (channel, &flux) in fluxes.iter().enumerate() {
            let (group, band) = (channel / BANDS, channel % BANDS);
            let range = channel * elements..(channel + 1) * elements;
            let (irradiance, unshot) = (&mut irradiance[range.clone()], &mut unshot[range]);
            if flux == 0.0 {
                continue;
            }
            if let Some(estimate) = &mut self.estimate {
                estimate.learn(band, flux, row.escaped[band]);
            }
            let balance = &mut balance[group][band];
            let reflect = |e: usize, _, radiosity| unshot[e] += radiosity;
            self.surfaces
                .spread(row, band, flux, irradiance, balance, reflect);
        }
        self.refresh(row, patch);
    }

    /// Takes what a patch shoots in each channel from its elements; what it shoots ahead of its time they owe.
    fn take_unshot(&mut self, patch: usize) -> Vec<f64> {
        let mut fluxes = unshot_flux(&self.solution, patch);
        let mesh = self.solution.mesh().clone();
        let elements = mesh.elements().len();
        let (_, unshot, _) = self.solution.channels_mut();
        for channel in 0..fluxes.len() {
            let ahead = self.estimate.as_ref().map_or(0.0, |e| e.ambient(channel));
            let reflectance = &self.surfaces.reflectance[channel % BANDS];
            for e in mesh.elements_of_patch(patch) {
                unshot[channel * elements + e] = if ahead == 0.0 {
                    0.0
                } else {
                    -to_f32(ahead) * reflectance[e]
                };
            }
        }
        if self.estimate.is_some() {
            // From what was written, so that not even its rounding is lost.
            let owed = unshot_flux(&self.solution, patch);
            fluxes.iter_mut().zip(owed).for_each(|(f, o)| *f -= o);
        }
        fluxes
    }

    /// Brings the tree up to date for the patches that a row reached.
    fn refresh(&mut self, row: &Row, shooter: usize) {
        let mesh = self.solution.mesh().clone();
        // Receivers ascend and a patch's elements are consecutive, so each patch comes up once.
        let mut reached: Vec<usize> = row
            .receivers
            .iter()
            .map(|&e| mesh.patch_of_element(e as usize))
            .collect();
        reached.dedup();
        let solution = &self.solution;
        let magnitude = |patch: usize| (patch, unshot_magnitude(solution, patch));
        if reached.len() * 8 > mesh.patches().len() {
            let fluxes: Vec<(usize, f64)> =
                reached.par_iter().map(|&patch| magnitude(patch)).collect();
            self.unshot.set_many(fluxes.into_iter());
        } else {
            for patch in reached {
                self.unshot.set(patch, magnitude(patch).1);
            }
        }
        self.unshot.set(shooter, magnitude(shooter).1);
    }
}

/// Position of the largest number, which then counts as taken; none if nothing is left.
fn take_largest(numbers: &mut MaxTree) -> Option<usize> {
    let (index, number) = numbers.largest();
    numbers.set(index, 0.0);
    (number > 0.0).then_some(index)
}

impl Solver for Shooting<'_> {
    fn step(&mut self) -> Progress {
        let chosen = self.choose();
        let mesh = self.solution.mesh().clone();
        let mut rows = core::mem::take(&mut self.rows);
        rows.resize_with(chosen.len().max(1), Row::default);
        let sources: Vec<NodeId> = chosen.iter().map(|&p| mesh.patches()[p]).collect();
        self.factors.fill_rows(&sources, &mut rows[..chosen.len()]);
        for (&patch, row) in chosen.iter().zip(&rows) {
            self.shoot(patch, row);
        }
        self.rows = rows;
        self.solution.provenance.steps += chosen.len() as u64;
        self.progress()
    }

    fn progress(&self) -> Progress {
        let emitted = if self.emitted > 0.0 {
            self.emitted
        } else {
            1.0
        };
        Progress {
            iteration: self.solution.provenance.steps,
            unshot: self.unshot.sum() / emitted,
            residual: self.unshot.largest().1 / emitted,
            noise: None,
        }
    }

    fn solution(&self) -> &Solution {
        &self.solution
    }

    fn into_solution(self) -> Solution {
        self.solution
    }
}

/// Signed unshot flux of a patch in each channel.
pub(super) fn unshot_flux(solution: &Solution, patch: usize) -> Vec<f64> {
    (0..solution.groups().len() * BANDS)
        .map(|channel| solution.unshot_patch_flux(patch, channel / BANDS, channel % BANDS))
        .collect()
}

/// Sum over channels of the absolute unshot flux of a patch.
fn unshot_magnitude(solution: &Solution, patch: usize) -> f64 {
    (0..solution.groups().len() * BANDS)
        .map(|channel| {
            solution
                .unshot_patch_flux(patch, channel / BANDS, channel % BANDS)
                .abs()
        })
        .sum()
}
