//! Where the light goes: what no element received, and how all that left is accounted for.

use super::shoot::{Arrived, Shooter};
use super::{Stochastic, outgoing};
use crate::sampling::hash;
use crate::solution::{BANDS, Solution};
use rayon::prelude::*;

/// Rays that tell which share of direct light is lost.
const PROBING_RAYS: u64 = 1 << 18;
/// Largest relative correction of what was estimated; beyond it, what was lost is corrected.
const TRUSTED_CORRECTION: f64 = 0.05;
/// Share of what is shot that must not be lost, for what arrives to be corrected by it.
const TRUSTED_LOSS: f64 = 0.5;

/// Flux that no element received, by channel: of direct light, and of reflected light.
pub(super) struct Lost {
    direct: [Vec<f64>; 2],
    /// What rays from the emitters say of direct light.
    probed: [Vec<f64>; 2],
    pub(super) reflected: [Vec<f64>; 2],
    /// Absorbed by backs and escaped before the first step.
    before: Vec<[f64; 2]>,
    shares: Option<Shares>,
}

/// Shares of what leaves by reflection, by channel, as shooting found them.
struct Shares {
    unshot: Vec<f64>,
    /// Of what is shot: to backs, and to nowhere.
    lost: [Vec<f64>; 2],
}

impl Stochastic {
    /// Rays from the emitters tell which share of direct light is lost.
    pub(super) fn probe(&mut self) {
        let mesh = self.mesh().clone();
        let mut prober = Shooter::new(&mesh, self.receivers, hash(self.options.seed, 3));
        let probe = prober.shoot(&mesh, self.direct.exitance(), PROBING_RAYS);
        self.stages.direct.rays += probe.rays;
        self.lost.probed = [probe.backs, probe.escaped];
    }

    /// Makes direct light account for all that is emitted.
    pub(super) fn close_direct(&mut self) {
        let mesh = self.mesh().clone();
        let elements = mesh.elements().len();
        for channel in 0..self.channels() {
            let area = |e: usize| f64::from(mesh.exposed_area(e));
            let kept = |e: usize| 1.0 - f64::from(mesh.transmittance()[e][channel % BANDS]);
            self.direct_light.scale[channel] = 1.0;
            let received: f64 = (0..elements)
                .map(|e| self.direct_light.irradiance(e, channel) * kept(e) * area(e))
                .sum();
            let exitance = &self.direct.exitance()[channel * elements..(channel + 1) * elements];
            let flux = |(e, &b): (usize, &f32)| f64::from(b) * area(e);
            let emitted: f64 = exitance.iter().enumerate().map(flux).sum();
            let [backs, escaped] = [0, 1].map(|way| self.lost.probed[way][channel]);
            let scale = (emitted - backs - escaped) / received;
            let is_trusted = (scale - 1.0).abs() <= TRUSTED_CORRECTION;
            let (scale, lost) = if is_trusted {
                (scale, [backs, escaped])
            } else {
                let share = (emitted - received) / (backs + escaped);
                let shares = [backs * share, escaped * share];
                let is_known = shares.iter().all(|flux| flux.is_finite());
                (
                    1.0,
                    if is_known {
                        shares
                    } else {
                        [0.0, emitted - received]
                    },
                )
            };
            self.direct_light.scale[channel] = scale;
            self.lost.direct[0][channel] = lost[0];
            self.lost.direct[1][channel] = lost[1];
        }
    }

    /// Makes what was gathered account for all that is reflected: with `κ` the share of what leaves that arrives,
    ///
    /// ```text
    /// s Σ G A (1 - τ) = κ Σ ρ A (H + s G)
    /// ```
    ///
    /// for the light `G` that was gathered, its factor `s`, and all other light `H`.
    pub(super) fn close_reflected(&mut self) {
        let mesh = self.mesh().clone();
        let elements = mesh.elements().len();
        self.find_shares();
        for channel in 0..self.channels() {
            let band = channel % BANDS;
            self.reflected.scale[channel] = 1.0;
            let gathered = &self.reflected.light[channel * elements..(channel + 1) * elements];
            let before = &self.before[channel * elements..(channel + 1) * elements];
            let (mut received, mut reflected, mut others) = (0.0, 0.0, 0.0);
            for (e, (g, before)) in gathered.iter().zip(before).enumerate() {
                let area = f64::from(mesh.exposed_area(e));
                let rho = f64::from(mesh.reflectance()[e][band]);
                let kept = 1.0 - f64::from(mesh.transmittance()[e][band]);
                received += f64::from(*g) * area * kept;
                reflected += f64::from(*g) * area * rho;
                let other = f64::from(*before) + self.direct_light.irradiance(e, channel);
                others += other * area * rho;
            }
            let Some(shares) = &self.lost.shares else {
                return;
            };
            let shot = 1.0 - shares.unshot[channel];
            let [backs, escaped] = [0, 1].map(|way| shares.lost[way][channel]);
            let arriving = shot * (1.0 - backs - escaped);
            let scale = arriving * others / (received - arriving * reflected);
            let is_trusted =
                (scale - 1.0).abs() <= TRUSTED_CORRECTION && backs + escaped <= TRUSTED_LOSS;
            let (scale, lost) = if is_trusted {
                (
                    scale,
                    [backs, escaped].map(|share| share * shot * (others + scale * reflected)),
                )
            } else {
                let lost = shot * (others + reflected) - received;
                let share = backs / (backs + escaped);
                let share = if share.is_finite() { share } else { 0.0 };
                (1.0, [lost * share, lost * (1.0 - share)])
            };
            self.reflected.scale[channel] = scale;
            for (way, lost) in lost.into_iter().enumerate() {
                self.lost.reflected[way][channel] = lost;
            }
        }
    }

    /// Before the first gathering, what shooting found of losses.
    fn find_shares(&mut self) {
        if self.lost.shares.is_some() {
            return;
        }
        let mesh = self.mesh();
        let elements = mesh.elements().len();
        let leaving = outgoing(&self.solution);
        let flux = |values: &[f32], channel: usize| -> f64 {
            let range = channel * elements..(channel + 1) * elements;
            let pairs = values[range.clone()]
                .iter()
                .zip(&self.direct.exitance()[range]);
            pairs
                .enumerate()
                .map(|(e, (b, emitted))| f64::from(b - emitted) * f64::from(mesh.exposed_area(e)))
                .sum()
        };
        let share = |part: f64, whole: f64| if whole > 0.0 { part / whole } else { 0.0 };
        let channels = 0..self.channels();
        let shot: Vec<f64> = channels.clone().map(|c| flux(&self.shot, c)).collect();
        let unshot = channels.map(|c| {
            let leaving = flux(&leaving, c);
            share(leaving - shot[c], leaving)
        });
        let unshot = unshot.collect();
        let lost = [0, 1].map(|way: usize| {
            let pairs = self.lost.reflected[way].iter().zip(&shot);
            pairs.map(|(&lost, &shot)| share(lost, shot)).collect()
        });
        self.lost.shares = Some(Shares { unshot, lost });
    }

    /// What was gathered counts as shot but for the share that shooting left.
    fn count_as_shot(&mut self) {
        let Some(shares) = &self.lost.shares else {
            return;
        };
        let elements = self.solution.mesh().elements().len();
        let leaving = outgoing(&self.solution);
        let pairs = leaving.par_iter().zip(self.direct.exitance());
        self.shot.par_iter_mut().zip(pairs).enumerate().for_each(
            |(i, (shot, (leaving, emitted)))| {
                let unshot = shares.unshot[i / elements];
                *shot = leaving - super::to_f32(unshot * f64::from(leaving - emitted));
            },
        );
    }

    /// Whether nothing is lost of a radiosity that is the same everywhere; rays find out once.
    pub(super) fn is_closed(&mut self) -> bool {
        if let Some(is_closed) = self.is_closed {
            return is_closed;
        }
        let mesh = self.mesh().clone();
        let is_tinted = mesh.transmittance().iter().any(|t| !t.is_black());
        let is_closed = !is_tinted && {
            let mut prober = Shooter::new(&mesh, self.receivers, hash(self.options.seed, 5));
            let probe = prober.shoot(&mesh, &vec![1.0; mesh.elements().len()], PROBING_RAYS);
            self.stages.spreading.rays += probe.rays;
            [probe.backs, probe.escaped]
                .iter()
                .flatten()
                .all(|&flux| flux == 0.0)
        };
        self.is_closed = Some(is_closed);
        is_closed
    }

    /// Irradiance, what of it is unshot, and where the light went.
    pub(super) fn write(&mut self, irradiance: &[f32]) {
        let mesh = self.mesh().clone();
        let elements = mesh.elements().len();
        let (values, _, balances) = self.solution.channels_mut();
        values.copy_from_slice(irradiance);
        for (channel, balance) in balances.as_flattened_mut().iter_mut().enumerate() {
            let band = channel % BANDS;
            let absorbed = |e: usize| {
                let share = 1.0 - mesh.transmittance()[e][band] - mesh.reflectance()[e][band];
                f64::from(share)
                    * f64::from(irradiance[channel * elements + e])
                    * f64::from(mesh.exposed_area(e))
            };
            let [backs, escaped] = self.lost.of(channel);
            balance.absorbed = (0..elements).map(absorbed).sum::<f64>() + backs;
            balance.escaped = escaped;
        }
        self.count_as_shot();
        let outgoing = outgoing(&self.solution);
        let shot = &self.shot;
        let (_, unshot, _) = self.solution.channels_mut();
        unshot
            .par_iter_mut()
            .zip(outgoing.par_iter().zip(shot))
            .for_each(|(unshot, (outgoing, shot))| *unshot = outgoing - shot);
    }
}

impl Lost {
    /// Nothing is lost yet but what the solution knows.
    pub(super) fn new(solution: &Solution) -> Self {
        let mesh = solution.mesh();
        let channels = solution.groups().len() * BANDS;
        let before = (0..channels).map(|channel| {
            let (group, band) = (channel / BANDS, channel % BANDS);
            let balance = solution.balance(group, band);
            let irradiance = solution.irradiance(group, band);
            let absorbed: f64 = (0..irradiance.len())
                .map(|e| {
                    let share = 1.0 - mesh.transmittance()[e][band] - mesh.reflectance()[e][band];
                    f64::from(share) * f64::from(irradiance[e]) * f64::from(mesh.exposed_area(e))
                })
                .sum();
            [balance.absorbed - absorbed, balance.escaped]
        });
        let zeros = || [vec![0.0; channels], vec![0.0; channels]];
        Self {
            before: before.collect(),
            direct: zeros(),
            probed: zeros(),
            reflected: zeros(),
            shares: None,
        }
    }

    /// Adds what shots lost.
    pub(super) fn add_reflected(&mut self, arrived: &Arrived) {
        let pairs = self
            .reflected
            .iter_mut()
            .zip([&arrived.backs, &arrived.escaped]);
        for (old, new) in pairs {
            old.iter_mut().zip(new).for_each(|(old, new)| *old += new);
        }
    }

    /// To backs, and to nowhere.
    fn of(&self, channel: usize) -> [f64; 2] {
        let way = |i: usize| {
            self.before[channel][i] + self.direct[i][channel] + self.reflected[i][channel]
        };
        [way(0), way(1)]
    }
}
