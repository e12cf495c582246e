//! Environment maps: light from all directions around a point, kept in pictures.

mod azimuthal;
mod cube;
mod latlong;
mod map;
mod octahedral;
mod projection;
mod solid_angle;

pub use cube::FACE_NAMES;
pub use map::{EnvironmentError, EnvironmentMap, reflected};
pub use projection::{ParseProjectionError, Projection};
