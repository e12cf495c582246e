//! Southwell relaxation: always the patch with the largest residual, which is sorted shooting on a matrix.

use crate::form_factor::matrix::Entries;
use crate::solve::system::{MatrixMethod, System};

/// One step relaxes the patch with most residual flux over all channels: its radiosity takes up its residual, and every
/// other patch's residual grows by `ρ_j F_ji ΔB_i`. As many steps as patches count as a sweep.
///
/// Columns of the factors are read, so it keeps them transposed.
#[derive(Debug, Clone, Default)]
pub struct Southwell {
    /// Factors with rows and columns exchanged.
    columns: Vec<Entries>,
    /// Of each channel and patch; empty before the first step.
    residuals: Vec<Vec<f64>>,
    steps: usize,
}

impl Southwell {
    fn largest(&self, system: &System<'_>) -> usize {
        let flux = |i: usize| -> f64 {
            let residual: f64 = self.residuals.iter().map(|r| r[i].abs()).sum();
            residual * system.areas[i]
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
}

impl MatrixMethod for Southwell {
    fn step(&mut self, system: &mut System<'_>) -> bool {
        if self.columns.is_empty() {
            self.columns = system.matrices.iter().map(Entries::transposed).collect();
        }
        if self.residuals.is_empty() {
            let channels = 0..system.channels.len();
            self.residuals = channels.map(|c| system.residuals(c)).collect();
        }
        let i = self.largest(system);
        for (channel, residuals) in system.channels.iter_mut().zip(&mut self.residuals) {
            let column = &self.columns[channel.matrix];
            let own = f64::from(column.get(i, i));
            let change = residuals[i] / (1.0 - channel.reflectance[i] * own);
            channel.radiosity[i] += change;
            for (j, f) in column.row(i).filter(|&(j, _)| j != i) {
                residuals[j] += channel.reflectance[j] * f64::from(f) * change;
            }
            residuals[i] = 0.0;
        }
        self.steps += 1;
        self.steps.is_multiple_of(system.size())
    }

    fn restart(&mut self) {
        self.residuals.clear();
    }
}
