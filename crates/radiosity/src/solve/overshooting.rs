//! Overshooting: a patch shoots also what it is expected to get back (Feda, Purgathofer 1992, *Accelerating radiosity
//! by overshooting*).
//!
//! The estimate is the ambient term: of the irradiance that all unshot light will bring in the end, patch i reflects
//! `ΔB'_i = ρ_i · ambient`. It shoots `ΔB_i + ΔB'_i` and is then owed: its unshot radiosity is `-ΔB'_i`. What comes
//! back fills that up, and the patch need not shoot again for it. The patch with the largest `|ΔB_i + ΔB'_i| A_i` is
//! next. Unshot light may thus be negative, and is then shot negatively.
//!
//! It converges: signed, each shot takes `(1 - ρ̄) (ΔB_i + ΔB'_i) A_i` off the sum of all unshot light, to which the
//! estimate is proportional. Without an estimate left it is sorted shooting.

use crate::patch::PatchMesh;
use crate::solution::{BANDS, Solution};
use crate::solve::ambient::Interior;
use crate::solve::max_tree::MaxTree;
use crate::solve::shooting::unshot_flux;
use crate::solve::southwell::Residuals;
use crate::solve::system::{MatrixMethod, System};

/// What patches of a mesh are expected to get back.
#[derive(Clone)]
pub(super) struct Estimate {
    interior: Interior,
    /// `Σ ρ_e A_e` of each patch, by band.
    reflecting: [Vec<f64>; BANDS],
    /// Irradiance still to come, by channel.
    ambient: Vec<f64>,
    /// By band, of what this solver has shot: all of it, and what met no surface.
    shot: [f64; BANDS],
    escaped: [f64; BANDS],
}

impl Estimate {
    pub(super) fn new(mesh: &PatchMesh) -> Self {
        let of_patch = |patch: usize, band: usize| -> f64 {
            let elements = mesh.elements_of_patch(patch);
            elements
                .map(|e| f64::from(mesh.exposed_area(e)) * f64::from(mesh.reflectance()[e][band]))
                .sum()
        };
        let patches = 0..mesh.patches().len();
        Self {
            interior: Interior::new(mesh),
            reflecting: [0, 1, 2].map(|band| patches.clone().map(|p| of_patch(p, band)).collect()),
            ambient: Vec::new(),
            shot: [0.0; BANDS],
            escaped: [0.0; BANDS],
        }
    }

    /// Learns from a shot how much of the light stays in the scene.
    pub(super) fn learn(&mut self, band: usize, flux: f64, escaped: f32) {
        self.shot[band] += flux.abs();
        self.escaped[band] += flux.abs() * f64::from(escaped);
    }

    /// Share of what is shot that meets a surface; none before the first shot, which so shoots only what is there.
    fn kept(&self, band: usize) -> f64 {
        if self.shot[band] > 0.0 {
            1.0 - self.escaped[band] / self.shot[band]
        } else {
            0.0
        }
    }

    /// Estimates anew; gives what each patch would shoot, as absolute flux over all channels.
    pub(super) fn refreshed(&mut self, solution: &Solution) -> MaxTree {
        let patches = 0..solution.mesh().patches().len();
        let fluxes: Vec<Vec<f64>> = patches.map(|p| unshot_flux(solution, p)).collect();
        let of_channel = |channel: usize| {
            let (band, unshot) = (channel % BANDS, fluxes.iter().map(|f| f[channel]).sum());
            self.interior.ambient(band, unshot, self.kept(band))
        };
        self.ambient = (0..solution.groups().len() * BANDS)
            .map(of_channel)
            .collect();
        let shot = |(patch, fluxes): (usize, &Vec<f64>)| -> f64 {
            let channels = fluxes.iter().enumerate();
            channels
                .map(|(c, flux)| (flux + self.ambient[c] * self.reflecting[c % BANDS][patch]).abs())
                .sum()
        };
        let shots: Vec<f64> = fluxes.iter().enumerate().map(shot).collect();
        MaxTree::new(&shots)
    }

    /// Irradiance still to come in a channel, as last estimated.
    pub(super) fn ambient(&self, channel: usize) -> f64 {
        self.ambient[channel]
    }

    /// Nothing is expected until it is estimated anew.
    pub(super) fn forget(&mut self) {
        self.ambient.fill(0.0);
    }
}

/// Overshooting on a matrix. One step is one patch, as many steps as patches count as a sweep.
///
/// Columns of the factors are read, so it keeps them transposed.
#[derive(Debug, Clone, Default)]
pub struct Overshooting {
    residuals: Residuals,
    /// Of each channel: what becomes of a net residual flux of 1, as irradiance of all patches.
    gains: Vec<f64>,
    steps: usize,
}

/// `κ / (A (1 - ρ̄ κ))` with the mean reflectance ρ̄ and the share κ of light that meets a patch.
fn gain(system: &System<'_>, channel: usize) -> f64 {
    let area = system.areas.iter().sum::<f64>().max(f64::MIN_POSITIVE);
    let mean = |of: &dyn Fn(usize) -> f64| -> f64 {
        let products = system.areas.iter().enumerate().map(|(i, a)| a * of(i));
        products.sum::<f64>() / area
    };
    let factors = system.factors(channel);
    let meets = mean(&|i| factors.row(i).map(|(_, f)| f64::from(f)).sum()).min(1.0);
    let reflectance = mean(&|i| system.channels[channel].reflectance[i]);
    meets / (area * (1.0 - (reflectance * meets).min(0.999)))
}

impl Overshooting {
    /// Radiosity that each patch is expected to reflect in the end, over its reflectance, by channel.
    fn ambient(&self, system: &System<'_>) -> Vec<f64> {
        let of_channel = |(residuals, gain): (&Vec<f64>, &f64)| {
            let fluxes = residuals.iter().zip(system.areas).map(|(r, a)| r * a);
            gain * fluxes.sum::<f64>()
        };
        self.residuals
            .values()
            .iter()
            .zip(&self.gains)
            .map(of_channel)
            .collect()
    }
}

impl MatrixMethod for Overshooting {
    fn step(&mut self, system: &mut System<'_>) -> bool {
        self.residuals.prepare(system);
        if self.gains.is_empty() {
            let channels = 0..system.channels.len();
            self.gains = channels.map(|c| gain(system, c)).collect();
        }
        let ambient = self.ambient(system);
        let ahead =
            |channel: usize, i: usize| system.channels[channel].reflectance[i] * ambient[channel];
        let i = self
            .residuals
            .largest(system, |channel, i, residual| residual + ahead(channel, i));
        let owed: Vec<f64> = (0..system.channels.len()).map(|c| ahead(c, i)).collect();
        for (channel, owed) in owed.into_iter().enumerate() {
            self.residuals.shoot(system, channel, i, owed);
        }
        self.steps += 1;
        self.steps.is_multiple_of(system.size())
    }

    fn restart(&mut self) {
        self.residuals.restart();
    }

    fn residuals(&self) -> Option<&[Vec<f64>]> {
        self.residuals.known()
    }
}
