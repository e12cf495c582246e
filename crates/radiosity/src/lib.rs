//! From a scene to a radiosity solution, on the CPU.
#![forbid(unsafe_code)]

mod band_sum;
pub mod drawn;
mod error;
pub mod export;
pub mod form_factor;
pub mod gather;
pub mod job;
pub mod patch;
pub mod primary;
pub mod sampling;
pub mod solution;
pub mod solve;
pub mod visibility;

pub use drawn::DrawnMesh;
pub use error::RadiosityError;
pub use form_factor::{FormFactors, RayCast, RayCastOptions, Row};
pub use gather::{GatherOptions, Gatherer};
pub use job::{Quality, SolveOptions, SolverKind, resume, solve};
pub use patch::{NodeId, PatchMesh, PatchOptions};
pub use solution::{EnergyBalance, Grouping, Solution};
pub use solve::{Order, Progress, Shooting, Solver};
pub use visibility::Visibility;

/// Index as the 32-bit number that arrays of ids hold.
fn index32(index: usize) -> u32 {
    u32::try_from(index).expect("a mesh has fewer than 2^32 elements")
}
