//! Where form factors and shooting come from: this crate, or a device that it knows nothing of.

use crate::error::RadiosityError;
use crate::form_factor::FormFactors;
use crate::job::SolveOptions;
use crate::patch::PatchMesh;
use crate::solution::Solution;
use crate::solve::{Hierarchical, Order, Solver};
use std::sync::Arc;

/// A maker of form factors that may keep the light itself while it shoots.
pub trait Backend: Sync {
    /// Name of its form factors, for reports.
    fn name(&self, options: &SolveOptions) -> String;

    /// Form factors between the nodes of a mesh.
    ///
    /// # Errors
    /// Options out of their range; what does not fit.
    fn form_factors(
        &self,
        mesh: Arc<PatchMesh>,
        options: &SolveOptions,
    ) -> Result<Box<dyn FormFactors>, RadiosityError>;

    /// A solver of its own that goes on with a solution by shooting, if it has one for this order.
    ///
    /// # Errors
    /// Options out of their range; what does not fit.
    fn shooting(
        &self,
        solution: Solution,
        options: &SolveOptions,
        order: Order,
    ) -> Result<Shooter, RadiosityError> {
        let _ = (options, order);
        Ok(Shooter::None(Box::new(solution)))
    }

    /// Told of a hierarchical solver when it ends: its links are not kept in the solution.
    fn finished(&self, solver: &Hierarchical) {
        let _ = solver;
    }

    /// Whether the CPU may go on where the backend has failed. It is asked before the CPU takes over and at the end of
    /// the work.
    ///
    /// # Errors
    /// The backend has failed, and was to do everything or nothing.
    fn verdict(&self) -> Result<(), RadiosityError> {
        Ok(())
    }
}

/// A backend's own way to shoot.
pub enum Shooter {
    /// It has one.
    Own(Box<dyn Solver>),
    /// It has none for this; the solution comes back as it was.
    None(Box<Solution>),
}

/// The ways to form factors of this crate.
#[derive(Debug, Clone, Copy, Default)]
pub struct Cpu;

impl Backend for Cpu {
    fn name(&self, options: &SolveOptions) -> String {
        options.form_factors.name().to_owned()
    }

    fn form_factors(
        &self,
        mesh: Arc<PatchMesh>,
        options: &SolveOptions,
    ) -> Result<Box<dyn FormFactors>, RadiosityError> {
        options
            .form_factors
            .build(mesh, &options.form_factor_options())
    }
}

impl<B: Backend + ?Sized> Backend for &B {
    fn name(&self, options: &SolveOptions) -> String {
        (**self).name(options)
    }

    fn form_factors(
        &self,
        mesh: Arc<PatchMesh>,
        options: &SolveOptions,
    ) -> Result<Box<dyn FormFactors>, RadiosityError> {
        (**self).form_factors(mesh, options)
    }

    fn shooting(
        &self,
        solution: Solution,
        options: &SolveOptions,
        order: Order,
    ) -> Result<Shooter, RadiosityError> {
        (**self).shooting(solution, options, order)
    }

    fn finished(&self, solver: &Hierarchical) {
        (**self).finished(solver);
    }

    fn verdict(&self) -> Result<(), RadiosityError> {
        (**self).verdict()
    }
}
