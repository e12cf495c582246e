//! Bump mapping: normals that tilt as if the surface had relief.
//!
//! [`tangents`] finds the directions in which a texture runs over a mesh.

pub mod tangents;
