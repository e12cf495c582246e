//! Solvers side by side: the same start, the same form factors, the same number of steps (after figure 2 of Cohen,
//! Chen, Wallace, Greenberg 1988, *A progressive refinement approach to fast radiosity image generation*).

use crate::error::RadiosityError;
use crate::form_factor::{FormFactors, MatrixOptions};
use crate::job::{SolverKind, Way};
use crate::solution::Solution;
use crate::solve::element_gathering::ElementGathering;
use crate::solve::{
    Hierarchical, HierarchicalOptions, MatrixSolverKind, NotStarted, OnMatrix, Order, Progress,
    Shooting, Solver, Stochastic, StochasticOptions, ambient_irradiance, run,
};
use crate::stop::Stop;
use hemicube_raster::Rgb;

/// What a solver shows after some steps, and how far that was from the truth on the way.
#[derive(Debug, Clone)]
pub struct Variant {
    /// The solver.
    pub kind: SolverKind,
    /// [`relative_error`] before the first step and after each.
    pub errors: Vec<f64>,
    /// After the last step, for pictures: with the solver's name, so that the ambient estimate is drawn where it
    /// belongs. After gathering it has no balance of energy.
    pub shown: Solution,
}

/// Radiosity of each element as a picture shows it: with the estimate of the light to come where the solver says so.
pub fn shown_radiosity(solution: &Solution, kind: SolverKind) -> Vec<Rgb> {
    let ambient = if kind == SolverKind::AmbientShooting {
        ambient_irradiance(solution)
    } else {
        Rgb::BLACK
    };
    let reflectance = solution.mesh().reflectance();
    let shown = |(e, &rho): (usize, &Rgb)| solution.element_radiosity(e) + rho * ambient;
    reflectance.iter().enumerate().map(shown).collect()
}

/// Root of the mean squared error of radiosities over area and bands, relative to the light that surfaces reflect in
/// truth: `√(Σ A |B - B*|² / Σ A |B* - E|²)`. It is 1 where only emitters shine, and 0 where that is all there is.
pub fn relative_error(radiosity: &[Rgb], truth: &Solution) -> f64 {
    let square = |c: Rgb| -> f64 { c.to_array().iter().map(|&x| f64::from(x).powi(2)).sum() };
    let (mut error, mut light) = (0.0, 0.0);
    for (e, &b) in radiosity.iter().enumerate() {
        let area = f64::from(truth.mesh().exposed_area(e));
        let true_b = truth.element_radiosity(e);
        error += area * square(b - true_b);
        light += area * square(true_b - truth.element_exitance(e));
    }
    if error == 0.0 {
        return 0.0;
    }
    (error / light).sqrt()
}

/// The light that all solvers come to: sorted shooting until at most `tolerance` of what was emitted is unshot. It may
/// end earlier if `go_on` says so.
pub fn converged(
    factors: &dyn FormFactors,
    start: &Solution,
    tolerance: f64,
    go_on: impl FnMut(&Progress, &Solution) -> bool,
) -> Solution {
    let mut solver = Shooting::new(factors, start.clone(), Order::Sorted);
    run(&mut solver, tolerance, go_on);
    solver.into_solution()
}

/// Lets a solver do some steps, none if it was stopped before.
///
/// A step is what one row of form factors brings: a shot, or a patch that gathers. A sweep of Jacobi or Gauss-Seidel
/// and a whole elimination count as many steps as there are patches, an iteration of conjugate gradients twice as
/// many; until they are paid for, nothing new is shown. A stochastic solver casts 256 rays for each element of an average
/// patch, and shows what its next whole step of them brings; a hierarchical one casts as many between the nodes of its
/// links.
///
/// # Errors
/// A matrix that takes more memory than allowed.
pub fn variant(
    factors: &dyn FormFactors,
    start: &Solution,
    kind: SolverKind,
    steps: u64,
    truth: &Solution,
    options: MatrixOptions,
    stop: Stop<'_>,
) -> Result<Option<Variant>, RadiosityError> {
    let mut start = start.clone();
    start.provenance.solver = kind.name().into();
    start.provenance.steps = 0;
    let patches = start.mesh().patches().len() as u64;
    let follow = |work: &mut dyn Work| follow(work, kind, steps, truth, stop);
    Ok(match kind.way() {
        Way::Shooting(order) => follow(&mut Shooting::new(factors, start, order)),
        Way::OnMatrix(MatrixSolverKind::Gathering) => {
            follow(&mut ElementGathering::new(factors, start))
        }
        Way::OnMatrix(kind) => match OnMatrix::new_until(factors, start, kind, options, stop) {
            Ok(solver) => follow(&mut Priced::new(solver, kind, patches)),
            Err(NotStarted::Stopped(_)) => None,
            Err(NotStarted::Failed(error)) => return Err(error),
        },
        Way::Stochastic => {
            let options = StochasticOptions {
                noise: f64::MIN_POSITIVE,
                ..StochasticOptions::default()
            };
            let price = rays_of_step(&start);
            let solver = Stochastic::new(start, options)?;
            follow(&mut ByRays { solver, price })
        }
        Way::Hierarchical => {
            let options = HierarchicalOptions {
                error: f64::MIN_POSITIVE,
                ..HierarchicalOptions::default()
            };
            let price = rays_of_step(&start);
            let solver = Hierarchical::new(start, options)?;
            follow(&mut ByRays { solver, price })
        }
    })
}

/// Rays that are worth a row of form factors: 256 for each element of an average patch.
fn rays_of_step(start: &Solution) -> u64 {
    let mesh = start.mesh();
    let patches = mesh.patches().len() as u64;
    256 * (mesh.elements().len() as u64).div_ceil(patches)
}

/// A solver without rows: a step pays for the rays of one that casts 256 for each element of a patch.
struct ByRays<S> {
    solver: S,
    price: u64,
}

/// A solver that counts its rays.
trait CastsRays: Solver {
    fn cast(&self) -> u64;
}

impl CastsRays for Stochastic {
    fn cast(&self) -> u64 {
        self.rays()
    }
}

impl CastsRays for Hierarchical {
    fn cast(&self) -> u64 {
        self.rays()
    }
}

impl<S: CastsRays> Work for ByRays<S> {
    fn advance(&mut self, steps: u64) {
        while self.solver.cast() < steps * self.price && !self.solver.is_exhausted() {
            self.solver.step();
        }
    }

    fn shown(&self) -> &Solution {
        self.solver.solution()
    }
}

/// Work that is paid in steps of one row each.
trait Work {
    /// Does what so many steps pay for, in all.
    fn advance(&mut self, steps: u64);

    /// Light to be shown.
    fn shown(&self) -> &Solution;
}

fn follow(
    work: &mut dyn Work,
    kind: SolverKind,
    steps: u64,
    truth: &Solution,
    stop: Stop<'_>,
) -> Option<Variant> {
    let mut errors = Vec::new();
    for step in 0..=steps {
        if stop() {
            return None;
        }
        work.advance(step);
        errors.push(relative_error(&shown_radiosity(work.shown(), kind), truth));
    }
    let shown = work.shown().clone();
    Some(Variant {
        kind,
        errors,
        shown,
    })
}

impl Work for Shooting<'_> {
    fn advance(&mut self, steps: u64) {
        // Where patches are many, several shoot at once.
        while self.progress().iteration < steps && self.progress().residual > 0.0 {
            self.step();
        }
    }

    fn shown(&self) -> &Solution {
        self.solution()
    }
}

impl Work for ElementGathering {
    fn advance(&mut self, steps: u64) {
        while self.shown().provenance.steps < steps {
            self.step();
        }
    }

    fn shown(&self) -> &Solution {
        self.shown()
    }
}

/// A solver on a matrix and what one of its rounds costs.
struct Priced<'a> {
    solver: OnMatrix<'a>,
    kind: MatrixSolverKind,
    price: u64,
    paid: u64,
    shown: Solution,
}

impl<'a> Priced<'a> {
    fn new(solver: OnMatrix<'a>, kind: MatrixSolverKind, patches: u64) -> Self {
        let price = match kind {
            MatrixSolverKind::Southwell
            | MatrixSolverKind::Overshooting
            | MatrixSolverKind::Gathering => 1,
            MatrixSolverKind::Jacobi | MatrixSolverKind::GaussSeidel | MatrixSolverKind::Gauss => {
                patches
            }
            MatrixSolverKind::ConjugateGradient => 2 * patches,
        };
        Self {
            shown: solver.solution().clone(),
            solver,
            kind,
            price,
            paid: 0,
        }
    }

    fn round(&mut self) {
        self.solver.step();
        while self.kind == MatrixSolverKind::Gauss && self.solver.is_pending() {
            self.solver.step();
        }
        self.shown = self.solver.snapshot();
    }
}

impl Work for Priced<'_> {
    fn advance(&mut self, steps: u64) {
        while self.paid + self.price <= steps {
            self.round();
            self.paid += self.price;
        }
    }

    fn shown(&self) -> &Solution {
        &self.shown
    }
}
