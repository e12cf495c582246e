//! Environment maps: light from all directions around a point, kept in pictures.
//!
//! [`EnvironmentMap`] is a map in one of eight projections ([`Projection`]); it is looked up by direction, bilinearly and
//! without seams. [`convert`] brings it into another projection and keeps its light. [`EnvironmentPyramid`] has its mip
//! levels, [`PrefilteredEnvironment`] its reflection in rougher and rougher surfaces, [`SphericalHarmonics`] its irradiance
//! in nine numbers, [`highlights`] those of lamps. [`EnvironmentSet`] holds maps of several places in a room.
//!
//! ```
//! use glam::Vec3;
//! use hemicube_raster::Rgb;
//! use hemicube_raster::environment::{ConvertOptions, EnvironmentMap, Projection, SphericalHarmonics, convert};
//!
//! let sky = EnvironmentMap::from_fn(Projection::LatLong, 32, 1, |d| Rgb::splat(d.y.max(0.0)));
//! let (cube, report) = convert(&sky, Projection::Cube, &ConvertOptions::default());
//! assert!(report.flux_error() < 1e-6, "no light is lost");
//! let upwards = SphericalHarmonics::of_map(&cube, 2).irradiance(Vec3::Y);
//! assert!((upwards.r / 2.094 - 1.0).abs() < 0.03, "2π/3: {upwards:?}");
//! ```
//!
//! The world is right-handed, +y up, as in glTF; *ahead* is -z, *right* is +x. Faces of a cube have the names and the
//! orientation of graphics interfaces, whose space is left-handed: face pz shows what lies ahead, px what is at the right.
//!
//! # Current state
//! All parts are written for the CPU and give the same bits on any number of threads. Nothing panics on directions;
//! those that are 0 or not finite see black. Prefiltered lobes are those of a surface seen straight on. Trilinear lookups in
//! levels of a panorama blur its poles unevenly; use cube or octahedral maps for that. On a paraboloid, lookups across
//! the rim take the nearest texel of the other half.

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
pub use prefilter::{Lobe, LobeSample, PrefilterOptions, PrefilteredEnvironment, lobe_samples};
pub use projection::{ParseProjectionError, Projection};
pub use pyramid::EnvironmentPyramid;
pub use set::{Bounds, Choice, EnvironmentSet, Probe};
