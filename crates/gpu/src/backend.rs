//! The GPU as a backend of solvers.

use crate::context::Context;
use crate::error::GpuError;
use crate::hemicube::GpuHemicube;
use crate::shooting::GpuShooting;
use core::fmt;
use hemicube_radiosity::backend::{Backend, Cpu, Shooter};
use hemicube_radiosity::form_factor::FormFactors;
use hemicube_radiosity::patch::PatchMesh;
use hemicube_radiosity::solve::Order;
use hemicube_radiosity::{RadiosityError, Solution, SolveOptions};
use std::sync::Arc;

/// Hears once why the CPU goes on.
pub(crate) type Report = Arc<dyn Fn(&GpuError) + Send + Sync>;

/// Hemicubes drawn on the device for every solver; sorted shooting stays on it altogether.
///
/// Where the device cannot do it, or is lost, the CPU's hemicubes take over.
#[derive(Clone)]
pub struct Gpu {
    context: Arc<Context>,
    is_required: bool,
    report: Report,
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
        }
    }

    /// Whether a scene that does not fit the device is an error. Default value: false, the CPU takes it.
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

    /// What to do about what the device cannot do: an error if it is required, else a report.
    fn give_up(&self, error: &GpuError) -> Result<(), RadiosityError> {
        if self.is_required {
            return Err(RadiosityError::Option(error.to_string()));
        }
        (self.report)(error);
        Ok(())
    }
}

impl Backend for Gpu {
    fn name(&self, _: &SolveOptions) -> String {
        String::from("gpu")
    }

    fn form_factors(
        &self,
        mesh: Arc<PatchMesh>,
        options: &SolveOptions,
    ) -> Result<Box<dyn FormFactors>, RadiosityError> {
        match GpuHemicube::new(self.context.clone(), mesh.clone(), options.hemicube) {
            Ok(factors) => Ok(Box::new(factors.with_report(self.report.clone()))),
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
        let has_panes = solution
            .mesh()
            .transmittance()
            .iter()
            .any(|t| !t.is_black());
        if order != Order::Sorted || has_panes {
            return Ok(Shooter::None(Box::new(solution)));
        }
        match GpuShooting::new(self.context.clone(), solution.clone(), options.hemicube) {
            Ok(solver) => Ok(Shooter::Own(Box::new(
                solver.with_report(self.report.clone()),
            ))),
            Err(error) => {
                self.give_up(&error)?;
                Ok(Shooter::None(Box::new(solution)))
            }
        }
    }
}
