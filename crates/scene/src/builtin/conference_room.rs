//! A conference room of the dimensions of one that many renderers have been shown with: 24 luminaires, table, 32 chairs.
//!
//! 10.8 x 6.7 x 2.7 m. Luminance in cd/m².

use super::build::{SceneBuilder, Sides};
use crate::{Material, Scene, Units};
use core::f32::consts::PI;
use glam::{Affine3A, Quat, Vec2, Vec3};
use hemicube_raster::Rgb;

/// Length (x), height (y) and depth (z).
const ROOM: Vec3 = Vec3::new(10.82, 2.71, 6.71);
/// Length and width of a luminaire, which lies in the ceiling.
const LUMINAIRE: Vec2 = Vec2::new(1.22, 0.30);
/// Rows and columns of luminaires.
const LUMINAIRES: (usize, usize) = (4, 6);
/// Centre of the table, its half length and half width.
const TABLE: (Vec3, Vec2) = (Vec3::new(4.9, 0.0, 3.4), Vec2::new(1.7, 0.61));
/// Openings of the two doors in the wall at the back: x.
const DOORS: [f32; 2] = [0.9, 7.7];
const DOOR: Vec2 = Vec2::new(1.05, 2.18);

struct Palette {
    wall: usize,
    ceiling: usize,
    carpet: usize,
    base: usize,
    door: usize,
    table: usize,
    steel: usize,
    vinyl: usize,
    wood: usize,
    board: usize,
    frame: usize,
    louvre: usize,
    lamp: usize,
    dusk: usize,
}

impl Palette {
    fn new(b: &mut SceneBuilder) -> Self {
        let light = |name: &str, emission: Rgb| Material {
            emission,
            ..Material::diffuse(name, Rgb::new(0.7, 0.7, 0.7))
        };
        Self {
            wall: b.diffuse("wall", 0.64, 0.60, 0.56),
            ceiling: b.diffuse("ceiling", 0.80, 0.80, 0.79),
            carpet: b.diffuse("carpet", 0.19, 0.10, 0.09),
            base: b.diffuse("baseboard", 0.07, 0.07, 0.07),
            door: b.diffuse("door", 0.62, 0.37, 0.17),
            table: b.diffuse("table", 0.30, 0.16, 0.11),
            steel: b.diffuse("steel", 0.52, 0.52, 0.52),
            vinyl: b.diffuse("vinyl", 0.05, 0.05, 0.055),
            wood: b.diffuse("arm", 0.46, 0.24, 0.12),
            board: b.diffuse("board", 0.76, 0.77, 0.76),
            frame: b.diffuse("frame", 0.33, 0.33, 0.34),
            louvre: b.diffuse("louvre", 0.70, 0.70, 0.70),
            lamp: b.material(light("lamp", Rgb::new(3400.0, 3150.0, 2750.0))),
            dusk: b.material(light("dusk", Rgb::new(70.0, 95.0, 150.0))),
        }
    }
}

/// The room.
pub(super) fn scene() -> Scene {
    let mut builder = SceneBuilder::new("conference-room", Units::Photometric);
    let palette = Palette::new(&mut builder);
    shell(&mut builder, &palette);
    luminaires(&mut builder, &palette);
    table(&mut builder, &palette);
    chairs(&mut builder, &palette);
    boards(&mut builder, &palette);
    builder.views(&[
        (
            "entrance",
            Vec3::new(10.5, 1.65, 4.6),
            Vec3::new(3.4, 0.75, 3.3),
            60.0,
        ),
        (
            "table",
            Vec3::new(8.2, 1.55, 3.0),
            Vec3::new(3.4, 0.7, 3.5),
            54.0,
        ),
        (
            "board",
            Vec3::new(1.2, 1.5, 5.9),
            Vec3::new(8.2, 0.9, 1.8),
            58.0,
        ),
    ]);
    builder.finish()
}

fn shell(b: &mut SceneBuilder, m: &Palette) {
    b.node("floor");
    b.room(m.carpet, Vec3::ZERO, ROOM, Sides::only(&[Sides::BOTTOM]));
    b.node("ceiling");
    let holes: Vec<(Vec2, Vec2)> = places()
        .map(|c| (c - LUMINAIRE * 0.5, c + LUMINAIRE * 0.5))
        .collect();
    let corner = Vec3::new(0.0, ROOM.y, 0.0);
    b.rectangle_with_holes(
        m.ceiling,
        corner,
        [Vec3::X, Vec3::Z],
        Vec2::new(ROOM.x, ROOM.z),
        &holes,
    );
    b.node("walls");
    b.room(m.wall, Vec3::ZERO, ROOM, Sides::only(&[Sides::FRONT]));
    // Behind, with two doors; on the left, with a window.
    let holes = DOORS.map(|x| (Vec2::new(x, 0.0), Vec2::new(x, 0.0) + DOOR));
    b.rectangle_with_holes(
        m.wall,
        Vec3::ZERO,
        [Vec3::X, Vec3::Y],
        Vec2::new(ROOM.x, ROOM.y),
        &holes,
    );
    let window = (Vec2::new(1.0, 0.95), Vec2::new(5.7, 2.35));
    let origin = Vec3::new(0.0, 0.0, ROOM.z);
    b.rectangle_with_holes(
        m.wall,
        origin,
        [Vec3::NEG_Z, Vec3::Y],
        Vec2::new(ROOM.z, ROOM.y),
        &[window],
    );
    b.room(m.wall, Vec3::ZERO, ROOM, Sides::only(&[Sides::RIGHT]));
    b.node("doors");
    for x in DOORS {
        b.room(
            m.frame,
            Vec3::new(x, 0.0, -0.12),
            Vec3::new(x + DOOR.x, DOOR.y, 0.0),
            Sides::only(&[Sides::LEFT, Sides::RIGHT, Sides::TOP, Sides::BOTTOM]),
        );
        b.room(
            m.door,
            Vec3::new(x, 0.0, -0.12),
            Vec3::new(x + DOOR.x, DOOR.y, 0.0),
            Sides::only(&[Sides::BACK]),
        );
        b.cuboid(
            m.steel,
            Vec3::new(x + 0.08, 1.0, -0.12),
            Vec3::new(x + 0.11, 1.14, -0.05),
            Sides::without(&[Sides::BACK]),
        );
    }
    b.node("window");
    let (low, high) = (ROOM.z - window.1.x, ROOM.z - window.0.x);
    let (from, to) = (
        Vec3::new(-0.18, window.0.y, low),
        Vec3::new(0.0, window.1.y, high),
    );
    b.room(
        m.frame,
        from,
        to,
        Sides::only(&[Sides::TOP, Sides::BOTTOM, Sides::BACK, Sides::FRONT]),
    );
    b.room(m.dusk, from, to, Sides::only(&[Sides::LEFT]));
    for i in 1..4 {
        let z = low + (high - low) * i as f32 / 4.0;
        b.cuboid(
            m.frame,
            Vec3::new(-0.13, from.y, z - 0.025),
            Vec3::new(-0.06, to.y, z + 0.025),
            Sides::without(&[Sides::TOP, Sides::BOTTOM]),
        );
    }
    b.node("baseboard");
    let height = 0.1;
    b.cuboid(
        m.base,
        Vec3::new(0.0, 0.0, ROOM.z - 0.012),
        Vec3::new(ROOM.x, height, ROOM.z),
        Sides::only(&[Sides::TOP, Sides::BACK]),
    );
    b.cuboid(
        m.base,
        Vec3::new(ROOM.x - 0.012, 0.0, 0.0),
        Vec3::new(ROOM.x, height, ROOM.z - 0.012),
        Sides::only(&[Sides::TOP, Sides::LEFT]),
    );
    b.cuboid(
        m.base,
        Vec3::ZERO,
        Vec3::new(0.012, height, ROOM.z - 0.012),
        Sides::only(&[Sides::TOP, Sides::RIGHT]),
    );
}

/// Centres of the luminaires: x and z.
fn places() -> impl Iterator<Item = Vec2> {
    let (rows, columns) = LUMINAIRES;
    (0..rows * columns).map(move |i| {
        let (row, column) = (i / columns, i % columns);
        Vec2::new(
            ROOM.x * (column as f32 + 0.5) / columns as f32,
            ROOM.z * (row as f32 + 0.5) / rows as f32,
        )
    })
}

/// Boxes in the ceiling with a lamp at their top, parted by louvres.
fn luminaires(b: &mut SceneBuilder, m: &Palette) {
    let depth = 0.11;
    for (i, centre) in places().enumerate() {
        b.node(&format!("luminaire-{}", i + 1));
        let (low, high) = (centre - LUMINAIRE * 0.5, centre + LUMINAIRE * 0.5);
        let (from, to) = (
            Vec3::new(low.x, ROOM.y, low.y),
            Vec3::new(high.x, ROOM.y + depth, high.y),
        );
        b.room(
            m.louvre,
            from,
            to,
            Sides::only(&[Sides::LEFT, Sides::RIGHT, Sides::BACK, Sides::FRONT]),
        );
        b.room(m.lamp, from, to, Sides::only(&[Sides::TOP]));
        for k in 1..6 {
            let x = low.x + LUMINAIRE.x * k as f32 / 6.0;
            b.cuboid(
                m.louvre,
                Vec3::new(x - 0.004, ROOM.y + 0.01, low.y),
                Vec3::new(x + 0.004, ROOM.y + 0.07, high.y),
                Sides::without(&[Sides::BACK, Sides::FRONT]),
            );
        }
    }
}

/// A top whose long sides bulge, on two stands.
fn table(b: &mut SceneBuilder, m: &Palette) {
    let (centre, half) = TABLE;
    b.node_at("table", Affine3A::from_translation(centre));
    let (top, thickness) = (0.74, 0.042);
    b.plate(m.table, 24, 6, |u, v, w| {
        let x = (2.0 * u - 1.0) * half.x;
        let width = half.y * (0.82 + 0.18 * (1.0 - (2.0 * u - 1.0).powi(2)));
        Vec3::new(x, top - thickness * (1.0 - w), (1.0 - 2.0 * v) * width)
    });
    for side in [-1.0, 1.0] {
        let x = side * 0.95;
        b.cuboid(
            m.frame,
            Vec3::new(x - 0.06, 0.05, -0.18),
            Vec3::new(x + 0.06, top - thickness, 0.18),
            Sides::without(&[Sides::TOP, Sides::BOTTOM]),
        );
        b.cuboid(
            m.frame,
            Vec3::new(x - 0.09, 0.0, -0.42),
            Vec3::new(x + 0.09, 0.05, 0.42),
            Sides::without(&[Sides::BOTTOM]),
        );
    }
}

/// Twelve around the table, ten along each of the long walls.
fn chairs(b: &mut SceneBuilder, m: &Palette) {
    let (centre, half) = TABLE;
    let mut number = 0;
    let mut put = |b: &mut SceneBuilder, x: f32, z: f32, degrees: f32| {
        number += 1;
        // Nobody leaves chairs quite in line.
        let turn = degrees + 9.0 * (number as f32 * 2.399).sin();
        let place = Affine3A::from_rotation_translation(
            Quat::from_rotation_y(turn * PI / 180.0),
            Vec3::new(x, 0.0, z),
        );
        b.node_at(&format!("chair-{number}"), place);
        chair(b, m);
    };
    for i in 0..5 {
        let x = centre.x - 1.32 + 0.66 * i as f32;
        put(b, x, centre.z - half.y - 0.42, 180.0);
        put(b, x, centre.z + half.y + 0.42, 0.0);
    }
    put(b, centre.x - half.x - 0.42, centre.z, 270.0);
    put(b, centre.x + half.x + 0.42, centre.z, 90.0);
    for i in 0..10 {
        let x = 2.35 + 0.72 * i as f32;
        put(b, x, ROOM.z - 0.48, 0.0);
        let x = [2.45, 3.15, 3.85, 4.55, 5.25, 5.95, 6.65, 9.1, 9.8, 10.48][i];
        put(b, x, 0.48, 180.0);
    }
}

/// Frame of steel, seat and back of vinyl; it looks along -z.
fn chair(b: &mut SceneBuilder, m: &Palette) {
    let (width, seat, arm) = (0.25, 0.44, 0.63);
    for x in [-width, width] {
        b.tube(
            m.steel,
            &[
                Vec3::new(x, 0.0, -0.23),
                Vec3::new(x, arm - 0.04, -0.20),
                Vec3::new(x, arm, -0.16),
                Vec3::new(x, arm, 0.17),
                Vec3::new(x, arm - 0.05, 0.21),
                Vec3::new(x, 0.0, 0.24),
            ],
            0.011,
            6,
        );
        b.cuboid(
            m.wood,
            Vec3::new(x - 0.022, arm + 0.011, -0.15),
            Vec3::new(x + 0.022, arm + 0.03, 0.15),
            Sides::ALL,
        );
    }
    b.tube(
        m.steel,
        &[
            Vec3::new(-width + 0.011, seat - 0.06, 0.1),
            Vec3::new(width - 0.011, seat - 0.06, 0.1),
        ],
        0.009,
        6,
    );
    b.tube(
        m.steel,
        &[
            Vec3::new(-width + 0.011, seat - 0.06, -0.14),
            Vec3::new(width - 0.011, seat - 0.06, -0.14),
        ],
        0.009,
        6,
    );
    b.rounded(
        m.vinyl,
        Vec3::new(-0.225, seat - 0.05, -0.215),
        Vec3::new(0.225, seat + 0.02, 0.19),
        0.03,
        2,
    );
    b.plate(m.vinyl, 6, 4, |u, v, w| {
        let x = (2.0 * u - 1.0) * 0.215;
        let bulge = 0.035 * (1.0 - (2.0 * u - 1.0).powi(2));
        let y = seat + 0.09 + 0.33 * v;
        // The front looks at who sits.
        Vec3::new(-x, y, 0.205 + 0.07 * v + bulge - 0.03 * w)
    });
}

/// A white board, a screen in its case, and what stands below.
fn boards(b: &mut SceneBuilder, m: &Palette) {
    b.node("board");
    let x = ROOM.x;
    b.cuboid(
        m.frame,
        Vec3::new(x - 0.03, 0.9, 2.0),
        Vec3::new(x, 2.15, 4.7),
        Sides::without(&[Sides::RIGHT]),
    );
    b.cuboid(
        m.board,
        Vec3::new(x - 0.034, 0.93, 2.03),
        Vec3::new(x - 0.03, 2.12, 4.67),
        Sides::without(&[Sides::RIGHT]),
    );
    b.cuboid(
        m.frame,
        Vec3::new(x - 0.09, 0.86, 2.2),
        Vec3::new(x, 0.9, 4.5),
        Sides::without(&[Sides::RIGHT, Sides::TOP]),
    );
    b.node("screen-case");
    b.cuboid(
        m.board,
        Vec3::new(x - 0.12, 2.42, 1.9),
        Vec3::new(x, 2.54, 4.8),
        Sides::without(&[Sides::RIGHT]),
    );
    b.node("waste-basket");
    b.part(Affine3A::from_translation(Vec3::new(0.35, 0.0, 6.3)), |b| {
        b.lathe(
            m.vinyl,
            &[
                (0.0, 0.0),
                (0.12, 0.0),
                (0.12, 0.0),
                (0.15, 0.33),
                (0.15, 0.33),
                (0.14, 0.33),
                (0.14, 0.33),
                (0.11, 0.01),
                (0.11, 0.01),
                (0.0, 0.01),
            ],
            20,
        );
    });
    b.node("lectern");
    let place =
        Affine3A::from_rotation_translation(Quat::from_rotation_y(-0.7), Vec3::new(9.7, 0.0, 5.6));
    b.part(place, |b| {
        b.cuboid(
            m.door,
            Vec3::new(-0.28, 0.0, -0.2),
            Vec3::new(0.28, 1.05, 0.2),
            Sides::without(&[Sides::BOTTOM]),
        );
        b.cuboid(
            m.frame,
            Vec3::new(-0.32, 1.05, -0.24),
            Vec3::new(0.32, 1.09, 0.24),
            Sides::ALL,
        );
    });
}
