//! A radiosity system: a scene goes in, light you can trust comes out.
#![forbid(unsafe_code)]

pub use hemicube_radiosity as radiosity;
pub use hemicube_raster as raster;
pub use hemicube_render as render;
pub use hemicube_scene as scene;
