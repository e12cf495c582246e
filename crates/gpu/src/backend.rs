//! The GPU as a backend of solvers.

use crate::context::Context;
use crate::error::GpuError;
use crate::hemicube::GpuHemicube;
use crate::shooting::GpuShooting;
use hemicube_radiosity::backend::{Backend, Shooter};
use hemicube_radiosity::form_factor::FormFactors;
use hemicube_radiosity::patch::PatchMesh;
use hemicube_radiosity::solve::Order;
use hemicube_radiosity::{RadiosityError, Solution, SolveOptions};
use std::sync::Arc;

/// Hemicubes drawn on the device for every solver; sorted shooting stays on it altogether.
#[derive(Debug, Clone)]
pub struct Gpu {
    context: Arc<Context>,
}

impl Gpu {
    /// The backend on a device.
    pub fn new(context: Arc<Context>) -> Self {
        Self { context }
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
        let hemicubes = GpuHemicube::new(self.context.clone(), mesh, options.hemicube);
        Ok(Box::new(hemicubes.map_err(of_gpu)?))
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
        let solver = GpuShooting::new(self.context.clone(), solution, options.hemicube);
        Ok(Shooter::Own(Box::new(solver.map_err(of_gpu)?)))
    }
}

fn of_gpu(error: GpuError) -> RadiosityError {
    RadiosityError::Option(error.to_string())
}
