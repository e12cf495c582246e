//! The Cornell box: measured geometry in millimetres, open at the front.

use crate::{Camera, Projection, Scene};
use glam::Vec3;

/// Walls and boxes of the original; reflectances in three bands, the light's radiance in W/(m² sr).
///
/// The light reflects too (0.78), which matters at the level of 1 %. Walls meet at slightly different corners, as
/// measured; the red one is not planar by 3.2 mm.
pub(super) fn scene() -> Scene {
    let mut scene = super::quads::scene(include_str!("cornell.json"), |quad, _| {
        String::from(match quad {
            "light" => "light",
            "right_green" => "green",
            "left_red" => "red",
            _ => "white",
        })
    });
    let (eye, vertical_fov) = (Vec3::new(278.0, 273.0, -800.0), 39.3077_f32.to_radians());
    let mut front = Camera::looking_at("front", eye, eye + Vec3::Z, Vec3::Y, vertical_fov);
    // The original photograph is square.
    front.projection = Projection::Perspective {
        vertical_fov,
        aspect: Some(1.0),
    };
    scene.cameras.push(front);
    scene
}
