//! The walkthrough viewer: a window in which light arrives.
//!
//! [`view`] opens it. A thread of its own solves ([`session`]); the window shows the newest light from wherever one
//! stands ([`walk`]), reads it off surfaces ([`measure`]), changes lamps and paints while it is solved, and dims groups of
//! lamps without solving at all ([`session::Mixer`]). Everything but [`panels`], [`draw`] and [`app`] knows no window
//! and is tested without one.
//!
//! ```no_run
//! use hemicube_viewer::{ViewOptions, view};
//!
//! view(ViewOptions { scene: String::from("cornell"), ..ViewOptions::default() })?;
//! # Ok::<(), hemicube_viewer::ViewError>(())
//! ```
//!
//! # Current state
//! Runs on X11 and Wayland with any adapter of wgpu. Where the processor draws (lavapipe), edges are smooth and mirrors new
//! only while light and eye are at rest, light comes ten times a second, and pixels are up to three times as wide while the
//! eye moves and frames are late. Window and solvers share one device: light that sorted shooting keeps there is drawn from
//! its own buffers ([`draw`]) and comes to the CPU when the solver rests, when a file or a grid wants it, and before an edit;
//! until then the error against the finished light is not known. If the device is lost, the CPU goes on from the light that
//! came last. A refined mesh ([`session::Refinement`]) is shown when all of it is there; its light is found by the
//! processor, also where the solver's device had found it before, and can be cancelled. It gets no coarser until one restarts.
//! The first picture of a kind (false colours, wireframe) makes its pipelines while the window waits. The window lets
//! the solver's threads wait on Linux only. Bumps are lit as if by a uniform sky. Lights without an area and the sky are one source and cannot be edited. An edit
//! copies scene and mesh, which is felt from a million elements on. Gathering starts again after an edit. Reading a file
//! cannot be interrupted; it is dropped when it is done. Screen readers are not served.
#![forbid(unsafe_code)]

pub mod app;
pub mod desk;
pub mod display;
pub mod document;
pub mod draw;
pub mod film_job;
pub mod format;
pub mod frames;
pub mod light;
pub mod measure;
pub mod panels;
pub mod panes;
pub mod prefs;
pub mod run;
pub mod session;
pub mod theme;
pub mod trial;
pub mod walk;

pub use app::{ViewOptions, Viewer};
pub use run::{ViewError, view};
