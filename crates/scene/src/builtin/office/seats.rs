//! Sofa, armchair, desk chair.

use super::super::build::SceneBuilder;
use super::palette::Palette;
use glam::{Affine3A, EulerRot, Quat, Vec3};
use std::f32::consts::{PI, TAU};

pub(super) fn draw(b: &mut SceneBuilder, m: &Palette) {
    sofa(b, m);
    armchair(b, m);
    desk_chair(b, m);
}

/// Faces -z; its own coordinates start in the middle of its front edge on the floor.
fn sofa(b: &mut SceneBuilder, m: &Palette) {
    b.node_at(
        "sofa",
        Affine3A::from_rotation_translation(Quat::from_rotation_y(PI), Vec3::new(2.75, 0.0, 3.62)),
    );
    let half = 1.08;
    b.rounded(
        m.sofa,
        Vec3::new(-half + 0.16, 0.13, -0.86),
        Vec3::new(half - 0.16, 0.30, -0.02),
        0.03,
        2,
    );
    b.rounded(
        m.sofa,
        Vec3::new(-half + 0.155, 0.14, -0.92),
        Vec3::new(half - 0.155, 0.80, -0.74),
        0.06,
        2,
    );
    for x in [-half, half - 0.18] {
        b.rounded(
            m.sofa,
            Vec3::new(x, 0.11, -0.92),
            Vec3::new(x + 0.18, 0.60, 0.0),
            0.06,
            2,
        );
    }
    for (from, to) in [(-half + 0.19, -0.005), (0.005, half - 0.19)] {
        b.rounded(
            m.sofa,
            Vec3::new(from, 0.295, -0.72),
            Vec3::new(to, 0.44, 0.01),
            0.055,
            2,
        );
        let back = Affine3A::from_rotation_translation(
            Quat::from_rotation_x(-0.16),
            Vec3::new(0.0, 0.44, -0.60),
        );
        b.part(back, |b| {
            b.rounded(
                m.sofa,
                Vec3::new(from, 0.0, -0.09),
                Vec3::new(to, 0.43, 0.09),
                0.08,
                2,
            );
        });
    }
    let pillow = |x: f32, turn: f32| {
        let rotation = Quat::from_euler(EulerRot::YXZ, turn, -0.36, 0.05);
        Affine3A::from_rotation_translation(rotation, Vec3::new(x, 0.44, -0.40))
    };
    for (material, x, turn) in [
        (m.mustard, -0.68, 0.35),
        (m.teal, 0.70, -0.3),
        (m.linen, 0.36, -0.1),
    ] {
        b.part(pillow(x, turn), |b| {
            b.rounded(
                material,
                Vec3::new(-0.22, 0.0, -0.065),
                Vec3::new(0.22, 0.42, 0.065),
                0.064,
                3,
            );
        });
    }
    for x in [-half + 0.08, half - 0.08] {
        for z in [-0.84, -0.08] {
            b.part(Affine3A::from_translation(Vec3::new(x, 0.0, z)), |b| {
                b.lathe(m.walnut, &[(0.014, 0.0), (0.024, 0.14)], 10);
            });
        }
    }
}

/// A tub of leather around a round cushion.
fn armchair(b: &mut SceneBuilder, m: &Palette) {
    let place = Affine3A::from_rotation_translation(
        Quat::from_rotation_y(-1.05),
        Vec3::new(4.72, 0.0, 1.72),
    );
    b.node_at("armchair", place);
    let (outer, thick) = (0.39, 0.055);
    // Around the back from one arm to the other; u runs from the sitter's left to the right as seen from the seat.
    b.plate(m.leather, 24, 2, |u, v, w| {
        let angle = PI * (1.5 - 1.24 * (u - 0.5));
        let rise = 0.5 + 0.5 * (TAU * (u - 0.5)).cos();
        let radius = outer - thick * w + 0.05 * v * rise;
        let height = 0.20 + (0.37 + 0.24 * rise) * v;
        Vec3::new(-radius * angle.cos(), height, radius * angle.sin())
    });
    b.part(
        Affine3A::from_translation(Vec3::new(0.0, 0.20, 0.02)),
        |b| {
            b.lathe(
                m.leather,
                &[
                    (0.0, 0.0),
                    (0.325, 0.0),
                    (0.325, 0.0),
                    (0.33, 0.10),
                    (0.33, 0.10),
                    (0.0, 0.10),
                ],
                22,
            );
        },
    );
    b.part(
        Affine3A::from_translation(Vec3::new(0.0, 0.302, 0.03)),
        |b| {
            let edge = [
                (0.0, 0.0),
                (0.29, 0.0),
                (0.315, 0.02),
                (0.325, 0.055),
                (0.315, 0.09),
                (0.28, 0.115),
                (0.15, 0.128),
                (0.0, 0.13),
            ];
            b.lathe(m.leather, &edge, 22);
        },
    );
    b.part(
        Affine3A::from_rotation_translation(
            Quat::from_rotation_x(-0.42),
            Vec3::new(0.02, 0.43, -0.17),
        ),
        |b| {
            b.rounded(
                m.linen,
                Vec3::new(-0.19, 0.0, -0.055),
                Vec3::new(0.19, 0.30, 0.055),
                0.054,
                3,
            );
        },
    );
    for i in 0..4 {
        let (sin, cos) = (TAU * (i as f32 + 0.5) / 4.0).sin_cos();
        let out = Vec3::new(cos, 0.0, sin);
        b.tube(
            m.walnut,
            &[out * 0.33 + Vec3::Y * 0.006, out * 0.26 + Vec3::Y * 0.201],
            0.015,
            8,
        );
    }
}

fn desk_chair(b: &mut SceneBuilder, m: &Palette) {
    let place = Affine3A::from_rotation_translation(
        Quat::from_rotation_y(PI + 0.42),
        Vec3::new(1.36, 0.0, 1.28),
    );
    b.node_at("desk chair", place);
    for i in 0..5 {
        let (sin, cos) = (TAU * (i as f32 + 0.3) / 5.0).sin_cos();
        let out = Vec3::new(cos, 0.0, sin);
        b.tube(
            m.steel,
            &[
                out * 0.02 + Vec3::Y * 0.095,
                out * 0.16 + Vec3::Y * 0.088,
                out * 0.30 + Vec3::Y * 0.068,
            ],
            0.016,
            6,
        );
        b.sphere(m.black, out * 0.30 + Vec3::Y * 0.029, 0.0285, 8);
    }
    b.cylinder(m.steel, Vec3::Y * 0.07, 0.036, 0.06, 14, [true, true]);
    b.cylinder(m.steel, Vec3::Y * 0.13, 0.018, 0.28, 12, [false, false]);
    b.cylinder(m.black, Vec3::Y * 0.13, 0.026, 0.14, 12, [false, true]);
    b.rounded(
        m.black,
        Vec3::new(-0.11, 0.40, -0.12),
        Vec3::new(0.11, 0.432, 0.10),
        0.01,
        1,
    );
    b.rounded(
        m.felt,
        Vec3::new(-0.24, 0.43, -0.22),
        Vec3::new(0.24, 0.50, 0.24),
        0.034,
        3,
    );
    // The back: bent around the sitter and inwards at its small.
    b.plate(m.felt, 8, 6, |u, v, w| {
        let side = 2.0 * u - 1.0;
        let half_width = 0.225 * (1.0 - 0.25 * (2.0 * v - 1.0).powi(4));
        let curve = 0.07 * side * side + 0.03 * (PI * v).sin() - 0.07 * v;
        Vec3::new(
            half_width * side,
            0.60 + 0.46 * v,
            -0.235 + curve - 0.03 * (1.0 - w),
        )
    });
    b.tube(
        m.steel,
        &[
            Vec3::new(0.0, 0.415, -0.11),
            Vec3::new(0.0, 0.42, -0.24),
            Vec3::new(0.0, 0.50, -0.28),
            Vec3::new(0.0, 0.70, -0.262),
        ],
        0.016,
        8,
    );
    for x in [-0.27, 0.27] {
        let path = [
            Vec3::new(x * 0.75, 0.425, 0.0),
            Vec3::new(x, 0.44, 0.0),
            Vec3::new(x, 0.665, 0.0),
        ];
        b.tube(m.steel, &path, 0.011, 6);
        b.rounded(
            m.black,
            Vec3::new(x - 0.035, 0.66, -0.12),
            Vec3::new(x + 0.035, 0.685, 0.12),
            0.012,
            2,
        );
    }
}
