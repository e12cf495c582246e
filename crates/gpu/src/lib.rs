//! Radiosity on the GPU through wgpu.
//!
//! [`Context`] is a device without a window, [`adapters`] lists what this machine has. [`GpuHemicube`] is the twin of
//! [`Hemicube`](hemicube_radiosity::form_factor::hemicube::Hemicube): the same hemicubes, drawn and summed on the device.
//!
//! # Current state
//! Nothing here panics because of a device: what it cannot do is a [`GpuError`], and form
//! factors go on with the CPU when it is lost.
#![forbid(unsafe_code)]

mod backend;
mod buffer;
mod context;
mod error;
mod hemicube;
pub mod pass;
mod raycast;
mod shooting;

pub use backend::Gpu;
pub use context::{ADAPTER_VARIABLE, AdapterReport, Context, adapters};
pub use error::GpuError;
pub use hemicube::{DrawCounts, GpuHemicube, ShotCounts, StageSeconds};
pub use raycast::GpuRayCast;
pub use shooting::GpuShooting;
