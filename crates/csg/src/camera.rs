//! A pinhole camera.

use crate::error::{CsgError, check_number};
use crate::ray::Ray;
use crate::shapes::{check_point, checked_direction};
use glam::DVec3;

/// A place to look from, with a direction and a field of view; up is +Y.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Camera {
    eye: DVec3,
    forward: DVec3,
    /// Half the height of a picture at distance 1, to the right and up.
    right: DVec3,
    up: DVec3,
}

impl Camera {
    /// Looking from `eye` at a point, with a field of view of so many degrees from the lower to the upper border.
    pub fn new(eye: DVec3, look_at: DVec3, degrees: f64) -> Result<Self, CsgError> {
        check_point("camera", "eye", eye)?;
        check_point("camera", "look-at", look_at)?;
        check_number("camera: field of view", degrees, 0.01, 179.0)?;
        let forward = checked_direction("camera", "line of sight", look_at - eye)?;
        // Straight up or down the upper border is towards -Z or +Z.
        let side = forward.cross(DVec3::Y);
        let right = if side.length() > 1e-9 {
            side.normalize()
        } else {
            DVec3::X
        };
        let half = (degrees.to_radians() * 0.5).tan();
        Ok(Self {
            eye,
            forward,
            right: right * half,
            up: right.cross(forward) * half,
        })
    }

    /// The ray through a point of a picture of `width` by `height` pixels: x to the right, y down, `(0, 0)` the upper
    /// left corner, pixel centres at halves.
    pub fn ray(&self, x: f64, y: f64, width: usize, height: usize) -> Ray {
        let (width, height) = (width as f64, height as f64);
        let across = (2.0 * x - width) / height;
        let upwards = 1.0 - 2.0 * y / height;
        let direction = self.forward + self.right * across + self.up * upwards;
        Ray::new(self.eye, direction)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn borders_lie_at_the_field_of_view() {
        let camera = Camera::new(DVec3::new(0.0, 1.0, 5.0), DVec3::new(0.0, 1.0, 0.0), 90.0)
            .expect("a camera");
        let top = camera.ray(100.0, 0.0, 200, 100).direction();
        assert!(
            (top - DVec3::new(0.0, 1.0, -1.0).normalize()).length() < 1e-15,
            "{top}"
        );
        let corner = camera.ray(200.0, 100.0, 200, 100).direction();
        assert!(
            (corner - DVec3::new(2.0, -1.0, -1.0).normalize()).length() < 1e-15,
            "{corner}"
        );
    }

    #[test]
    fn looking_straight_down_has_an_upper_border() {
        let camera = Camera::new(DVec3::Y, DVec3::ZERO, 90.0).expect("a camera");
        let top = camera.ray(0.5, 0.0, 1, 1).direction();
        assert!(top.z < -0.5 && top.y < -0.5, "{top}");
    }

    #[test]
    fn cameras_that_see_nothing_are_refused() {
        for (eye, look_at, degrees) in [
            (DVec3::ZERO, DVec3::ZERO, 40.0),
            (DVec3::NAN, DVec3::ZERO, 40.0),
            (DVec3::ZERO, DVec3::X, 0.0),
            (DVec3::ZERO, DVec3::X, f64::NAN),
        ] {
            let error = Camera::new(eye, look_at, degrees).expect_err("no camera");
            assert!(error.to_string().starts_with("camera: "), "{error}");
        }
    }
}
