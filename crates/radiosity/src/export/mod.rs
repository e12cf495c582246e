//! Solutions in files that other programs open.

pub mod lit_glb;
