//! Matrix methods as solvers of a [`Solution`].
//!
//! Methods work on patches; light is kept on elements, and rows of form factors stay the truth. A sweep therefore
//! solves for a *correction*: given what each patch has unshot, how much should each shoot? Then all of it is shot
//! through the rows, which keeps energy exactly, reaches every element and leaves the true residual. Where patches are
//! not what the matrix believes (textures that vary within one), later sweeps correct for it.

use crate::error::RadiosityError;
use crate::form_factor::matrix::{Entries, patch_area};
use crate::form_factor::{FormFactors, MatrixOptions, Row, ViewFactorMatrix};
use crate::patch::PatchMesh;
use crate::solution::{BANDS, Solution};
use crate::solve::system::{Channel, MatrixMethod, MatrixSolverKind, System};
use crate::solve::{Progress, Solver};
use rayon::prelude::*;

/// Rows that are filled at the same time when a correction is shot.
const ROWS: usize = 64;

/// A matrix method that solves a solution.
///
/// A step is one of the method (a pivot column, a sweep, a patch). The solution and its energy balance are brought up
/// to date at the end of each sweep and by [`Solver::into_solution`]; in between they stay those of the sweep before,
/// consistent in themselves. What is unshot is spread evenly over a patch. All bands and groups go in one pass.
pub struct OnMatrix<'a> {
    factors: &'a dyn FormFactors,
    solution: Solution,
    method: Box<dyn MatrixMethod>,
    matrices: Vec<Entries>,
    areas: Vec<f64>,
    /// Unknowns: the radiosity that each patch should still shoot.
    channels: Vec<Channel>,
    emitted: f64,
    /// Whether steps were done since the solution was brought up to date.
    is_pending: bool,
}

impl<'a> OnMatrix<'a> {
    /// Goes on from a solution; builds the matrix. Rows are asked for again at the end of each sweep, so
    /// [`Cached`](crate::form_factor::Cached) factors pay.
    ///
    /// # Errors
    /// More memory than the options allow.
    pub fn new(
        factors: &'a dyn FormFactors,
        solution: Solution,
        kind: MatrixSolverKind,
        options: MatrixOptions,
    ) -> Result<Self, RadiosityError> {
        let mesh = solution.mesh().clone();
        let (count, patches) = (solution.groups().len() * BANDS, mesh.patches().len());
        // Gathering by the reciprocal rows is the same as shooting by the rows, whatever their error.
        let matrices: Vec<Entries> = ViewFactorMatrix::build(factors, options)?
            .into_iter()
            .map(|m| m.entries().reciprocal(m.areas()))
            .collect();
        kind.refuse_memory(&matrices, count, options.memory_limit)?;
        let areas: Vec<f64> = (0..patches).map(|p| patch_area(&mesh, p)).collect();
        let channels = (0..count)
            .map(|channel| {
                let (group, band) = (channel / BANDS, channel % BANDS);
                let unshot = |p: usize| {
                    let flux = solution.unshot_patch_flux(p, group, band);
                    if areas[p] > 0.0 { flux / areas[p] } else { 0.0 }
                };
                let emission: Vec<f64> = (0..patches).map(unshot).collect();
                Channel {
                    matrix: if matrices.len() == 1 { 0 } else { band },
                    reflectance: (0..patches)
                        .map(|p| mean_reflectance(&mesh, p, band, areas[p]))
                        .collect(),
                    radiosity: if kind.starts_at_emission() {
                        emission.clone()
                    } else {
                        vec![0.0; patches]
                    },
                    emission,
                }
            })
            .collect();
        let emitted = (0..BANDS)
            .map(|band| solution.total_balance(band).emitted)
            .sum();
        let mut solver = Self {
            factors,
            solution,
            method: kind.method(),
            matrices,
            areas,
            channels,
            emitted,
            is_pending: false,
        };
        solver.solution.provenance.solver = kind.name().into();
        Ok(solver)
    }

    /// Shoots the correction through the rows and starts a new one.
    fn commit(&mut self) {
        let mesh = self.solution.mesh().clone();
        let shoots = |&p: &usize| self.channels.iter().any(|c| c.radiosity[p] != 0.0);
        let shooters: Vec<usize> = (0..self.areas.len()).filter(shoots).collect();
        let mut rows = vec![Row::default(); ROWS.min(shooters.len())];
        for chunk in shooters.chunks(ROWS) {
            let jobs: Vec<_> = chunk.iter().zip(&mut rows).collect();
            jobs.into_par_iter()
                .for_each(|(&p, row)| self.factors.fill_row(mesh.patches()[p], row));
            for (&p, row) in chunk.iter().zip(&rows) {
                self.shoot(&mesh, p, row);
            }
        }
        self.write_unshot(&mesh);
        for channel in &mut self.channels {
            channel.radiosity.fill(0.0);
        }
        self.method.restart();
        self.is_pending = false;
    }

    /// Spreads the correction of one patch; its `emission` becomes what is left to shoot.
    fn shoot(&mut self, mesh: &PatchMesh, patch: usize, row: &Row) {
        let elements = mesh.elements().len();
        let (irradiance, _, balance) = self.solution.channels_mut();
        for (c, channel) in self.channels.iter_mut().enumerate() {
            let (group, band) = (c / BANDS, c % BANDS);
            let flux = channel.radiosity[patch] * self.areas[patch];
            channel.emission[patch] -= channel.radiosity[patch];
            if flux == 0.0 {
                continue;
            }
            let irradiance = &mut irradiance[c * elements..(c + 1) * elements];
            let (mut received, mut reflected) = (0.0, 0.0);
            for (&e, &fraction) in row.receivers.iter().zip(row.band(band)) {
                let e = e as usize;
                let fraction = f64::from(fraction);
                let (area, to) = (f64::from(mesh.exposed_area(e)), mesh.patch_of_element(e));
                let reflectance = f64::from(mesh.reflectance()[e][band]);
                if area > 0.0 {
                    irradiance[e] += to_f32(fraction * flux / area);
                    channel.emission[to] += reflectance * fraction * flux / self.areas[to];
                }
                received += fraction * f64::from(1.0 - mesh.transmittance()[e][band]);
                reflected += fraction * reflectance;
            }
            let backs = f64::from(row.absorbed[band]);
            balance[group][band].absorbed += flux * (received - reflected + backs);
            balance[group][band].escaped += flux * f64::from(row.escaped[band]);
        }
    }

    fn write_unshot(&mut self, mesh: &PatchMesh) {
        let elements = mesh.elements().len();
        let (_, unshot, _) = self.solution.channels_mut();
        for (channel, unshot) in self.channels.iter().zip(unshot.chunks_mut(elements)) {
            for (p, &left) in channel.emission.iter().enumerate() {
                unshot[mesh.elements_of_patch(p)].fill(to_f32(left));
            }
        }
    }

    /// Largest and summed residual flux over patches, channels together.
    fn residual(&self) -> (f64, f64) {
        let flux = |p: usize| -> f64 {
            let left: f64 = self.channels.iter().map(|c| c.emission[p].abs()).sum();
            left * self.areas[p]
        };
        let fluxes = (0..self.areas.len()).map(flux);
        fluxes.fold((0.0, 0.0), |(most, sum), f| (f64::max(most, f), sum + f))
    }
}

impl Solver for OnMatrix<'_> {
    fn step(&mut self) -> Progress {
        let mut system = System {
            matrices: &self.matrices,
            areas: &self.areas,
            channels: &mut self.channels,
        };
        self.is_pending = true;
        if self.method.step(&mut system) {
            self.commit();
        }
        self.solution.provenance.steps += 1;
        let emitted = if self.emitted > 0.0 {
            self.emitted
        } else {
            1.0
        };
        let (largest, sum) = self.residual();
        Progress {
            iteration: self.solution.provenance.steps,
            unshot: sum / emitted,
            residual: largest / emitted,
        }
    }

    fn solution(&self) -> &Solution {
        &self.solution
    }

    fn into_solution(mut self) -> Solution {
        // What an unfinished sweep already knows; of an elimination that is nothing new.
        if self.is_pending {
            self.commit();
        }
        self.solution
    }
}

fn mean_reflectance(mesh: &PatchMesh, patch: usize, band: usize, area: f64) -> f64 {
    let reflected: f64 = mesh
        .elements_of_patch(patch)
        .map(|e| f64::from(mesh.exposed_area(e)) * f64::from(mesh.reflectance()[e][band]))
        .sum();
    if area > 0.0 { reflected / area } else { 0.0 }
}

#[expect(clippy::cast_possible_truncation, reason = "light is kept in f32")]
fn to_f32(x: f64) -> f32 {
    x as f32
}
