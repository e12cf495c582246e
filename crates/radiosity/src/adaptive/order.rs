//! Which elements are cut first where not all can be.
//!
//! An element is shown by a linear interpolation of light at its vertices. Its error is estimated by `η = |H - H̄| √A`, the
//! element's own light less the mean at its vertices: a second difference, 0 where light is linear, and as a root of an
//! integral of squares. Where light is smooth a cut divides second differences by 4 and lengths by 2, so `η` by 8; a mesh
//! whose parts all come to `τ` has `(η / τ)^⅔` of them for each element, and has the least error of all meshes of so many
//! elements. Contrast would choose dim slopes, which interpolation follows, before bright hilltops, which it cuts off.

use crate::drawn::element_irradiance;
use crate::solution::Solution;
use crate::vertex_light::Fans;
use rayon::prelude::*;

/// Elements that would become so many are cut: it lies between 1 and 4.
const WORTH_A_CUT: f64 = 2.0;

/// Steps of the bisection that looks for `τ`.
const BISECTIONS: u32 = 50;

/// `η` of each element, in luminance times length; 0 of buried ones.
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
        let difference = irradiance[e].luminance() - sum / parts.len() as f32;
        difference.abs() * mesh.exposed_area(e).sqrt()
    };
    (0..irradiance.len())
        .into_par_iter()
        .map(of_element)
        .collect()
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
