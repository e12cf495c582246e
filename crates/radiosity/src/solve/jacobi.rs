//! Jacobi iteration: all patches gather at once from the radiosities of the sweep before.

use crate::solve::system::{MatrixMethod, System};

/// One step is one sweep, `B ← E + ρ F B`: the light of one more reflection.
#[derive(Debug, Clone, Copy, Default)]
pub struct Jacobi;

impl MatrixMethod for Jacobi {
    fn step(&mut self, system: &mut System<'_>) -> bool {
        for channel in 0..system.channels.len() {
            let residuals = system.residuals(channel);
            let radiosity = &mut system.channels[channel].radiosity;
            for (b, r) in radiosity.iter_mut().zip(&residuals) {
                *b += r;
            }
        }
        true
    }

    fn restart(&mut self) {}
}
