//! Bump mapping: normals that tilt as if the surface had relief (Blinn, *Simulation of wrinkled surfaces*, SIGGRAPH 1978).
//!
//! A height `h`, positive outwards, tilts a normal `n` against the height's slope along the surface:
//! `n' = normalize(n - grad h)`. Everything here either makes such a *surface gradient* or adds them up
//! ([`SurfaceGradient`]): from a height map's slopes, a normal map's normal, differences between pixels, a function of
//! space. Where the relief comes from:
//!
//! * [`HeightMap`]: a picture of heights, smooth under magnification (bicubic B-spline),
//! * a normal map, with [`tangents`] and [`blend_reoriented`] to lay one over another,
//! * [`relief`]: orange peel, ripples, bricks, a golf ball, noise; heights with exact gradients,
//! * [`SlopeMoments`]: any of them seen from afar, where bumps become roughness.
//!
//! [`Parallax`] moves the texture with the eye as well.
//!
//! Only normals tilt. The silhouette and the shadows stay those of the smooth surface: that is the method's limit.

mod height_map;
mod normal_map;
mod parallax;
pub mod relief;
mod slope_moments;
mod surface_gradient;
pub mod tangents;

pub use height_map::{HeightMap, HeightMapError, HeightSample, MAX_SIDE};
pub use normal_map::{blend_reoriented, decode_normal, encode_normal};
pub use parallax::{Parallax, sight_slope};
pub use slope_moments::{SlopeMoments, SlopePyramid};
pub use surface_gradient::{SurfaceGradient, blinn_normal, facing, triplanar_weights};
