//! The crane with trolley, hook and cabin.

use super::super::build::{SceneBuilder, Sides};
use super::hall::bar;
use super::{HALL, Palette, RAIL};
use core::f32::consts::{FRAC_PI_2, TAU};
use glam::{Affine3A, Quat, Vec3};

/// A bridge of two girders with a trolley, its cabin, ropes and hook.
pub(super) fn crane(b: &mut SceneBuilder, m: &Palette) {
    let x = 29.0;
    b.node("crane");
    let (near, far) = (1.1, HALL.z - 1.1);
    for dx in [-1.3, 1.3] {
        let (low, high) = (
            Vec3::new(x + dx - 0.3, RAIL + 0.55, near),
            Vec3::new(x + dx + 0.3, RAIL + 1.75, far),
        );
        b.cuboid(m.crane, low, high, Sides::ALL);
        for i in 0..24 {
            let z = near + 0.5 + 0.9 * i as f32;
            for face in [low.x - 0.06, high.x] {
                b.cuboid(
                    m.crane,
                    Vec3::new(face, low.y + 0.04, z),
                    Vec3::new(face + 0.06, high.y - 0.04, z + 0.06),
                    Sides::ALL,
                );
            }
        }
    }
    for z in [near, far - 0.7] {
        b.cuboid(
            m.crane,
            Vec3::new(x - 2.6, RAIL + 0.22, z),
            Vec3::new(x + 2.6, RAIL + 0.55, z + 0.7),
            Sides::ALL,
        );
        for dx in [-2.2, -1.4, 1.4, 2.2] {
            let lying = Quat::from_rotation_x(FRAC_PI_2);
            b.part(
                Affine3A::from_rotation_translation(lying, Vec3::new(x + dx, RAIL + 0.3, z + 0.25)),
                |b| {
                    b.lathe(
                        m.rust,
                        &[
                            (0.0, 0.0),
                            (0.22, 0.0),
                            (0.22, 0.0),
                            (0.22, 0.2),
                            (0.22, 0.2),
                            (0.0, 0.2),
                        ],
                        16,
                    );
                },
            );
        }
    }
    let z = 13.0;
    b.node("trolley");
    b.cuboid(
        m.crane,
        Vec3::new(x - 1.7, RAIL + 1.8, z - 1.3),
        Vec3::new(x + 1.7, RAIL + 2.05, z + 1.3),
        Sides::ALL,
    );
    b.cuboid(
        m.machine,
        Vec3::new(x - 0.9, RAIL + 2.05, z - 0.9),
        Vec3::new(x + 0.2, RAIL + 2.75, z + 0.2),
        Sides::without(&[Sides::BOTTOM]),
    );
    let across = Quat::from_rotation_z(-FRAC_PI_2);
    b.part(
        Affine3A::from_rotation_translation(across, Vec3::new(x - 0.7, RAIL + 2.5, z + 0.75)),
        |b| {
            b.lathe(
                m.roll,
                &[
                    (0.0, 0.0),
                    (0.35, 0.0),
                    (0.35, 0.0),
                    (0.35, 1.4),
                    (0.35, 1.4),
                    (0.0, 1.4),
                ],
                24,
            );
        },
    );
    b.node("hook");
    let block = Vec3::new(x, 7.3, z);
    for (dx, dz) in [(-0.2, -0.2), (-0.2, 0.2), (0.2, -0.2), (0.2, 0.2)] {
        b.tube(
            m.roll,
            &[
                block + Vec3::new(dx, 0.35, dz),
                Vec3::new(x + dx, RAIL + 1.8, z + dz),
            ],
            0.02,
            6,
        );
    }
    b.rounded(
        m.crane,
        block - Vec3::new(0.4, 0.35, 0.3),
        block + Vec3::new(0.4, 0.35, 0.3),
        0.12,
        2,
    );
    bar(
        b,
        m.rust,
        block + Vec3::new(0.0, -0.6, -1.35),
        block + Vec3::new(0.0, -0.6, 1.35),
        0.3,
    );
    for dz in [-1.2_f32, 1.2] {
        let curve: Vec<Vec3> = (0..=10)
            .map(|i| {
                let angle = TAU * 0.75 * i as f32 / 10.0;
                block + Vec3::new(0.32 * angle.sin(), -2.3 - 0.32 * angle.cos(), dz)
            })
            .collect();
        let mut path = vec![block + Vec3::new(0.0, -0.7, dz)];
        path.push(block + Vec3::new(0.0, -1.5, dz));
        path.extend(curve.into_iter().rev());
        b.tube(m.rust, &path, 0.08, 8);
    }
    b.node("cabin");
    let low = Vec3::new(x - 1.2, RAIL - 1.9, HALL.z - 5.2);
    b.cuboid(m.crane, low, low + Vec3::new(2.4, 1.0, 2.2), Sides::ALL);
    b.cuboid(
        m.crane,
        low + Vec3::new(0.0, 2.1, 0.0),
        low + Vec3::new(2.4, 2.3, 2.2),
        Sides::ALL,
    );
    for (dx, dz) in [(0.0, 0.0), (2.3, 0.0), (0.0, 2.1), (2.3, 2.1)] {
        let corner = low + Vec3::new(dx, 1.0, dz);
        b.cuboid(
            m.crane,
            corner,
            corner + Vec3::new(0.1, 1.1, 0.1),
            Sides::without(&[Sides::TOP, Sides::BOTTOM]),
        );
    }
}
