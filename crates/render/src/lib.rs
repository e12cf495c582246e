//! Pictures of radiosity solutions on the CPU.
//!
//! [`render`] gives linear radiance for each pixel, in the scene's units (cd/m² or W/(m² sr)): what an OpenEXR file
//! should hold. [`render_display`] gives what a display shows: every sample goes through exposure and tone curve before
//! samples are averaged, so the edges of lamps are smooth. [`Renderer`] makes both from one preparation and reports its
//! progress. [`choose_camera`] finds a view for scenes that bring none.
//!
//! The same solution, camera and options give the same bits on any number of threads.
//!
//! # Current state
//! Cameras are perspective, orthographic, panoramic (equirectangular) or fisheyes. The first two draw triangles; bent
//! projections and jittered samples cast a ray for each sample, several times slower. Antialiasing is any of
//! [`hemicube_raster::antialias`]; samples beyond the border are real ones. Textures are filtered over the exact footprint of
//! each sample ([`TextureFilter`]), alpha masks by supersampling alone.
//!
//! Surfaces are diffuse: `L = emission + reflectance × H / π`, and what lets light straight through is blended sample by
//! sample in the order of depth, without refraction. Normal and height maps turn normals; interpolated light is tilted by
//! what is gathered around each vertex when it is first seen, up to some seconds for a model with bumps everywhere.
//! [`Reflections`] add environment mapping: mirrors show one blurred map per object, neither themselves nor other mirrors,
//! and planes are mirrored as if seen from their middle. [`Renderer::with_surroundings`] shows a picture behind everything,
//! which lights nothing. [`RenderOptions::mesh`] draws edges of elements or patches over pictures for displays, not over what
//! mirrors show. Lights without an area are not drawn, nor mirrored. A one-sided surface seen from behind is left
//! out, also where it is glass. Clear coat and occlusion maps are not read.
#![forbid(unsafe_code)]

mod auto_camera;
mod band;
mod behind;
mod bins;
mod capture;
mod draw;
mod error;
mod exterior_view;
mod filtering;
mod footprint;
mod grid;
mod interior_view;
mod lens;
mod mesh_lines;
mod options;
mod projection;
mod reflections;
mod relief;
mod renderer;
mod shade;
mod sight;
mod split_sum;
mod stage;
mod surface;
mod tangents;
mod tilt;
mod trace;

pub use auto_camera::choose_camera;
pub use capture::{MirrorPlan, MirrorSite, face_camera};
pub use error::RenderError;
pub use options::{MeshOverlay, ParseShadingError, RenderOptions, Shading, TextureFilter};
pub use projection::{check_camera, clip_from_world};
pub use reflections::Reflections;
pub use renderer::{Renderer, render, render_display, tone_mapped};
pub use split_sum::split_sum_table;
pub use tangents::{TangentFrame, Tangents};
pub use tilt::{TiltFit, tilt_fits};
