//! Numbers off the surfaces: what is under the pointer, and grids of points as lighting reports have them.

mod grid;
mod reading;

pub use grid::{Grid, GridJob, GridOptions, GridPoint, Statistics};
pub use reading::{Reading, read_along};
