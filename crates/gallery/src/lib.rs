//! Pictures that show each technique of scan conversion, sampling and mapping at work.
//!
//! Every [`Exhibit`] draws what a textbook shows about a technique and states its figures beside it: pictures, charts
//! and tables. `hemicube gallery` lists them and writes their files.
//!
//! # Current state
//! Exhibits on measured data ask for files ([`Exhibit::needs`]); all others need nothing.
#![forbid(unsafe_code)]

mod adaptive;
mod antialiasing;
mod bumps;
mod csg;
mod discontinuity;
mod environments;
mod exhibit;
mod field;
mod scan_conversion;
mod sheet;
mod stage;
mod textures;
mod two_part;

pub use exhibit::{Exhibit, GalleryError, Piece, Request};

/// All exhibits, in the order in which a course would show them.
pub fn exhibits() -> impl Iterator<Item = &'static Exhibit> {
    ROOMS.iter().copied().flatten()
}

/// The exhibits of each module.
const ROOMS: &[&[Exhibit]] = &[
    scan_conversion::EXHIBITS,
    antialiasing::EXHIBITS,
    csg::EXHIBITS,
    textures::EXHIBITS,
    field::EXHIBITS,
    two_part::EXHIBITS,
    bumps::EXHIBITS,
    environments::EXHIBITS,
    adaptive::EXHIBITS,
    discontinuity::EXHIBITS,
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_told_apart() {
        let names: Vec<&str> = exhibits().map(|e| e.name).collect();
        for (i, name) in names.iter().enumerate() {
            assert!(!names[..i].contains(name), "{name} twice");
        }
    }
}
