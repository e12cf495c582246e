//! Two rooms joined by a doorway.

use crate::{Camera, Scene};
use glam::Vec3;

/// Room A with a table and two ceiling lights, room B lit by a cove light on a cabinet and by what comes through the
/// doorway; metres, closed.
pub(super) fn scene() -> Scene {
    let mut scene = super::quads::scene(include_str!("two_rooms.json"), |quad, _| {
        String::from(match quad {
            "A_floor" => "parquet",
            "B_floor" => "carpet",
            "A_west" => "terracotta",
            "B_east" => "blue",
            "L1" => "light-neutral",
            "L2" => "light-warm",
            "L3" => "light-cove",
            _ if quad.contains("ceil") => "ceiling",
            _ if quad.starts_with("door") => "door-frame",
            _ if quad.starts_with("table") || quad.starts_with("leg") => "table",
            _ if quad.starts_with("cab") || quad.starts_with("lip") => "cabinet",
            _ => "plaster",
        })
    });
    let views = [
        (
            "room-a",
            Vec3::new(0.4, 1.6, 0.4),
            Vec3::new(5.0, 1.1, 3.0),
            65.0_f32,
        ),
        (
            "room-b",
            Vec3::new(5.6, 1.6, 0.5),
            Vec3::new(7.3, 1.3, 5.6),
            60.0,
        ),
        (
            "doorway",
            Vec3::new(7.8, 1.6, 4.4),
            Vec3::new(3.6, 1.0, 2.2),
            60.0,
        ),
    ];
    for (name, eye, target, fov) in views {
        scene.cameras.push(Camera::looking_at(
            name,
            eye,
            target,
            Vec3::Y,
            fov.to_radians(),
        ));
    }
    scene
}
