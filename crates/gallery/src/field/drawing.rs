//! An eye from which a whole object is seen, and pictures of bare triangles from there.

use crate::stage::{Hit, draw_hits};
use glam::{DMat3, DMat4, DVec2, DVec3, Vec3, Vec4};
use hemicube_raster::antialias::Antialiasing;
use hemicube_raster::{Image, Rgb};

/// Where an object is seen from.
#[derive(Debug, Clone, Copy)]
pub struct Eye {
    clip_from_world: DMat4,
    /// Towards the eye.
    pub direction: DVec3,
}

/// Vertical field of view, radians.
const FIELD_OF_VIEW: f64 = 0.45;

/// How much larger the picture is than what it shows.
const MARGIN: f64 = 1.04;

impl Eye {
    /// From a direction, so near that all points just fit into the picture.
    pub fn around(points: &[Vec3], direction: DVec3, (width, height): (usize, usize)) -> Self {
        let direction = direction.normalize_or(DVec3::Z);
        // Seen from above or below, -Z is up in the picture.
        let is_steep = direction.y.abs() > 0.99;
        let up = if is_steep { DVec3::NEG_Z } else { DVec3::Y };
        let right = up.cross(direction).normalize();
        let axes = DMat3::from_cols(right, direction.cross(right), direction);
        let seen = || points.iter().map(|p| axes.transpose() * p.as_dvec3());
        let start = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        let (low, high) = seen().fold(start, |(low, high), p| (low.min(p), high.max(p)));
        let centre = (low + high) * 0.5;
        let aspect = width as f64 / height as f64;
        let slope = DVec2::new(aspect, 1.0) * (0.5 * FIELD_OF_VIEW).tan() / MARGIN;
        let needed = |p: DVec3| p.z + ((p - centre).truncate().abs() / slope).max_element();
        let size = (high - low).max_element().max(1e-30);
        // Not so near that what lies in front is out of proportion.
        let nearest = high.z + 0.5 * size;
        let height = seen().map(needed).fold(nearest, f64::max);
        let eye = axes * centre.truncate().extend(height);
        let view = glam::dcamera::rh::view::look_to_mat4(eye, -direction, up);
        let (near, far) = (height - high.z, height - low.z);
        let projection = glam::dcamera::rh::proj::directx::perspective(
            FIELD_OF_VIEW,
            aspect,
            near - 0.01 * size,
            far + 0.01 * size,
        );
        Self {
            clip_from_world: projection * view,
            direction,
        }
    }

    fn clip(&self, point: Vec3) -> Vec4 {
        (self.clip_from_world * point.as_dvec3().extend(1.0)).as_vec4()
    }
}

/// Draws triangles on a ground, both sides, antialiased: `shade` is asked at each sample, with barycentric coordinates in [0, 1]
/// and gradients per pixel.
pub fn draw(
    corners: &[[Vec3; 3]],
    eye: &Eye,
    size: (usize, usize),
    antialiasing: Antialiasing,
    ground: Rgb,
    shade: impl Fn(&Hit) -> Rgb + Sync,
) -> Image<Rgb> {
    let clipped: Vec<[Vec4; 3]> = corners.iter().map(|t| t.map(|p| eye.clip(p))).collect();
    let per_pixel = antialiasing.factor.get() as f32;
    draw_hits(&clipped, size, antialiasing, ground, |hit| {
        let [_, b, c] = hit.barycentric.map(|share| share.clamp(0.0, 1.0));
        shade(&Hit {
            barycentric: [(1.0 - b - c).max(0.0), b, c],
            ..hit.scaled(per_pixel)
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square() -> [[Vec3; 3]; 2] {
        let corner = |x: f32, y: f32| Vec3::new(x, y, 0.0);
        let [a, b, c, d] = [
            corner(-1.0, -1.0),
            corner(1.0, -1.0),
            corner(1.0, 1.0),
            corner(-1.0, 1.0),
        ];
        [[a, b, c], [a, c, d]]
    }

    #[test]
    fn values_and_gradients_are_those_of_the_plane() {
        let square = square();
        let eye = Eye::around(square.as_flattened(), DVec3::Z, (100, 100));
        let image = draw(
            &square,
            &eye,
            (100, 100),
            Antialiasing::NONE,
            Rgb::BLACK,
            |f: &Hit| {
                let (x, change) = f.interpolate(square[f.triangle].map(|p| p.x));
                Rgb::new(
                    x + 2.0,
                    change.length(),
                    f.place(square[f.triangle]).y + 2.0,
                )
            },
        );
        let (left, right) = (image.pixel(40, 50), image.pixel(60, 50));
        let slope = (right.r - left.r) / 20.0;
        assert!(
            (left.g / slope - 1.0).abs() < 1e-3,
            "gradient {}, difference {slope}",
            left.g
        );
        assert!(image.pixel(50, 30).b > image.pixel(50, 70).b, "y points up");
        assert_eq!(*image.pixel(0, 0), Rgb::BLACK, "the ground");
    }

    #[test]
    fn all_points_are_in_the_picture() {
        let far = [
            Vec3::new(1e6, 0.0, 0.0),
            Vec3::new(1e6, 3.0, 1.0),
            Vec3::new(1e6, -3.0, 0.5),
        ];
        let views = [(200, 50), (50, 200)]
            .into_iter()
            .flat_map(|size| [[1.0, 0.4, 0.2], [0.0, -1.0, 0.0], [0.0; 3]].map(|d| (size, d)));
        for (size, direction) in views {
            let eye = Eye::around(&far, direction.into(), size);
            for p in far {
                let p = eye.clip(p);
                assert!(
                    p.x.abs() <= p.w && p.y.abs() <= p.w && (0.0..=p.w).contains(&p.z),
                    "{p}"
                );
            }
        }
    }
}
