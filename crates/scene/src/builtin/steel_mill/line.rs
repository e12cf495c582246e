//! The rolling line: rollers, the glowing strip, stands and their motors.

use super::super::build::{SceneBuilder, Sides};
use super::{LINE, Palette};
use core::f32::consts::FRAC_PI_2;
use glam::{Affine3A, Quat, Vec3};

/// A table of rollers, and the strip on it.
pub(super) fn line(b: &mut SceneBuilder, m: &Palette) {
    let (middle, height, half) = LINE;
    let radius = 0.17;
    b.node("roller-table");
    for side in [-1.0, 1.0] {
        let z = middle + side * (half + 0.2);
        let (low, high) = (z - 0.15, z + 0.15);
        b.cuboid(
            m.machine,
            Vec3::new(8.0, 0.0, low),
            Vec3::new(57.0, height - radius - 0.05, high),
            Sides::without(&[Sides::BOTTOM]),
        );
    }
    let upright = Quat::from_rotation_x(FRAC_PI_2);
    for i in 0..94 {
        let x = 8.5 + 0.51 * i as f32;
        let place = Vec3::new(x, height - radius, middle - half - 0.02);
        b.part(Affine3A::from_rotation_translation(upright, place), |b| {
            b.lathe(
                m.roll,
                &[
                    (0.0, 0.0),
                    (0.07, 0.0),
                    (0.07, 0.0),
                    (0.07, 0.1),
                    (0.07, 0.1),
                    (radius, 0.1),
                    (radius, 0.1),
                    (radius, 2.0 * half - 0.06),
                    (radius, 2.0 * half - 0.06),
                    (0.0, 2.0 * half - 0.06),
                ],
                14,
            );
        });
    }
    b.node("strip");
    let top = height + 0.012;
    for (from, to, thick) in [
        (12.0, 24.8, 0.16),
        (26.4, 32.3, 0.10),
        (33.9, 39.8, 0.06),
        (41.4, 53.0, 0.035),
    ] {
        b.cuboid(
            m.strip,
            Vec3::new(from, top, middle - 0.55),
            Vec3::new(to, top + thick, middle + 0.55),
            Sides::ALL,
        );
    }
    b.node("coil");
    let place = Vec3::new(54.6, height + 0.75, middle - 0.55);
    b.part(Affine3A::from_rotation_translation(upright, place), |b| {
        b.lathe(
            m.strip,
            &[
                (0.3, 0.0),
                (0.75, 0.0),
                (0.75, 0.0),
                (0.75, 1.1),
                (0.75, 1.1),
                (0.3, 1.1),
                (0.3, 1.1),
                (0.3, 0.0),
            ],
            40,
        );
    });
}

/// Three stands, each with four rolls between two housings, and a motor beside it.
pub(super) fn stands(b: &mut SceneBuilder, m: &Palette) {
    let (middle, height, half) = LINE;
    for (i, x) in [25.6_f32, 33.1, 40.6].into_iter().enumerate() {
        b.node_at(
            &format!("stand-{}", i + 1),
            Affine3A::from_translation(Vec3::new(x, 0.0, middle)),
        );
        for side in [-1.0_f32, 1.0] {
            let (near, far) = (side * (half + 0.35), side * (half + 0.95));
            let (low, high) = (near.min(far), near.max(far));
            for (from, to) in [(-0.8, -0.35), (0.35, 0.8)] {
                b.cuboid(
                    m.machine,
                    Vec3::new(from, 0.0, low),
                    Vec3::new(to, 4.2, high),
                    Sides::without(&[Sides::BOTTOM]),
                );
            }
            b.cuboid(
                m.machine,
                Vec3::new(-0.35, 3.6, low),
                Vec3::new(0.35, 4.2, high),
                Sides::without(&[Sides::LEFT, Sides::RIGHT]),
            );
            b.cylinder(
                m.roll,
                Vec3::new(0.0, 2.75, 0.5 * (low + high)),
                0.16,
                0.85,
                16,
                [true, false],
            );
        }
        let upright = Quat::from_rotation_x(FRAC_PI_2);
        for (y, radius) in [
            (height - 0.32, 0.26),
            (height + 0.44, 0.26),
            (height - 0.0 + 1.22, 0.46),
        ] {
            b.part(
                Affine3A::from_rotation_translation(upright, Vec3::new(0.0, y, -half - 0.3)),
                |b| {
                    b.lathe(
                        m.roll,
                        &[
                            (0.0, 0.0),
                            (radius, 0.0),
                            (radius, 0.0),
                            (radius, 2.0 * half + 0.6),
                            (radius, 2.0 * half + 0.6),
                            (0.0, 2.0 * half + 0.6),
                        ],
                        28,
                    );
                },
            );
        }
        b.cuboid(
            m.machine,
            Vec3::new(-1.0, 4.2, -half - 1.05),
            Vec3::new(1.0, 4.55, half + 1.05),
            Sides::ALL,
        );
        motor(b, m, -half - 2.7);
    }
}

pub(super) fn motor(b: &mut SceneBuilder, m: &Palette, z: f32) {
    b.cuboid(
        m.crane,
        Vec3::new(-0.8, 0.0, z - 0.7),
        Vec3::new(0.8, 0.45, z + 0.7),
        Sides::without(&[Sides::BOTTOM]),
    );
    let lying = Quat::from_rotation_x(FRAC_PI_2);
    b.part(
        Affine3A::from_rotation_translation(lying, Vec3::new(0.0, 1.15, z - 0.75)),
        |b| {
            let mut profile = vec![(0.0, 0.0), (0.5, 0.0), (0.5, 0.0)];
            for rib in 0..7 {
                let y = 0.1 + 0.2 * rib as f32;
                profile.extend([
                    (0.62, y),
                    (0.62, y),
                    (0.70, y),
                    (0.70, y),
                    (0.70, y + 0.06),
                    (0.70, y + 0.06),
                    (0.62, y + 0.06),
                    (0.62, y + 0.06),
                ]);
            }
            profile.extend([
                (0.5, 1.5),
                (0.5, 1.5),
                (0.12, 1.5),
                (0.12, 1.5),
                (0.12, 2.1),
                (0.12, 2.1),
                (0.0, 2.1),
            ]);
            b.lathe(m.machine, &profile, 24);
        },
    );
}
