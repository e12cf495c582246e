//! Pipes with their valves, the gangway with its stairs.

use super::super::build::{SceneBuilder, Sides};
use super::hall::bar;
use super::{HALL, Palette};
use core::f32::consts::{FRAC_PI_2, TAU};
use glam::{Affine3A, Quat, Vec3};

/// Pipes along the northern wall, with flanges, bends and valves.
pub(super) fn pipes(b: &mut SceneBuilder, m: &Palette) {
    for i in 0..9 {
        b.node(&format!("pipe-{}", i + 1));
        let radius = 0.09 + 0.025 * ((i * 5) % 4) as f32;
        let (y, z) = (4.0 + 0.62 * i as f32, HALL.z - 1.05 - 0.12 * (i % 3) as f32);
        let drop = 8.0 + 5.3 * i as f32;
        let material = if i % 3 == 1 { m.hot_pipe } else { m.pipe };
        let mut path = vec![Vec3::new(0.4, y, z), Vec3::new(drop - 0.5, y, z)];
        for k in 0..=6 {
            let (sin, cos) = (FRAC_PI_2 * k as f32 / 6.0).sin_cos();
            path.push(Vec3::new(drop - 0.5 + 0.5 * sin, y - 0.5 + 0.5 * cos, z));
        }
        path.push(Vec3::new(drop, 0.0, z));
        b.tube(material, &path, radius, 16);
        for k in (1..20).take_while(|&k| 3.0 * (k + 1) as f32 <= drop) {
            let across = Quat::from_rotation_z(-FRAC_PI_2);
            let place = Vec3::new(3.0 * k as f32 + 0.17 * i as f32, y, z);
            b.part(Affine3A::from_rotation_translation(across, place), |b| {
                b.lathe(
                    material,
                    &[
                        (radius, 0.0),
                        (radius * 1.5, 0.0),
                        (radius * 1.5, 0.0),
                        (radius * 1.5, 0.07),
                        (radius * 1.5, 0.07),
                        (radius, 0.07),
                    ],
                    16,
                );
            });
        }
        valve(b, m, Vec3::new(drop, 1.3, z), radius);
    }
}

pub(super) fn valve(b: &mut SceneBuilder, m: &Palette, place: Vec3, radius: f32) {
    let outward = Quat::from_rotation_x(-FRAC_PI_2);
    b.part(Affine3A::from_rotation_translation(outward, place), |b| {
        b.lathe(
            m.pipe,
            &[
                (radius * 0.6, radius),
                (0.03, radius + 0.05),
                (0.03, radius + 0.3),
                (0.03, radius + 0.3),
                (0.0, radius + 0.3),
            ],
            12,
        );
        let wheel: Vec<Vec3> = (0..=16)
            .map(|i| {
                let (sin, cos) = (TAU * (i % 16) as f32 / 16.0).sin_cos();
                Vec3::new(0.17 * cos, radius + 0.26, 0.17 * sin)
            })
            .collect();
        b.tube(m.hot_pipe, &wheel, 0.016, 6);
        for k in 0..4 {
            let (sin, cos) = (TAU * k as f32 / 4.0).sin_cos();
            bar(
                b,
                m.hot_pipe,
                Vec3::new(0.03 * cos, radius + 0.26, 0.03 * sin),
                Vec3::new(0.16 * cos, radius + 0.26, 0.16 * sin),
                0.02,
            );
        }
    });
}

/// A gangway along the line with its grating, railings and stairs.
pub(super) fn walkway(b: &mut SceneBuilder, m: &Palette) {
    let (from, to, y, near, far) = (20.0, 50.0, 4.6, 9.7, 11.0);
    b.node("grating");
    for i in 0..150 {
        let x = from + (to - from) * (i as f32 + 0.5) / 150.0;
        b.cuboid(
            m.steel,
            Vec3::new(x - 0.02, y - 0.05, near),
            Vec3::new(x + 0.02, y, far),
            Sides::without(&[Sides::BACK, Sides::FRONT]),
        );
    }
    for z in [near - 0.06, far] {
        b.cuboid(
            m.rail,
            Vec3::new(from, y - 0.18, z),
            Vec3::new(to, y + 0.04, z + 0.06),
            Sides::ALL,
        );
    }
    b.node("railings");
    for z in [near - 0.03, far + 0.03] {
        for height in [0.55, 1.05] {
            b.tube(
                m.rail,
                &[Vec3::new(from, y + height, z), Vec3::new(to, y + height, z)],
                0.024,
                8,
            );
        }
        for i in 0..=20 {
            let x = from + (to - from) * i as f32 / 20.0;
            b.tube(
                m.rail,
                &[Vec3::new(x, y + 0.04, z), Vec3::new(x, y + 1.04, z)],
                0.022,
                8,
            );
        }
    }
    b.node("legs");
    for i in 0..=6 {
        let x = from + 0.2 + (to - from - 0.4) * i as f32 / 6.0;
        for z in [near + 0.1, far - 0.1] {
            bar(
                b,
                m.steel,
                Vec3::new(x, 0.0, z),
                Vec3::new(x, y - 0.06, z),
                0.14,
            );
        }
    }
    b.node("stairs");
    let steps = 22;
    for i in 0..steps {
        let share = (i as f32 + 1.0) / (steps as f32 + 1.0);
        let (x, height) = (to + 4.6 * (1.0 - share), y * share);
        b.cuboid(
            m.steel,
            Vec3::new(x - 0.13, height - 0.04, near + 0.1),
            Vec3::new(x + 0.13, height, far - 0.1),
            Sides::ALL,
        );
    }
    for z in [near + 0.04, far - 0.04] {
        bar(
            b,
            m.rail,
            Vec3::new(to + 4.6, 0.0, z),
            Vec3::new(to + 0.05, y - 0.05, z),
            0.1,
        );
        b.tube(
            m.rail,
            &[
                Vec3::new(to + 4.6, 1.0, z),
                Vec3::new(to + 0.05, y + 0.95, z),
            ],
            0.024,
            8,
        );
    }
}
