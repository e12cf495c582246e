//! Round bodies as facets: planar quads and triangles with their corners on the body, so that the facets are inside of
//! what bulges and every error falls with the square of their size.

use core::f64::consts::{PI, TAU};
use glam::DVec3;

/// Corners of a facet, counter-clockwise seen from the side that radiates.
pub type Facet = Vec<DVec3>;

/// Which side of a body radiates.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Radiates {
    /// Away from the centre or axis.
    Outwards,
    /// Towards it.
    Inwards,
}

/// A band of a sphere around +z, in `rings` times `sectors` facets; angles from the axis in radians, `0.0..PI` for all.
pub fn sphere(
    centre: DVec3,
    radius: f64,
    angles: core::ops::Range<f64>,
    rings: u32,
    sectors: u32,
    side: Radiates,
) -> Vec<Facet> {
    let at = |ring: u32, sector: u32| {
        let from_axis =
            angles.start + (angles.end - angles.start) * f64::from(ring) / f64::from(rings);
        let (sine, height) = if from_axis == 0.0 || from_axis == PI {
            (0.0, from_axis.cos())
        } else {
            from_axis.sin_cos()
        };
        let around = TAU * f64::from(sector % sectors) / f64::from(sectors);
        centre + radius * DVec3::new(sine * around.cos(), sine * around.sin(), height)
    };
    grid(rings, sectors, side, at)
}

/// The lateral surface of a cylinder from `base` to `base + axis`.
pub fn cylinder(
    base: DVec3,
    axis: DVec3,
    radius: f64,
    rings: u32,
    sectors: u32,
    side: Radiates,
) -> Vec<Facet> {
    let (x, y) = axis.normalize().any_orthonormal_pair();
    let at = |ring: u32, sector: u32| {
        let around = TAU * f64::from(sector % sectors) / f64::from(sectors);
        // From its far end on, so that rings run downwards as those of a sphere do.
        let up = 1.0 - f64::from(ring) / f64::from(rings);
        base + up * axis + radius * (around.cos() * x + around.sin() * y)
    };
    grid(rings, sectors, side, at)
}

/// A disk as a regular polygon of the same *area*, cut into triangles; it radiates to the side of its normal.
pub fn disk(centre: DVec3, normal: DVec3, radius: f64, corners: u32) -> Vec<Facet> {
    let outline = regular_polygon(centre, normal, radius, corners);
    let next = |i: usize| outline[(i + 1) % outline.len()];
    (0..outline.len())
        .map(|i| vec![centre, outline[i], next(i)])
        .collect()
}

/// The outline of [`disk`].
pub fn regular_polygon(centre: DVec3, normal: DVec3, radius: f64, corners: u32) -> Facet {
    let (x, y) = normal.normalize().any_orthonormal_pair();
    let step = TAU / f64::from(corners);
    let radius = radius * (step / step.sin()).sqrt();
    (0..corners)
        .map(|i| {
            let (sine, cosine) = (step * f64::from(i)).sin_cos();
            centre + radius * (cosine * x + sine * y)
        })
        .collect()
}

/// Facets between rings (downwards) and sectors (counter-clockwise from above); those at a pole are triangles.
fn grid(rings: u32, sectors: u32, side: Radiates, at: impl Fn(u32, u32) -> DVec3) -> Vec<Facet> {
    let mut facets = Vec::new();
    for ring in 0..rings {
        for sector in 0..sectors {
            let mut facet = vec![
                at(ring, sector),
                at(ring + 1, sector),
                at(ring + 1, sector + 1),
                at(ring, sector + 1),
            ];
            facet.dedup();
            if facet.first() == facet.last() {
                facet.pop();
            }
            if side == Radiates::Inwards {
                facet.reverse();
            }
            facets.push(facet);
        }
    }
    facets
}
