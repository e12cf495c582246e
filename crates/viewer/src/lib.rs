//! The walkthrough viewer: a window in which light arrives.
//!
//! [`view`] opens it. A thread of its own solves ([`session`]); the window shows the newest light from wherever one
//! stands ([`walk`]), reads it off surfaces ([`measure`]), changes lamps and paints while it is solved, and dims groups of
//! lamps without solving at all ([`session::Mixer`]). Everything but [`panels`], [`draw`] and [`app`] knows no window
//! and is tested without one.
//!
//! # Current state
//! Runs on X11 and Wayland with any adapter of wgpu, lavapipe too.
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
pub mod walk;

pub use app::{ViewOptions, Viewer};
pub use run::{ViewError, view};
