//! From the world to clip space.

use crate::error::RenderError;
use crate::lens::frame;
use core::f32::consts::{PI, TAU};
use core::f64::consts::FRAC_PI_2;
use glam::{DMat4, DVec3, DVec4};
use hemicube_scene::{Camera, Projection};

/// Clip space from world space, with the convention of wgpu: y up, `0 <= z <= w` between `near` and `far` (distances
/// along the viewing direction).
///
/// `aspect` is the picture's width by its height. A perspective camera keeps its vertical angle of view; an orthographic
/// one shows all of its view volume and more on two sides where the picture has another aspect. Panoramas and fisheyes
/// bend lines, which no matrix does; for them this is the view of a perspective camera of 90°.
pub fn clip_from_world(camera: &Camera, aspect: f64, near: f64, far: f64) -> DMat4 {
    clip_from_view(camera.projection, aspect, near, far) * view_from_world(camera)
}

/// View space has x to the right, y up, and looks along -z.
fn view_from_world(camera: &Camera) -> DMat4 {
    let (right, up, forward) = frame(camera);
    let world_from_view = DMat4::from_cols(
        right.extend(0.0),
        up.extend(0.0),
        (-forward).extend(0.0),
        DVec4::W,
    );
    world_from_view.transpose() * DMat4::from_translation(-camera.eye.as_dvec3())
}

fn clip_from_view(projection: Projection, aspect: f64, near: f64, far: f64) -> DMat4 {
    let depth = far - near;
    // z/w = far / (far - near) (1 - near / distance)
    let perspective = |vertical_fov: f64| {
        let y = 1.0 / (0.5 * vertical_fov).tan();
        DMat4::from_cols(
            DVec4::new(y / aspect, 0.0, 0.0, 0.0),
            DVec4::new(0.0, y, 0.0, 0.0),
            DVec4::new(0.0, 0.0, -far / depth, -1.0),
            DVec4::new(0.0, 0.0, -near * far / depth, 0.0),
        )
    };
    match projection {
        Projection::Perspective { vertical_fov, .. } => perspective(f64::from(vertical_fov)),
        Projection::Panorama | Projection::Fisheye { .. } => perspective(FRAC_PI_2),
        Projection::Orthographic {
            half_width,
            half_height,
        } => {
            let y = f64::from(half_height).max(f64::from(half_width) / aspect);
            DMat4::from_cols(
                DVec4::new(1.0 / (y * aspect), 0.0, 0.0, 0.0),
                DVec4::new(0.0, 1.0 / y, 0.0, 0.0),
                DVec4::new(0.0, 0.0, -1.0 / depth, 0.0),
                DVec4::new(0.0, 0.0, -near / depth, 1.0),
            )
        }
    }
}

/// Distance of a point from the eye along the viewing direction; negative behind it.
pub(crate) fn distance_along_view(camera: &Camera, point: DVec3) -> f64 {
    (point - camera.eye.as_dvec3()).dot(camera.forward.as_dvec3().normalize())
}

/// The door for cameras.
///
/// # Errors
/// One that cannot see: numbers that are not finite, no direction, an angle of view out of range.
pub fn check_camera(camera: &Camera) -> Result<(), RenderError> {
    let fail = |problem| {
        Err(RenderError::Camera {
            name: camera.name.clone(),
            problem,
        })
    };
    if !(camera.eye.is_finite() && camera.forward.is_finite() && camera.up.is_finite()) {
        return fail("eye, forward or up is not finite");
    }
    let Some(forward) = camera.forward.as_dvec3().try_normalize() else {
        return fail("forward has no length");
    };
    let up = camera.up.as_dvec3();
    if forward.cross(up).length() <= 1e-6 * up.length() {
        return fail("up has no length or lies along forward");
    }
    match camera.projection {
        Projection::Perspective { vertical_fov, .. }
            if !(1e-4..PI - 1e-3).contains(&vertical_fov) =>
        {
            fail("the vertical angle of view is not between 0 and 180 degrees")
        }
        Projection::Orthographic {
            half_width,
            half_height,
        } if ![half_width, half_height]
            .iter()
            .all(|x| x.is_finite() && *x > 0.0) =>
        {
            fail("the view volume's half width or half height is not a positive length")
        }
        Projection::Fisheye { angle, .. } if !(1e-4..=TAU).contains(&angle) => {
            fail("the fisheye's angle of view is not between 0 and 360 degrees")
        }
        _ => Ok(()),
    }
}

/// Whether lines stay straight, so that triangles can be drawn by their corners.
pub(crate) fn keeps_lines(projection: Projection) -> bool {
    matches!(
        projection,
        Projection::Perspective { .. } | Projection::Orthographic { .. }
    )
}
