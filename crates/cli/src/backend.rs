//! What makes the form factors: the CPU, or a GPU where the program was built for one.

use crate::args::GpuArgs;
use crate::failure::Failure;
use hemicube::radiosity::backend::{Backend, Cpu};
use hemicube::radiosity::form_factor::FormFactors;
use hemicube::radiosity::{PatchMesh, RadiosityError, SolveOptions};
use std::sync::Arc;

/// The option by which solvers choose their form factors.
pub const FORM_FACTORS: &str = "--form-factors";

/// The backend that the options ask for; `chosen_by` is the option that chooses the way to form factors.
pub fn chosen(
    args: &GpuArgs,
    uses_gpu: bool,
    chosen_by: &str,
    quiet: bool,
) -> Result<Box<dyn Backend>, Failure> {
    if !uses_gpu {
        if let Some(option) = args.given() {
            return Err(Failure::Usage(format!(
                "{option} is for {chosen_by} gpu or gpu-raycast; leave it out, or add that"
            )));
        }
        return Ok(Box::new(Cpu));
    }
    gpu(args, chosen_by, quiet)
}

/// The form factors of a backend with the CPU's solvers, which bring every step's light along.
pub struct FactorsOf<'a>(pub &'a dyn Backend);

impl Backend for FactorsOf<'_> {
    fn name(&self, options: &SolveOptions) -> String {
        self.0.name(options)
    }

    fn form_factors(
        &self,
        mesh: Arc<PatchMesh>,
        options: &SolveOptions,
    ) -> Result<Box<dyn FormFactors>, RadiosityError> {
        self.0.form_factors(mesh, options)
    }

    fn verdict(&self) -> Result<(), RadiosityError> {
        self.0.verdict()
    }
}

#[cfg(feature = "gpu")]
fn gpu(args: &GpuArgs, _: &str, quiet: bool) -> Result<Box<dyn Backend>, Failure> {
    use hemicube::gpu::{Context, Gpu};
    let tell = move |why: &str| {
        if !quiet {
            let why = crate::failure::one_line(why);
            eprintln!("hemicube: note: {why}; going on with the CPU");
        }
    };
    match Context::headless(args.adapter.as_deref()) {
        Ok(context) => {
            let gpu = Gpu::new(Arc::new(context)).with_required(args.require_gpu);
            Ok(Box::new(
                gpu.with_report(move |error| tell(&error.to_string())),
            ))
        }
        Err(error) if args.require_gpu => Err(Failure::Failed(error.to_string())),
        Err(error) => {
            tell(&error.to_string());
            Ok(Box::new(Cpu))
        }
    }
}

#[cfg(not(feature = "gpu"))]
fn gpu(_: &GpuArgs, chosen_by: &str, _: bool) -> Result<Box<dyn Backend>, Failure> {
    Err(Failure::Usage(format!("{chosen_by} gpu: {NOT_BUILT}")))
}

/// What to say where the program was built without the feature.
#[cfg(not(feature = "gpu"))]
pub const NOT_BUILT: &str =
    "this program was built without it; `cargo install --path crates/cli --features gpu` builds it";
