//! What irradiance is made of: direct light and reflected light, each with what is known of its error.

use super::direct::{Brought, FIRST_SHARE};
use super::gather::Gathered;
use super::shoot::{Arrived, REPLICATES};

/// Direct light of the elements, as the sum over rounds of rays.
pub(super) struct DirectLight {
    /// From emitters that nearly touch, `[element][channel]`; empty before the first round.
    pub(super) near: Vec<f32>,
    /// From the others, summed over rounds.
    pub(super) far: Vec<f32>,
    /// The same summed over channels, of each replicate.
    pub(super) replicates: Vec<[f32; REPLICATES]>,
    /// Rounds of each element.
    pub(super) rounds: Vec<u32>,
    /// Factor by channel, which makes it account for all that is emitted.
    pub(super) scale: Vec<f64>,
}

impl DirectLight {
    /// Nothing is known yet.
    pub(super) fn new(elements: usize, channels: usize) -> Self {
        Self {
            near: Vec::new(),
            far: vec![0.0; channels * elements],
            replicates: vec![[0.0; REPLICATES]; elements],
            rounds: vec![0; elements],
            scale: vec![1.0; channels],
        }
    }

    /// Irradiance of an element in a channel.
    pub(super) fn irradiance(&self, element: usize, channel: usize) -> f64 {
        if self.near.is_empty() {
            return 0.0;
        }
        let i = element * self.scale.len() + channel;
        let far = f64::from(self.far[i]) / self.weight(element);
        (far + f64::from(self.near[i])) * self.scale[channel]
    }

    /// Squared standard error of the irradiance summed over channels.
    pub(super) fn variance(&self, element: usize) -> f64 {
        let weight = self.weight(element);
        variance_of_mean(self.replicates[element].map(|sum| f64::from(sum) / weight))
    }

    /// Adds a round of the elements that had one.
    pub(super) fn add_round(&mut self, brought: &Brought, had: impl Fn(usize) -> bool) {
        let channels = self.scale.len();
        let old = self.far.chunks_exact_mut(channels);
        let new = brought.irradiance.chunks_exact(channels);
        let light = old.zip(new);
        let replicates = self.replicates.iter_mut().zip(&brought.replicates);
        let rounds = self.rounds.iter_mut();
        for (e, (((old, new), (sums, found)), round)) in
            light.zip(replicates).zip(rounds).enumerate()
        {
            if had(e) {
                let weight = weight_of_round(*round);
                *round += 1;
                old.iter_mut()
                    .zip(new)
                    .for_each(|(old, new)| *old += weight * new);
                sums.iter_mut()
                    .zip(found)
                    .for_each(|(sum, found)| *sum += weight * found);
            }
        }
    }

    /// Weight of all rounds of an element.
    fn weight(&self, element: usize) -> f64 {
        let rounds = self.rounds[element].max(1);
        f64::from(weight_of_round(0)) + f64::from(rounds - 1)
    }
}

/// The first round has fewer rays.
fn weight_of_round(round: u32) -> f32 {
    if round == 0 { FIRST_SHARE } else { 1.0 }
}

/// Reflected light of the receivers, by shots and by gathering.
pub(super) struct Reflected {
    channels: usize,
    /// Exposed areas.
    pub(super) areas: Vec<f64>,
    /// By shots, `[channel][receiver]`; summed over channels, `[replicate][receiver]`.
    shot: Vec<f64>,
    shot_replicates: Vec<f64>,
    /// Rays that were shot, and all areas.
    shots: f64,
    total_area: f64,
    /// By gathering, summed over rounds, `[receiver][channel]`; summed over channels.
    gathered: Vec<f32>,
    gathered_replicates: Vec<[f32; REPLICATES]>,
    /// Rounds of each receiver, and rays of each.
    rounds: Vec<u32>,
    rays_of_round: f64,
    /// Factor by channel on what was gathered, which makes it account for all that is reflected.
    pub(super) scale: Vec<f64>,
}

impl Reflected {
    /// Nothing is known yet.
    pub(super) fn new(areas: Vec<f64>, channels: usize, rays_of_round: u64) -> Self {
        let receivers = areas.len();
        Self {
            channels,
            shot: vec![0.0; channels * receivers],
            shot_replicates: vec![0.0; REPLICATES * receivers],
            shots: 0.0,
            total_area: areas.iter().sum(),
            gathered: Vec::new(),
            gathered_replicates: Vec::new(),
            rounds: vec![0; receivers],
            rays_of_round: rays_of_round as f64,
            scale: vec![1.0; channels],
            areas,
        }
    }

    /// Adds what so many shots brought.
    pub(super) fn add_shots(&mut self, arrived: &Arrived, rays: f64) {
        let areas = &self.areas;
        let add = |old: &mut [f64], new: &[f64]| {
            for (i, (old, new)) in old.iter_mut().zip(new).enumerate() {
                let area = areas[i % areas.len()];
                *old += if area > 0.0 { new / area } else { 0.0 };
            }
        };
        add(&mut self.shot, &arrived.received);
        add(&mut self.shot_replicates, &arrived.replicates);
        self.shots += rays;
    }

    /// Adds a round of the receivers that had one.
    pub(super) fn add_round(&mut self, gathered: &Gathered, had: impl Fn(usize) -> bool) {
        if self.gathered.is_empty() {
            self.gathered = vec![0.0; gathered.irradiance.len()];
            self.gathered_replicates = vec![[0.0; REPLICATES]; self.areas.len()];
        }
        let pairs = self.gathered.iter_mut().zip(&gathered.irradiance);
        pairs.for_each(|(old, new)| *old += new);
        for (receiver, new) in gathered.replicates.iter().enumerate() {
            if had(receiver) {
                self.rounds[receiver] += 1;
                let pairs = self.gathered_replicates[receiver].iter_mut().zip(new);
                pairs.for_each(|(old, new)| *old += new);
            }
        }
    }

    /// Rounds of gathering that a receiver has had.
    pub(super) fn rounds(&self, receiver: usize) -> u32 {
        self.rounds[receiver]
    }

    /// Whether any receiver has gathered.
    pub(super) fn has_gathered(&self) -> bool {
        !self.gathered.is_empty()
    }

    /// Irradiance of a receiver in a channel, without the factor.
    pub(super) fn unscaled(&self, receiver: usize, channel: usize) -> f64 {
        let shot = self.shot[channel * self.areas.len() + receiver];
        let rounds = self.rounds[receiver];
        if rounds == 0 {
            return shot;
        }
        let sum = self.gathered[receiver * self.channels + channel];
        let share = self.share_of_shots(receiver);
        share * shot + (1.0 - share) * f64::from(sum) / f64::from(rounds)
    }

    /// Irradiance of a receiver in a channel.
    pub(super) fn irradiance(&self, receiver: usize, channel: usize) -> f64 {
        self.unscaled(receiver, channel) * self.scale[channel]
    }

    /// Squared standard error of the irradiance summed over channels.
    pub(super) fn variance(&self, receiver: usize) -> f64 {
        let receivers = self.areas.len();
        let shot = |g: usize| self.shot_replicates[g * receivers + receiver];
        let rounds = f64::from(self.rounds[receiver]);
        if rounds == 0.0 {
            return variance_of_mean(core::array::from_fn(shot));
        }
        let share = self.share_of_shots(receiver);
        let sums = &self.gathered_replicates[receiver];
        variance_of_mean(core::array::from_fn(|g| {
            share * shot(g) + (1.0 - share) * f64::from(sums[g]) / rounds
        }))
    }

    /// Weight of the estimate by shots: they and rays that gather count alike. How many shots meet a receiver is not
    /// counted but expected, by its area: a count would favour those estimates that came out large.
    fn share_of_shots(&self, receiver: usize) -> f64 {
        let shots = self.shots * self.areas[receiver] / self.total_area;
        let rays = f64::from(self.rounds[receiver]) * self.rays_of_round;
        shots / (shots + rays)
    }
}

/// Squared standard error of the mean of independent estimates.
fn variance_of_mean(values: [f64; REPLICATES]) -> f64 {
    let n = REPLICATES as f64;
    let mean = values.iter().sum::<f64>() / n;
    values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n * (n - 1.0))
}
