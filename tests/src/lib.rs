//! What the tests share: reference data, and the folder of real files that is not part of the project.

pub mod enclosures;
pub mod gpu;
pub mod meshes;
pub mod shapes;
pub mod shown_light;
pub mod solutions;
pub mod spheres;
pub mod surfaces;
pub mod watertight;

use glam::Vec3;
use hemicube::raster::Rgb;
use std::path::PathBuf;

/// A point of a reference room with its irradiance.
#[derive(Debug, Clone)]
pub struct ReferencePoint {
    /// Where, in the scene's units.
    pub point: Vec3,
    /// Unit normal of the side that is measured.
    pub normal: Vec3,
    /// Irradiance, W/m².
    pub irradiance: Rgb,
    /// What kind of place it is.
    pub tag: String,
}

/// The points of `data/reference_*.json`: `cornell` or `two-rooms`.
pub fn reference_points(scene: &str) -> Vec<ReferencePoint> {
    let text = match scene {
        "cornell" => include_str!("../data/reference_cornell.json"),
        "two-rooms" => include_str!("../data/reference_two_rooms.json"),
        _ => panic!("no reference points of scene '{scene}'"),
    };
    let root: serde_json::Value = serde_json::from_str(text).expect("the reference data is JSON");
    let points = root["points"]
        .as_array()
        .expect("the reference data has points");
    points
        .iter()
        .map(|entry| ReferencePoint {
            point: Vec3::from_array(triple(&entry["point"])),
            normal: Vec3::from_array(triple(&entry["normal"])),
            irradiance: triple(&entry["irradiance"]).into(),
            tag: entry["tag"].as_str().unwrap_or_default().into(),
        })
        .collect()
}

#[expect(
    clippy::cast_possible_truncation,
    reason = "reference values are compared in f32"
)]
fn triple(value: &serde_json::Value) -> [f32; 3] {
    [0, 1, 2].map(|i| value[i].as_f64().expect("three numbers") as f32)
}

/// RMS over points and channels of the error relative to the point's mean irradiance over channels.
pub fn rms_error(points: &[ReferencePoint], irradiance: &[Rgb]) -> f64 {
    let mut sum = 0.0;
    for (reference, found) in points.iter().zip(irradiance) {
        let mean = f64::from(reference.irradiance.to_array().iter().sum::<f32>()) / 3.0;
        for band in 0..3 {
            let error = f64::from(found[band] - reference.irradiance[band]) / mean;
            sum += error * error;
        }
    }
    (sum / (3 * points.len()) as f64).sqrt()
}

/// The folder of real files beside the project, from `HEMICUBE_TESTDATA` or `../shared/testdata`; where there is none,
/// says so and gives `None`.
pub fn testdata() -> Option<PathBuf> {
    let folder = std::env::var_os("HEMICUBE_TESTDATA").map_or_else(
        || {
            PathBuf::from(concat!(
                env!("CARGO_MANIFEST_DIR"),
                "/../../shared/testdata"
            ))
        },
        PathBuf::from,
    );
    if folder.is_dir() {
        return Some(folder);
    }
    eprintln!(
        "skipped: there is no {}; set HEMICUBE_TESTDATA to a folder of scenes",
        folder.display()
    );
    None
}
