//! What lies and stands about: lamps, monitor, keyboard, vases, paper.

use super::super::build::{SceneBuilder, Sides};
use super::palette::Palette;
use glam::{Affine3A, Quat, Vec3};
use std::f32::consts::{FRAC_PI_2, PI, TAU};

/// Height of the desk's top.
const DESK: f32 = 0.75;

pub(super) fn draw(b: &mut SceneBuilder, m: &Palette) {
    monitor(b, m);
    keyboard(b, m);
    desk_lamp(b, m);
    desk_things(b, m);
    wastebasket(b, m);
    floor_lamp(b, m);
    table_lamp(b, m);
    on_the_sideboard(b, m);
    on_the_table(b, m);
    on_the_shelf(b, m);
}

fn at(x: f32, y: f32, z: f32) -> Affine3A {
    Affine3A::from_translation(Vec3::new(x, y, z))
}

fn turned(x: f32, y: f32, z: f32, turn: f32) -> Affine3A {
    Affine3A::from_rotation_translation(Quat::from_rotation_y(turn), Vec3::new(x, y, z))
}

fn monitor(b: &mut SceneBuilder, m: &Palette) {
    b.node_at("monitor", turned(1.36, DESK, 0.34, 0.06));
    let (half, low, high) = (0.345, 0.13, 0.53);
    b.rounded(
        m.black,
        Vec3::new(-half, low, -0.014),
        Vec3::new(half, high, 0.014),
        0.008,
        1,
    );
    let screen = |x: f32, y: f32| Vec3::new(x, y, 0.0155);
    let (x, bottom, top) = (half - 0.014, low + 0.018, high - 0.012);
    b.picture(
        m.screen,
        [
            screen(-x, bottom),
            screen(x, bottom),
            screen(x, top),
            screen(-x, top),
        ],
    );
    b.cuboid(
        m.steel,
        Vec3::new(-0.03, 0.008, -0.045),
        Vec3::new(0.03, 0.36, -0.022),
        Sides::without(&[Sides::BOTTOM]),
    );
    b.cuboid(
        m.steel,
        Vec3::new(-0.03, 0.25, -0.022),
        Vec3::new(0.03, 0.33, -0.014),
        Sides::without(&[Sides::BACK, Sides::FRONT]),
    );
    b.part(at(0.0, 0.0, -0.02), |b| {
        b.lathe(
            m.steel,
            &[
                (0.115, 0.0),
                (0.115, 0.006),
                (0.11, 0.008),
                (0.11, 0.008),
                (0.0, 0.008),
            ],
            22,
        );
    });
}

fn keyboard(b: &mut SceneBuilder, m: &Palette) {
    b.node("desk mat");
    b.cuboid(
        m.leather,
        Vec3::new(0.98, DESK, 0.55),
        Vec3::new(1.76, DESK + 0.003, 0.89),
        Sides::without(&[Sides::BOTTOM]),
    );
    b.node_at("keyboard", turned(1.30, DESK + 0.003, 0.70, 0.03));
    b.cuboid(
        m.steel,
        Vec3::new(-0.20, 0.0, -0.068),
        Vec3::new(0.20, 0.012, 0.068),
        Sides::without(&[Sides::BOTTOM]),
    );
    let key = Sides::without(&[Sides::BOTTOM]);
    for row in 0..4 {
        let z = -0.058 + 0.0245 * row as f32;
        for column in 0..14 {
            let x = -0.190 + 0.0273 * column as f32;
            b.cuboid(
                m.ceramic,
                Vec3::new(x, 0.012, z),
                Vec3::new(x + 0.0243, 0.018, z + 0.0215),
                key,
            );
        }
    }
    for (from, to) in [(-0.190, -0.112), (-0.108, 0.082), (0.086, 0.189)] {
        b.cuboid(
            m.ceramic,
            Vec3::new(from, 0.012, 0.040),
            Vec3::new(to, 0.018, 0.0615),
            key,
        );
    }
    b.node_at("mouse", turned(1.62, DESK + 0.003, 0.72, -0.1));
    let dome = [
        (1.0, 0.0),
        (1.0, 0.35),
        (0.93, 0.6),
        (0.75, 0.82),
        (0.45, 0.95),
        (0.0, 1.0),
    ];
    b.part(Affine3A::from_scale(Vec3::new(0.031, 0.034, 0.054)), |b| {
        b.lathe(m.ceramic, &dome, 16);
    });
}

fn desk_lamp(b: &mut SceneBuilder, m: &Palette) {
    b.node_at("desk lamp", turned(0.72, DESK, 0.36, -0.55));
    b.lathe(
        m.brass,
        &[
            (0.095, 0.0),
            (0.095, 0.014),
            (0.088, 0.02),
            (0.088, 0.02),
            (0.02, 0.024),
            (0.0, 0.024),
        ],
        18,
    );
    let (hip, elbow, head) = (
        Vec3::new(0.0, 0.022, 0.0),
        Vec3::new(-0.10, 0.34, 0.0),
        Vec3::new(0.24, 0.49, 0.0),
    );
    b.tube(m.brass, &[hip, elbow], 0.008, 8);
    b.tube(m.brass, &[elbow, head], 0.008, 8);
    b.sphere(m.black, elbow, 0.017, 10);
    // The shade hangs along its own -y; outside, rim and inside are one profile.
    b.part(
        Affine3A::from_rotation_translation(Quat::from_rotation_z(0.35), head),
        |b| {
            b.lathe(
                m.teal,
                &[
                    (0.082, -0.10),
                    (0.075, -0.075),
                    (0.040, 0.0),
                    (0.026, 0.03),
                    (0.0, 0.032),
                ],
                18,
            );
            b.lathe(
                m.white,
                &[
                    (0.0, -0.02),
                    (0.036, -0.02),
                    (0.072, -0.075),
                    (0.080, -0.10),
                    (0.080, -0.10),
                    (0.082, -0.10),
                ],
                18,
            );
            b.sphere(m.bulb, Vec3::new(0.0, -0.056, 0.0), 0.03, 12);
        },
    );
}

fn desk_things(b: &mut SceneBuilder, m: &Palette) {
    b.node_at("mug", turned(1.86, DESK, 0.55, 0.7));
    let profile = [
        (0.0, 0.0),
        (0.037, 0.0),
        (0.040, 0.004),
        (0.040, 0.092),
        (0.0365, 0.092),
        (0.0365, 0.012),
        (0.0365, 0.012),
        (0.0, 0.012),
    ];
    b.lathe(m.mustard, &profile, 20);
    let ear: Vec<Vec3> = (0..=8)
        .map(|i| {
            let (sin, cos) = (PI * (i as f32 / 8.0 - 0.5)).sin_cos();
            Vec3::new(0.039 + 0.026 * cos, 0.047 + 0.028 * sin, 0.0)
        })
        .collect();
    b.tube(m.mustard, &ear, 0.0045, 6);

    b.node_at("pencil pot", at(2.10, DESK, 0.30));
    b.lathe(
        m.walnut,
        &[
            (0.0, 0.0),
            (0.038, 0.0),
            (0.038, 0.0),
            (0.038, 0.10),
            (0.038, 0.10),
            (0.034, 0.10),
            (0.034, 0.10),
            (0.034, 0.01),
            (0.034, 0.01),
            (0.0, 0.01),
        ],
        18,
    );
    for (i, material) in [m.mustard, m.leather, m.black, m.teal, m.ceramic]
        .into_iter()
        .enumerate()
    {
        let (sin, cos) = (TAU * i as f32 / 5.0).sin_cos();
        let foot = Vec3::new(-0.018 * cos, 0.012, -0.018 * sin);
        let tip = Vec3::new(0.036 * cos, 0.165 + 0.012 * sin, 0.036 * sin);
        b.tube(material, &[foot, tip], 0.0038, 6);
    }

    b.node_at("papers", turned(2.12, DESK, 0.66, 0.22));
    b.cuboid(
        m.paper,
        Vec3::new(-0.105, 0.0, -0.148),
        Vec3::new(0.105, 0.012, 0.148),
        Sides::without(&[Sides::BOTTOM]),
    );
    b.part(turned(0.01, 0.0125, 0.01, -0.2), |b| {
        b.cuboid(
            m.felt,
            Vec3::new(-0.075, 0.0, -0.105),
            Vec3::new(0.075, 0.016, 0.105),
            Sides::ALL,
        );
        b.tube(
            m.brass,
            &[
                Vec3::new(-0.04, 0.0205, 0.06),
                Vec3::new(0.05, 0.0205, -0.05),
            ],
            0.0042,
            8,
        );
    });
}

fn wastebasket(b: &mut SceneBuilder, m: &Palette) {
    b.node_at("wastebasket", at(2.56, 0.0, 0.86));
    let profile = [
        (0.0, 0.002),
        (0.105, 0.002),
        (0.105, 0.002),
        (0.135, 0.31),
        (0.139, 0.315),
        (0.135, 0.319),
        (0.131, 0.312),
        (0.101, 0.012),
        (0.101, 0.012),
        (0.0, 0.012),
    ];
    b.lathe(m.teal, &profile, 22);
    for (x, y, z, radius) in [
        (0.02, 0.06, 0.03, 0.045),
        (-0.045, 0.075, -0.02, 0.04),
        (0.02, 0.10, -0.04, 0.038),
    ] {
        b.sphere(m.paper, Vec3::new(x, y, z), radius, 7);
    }
}

fn floor_lamp(b: &mut SceneBuilder, m: &Palette) {
    b.node_at("floor lamp", at(4.28, 0.0, 4.22));
    b.lathe(
        m.brass,
        &[
            (0.15, 0.0),
            (0.15, 0.018),
            (0.145, 0.024),
            (0.145, 0.024),
            (0.03, 0.03),
            (0.012, 0.05),
            (0.012, 0.05),
            (0.011, 1.40),
        ],
        18,
    );
    drum(b, m, 1.30, 0.17, 0.21, 0.28);
}

fn table_lamp(b: &mut SceneBuilder, m: &Palette) {
    b.node_at("table lamp", at(5.75, 0.74, 1.22));
    let body = [
        (0.0, 0.0),
        (0.06, 0.0),
        (0.075, 0.02),
        (0.092, 0.07),
        (0.092, 0.11),
        (0.070, 0.17),
        (0.030, 0.22),
        (0.018, 0.24),
        (0.018, 0.30),
    ];
    b.lathe(m.clay, &body, 20);
    drum(b, m, 0.28, 0.10, 0.14, 0.19);
}

/// A glowing lamp shade, wider below, with a lid below and above that the bulb lights from within.
fn drum(b: &mut SceneBuilder, m: &Palette, foot: f32, upper: f32, lower: f32, height: f32) {
    let top = foot + height;
    b.lathe(m.shade, &[(lower, foot), (upper, top)], 22);
    let (inner_low, inner_high) = (lower - 0.004, upper - 0.004);
    b.lathe(
        m.linen,
        &[
            (0.0, foot + 0.02),
            (inner_low, foot + 0.02),
            (inner_low, foot + 0.02),
            (inner_low, foot),
            (inner_low, foot),
            (lower, foot),
        ],
        22,
    );
    b.lathe(
        m.linen,
        &[
            (upper, top),
            (inner_high, top),
            (inner_high, top),
            (inner_high, top - 0.02),
        ],
        22,
    );
    b.lathe(m.shade, &[(inner_high, top - 0.02), (0.0, top - 0.02)], 22);
}

fn on_the_sideboard(b: &mut SceneBuilder, m: &Palette) {
    let top = 0.74;
    b.node_at("vase", at(5.76, top, 2.42));
    let vase = [
        (0.0, 0.0),
        (0.055, 0.0),
        (0.075, 0.03),
        (0.095, 0.10),
        (0.090, 0.16),
        (0.055, 0.23),
        (0.032, 0.27),
        (0.034, 0.31),
        (0.046, 0.335),
        (0.042, 0.335),
        (0.030, 0.31),
        (0.0, 0.27),
    ];
    b.lathe(m.ceramic, &vase, 20);
    b.node_at("bowl", at(5.74, top, 1.98));
    let bowl = [
        (0.0, 0.006),
        (0.05, 0.0),
        (0.05, 0.0),
        (0.10, 0.03),
        (0.135, 0.075),
        (0.131, 0.077),
        (0.096, 0.037),
        (0.05, 0.014),
        (0.0, 0.012),
    ];
    b.lathe(m.walnut, &bowl, 22);
    for (x, z, lift, material) in [
        (0.035, 0.02, 0.052, m.clay),
        (-0.04, 0.025, 0.052, m.mustard),
        (0.0, -0.045, 0.052, m.clay),
        (-0.005, 0.0, 0.10, m.mustard),
    ] {
        b.sphere(material, Vec3::new(x, lift, z), 0.036, 10);
    }
    b.node_at("sideboard books", turned(5.75, top, 1.60, 0.12));
    pile(b, m, &[(0, 0.30, 0.21), (3, 0.27, 0.20), (1, 0.25, 0.18)]);
}

/// Books that lie on each other: cover, length along z, width along x.
fn pile(b: &mut SceneBuilder, m: &Palette, books: &[(usize, f32, f32)]) {
    let mut y = 0.0;
    for (i, &(cover, length, width)) in books.iter().enumerate() {
        let (thick, turn) = (0.028, 0.13 * (i as f32 * 2.4).sin());
        b.part(turned(0.0, y, 0.0, turn), |b| {
            let half = Vec3::new(width, 0.0, length) * 0.5;
            let (low, high) = (-half, half + Vec3::Y * thick);
            b.cuboid(
                m.books[cover],
                low,
                high,
                Sides::only(&[Sides::TOP, Sides::LEFT]),
            );
            b.cuboid(
                m.paper,
                low,
                high,
                Sides::only(&[Sides::RIGHT, Sides::BACK, Sides::FRONT]),
            );
        });
        y += thick + 0.0005;
    }
}

fn on_the_table(b: &mut SceneBuilder, m: &Palette) {
    let top = 0.422;
    b.node_at("table books", turned(2.62, top, 2.70, 0.6));
    pile(b, m, &[(2, 0.30, 0.23), (4, 0.25, 0.19)]);
    b.node_at("tray", at(2.98, top, 2.50));
    b.lathe(
        m.brass,
        &[
            (0.0, 0.003),
            (0.12, 0.0),
            (0.13, 0.012),
            (0.127, 0.013),
            (0.118, 0.006),
            (0.0, 0.006),
        ],
        22,
    );
    b.node_at("teapot", turned(2.95, top + 0.006, 2.47, 0.4));
    let body = [
        (0.0, 0.0),
        (0.042, 0.0),
        (0.056, 0.018),
        (0.062, 0.045),
        (0.054, 0.075),
        (0.034, 0.092),
        (0.034, 0.092),
        (0.026, 0.100),
        (0.010, 0.104),
        (0.010, 0.110),
        (0.0, 0.116),
    ];
    b.lathe(m.clay, &body, 22);
    b.tube(
        m.clay,
        &[
            Vec3::new(0.052, 0.035, 0.0),
            Vec3::new(0.08, 0.055, 0.0),
            Vec3::new(0.098, 0.088, 0.0),
        ],
        0.009,
        8,
    );
    let handle: Vec<Vec3> = (0..=8)
        .map(|i| {
            let (sin, cos) = (PI * i as f32 / 8.0).sin_cos();
            Vec3::new(0.048 * cos, 0.085 + 0.075 * sin, 0.0)
        })
        .collect();
    b.tube(m.brass, &handle, 0.004, 6);
    b.node_at("cup", at(3.045, top + 0.006, 2.535));
    b.lathe(
        m.ceramic,
        &[
            (0.0, 0.0),
            (0.022, 0.0),
            (0.034, 0.03),
            (0.036, 0.05),
            (0.034, 0.05),
            (0.031, 0.03),
            (0.02, 0.008),
            (0.0, 0.007),
        ],
        18,
    );
}

fn on_the_shelf(b: &mut SceneBuilder, m: &Palette) {
    // Boards of the shelf: see `furniture`.
    let board = |row: f32| 0.08 + 0.025 + row * (2.12 - 0.025 - 0.08) / 5.0;
    b.node_at("shelf vase", at(3.98, board(1.0), 0.18));
    b.lathe(
        m.clay,
        &[
            (0.0, 0.0),
            (0.05, 0.0),
            (0.078, 0.05),
            (0.08, 0.10),
            (0.05, 0.17),
            (0.026, 0.21),
            (0.034, 0.24),
            (0.03, 0.24),
            (0.022, 0.21),
            (0.0, 0.19),
        ],
        22,
    );
    b.node_at("globe", at(3.28, board(2.0), 0.18));
    b.lathe(
        m.brass,
        &[
            (0.0, 0.0),
            (0.06, 0.0),
            (0.055, 0.012),
            (0.012, 0.02),
            (0.010, 0.06),
        ],
        18,
    );
    b.sphere(m.teal, Vec3::Y * 0.16, 0.10, 16);
    let ring: Vec<Vec3> = (0..=8)
        .map(|i| {
            let (sin, cos) = (-FRAC_PI_2 + PI * i as f32 / 8.0).sin_cos();
            Vec3::new(0.115 * cos, 0.16 + 0.115 * sin, 0.0)
        })
        .collect();
    b.tube(m.brass, &ring, 0.004, 6);
    b.node_at("shelf box", at(3.88, board(4.0), 0.17));
    b.cuboid(
        m.mustard,
        Vec3::new(-0.10, 0.0, -0.12),
        Vec3::new(0.22, 0.13, 0.12),
        Sides::without(&[Sides::BOTTOM]),
    );
    b.cuboid(
        m.mustard,
        Vec3::new(-0.105, 0.1315, -0.125),
        Vec3::new(0.225, 0.165, 0.125),
        Sides::ALL,
    );
    b.node_at("shelf books", turned(4.98, board(0.0), 0.18, FRAC_PI_2));
    pile(
        b,
        m,
        &[
            (5, 0.26, 0.20),
            (6, 0.25, 0.19),
            (7, 0.24, 0.18),
            (0, 0.22, 0.17),
        ],
    );
    b.node_at("shelf bowl", at(4.34, board(3.0), 0.18));
    b.lathe(
        m.ceramic,
        &[
            (0.0, 0.0),
            (0.04, 0.0),
            (0.09, 0.05),
            (0.115, 0.10),
            (0.111, 0.10),
            (0.086, 0.055),
            (0.04, 0.012),
            (0.0, 0.01),
        ],
        18,
    );
    b.node_at(
        "shelf picture",
        Affine3A::from_rotation_translation(
            Quat::from_rotation_x(-0.12),
            Vec3::new(4.40, board(4.0), 0.14),
        ),
    );
    b.cuboid(
        m.black,
        Vec3::new(-0.11, 0.0, 0.0),
        Vec3::new(0.11, 0.29, 0.014),
        Sides::ALL,
    );
    let corner = |x: f32, y: f32| Vec3::new(x, y, 0.0155);
    b.picture(
        m.arches,
        [
            corner(-0.098, 0.012),
            corner(0.098, 0.012),
            corner(0.098, 0.278),
            corner(-0.098, 0.278),
        ],
    );
}
