//! Environment maps: light from all directions around a point, kept in pictures.

mod azimuthal;
mod convert;
mod cube;
mod harmonics;
mod highlight;
mod latlong;
mod layout;
mod map;
mod octahedral;
mod prefilter;
mod projection;
mod pyramid;
mod set;
mod solid_angle;

pub use convert::{Conversion, ConvertOptions, convert, matching_rows};
pub use cube::FACE_NAMES;
pub use harmonics::{SphericalHarmonics, irradiance_by_texels};
pub use highlight::{DistantLight, highlights};
pub use layout::{Layout, projection_of_size};
pub use map::{EnvironmentError, EnvironmentMap, reflected};
pub use prefilter::{Lobe, PrefilterOptions, PrefilteredEnvironment};
pub use projection::{ParseProjectionError, Projection};
pub use pyramid::EnvironmentPyramid;
pub use set::{Bounds, Choice, EnvironmentSet, Probe};
