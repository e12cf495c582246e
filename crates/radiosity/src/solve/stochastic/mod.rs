//! Stochastic Jacobi radiosity (Neumann 1995; Bekaert 1999): light is carried by rays, and no form factor is stored.
//!
//! The work is split by what it needs:
//!
//! 1. *Direct* light, which has the sharp shadows: shadow rays from every element to the emitters, which find what differs
//!    from a guess by the neighbourhood.
//! 2. *Spreading*: each step shoots all that is unshot, by as many rays as it is worth, until little is left. Where no
//!    ray is lost, from whatever surface, a constant radiosity needs no rays, as what leaves at it arrives at it: it is
//!    subtracted from what is shot and added to what arrives (a control variate).
//! 3. *Gathering* reflected light at every element, that of the brightest surfaces by shadow rays of their own; the others go
//!    where earlier ones found light. In the open the elements of a patch are as good as one; close to other surfaces each
//!    sees for itself.
//! 4. *Refining* what makes most of the noise, by as many rays for each place as its error asks for. What shots brought
//!    is no longer needed then, all later estimates of a place are averaged.
//!
//! Shots are counted on elements, or on patches where there are more than 50,000 elements. Rays follow
//! low-discrepancy sequences. How their parts differ tells the standard error of every element; [`Stochastic::noise`] sums
//! it up.
//!
//! The cost of a step is that of its rays: with so many for each element, an error takes work that grows with the
//! scene as the depth of its hierarchy of boxes does beyond the number of receivers.

mod allocation;
mod balance;
mod cells;
mod check;
mod direct;
mod emitters;
mod estimates;
mod gather;
mod guides;
mod highlights;
mod interpolate;
mod light;
mod lights;
mod noise;
mod receivers;
mod shadow_rays;
mod shoot;
mod shrinkage;
mod source;
mod stages;
mod strata;
mod tally;
mod view;

pub use self::check::NoiseCheck;
pub use self::stages::{Stage, Stages};
use crate::cast::to_f32;

use self::balance::Lost;
use self::direct::Direct;
use self::estimates::LEAST_RAYS;
use self::gather::Scenery;
use self::guides::Guides;
use self::highlights::Highlights;
use self::interpolate::Interpolation;
use self::light::{DirectLight, Reflected};
use self::receivers::Receivers;
use self::shoot::{Arrived, Shooter};
use crate::error::RadiosityError;
use crate::patch::PatchMesh;
use crate::sampling::hash;
use crate::solution::{BANDS, Solution};
use crate::solve::{Progress, Solver};
use rayon::prelude::*;
use std::sync::Arc;
use std::time::Instant;

/// How the rays are spent.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StochasticOptions {
    /// Rays by which each element gathers reflected light at first, rounded up to a power of two, and with a quarter as many
    /// or 64 direct light; those that are uncertain get more. Where patches count shots, the elements of each share a
    /// quarter of the rays. For spreading light a quarter as many are shot for each receiver, on average. Default value: 256.
    pub rays: u32,
    /// Finished at this noise ([`Stochastic::noise`]). Default value: 0.03.
    pub noise: f64,
    /// Unshot share of the emitted flux at which spreading ends. Default value: 5e-4.
    pub tolerance: f64,
    /// Elements up to which each counts for itself what is shot; beyond, patches do until elements gather. Default value: 50,000.
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
/// Unshot share of which most is the rounding of numbers.
const ROUNDING: f64 = 1e-6;
/// Share of the rays by which a receiver gathers that is shot for it while light is spread.
const SPREADING: f64 = 0.25;
/// Shadow rays to highlights of each element in the first gathering, at least.
const LEAST_HIGHLIGHT_RAYS: u32 = 4;
/// Patches gather by so many times fewer rays than elements at first.
const FIRST_SHARE: u32 = 4;
/// Least shadow rays of each element in the first round that counts, enough to tell where more are wanted; and rays by
/// which it gathers for each of them.
const SHADOW_RAYS: u32 = 32;
const GATHERED_FOR_SHADOW: u32 = 8;
/// Least rays that spread all light: they also tell how much is lost.
const LEAST_SHOTS: f64 = (1_u32 << 18) as f64;

/// What the next step does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Phase {
    Direct,
    Spread,
    Refine,
    Gather,
    Done,
}

/// Radiosity by rays alone.
pub struct Stochastic {
    solution: Solution,
    options: StochasticOptions,
    phase: Phase,
    receivers: Receivers,
    interpolation: Interpolation,
    shooter: Shooter,
    direct: Direct,
    /// None before the first gathering.
    highlights: Option<Highlights>,
    guides: Guides,
    /// Irradiance before the first step, `[channel][element]`: sun, sky and points, or what another solver brought.
    before: Vec<f32>,
    direct_light: DirectLight,
    reflected: Reflected,
    /// Radiosity that has been shot, `[channel][element]`.
    shot: Vec<f32>,
    lost: Lost,
    /// Whether nothing of what leaves any surface is lost, once it is known.
    is_closed: Option<bool>,
    stages: Stages,
    refinements: u32,
    /// Whether all its light is of this solver, so that it can be refined.
    is_new: bool,
    emitted: f64,
    noise: f64,
    /// Its parts, of direct and of reflected light.
    noises: [f64; 2],
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
        let is_new = solution.provenance.steps == 0;
        let exitance = if is_new {
            all_channels(&solution, Solution::exitance)
        } else {
            vec![0.0; channels * elements]
        };
        let direct = Direct::new(mesh.clone(), exitance, hash(options.seed, 1));
        let mut shot = outgoing(&solution);
        let unshot = all_channels(&solution, Solution::unshot);
        let pairs = shot.iter_mut().zip(unshot);
        pairs.for_each(|(shot, unshot)| *shot -= unshot);
        Ok(Self {
            phase: if direct.is_dark() {
                Phase::Spread
            } else {
                Phase::Direct
            },
            interpolation: Interpolation::new(&mesh, Receivers::Patches.areas(&mesh)),
            shooter: Shooter::new(&mesh, receivers, hash(options.seed, 2)),
            before: all_channels(&solution, Solution::irradiance),
            direct_light: DirectLight::new(elements, channels),
            reflected: Reflected::new(&mesh, receivers, channels),
            highlights: None,
            guides: Guides::new(&mesh),
            lost: Lost::new(&solution),
            is_closed: None,
            stages: Stages::default(),
            refinements: 0,
            is_new,
            emitted: (0..BANDS)
                .map(|band| solution.total_balance(band).emitted)
                .sum(),
            noise: f64::INFINITY,
            noises: [f64::INFINITY; 2],
            shot,
            direct,
            receivers,
            options,
            solution,
        })
    }

    /// Relative standard error of the irradiance, root mean square over the elements that receive more than a hundredth
    /// of the mean; infinite as long as nothing is known. Neither the error of light that was there before is in it, nor
    /// that of the radiosity that is gathered.
    ///
    /// It is an estimate: by [`Self::check_noise`] with 64 times the rays, 5.7 % are found where 5.7 % are stated in the
    /// `theatre` (232,479 elements on 95,407 patches), 5.6 % for 5.8 % in the `steel-mill` (111,854 on 36,038), 9.7 % for
    /// 9.5 % in a `theatre` of 295,807 elements with fewer rays.
    pub fn noise(&self) -> f64 {
        self.noise
    }

    /// The noise, if this solver made all the light and knows it.
    pub fn known_noise(&self) -> Option<f64> {
        (self.is_new && self.noise.is_finite()).then_some(self.noise)
    }

    /// Its parts: of direct light, and of reflected light.
    pub fn noises(&self) -> [f64; 2] {
        self.noises
    }

    /// Rays that were cast.
    pub fn rays(&self) -> u64 {
        self.stages.rays()
    }

    /// Rays and time of each stage so far.
    pub fn stages(&self) -> Stages {
        self.stages
    }

    /// Estimated standard error of an element's irradiance, summed over channels and undimmed; infinite as long as
    /// nothing is known.
    pub fn standard_error(&self, element: usize) -> f64 {
        (self.direct_light.square(element) + self.reflected.square(element)).sqrt()
    }

    fn mesh(&self) -> &Arc<PatchMesh> {
        self.solution.mesh()
    }

    fn channels(&self) -> usize {
        self.solution.groups().len() * BANDS
    }

    /// The first rounds of direct light.
    fn begin_direct(&mut self) {
        let start = Instant::now();
        let (near, rays) = self.direct.near();
        self.stages.direct.rays += rays;
        self.direct_light.near = near;
        self.probe();
        // What is emitted counts as shot from now on.
        let shot = self.shot.iter_mut().zip(self.direct.exitance());
        shot.for_each(|(shot, emitted)| *shot += emitted);
        let elements = self.mesh().elements().len();
        let rays = (self.options.rays / GATHERED_FOR_SHADOW).next_power_of_two();
        self.add_direct_round(&vec![rays.max(SHADOW_RAYS); elements]);
        self.stages.direct.time += start.elapsed();
        self.update();
        self.phase = Phase::Spread;
    }

    /// One more round of direct light where it takes most off the noise.
    fn refine_direct(&mut self) {
        let start = Instant::now();
        self.add_direct_round(&self.wanted_direct());
        self.stages.direct.time += start.elapsed();
        self.update();
        self.phase = self.next_phase();
    }

    /// Casts one more round of shadow rays.
    fn add_direct_round(&mut self, wanted: &[u32]) {
        let brought = self.direct.round(self.direct_light.far.round(wanted));
        self.stages.direct.rays += brought.rays;
        self.direct_light.far.add(&brought, wanted);
        self.close_direct();
    }

    /// Shoots all that is unshot.
    fn spread(&mut self) {
        let start = Instant::now();
        let unshot = all_channels(&self.solution, Solution::unshot);
        let share = self.solution.unshot_fraction().min(1.0);
        let rays = (SPREADING * self.rays_of_step()).max(LEAST_SHOTS) * share;
        let arrived = self.shoot(&unshot, rays);
        self.stages.spreading.rays += arrived.rays;
        let pairs = self.shot.iter_mut().zip(&unshot);
        pairs.for_each(|(shot, unshot)| *shot += unshot);
        self.reflected
            .add_shots(self.solution.mesh(), &arrived, &self.interpolation);
        self.lost.add_reflected(&arrived);
        self.stages.spreading.time += start.elapsed();
        self.update();
        if self.solution.unshot_fraction() <= self.options.tolerance.max(ROUNDING) {
            self.phase = self.next_phase();
        }
    }

    /// Shoots a radiosity; a constant part of it without rays, where nothing is lost.
    fn shoot(&mut self, radiosity: &[f32], rays: f64) -> Arrived {
        let mesh = self.mesh().clone();
        if !self.is_closed() {
            return self.shooter.shoot(&mesh, radiosity, whole(rays));
        }
        let elements = mesh.elements().len();
        let channels = radiosity.chunks_exact(elements);
        let constants: Vec<f32> = channels.map(|values| mean(&mesh, values)).collect();
        let rest = radiosity.chunks_exact(elements).zip(&constants);
        let rest: Vec<f32> = rest
            .flat_map(|(values, constant)| values.iter().map(move |b| b - constant))
            .collect();
        let share = magnitude(&mesh, &rest) / magnitude(&mesh, radiosity).max(f64::MIN_POSITIVE);
        let mut arrived = self
            .shooter
            .shoot(&mesh, &rest, whole(rays * share.min(1.0)));
        arrived.add_constants(&self.reflected.areas, &constants);
        arrived
    }

    /// Gathers reflected light at the elements of which it is uncertain, at all of them the first time.
    fn gather(&mut self) {
        let start = Instant::now();
        let mesh = self.mesh().clone();
        let radiosity = self.reflected_radiosity();
        let mut highlights = self.highlights.take().unwrap_or_else(|| {
            let seed = hash(self.options.seed, 6);
            Highlights::new(&mesh, &radiosity, self.channels(), seed)
        });
        let first = self.first_gathering(highlights.is_empty());
        let wanted = match &self.reflected.gathered {
            Some(draft) if self.reflected.is_draft() => {
                larger(&first, &self.wanted_gathering(draft))
            }
            Some(gathered) => self.wanted_gathering(gathered),
            None => first,
        };
        let scenery = Scenery {
            mesh: &mesh,
            highlights: Some(&highlights),
            radiosity: &radiosity,
            channels: self.channels(),
        };
        let [to_highlights, to_rest] = &wanted;
        let gathered = self.reflected.gathered();
        let seed = if gathered.is_draft { 9 } else { 4 };
        let seed = hash(self.options.seed, seed);
        let rest = scenery.gather(gathered.rest.round(to_rest), seed, &mut self.guides);
        let brought = highlights.round(gathered.highlights.round(to_highlights));
        self.stages.gathering.rays += rest.light.rays + brought.rays;
        let brought = (&brought, &rest);
        self.reflected
            .add_gathered(&mesh, brought, &wanted, &self.interpolation);
        self.highlights = Some(highlights);
        self.stages.gathering.time += start.elapsed();
        self.update();
        self.phase = self.next_phase();
    }

    /// Rays of the first gathering: those of a receiver are shared by its elements.
    fn first_gathering(&self, is_without_highlights: bool) -> [Vec<u32>; 2] {
        let mesh = self.mesh();
        let rays = |e: usize| match self.receivers {
            Receivers::Elements => self.options.rays,
            Receivers::Patches => {
                let elements = mesh.elements_of_patch(mesh.patch_of_element(e));
                self.options.rays / FIRST_SHARE / crate::index32(elements.len())
            }
        };
        let elements = 0..mesh.elements().len();
        // What is buried has none: nothing would be taken for its light.
        let exposed = |e: usize| u32::from(mesh.exposed_area(e) > 0.0);
        let to_rest: Vec<u32> = elements
            .map(|e| exposed(e) * rays(e).next_power_of_two().max(LEAST_RAYS))
            .collect();
        let to_highlights = |&rays: &u32| {
            if is_without_highlights || rays == 0 {
                0
            } else {
                (rays / 4).max(LEAST_HIGHLIGHT_RAYS)
            }
        };
        [to_rest.iter().map(to_highlights).collect(), to_rest]
    }

    /// What leaves the elements by reflection, `[element][channel]`.
    fn reflected_radiosity(&self) -> Vec<f32> {
        let reflectance = self.mesh().reflectance();
        let channels = self.channels();
        let mut radiosity = vec![0.0; channels * reflectance.len()];
        for channel in 0..channels {
            let irradiance = self.solution.irradiance(channel / BANDS, channel % BANDS);
            let out = radiosity.iter_mut().skip(channel).step_by(channels);
            for ((out, h), rho) in out.zip(irradiance).zip(reflectance) {
                *out = h * rho[channel % BANDS];
            }
        }
        radiosity
    }

    /// What makes most of the noise is next.
    fn next_phase(&self) -> Phase {
        let is_over = !self.is_new
            || self.noise <= self.options.noise
            || self.refinements >= MOST_REFINEMENTS;
        if self.is_new && self.reflected.is_draft() {
            return Phase::Gather;
        }
        match (is_over, self.is_direct_worse()) {
            (true, _) => Phase::Done,
            (false, true) => Phase::Refine,
            (false, false) => Phase::Gather,
        }
    }

    /// Rays that carry all light once.
    fn rays_of_step(&self) -> f64 {
        f64::from(self.options.rays) * self.reflected.areas.len() as f64
    }

    /// Brings the solution up to date, and the noise.
    fn update(&mut self) {
        if self.reflected.gathered.is_some() {
            self.close_reflected();
        }
        let elements = self.mesh().elements().len();
        let mut irradiance = vec![0.0; self.channels() * elements];
        for channel in 0..self.channels() {
            let range = channel * elements..(channel + 1) * elements;
            let values = irradiance[range.clone()].par_iter_mut();
            let pairs = values.zip(&self.before[range]).enumerate();
            pairs.for_each(|(e, (value, before))| {
                let reflected = self.reflected.irradiance(e, channel);
                let direct = self.direct_light.irradiance(e, channel);
                *value = before + to_f32(reflected) + to_f32(direct);
            });
        }
        self.write(&irradiance);
        self.noises = self.estimate_noises();
        self.noise = self.noises[0].hypot(self.noises[1]);
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
            Phase::Gather => {
                self.refinements += 1;
                self.gather();
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

/// The larger of the rays that two want of each kind.
fn larger(first: &[Vec<u32>; 2], second: &[Vec<u32>; 2]) -> [Vec<u32>; 2] {
    [0, 1].map(|kind: usize| {
        let pairs = first[kind].iter().zip(&second[kind]);
        pairs.map(|(&a, &b)| a.max(b)).collect()
    })
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

/// What leaves the elements, shot or not, `[channel][element]`.
fn outgoing(solution: &Solution) -> Vec<f32> {
    let reflectance = solution.mesh().reflectance();
    let mut radiosity = all_channels(solution, Solution::irradiance);
    let exitance = all_channels(solution, Solution::exitance);
    let elements = reflectance.len();
    for (i, (value, emitted)) in radiosity.iter_mut().zip(exitance).enumerate() {
        *value = emitted + *value * reflectance[i % elements][i / elements % BANDS];
    }
    radiosity
}

/// Flux of all channels, whatever its signs.
fn magnitude(mesh: &PatchMesh, radiosity: &[f32]) -> f64 {
    let elements = mesh.elements().len();
    let flux = |(i, b): (usize, &f32)| f64::from(b.abs() * mesh.exposed_area(i % elements));
    radiosity.iter().enumerate().map(flux).sum()
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a cast of floats stops at the ends of the range"
)]
fn whole(x: f64) -> u64 {
    x.ceil() as u64
}
