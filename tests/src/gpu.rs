//! The GPU's ways to form factors, for tests whose body is that of all ways.

use hemicube::radiosity::form_factor::hemicube::HemicubeOptions;
use hemicube::radiosity::{FormFactors, PatchMesh, RayCastOptions};
use std::sync::Arc;

/// A way to form factors by its name.
pub type Named = (&'static str, Box<dyn FormFactors>);

/// Hemicubes (`gpu`) and rays (`gpu-raycast`) of a device; none without the feature `gpu`, or without an adapter, which is
/// said.
#[cfg(feature = "gpu")]
pub fn ways(
    mesh: &Arc<PatchMesh>,
    hemicube: HemicubeOptions,
    raycast: RayCastOptions,
) -> Vec<Named> {
    use hemicube::gpu::{GpuHemicube, GpuRayCast};
    let Some(context) = context() else {
        return Vec::new();
    };
    let hemicubes = GpuHemicube::new(context.clone(), mesh.clone(), hemicube).expect("it fits");
    let rays = GpuRayCast::new(context, mesh.clone(), raycast).expect("it fits");
    vec![
        ("gpu", Box::new(hemicubes)),
        ("gpu-raycast", Box::new(rays)),
    ]
}

/// Hemicubes (`gpu`) and rays (`gpu-raycast`) of a device; none without the feature `gpu`.
#[cfg(not(feature = "gpu"))]
pub fn ways(_: &Arc<PatchMesh>, _: HemicubeOptions, _: RayCastOptions) -> Vec<Named> {
    Vec::new()
}

/// One device for all tests of a program, or none where there is no adapter, which is said; a machine that is to test
/// everything (`CI` is set) must have one.
#[cfg(feature = "gpu")]
pub fn context() -> Option<Arc<hemicube::gpu::Context>> {
    use hemicube::gpu::Context;
    use std::sync::OnceLock;
    static CONTEXT: OnceLock<Option<Arc<Context>>> = OnceLock::new();
    let found = CONTEXT.get_or_init(|| match Context::headless(None) {
        Ok(context) => Some(Arc::new(context)),
        Err(error) => {
            let must_be_there = std::env::var_os("HEMICUBE_TESTS_NEED_GPU").is_some();
            assert!(
                !must_be_there,
                "{error}; there is a driver, so tests of the GPU are not skipped"
            );
            eprintln!("skipped on the GPU: {error}");
            None
        }
    });
    found.clone()
}
