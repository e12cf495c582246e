//! How uncertain the light is.

use super::Stochastic;
use crate::solution::BANDS;
use rayon::prelude::*;

/// Elements that receive less than this share of the mean do not count for the noise.
const DIM: f64 = 0.01;

/// Estimates are worth another round where it takes off this share of what a round takes off their squared errors on
/// average.
const WORTH: f64 = 0.25;

/// Relative squared errors of elements, and the rounds behind them.
pub(super) struct Doubts {
    /// What one more round takes off.
    gains: Vec<f64>,
    least: f64,
}

impl Doubts {
    /// Of elements by their relative squared errors and rounds. An error falls with the rounds, so one more after `n`
    /// takes off its `n + 1`th part.
    fn new(squares: Vec<f64>, rounds: impl Fn(usize) -> u32) -> Self {
        let gains = squares.into_iter().enumerate();
        let gains: Vec<f64> = gains
            .map(|(e, square)| square / f64::from(rounds(e) + 1))
            .collect();
        let count = gains.iter().filter(|&&gain| gain > 0.0).count();
        let mean = gains.iter().sum::<f64>() / count.max(1) as f64;
        Self {
            gains,
            least: WORTH * mean,
        }
    }

    /// Whether an element is worth another round.
    pub(super) fn is_worth_it(&self, element: usize) -> bool {
        self.gains[element] > 0.0 && self.gains[element] >= self.least
    }
}

impl Stochastic {
    /// Of direct and of reflected light: root mean squares of relative standard errors over the elements that count.
    pub(super) fn estimate_noises(&self) -> [f64; 2] {
        let (irradiance, least) = self.bright_irradiance();
        let squares: Vec<[f64; 2]> = irradiance
            .into_par_iter()
            .enumerate()
            .filter(|&(_, h)| h > least)
            .map(|(e, h)| {
                let variances = [self.direct_light.variance(e), self.reflected_variance(e)];
                variances.map(|variance| variance / (h * h))
            })
            .collect();
        [0, 1].map(|i| {
            let sum: f64 = squares.iter().map(|square| square[i]).sum();
            (sum / squares.len().max(1) as f64).sqrt()
        })
    }

    /// Which elements want more shadow rays.
    pub(super) fn direct_doubts(&self) -> Doubts {
        let squares = self.relative_squares(|e| self.direct_light.variance(e));
        Doubts::new(squares, |e| self.direct_light.rounds[e])
    }

    /// Which elements want their receivers to gather more.
    pub(super) fn reflected_doubts(&self) -> Doubts {
        let squares = self.relative_squares(|e| self.reflected_variance(e));
        Doubts::new(squares, |e| {
            let receiver = self.receivers.of_element(self.mesh(), e);
            self.reflected.rounds(receiver)
        })
    }

    /// Squared errors relative to the irradiance, or to the least that counts.
    fn relative_squares(&self, variance: impl Fn(usize) -> f64 + Sync) -> Vec<f64> {
        let (irradiance, least) = self.bright_irradiance();
        if least <= 0.0 {
            return vec![0.0; irradiance.len()];
        }
        let squares = irradiance.into_par_iter().enumerate();
        squares
            .map(|(e, h)| variance(e) / h.max(least).powi(2))
            .collect()
    }

    /// Irradiance of all elements, and the least that counts.
    fn bright_irradiance(&self) -> (Vec<f64>, f64) {
        let elements = 0..self.mesh().elements().len();
        let irradiance: Vec<f64> = elements
            .into_par_iter()
            .map(|e| self.total_irradiance(e))
            .collect();
        let (mut flux, mut areas) = (0.0, 0.0);
        for (e, h) in irradiance.iter().enumerate() {
            let area = f64::from(self.mesh().exposed_area(e));
            flux += h * area;
            areas += area;
        }
        (irradiance, DIM * flux / areas)
    }

    /// Irradiance of an element, summed over channels.
    fn total_irradiance(&self, element: usize) -> f64 {
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
