//! Walls, sconces, ceiling and chandelier.

use super::super::build::{SceneBuilder, Sides};
use super::{HOUSE, Palette, rake};
use core::f32::consts::PI;
use glam::{Affine3A, Vec2, Vec3};

pub(super) fn walls(b: &mut SceneBuilder, m: &Palette) {
    b.node("floor");
    b.sheet(m.carpet, 35, 15, |row, column| {
        let (x, z) = (
            HOUSE.x * (column as f32 / 7.0 - 1.0),
            HOUSE.z * (1.0 - row as f32 / 34.0),
        );
        Vec3::new(x, rake(z), z)
    });
    b.node("walls");
    // Panels between pilasters; they stand on a dado of wood.
    for side in [-1.0_f32, 1.0] {
        let x = side * HOUSE.x;
        let wall = |b: &mut SceneBuilder, material: usize, low: f32, high: f32| {
            b.sheet(material, 8, 35, |row, column| {
                let z = if side < 0.0 {
                    HOUSE.z - column as f32
                } else {
                    column as f32
                };
                let foot = low.max(rake(z) - 0.02);
                Vec3::new(x, foot + (high - foot) * row as f32 / 7.0, z)
            });
        };
        wall(b, m.plaster, 0.0, HOUSE.y);
        for i in 0..9 {
            let z = 2.2 + 3.7 * i as f32;
            let (from, to) = (x.min(x - side * 0.22), x.max(x - side * 0.22));
            let faces = if side < 0.0 {
                Sides::without(&[Sides::LEFT, Sides::BOTTOM, Sides::TOP])
            } else {
                Sides::without(&[Sides::RIGHT, Sides::BOTTOM, Sides::TOP])
            };
            b.cuboid(
                m.ornament,
                Vec3::new(from, rake(z) - 0.1, z - 0.35),
                Vec3::new(to, HOUSE.y, z + 0.35),
                faces,
            );
            sconce(b, m, Vec3::new(x - side * 0.22, rake(z) + 2.6, z), side);
        }
    }
    b.node("rear-wall");
    b.sheet(m.plaster, 8, 29, |row, column| {
        let foot = rake(HOUSE.z);
        Vec3::new(
            HOUSE.x - column as f32,
            foot + (HOUSE.y - foot) * row as f32 / 7.0,
            HOUSE.z,
        )
    });
    for x in [-7.0, 7.0] {
        let foot = rake(HOUSE.z);
        b.node(&format!("exit-{}", if x < 0.0 { "left" } else { "right" }));
        b.cuboid(
            m.wood,
            Vec3::new(x - 1.0, foot - 0.2, HOUSE.z - 0.1),
            Vec3::new(x + 1.0, foot + 2.4, HOUSE.z),
            Sides::without(&[Sides::FRONT, Sides::BOTTOM]),
        );
        b.cuboid(
            m.exit,
            Vec3::new(x - 0.4, foot + 2.55, HOUSE.z - 0.08),
            Vec3::new(x + 0.4, foot + 2.8, HOUSE.z),
            Sides::without(&[Sides::FRONT]),
        );
    }
}

/// Two globes on an arm.
pub(super) fn sconce(b: &mut SceneBuilder, m: &Palette, place: Vec3, side: f32) {
    let out = Vec3::new(-side, 0.0, 0.0);
    b.tube(
        m.gold,
        &[
            place,
            place + out * 0.18,
            place + out * 0.18 + Vec3::Y * 0.08,
        ],
        0.02,
        6,
    );
    for dz in [-0.16, 0.16] {
        let end = place + out * 0.18 + Vec3::new(0.0, 0.08, dz);
        let start = place + out * 0.18 + Vec3::new(0.0, 0.01, 0.125 * dz);
        b.tube(m.gold, &[start, end], 0.014, 6);
        b.sphere(m.globe, end + Vec3::Y * 0.11, 0.09, 8);
    }
}

/// Coffers in rows, each a stepped box with a lamp in its middle; a ring of light around the chandelier.
pub(super) fn ceiling(b: &mut SceneBuilder, m: &Palette) {
    let (columns, rows) = (8, 10);
    let pitch = Vec2::new(2.0 * HOUSE.x / columns as f32, HOUSE.z / rows as f32);
    let opening = Vec2::new(0.74, 0.74) * pitch;
    let mut holes = Vec::new();
    for i in 0..columns * rows {
        let low =
            Vec2::new((i % columns) as f32, (i / columns) as f32) * pitch + (pitch - opening) * 0.5;
        holes.push((low, low + opening));
    }
    b.node("ceiling");
    let corner = Vec3::new(-HOUSE.x, HOUSE.y, 0.0);
    b.rectangle_with_holes(
        m.ceiling,
        corner,
        [Vec3::X, Vec3::Z],
        Vec2::new(2.0 * HOUSE.x, HOUSE.z),
        &holes,
    );
    for (i, &(low, high)) in holes.iter().enumerate() {
        b.node(&format!("coffer-{}", i + 1));
        let (mut low, mut high, mut y) = (low, high, HOUSE.y);
        let at = |p: Vec2, y: f32| Vec3::new(p.x - HOUSE.x, y, p.y);
        for step in 0..3 {
            let material = if step == 1 { m.gold } else { m.ornament };
            b.room(
                material,
                at(low, y),
                at(high, y + 0.16),
                Sides::without(&[Sides::TOP, Sides::BOTTOM]),
            );
            y += 0.16;
            let inset = Vec2::splat(if step == 2 { 0.0 } else { 0.22 });
            if step < 2 {
                let size = high - low;
                b.rectangle_with_holes(
                    m.ceiling,
                    at(low, y),
                    [Vec3::X, Vec3::Z],
                    size,
                    &[(inset, size - inset)],
                );
            }
            low += inset;
            high -= inset;
        }
        let centre = (low + high) * 0.5;
        let half = Vec2::splat(0.32);
        let size = high - low;
        b.rectangle_with_holes(
            m.ceiling,
            at(low, y),
            [Vec3::X, Vec3::Z],
            size,
            &[(centre - half - low, centre + half - low)],
        );
        b.room(
            m.gold,
            at(centre - half, y),
            at(centre + half, y + 0.1),
            Sides::without(&[Sides::TOP, Sides::BOTTOM]),
        );
        b.room(
            m.dome,
            at(centre - half, y),
            at(centre + half, y + 0.1),
            Sides::only(&[Sides::TOP]),
        );
    }
    chandelier(b, m);
}

/// Rings of globes on curved arms.
pub(super) fn chandelier(b: &mut SceneBuilder, m: &Palette) {
    b.node_at(
        "chandelier",
        Affine3A::from_translation(Vec3::new(0.0, 10.4, 13.6)),
    );
    b.tube(
        m.gold,
        &[
            Vec3::new(0.0, 0.0, 0.0),
            Vec3::new(0.0, HOUSE.y + 0.4 - 10.4, 0.0),
        ],
        0.035,
        8,
    );
    b.lathe(
        m.gold,
        &[
            (0.0, -0.7),
            (0.08, -0.6),
            (0.22, -0.4),
            (0.12, -0.15),
            (0.3, 0.1),
            (0.18, 0.5),
            (0.0, 0.7),
        ],
        24,
    );
    for (ring, (radius, y, count)) in [(1.9_f32, -0.1_f32, 24), (1.3, 0.45, 16), (0.8, 0.9, 10)]
        .into_iter()
        .enumerate()
    {
        for i in 0..count {
            let angle = 2.0 * PI * (i as f32 + 0.5 * ring as f32) / count as f32;
            let out = Vec3::new(angle.cos(), 0.0, angle.sin());
            let path = [
                out * 0.15 + Vec3::Y * 0.1,
                out * (0.5 * radius) + Vec3::Y * (y - 0.25),
                out * (0.9 * radius) + Vec3::Y * (y - 0.15),
                out * radius + Vec3::Y * y,
            ];
            b.tube(m.gold, &path, 0.016, 6);
            lathe_at(
                b,
                m.gold,
                out * radius + Vec3::Y * y,
                &[
                    (0.0, -0.02),
                    (0.06, 0.0),
                    (0.06, 0.0),
                    (0.05, 0.03),
                    (0.05, 0.03),
                    (0.0, 0.03),
                ],
                10,
            );
            b.sphere(m.globe, out * radius + Vec3::Y * (y + 0.12), 0.085, 8);
        }
    }
}

/// A body of revolution around an upright axis through a place.
pub(super) fn lathe_at(
    b: &mut SceneBuilder,
    material: usize,
    place: Vec3,
    profile: &[(f32, f32)],
    segments: usize,
) {
    b.part(Affine3A::from_translation(place), |b| {
        b.lathe(material, profile, segments);
    });
}
