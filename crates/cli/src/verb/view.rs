//! `hemicube view`: a window on a scene.

use crate::args::ViewVerb;
use crate::failure::Failure;

/// Opens the window and stays until it is closed.
#[cfg(feature = "viewer")]
pub fn run(args: &ViewVerb) -> Result<(), Failure> {
    use hemicube_viewer::session::{Asked, FactorsBy};
    let factors = |name: &String| match name.as_str() {
        "gpu" => FactorsBy::Gpu,
        "hemicube" => FactorsBy::Hemicubes,
        _ => FactorsBy::Rays,
    };
    let options = hemicube_viewer::ViewOptions {
        scene: args.scene.to_string_lossy().into_owned(),
        measure: args.measure,
        size: args
            .size
            .map(|(width, height)| [width as f32, height as f32]),
        settings: None,
        asked: Asked {
            quality: args.solve.quality,
            mesh: args.solve.mesh().map(Into::into),
            solver: args.solve.solver,
            factors: args.solve.form_factors.as_ref().map(factors),
            tolerance: args.solve.tolerance,
        },
        changes: args.scene_options.changes(),
        camera: args.camera.clone(),
        forgets: args.fresh,
    };
    hemicube_viewer::view(options).map_err(|error| Failure::Failed(error.to_string()))
}

/// Says how to build the program for it.
#[cfg(not(feature = "viewer"))]
pub fn run(args: &ViewVerb) -> Result<(), Failure> {
    let ViewVerb {
        scene,
        measure: _,
        size: _,
        fresh: _,
        camera: _,
        solve: _,
        scene_options: _,
    } = args;
    Err(Failure::Usage(format!(
        "view {}: this program was built without windows; `cargo install --path crates/cli --features viewer` builds \
         it with them, `hemicube render` draws pictures without",
        scene.display()
    )))
}
