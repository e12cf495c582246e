//! Which elements light varies over too much.

use crate::drawn::element_irradiance;
use crate::patch::PatchMesh;
use crate::solution::Solution;
use crate::vertex_light::Fans;
use hemicube_raster::Rgb;
use rayon::prelude::*;

/// Share of the mean illumination below which differences count as if light were there: of dark corners nobody sees more.
pub const FLOOR: f32 = 0.1;

/// Contrast of light over each element, in [0, 1]: the largest less the least luminance of the irradiance at its vertices
/// and on itself, relative to the largest one.
///
/// It is that of a white surface: what an element emits counts as brightness, so lamps have none, and the brightness is
/// taken to be at least [`FLOOR`] times the mean irradiance of the scene. Buried elements have none.
pub fn contrasts(solution: &Solution) -> Vec<f32> {
    let mesh = solution.mesh();
    let irradiance = element_irradiance(solution);
    let fans = Fans::new(mesh);
    let at_parts = fans.means(&irradiance);
    let floor = FLOOR * mean_luminance(mesh, &irradiance);
    let of_element = |e: usize| {
        if mesh.exposed_area(e) <= 0.0 {
            return 0.0;
        }
        let own = irradiance[e].luminance();
        let corners = fans.of_element(e).iter();
        let corners = corners.map(|&part| at_parts[part as usize].luminance());
        let (least, most) = corners.fold((own, own), |(least, most), light| {
            (f32::min(least, light), f32::max(most, light))
        });
        let brightness = most + solution.element_exitance(e).luminance();
        (most - least) / brightness.max(floor).max(f32::MIN_POSITIVE)
    };
    (0..irradiance.len())
        .into_par_iter()
        .map(of_element)
        .collect()
}

/// Mean over the exposed areas.
pub(super) fn mean_luminance(mesh: &PatchMesh, irradiance: &[Rgb]) -> f32 {
    let (mut sum, mut areas) = (0.0, 0.0);
    for (e, light) in irradiance.iter().enumerate() {
        let area = f64::from(mesh.exposed_area(e));
        sum += area * f64::from(light.luminance());
        areas += area;
    }
    super::to_f32(sum / areas.max(f64::MIN_POSITIVE))
}
