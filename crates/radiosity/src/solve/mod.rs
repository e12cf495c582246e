//! Ways to the equilibrium of light.

pub mod ambient;
pub mod gathering;
pub mod gauss;
pub mod gauss_seidel;
pub mod jacobi;
mod max_tree;
pub mod on_matrix;
pub mod shooting;
pub mod southwell;
pub mod system;

pub use ambient::ambient_irradiance;
pub use gathering::Gathering;
pub use gauss::Gauss;
pub use gauss_seidel::GaussSeidel;
pub use jacobi::Jacobi;
pub use on_matrix::OnMatrix;
pub use shooting::{Order, Shooting};
pub use southwell::Southwell;
pub use system::{MatrixMethod, MatrixRun, MatrixSolverKind, solve_matrix};

use crate::solution::Solution;

/// A stepped solver. Its whole state is its [`Solution`] (light received, light unshot), so it can be stopped, stored,
/// resumed and handed to another solver.
pub trait Solver {
    /// Does one step.
    fn step(&mut self) -> Progress;

    /// Light as it stands.
    fn solution(&self) -> &Solution;

    /// Light as it stands, taken out.
    fn into_solution(self) -> Solution
    where
        Self: Sized;
}

/// Where a solver is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Progress {
    /// Steps done, those before a resumption included.
    pub iteration: u64,
    /// Unshot share of all emitted flux; also the share of the final light that is still missing, as long as what is
    /// unshot is reflected like what was emitted.
    pub unshot: f64,
    /// Largest share of the emitted flux that one patch has still to shoot.
    pub residual: f64,
}

/// Steps until the unshot share is at most `tolerance` or `go_on` says no.
pub fn run(
    solver: &mut impl Solver,
    tolerance: f64,
    mut go_on: impl FnMut(&Progress, &Solution) -> bool,
) -> Progress {
    let mut progress = Progress {
        iteration: solver.solution().provenance.steps,
        unshot: solver.solution().unshot_fraction(),
        residual: 1.0,
    };
    while progress.unshot > tolerance
        && progress.residual > 0.0
        && go_on(&progress, solver.solution())
    {
        progress = solver.step();
    }
    progress
}
