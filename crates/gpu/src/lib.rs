//! Radiosity on the GPU through wgpu.
//!
//! [`Context`] is a device, with a window or without, [`adapters`] lists what this machine has. [`GpuHemicube`] is the twin of
//! [`Hemicube`](hemicube_radiosity::form_factor::hemicube::Hemicube): the same hemicubes, drawn and summed on the device.
//!
//! [`GpuRayCast`] casts rays in compute shaders, [`GpuShooting`] keeps all of the light on the device while it shoots, and
//! [`Gpu`] is all of that as the backend of any solver.
//! [`pass`] draws pictures of solutions: lit surfaces with textures, bumps, mirrors, antialiasing and tones, from light that
//! may stay on the device.
//!
//! # Memory and limits
//! A million elements take about 230 MiB; [`hemicube_shaders::memory`] computes it, `hemicube info` prints it. No binding may
//! be larger than the adapter says. At 128 MiB, the least that WebGPU promises:
//!
//! | what | bytes | largest |
//! |---|---|---|
//! | receivers; what shooting knows of elements | 32 an element | 4,194,304 elements |
//! | corners; vertices in a hemicube's frame | 16 | 8,388,608 elements, vertices |
//! | lists of what faces show | 20 an element | 6,710,886 elements |
//! | sums | 4 an element, 12 with panes | 33 million, 11 million elements |
//! | light | 24 an element and group of luminaires | 5,592,405 elements; 1,118,481 in five groups |
//! | where hemicubes stand | 32 a hemicube | 4,194,304 hemicubes, 16 on each of 262,144 patches |
//! | rays: triangles, where a shader walks a tree | 96 a quad | 1,398,101 quads |
//! | cells behind panes | 48 resolution² | resolution 1672 |
//!
//! A mesh has 4,000,000 elements at most. Pictures are two resolutions wide, so a resolution of 4096 asks for 8192 pixels a
//! side. A submission holds as many hemicubes as fit, up to 16 (shooting: one after the other, 32 in a submission);
//! what does not fit one by one is refused with both numbers, and the CPU takes it.
//!
//! # Current state
//! Nothing here panics because of a device: what it cannot do is a [`GpuError`], and the CPU goes on when it is lost. What
//! a solver that keeps its light on the device had not yet brought to the CPU is then lost, too. Several threads may work on
//! one device: a window draws from a solver's light ([`GpuShooting::light`]) while that goes on, and waits behind two of its
//! steps at most ([`GpuShooting::with_step_time`]). Where panes let light through, the CPU casts the rays.
//!
//! Mesa's lavapipe 22.3.6 loses some 200 KB of memory with every hemicube, which it gives back when the device is closed; 25.0.7 loses
//! none.
//!
//! Rays are cast by the adapter's ray queries where it has circuits for them, else by a tree that a shader walks;
//! [`RayQueries`] and the environment variable `HEMICUBE_RAY_QUERIES` choose otherwise. wgpu 30 calls ray queries an
//! experiment, which has to be asked for in unsafe code: one function here does, and nothing else is unsafe. Mesa's lavapipe
//! has them from 24.1 on, in software. They were not seen on a card.
#![deny(unsafe_code)]

mod backend;
mod buffer;
mod context;
mod error;
mod hemicube;
pub mod pass;
mod ray_queries;
mod raycast;
mod shooting;

pub use backend::Gpu;
pub use context::{ADAPTER_VARIABLE, AdapterReport, Context, ContextOptions, adapters};
pub use error::GpuError;
pub use hemicube::{DrawCounts, GpuHemicube, ShotCounts, StageSeconds};
pub use ray_queries::{RAY_QUERY_VARIABLE, RayQueries};
pub use raycast::GpuRayCast;
pub use shooting::{ChannelFlux, DeviceLight, GpuShooting};
