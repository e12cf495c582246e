//! The GPU as a backend of solvers.

use crate::context::Context;
use crate::error::GpuError;
use crate::hemicube::GpuHemicube;
use crate::raycast::GpuRayCast;
use crate::shooting::GpuShooting;
use core::fmt;
use hemicube_radiosity::backend::{Backend, Cpu, Shooter};
use hemicube_radiosity::form_factor::{FormFactorKind, FormFactors};
use hemicube_radiosity::patch::PatchMesh;
use hemicube_radiosity::solve::Order;
use hemicube_radiosity::{RadiosityError, Solution, SolveOptions};
use std::sync::{Arc, OnceLock};

/// Hears once why the CPU goes on.
pub(crate) type Report = Arc<dyn Fn(&GpuError) + Send + Sync>;

/// Hemicubes drawn on the device for every solver, or rays cast there if [`SolveOptions::form_factors`] says rays; with
/// hemicubes, sorted shooting stays on it altogether.
///
/// Where the device cannot do it, or is lost, the CPU takes over with the same way to form factors.
#[derive(Clone)]
pub struct Gpu {
    context: Arc<Context>,
    is_required: bool,
    report: Report,
    /// The first thing that went wrong while it worked.
    failure: Arc<OnceLock<GpuError>>,
}

impl fmt::Debug for Gpu {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Gpu")
            .field("context", &self.context)
            .field("is_required", &self.is_required)
            .finish_non_exhaustive()
    }
}

impl Gpu {
    /// The backend on a device.
    pub fn new(context: Arc<Context>) -> Self {
        Self {
            context,
            is_required: false,
            report: Arc::new(|_| {}),
            failure: Arc::new(OnceLock::new()),
        }
    }

    /// Whether a scene that does not fit the device, or the loss of the device, is an error. Default value: false, the
    /// CPU takes over.
    pub fn with_required(self, is_required: bool) -> Self {
        Self {
            is_required,
            ..self
        }
    }

    /// `report` hears why the CPU goes on. Default value: nobody does.
    pub fn with_report(self, report: impl Fn(&GpuError) + Send + Sync + 'static) -> Self {
        Self {
            report: Arc::new(report),
            ..self
        }
    }

    /// Sorted shooting that keeps its light on the device, going on with a solution; none if the CPU is to do it, which was
    /// reported.
    ///
    /// # Errors
    /// The device is required and cannot do it.
    pub fn shoot(
        &self,
        solution: Solution,
        options: &SolveOptions,
    ) -> Result<Option<GpuShooting>, RadiosityError> {
        match GpuShooting::new(self.context.clone(), solution, options.hemicube) {
            Ok(solver) => Ok(Some(
                solver
                    .with_report(self.while_at_work())
                    .with_most_shots(options.max_steps),
            )),
            Err(error) => {
                self.give_up(&error)?;
                Ok(None)
            }
        }
    }

    /// What to do about what the device cannot do: an error if it is required, else a report.
    fn give_up(&self, error: &GpuError) -> Result<(), RadiosityError> {
        if self.is_required {
            return Err(RadiosityError::Option(error.to_string()));
        }
        (self.report)(error);
        Ok(())
    }

    /// Remembers what goes wrong while the device works, and reports it unless it ends the work.
    fn while_at_work(&self) -> Report {
        let Self {
            is_required,
            report,
            failure,
            ..
        } = self.clone();
        Arc::new(move |error| {
            if failure.set(error.clone()).is_ok() && !is_required {
                report(error);
            }
        })
    }
}

/// Whether form factors come from rays; from hemicubes otherwise.
fn casts_rays(options: &SolveOptions) -> bool {
    options.form_factors == FormFactorKind::RayCast
}

impl Backend for Gpu {
    fn name(&self, options: &SolveOptions) -> String {
        let name = if casts_rays(options) {
            "gpu-raycast"
        } else {
            "gpu"
        };
        name.to_owned()
    }

    fn form_factors(
        &self,
        mesh: Arc<PatchMesh>,
        options: &SolveOptions,
    ) -> Result<Box<dyn FormFactors>, RadiosityError> {
        let (context, report) = (self.context.clone(), self.while_at_work());
        let made: Result<Box<dyn FormFactors>, GpuError> = if casts_rays(options) {
            GpuRayCast::new(context, mesh.clone(), options.form_factor_options().raycast)
                .map(|factors| Box::new(factors.with_report(report)) as _)
        } else {
            GpuHemicube::new(context, mesh.clone(), options.hemicube)
                .map(|factors| Box::new(factors.with_report(report)) as _)
        };
        match made {
            Ok(factors) => Ok(factors),
            Err(error) => {
                self.give_up(&error)?;
                Cpu.form_factors(mesh, options)
            }
        }
    }

    fn shooting(
        &self,
        solution: Solution,
        options: &SolveOptions,
        order: Order,
    ) -> Result<Shooter, RadiosityError> {
        if order != Order::Sorted || casts_rays(options) {
            return Ok(Shooter::None(Box::new(solution)));
        }
        let kept = solution.clone();
        Ok(match self.shoot(solution, options)? {
            Some(solver) => Shooter::Own(Box::new(solver)),
            None => Shooter::None(Box::new(kept)),
        })
    }

    fn verdict(&self) -> Result<(), RadiosityError> {
        match self.failure.get() {
            Some(failure) if self.is_required => Err(RadiosityError::Option(failure.to_string())),
            _ => Ok(()),
        }
    }
}
