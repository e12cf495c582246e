//! Jacobi iteration: all patches gather at once from the radiosities of the sweep before.

use crate::solve::system::{MatrixMethod, System};

/// One step is one sweep, `B ← E + ρ F B`: the light of one more reflection.
#[derive(Debug, Clone, Copy, Default)]
pub struct Jacobi;

impl MatrixMethod for Jacobi {
    fn step(&mut self, system: &mut System<'_>) -> bool {
        let residuals = system.residuals();
        for (channel, residuals) in system.channels.iter_mut().zip(&residuals) {
            for (b, r) in channel.radiosity.iter_mut().zip(residuals) {
                *b += r;
            }
        }
        true
    }

    fn restart(&mut self) {}
}
