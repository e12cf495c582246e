//! Matrix methods as solvers of a [`Solution`].
//!
//! Methods work on patches; light is kept on elements, and rows of form factors stay the truth. A sweep therefore
//! solves for a *correction*: given what each patch has unshot, how much should each shoot? Then all of it is shot
//! through the rows, which keeps energy exactly, reaches every element and leaves the true residual. Where patches are
//! not what the matrix believes (textures that vary within one), later sweeps correct for it.

use crate::error::RadiosityError;
use crate::form_factor::matrix::{Entries, MatrixPlan, patch_area};
use crate::form_factor::{FormFactors, MatrixOptions, Row, ViewFactorMatrix};
use crate::patch::{NodeId, PatchMesh};
use crate::solution::{BANDS, Solution};
use crate::solve::shot::{Surfaces, to_f32};
use crate::solve::system::{Channel, MatrixMethod, MatrixSolverKind, System};
use crate::solve::{Progress, Solver};
use crate::stop::{NEVER, Stop};

/// Rows that are filled at the same time when a correction is shot.
const ROWS: usize = 64;

/// Share of the emitted flux below which what no longer falls is rounding.
const ROUNDING: f64 = 1e-5;

/// A matrix method that solves a solution.
///
/// A step is one of the method: a pivot column or a block of them (Gauss), a patch (Southwell, gathering,
/// overshooting), a sweep (Jacobi, Gauss-Seidel), an iteration (conjugate gradients). The solution and its energy
/// balance are brought up to date at the end of each sweep, by [`Solver::settle`] and by [`Solver::into_solution`]; in
/// between they stay those of the sweep before, consistent in themselves, and so does [`Progress`] unless the method
/// keeps residuals (Southwell, overshooting, conjugate gradients). What is unshot is spread evenly over a patch. All
/// bands and groups go in one pass.
pub struct OnMatrix<'a> {
    shots: Shots<'a>,
    solution: Solution,
    method: Box<dyn MatrixMethod>,
    matrices: Vec<Entries>,
    /// Unknowns: the radiosity that each patch should still shoot.
    channels: Vec<Channel>,
    emitted: f64,
    /// Whether steps were done since the solution was brought up to date.
    is_pending: bool,
    /// Summed residual flux after the last sweep.
    left: f64,
    is_exhausted: bool,
}

/// What it takes to shoot a correction.
struct Shots<'a> {
    factors: &'a dyn FormFactors,
    areas: Vec<f64>,
    surfaces: Surfaces,
    stop: Stop<'a>,
}

impl<'a> OnMatrix<'a> {
    /// Goes on from a solution; builds the matrix. Rows are asked for again at the end of each sweep, so
    /// [`Cached`](crate::form_factor::Cached) factors pay.
    ///
    /// # Errors
    /// More memory than the options allow, told before rows are computed (but for a sample of them).
    pub fn new(
        factors: &'a dyn FormFactors,
        solution: Solution,
        kind: MatrixSolverKind,
        options: MatrixOptions,
    ) -> Result<Self, RadiosityError> {
        Self::new_until(factors, solution, kind, options, NEVER)
            .map_err(|stopped| stopped.error().expect("nobody stops it"))
    }

    /// As [`Self::new`], but `stop` may end the work early: while rows are computed the solution comes back as it was,
    /// while a correction is shot the rest of it is dropped.
    ///
    /// # Errors
    /// As [`Self::new`], or [`NotStarted::Stopped`] with the solution.
    pub fn new_until(
        factors: &'a dyn FormFactors,
        solution: Solution,
        kind: MatrixSolverKind,
        options: MatrixOptions,
        stop: Stop<'a>,
    ) -> Result<Self, NotStarted> {
        let mesh = solution.mesh().clone();
        let (count, patches) = (solution.groups().len() * BANDS, mesh.patches().len());
        let limit = options.memory_limit;
        let plan = MatrixPlan::new(factors, options)
            .map_err(|error| kind.refusal(error, patches, count, limit))?;
        kind.refuse_memory(patches, plan.bytes(), count, limit)?;
        let Some(matrices) = ViewFactorMatrix::build_as(factors, plan, stop)? else {
            return Err(NotStarted::Stopped(Box::new(solution)));
        };
        // Gathering by the reciprocal rows is the same as shooting by the rows, whatever their error.
        let areas: Vec<f64> = (0..patches).map(|p| patch_area(&mesh, p)).collect();
        let matrices: Vec<Entries> = matrices
            .into_iter()
            .map(|m| m.into_entries().into_reciprocal(&areas))
            .collect();
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
        let emitted = solution.reference_flux();
        let mut solver = Self {
            shots: Shots {
                factors,
                areas,
                surfaces: Surfaces::new(&mesh),
                stop,
            },
            solution,
            method: kind.method(),
            matrices,
            channels,
            emitted,
            is_pending: false,
            left: f64::INFINITY,
            is_exhausted: false,
        };
        solver.solution.provenance.solver = kind.name().into();
        Ok(solver)
    }

    /// Whether steps were done since the solution was brought up to date.
    pub fn is_pending(&self) -> bool {
        self.is_pending
    }

    /// The solution brought up to date, without ending the sweep.
    pub fn snapshot(&self) -> Solution {
        let mut solution = self.solution.clone();
        if self.is_pending {
            let mut channels = self.channels.clone();
            self.shots.shoot_all(&mut solution, &mut channels);
        }
        solution
    }

    /// Shoots the correction through the rows and starts a new one.
    fn commit(&mut self) {
        self.shots.shoot_all(&mut self.solution, &mut self.channels);
        self.method.restart();
        self.is_pending = false;
        let left = self.residual().1;
        // Light is kept in f32: from some sweep on residuals are its rounding.
        self.is_exhausted = left > 0.999 * self.left && left < ROUNDING * self.emitted;
        self.left = left;
    }

    /// Largest and summed residual flux over patches, channels together.
    fn residual(&self) -> (f64, f64) {
        let known = self.method.residuals().filter(|_| self.is_pending);
        let flux = |p: usize| -> f64 {
            let left: f64 = match known {
                Some(residuals) => residuals.iter().map(|r| r[p].abs()).sum(),
                None => self.channels.iter().map(|c| c.emission[p].abs()).sum(),
            };
            left * self.shots.areas[p]
        };
        let fluxes = (0..self.shots.areas.len()).map(flux);
        fluxes.fold((0.0, 0.0), |(most, sum), f| (f64::max(most, f), sum + f))
    }
}

impl Shots<'_> {
    /// Shoots a correction through the rows. What is left of emission is what is unshot.
    fn shoot_all(&self, solution: &mut Solution, channels: &mut [Channel]) {
        let mesh = solution.mesh().clone();
        let shoots = |&p: &usize| channels.iter().any(|c| c.radiosity[p] != 0.0);
        let shooters: Vec<usize> = (0..self.areas.len()).filter(shoots).collect();
        let mut rows = vec![Row::default(); ROWS.min(shooters.len())];
        for chunk in shooters.chunks(ROWS) {
            if (self.stop)() {
                break;
            }
            let sources: Vec<NodeId> = chunk.iter().map(|&p| mesh.patches()[p]).collect();
            self.factors.fill_rows(&sources, &mut rows[..chunk.len()]);
            for (&p, row) in chunk.iter().zip(&rows) {
                self.shoot(solution, channels, p, row);
            }
        }
        let (_, unshot, _) = solution.channels_mut();
        let elements = mesh.elements().len();
        for (channel, unshot) in channels.iter_mut().zip(unshot.chunks_mut(elements)) {
            channel.radiosity.fill(0.0);
            for (p, &left) in channel.emission.iter().enumerate() {
                unshot[mesh.elements_of_patch(p)].fill(to_f32(left));
            }
        }
    }

    /// Spreads the correction of one patch; its `emission` becomes what is left to shoot.
    fn shoot(&self, solution: &mut Solution, channels: &mut [Channel], patch: usize, row: &Row) {
        let mesh = solution.mesh().clone();
        let elements = mesh.elements().len();
        let (irradiance, _, balance) = solution.channels_mut();
        for (c, channel) in channels.iter_mut().enumerate() {
            let (group, band) = (c / BANDS, c % BANDS);
            let flux = channel.radiosity[patch] * self.areas[patch];
            channel.emission[patch] -= channel.radiosity[patch];
            if flux == 0.0 {
                continue;
            }
            let irradiance = &mut irradiance[c * elements..(c + 1) * elements];
            let (areas, emission) = (&self.areas, &mut channel.emission);
            let reflect = |e: usize, share: f64, _| {
                let to = mesh.patch_of_element(e);
                if areas[to] > 0.0 {
                    emission[to] += share * flux / areas[to];
                }
            };
            let balance = &mut balance[group][band];
            self.surfaces
                .spread(row, band, flux, irradiance, balance, reflect);
        }
    }
}

impl Solver for OnMatrix<'_> {
    fn step(&mut self) -> Progress {
        let mut system = System::new(&self.matrices, &self.shots.areas, &mut self.channels);
        self.is_pending = true;
        if self.method.step(&mut system) {
            self.commit();
        }
        self.solution.provenance.steps += 1;
        self.progress()
    }

    fn progress(&self) -> Progress {
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
            noise: None,
        }
    }

    fn is_exhausted(&self) -> bool {
        self.is_exhausted
    }

    fn settle(&mut self) {
        // What an unfinished sweep already knows; of an elimination that is nothing new.
        if self.is_pending {
            self.commit();
        }
    }

    fn solution(&self) -> &Solution {
        &self.solution
    }

    fn into_solution(mut self) -> Solution {
        self.settle();
        self.solution
    }
}

/// Why a solver on a matrix could not start.
#[derive(Debug)]
pub enum NotStarted {
    /// It was asked to stop while it computed the matrix; the solution as it was.
    Stopped(Box<Solution>),
    /// It cannot be done.
    Failed(RadiosityError),
}

impl NotStarted {
    fn error(self) -> Option<RadiosityError> {
        match self {
            Self::Stopped(_) => None,
            Self::Failed(error) => Some(error),
        }
    }
}

impl From<RadiosityError> for NotStarted {
    fn from(error: RadiosityError) -> Self {
        Self::Failed(error)
    }
}

fn mean_reflectance(mesh: &PatchMesh, patch: usize, band: usize, area: f64) -> f64 {
    let reflected: f64 = mesh
        .elements_of_patch(patch)
        .map(|e| f64::from(mesh.exposed_area(e)) * f64::from(mesh.reflectance()[e][band]))
        .sum();
    if area > 0.0 { reflected / area } else { 0.0 }
}
