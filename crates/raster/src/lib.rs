//! Pictures on the CPU: images, linear colour, and what is drawn into them: lines, circles, polygons, triangles.
//!
//! This crate knows no scene: it is everything between geometry and pixels, usable on its own.
//! Colour is linear Rec. 709 in memory ([`Rgb`]); sRGB appears only where a file says so ([`color`]).
//!
//! # Current state
//! [`line`](mod@line), [`circle`], [`ellipse`], [`polygon`] and [`stroke`] scan-convert flat shapes, readable beside their textbooks
//! and fast, whole pixels or, for lines, strokes and circles, exact coverage; all of them clip before they step and draw
//! into any [`target`]. [`triangle`] draws perspective-correct triangles with a z-buffer and item buffers ([`clip`] cuts them in homogeneous
//! coordinates before), [`tonemap`] brings light into the range of a display, [`image`] holds and stores pictures (PNG in
//! sRGB, OpenEXR in linear light). Nothing here panics on the coordinates it is given; non-finite ones are not drawn.
#![forbid(unsafe_code)]

pub mod circle;
pub mod clip;
pub mod color;
pub mod ellipse;
pub mod image;
pub mod line;
pub mod polygon;
pub mod stroke;
pub mod target;
pub mod tonemap;
pub mod triangle;

pub use color::Rgb;
pub use image::Image;
