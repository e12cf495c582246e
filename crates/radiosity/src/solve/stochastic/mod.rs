//! Stochastic Jacobi radiosity (Neumann 1995; Bekaert 1999): light is carried by rays, and no form factor is stored.
//!
//! The work is split by what it needs:
//!
//! 1. *Direct* light, which has the sharp shadows: shadow rays from every element to the emitters.
//! 2. *Spreading*: each step shoots all that is unshot, by as many rays as it is worth, until little is left.
//! 3. *Refining* what makes most of the noise: by more shadow rays where direct light is uncertain, or by shooting all
//!    reflected light anew, where the results of all steps are averaged by their rays, so that every ray counts. Where
//!    no ray has ever been lost, a constant radiosity needs no rays, as what leaves at it arrives at it: it is
//!    subtracted from what is shot and added to what arrives (a control variate).
//!
//! Interreflected light is counted on elements, or on patches where there are more than 50,000 elements. Rays follow
//! low-discrepancy sequences that go on from step to step. They come in four independent replicates, whose differences
//! tell the standard error of every element; [`Stochastic::noise`] sums it up.
//!
//! The cost of a step is that of its rays: with so many for each receiver, an error takes work that grows with the
//! scene as the depth of its hierarchy of boxes does beyond the number of receivers.

mod direct;
mod interpolate;
mod receivers;
mod shoot;
mod source;
mod tally;

use self::direct::Direct;
use self::interpolate::Interpolation;
use self::receivers::Receivers;
use self::shoot::{Arrived, REPLICATES, Shooter};
use crate::error::RadiosityError;
use crate::patch::PatchMesh;
use crate::sampling::hash;
use crate::solution::{BANDS, Solution};
use crate::solve::{Progress, Solver};
use rayon::prelude::*;
use std::sync::Arc;

/// How the rays are spent.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StochasticOptions {
    /// Rays for each receiver, on average, that carry all reflected light once. Default value: 256.
    pub rays: u32,
    /// Finished at this noise ([`Stochastic::noise`]). Default value: 0.03.
    pub noise: f64,
    /// Unshot share of the emitted flux at which spreading ends. Default value: 5e-4.
    pub tolerance: f64,
    /// Elements up to which each counts reflected light for itself. Default value: 50,000.
    pub counting_elements: usize,
    /// Seed of the sequences. Default value: 0.
    pub seed: u64,
}

impl Default for StochasticOptions {
    fn default() -> Self {
        Self {
            rays: 256,
            noise: 0.03,
            tolerance: 5e-4,
            counting_elements: 50_000,
            seed: 0,
        }
    }
}

/// Most steps that refine, if the noise does not come down.
const MOST_REFINEMENTS: u32 = 4096;
/// Elements are uncertain whose relative error is above this share of its root mean square.
const HALF: f64 = 0.5;
/// Unshot share of which most is the rounding of numbers.
const ROUNDING: f64 = 1e-6;
/// Rays that tell which share of direct light is lost.
const PROBING_RAYS: u64 = 1 << 18;
/// Largest relative correction of direct light by that share.
const TRUSTED_CORRECTION: f64 = 0.05;
/// Elements that receive less than this share of the mean do not count for the noise.
const DIM: f64 = 0.01;

/// What the next step does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Phase {
    Direct,
    Spread,
    Refine,
    Repeat,
    Done,
}

/// Radiosity by rays alone.
pub struct Stochastic {
    solution: Solution,
    options: StochasticOptions,
    phase: Phase,
    receivers: Receivers,
    areas: Vec<f64>,
    interpolation: Option<Interpolation>,
    shooter: Shooter,
    direct: Direct,
    light: Light,
    lost: Lost,
    /// Rays of direct light, of spreading and of repetitions.
    rays: [u64; 3],
    refinements: u32,
    /// Whether all its light is of this solver, so that it can be shot anew.
    is_new: bool,
    emitted: f64,
    noise: f64,
    /// Its parts, of direct and of reflected light.
    noises: [f64; 2],
}

/// What irradiance is made of. Elements of a channel follow each other, except where it is said otherwise.
struct Light {
    /// Before the first step: sun, sky and points, or what another solver brought.
    before: Vec<f32>,
    /// From emitters that nearly touch, and the sum over rounds of what the others bring, `[element][channel]`.
    near: Vec<f32>,
    far: Vec<f32>,
    /// Rounds of each element.
    rounds: Vec<u32>,
    /// The sum over rounds, summed over channels, of each replicate.
    far_replicates: Vec<[f32; REPLICATES]>,
    /// Factor on direct light by channel, which makes it account for all that is emitted.
    scale: Vec<f64>,
    /// Reflected light of each receiver, `[channel][receiver]`.
    indirect: Vec<f64>,
    /// The same summed over channels, of each replicate, `[replicate][receiver]`.
    replicates: Vec<f64>,
    /// Radiosity that has been shot, `[channel][element]`.
    shot: Vec<f32>,
}

/// Flux that no element received, by channel: of direct light, and of reflected light.
#[derive(Default)]
struct Lost {
    direct: [Vec<f64>; 2],
    /// What rays from the emitters say of direct light.
    probed: [Vec<f64>; 2],
    indirect: [Vec<f64>; 2],
    /// Absorbed by backs and escaped before the first step.
    before: Vec<[f64; 2]>,
}

impl Stochastic {
    /// Goes on with a solution. A new one goes through all three kinds of steps; one with steps behind it, whatever
    /// solver they were of, has its unshot light spread.
    ///
    /// # Errors
    /// No rays; a noise that is not positive.
    pub fn new(solution: Solution, options: StochasticOptions) -> Result<Self, RadiosityError> {
        let fail = |message: &str| Err(RadiosityError::Option(String::from(message)));
        if options.rays == 0 {
            return fail("a stochastic solver needs at least one ray for each receiver");
        }
        if options.noise.is_nan() || options.noise <= 0.0 {
            return fail("the noise to stop at must be more than 0");
        }
        let mesh = solution.mesh().clone();
        let channels = solution.groups().len() * BANDS;
        let elements = mesh.elements().len();
        let receivers = Receivers::of(&mesh, options.counting_elements);
        let areas = receivers.areas(&mesh);
        let is_new = solution.provenance.steps == 0;
        let exitance = if is_new {
            all_channels(&solution, Solution::exitance)
        } else {
            vec![0.0; channels * elements]
        };
        let direct = Direct::new(mesh.clone(), exitance, hash(options.seed, 1));
        let mut solver = Self {
            phase: if direct.is_dark() {
                Phase::Spread
            } else {
                Phase::Direct
            },
            interpolation: (receivers == Receivers::Patches)
                .then(|| Interpolation::new(&mesh, areas.clone())),
            shooter: Shooter::new(&mesh, receivers, hash(options.seed, 2)),
            light: Light {
                before: all_channels(&solution, Solution::irradiance),
                near: Vec::new(),
                far: vec![0.0; channels * elements],
                rounds: vec![0; elements],
                far_replicates: vec![[0.0; REPLICATES]; elements],
                scale: vec![1.0; channels],
                indirect: vec![0.0; channels * areas.len()],
                replicates: vec![0.0; REPLICATES * areas.len()],
                shot: Vec::new(),
            },
            lost: Lost::new(&solution),
            rays: [0; 3],
            refinements: 0,
            is_new,
            emitted: (0..BANDS)
                .map(|band| solution.total_balance(band).emitted)
                .sum(),
            noise: f64::INFINITY,
            noises: [f64::INFINITY; 2],
            direct,
            receivers,
            areas,
            options,
            solution,
        };
        solver.light.shot = solver.outgoing();
        let unshot = all_channels(&solver.solution, Solution::unshot);
        solver
            .light
            .shot
            .iter_mut()
            .zip(unshot)
            .for_each(|(shot, unshot)| *shot -= unshot);
        Ok(solver)
    }

    /// Relative standard error of the irradiance, root mean square over the elements that receive more than a hundredth
    /// of the mean; infinite as long as nothing is known. The error of light that was there before is not in it.
    pub fn noise(&self) -> f64 {
        self.noise
    }

    /// The noise, if this solver made all the light and knows it.
    pub fn known_noise(&self) -> Option<f64> {
        (self.is_new && self.noise.is_finite()).then_some(self.noise)
    }

    /// Rays that were cast.
    pub fn rays(&self) -> u64 {
        self.rays.iter().sum()
    }

    /// Estimated standard error of an element's irradiance, summed over channels and undimmed; infinite as long as
    /// nothing is known.
    pub fn standard_error(&self, element: usize) -> f64 {
        (self.direct_variance(element) + self.indirect_variance(element)).sqrt()
    }

    fn mesh(&self) -> &Arc<PatchMesh> {
        self.solution.mesh()
    }

    fn channels(&self) -> usize {
        self.solution.groups().len() * BANDS
    }

    /// What leaves the elements, shot or not, `[channel][element]`.
    fn outgoing(&self) -> Vec<f32> {
        let reflectance = self.mesh().reflectance();
        let mut radiosity = all_channels(&self.solution, Solution::irradiance);
        let exitance = all_channels(&self.solution, Solution::exitance);
        let elements = reflectance.len();
        for (i, (value, emitted)) in radiosity.iter_mut().zip(exitance).enumerate() {
            *value = emitted + *value * reflectance[i % elements][i / elements % BANDS];
        }
        radiosity
    }

    /// The first round of direct light.
    fn begin_direct(&mut self) {
        let near = self.direct.near();
        self.rays[0] += near.rays;
        self.light.near = near.irradiance;
        self.probe();
        // What is emitted counts as shot from now on.
        let shot = self.light.shot.iter_mut().zip(self.direct.exitance());
        shot.for_each(|(shot, emitted)| *shot += emitted);
        self.add_round(|_| true);
        self.phase = Phase::Spread;
    }

    /// One more round of direct light for the elements of which it is uncertain.
    fn refine_direct(&mut self) {
        let doubt = HALF * self.noises[0];
        let elements = 0..self.mesh().elements().len();
        let is_uncertain: Vec<bool> = elements
            .into_par_iter()
            .map(|e| {
                let irradiance = self.total_irradiance(e);
                irradiance > 0.0 && self.direct_variance(e).sqrt() >= doubt * irradiance
            })
            .collect();
        self.add_round(|e| is_uncertain[e]);
        self.phase = self.next_phase();
    }

    /// Casts one more round of rays for some elements.
    fn add_round(&mut self, is_wanted: impl Fn(usize) -> bool + Sync) {
        let light = &mut self.light;
        let brought = self
            .direct
            .round(|e| is_wanted(e).then_some(light.rounds[e]));
        self.rays[0] += brought.rays;
        let channels = light.scale.len();
        let new = brought
            .irradiance
            .chunks_exact(channels)
            .zip(&brought.replicates);
        let old = light
            .far
            .chunks_exact_mut(channels)
            .zip(&mut light.far_replicates);
        for (e, ((new, new_replicates), (old, replicates))) in new.zip(old).enumerate() {
            if !is_wanted(e) {
                continue;
            }
            light.rounds[e] += 1;
            old.iter_mut().zip(new).for_each(|(old, new)| *old += new);
            replicates
                .iter_mut()
                .zip(new_replicates)
                .for_each(|(old, new)| *old += new);
        }
        self.close_direct();
        self.update();
    }

    /// Rays from the emitters tell which share of direct light is lost.
    fn probe(&mut self) {
        let mesh = self.mesh().clone();
        let mut prober = Shooter::new(&mesh, self.receivers, hash(self.options.seed, 3));
        let probe = prober.shoot(&mesh, self.direct.exitance(), PROBING_RAYS);
        self.rays[0] += probe.rays;
        self.lost.probed = [probe.backs, probe.escaped];
    }

    /// Makes direct light account for all that is emitted.
    fn close_direct(&mut self) {
        let mesh = self.mesh().clone();
        let elements = mesh.elements().len();
        for channel in 0..self.channels() {
            let area = |e: usize| f64::from(mesh.exposed_area(e));
            let kept = |e: usize| 1.0 - f64::from(mesh.transmittance()[e][channel % BANDS]);
            self.light.scale[channel] = 1.0;
            let received: f64 = (0..elements)
                .map(|e| self.light.direct(e, channel) * kept(e) * area(e))
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
            self.light.scale[channel] = scale;
            self.lost.direct[0][channel] = lost[0];
            self.lost.direct[1][channel] = lost[1];
        }
    }

    /// Shoots all that is unshot.
    fn spread(&mut self) {
        let unshot = all_channels(&self.solution, Solution::unshot);
        let share = self.solution.unshot_fraction().min(1.0);
        let rays = self.rays_of_step() * share;
        let mesh = self.mesh().clone();
        let arrived = self.shooter.shoot(&mesh, &unshot, whole(rays));
        self.rays[1] += arrived.rays;
        self.light
            .shot
            .iter_mut()
            .zip(&unshot)
            .for_each(|(shot, unshot)| *shot += unshot);
        self.take(&arrived, 1.0, 1.0);
        self.update();
        if self.solution.unshot_fraction() <= self.options.tolerance.max(ROUNDING) {
            self.phase = self.next_phase();
        }
    }

    /// Shoots all reflected light anew and averages.
    fn repeat(&mut self) {
        let mesh = self.mesh().clone();
        let elements = mesh.elements().len();
        let mut radiosity = self.outgoing();
        if !self.direct.is_dark() {
            let exitance = self.direct.exitance();
            radiosity
                .iter_mut()
                .zip(exitance)
                .for_each(|(b, e)| *b -= e);
        }
        let constants: Vec<f32> = (0..self.channels())
            .map(|channel| {
                let range = channel * elements..(channel + 1) * elements;
                if self.loses_nothing() {
                    mean(&mesh, &radiosity[range])
                } else {
                    0.0
                }
            })
            .collect();
        let shot = radiosity.clone();
        for (channel, constant) in constants.iter().enumerate() {
            let range = channel * elements..(channel + 1) * elements;
            radiosity[range].iter_mut().for_each(|b| *b -= constant);
        }
        let rays = self.rays_of_step();
        let mut arrived = self.shooter.shoot(&mesh, &radiosity, whole(rays));
        self.add_constants(&mut arrived, &constants);
        let before = self.rays[1] + self.rays[2];
        self.rays[2] += arrived.rays;
        let weight = arrived.rays as f64 / (before + arrived.rays) as f64;
        let emitted: Vec<f32> = if !self.direct.is_dark() {
            self.direct.exitance().to_vec()
        } else {
            vec![0.0; shot.len()]
        };
        let now = shot.iter().zip(&emitted);
        for (old, (new, emitted)) in self.light.shot.iter_mut().zip(now) {
            let reflected = f64::from(*old - emitted);
            *old = to_f32(reflected + weight * (f64::from(*new) - reflected)) + emitted;
        }
        self.take(&arrived, 1.0 - weight, weight);
        self.update();
        self.phase = self.next_phase();
    }

    /// What makes most of the noise is next.
    fn next_phase(&self) -> Phase {
        let is_over = !self.is_new
            || self.noise <= self.options.noise
            || self.refinements >= MOST_REFINEMENTS;
        match (is_over, self.noises[0] > self.noises[1]) {
            (true, _) => Phase::Done,
            (false, true) => Phase::Refine,
            (false, false) => Phase::Repeat,
        }
    }

    /// Rays that carry all light once.
    fn rays_of_step(&self) -> f64 {
        f64::from(self.options.rays) * self.areas.len() as f64
    }

    fn loses_nothing(&self) -> bool {
        let lost = self.lost.direct.iter().chain(&self.lost.indirect);
        let tints = self.mesh().transmittance().iter().any(|t| !t.is_black());
        !tints && lost.flatten().all(|&flux| flux == 0.0)
    }

    /// What a constant radiosity brings where nothing is lost.
    fn add_constants(&self, arrived: &mut Arrived, constants: &[f32]) {
        let receivers = self.areas.len();
        let total: f64 = constants.iter().map(|&c| f64::from(c)).sum();
        for (receiver, area) in self.areas.iter().enumerate() {
            for (channel, &constant) in constants.iter().enumerate() {
                arrived.received[channel * receivers + receiver] += f64::from(constant) * area;
            }
            for replicate in 0..REPLICATES {
                arrived.replicates[replicate * receivers + receiver] += total * area;
            }
        }
    }

    /// Mixes what has arrived into reflected light.
    fn take(&mut self, arrived: &Arrived, kept: f64, weight: f64) {
        let receivers = self.areas.len();
        let mix = |old: &mut [f64], new: &[f64]| {
            for (i, (old, new)) in old.iter_mut().zip(new).enumerate() {
                let area = self.areas[i % receivers];
                let new = if area > 0.0 { new / area } else { 0.0 };
                *old = *old * kept + new * weight;
            }
        };
        mix(&mut self.light.indirect, &arrived.received);
        mix(&mut self.light.replicates, &arrived.replicates);
        for (old, new) in self
            .lost
            .indirect
            .iter_mut()
            .zip([&arrived.backs, &arrived.escaped])
        {
            for (old, new) in old.iter_mut().zip(new) {
                *old = *old * kept + new * weight;
            }
        }
    }

    /// Brings the solution up to date, and the noise.
    fn update(&mut self) {
        let mesh = self.mesh().clone();
        let elements = mesh.elements().len();
        let mut irradiance = vec![0.0; self.channels() * elements];
        for channel in 0..self.channels() {
            let range = channel * elements..(channel + 1) * elements;
            let values = &mut irradiance[range.clone()];
            self.spread_indirect(channel, values);
            let before = &self.light.before[range];
            values
                .par_iter_mut()
                .zip(before)
                .enumerate()
                .for_each(|(e, (value, before))| {
                    *value += before + to_f32(self.light.direct(e, channel));
                });
        }
        self.write(&irradiance);
        self.noises = self.estimate_noises();
        self.noise = self.noises[0].hypot(self.noises[1]);
    }

    /// Reflected light of the elements.
    fn spread_indirect(&self, channel: usize, values: &mut [f32]) {
        let receivers = self.areas.len();
        let indirect = &self.light.indirect[channel * receivers..(channel + 1) * receivers];
        let indirect: Vec<f32> = indirect.iter().map(|&h| to_f32(h)).collect();
        match &self.interpolation {
            Some(interpolation) => interpolation.to_elements(self.mesh(), &indirect, values),
            None => values.copy_from_slice(&indirect),
        }
    }

    /// Irradiance, what of it is unshot, and where the light went.
    fn write(&mut self, irradiance: &[f32]) {
        let mesh = self.mesh().clone();
        let elements = mesh.elements().len();
        let (values, unshot, balances) = self.solution.channels_mut();
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
        let _ = unshot;
        let outgoing = self.outgoing();
        let shot = &self.light.shot;
        let (_, unshot, _) = self.solution.channels_mut();
        unshot
            .par_iter_mut()
            .zip(outgoing.par_iter().zip(shot))
            .for_each(|(unshot, (outgoing, shot))| *unshot = outgoing - shot);
    }

    /// Of direct and of reflected light.
    fn estimate_noises(&self) -> [f64; 2] {
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
                    self.direct_variance(e) / square,
                    self.indirect_variance(e) / square,
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
    fn total_irradiance(&self, element: usize) -> f64 {
        (0..self.channels())
            .map(|c| f64::from(self.solution.irradiance(c / BANDS, c % BANDS)[element]))
            .sum()
    }

    fn direct_variance(&self, element: usize) -> f64 {
        let rounds = f64::from(self.light.rounds[element].max(1));
        let values = self.light.far_replicates[element].map(|sum| f64::from(sum) / rounds);
        variance_of_mean(values)
    }

    fn indirect_variance(&self, element: usize) -> f64 {
        let receiver = self.receivers.of_element(self.mesh(), element);
        let receivers = self.areas.len();
        variance_of_mean(core::array::from_fn(|g| {
            self.light.replicates[g * receivers + receiver]
        }))
    }
}

/// Squared standard error of the mean of independent estimates.
fn variance_of_mean(values: [f64; REPLICATES]) -> f64 {
    let n = REPLICATES as f64;
    let mean = values.iter().sum::<f64>() / n;
    values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n * (n - 1.0))
}

impl Light {
    /// Direct irradiance of an element in a channel.
    fn direct(&self, element: usize, channel: usize) -> f64 {
        if self.near.is_empty() {
            return 0.0;
        }
        let i = element * self.scale.len() + channel;
        let far = f64::from(self.far[i]) / f64::from(self.rounds[element].max(1));
        (far + f64::from(self.near[i])) * self.scale[channel]
    }
}

impl Lost {
    /// Nothing is lost yet but what the solution knows.
    fn new(solution: &Solution) -> Self {
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
            indirect: zeros(),
        }
    }

    /// To backs, and to nowhere.
    fn of(&self, channel: usize) -> [f64; 2] {
        let way = |i: usize| {
            self.before[channel][i] + self.direct[i][channel] + self.indirect[i][channel]
        };
        [way(0), way(1)]
    }
}

impl Solver for Stochastic {
    fn step(&mut self) -> Progress {
        match self.phase {
            Phase::Direct => self.begin_direct(),
            Phase::Spread => self.spread(),
            Phase::Refine => {
                self.refinements += 1;
                self.refine_direct();
            }
            Phase::Repeat => {
                self.refinements += 1;
                self.repeat();
            }
            Phase::Done => {}
        }
        self.solution.provenance.steps += 1;
        self.progress()
    }

    fn progress(&self) -> Progress {
        let unshot = self.solution.unshot_fraction();
        Progress {
            iteration: self.solution.provenance.steps,
            unshot,
            residual: unshot,
            noise: Some(self.noise),
        }
    }

    /// It is at its noise, not at a share of unshot light.
    fn is_finished(&self, _tolerance: f64) -> bool {
        self.phase == Phase::Done || self.emitted <= 0.0
    }

    fn is_exhausted(&self) -> bool {
        self.phase == Phase::Done
    }

    fn solution(&self) -> &Solution {
        &self.solution
    }

    fn into_solution(self) -> Solution {
        self.solution
    }
}

/// All channels of something, one after the other.
fn all_channels(solution: &Solution, of: fn(&Solution, usize, usize) -> &[f32]) -> Vec<f32> {
    let channels = 0..solution.groups().len() * BANDS;
    channels
        .flat_map(|c| of(solution, c / BANDS, c % BANDS).iter().copied())
        .collect()
}

/// Mean over the exposed areas.
fn mean(mesh: &PatchMesh, values: &[f32]) -> f32 {
    let (mut sum, mut areas) = (0.0, 0.0);
    for (e, &value) in values.iter().enumerate() {
        let area = f64::from(mesh.exposed_area(e));
        sum += area * f64::from(value);
        areas += area;
    }
    to_f32(sum / areas.max(f64::MIN_POSITIVE))
}

#[expect(clippy::cast_possible_truncation, reason = "light is kept in f32")]
fn to_f32(x: f64) -> f32 {
    x as f32
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a cast of floats stops at the ends of the range"
)]
fn whole(x: f64) -> u64 {
    x.ceil() as u64
}
