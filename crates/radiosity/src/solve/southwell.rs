//! Southwell relaxation: always the patch with the largest residual, which is sorted shooting on a matrix
//! (Southwell 1946; Gortler, Cohen, Slusallek 1994, *Radiosity and relaxation methods*, on the kinship).

use crate::form_factor::matrix::Entries;
use crate::solve::system::{MatrixMethod, System};

/// One step relaxes the patch with most residual flux over all channels: its radiosity takes up its residual, and every
/// other patch's residual grows by `ρ_j F_ji ΔB_i`. As many steps as patches count as a sweep.
///
/// Columns of the factors are read, so it keeps them transposed.
#[derive(Debug, Clone, Default)]
pub struct Southwell {
    residuals: Residuals,
    steps: usize,
}

impl MatrixMethod for Southwell {
    fn step(&mut self, system: &mut System<'_>) -> bool {
        self.residuals.prepare(system);
        let i = self.residuals.largest(system, |_, _, residual| residual);
        for channel in 0..system.channels.len() {
            self.residuals.shoot(system, channel, i, 0.0);
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

/// Residuals that follow each change of a radiosity.
#[derive(Debug, Clone, Default)]
pub(super) struct Residuals {
    /// Factors with rows and columns exchanged.
    columns: Vec<Entries>,
    /// Of each channel and patch; empty before the first step.
    values: Vec<Vec<f64>>,
}

impl Residuals {
    /// Computes what is not known yet.
    pub(super) fn prepare(&mut self, system: &System<'_>) {
        if self.columns.is_empty() {
            self.columns = system.matrices.iter().map(Entries::transposed).collect();
        }
        if self.values.is_empty() {
            self.values = system.residuals();
        }
    }

    /// Forgets the residuals, not the factors.
    pub(super) fn restart(&mut self) {
        self.values.clear();
    }

    /// Of each channel and patch.
    pub(super) fn values(&self) -> &[Vec<f64>] {
        &self.values
    }

    pub(super) fn known(&self) -> Option<&[Vec<f64>]> {
        (!self.values.is_empty()).then_some(&self.values)
    }

    /// The patch whose `measure(channel, patch, residual)`, as absolute flux over all channels, is the largest; the
    /// first of equal ones.
    pub(super) fn largest(
        &self,
        system: &System<'_>,
        measure: impl Fn(usize, usize, f64) -> f64,
    ) -> usize {
        let flux = |i: usize| -> f64 {
            let channels = self.values.iter().enumerate();
            let sum: f64 = channels.map(|(c, r)| measure(c, i, r[i]).abs()).sum();
            sum * system.areas[i]
        };
        let mut largest = (0, flux(0));
        for i in 1..system.size() {
            let candidate = (i, flux(i));
            if candidate.1 > largest.1 {
                largest = candidate;
            }
        }
        largest.0
    }

    /// Changes the radiosity of patch i so that its residual becomes `-owed`, and hands the change on.
    pub(super) fn shoot(&mut self, system: &mut System<'_>, channel: usize, i: usize, owed: f64) {
        let residuals = &mut self.values[channel];
        let channel = &mut system.channels[channel];
        let column = &self.columns[channel.matrix];
        let own = f64::from(column.get(i, i));
        let change = (residuals[i] + owed) / (1.0 - channel.reflectance[i] * own);
        channel.radiosity[i] += change;
        for (j, f) in column.row(i).filter(|&(j, _)| j != i) {
            residuals[j] += channel.reflectance[j] * f64::from(f) * change;
        }
        residuals[i] = -owed;
    }
}
