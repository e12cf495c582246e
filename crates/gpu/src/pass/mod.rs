//! Pictures of solutions on the device.
//!
//! A [`Walkthrough`] holds a lit scene and draws it from any camera into any [`Target`], as [`DrawOptions`] say. Its light
//! can be replaced before every picture, by that of a solution or by what [`GpuShooting`](crate::GpuShooting) keeps on the
//! device. Light is drawn in floats of 16 bits, exposed before it is stored, and goes through the tone curve sample by
//! sample, as on the CPU. Each file is a pass or what passes share; a pass makes its pipelines once, at their first use.
//!
//! ```
//! use hemicube_gpu::Context;
//! use hemicube_gpu::pass::{DrawOptions, Walkthrough};
//! use hemicube_radiosity::{SolveOptions, stop::NEVER, unlit};
//! use std::sync::Arc;
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let scene = Arc::new(hemicube_scene::open("cornell")?);
//! let solution = unlit(scene, &SolveOptions::default(), NEVER)?;
//! let Ok(context) = Context::headless(None) else {
//!     return Ok(()); // This machine has no adapter.
//! };
//! let mut walkthrough = Walkthrough::new(Arc::new(context), &solution)?;
//! let camera = &solution.mesh().scene().cameras[0];
//! let picture = walkthrough.display(camera, [64, 64], &DrawOptions::default())?;
//! assert!(picture.pixel(32, 8).g > 0.9, "the lamp");
//! # Ok(())
//! # }
//! ```
//!
//! # How near pictures are to those of the CPU
//! Mean of absolute differences over the mean, on Mesa's lavapipe, as the tests of this crate measure it:
//!
//! | pass | twin | difference | why |
//! |---|---|---|---|
//! | light, flat and between vertices | `radiosity::drawn`, `render` | 4e-4 | 11 binary digits; pixels on edges |
//! | tones | `raster::tonemap` | 5e-4 to 7e-4 | the same, where curves are steep |
//! | filters of fine grids | `raster::antialias` | below 2e-3 | samples on edges |
//! | textures: point, bilinear, trilinear | `raster::texture` | 2e-3, 2e-3, 3e-3 | derivatives are differences between neighbours; drivers decode sRGB and weigh texels in 8 bits |
//! | EWA, bicubic | `raster::texture` | below 6e-3, 4e-3 | the same |
//! | normal maps, heights | `raster::bump`, `render` | below 5e-3 | the same |
//! | maps of all projections | `raster::environment` | below 2e-3 | 16 bits |
//! | mirrors | `render` | 0.01; rough ones 0.02 | fewer levels of roughness, samples of 16 bits |
//!
//! # Current state
//! Cameras are perspective or orthographic. What lets light through is sorted by the middles of triangles: where panes cut
//! each other their order may be wrong. Multisampling smooths edges of triangles, not those of alpha masks. Single samples
//! that fall between surfaces are not mended, as the CPU does. Pictures that come to the CPU may be larger than a texture:
//! they are drawn in tiles, which differ from one picture in 2 of 210,000 pixels; a [`Target`] is drawn at once. Bumps are lit as if by a uniform sky until
//! [`Walkthrough::gather_reliefs`] has been called, which works on the CPU. Radiance above 65,504 times what the exposure
//! makes 1 is cut. A mesh that changes its elements needs a new walkthrough; [`Walkthrough::another`] keeps the pipelines.

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
mod metering;
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
mod tile;
mod tonemap;
mod variant;
mod view;
mod walkthrough;

pub use environment::Lookup;
pub use metering::{Meter, Metering};
pub use options::{DrawOptions, Interpolation, Smoothing, Style};
pub use overlay::MeshLines;
pub use target::Target;
pub use textured::TextureFiltering;
pub use walkthrough::Walkthrough;
