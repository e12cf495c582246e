//! Which elements are cut first where not all can be.
//!
//! An element is shown by a linear interpolation of light at its vertices. Its error is estimated by `η = |H - H̄| √A`, the
//! element's own light less the mean at its vertices: a second difference, 0 where light is linear, and as a root of an
//! integral of squares. Where light is smooth a cut divides second differences by 4 and lengths by 2, so `η` by 8; a mesh
//! whose parts all come to `τ` has `(η / τ)^⅔` of them for each element, and has the least error of all meshes of so many
//! elements. Contrast would choose dim slopes, which interpolation follows, before bright hilltops, which it cuts off.

use super::contrast::{assume_for_blind, mean_luminance};
use crate::drawn::element_irradiance;
use crate::solution::Solution;
use crate::vertex_light::Fans;
use rayon::prelude::*;

/// Share of the contrast that is wanted up to which pictures may be off, as a root mean square relative to the mean light.
/// Contrast is relative to the light of a place, and would go on in dark corners, of which pictures show little, long
/// after all the error is elsewhere: in the Cornell box, to a contrast of 0.1, up to 39,018 elements that are off by 2.6 %
/// instead of 4227 that are off by 2.5 %. A uniform mesh has 8008 for 2.6 %.
pub const ERROR_SHARE: f64 = 0.1;

/// Elements that would become so many are cut: it lies between 1 and 4.
const WORTH_A_CUT: f64 = 2.0;

/// Steps of the bisection that looks for `τ`.
const BISECTIONS: u32 = 50;

/// `η` of each element, in luminance times length; 0 of buried ones. Faces of few elements, whose vertices do not show
/// differences, are taken to have them as others have.
pub(super) fn error_estimates(solution: &Solution) -> Vec<f32> {
    let mesh = solution.mesh();
    let irradiance = element_irradiance(solution);
    let fans = Fans::new(mesh);
    let at_parts = fans.means(&irradiance);
    let of_element = |e: usize| {
        let parts = fans.of_element(e);
        let sum: f32 = parts
            .iter()
            .map(|&part| at_parts[part as usize].luminance())
            .sum();
        (irradiance[e].luminance() - sum / parts.len() as f32).abs()
    };
    let mut differences: Vec<f32> = (0..irradiance.len())
        .into_par_iter()
        .map(of_element)
        .collect();
    assume_for_blind(mesh, &fans, &mut differences, |e| irradiance[e].luminance());
    let pairs = differences.iter().enumerate();
    pairs
        .map(|(e, difference)| difference * mesh.exposed_area(e).sqrt())
        .collect()
}

/// Of elements given by their `η` in descending order, how many are worth a cut: the others together add less to the error of
/// pictures than `allowed`, in the same unit.
pub(super) fn worth_a_cut(errors: &[f32], allowed: f64) -> usize {
    let mut squares = 0.0;
    let small = errors.iter().rev().take_while(|&&eta| {
        squares += f64::from(eta).powi(2);
        squares <= allowed * allowed
    });
    errors.len() - small.count()
}

/// The error that pictures may have for a contrast, in the unit of [`error_estimates`].
pub(super) fn allowed_error(solution: &Solution, contrast: f32) -> f64 {
    let mesh = solution.mesh();
    let areas = (0..mesh.elements().len()).map(|e| f64::from(mesh.exposed_area(e)));
    let mean = mean_luminance(mesh, &element_irradiance(solution));
    ERROR_SHARE * f64::from(contrast) * f64::from(mean) * areas.sum::<f64>().sqrt()
}

/// How many of some elements are cut now, given by their `η` in descending order, so that some rounds later the mesh has
/// at most `more` elements more. All, if none of them is much worse than others.
pub(super) fn to_cut(errors: &[f32], more: usize) -> usize {
    let parts = |tau: f64| errors.iter().map(move |&eta| parts(eta, tau));
    let (mut low, mut high) = (0.0, f64::from(errors.first().copied().unwrap_or(0.0)));
    for _ in 0..BISECTIONS {
        let tau = f64::midpoint(low, high);
        if parts(tau).map(|n| n - 1.0).sum::<f64>() > more as f64 {
            low = tau;
        } else {
            high = tau;
        }
    }
    match parts(high).take_while(|&n| n > WORTH_A_CUT).count() {
        0 => errors.len(),
        some => some,
    }
}

/// Parts of an element that bring it to `tau`.
fn parts(eta: f32, tau: f64) -> f64 {
    let ratio = f64::from(eta) / tau.max(f64::MIN_POSITIVE);
    (ratio * ratio).cbrt().max(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_adds_little_is_left() {
        let errors = [4.0, 3.0, 0.6, 0.8];
        assert_eq!(worth_a_cut(&errors, 1.001), 2, "0.6 and 0.8 make 1");
        assert_eq!(worth_a_cut(&errors, 0.999), 3, "a little too much");
        assert_eq!(worth_a_cut(&errors, 0.0), 4, "nothing is allowed");
        assert_eq!(worth_a_cut(&errors, 10.0), 0, "all of it");
        assert_eq!(worth_a_cut(&[], 1.0), 0, "nothing");
    }

    #[test]
    fn the_worst_are_cut_first() {
        // 10 elements that would take 16 parts each at η = 1, and 1000 fine ones.
        let mut errors = vec![64.0; 10];
        errors.extend(vec![1.0; 1000]);
        assert_eq!(to_cut(&errors, 150), 10, "what a mesh of even errors cuts");
        assert_eq!(to_cut(&errors, 100_000), 1010, "more room than they need");
        assert_eq!(to_cut(&[1.0; 8], 4), 8, "of equals all are offered");
        assert_eq!(to_cut(&[], 10), 0, "nothing");
        assert_eq!(to_cut(&[0.0; 3], 10), 3, "no error at all");
    }
}
