//! Texture coordinates on the screen and their exact derivatives.

use crate::triangle::Viewport;
use glam::{DMat3, DVec2, DVec3, Vec2, Vec4};

/// Texture coordinates of a triangle in perspective, as functions of the pixel.
///
/// `u/w`, `v/w` and `1/w` are planes over the screen. With `q = 1/w`, `u = (u/w) / q` and, by the quotient rule,
/// `du/dx = (d(u/w)/dx - u dq/dx) / q`. The planes follow from the corners in homogeneous coordinates (Olano and Greer
/// 1997): `[x y w] a = u` for each corner, so corners behind the eye need no clipping. Unlike differences between
/// pixels of a 2 x 2 block these derivatives are right at edges of triangles too.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TexcoordPlanes {
    u_over_w: DVec3,
    v_over_w: DVec3,
    inverse_w: DVec3,
}

/// Texture coordinates of a pixel and their change to the pixel to the right and to the one below.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Texcoord {
    /// The coordinates.
    pub uv: Vec2,
    /// Change from a pixel to its right neighbour.
    pub ddx: Vec2,
    /// Change from a pixel to the one below.
    pub ddy: Vec2,
}

impl TexcoordPlanes {
    /// From clip-space positions (y up, before division by w) and coordinates of three corners.
    ///
    /// `None` if the triangle is seen edge-on or has no area, or a number is not finite.
    pub fn new(viewport: Viewport, positions: &[Vec4; 3], texcoords: &[Vec2; 3]) -> Option<Self> {
        let half = 0.5 * DVec2::new(viewport.width as f64, viewport.height as f64);
        // Pixels times w, from the upper left corner.
        let corner = |p: Vec4| {
            let p = p.as_dvec4();
            DVec3::new((p.x + p.w) * half.x, (p.w - p.y) * half.y, p.w)
        };
        let corners = DMat3::from_cols_array_2d(&positions.map(|p| corner(p).to_array()));
        let scale = corners.x_axis.length() * corners.y_axis.length() * corners.z_axis.length();
        let determinant = corners.determinant();
        if !scale.is_finite() || determinant.abs() <= 1e-14 * scale {
            return None;
        }
        let planes_from_corners = corners.transpose().inverse();
        let [a, b, c] = texcoords.map(Vec2::as_dvec2);
        let planes = Self {
            u_over_w: planes_from_corners * DVec3::new(a.x, b.x, c.x),
            v_over_w: planes_from_corners * DVec3::new(a.y, b.y, c.y),
            inverse_w: planes_from_corners * DVec3::ONE,
        };
        let is_finite = planes.u_over_w.is_finite() && planes.v_over_w.is_finite();
        is_finite.then_some(planes)
    }

    /// At a point in pixels from the upper left corner; the centre of pixel `(i, j)` is `(i + 1/2, j + 1/2)`.
    ///
    /// On the triangle's horizon (`1/w = 0`) numbers are infinite or NaN.
    #[inline]
    pub fn at(&self, pixel: DVec2) -> Texcoord {
        let point = pixel.extend(1.0);
        let w = 1.0 / self.inverse_w.dot(point);
        let over_w = DVec2::new(self.u_over_w.dot(point), self.v_over_w.dot(point));
        let uv = over_w * w;
        let change = |axis: usize| {
            let over_w = DVec2::new(self.u_over_w[axis], self.v_over_w[axis]);
            ((over_w - uv * self.inverse_w[axis]) * w).as_vec2()
        };
        Texcoord {
            uv: uv.as_vec2(),
            ddx: change(0),
            ddy: change(1),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::triangle::{ClipVertex, Cull, DepthBuffer, draw_triangle};
    use proptest::prelude::*;

    const VIEWPORT: Viewport = Viewport::new(48, 32);

    /// Corners of a triangle under a perspective projection, in clip space.
    fn positions(corners: [[f32; 3]; 3]) -> [Vec4; 3] {
        corners.map(|[x, y, z]| Vec4::new(x, 1.5 * y, -0.5 * z, -z))
    }

    fn corner() -> impl Strategy<Value = [f32; 3]> {
        [-3.0_f32..3.0, -3.0_f32..3.0, -9.0_f32..-0.5]
    }

    const TEXCOORDS: [Vec2; 3] = [Vec2::ZERO, Vec2::new(4.0, 0.5), Vec2::new(-1.0, 3.0)];

    proptest! {
        #[test]
        fn coordinates_are_those_of_the_rasteriser(corners in [corner(), corner(), corner()]) {
            let positions = positions(corners);
            let Some(planes) = TexcoordPlanes::new(VIEWPORT, &positions, &TEXCOORDS) else {
                return Ok(());
            };
            let vertices = [0, 1, 2].map(|i| ClipVertex::new(positions[i], TEXCOORDS[i].to_array()));
            let mut depth = DepthBuffer::new(VIEWPORT);
            let rows = 0..VIEWPORT.height;
            let mut worst = 0.0_f32;
            draw_triangle(rows, VIEWPORT, Cull::None, &vertices, depth.values_mut(), |x, y, _, uv| {
                let found = planes.at(DVec2::new(x as f64 + 0.5, y as f64 + 0.5));
                // Corners of the drawn triangle are snapped to 1/256 pixel, by less than that in each direction.
                let slack = (found.ddx.abs() + found.ddy.abs()).length() / 128.0 + 1e-4;
                worst = worst.max((found.uv - Vec2::from_array(*uv)).length() - slack);
                true
            });
            // Where a triangle is nearly edge-on, snapping turns it.
            let area = (positions[1] / positions[1].w - positions[0] / positions[0].w).truncate().truncate()
                .perp_dot((positions[2] / positions[2].w - positions[0] / positions[0].w).truncate().truncate());
            prop_assert!(worst <= 0.0 || area.abs() < 0.5, "{worst} beyond snapping");
        }

        #[test]
        fn derivatives_are_limits_of_differences(corners in [corner(), corner(), corner()], x in 0.0..48.0, y in 0.0..32.0) {
            let Some(planes) = TexcoordPlanes::new(VIEWPORT, &positions(corners), &TEXCOORDS) else {
                return Ok(());
            };
            let (pixel, step) = (DVec2::new(x, y), 1e-4);
            let exact = |point: DVec2| {
                let point = point.extend(1.0);
                DVec2::new(planes.u_over_w.dot(point), planes.v_over_w.dot(point)) / planes.inverse_w.dot(point)
            };
            let found = planes.at(pixel);
            for (axis, derivative) in [(DVec2::X, found.ddx), (DVec2::Y, found.ddy)] {
                let difference = (exact(pixel + axis * step) - exact(pixel - axis * step)) / (2.0 * step);
                let error = (difference - derivative.as_dvec2()).length();
                // Next to the horizon the difference itself is wrong.
                prop_assume!(difference.length() < 10.0);
                prop_assert!(error < 1e-3 * (1.0 + difference.length()), "{derivative} instead of {difference}");
            }
        }
    }

    #[test]
    fn triangles_without_area_have_no_planes() {
        let line = positions([[0.0, 0.0, -1.0], [1.0, 1.0, -2.0], [2.0, 2.0, -3.0]]);
        assert_eq!(
            TexcoordPlanes::new(VIEWPORT, &line, &TEXCOORDS),
            None,
            "a line"
        );
        let mut broken = positions([[0.0, 0.0, -1.0], [1.0, 0.0, -2.0], [0.0, 2.0, -3.0]]);
        assert!(
            TexcoordPlanes::new(VIEWPORT, &broken, &TEXCOORDS).is_some(),
            "whole"
        );
        broken[1].x = f32::NAN;
        assert_eq!(
            TexcoordPlanes::new(VIEWPORT, &broken, &TEXCOORDS),
            None,
            "NaN"
        );
    }
}
