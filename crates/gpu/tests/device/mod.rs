//! The device that tests run on.

use hemicube_gpu::Context;
use std::sync::Arc;

/// A device, or none where there is no adapter, which it says; a machine that is to test everything (`CI` is set) must
/// have one.
pub fn context() -> Option<Arc<Context>> {
    found(Context::headless(None))
}

/// What came of asking for a device.
pub fn found(context: Result<Context, hemicube_gpu::GpuError>) -> Option<Arc<Context>> {
    match context {
        Ok(context) => Some(Arc::new(context)),
        Err(error) if std::env::var_os("HEMICUBE_TESTS_NEED_GPU").is_some() => {
            panic!("{error}; there is a driver, so tests of the GPU are not skipped")
        }
        Err(error) => {
            println!("skipped: {error}");
            None
        }
    }
}
