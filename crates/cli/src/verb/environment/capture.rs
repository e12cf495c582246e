//! What is seen from a point of a scene.

use super::files::{Outputs, Tones};
use super::{in_words, shape};
use crate::args::{CaptureTask, GlobalArgs};
use crate::failure::Failure;
use crate::output::{print, print_json};
use crate::progress::Bar;
use crate::verb::solution_of;
use hemicube::radiosity::Solution;
use hemicube::raster::environment::{ConvertOptions, EnvironmentMap, Projection, convert};
use hemicube::raster::{Image, Rgb};
use hemicube::render::{RenderOptions, Renderer, face_camera};
use serde_json::json;
use std::time::Instant;

/// Renders the map and writes it.
pub fn run(task: &CaptureTask, global: GlobalArgs, start: Instant) -> Result<(), Failure> {
    let to = task.to.unwrap_or(Projection::Cube);
    let outputs = Outputs::check(&task.output, to, task.layout)?;
    let solution = solution_of(
        &task.scene,
        &task.solve,
        &task.scene_options,
        global,
        start,
        |_| Ok(()),
    )?;
    let cube = capture(&solution, task, global)?;
    let (map, _) = convert(&cube, to, &ConvertOptions::default());
    let written = outputs.write(&map, Tones::new(task.tones, false))?;
    let mean = map.mean();
    if global.json {
        return print_json(&json!({
            "scene": solution.mesh().scene().name, "at": task.at.to_array(), "map": shape(&map),
            "mean_radiance": mean, "files": written,
        }));
    }
    let [r, g, b] = mean;
    let mut text = format!(
        "map       {}\nradiance  {r:.5} {g:.5} {b:.5} on average\n",
        in_words(&map)
    );
    for file in written {
        text += &format!("wrote     {file}\n");
    }
    print(&text)
}

/// The six pictures, in linear radiance.
fn capture(
    solution: &Solution,
    task: &CaptureTask,
    global: GlobalArgs,
) -> Result<EnvironmentMap, Failure> {
    let defaults = RenderOptions::default();
    let options = RenderOptions {
        shading: task.shading.unwrap_or(defaults.shading),
        antialias: task.antialias.unwrap_or(defaults.antialias),
        ..defaults
    }
    .with_size(task.size as usize, task.size as usize);
    let bar = Bar::new("drawing", global.quiet);
    let mut faces: Vec<Image<Rgb>> = Vec::new();
    for face in 0..6 {
        let camera = face_camera(task.at, face);
        let progress = |share: f64| bar.show((face as f64 + share) / 6.0, String::new);
        let renderer = Renderer::new(solution, &camera, &options)?.with_progress(&progress);
        faces.push(renderer.linear());
    }
    EnvironmentMap::new(Projection::Cube, &faces)
        .map_err(|error| Failure::Failed(format!("{}: {error}", task.scene.display())))
}
