//! Progressive gathering: one patch a step gathers the light of all others.

use crate::solve::system::{MatrixMethod, System};

/// One step is one patch, in the order of the mesh; as many steps as patches are a sweep of Gauss-Seidel.
#[derive(Debug, Clone, Copy, Default)]
pub struct Gathering {
    next: usize,
}

impl MatrixMethod for Gathering {
    fn step(&mut self, system: &mut System<'_>) -> bool {
        system.relax(self.next);
        self.next = (self.next + 1) % system.size();
        self.next == 0
    }

    fn restart(&mut self) {}
}
