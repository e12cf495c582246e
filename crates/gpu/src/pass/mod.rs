//! Pictures of solutions on the device.
//!
//! A [`Walkthrough`] holds a lit scene and draws it from any camera into any [`Target`], as [`DrawOptions`] say. Light is
//! drawn in floats of 16 bits, exposed before it is stored, and goes through the tone curve sample by sample, as on the CPU.
//! Each file is a pass or what passes share; a pass makes its pipelines once, at their first use.

mod antialias;
mod bump;
mod cube;
mod draw;
mod environment;
mod falsecolour;
mod geometry;
mod layers;
mod light;
mod lit;
mod map;
mod material;
mod options;
mod overlay;
mod passes;
mod pick;
mod pipeline;
mod readback;
mod reflections;
mod surfaces;
mod surroundings;
mod target;
mod textured;
mod textures;
mod tonemap;
mod view;
mod walkthrough;

pub use environment::Lookup;
pub use options::{DrawOptions, Interpolation, Smoothing, Style};
pub use overlay::MeshLines;
pub use target::Target;
pub use textured::TextureFiltering;
pub use walkthrough::Walkthrough;
