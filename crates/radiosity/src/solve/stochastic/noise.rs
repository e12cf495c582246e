//! How uncertain the light is.

use super::Stochastic;
use crate::solution::BANDS;
use rayon::prelude::*;

/// Elements that receive less than this share of the mean do not count for the noise.
const DIM: f64 = 0.01;

impl Stochastic {
    /// Of direct and of reflected light.
    pub(super) fn estimate_noises(&self) -> [f64; 2] {
        let elements = self.mesh().elements().len();
        let irradiance: Vec<f64> = (0..elements)
            .into_par_iter()
            .map(|e| self.total_irradiance(e))
            .collect();
        let area = |e: usize| f64::from(self.mesh().exposed_area(e));
        let flux: f64 = irradiance
            .iter()
            .enumerate()
            .map(|(e, h)| h * area(e))
            .sum();
        let least = DIM * flux / (0..elements).map(area).sum::<f64>();
        let squares: Vec<[f64; 2]> = irradiance
            .into_par_iter()
            .enumerate()
            .filter(|&(_, h)| h > least)
            .map(|(e, h)| {
                let square = h * h;
                [
                    self.direct_light.variance(e) / square,
                    self.reflected_variance(e) / square,
                ]
            })
            .collect();
        let mean = |i: usize| {
            let sum: f64 = squares.iter().map(|square| square[i]).sum();
            (sum / squares.len().max(1) as f64).sqrt()
        };
        [mean(0), mean(1)]
    }

    /// Irradiance of an element, summed over channels.
    pub(super) fn total_irradiance(&self, element: usize) -> f64 {
        (0..self.channels())
            .map(|c| f64::from(self.solution.irradiance(c / BANDS, c % BANDS)[element]))
            .sum()
    }

    /// Squared standard error of an element's reflected light.
    pub(super) fn reflected_variance(&self, element: usize) -> f64 {
        let receiver = self.receivers.of_element(self.mesh(), element);
        self.reflected.variance(receiver)
    }
}
