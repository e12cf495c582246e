//! A radiosity system: a scene goes in, light you can trust comes out; view-independent, in physical units.
//!
//! ```
//! use hemicube::radiosity::{GatherOptions, Gatherer, Quality, solve};
//! use hemicube::scene;
//! use glam::Vec3;
//! use std::sync::Arc;
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! // A file (.glb, .gltf, .obj, .stl, .vs3) or the name of a built-in scene.
//! let scene = scene::open("cornell")?;
//! let units = scene.units;
//! // Asked before every step; `false` ends the work with the light so far.
//! let solution = solve(Arc::new(scene), &Quality::Draft.into(), |progress, _| progress.iteration < 10_000)?;
//!
//! let gatherer = Gatherer::new(&solution, GatherOptions::default());
//! let floor = gatherer.irradiance(Vec3::new(265.0, 0.0, 263.0), Vec3::Y);
//! println!("{floor:?} W/m², {:.0} lx", units.illuminance(floor));
//! # assert!((floor.r - 0.95).abs() < 0.08, "the reference is 0.956 W/m²: {floor:?}");
//! # Ok(())
//! # }
//! ```
//!
//! | module | what it holds |
//! |---|---|
//! | [`csg`] | solids combined by set operations, and a ray tracer that shows them |
//! | [`raster`] | images, linear colour, triangles with a z-buffer, tone mapping; knows no scene |
//! | [`scene`] | glTF, OBJ, STL and View3D import, materials, lights, cameras, built-in scenes |
//! | [`radiosity`] | patches, form factors, solvers, solutions, lit `.glb` files |
//! | [`render`] | pictures of solutions |
//! | `gpu` | hemicubes, rays, shooting and pictures on a GPU; only with the feature `gpu` |
//! | [`shaders`] | their WGSL, and what a scene takes of a GPU's memory |
//!
//! # Current state
//! Surfaces are diffuse; panes let light straight through. The front page of each crate says what it does not do yet.
//! Nothing panics on what files hold.
#![forbid(unsafe_code)]

pub use hemicube_csg as csg;
#[cfg(feature = "gpu")]
pub use hemicube_gpu as gpu;
pub use hemicube_radiosity as radiosity;
pub use hemicube_raster as raster;
pub use hemicube_render as render;
pub use hemicube_scene as scene;
pub use hemicube_shaders as shaders;
