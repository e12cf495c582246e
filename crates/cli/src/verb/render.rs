//! `hemicube render`: a picture of a scene or of a lit `.glb`.

use super::solution_of;
use crate::args::{GlobalArgs, RenderVerb};
use crate::failure::Failure;
use crate::output::{Target, print, print_json};
use crate::picture::{ENDINGS, View, check, refuse_mesh_in, refuse_surroundings};
use serde_json::json;
use std::time::Instant;

/// Draws the picture.
pub fn run(args: &RenderVerb, global: GlobalArgs, start: Instant) -> Result<(), Failure> {
    let target = Target::check(&args.output, ENDINGS)?;
    refuse_surroundings(&target, &args.picture)?;
    refuse_mesh_in(&target, &args.picture)?;
    let solve = args.solve.without_gpu_of_picture(args.picture.uses_gpu());
    let solution = solution_of(
        &args.scene,
        &solve,
        &args.scene_options,
        global,
        start,
        |scene| check(scene, &args.picture),
    )?;
    let view = View::new(&solution, &args.picture)?;
    let mirrors = view.draw(&solution, &target, &args.solve.mesh.gpu, global)?;
    let file = target.path.display().to_string();
    let (width, height) = view.size();
    if global.json {
        return print_json(&json!({
            "scene": solution.mesh().scene().name, "camera": view.camera_name(),
            "width": width, "height": height, "shading": view.shading_name(), "mirrors": mirrors, "files": [file],
        }));
    }
    let mirroring = match mirrors {
        0 => String::new(),
        1 => String::from(", 1 mirror"),
        n => format!(", {n} mirrors"),
    };
    print(&format!(
        "wrote     {file} ({width} x {height}, camera {}, {}{mirroring})\n",
        view.camera_name(),
        view.shading_name()
    ))
}
