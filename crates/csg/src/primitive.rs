//! The solids that are given by equations, each in a place of its own; everything else is made of them.
//!
//! | solid | its points |
//! |---|---|
//! | sphere | `x² + y² + z² <= 1` |
//! | cuboid | `|x|, |y|, |z| <= 1` |
//! | frustum | `x² + z² <= (1 - taper y)²`, `0 <= y <= 1`: a cylinder with taper 0, a cone with taper 1 |
//! | torus | `(sqrt(x² + z²) - 1)² + y² <= tube²` |
//! | half-space | `y <= 0` |

mod cuboid;
mod frustum;
mod half_space;
mod sphere;
mod torus;

use crate::bounds::Bounds;
use glam::DVec3;

/// A solid at its own place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Primitive {
    Sphere,
    Cuboid,
    /// From radius 1 at y = 0 to radius `1 - taper` at y = 1.
    Frustum {
        taper: f64,
    },
    /// A ring of radius 1 around the y axis; a `tube` above 1 meets itself, and the solid is what its outer surface
    /// encloses: an apple.
    Torus {
        tube: f64,
    },
    HalfSpace,
}

/// A line in the place of a primitive, with the point nearest to the primitive's origin as its own: the origin is
/// orthogonal to the direction, which has length 1. No digits are lost to the distance of the eye that way; see Haines
/// et al., *Precision improvements for ray/sphere intersection* (Ray Tracing Gems, 2019).
#[derive(Debug, Clone, Copy)]
pub(crate) struct CentredLine {
    pub origin: DVec3,
    pub direction: DVec3,
}

impl CentredLine {
    pub(crate) fn at(&self, t: f64) -> DVec3 {
        self.origin + self.direction * t
    }
}

/// The ends of at most two spans.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Ends {
    t: [f64; 4],
    len: usize,
}

impl Ends {
    const NONE: Self = Self {
        t: [0.0; 4],
        len: 0,
    };

    /// One span, none if it has no length or a number is NaN.
    fn span(enter: f64, leave: f64) -> Self {
        if enter < leave {
            Self {
                t: [enter, leave, 0.0, 0.0],
                len: 2,
            }
        } else {
            Self::NONE
        }
    }

    pub(crate) fn as_slice(&self) -> &[f64] {
        &self.t[..self.len]
    }

    fn push(&mut self, t: f64) {
        self.t[self.len] = t;
        self.len += 1;
    }
}

impl Primitive {
    /// Where a line is inside.
    pub(crate) fn ends(&self, line: &CentredLine) -> Ends {
        match *self {
            Self::Sphere => sphere::ends(line),
            Self::Cuboid => cuboid::ends(line),
            Self::Frustum { taper } => frustum::ends(taper, line),
            Self::Torus { tube } => torus::ends(tube, line),
            Self::HalfSpace => half_space::ends(line),
        }
    }

    /// The normal at a point of the surface, outwards, of any length.
    pub(crate) fn normal(&self, p: DVec3) -> DVec3 {
        match *self {
            Self::Sphere => p,
            Self::Cuboid => cuboid::normal(p),
            Self::Frustum { taper } => frustum::normal(taper, p),
            Self::Torus { .. } => torus::normal(p),
            Self::HalfSpace => DVec3::Y,
        }
    }

    /// Whether a point lies inside.
    pub(crate) fn contains(&self, p: DVec3) -> bool {
        match *self {
            Self::Sphere => p.length_squared() <= 1.0,
            Self::Cuboid => p.abs().max_element() <= 1.0,
            Self::Frustum { taper } => frustum::contains(taper, p),
            Self::Torus { tube } => torus::contains(tube, p),
            Self::HalfSpace => p.y <= 0.0,
        }
    }

    /// A box around it.
    pub(crate) fn bounds(&self) -> Bounds {
        let around = |reach: DVec3| Bounds {
            low: -reach,
            high: reach,
        };
        match *self {
            Self::Sphere | Self::Cuboid => around(DVec3::ONE),
            Self::Frustum { .. } => Bounds {
                low: DVec3::new(-1.0, 0.0, -1.0),
                high: DVec3::ONE,
            },
            Self::Torus { tube } => around(DVec3::new(1.0 + tube, tube, 1.0 + tube)),
            Self::HalfSpace => Bounds::EVERYTHING,
        }
    }
}
