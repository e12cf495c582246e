//! Which elements light varies over too much.

use crate::drawn::element_irradiance;
use crate::patch::PatchMesh;
use crate::solution::Solution;
use crate::vertex_light::Fans;
use hemicube_raster::Rgb;
use rayon::prelude::*;

/// Share of the mean illumination below which differences count as if light were there: of dark corners nobody sees more.
pub const FLOOR: f32 = 0.1;

/// Elements around one, itself among them, below which it is *blind*: light at its vertices is that of a plane at best, or of
/// itself alone, whatever falls on it.
const LEAST_SEEN: usize = 4;

/// Contrast of light over each element, in [0, 1]: the largest less the least luminance of the irradiance at its vertices
/// and on itself, relative to the largest one.
///
/// It is that of a white surface: what an element emits counts as brightness, so lamps have none, and the brightness is
/// taken to be at least [`FLOOR`] times the mean irradiance of the scene. Buried elements have none. On faces of one, two or
/// three elements vertices show little of it; they are taken to have as much as elements have in the mean.
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
    let mut contrasts: Vec<f32> = (0..irradiance.len())
        .into_par_iter()
        .map(of_element)
        .collect();
    let share_of_arriving = |e: usize| {
        let own = irradiance[e].luminance();
        own / (own + solution.element_exitance(e).luminance()).max(f32::MIN_POSITIVE)
    };
    assume_for_blind(mesh, &fans, &mut contrasts, share_of_arriving);
    contrasts
}

/// Gives blind elements at least the mean of the others over their areas, times what `scale` says of each.
pub(super) fn assume_for_blind(
    mesh: &PatchMesh,
    fans: &Fans,
    values: &mut [f32],
    scale: impl Fn(usize) -> f32,
) {
    let is_blind: Vec<bool> = (0..values.len())
        .into_par_iter()
        .map(|e| is_blind(fans, e))
        .collect();
    let (mut sum, mut areas) = (0.0, 0.0);
    for e in (0..values.len()).filter(|&e| !is_blind[e]) {
        let area = f64::from(mesh.exposed_area(e));
        sum += area * f64::from(values[e]);
        areas += area * f64::from(scale(e));
    }
    let mean = super::to_f32(sum / areas.max(f64::MIN_POSITIVE));
    for e in (0..values.len()).filter(|&e| is_blind[e] && mesh.exposed_area(e) > 0.0) {
        values[e] = values[e].max(mean * scale(e));
    }
}

fn is_blind(fans: &Fans, element: usize) -> bool {
    let parts = fans.of_element(element).iter();
    let mut seen: Vec<u32> = parts
        .flat_map(|&part| fans.of_part(part).0.iter().copied())
        .collect();
    seen.sort_unstable();
    seen.dedup();
    seen.len() < LEAST_SEEN
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
