//! What the benchmarks share: irradiance at the points of a reference room, with its error.

use hemicube::radiosity::{GatherOptions, Gatherer, Solution};
use hemicube_tests::{ReferencePoint, rms_error};

/// RMS error of a solution at the points of its room, gathered with so many rays each.
pub fn measured_error(solution: &Solution, points: &[ReferencePoint], rays: u32) -> f64 {
    let gatherer = Gatherer::new(solution, GatherOptions { rays, seed: 0 });
    let found: Vec<_> = points
        .iter()
        .map(|p| gatherer.irradiance(p.point, p.normal))
        .collect();
    rms_error(points, &found)
}
