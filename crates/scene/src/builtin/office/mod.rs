//! A study: the first picture people see.
//!
//! 6.0 x 4.6 x 2.8 m. A window of four square metres looks west into a cool sky, everything else is lit by warm lamps.
//! Luminance in cd/m²; reflectances between 0.02 (black steel) and 0.85 (ceiling).

mod furniture;
mod objects;
mod paint;
mod palette;
mod plants;
mod seats;
mod shell;

use super::build::SceneBuilder;
use crate::{Scene, Units};
use glam::{Vec2, Vec3};
use palette::Palette;

/// Width (x), height (y) and depth (z) of the room.
const ROOM: Vec3 = Vec3::new(6.0, 2.8, 4.6);
/// Opening of the window in the western wall: z and y.
const WINDOW: (Vec2, Vec2) = (Vec2::new(0.9, 0.8), Vec2::new(3.7, 2.5));
/// Opening of the door in the eastern wall: z and y.
const DOOR: (Vec2, Vec2) = (Vec2::new(3.3, 0.0), Vec2::new(4.2, 2.05));
/// The rug on the floor: x and z.
const RUG: (Vec2, Vec2) = (Vec2::new(1.5, 1.75), Vec2::new(4.1, 3.55));

/// The study.
pub(super) fn scene() -> Scene {
    let mut builder = SceneBuilder::new("office", Units::Photometric);
    let palette = Palette::new(&mut builder);
    shell::draw(&mut builder, &palette);
    shell::draw_lights(&mut builder, &palette);
    furniture::draw(&mut builder, &palette);
    seats::draw(&mut builder, &palette);
    objects::draw(&mut builder, &palette);
    plants::draw(&mut builder, &palette);
    let views = [
        (
            "entrance",
            Vec3::new(5.62, 1.6, 3.75),
            Vec3::new(1.9, 0.92, 1.3),
            58.0,
        ),
        (
            "desk",
            Vec3::new(2.95, 1.4, 2.3),
            Vec3::new(1.25, 0.93, 0.35),
            52.0,
        ),
        (
            "window",
            Vec3::new(0.55, 1.5, 3.35),
            Vec3::new(5.2, 0.95, 1.2),
            56.0,
        ),
        (
            "corner",
            Vec3::new(5.45, 1.65, 0.88),
            Vec3::new(1.8, 0.78, 3.15),
            60.0,
        ),
    ];
    builder.views(&views);
    builder.finish()
}
