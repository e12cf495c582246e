//! What the benchmarks share: errors of solutions, at the points of a reference room and of their elements.

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

/// RMS relative difference of the elements' irradiance from that of another solution on the same mesh, by luminance, over
/// the elements that get more than a hundredth of the mean there.
///
/// # Panics
/// If the meshes have other numbers of elements.
pub fn element_error(solution: &Solution, truth: &Solution) -> f64 {
    let elements = truth.mesh().elements().len();
    assert_eq!(elements, solution.mesh().elements().len(), "one mesh");
    let light = |of: &Solution, e: usize| f64::from(of.element_irradiance(e).luminance());
    let area = |e: usize| f64::from(truth.mesh().exposed_area(e));
    let total: f64 = (0..elements).map(area).sum();
    let mean = (0..elements)
        .map(|e| area(e) * light(truth, e))
        .sum::<f64>()
        / total;
    let errors: Vec<f64> = (0..elements)
        .filter(|&e| area(e) > 0.0 && light(truth, e) > 0.01 * mean)
        .map(|e| (light(solution, e) / light(truth, e) - 1.0).powi(2))
        .collect();
    (errors.iter().sum::<f64>() / errors.len() as f64).sqrt()
}
