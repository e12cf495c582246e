//! Surface gradients: one kind of vector that every source of bumps can be turned into.
//!
//! Mikkelsen, *Surface gradient-based bump mapping framework* (JCGT 9(4), 2020), after his *Bump mapping unparametrized
//! surfaces on the GPU* (2010). Gradients of several bumps add, and scale with a bump's strength, however each is
//! parametrised.

use core::ops::{Add, AddAssign, Mul, Neg};
use glam::{DVec3, Vec2, Vec3};

/// The gradient of a height over a surface: along the surface, in the direction in which the height grows; its length is
/// the height's growth per length.
///
/// The height is positive on the side that the normal points to. Where a gradient is not defined (derivatives parallel,
/// a normal of length 0, a number that is not finite) it is zero, which bumps nothing.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct SurfaceGradient(Vec3);

impl SurfaceGradient {
    /// No bump.
    pub const ZERO: Self = Self(Vec3::ZERO);

    /// A vector that is a gradient as it stands; its part along the normal is not taken away.
    pub fn new(gradient: Vec3) -> Self {
        if gradient.is_finite() {
            Self(gradient)
        } else {
            Self::ZERO
        }
    }

    /// As a vector.
    pub fn to_vec3(self) -> Vec3 {
        self.0
    }

    /// From a height that is a function of space, by its gradient there: `g - (n.g) n`.
    pub fn from_volume(normal: Vec3, gradient: Vec3) -> Self {
        Self::new(gradient - normal * normal.dot(gradient))
    }

    /// From the places's and the height's derivatives by any two parameters: texture coordinates (`Pu`, `Pv`), or a
    /// pixel's column and row.
    ///
    /// With `R1 = Pv x n`, `R2 = n x Pu` and `d = Pu . R1` it is `(hu R1 + hv R2) / d`, whichever way round `Pu` and `Pv`
    /// are.
    pub fn from_parameters(normal: Vec3, d_point: [Vec3; 2], d_height: [f32; 2]) -> Self {
        // In f64: derivatives per pixel are small, and products of four of them underflow f32.
        let n = normal.as_dvec3();
        let [pu, pv] = d_point.map(|d| d.as_dvec3());
        let [hu, hv] = d_height.map(f64::from);
        let (r1, r2) = (pv.cross(n), n.cross(pu));
        let determinant = pu.dot(r1);
        // A needle as thin as rounding has no direction across.
        if determinant.abs() <= 1e-7 * pu.length() * pv.length() * n.length() {
            return Self::ZERO;
        }
        let gradient: DVec3 = (r1 * hu + r2 * hv) / determinant;
        Self::new(gradient.as_vec3())
    }

    /// From a height over a texture, by its slopes `(dh/du, dh/dv)` and the derivatives of place and texture coordinate
    /// by a pixel's column and row: no tangents are needed.
    pub fn from_texture(
        normal: Vec3,
        d_point: [Vec3; 2],
        d_texcoord: [Vec2; 2],
        slopes: Vec2,
    ) -> Self {
        let d_height = d_texcoord.map(|d| slopes.dot(d));
        Self::from_parameters(normal, d_point, d_height)
    }

    /// From the normal of a normal map (x right, y up in the texture, z out), with tangent and bitangent as interpolated
    /// over the triangle, not made unit again.
    ///
    /// A normal that leans over by more than 89.55 degrees (its z below 1/128 of x or y) counts as leaning that far.
    pub fn from_tangent_space(m: Vec3, tangent: Vec3, bitangent: Vec3) -> Self {
        let steepest = m.x.abs().max(m.y.abs()) / 128.0;
        let z = m.z.abs().max(steepest);
        if z > 0.0 {
            Self::new((tangent * m.x + bitangent * m.y) * (-1.0 / z))
        } else {
            Self::ZERO
        }
    }

    /// The one that tilts `normal` to `tilted`: `((n.t) n - t) / |n.t|`. Of a normal at right angles or pointing inwards,
    /// which no height makes, the nearest that leans as far as 89.55 degrees.
    pub fn from_normal(normal: Vec3, tilted: Vec3) -> Self {
        let out = normal.dot(tilted);
        let along = tilted - normal * out;
        let z = out.max(along.length() / 128.0);
        if z > 0.0 {
            Self::new(along * (-1.0 / z))
        } else {
            Self::ZERO
        }
    }

    /// From slopes on the three coordinate planes, by the point's own coordinates: `slopes[0]` on the plane with x as its
    /// normal by (z, y), `[1]` with y by (x, z), `[2]` with z by (x, y). Needs no texture coordinates.
    pub fn triplanar(normal: Vec3, slopes: [Vec2; 3]) -> Self {
        let w = triplanar_weights(normal);
        let [on_x, on_y, on_z] = slopes;
        let gradient = Vec3::new(
            w.z * on_z.x + w.y * on_y.x,
            w.z * on_z.y + w.x * on_x.y,
            w.x * on_x.x + w.y * on_y.y,
        );
        Self::from_volume(normal, gradient)
    }

    /// The bumped normal `normalize(n - gradient)`; `normal` itself, unchanged, where there is no bump.
    pub fn apply(self, normal: Vec3) -> Vec3 {
        if self == Self::ZERO {
            return normal;
        }
        (normal - self.0).try_normalize().unwrap_or(normal)
    }
}

impl Add for SurfaceGradient {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self::new(self.0 + other.0)
    }
}

impl AddAssign for SurfaceGradient {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl Mul<f32> for SurfaceGradient {
    type Output = Self;
    fn mul(self, strength: f32) -> Self {
        Self::new(self.0 * strength)
    }
}

impl Neg for SurfaceGradient {
    type Output = Self;
    fn neg(self) -> Self {
        Self(-self.0)
    }
}

/// How much each of the three planes counts for a normal: `max(|n_i| - 0.2, 0)^3` over their sum, so that the planes
/// blend only around 45 degrees. Equal weights for a normal of length 0.
pub fn triplanar_weights(normal: Vec3) -> Vec3 {
    let w = (normal.abs() - 0.2).max(Vec3::ZERO).powf(3.0);
    let sum = w.element_sum();
    if sum > 0.0 && sum.is_finite() {
        w / sum
    } else {
        Vec3::splat(1.0 / 3.0)
    }
}

/// Blinn's bumped normal, from the derivatives of place and height by the texture coordinates.
///
/// With `N = Pu x Pv`, `n` the unit normal on the side to which heights are positive and `s` the sign of `n . N` (-1 where
/// u goes right and v down as seen from outside):
/// `N' = |N| n + s (hu (n x Pv) - hv (n x Pu))`, of length 1.
///
/// It is Blinn's formula with the sign written out, and the same as [`SurfaceGradient::from_parameters`] for a normal at
/// right angles to `Pu` and `Pv`. Terms of the height times the surface's curvature are left out: heights are small
/// against its radius. `n` itself where `Pu` and `Pv` are parallel.
pub fn blinn_normal(normal: Vec3, pu: Vec3, pv: Vec3, d_height: [f32; 2]) -> Vec3 {
    // In f64, where products of tiny or huge derivatives neither vanish nor overflow.
    let [unit, pu, pv] = [normal, pu, pv].map(Vec3::as_dvec3);
    let [hu, hv] = d_height.map(f64::from);
    let n = pu.cross(pv);
    if n == DVec3::ZERO {
        return normal;
    }
    let tilt = unit.cross(pv) * hu - unit.cross(pu) * hv;
    let bumped = unit * n.length() + tilt * unit.dot(n).signum();
    bumped.try_normalize().map_or(normal, |n| n.as_vec3())
}

/// The normal nearest to a bumped one that still faces the viewer: light would else be mirrored into the surface.
///
/// `view` points to the eye. A normal at right angles to it stays; one that can be turned nowhere becomes `view`.
pub fn facing(normal: Vec3, view: Vec3) -> Vec3 {
    let away = normal.dot(view);
    if away >= 0.0 {
        return normal;
    }
    (normal - view * (away / view.length_squared()))
        .try_normalize()
        .unwrap_or(view)
}
