//! Solutions and view factors in files that other programs open.

pub mod lit_glb;
pub mod view_factors;
