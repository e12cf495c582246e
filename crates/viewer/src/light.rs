//! The light of a solution as dimmed, element by element.

use hemicube_radiosity::solution::BANDS;
use hemicube_radiosity::{PatchMesh, Solution};
use hemicube_raster::Rgb;

/// Irradiance and exitance of each element, summed over light groups with their factors.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Light {
    /// lx or W/m².
    pub irradiance: Vec<Rgb>,
    /// lm/m² or W/m².
    pub exitance: Vec<Rgb>,
}

impl Light {
    /// The weighted sum; groups beyond `dims` count as they were solved.
    pub fn new(solution: &Solution, dims: &[Rgb]) -> Self {
        let elements = solution.mesh().elements().len();
        let mut light = Self {
            irradiance: vec![Rgb::BLACK; elements],
            exitance: vec![Rgb::BLACK; elements],
        };
        for group in 0..solution.groups().len() {
            let dim = dims.get(group).copied().unwrap_or(Rgb::WHITE);
            for band in (0..BANDS).filter(|&band| dim[band] != 0.0) {
                add(
                    &mut light.irradiance,
                    solution.irradiance(group, band),
                    band,
                    dim[band],
                );
                add(
                    &mut light.exitance,
                    solution.exitance(group, band),
                    band,
                    dim[band],
                );
            }
        }
        light
    }

    /// Radiosity `B = E + ρ H` of an element.
    pub fn radiosity(&self, mesh: &PatchMesh, element: usize) -> Rgb {
        self.exitance[element] + mesh.reflectance()[element] * self.irradiance[element]
    }
}

fn add(sums: &mut [Rgb], values: &[f32], band: usize, factor: f32) {
    for (sum, value) in sums.iter_mut().zip(values) {
        sum[band] += factor * value;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use hemicube_radiosity::{Grouping, PatchOptions, SolveOptions, solve};
    use hemicube_scene::builtin;
    use std::sync::Arc;

    #[test]
    fn it_is_the_sum_that_the_solution_has_itself() {
        let options = SolveOptions {
            mesh: PatchOptions::default().with_elements(200).with_patches(40),
            rays: 32,
            grouping: Grouping::ByMaterial,
            ..SolveOptions::default()
        };
        let scene = Arc::new(builtin::scene("office").expect("it is built in"));
        let mut solution = solve(scene, &options, |progress, _| progress.iteration < 30)
            .expect("it can be solved");
        let dims: Vec<Rgb> = (0..solution.groups().len())
            .map(|i| Rgb::new(0.2 * i as f32, 1.0, 0.5))
            .collect();
        let light = Light::new(&solution, &dims);
        for (group, &dim) in dims.iter().enumerate() {
            solution.set_dim(group, dim);
        }
        for e in 0..solution.mesh().elements().len() {
            let (ours, theirs) = (light.irradiance[e], solution.element_irradiance(e));
            let apart = (ours - theirs).map(f32::abs).max_band();
            assert!(apart <= 1e-5 * theirs.max_band(), "{ours:?} {theirs:?}");
            assert_eq!(
                light.exitance[e],
                solution.element_exitance(e),
                "one group each"
            );
        }
    }
}
