//! Pictures on the CPU: images, linear colour, and triangles drawn into them.
//!
//! This crate knows no scene: it is everything between geometry and pixels, usable on its own.
//! Colour is linear Rec. 709 in memory ([`Rgb`]); sRGB appears only where a file says so ([`color`]).
//!
//! # Current state
//! [`triangle`] draws perspective-correct triangles with a z-buffer and item buffers ([`clip`] cuts them in homogeneous
//! coordinates before), [`tonemap`] brings light into the range of a display, [`image`] holds and stores pictures (PNG in
//! sRGB, OpenEXR in linear light). Nothing here panics on the coordinates it is given; non-finite ones are not drawn.
//!
//! [`two_part`] puts textures on objects by an intermediate surface, [`bump`] tilts normals by heights and normal maps and
//! turns distant bumps into roughness, [`reflection`] has Phong's models. Where a mapping or a bump is not defined they give
//! nothing (`None`, no bump) and never a number that is not finite; `TwoPart::map` takes 70 to 200 ns a point, as
//! its derivatives go through f64 dual numbers. Not there: horizon maps (bumps cast no shadows), displacement of meshes.
#![forbid(unsafe_code)]

pub mod antialias;
pub mod bump;
pub mod clip;
pub mod color;
pub mod environment;
pub mod image;
pub mod reflection;
pub mod texture;
pub mod tonemap;
pub mod triangle;
pub mod two_part;

pub use color::Rgb;
pub use image::Image;
