//! Desk, bookshelf, sideboard, table, pictures.

use super::super::build::{SceneBuilder, Sides};
use super::ROOM;
use super::paint::hash;
use super::palette::Palette;
use glam::{Affine3A, Quat, Vec2, Vec3};

pub(super) fn draw(b: &mut SceneBuilder, m: &Palette) {
    desk(b, m);
    shelf(b, m);
    sideboard(b, m);
    coffee_table(b, m);
    pictures(b, m);
}

fn desk(b: &mut SceneBuilder, m: &Palette) {
    b.node("desk");
    let (low, high) = (Vec3::new(0.50, 0.715, 0.13), Vec3::new(2.35, 0.75, 0.93));
    b.cuboid(m.oak, low, high, Sides::ALL);
    // Frames of steel: two legs with a bar between them at either end.
    let end = Sides::without(&[Sides::TOP, Sides::BOTTOM]);
    for x in [low.x + 0.06, high.x - 0.10] {
        for z in [low.z + 0.06, high.z - 0.10] {
            b.cuboid(
                m.black,
                Vec3::new(x, 0.0, z),
                Vec3::new(x + 0.04, low.y, z + 0.04),
                end,
            );
        }
        let bar = (
            Vec3::new(x + 0.005, 0.62, low.z + 0.10),
            Vec3::new(x + 0.035, 0.66, high.z - 0.10),
        );
        b.cuboid(
            m.black,
            bar.0,
            bar.1,
            Sides::without(&[Sides::BACK, Sides::FRONT]),
        );
    }

    b.node("drawers");
    let (low, high) = (Vec3::new(1.80, 0.04, 0.25), Vec3::new(2.20, 0.66, 0.80));
    b.cuboid(m.white, low, high, Sides::ALL);
    for x in [low.x + 0.04, high.x - 0.04] {
        for z in [low.z + 0.05, high.z - 0.05] {
            b.cylinder(
                m.black,
                Vec3::new(x, 0.0, z),
                0.022,
                low.y,
                8,
                [false, false],
            );
        }
    }
    for (from, to) in [(0.05, 0.24), (0.25, 0.44), (0.45, 0.65)] {
        let front = (
            Vec3::new(low.x + 0.008, from, high.z + 0.002),
            Vec3::new(high.x - 0.008, to, high.z + 0.018),
        );
        b.cuboid(m.white, front.0, front.1, Sides::ALL);
        let (y, z) = (to - 0.035, front.1.z);
        b.cuboid(
            m.brass,
            Vec3::new(1.93, y, z),
            Vec3::new(2.07, y + 0.012, z + 0.016),
            Sides::without(&[Sides::BACK]),
        );
    }
}

/// Two bays of five rows: books, and things between them.
fn shelf(b: &mut SceneBuilder, m: &Palette) {
    let (low, high, board) = (
        Vec3::new(3.10, 0.0, 0.016),
        Vec3::new(5.26, 2.12, 0.34),
        0.025,
    );
    b.node("shelf");
    let inner = Sides::only(&[Sides::LEFT, Sides::RIGHT, Sides::FRONT]);
    b.cuboid(
        m.oak,
        low,
        Vec3::new(low.x + board, high.y - board, high.z),
        inner,
    );
    b.cuboid(
        m.oak,
        Vec3::new(high.x - board, 0.0, low.z),
        Vec3::new(high.x, high.y - board, high.z),
        inner,
    );
    b.cuboid(
        m.oak,
        Vec3::new(low.x, high.y - board, low.z),
        high,
        Sides::without(&[Sides::BACK]),
    );
    let middle = (low.x + high.x) * 0.5;
    let plinth = 0.08;
    let rows = 5;
    let pitch = (high.y - board - plinth) / rows as f32;
    let bays = [
        (low.x + board, middle - board * 0.5),
        (middle + board * 0.5, high.x - board),
    ];
    b.cuboid(
        m.oak,
        Vec3::new(middle - board * 0.5, plinth + board, low.z),
        Vec3::new(middle + board * 0.5, high.y - board, high.z - 0.004),
        inner,
    );
    b.cuboid(
        m.oak,
        Vec3::new(low.x + board, 0.0, low.z),
        Vec3::new(high.x - board, plinth, high.z - 0.03),
        Sides::only(&[Sides::FRONT]),
    );
    b.cuboid(
        m.oak,
        Vec3::new(low.x + board, plinth, low.z),
        Vec3::new(high.x - board, plinth + board, high.z - 0.006),
        Sides::without(&[Sides::BACK, Sides::LEFT, Sides::RIGHT]),
    );
    for (from, to) in bays {
        for row in 1..rows {
            let y = plinth + row as f32 * pitch;
            let ends = Sides::without(&[Sides::BACK, Sides::LEFT, Sides::RIGHT]);
            b.cuboid(
                m.oak,
                Vec3::new(from, y, low.z),
                Vec3::new(to, y + board, high.z - 0.006),
                ends,
            );
        }
        let corner = |x: f32, y: f32| Vec3::new(x, y, low.z + 0.006);
        let (bottom, top) = (plinth + board, high.y - board);
        b.quad(
            m.walnut,
            [
                corner(from, bottom),
                corner(to, bottom),
                corner(to, top),
                corner(from, top),
            ],
        );
    }

    b.node("books");
    for (bay, (from, to)) in (0_i32..).zip(bays) {
        for row in 0..rows {
            let foot = Vec3::new(
                from + 0.012,
                plinth + board + row as f32 * pitch,
                low.z + 0.03,
            );
            let seed = bay * 8 + row;
            // Free places for the things that `objects` puts here.
            let (start, end) = match seed {
                1 => (0.0, 0.60),
                2 => (0.36, 1.0),
                4 => (0.0, 0.70),
                8 => (0.0, 0.55),
                11 => (0.30, 1.0),
                12 => (0.42, 1.0),
                _ => (0.0, 1.0),
            };
            let length = to - from - 0.024;
            row_of_books(
                b,
                m,
                foot + Vec3::X * (start * length),
                (end - start) * length,
                seed,
            );
        }
    }
}

/// Books side by side on `foot`, over a length; the last one leans.
fn row_of_books(b: &mut SceneBuilder, m: &Palette, foot: Vec3, length: f32, seed: i32) {
    let mut x = 0.0;
    for i in 0.. {
        let random = |what: u32| hash(i, seed, 400 + what);
        let (width, height, depth) = (
            0.018 + 0.032 * random(0),
            0.21 + 0.10 * random(1),
            0.16 + 0.05 * random(2),
        );
        let leans = x + width + 0.10 > length;
        if leans && x + width + 0.075 > length {
            return;
        }
        // Colours come in short runs, as series do.
        let cover = m.books[(i / 3 + seed) as usize % m.books.len()];
        let cover = if random(3) < 0.5 {
            cover
        } else {
            m.books[pick(random(4), m.books.len())]
        };
        let angle = if leans { 0.2 } else { 0.0 };
        let lift = foot + Vec3::X * x;
        b.part(
            Affine3A::from_rotation_translation(
                Quat::from_rotation_z(angle),
                lift + Vec3::X * (height * angle),
            ),
            |b| {
                book(b, m, cover, Vec3::new(width, height, depth));
            },
        );
        x += width + 0.0015;
        if leans {
            return;
        }
    }
}

/// A standing book with its back to the front.
fn book(b: &mut SceneBuilder, m: &Palette, cover: usize, size: Vec3) {
    let side = Sides::only(&[Sides::LEFT, Sides::RIGHT]);
    b.cuboid(cover, Vec3::ZERO, size, side);
    let front = |x: f32, y: f32| Vec3::new(x, y, size.z);
    b.picture(
        cover,
        [
            front(0.0, 0.0),
            front(size.x, 0.0),
            front(size.x, size.y),
            front(0.0, size.y),
        ],
    );
    b.cuboid(m.paper, Vec3::ZERO, size, Sides::only(&[Sides::TOP]));
}

/// The index that a random number in [0, 1) picks.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a number in 0..count"
)]
fn pick(random: f32, count: usize) -> usize {
    ((random * count as f32) as usize).min(count - 1)
}

fn sideboard(b: &mut SceneBuilder, m: &Palette) {
    b.node("sideboard");
    let (low, high) = (Vec3::new(5.52, 0.16, 0.95), Vec3::new(5.97, 0.74, 2.65));
    b.cuboid(m.walnut, low, high, Sides::ALL);
    for z in [0.0, 1.0, 2.0] {
        let from = low.z + 0.015 + z * 0.5633;
        let door = (
            Vec3::new(low.x - 0.016, low.y + 0.02, from),
            Vec3::new(low.x - 0.002, high.y - 0.03, from + 0.5433),
        );
        b.cuboid(
            if z == 1.0 { m.white } else { m.walnut },
            door.0,
            door.1,
            Sides::ALL,
        );
        let knob = Vec3::new(
            door.0.x,
            0.5,
            if z == 0.0 { from + 0.50 } else { from + 0.045 },
        );
        b.part(
            Affine3A::from_rotation_translation(
                Quat::from_rotation_z(std::f32::consts::FRAC_PI_2),
                knob,
            ),
            |b| {
                b.lathe(
                    m.brass,
                    &[
                        (0.006, 0.0),
                        (0.006, 0.012),
                        (0.013, 0.018),
                        (0.011, 0.026),
                        (0.0, 0.028),
                    ],
                    10,
                );
            },
        );
    }
    for x in [low.x + 0.05, high.x - 0.05] {
        for z in [low.z + 0.12, high.z - 0.12] {
            b.part(Affine3A::from_translation(Vec3::new(x, 0.0, z)), |b| {
                b.lathe(m.oak, &[(0.013, 0.0), (0.024, low.y)], 10);
            });
        }
    }
}

fn coffee_table(b: &mut SceneBuilder, m: &Palette) {
    b.node_at(
        "coffee table",
        Affine3A::from_translation(Vec3::new(2.8, 0.012, 2.62)),
    );
    let top = [
        (0.0, 0.375),
        (0.40, 0.375),
        (0.40, 0.375),
        (0.425, 0.395),
        (0.425, 0.405),
        (0.42, 0.41),
        (0.42, 0.41),
        (0.0, 0.41),
    ];
    b.lathe(m.walnut, &top, 32);
    for i in 0..3 {
        let (sin, cos) = (0.5 + std::f32::consts::TAU * i as f32 / 3.0).sin_cos();
        let out = Vec3::new(cos, 0.0, sin);
        b.tube(
            m.walnut,
            &[out * 0.34 + Vec3::Y * 0.006, out * 0.24 + Vec3::Y * 0.376],
            0.017,
            10,
        );
    }
    b.lathe(
        m.brass,
        &[
            (0.275, 0.155),
            (0.285, 0.155),
            (0.285, 0.165),
            (0.275, 0.165),
            (0.275, 0.155),
        ],
        24,
    );
}

fn pictures(b: &mut SceneBuilder, m: &Palette) {
    use std::f32::consts::{FRAC_PI_2, PI};
    let wall = |x: f32, y: f32, z: f32, turn: f32| {
        Affine3A::from_rotation_translation(Quat::from_rotation_y(turn), Vec3::new(x, y, z))
    };
    b.node_at("picture hills", wall(ROOM.x, 1.62, 1.8, -FRAC_PI_2));
    framed(b, m.black, m.hills, Vec2::new(0.96, 0.72));
    b.node_at("picture arches", wall(0.84, 1.66, 0.0, 0.0));
    framed(b, m.oak, m.arches, Vec2::new(0.48, 0.64));
    b.node_at("picture fields", wall(2.75, 1.66, ROOM.z, PI));
    framed(b, m.oak, m.fields, Vec2::new(1.5, 0.9));
    b.node_at("picture small hills", wall(2.08, 1.72, 0.0, 0.0));
    framed(b, m.black, m.hills, Vec2::new(0.48, 0.36));
}

/// A picture around the origin, facing +z, with a frame of 2 cm.
fn framed(b: &mut SceneBuilder, frame: usize, picture: usize, size: Vec2) {
    let (half, bar, deep) = (size * 0.5, 0.022, 0.028);
    let corner = |x: f32, y: f32| Vec3::new(x, y, 0.012);
    b.picture(
        picture,
        [
            corner(-half.x, -half.y),
            corner(half.x, -half.y),
            corner(half.x, half.y),
            corner(-half.x, half.y),
        ],
    );
    let outer = half + bar;
    for x in [-outer.x, half.x] {
        let sides = Sides::without(&[Sides::BACK]);
        b.cuboid(
            frame,
            Vec3::new(x, -outer.y, 0.0),
            Vec3::new(x + bar, outer.y, deep),
            sides,
        );
    }
    for y in [-outer.y, half.y] {
        let sides = Sides::without(&[Sides::BACK, Sides::LEFT, Sides::RIGHT]);
        b.cuboid(
            frame,
            Vec3::new(-half.x, y, 0.0),
            Vec3::new(half.x, y + bar, deep),
            sides,
        );
    }
}
