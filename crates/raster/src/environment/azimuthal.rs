//! Projections around an axis onto a disc: the angle to the axis decides on the distance from the middle.
//!
//! With `θ` from 0 to the projection's widest angle, `r` from 0 to 1:
//!
//! | projection | r | middle | widest |
//! |---|---|---|---|
//! | sphere map: photograph of a mirror ball from afar, `GL_SPHERE_MAP` | sin(θ/2) | +z, behind | 180° |
//! | angular map: light probe (Debevec 1998) | θ/π | -z, ahead | 180° |
//! | paraboloid, one half of two (Heidrich and Seidel 1998) | tan(θ/2) | -z; +z | 90° |
//! | fisheye: equidistant lens, Radiance `-vta` of 180° | 2θ/π | -z | 90° |
//! | hemispherical: orthographic lens, Nusselt's analog, Radiance `-vth` | sin θ | -z | 90° |
//!
//! All are formulated over `z = cos θ`, without an angle where none is needed.

use super::solid_angle::{Disc, of_rectangle_in_disc};
use crate::sinc::{sinc, sinc32};
use core::f32::consts::PI;
use glam::{Vec2, Vec3};

/// Which of the projections.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Sphere,
    Angular,
    Paraboloid,
    Fisheye,
    Hemispherical,
}

impl Kind {
    /// Signs of the disc's right and of its middle: x to the right, z of the axis.
    fn frame(self, face: usize) -> (f32, f32) {
        match (self, face) {
            // A mirror: what is at the right is seen at the right, though behind.
            (Self::Sphere, _) => (1.0, 1.0),
            (Self::Paraboloid, 1) => (-1.0, 1.0),
            _ => (1.0, -1.0),
        }
    }

    /// Whether one disc shows the whole sphere.
    pub fn is_whole(self) -> bool {
        matches!(self, Self::Sphere | Self::Angular)
    }

    /// Face and texture coordinates of a direction of unit length; `None` beyond the widest angle.
    pub fn coordinates(self, d: Vec3) -> Option<(usize, Vec2)> {
        let face = usize::from(self == Self::Paraboloid && d.z > 0.0);
        let (right, axis) = self.frame(face);
        let z = d.z * axis;
        if !self.is_whole() && z < 0.0 {
            return None;
        }
        let rho = d.x.hypot(d.y);
        let p = if rho < 1e-12 && z < 0.0 {
            // The whole rim is one direction; any of its points will do.
            Vec2::X
        } else {
            self.stretch(z, rho) * Vec2::new(right * d.x, -d.y)
        };
        Some((face, ((p + 1.0) / 2.0).clamp(Vec2::ZERO, Vec2::ONE)))
    }

    /// `r / sin θ`; `rho` is `sin θ`. Towards a singular point, where it is infinite, it stops where `r` is 1.
    fn stretch(self, z: f32, rho: f32) -> f32 {
        let angle = || rho.atan2(z) / rho.max(1e-12);
        match self {
            // sin(θ/2) / sin θ = 1 / (2 cos(θ/2)); behind, 1 + z loses its digits, and rho² / (1 - z) is the same.
            Self::Sphere if z < 0.0 => ((1.0 - z) / 2.0).sqrt() / rho.max(1e-12),
            Self::Sphere => (2.0 * (1.0 + z)).sqrt().recip(),
            Self::Angular if rho < 1e-6 && z > 0.0 => 1.0 / PI,
            Self::Angular => angle() / PI,
            Self::Paraboloid => 1.0 / (1.0 + z),
            Self::Fisheye if rho < 1e-6 => 2.0 / PI,
            Self::Fisheye => angle() * 2.0 / PI,
            Self::Hemispherical => 1.0,
        }
    }

    /// Derivative of [`Self::stretch`] by z.
    fn stretch_by_z(self, z: f32, rho: f32) -> f32 {
        let of_angle = || {
            let theta = rho.atan2(z);
            if rho < 1e-2 && z > 0.0 {
                return -1.0 / 3.0 - 2.0 / 15.0 * rho * rho;
            }
            -(rho - theta * z) / rho.max(1e-6).powi(3)
        };
        match self {
            Self::Sphere => -(2.0 * (1.0 + z)).max(1e-9).powf(-1.5),
            Self::Angular => of_angle() / PI,
            Self::Paraboloid => -(1.0 + z).powi(-2),
            Self::Fisheye => of_angle() * 2.0 / PI,
            Self::Hemispherical => 0.0,
        }
    }

    /// Gradients of s and t by a direction of unit length.
    pub fn gradient(self, d: Vec3) -> [Vec3; 2] {
        let face = usize::from(self == Self::Paraboloid && d.z > 0.0);
        let (right, axis) = self.frame(face);
        let z = d.z * axis;
        let rho = d.x.hypot(d.y);
        let (q, dq) = (self.stretch(z, rho), self.stretch_by_z(z, rho));
        let by_z = Vec3::new(0.0, 0.0, axis * dq);
        let of = |plane: Vec3| (q * plane + d.dot(plane) * by_z) / 2.0;
        [of(right * Vec3::X), of(Vec3::NEG_Y)]
    }

    /// Direction of a point, of unit length; points outside the disc mean that of the rim, or go on over it on a
    /// paraboloid, whose rim is not the end of its formula.
    pub fn direction(self, face: usize, at: Vec2) -> Vec3 {
        let (right, axis) = self.frame(face);
        let mut p = 2.0 * at - 1.0;
        if self != Self::Paraboloid {
            p = p.clamp_length_max(1.0);
        }
        let square = p.length_squared();
        let r = square.sqrt();
        // sin θ / r and cos θ
        let (shrink, z) = match self {
            Self::Sphere => (2.0 * (1.0 - square).max(0.0).sqrt(), 1.0 - 2.0 * square),
            Self::Angular => (PI * sinc32(PI * r), (PI * r).cos()),
            Self::Paraboloid => (2.0 / (1.0 + square), (1.0 - square) / (1.0 + square)),
            Self::Fisheye => (PI / 2.0 * sinc32(PI / 2.0 * r), (PI / 2.0 * r).cos()),
            Self::Hemispherical => (1.0, (1.0 - square).max(0.0).sqrt()),
        };
        Vec3::new(right * shrink * p.x, -shrink * p.y, axis * z).normalize()
    }

    /// Solid angle by area of texture coordinates, in the disc.
    pub fn density(self, at: Vec2) -> f32 {
        let square = (2.0 * at - 1.0).length_squared().min(1.0);
        let r = square.sqrt();
        4.0 * match self {
            Self::Sphere => 4.0,
            Self::Angular => PI * PI * sinc32(PI * r),
            Self::Paraboloid => 4.0 / (1.0 + square).powi(2),
            Self::Fisheye => (PI / 2.0).powi(2) * sinc32(PI / 2.0 * r),
            Self::Hemispherical => (1.0 - square).max(1e-6).sqrt().recip(),
        }
    }

    /// Solid angle of a rectangle of texture coordinates.
    pub fn solid_angle(self, s: [f64; 2], t: [f64; 2]) -> f64 {
        let scaled = |[a, b]: [f64; 2]| [2.0 * a - 1.0, 2.0 * b - 1.0];
        of_rectangle_in_disc(&self, scaled(s), scaled(t))
    }
}

impl Disc for Kind {
    fn cap_by_square(&self, r: f64) -> f64 {
        use core::f64::consts::PI;
        match self {
            Self::Sphere => 2.0,
            Self::Angular => PI * PI / 2.0 * sinc(PI / 2.0 * r).powi(2),
            Self::Paraboloid => 2.0 / (1.0 + r * r),
            Self::Fisheye => PI * PI / 8.0 * sinc(PI / 4.0 * r).powi(2),
            Self::Hemispherical => 1.0 / (1.0 + (1.0 - r * r).max(0.0).sqrt()),
        }
    }
}

/// Whether the middle of a texel lies in the disc.
pub(super) fn is_inside(n: [usize; 2], x: isize, y: isize) -> bool {
    middle(n, x, y).length_squared() <= 1.0
}

/// Middle of a texel, with the disc as unit circle.
fn middle([width, height]: [usize; 2], x: isize, y: isize) -> Vec2 {
    let of = |i: isize, n: usize| (2 * i + 1 - n.cast_signed()) as f32 / n as f32;
    Vec2::new(of(x, width), of(y, height))
}

/// Texture coordinates of the middle of a texel, inside the picture or not.
pub(super) fn place(n: [usize; 2], x: isize, y: isize) -> Vec2 {
    (middle(n, x, y) + 1.0) / 2.0
}

/// The texel inside the disc that is next to one outside it, towards the middle.
pub(super) fn inwards(n: [usize; 2], x: isize, y: isize) -> (usize, usize) {
    let p = middle(n, x, y);
    // So far inside that the texel around the point has its middle in the disc.
    let [width, height] = n.map(|n| n as f32);
    let reach = (1.0 - 1.42 / width.min(height)).max(0.0);
    let p = p * (reach / p.length().max(1e-12)).min(1.0);
    nearest(n, (p + 1.0) / 2.0)
}

/// The texel around a point.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "clamped to the texels"
)]
pub(super) fn nearest([width, height]: [usize; 2], at: Vec2) -> (usize, usize) {
    let of = |x: f32, n: usize| (x * n as f32).clamp(0.0, (n - 1) as f32) as usize;
    (of(at.x, width), of(at.y, height))
}
