//! How uncertain the light is.
//!
//! What rays say of their own errors does not hold the error of the radiosity that they gather, which all receivers share.

use super::Stochastic;
use super::allocation::allocate;
use super::estimates::Estimates;
use super::light::Gathered;
use crate::solution::BANDS;
use rayon::prelude::*;

/// Elements that receive less than this share of the mean do not count for the noise.
const DIM: f64 = 0.01;

/// Places that follow each other, and so mostly lie by each other, by which errors are pooled.
const GROUPS: [usize; 2] = [8, 64];

/// Share of the noise that was asked for at which a round aims: what it takes off is foreseen from estimates.
const GOAL: f64 = 0.97;

impl Stochastic {
    /// Of direct and of reflected light: root mean squares of relative standard errors over the elements that count.
    pub(super) fn estimate_noises(&self) -> [f64; 2] {
        let weights = self.weights();
        let count = weights.iter().filter(|&&weight| weight > 0.0).count();
        let noise = |squares: &[f64]| (squares.iter().sum::<f64>() / count.max(1) as f64).sqrt();
        let gathered = self.reflected.gathered.as_ref();
        let reflected = gathered.map(|gathered| noise(&self.reflected_squares(gathered, &weights)));
        [
            noise(&relative_squares(&self.direct_light.far, &weights)),
            reflected.unwrap_or(f64::INFINITY),
        ]
    }

    /// What the noises of direct and of reflected light must come down to: the same for both, and all that is left where
    /// one has less.
    fn goals(&self) -> [f64; 2] {
        let noise = GOAL * self.options.noise;
        let half = noise / core::f64::consts::SQRT_2;
        [1, 0].map(|other: usize| {
            let other = self.noises[other].min(half);
            (noise * noise - other * other).sqrt()
        })
    }

    /// Whether direct light is farther from its goal than reflected light.
    pub(super) fn is_direct_worse(&self) -> bool {
        let [direct, reflected] = self.goals();
        self.noises[0] / direct > self.noises[1] / reflected
    }

    /// Shadow rays that the elements want next.
    pub(super) fn wanted_direct(&self) -> Vec<u32> {
        let weights = self.weights();
        let squares = relative_squares(&self.direct_light.far, &weights);
        let goal = self.squares_of(self.goals()[0], &weights);
        allocate(&squares, self.direct_light.far.rays(), goal)
    }

    /// Rays that the elements want next: to highlights, and to all other reflected light.
    pub(super) fn wanted_gathering(&self, gathered: &Gathered) -> [Vec<u32>; 2] {
        let weights = self.weights();
        let squares = self.reflected_squares(gathered, &weights);
        let rays = [&gathered.highlights, &gathered.rest].map(Estimates::rays);
        let rays = rays.concat();
        let goal = self.squares_of(self.goals()[1], &weights);
        let mut highlights = allocate(&squares, &rays, goal);
        let rest = highlights.split_off(weights.len());
        [highlights, rest]
    }

    /// Relative squared errors of highlights at all elements, then of all other reflected light.
    fn reflected_squares(&self, gathered: &Gathered, weights: &[f64]) -> Vec<f64> {
        gathered
            .parts()
            .map(|(light, shrinkage)| {
                let left = weights.iter().enumerate();
                let left: Vec<f64> = left.map(|(e, w)| w * shrinkage.left(e)).collect();
                relative_squares(light, &left)
            })
            .concat()
    }

    /// Relative squared errors of the elements, as [`Self::estimate_noises`] takes them.
    pub(super) fn relative_squares_of_elements(&self, weights: &[f64]) -> Vec<f64> {
        let mut squares = relative_squares(&self.direct_light.far, weights);
        if let Some(gathered) = &self.reflected.gathered {
            let reflected = self.reflected_squares(gathered, weights);
            for part in reflected.chunks_exact(squares.len()) {
                squares
                    .iter_mut()
                    .zip(part)
                    .for_each(|(sum, part)| *sum += part);
            }
        }
        squares
    }

    /// Sum of the squares that make a noise.
    fn squares_of(&self, noise: f64, weights: &[f64]) -> f64 {
        let count = weights.iter().filter(|&&weight| weight > 0.0).count();
        noise * noise * count as f64
    }

    /// Of each element what makes a squared error relative, 0 where it does not count: where it is dim or nothing of it is
    /// exposed.
    pub(super) fn weights(&self) -> Vec<f64> {
        let (irradiance, least) = self.bright_irradiance();
        let weight = |(e, h): (usize, f64)| {
            if h > least && self.mesh().exposed_area(e) > 0.0 {
                1.0 / (h * h)
            } else {
                0.0
            }
        };
        irradiance.into_par_iter().enumerate().map(weight).collect()
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
    pub(super) fn total_irradiance(&self, element: usize) -> f64 {
        (0..self.channels())
            .map(|c| f64::from(self.solution.irradiance(c / BANDS, c % BANDS)[element]))
            .sum()
    }
}

/// Squared errors times weights. What one ray's error is, a place takes by a third each from itself and from the means of
/// the small and the large group around it. Alone, one whose few rays happened to agree would get no more of them and
/// would be believed: errors would be stated by half too small in the dark.
fn relative_squares(light: &Estimates, weights: &[f64]) -> Vec<f64> {
    let rays = |place: usize| f64::from(light.rays()[place].max(1));
    let of_ray = |(place, weight): (usize, &f64)| weight * light.square(place) * rays(place);
    let of_rays: Vec<f64> = weights.iter().enumerate().map(of_ray).collect();
    let mut pooled: Vec<f64> = of_rays.iter().map(|own| own / 3.0).collect();
    for group in GROUPS {
        let chunks = pooled.chunks_mut(group).zip(of_rays.chunks(group));
        for (start, (pooled, of_rays)) in (0..).step_by(group).zip(chunks) {
            let counts = |&place: &usize| weights[place] > 0.0;
            let count = (start..start + of_rays.len()).filter(counts).count();
            let mean = of_rays.iter().sum::<f64>() / count.max(1) as f64;
            for (place, pooled) in (start..).zip(pooled) {
                *pooled += if weights[place] > 0.0 {
                    mean / 3.0
                } else {
                    0.0
                };
            }
        }
    }
    let pairs = pooled.into_iter().enumerate();
    pairs.map(|(place, square)| square / rays(place)).collect()
}
