//! Walls, floor, window, door, and the lights that belong to the building.

use super::super::build::{SceneBuilder, Sides};
use super::palette::Palette;
use super::{DOOR, ROOM, RUG, WINDOW};
use glam::{Affine3A, Quat, Vec2, Vec3};
use std::f32::consts::{FRAC_PI_2, TAU};

/// Low corners (x, z) of the ceiling panels, and their side.
const PANELS: [Vec2; 4] = [
    Vec2::new(1.25, 1.05),
    Vec2::new(4.3, 1.05),
    Vec2::new(1.25, 3.1),
    Vec2::new(4.3, 3.1),
];
const PANEL: f32 = 0.45;

pub(super) fn draw(b: &mut SceneBuilder, m: &Palette) {
    floor_and_ceiling(b, m);
    walls(b, m);
    window(b, m);
    curtains(b, m);
    door(b, m);
}

fn floor_and_ceiling(b: &mut SceneBuilder, m: &Palette) {
    // The rug lies in a hole of the floor, so that no piece of floor is half hidden by it.
    let hole = (
        Vec2::new(RUG.0.x, ROOM.z - RUG.1.y),
        Vec2::new(RUG.1.x, ROOM.z - RUG.0.y),
    );
    b.node("floor");
    b.rectangle_with_holes(
        m.floor,
        Vec3::new(0.0, 0.0, ROOM.z),
        [Vec3::X, Vec3::NEG_Z],
        Vec2::new(ROOM.x, ROOM.z),
        &[hole],
    );
    b.node("rug");
    let (low, high) = (
        Vec3::new(RUG.0.x, 0.0, RUG.0.y),
        Vec3::new(RUG.1.x, 0.012, RUG.1.y),
    );
    b.cuboid(
        m.rug_edge,
        low,
        high,
        Sides::without(&[Sides::BOTTOM, Sides::TOP]),
    );
    let corner = |x: f32, z: f32| Vec3::new(x, high.y, z);
    b.picture(
        m.rug,
        [
            corner(low.x, high.z),
            corner(high.x, high.z),
            corner(high.x, low.z),
            corner(low.x, low.z),
        ],
    );

    b.node("ceiling");
    let holes = PANELS.map(|low| (low, low + PANEL));
    b.rectangle_with_holes(
        m.ceiling,
        Vec3::new(0.0, ROOM.y, 0.0),
        [Vec3::X, Vec3::Z],
        Vec2::new(ROOM.x, ROOM.z),
        &holes,
    );
}

fn walls(b: &mut SceneBuilder, m: &Palette) {
    let Vec3 { x, y, z } = ROOM;
    b.node("wall north");
    b.quad(
        m.accent,
        [
            Vec3::ZERO,
            Vec3::new(x, 0.0, 0.0),
            Vec3::new(x, y, 0.0),
            Vec3::new(0.0, y, 0.0),
        ],
    );
    b.node("wall south");
    b.quad(
        m.plaster,
        [
            Vec3::new(x, 0.0, z),
            Vec3::new(0.0, 0.0, z),
            Vec3::new(0.0, y, z),
            ROOM,
        ],
    );
    b.node("wall west");
    let window = (
        Vec2::new(z - WINDOW.1.x, WINDOW.0.y),
        Vec2::new(z - WINDOW.0.x, WINDOW.1.y),
    );
    b.rectangle_with_holes(
        m.plaster,
        Vec3::new(0.0, 0.0, z),
        [Vec3::NEG_Z, Vec3::Y],
        Vec2::new(z, y),
        &[window],
    );
    b.node("wall east");
    b.rectangle_with_holes(
        m.plaster,
        Vec3::new(x, 0.0, 0.0),
        [Vec3::Z, Vec3::Y],
        Vec2::new(z, y),
        &[DOOR],
    );

    b.node("skirting");
    let (high, thick) = (0.09, 0.014);
    let mut board = |low: Vec3, size: Vec3, sides: &[usize]| {
        b.cuboid(m.white, low, low + size, Sides::only(sides));
    };
    board(
        Vec3::ZERO,
        Vec3::new(x, high, thick),
        &[Sides::TOP, Sides::FRONT],
    );
    board(
        Vec3::new(0.0, 0.0, z - thick),
        Vec3::new(x, high, thick),
        &[Sides::TOP, Sides::BACK],
    );
    board(
        Vec3::new(0.0, 0.0, thick),
        Vec3::new(thick, high, z - 2.0 * thick),
        &[Sides::TOP, Sides::RIGHT],
    );
    let (before, after) = (DOOR.0.x - 0.08, DOOR.1.x + 0.08);
    board(
        Vec3::new(x - thick, 0.0, thick),
        Vec3::new(thick, high, before - thick),
        &[Sides::TOP, Sides::LEFT],
    );
    board(
        Vec3::new(x - thick, 0.0, after),
        Vec3::new(thick, high, z - thick - after),
        &[Sides::TOP, Sides::LEFT],
    );
}

fn window(b: &mut SceneBuilder, m: &Palette) {
    let (low, high) = WINDOW;
    let glass = -0.2;
    b.node("window");
    b.room(
        m.white,
        Vec3::new(glass, low.y, low.x),
        Vec3::new(0.0, high.y, high.x),
        Sides::without(&[Sides::LEFT, Sides::RIGHT]),
    );
    // The sill continues the lower side of the opening into the room.
    b.cuboid(
        m.oak,
        Vec3::new(0.0, low.y - 0.03, low.x - 0.04),
        Vec3::new(0.10, low.y, high.x + 0.04),
        Sides::without(&[Sides::LEFT]),
    );
    let uprights = [low.x, 1.80, 2.74, high.x - 0.06];
    for (i, z) in uprights.into_iter().enumerate() {
        let mut hidden = vec![Sides::LEFT, Sides::TOP, Sides::BOTTOM];
        hidden.extend(
            [
                (i == 0).then_some(Sides::BACK),
                (i == 3).then_some(Sides::FRONT),
            ]
            .into_iter()
            .flatten(),
        );
        b.cuboid(
            m.white,
            Vec3::new(glass, low.y, z),
            Vec3::new(-0.12, high.y, z + 0.06),
            Sides::without(&hidden),
        );
    }
    for pair in uprights.windows(2) {
        let (from, to) = (pair[0] + 0.06, pair[1]);
        for (y, height, hidden) in [
            (low.y, 0.06, Some(Sides::BOTTOM)),
            (2.02, 0.045, None),
            (high.y - 0.06, 0.06, Some(Sides::TOP)),
        ] {
            let mut sides = vec![Sides::LEFT, Sides::BACK, Sides::FRONT];
            sides.extend(hidden);
            b.cuboid(
                m.white,
                Vec3::new(glass, y, from),
                Vec3::new(-0.13, y + height, to),
                Sides::without(&sides),
            );
        }
    }
    b.node("daylight");
    let corner = |y: f32, z: f32| Vec3::new(glass, y, z);
    b.picture(
        m.daylight,
        [
            corner(low.y, high.x),
            corner(low.y, low.x),
            corner(high.y, low.x),
            corner(high.y, high.x),
        ],
    );
}

fn curtains(b: &mut SceneBuilder, m: &Palette) {
    b.node("curtains");
    for (from, to) in [(0.42, 0.95), (3.65, 4.18)] {
        let columns = 37;
        b.sheet(m.curtain, 3, columns, |row, column| {
            let share = column as f32 / (columns - 1) as f32;
            let fold = (TAU * share * 6.0).sin() * (0.022 + 0.012 * (share * 9.0).sin());
            let height = [0.02, 1.3, 2.6][row];
            let gathered = 1.0 - 0.05 * row as f32;
            let middle = (from + to) * 0.5;
            Vec3::new(
                0.17 + fold * gathered,
                height,
                middle + (to - from) * (0.5 - share) * gathered,
            )
        });
    }
    b.node("curtain rail");
    b.tube(
        m.brass,
        &[Vec3::new(0.17, 2.625, 0.32), Vec3::new(0.17, 2.625, 4.28)],
        0.012,
        8,
    );
    for z in [0.32, 4.28] {
        b.sphere(m.brass, Vec3::new(0.17, 2.625, z), 0.026, 10);
    }
    for z in [0.40, 4.20] {
        b.tube(
            m.brass,
            &[Vec3::new(0.001, 2.625, z), Vec3::new(0.17, 2.625, z)],
            0.007,
            6,
        );
    }
}

fn door(b: &mut SceneBuilder, m: &Palette) {
    let (low, high) = DOOR;
    let (face, leaf) = (ROOM.x, ROOM.x + 0.06);
    b.node("door");
    b.room(
        m.white,
        Vec3::new(face, low.y, low.x),
        Vec3::new(leaf, high.y, high.x),
        Sides::without(&[Sides::LEFT, Sides::RIGHT]),
    );
    let corner = |y: f32, z: f32| Vec3::new(leaf, y, z);
    b.quad(
        m.walnut,
        [
            corner(low.y, low.x),
            corner(low.y, high.x),
            corner(high.y, high.x),
            corner(high.y, low.x),
        ],
    );
    for (from, to) in [(0.16, 0.86), (1.0, 1.92)] {
        let (a, c) = (
            Vec3::new(leaf - 0.014, from, low.x + 0.13),
            Vec3::new(leaf, to, high.x - 0.13),
        );
        b.cuboid(m.walnut, a, c, Sides::without(&[Sides::RIGHT]));
    }
    b.node("door frame");
    let (width, thick) = (0.08, 0.02);
    for z in [low.x - width, high.x] {
        let sides = Sides::without(&[Sides::RIGHT, Sides::BOTTOM]);
        b.cuboid(
            m.white,
            Vec3::new(face - thick, 0.0, z),
            Vec3::new(face, high.y + width, z + width),
            sides,
        );
    }
    let lintel = Sides::without(&[Sides::RIGHT, Sides::BACK, Sides::FRONT]);
    b.cuboid(
        m.white,
        Vec3::new(face - thick, high.y, low.x),
        Vec3::new(face, high.y + width, high.x),
        lintel,
    );

    b.node("door handle");
    let at = Vec3::new(leaf, 1.03, low.x + 0.065);
    b.part(
        Affine3A::from_rotation_translation(Quat::from_rotation_z(FRAC_PI_2), at),
        |b| {
            b.lathe(
                m.brass,
                &[
                    (0.026, 0.0),
                    (0.026, 0.006),
                    (0.026, 0.006),
                    (0.009, 0.008),
                    (0.009, 0.05),
                ],
                14,
            );
        },
    );
    let out = at - Vec3::X * 0.048;
    b.tube(
        m.brass,
        &[
            out - Vec3::Z * 0.012,
            out + Vec3::Z * 0.03,
            out + Vec3::Z * 0.12,
        ],
        0.0095,
        8,
    );
    b.node("light switch");
    let plate = Vec3::new(face - 0.008, 1.06, 3.04);
    b.cuboid(
        m.white,
        plate,
        plate + Vec3::new(0.008, 0.085, 0.085),
        Sides::without(&[Sides::RIGHT]),
    );
    b.cuboid(
        m.ceramic,
        plate + Vec3::new(-0.004, 0.02, 0.02),
        plate + Vec3::new(0.0, 0.065, 0.065),
        Sides::without(&[Sides::RIGHT]),
    );
}

/// Panels in the ceiling, the cove above the northern wall, the pendant over the table.
pub(super) fn draw_lights(b: &mut SceneBuilder, m: &Palette) {
    for (i, low) in PANELS.into_iter().enumerate() {
        b.node(&format!("ceiling panel {}", i + 1));
        let (bottom, top) = (
            Vec3::new(low.x, ROOM.y, low.y),
            Vec3::new(low.x + PANEL, ROOM.y + 0.03, low.y + PANEL),
        );
        b.room(
            m.white,
            bottom,
            top,
            Sides::without(&[Sides::TOP, Sides::BOTTOM]),
        );
        b.room(m.panel, bottom, top, Sides::only(&[Sides::TOP]));
    }

    b.node("cove board");
    let (low, high) = (Vec3::new(0.0, 2.63, 0.20), Vec3::new(ROOM.x, ROOM.y, 0.222));
    b.cuboid(
        m.ceiling,
        low,
        high,
        Sides::only(&[Sides::FRONT, Sides::BACK, Sides::BOTTOM]),
    );
    b.node("cove light");
    let (low, high) = (
        Vec3::new(0.2, ROOM.y - 0.02, 0.07),
        Vec3::new(ROOM.x - 0.2, ROOM.y, 0.12),
    );
    b.cuboid(m.cove, low, high, Sides::only(&[Sides::BOTTOM]));
    b.cuboid(
        m.white,
        low,
        high,
        Sides::without(&[Sides::BOTTOM, Sides::TOP]),
    );

    for (i, (x, z, y, radius)) in [
        (2.62, 2.78, 1.86, 0.12),
        (2.98, 2.68, 2.02, 0.095),
        (2.80, 2.44, 1.72, 0.075),
    ]
    .into_iter()
    .enumerate()
    {
        b.node(&format!("pendant {}", i + 1));
        b.sphere(m.globe, Vec3::new(x, y, z), radius, 14);
        let neck = y + radius - 0.004;
        b.part(Affine3A::from_translation(Vec3::new(x, neck, z)), |b| {
            b.lathe(
                m.brass,
                &[
                    (0.0, 0.0),
                    (0.03, 0.0),
                    (0.03, 0.0),
                    (0.026, 0.045),
                    (0.008, 0.06),
                    (0.0, 0.062),
                ],
                12,
            );
        });
        let cord = [Vec3::new(x, neck + 0.06, z), Vec3::new(x, ROOM.y - 0.03, z)];
        b.tube(m.black, &cord, 0.003, 5);
    }
    b.node("pendant rose");
    b.part(
        Affine3A::from_translation(Vec3::new(2.80, ROOM.y - 0.03, 2.62)),
        |b| {
            b.lathe(
                m.brass,
                &[(0.0, 0.0), (0.25, 0.0), (0.25, 0.0), (0.25, 0.03)],
                24,
            );
        },
    );
}
