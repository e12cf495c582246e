//! What is seen from a point of a scene.

use super::files::{Outputs, Tones};
use super::{in_words, shape};
use crate::args::{CaptureTask, GlobalArgs};
use crate::failure::Failure;
use crate::output::{print, print_json};
use crate::progress::Bar;
use crate::verb::solution_of;
use core::f32::consts::FRAC_PI_2;
use glam::Vec3;
use hemicube::radiosity::Solution;
use hemicube::raster::environment::{ConvertOptions, EnvironmentMap, Projection, convert};
use hemicube::raster::{Image, Rgb};
use hemicube::render::{RenderOptions, Renderer};
use hemicube::scene::Camera;
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
    for (face, (forward, up)) in VIEWS.into_iter().enumerate() {
        let camera = Camera::looking_at("face", task.at, task.at + forward, up, FRAC_PI_2);
        let camera = Camera {
            forward,
            up,
            ..camera
        };
        let progress = |share: f64| bar.show((face as f64 + share) / 6.0, String::new);
        let renderer = Renderer::new(solution, &camera, &options)?.with_progress(&progress);
        faces.push(renderer.linear());
    }
    EnvironmentMap::new(Projection::Cube, &faces)
        .map_err(|error| Failure::Failed(format!("{}: {error}", task.scene.display())))
}

/// Where the camera of each face looks, and what is up in its picture.
const VIEWS: [(Vec3, Vec3); 6] = [
    (Vec3::X, Vec3::Y),
    (Vec3::NEG_X, Vec3::Y),
    (Vec3::Y, Vec3::Z),
    (Vec3::NEG_Y, Vec3::NEG_Z),
    (Vec3::NEG_Z, Vec3::Y),
    (Vec3::Z, Vec3::Y),
];
