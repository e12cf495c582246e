//! Pictures that show each technique of scan conversion, sampling and mapping at work.
//!
//! Every [`Exhibit`] draws what a textbook shows about a technique and states its figures beside it: pictures, charts
//! and tables. `hemicube gallery` lists them and writes their files.
//!
//! # Current state
//! Exhibits on measured data ask for files ([`Exhibit::needs`]); all others need nothing.
#![forbid(unsafe_code)]

mod exhibit;
mod scan_conversion;

pub use exhibit::{Exhibit, GalleryError, Piece, Request};

/// All exhibits, in the order in which a course would show them.
pub fn exhibits() -> impl Iterator<Item = &'static Exhibit> {
    ROOMS.iter().copied().flatten()
}

/// The exhibits of each module.
const ROOMS: &[&[Exhibit]] = &[scan_conversion::EXHIBITS];
