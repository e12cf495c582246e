//! Pictures on the CPU: everything between geometry and pixels, usable on its own; it knows no scene.
//!
//! Colour is linear Rec. 709 in memory ([`Rgb`]); sRGB appears only where a file says so ([`color`]).
//!
//! | module | what it holds |
//! |---|---|
//! | [`line`](mod@line), [`circle`], [`ellipse`], [`stroke`], [`polygon`] | flat shapes scan-converted, readable beside their textbooks; whole pixels, or exact areas of lines, strokes and circles; drawn into any [`target`] |
//! | [`triangle`], [`clip`] | perspective-correct triangles with a z-buffer, item buffers, clipping in homogeneous coordinates |
//! | [`antialias`] | exact areas of outlines; samples and filters for any picture; their errors, measured |
//! | [`texture`] | mip chains in linear light, filters from point sampling to elliptical weighted averages, normal maps |
//! | [`two_part`] | textures on objects by way of an intermediate surface (Bier and Sloan 1986) |
//! | [`bump`], [`reflection`] | normals tilted by heights and normal maps, distant bumps as roughness; Phong's models |
//! | [`environment`] | light from all directions in eight projections, conversion between any two, levels by roughness, spherical harmonics |
//! | [`colormap`] | numbers as colours: perceptually even tables, isolines, element edges |
//! | [`noise`], [`random`] | gradient noise, hashes, even points |
//! | [`image`], [`io_error`], [`tonemap`], [`color`] | pictures in memory and in files (read: PNG, JPEG, WebP, Radiance, OpenEXR), what the system says about files in words, light into the range of a display |
//!
//! # Current state
//! Nothing here panics on the coordinates it is given: what is not finite is not drawn, and where a mapping or a bump is
//! not defined there is none. Bumps cast no shadows, and meshes are not displaced. The front page of each module states
//! its errors and what it does not do.
#![forbid(unsafe_code)]

pub mod antialias;
pub mod bump;
pub mod circle;
pub mod clip;
pub mod color;
pub mod colormap;
pub mod ellipse;
pub mod environment;
pub mod image;
pub mod io_error;
pub mod line;
pub mod noise;
pub mod polygon;
pub mod random;
pub mod reflection;
mod signed_area;
mod sinc;
pub mod stroke;
pub mod target;
pub mod texture;
pub mod tonemap;
pub mod triangle;
pub mod two_part;

pub use color::Rgb;
pub use image::Image;
