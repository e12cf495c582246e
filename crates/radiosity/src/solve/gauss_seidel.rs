//! Gauss-Seidel iteration: patches gather one after the other, each from what the others have by then.

use crate::solve::system::{MatrixMethod, System};

/// One step is one sweep over all patches, in the order of the mesh.
#[derive(Debug, Clone, Copy, Default)]
pub struct GaussSeidel;

impl MatrixMethod for GaussSeidel {
    fn step(&mut self, system: &mut System<'_>) -> bool {
        for i in 0..system.size() {
            system.relax(i);
        }
        true
    }

    fn restart(&mut self) {}
}
