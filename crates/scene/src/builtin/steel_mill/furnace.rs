//! The furnace and the ladles.

use super::super::build::{SceneBuilder, Sides};
use super::{LINE, Palette};
use core::f32::consts::FRAC_PI_2;
use glam::{Affine3A, Quat, Vec2, Vec3};

/// A block of brick whose mouths glow, with a chute to the line.
pub(super) fn furnace(b: &mut SceneBuilder, m: &Palette) {
    b.node("furnace");
    let (low, high) = (Vec3::new(0.9, 0.0, 2.4), Vec3::new(6.4, 5.6, 11.6));
    b.cuboid(
        m.brick,
        low,
        high,
        Sides::only(&[Sides::LEFT, Sides::TOP, Sides::BACK, Sides::FRONT]),
    );
    let mouths: Vec<_> = (0..3)
        .map(|i| {
            let z = 3.1 + 2.85 * i as f32;
            (Vec2::new(z, 0.8), Vec2::new(z + 1.9, 2.3))
        })
        .collect();
    let flipped: Vec<_> = mouths
        .iter()
        .map(|(a, c)| (Vec2::new(high.z - c.x, a.y), Vec2::new(high.z - a.x, c.y)))
        .collect();
    let origin = Vec3::new(high.x, 0.0, high.z);
    b.rectangle_with_holes(
        m.brick,
        origin,
        [Vec3::NEG_Z, Vec3::Y],
        Vec2::new(high.z - low.z, high.y),
        &flipped,
    );
    for (from, to) in mouths {
        let (inner, outer) = (
            Vec3::new(high.x - 0.8, from.y, from.x),
            Vec3::new(high.x, to.y, to.x),
        );
        b.room(
            m.brick,
            inner,
            outer,
            Sides::only(&[Sides::TOP, Sides::BOTTOM, Sides::BACK, Sides::FRONT]),
        );
        b.room(m.mouth, inner, outer, Sides::only(&[Sides::LEFT]));
        b.cuboid(
            m.rust,
            Vec3::new(high.x + 0.03, 2.45, from.x - 0.1),
            Vec3::new(high.x + 0.18, 3.9, to.x + 0.1),
            Sides::ALL,
        );
    }
    for i in 0..6 {
        let z = low.z + (high.z - low.z) * i as f32 / 5.0;
        let z = z.clamp(low.z + 0.12, high.z - 0.12);
        b.cuboid(
            m.rust,
            Vec3::new(high.x - 0.05, high.y, z - 0.1),
            Vec3::new(high.x + 0.2, high.y + 0.5, z + 0.1),
            Sides::ALL,
        );
        b.cuboid(
            m.rust,
            Vec3::new(low.x, high.y, z - 0.1),
            Vec3::new(high.x - 0.05, high.y + 0.25, z + 0.1),
            Sides::without(&[Sides::BOTTOM, Sides::RIGHT]),
        );
    }
    b.node("chute");
    let (middle, height, half) = LINE;
    b.cuboid(
        m.rust,
        Vec3::new(6.45, height - 0.35, middle - half),
        Vec3::new(8.2, height - 0.2, middle + half),
        Sides::ALL,
    );
    b.node("stack");
    b.cylinder(
        m.rust,
        Vec3::new(3.4, high.y, 7.0),
        0.75,
        9.2,
        32,
        [false, false],
    );
    for ring in 0..5 {
        b.part(
            Affine3A::from_translation(Vec3::new(3.4, 6.5 + 1.8 * ring as f32, 7.0)),
            |b| {
                b.lathe(
                    m.rust,
                    &[
                        (0.75, 0.0),
                        (0.83, 0.0),
                        (0.83, 0.0),
                        (0.83, 0.12),
                        (0.83, 0.12),
                        (0.75, 0.12),
                    ],
                    32,
                );
            },
        );
    }
}

/// One ladle hangs from the crane, three wait on their stands.
pub(super) fn ladles(b: &mut SceneBuilder, m: &Palette) {
    let places = [
        (Vec3::new(29.0, 2.75, 13.0), false),
        (Vec3::new(12.5, 0.9, 18.2), true),
        (Vec3::new(17.5, 0.9, 18.2), true),
        (Vec3::new(22.5, 0.9, 18.2), true),
    ];
    for (i, (place, has_stand)) in places.into_iter().enumerate() {
        b.node_at(
            &format!("ladle-{}", i + 1),
            Affine3A::from_translation(place),
        );
        ladle(b, m, i != 2);
        if has_stand {
            for z in [-1.35, 1.35] {
                b.cuboid(
                    m.rust,
                    Vec3::new(-1.2, -0.9, z - 0.25),
                    Vec3::new(1.2, 0.75, z + 0.25),
                    Sides::without(&[Sides::BOTTOM]),
                );
            }
        }
    }
}

pub(super) fn ladle(b: &mut SceneBuilder, m: &Palette, is_full: bool) {
    let outside = [
        (0.0, 0.0),
        (0.85, 0.0),
        (0.85, 0.0),
        (0.92, 0.5),
        (0.99, 0.5),
        (0.99, 0.5),
        (1.0, 0.65),
        (1.0, 0.65),
        (0.95, 0.66),
        (1.02, 1.3),
        (1.09, 1.3),
        (1.09, 1.3),
        (1.1, 1.45),
        (1.1, 1.45),
        (1.04, 1.46),
        (1.12, 2.2),
        (1.12, 2.2),
        (0.98, 2.2),
        (0.98, 2.2),
        (0.76, 0.2),
        (0.76, 0.2),
        (0.0, 0.2),
    ];
    b.lathe(m.rust, &outside, 40);
    if is_full {
        b.lathe(m.melt, &[(0.93, 1.85), (0.0, 1.85)], 40);
    }
    let lying = Quat::from_rotation_x(FRAC_PI_2);
    for z in [-1.45, 1.05] {
        b.part(
            Affine3A::from_rotation_translation(lying, Vec3::new(0.0, 1.38, z)),
            |b| {
                b.lathe(
                    m.rust,
                    &[
                        (0.0, 0.0),
                        (0.14, 0.0),
                        (0.14, 0.0),
                        (0.14, 0.4),
                        (0.14, 0.4),
                        (0.0, 0.4),
                    ],
                    16,
                );
            },
        );
    }
}
