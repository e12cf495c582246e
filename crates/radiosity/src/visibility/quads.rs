//! Rays against eight quads at once, without gaps along edges.

use super::ray::Ray;
use glam::Vec3;
use wide::f32x8;

/// Quads that are tested at once.
pub(super) const LANES: usize = 8;

/// Two triangles with a common side: corners 0, 1, 2 and 0, 2, 3. A single triangle repeats its last corner.
///
/// They need not lie in a plane: any two neighbours of a mesh will do, also where they fold back. Four corners instead of six are a third less to
/// load and to transform, and half as many boxes.
#[derive(Debug, Clone, Copy)]
pub(super) struct Quad {
    pub(super) corners: [Vec3; 4],
    /// The faces to which its two triangles belong.
    pub(super) faces: [u32; 2],
}

/// The corners of up to eight quads, `[axis][corner]`.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(64))]
pub(super) struct QuadPack {
    corners: [[f32x8; 4]; 3],
}

/// Where a ray meets the triangles of a pack: the first of each quad, and the second. Where the two are folded, a ray
/// may meet both.
#[derive(Debug, Clone, Copy)]
pub(super) struct Hits([HitsOfTriangles; 2]);

/// Where a ray meets one triangle of each quad.
#[derive(Debug, Clone, Copy)]
struct HitsOfTriangles {
    /// One for each quad whose triangle is met.
    mask: f32x8,
    distance_times_scale: f32x8,
    scale: f32x8,
}

impl Hits {
    /// Whether anything is met.
    #[inline(always)]
    pub(super) fn any(&self) -> bool {
        let [first, second] = &self.0;
        (first.mask | second.mask).any()
    }

    /// One bit for each quad whose first triangle is met, its distances, and the same of the second.
    pub(super) fn by_triangle(&self) -> [(u32, [f32; LANES]); 2] {
        self.0.map(|hits| {
            (
                hits.mask.to_bitmask(),
                (hits.distance_times_scale / hits.scale).to_array(),
            )
        })
    }
}

impl QuadPack {
    /// At most eight quads; lanes without one are never met.
    pub(super) fn new(quads: &[Quad]) -> Self {
        let mut raw = [[[f32::NAN; LANES]; 4]; 3];
        for (lane, quad) in quads.iter().enumerate() {
            for (corner, position) in quad.corners.iter().enumerate() {
                for axis in 0..3 {
                    raw[axis][corner][lane] = position[axis];
                }
            }
        }
        Self {
            corners: raw.map(|corners| corners.map(f32x8::from)),
        }
    }

    /// Which quads the ray meets up to a distance, after Woop, Benthin and Wald 2013, *Watertight Ray/Triangle
    /// Intersection*: the scene is moved and sheared so that the ray starts at the origin and runs along z. A triangle
    /// is met if the origin lies on the same side of the projections of its three sides, or on them.
    ///
    /// 1. A projected corner is the same for all triangles that have it, and a side's product `x_i y_j - y_i x_j` only
    ///    changes its sign with the direction of the side (no fused multiplication here, it would round both ways
    ///    differently), so a ray cannot slip between neighbours.
    /// 2. The distance is a mean of the corners' depths and so never beyond them.
    #[inline(always)]
    pub(super) fn meet(&self, ray: &Ray, length: f32) -> Hits {
        let [along_x, along_y, along_z] = ray.axes.map(|axis| &self.corners[usize::from(axis)]);
        let [origin_x, origin_y, origin_z] = ray.origin.map(f32x8::splat);
        let [slope_x, slope_y, inverse_z] = ray.shear.map(f32x8::splat);
        let z = [0, 1, 2, 3].map(|i| along_z[i] - origin_z);
        let x = [0, 1, 2, 3].map(|i| slope_x.mul_neg_add(z[i], along_x[i] - origin_x));
        let y = [0, 1, 2, 3].map(|i| slope_y.mul_neg_add(z[i], along_y[i] - origin_y));
        let side = |i: usize, j: usize| x[i] * y[j] - y[i] * x[j];
        let (ab, bc, cd, da, ac) = (side(0, 1), side(1, 2), side(2, 3), side(3, 0), side(0, 2));

        let to_triangle = |sides: [f32x8; 3], z: [f32x8; 3]| {
            let none = f32x8::ZERO;
            let [a, b, c] = sides;
            let inside = (a.simd_ge(none) & b.simd_ge(none) & c.simd_ge(none))
                | (a.simd_le(none) & b.simd_le(none) & c.simd_le(none));
            // The sides are the weights of the corners opposite and sum to the doubled area.
            let area = a + b + c;
            let depth = a.mul_add(z[0], b.mul_add(z[1], c * z[2]));
            let sign = area & f32x8::splat(-0.0);
            let (scale, distance) = (area ^ sign, (depth * inverse_z) ^ sign);
            let within = distance.simd_ge(none) & distance.simd_le(f32x8::splat(length) * scale);
            HitsOfTriangles {
                mask: inside & within & scale.simd_gt(none),
                distance_times_scale: distance,
                scale,
            }
        };
        Hits([
            to_triangle([bc, -ac, ab], [z[0], z[1], z[2]]),
            to_triangle([cd, da, ac], [z[0], z[2], z[3]]),
        ])
    }
}
