//! Solves a glTF file and reads irradiance at points: `cargo run --release --example irradiance -- room.glb`.
//!
//! Without a file the built-in Cornell box is solved.

use glam::Vec3;
use hemicube::radiosity::{GatherOptions, Gatherer, Quality, RadiosityError, solve};
use hemicube::raster::Rgb;
use hemicube::scene;
use std::sync::Arc;

/// Irradiance on points of a horizontal plane through the middle of a scene, looking up.
pub fn work_plane(name: &str, quality: Quality) -> Result<Vec<(Vec3, Rgb)>, RadiosityError> {
    let scene = Arc::new(scene::open(name)?);
    let solution = solve(scene.clone(), &quality.into(), |_, _| true)?;
    let gatherer = Gatherer::new(&solution, GatherOptions::default());
    let (low, high) = scene.bounds().expect("a solved scene has faces");
    let grid = (0..9_u8).map(|i| Vec3::new(f32::from(i % 3), 1.0, f32::from(i / 3)));
    let points = grid.map(|cell| {
        low + (high - low) * (cell + Vec3::new(1.0, 0.0, 1.0)) / Vec3::new(4.0, 2.0, 4.0)
    });
    Ok(points
        .map(|point| (point, gatherer.irradiance(point, Vec3::Y)))
        .collect())
}

fn main() -> Result<(), RadiosityError> {
    let name = std::env::args().nth(1).unwrap_or_else(|| "cornell".into());
    for (point, irradiance) in work_plane(&name, Quality::Normal)? {
        println!("{point:?}: {:.4?}", irradiance.to_array());
    }
    Ok(())
}
