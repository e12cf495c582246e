//! What the benchmarks share: reference rooms and their error.

use glam::Vec3;
use hemicube::radiosity::{GatherOptions, Gatherer, Solution};
use hemicube::raster::Rgb;

/// Points of a reference room with their irradiance.
#[derive(Debug, Clone)]
pub struct Reference {
    points: Vec<(Vec3, Vec3, Rgb)>,
}

impl Reference {
    /// The points of `cornell` or `two-rooms`.
    pub fn of(scene: &str) -> Self {
        let text = match scene {
            "cornell" => include_str!("../../tests/data/reference_cornell.json"),
            "two-rooms" => include_str!("../../tests/data/reference_two_rooms.json"),
            _ => panic!("no reference points of scene '{scene}'"),
        };
        let root: serde_json::Value =
            serde_json::from_str(text).expect("the reference data is JSON");
        let entries = root["points"]
            .as_array()
            .expect("the reference data has points");
        let point = |entry: &serde_json::Value| {
            let [p, n, h] = ["point", "normal", "irradiance"].map(|key| triple(&entry[key]));
            (Vec3::from_array(p), Vec3::from_array(n), h.into())
        };
        Self {
            points: entries.iter().map(point).collect(),
        }
    }

    /// Irradiance of a solution at the points.
    pub fn measure(&self, solution: &Solution, rays: u32) -> Vec<Rgb> {
        let gatherer = Gatherer::new(solution, GatherOptions { rays, seed: 0 });
        self.points
            .iter()
            .map(|&(point, normal, _)| gatherer.irradiance(point, normal))
            .collect()
    }

    /// RMS over points and channels of the error relative to the point's mean irradiance.
    pub fn rms_error(&self, found: &[Rgb]) -> f64 {
        let mut sum = 0.0;
        for ((_, _, exact), found) in self.points.iter().zip(found) {
            let mean = f64::from(exact.r + exact.g + exact.b) / 3.0;
            sum += (0..3)
                .map(|band| (f64::from(found[band] - exact[band]) / mean).powi(2))
                .sum::<f64>();
        }
        (sum / (3 * self.points.len()) as f64).sqrt()
    }
}

#[expect(
    clippy::cast_possible_truncation,
    reason = "reference values are compared in f32"
)]
fn triple(value: &serde_json::Value) -> [f32; 3] {
    [0, 1, 2].map(|i| value[i].as_f64().expect("three numbers") as f32)
}
