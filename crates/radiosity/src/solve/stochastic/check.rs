//! Whether the noise is what is stated: some elements once more, by many more rays.

use super::Stochastic;
use super::estimates::{Brought, Round};
use super::gather::Scenery;
use super::guides::Guides;
use crate::sampling::hash;

/// Most rays of an element in one of the two runs, for each kind of light.
const MOST_RAYS: u32 = 1 << 17;

/// What a check of the noise found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NoiseCheck {
    /// Elements that were looked at and receive more than a hundredth of the mean.
    pub elements: usize,
    /// Root mean square of their relative standard errors as estimated.
    pub stated: f64,
    /// Root mean square of their relative errors.
    pub found: f64,
    /// Rays that it took.
    pub rays: u64,
}

/// Light of some elements, summed over channels.
struct Again {
    direct: Vec<f64>,
    reflected: Vec<f64>,
    rays: u64,
}

impl Stochastic {
    /// Looks at about `count` elements, spread evenly over the mesh, by so many `times` the rays they had, in two runs of
    /// half as many each. With `x` what was solved and `a` and `b` what the two runs say, no error of theirs is in the mean
    /// of
    ///
    /// ```text
    /// (x - a) (x - b)
    /// ```
    ///
    /// Direct light is by shadow rays to the element, but for emitters that nearly touch it, and reflected light by rays
    /// from the element alone. They gather the radiosity of the solution, whose error
    /// all elements share. The solution stays as it is. Before the first gathering there is nothing to find.
    pub fn check_noise(&mut self, count: usize, times: u32) -> NoiseCheck {
        let all = self.mesh().elements().len();
        let step = all.div_ceil(count.max(1)).max(1);
        let chosen: Vec<usize> = (0..all).step_by(step).collect();
        let runs = [7, 8].map(|run| {
            let seed = hash(self.options.seed, run);
            self.look_again(&chosen, times / 2, seed)
        });
        let weights = self.weights();
        let stated = self.relative_squares_of_elements(&weights);
        let (mut sums, mut elements) = ([0.0; 2], 0_u32);
        for (i, &e) in chosen
            .iter()
            .enumerate()
            .filter(|&(_, &e)| weights[e] > 0.0)
        {
            let solved = self.total_irradiance(e);
            let errors =
                [0, 1].map(|run: usize| solved - runs[run].direct[i] - runs[run].reflected[i]);
            elements += 1;
            sums[0] += stated[e];
            sums[1] += weights[e] * errors[0] * errors[1];
        }
        let [stated, found] =
            sums.map(|sum: f64| (sum / f64::from(elements.max(1))).max(0.0).sqrt());
        NoiseCheck {
            elements: elements as usize,
            stated,
            found,
            rays: runs.iter().map(|run| run.rays).sum(),
        }
    }

    fn look_again(&mut self, chosen: &[usize], times: u32, seed: u64) -> Again {
        let mesh = self.mesh().clone();
        let elements = mesh.elements().len();
        let more = |rays: u32| rays.max(1).saturating_mul(times.max(1)).min(MOST_RAYS);
        let mut wanted = vec![0; elements];
        for &e in chosen {
            wanted[e] = more(self.direct_light.far.rays()[e]);
        }
        let brought = self.direct.round(Round {
            wanted: &wanted,
            before: &vec![0; elements],
        });
        let direct = chosen.iter().map(|&e| self.direct_again(&brought, e));
        let direct = direct.collect();
        let light = self.gather_again(chosen, &more, seed);
        let reflected = chosen.iter().map(|&e| sum_of(&light, e, self.channels()));
        Again {
            direct,
            reflected: reflected.collect(),
            rays: brought.rays + light.rays,
        }
    }

    /// Direct light of an element and what was there before, summed over channels, by what rays brought.
    fn direct_again(&self, brought: &Brought, element: usize) -> f64 {
        let (elements, channels) = (self.mesh().elements().len(), self.channels());
        let others = |c: usize| {
            let near = self.direct_light.near.get(element * channels + c);
            let before = self.before[c * elements + element];
            f64::from(near.copied().unwrap_or(0.0)) + f64::from(before)
        };
        sum_of(brought, element, channels) + (0..channels).map(others).sum::<f64>()
    }

    /// Reflected light of some elements.
    fn gather_again(&self, chosen: &[usize], more: &dyn Fn(u32) -> u32, seed: u64) -> Brought {
        let mesh = self.mesh();
        let elements = mesh.elements().len();
        let mut wanted = vec![0; elements];
        for &e in chosen {
            let gathered = self.reflected.gathered.as_ref();
            let rays = gathered.map_or(1, |gathered| gathered.rest.rays()[e]);
            wanted[e] = more(rays).next_power_of_two();
        }
        let scenery = Scenery {
            mesh,
            highlights: None,
            radiosity: &self.reflected_radiosity(),
            channels: self.channels(),
        };
        let round = Round {
            wanted: &wanted,
            before: &vec![0; elements],
        };
        let guides = &mut Guides::new(mesh);
        scenery.gather(round, seed, guides).light
    }
}

/// Over the channels of a place.
fn sum_of(brought: &Brought, place: usize, channels: usize) -> f64 {
    let light = &brought.irradiance[place * channels..(place + 1) * channels];
    light.iter().map(|&h| f64::from(h)).sum()
}
