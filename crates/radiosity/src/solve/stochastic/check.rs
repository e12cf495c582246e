//! Whether the noise is what is stated: some elements once more, by many more rays.

use super::Stochastic;
use super::estimates::{Brought, Round};
use super::gather::Scenery;
use super::receivers::Receivers;
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
    /// Root mean square of their relative errors, on the same receivers.
    pub found: f64,
    /// The same with the error of interpolation from patches to elements.
    pub found_with_interpolation: f64,
    /// Rays that it took.
    pub rays: u64,
}

/// Light of some elements, summed over channels.
struct Again {
    direct: Vec<f64>,
    /// Reflected light of their receivers, and of the elements themselves.
    reflected: [Vec<f64>; 2],
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
    /// from the element's receiver, then from the element itself. They gather the radiosity of the solution, whose error
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
        let (mut sums, mut elements) = ([0.0; 3], 0);
        for (i, &e) in chosen.iter().enumerate() {
            let receiver = self.receivers.of_element(self.mesh(), e);
            let solved = self.total_irradiance(e);
            let reflected = [self.reflected_sum(receiver), solved - self.direct_sum(e)];
            let errors = [0, 1].map(|run: usize| {
                let direct = self.direct_sum(e) - runs[run].direct[i];
                [0, 1].map(|of: usize| direct + reflected[of] - runs[run].reflected[of][i])
            });
            if weights[e] > 0.0 {
                elements += 1;
                sums[0] += stated[e];
                sums[1] += weights[e] * errors[0][0] * errors[1][0];
                sums[2] += weights[e] * errors[0][1] * errors[1][1];
            }
        }
        let [stated, found, found_with_interpolation] =
            sums.map(|sum: f64| (sum / f64::from(elements.max(1))).max(0.0).sqrt());
        NoiseCheck {
            elements: elements as usize,
            stated,
            found,
            found_with_interpolation,
            rays: runs.iter().map(|run| run.rays).sum(),
        }
    }

    /// Direct light of an element and what was there before, summed over channels.
    fn direct_sum(&self, element: usize) -> f64 {
        let elements = self.mesh().elements().len();
        let of = |c: usize| {
            self.direct_light.irradiance(element, c)
                + f64::from(self.before[c * elements + element])
        };
        (0..self.channels()).map(of).sum()
    }

    /// Reflected light of a receiver, summed over channels.
    fn reflected_sum(&self, receiver: usize) -> f64 {
        let channels = 0..self.channels();
        channels
            .map(|c| self.reflected.irradiance(receiver, c))
            .sum()
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
        let mut again = Again {
            direct: chosen
                .iter()
                .map(|&e| self.direct_again(&brought, e))
                .collect(),
            reflected: [Vec::new(), Vec::new()],
            rays: brought.rays,
        };
        for (receivers, light) in [self.receivers, Receivers::Elements]
            .into_iter()
            .zip(&mut again.reflected)
        {
            let brought = self.gather_again(chosen, receivers, &more, seed);
            let place = |&e: &usize| receivers.of_element(&mesh, e);
            *light = chosen
                .iter()
                .map(|e| sum_of(&brought, place(e), self.channels()))
                .collect();
            again.rays += brought.rays;
        }
        again
    }

    /// As [`Self::direct_sum`], of what rays brought.
    fn direct_again(&self, brought: &Brought, element: usize) -> f64 {
        let (elements, channels) = (self.mesh().elements().len(), self.channels());
        let others = |c: usize| {
            let near = self.direct_light.near.get(element * channels + c);
            let before = self.before[c * elements + element];
            f64::from(near.copied().unwrap_or(0.0)) + f64::from(before)
        };
        sum_of(brought, element, channels) + (0..channels).map(others).sum::<f64>()
    }

    /// Reflected light at the receivers of some elements.
    fn gather_again(
        &self,
        chosen: &[usize],
        receivers: Receivers,
        more: &dyn Fn(u32) -> u32,
        seed: u64,
    ) -> Brought {
        let mesh = self.mesh();
        let count = receivers.areas(mesh).len();
        let mut wanted = vec![0; count];
        for &e in chosen {
            let receiver = self.receivers.of_element(mesh, e);
            let gathered = self.reflected.gathered.as_ref();
            let rays = gathered.map_or(1, |gathered| gathered.rest.rays()[receiver]);
            wanted[receivers.of_element(mesh, e)] = more(rays).next_power_of_two();
        }
        let scenery = Scenery {
            mesh,
            highlights: None,
            radiosity: &self.reflected_radiosity(),
            receivers,
            channels: self.channels(),
        };
        let round = Round {
            wanted: &wanted,
            before: &vec![0; count],
        };
        scenery.gather(round, seed)
    }
}

/// Over the channels of a place.
fn sum_of(brought: &Brought, place: usize, channels: usize) -> f64 {
    let light = &brought.irradiance[place * channels..(place + 1) * channels];
    light.iter().map(|&h| f64::from(h)).sum()
}
