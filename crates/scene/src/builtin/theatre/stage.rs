//! The stage, its arch, curtain and lights.

use super::super::build::{SceneBuilder, Sides};
use super::house::lathe_at;
use super::{ARCH, HOUSE, Palette, STAGE};
use core::f32::consts::PI;
use glam::{Affine3A, Quat, Vec2, Vec3};

pub(super) fn stage(b: &mut SceneBuilder, m: &Palette) {
    let (depth, height) = STAGE;
    let half = 12.0;
    b.node("stage");
    // The apron bulges into the house.
    b.sheet(m.boards, 3, 33, |row, column| {
        let x = ARCH.x * (column as f32 / 16.0 - 1.0);
        let front = 2.0 * (1.0 - (x / ARCH.x).powi(2)).max(0.0);
        Vec3::new(x, height, front * (1.0 - row as f32 * 0.5))
    });
    b.sheet(m.wood, 2, 33, |row, column| {
        let x = ARCH.x * (column as f32 / 16.0 - 1.0);
        let front = 2.0 * (1.0 - (x / ARCH.x).powi(2)).max(0.0);
        Vec3::new(x, height * row as f32, front)
    });
    b.sheet(m.boards, 13, 25, |row, column| {
        Vec3::new(
            half * (column as f32 / 12.0 - 1.0),
            height,
            -(row as f32) * depth / 12.0,
        )
    });
    b.node("stage-house");
    let top = 13.0;
    b.room(
        m.black,
        Vec3::new(-half, height, -depth),
        Vec3::new(half, top, -0.6),
        Sides::without(&[Sides::BOTTOM, Sides::FRONT]),
    );
    b.node("backcloth");
    b.sheet(m.cloth, 9, 33, |row, column| {
        let x = 9.5 * (column as f32 / 16.0 - 1.0);
        Vec3::new(
            x,
            height + 8.5 * row as f32 / 8.0,
            -depth + 0.9 + 0.25 * (x * 0.33).powi(2) * 0.3,
        )
    });
    b.node("wings");
    for i in 0..4 {
        let z = -2.2 - 2.2 * i as f32;
        for side in [-1.0_f32, 1.0] {
            folds(
                b,
                m.black,
                Vec3::new(side * 7.2, height, z),
                Vec3::new(side * 10.6, height, z),
                8.0,
                16,
            );
        }
        b.cuboid(
            m.black,
            Vec3::new(-10.6, height + 7.2, z - 0.05),
            Vec3::new(10.6, height + 9.6, z + 0.05),
            Sides::ALL,
        );
        // Spots on a bar behind the border.
        b.tube(
            m.frame,
            &[
                Vec3::new(-9.0, height + 7.0, z - 0.6),
                Vec3::new(9.0, height + 7.0, z - 0.6),
            ],
            0.03,
            8,
        );
        for k in 0..9 {
            lantern(
                b,
                m,
                Vec3::new(-7.2 + 1.8 * k as f32, height + 6.75, z - 0.6),
                0.55,
            );
        }
    }
    b.node("set");
    scenery(b, m, height);
    b.node("footlights");
    for i in 0..24 {
        let x = 7.0 * ((i as f32 + 0.5) / 12.0 - 1.0);
        let z = 2.0 * (1.0 - (x / ARCH.x).powi(2)) - 0.28;
        let low = Vec3::new(x - 0.12, height, z);
        b.cuboid(
            m.frame,
            low,
            low + Vec3::new(0.24, 0.14, 0.16),
            Sides::without(&[Sides::BOTTOM, Sides::BACK]),
        );
        b.quad(
            m.footlight,
            [
                low + Vec3::new(0.24, 0.0, 0.0),
                low,
                low + Vec3::new(0.0, 0.14, 0.0),
                low + Vec3::new(0.24, 0.14, 0.0),
            ],
        );
    }
}

/// A lantern that looks down and towards the back of the stage.
pub(super) fn lantern(b: &mut SceneBuilder, m: &Palette, place: Vec3, tilt: f32) {
    let part = Affine3A::from_rotation_translation(Quat::from_rotation_x(tilt), place);
    b.part(part, |b| {
        b.lathe(
            m.frame,
            &[
                (0.14, -0.32),
                (0.14, 0.1),
                (0.08, 0.2),
                (0.08, 0.2),
                (0.0, 0.2),
            ],
            12,
        );
        b.lathe(
            m.frame,
            &[
                (0.0, -0.2),
                (0.12, -0.2),
                (0.12, -0.2),
                (0.12, -0.32),
                (0.12, -0.32),
                (0.14, -0.32),
            ],
            12,
        );
        b.lathe(m.spot, &[(0.1, -0.22), (0.0, -0.22)], 12);
    });
}

/// Steps, columns and a doorway.
pub(super) fn scenery(b: &mut SceneBuilder, m: &Palette, floor: f32) {
    for i in 0..4 {
        let inset = 0.5 * i as f32;
        b.cuboid(
            m.ornament,
            Vec3::new(-4.5 + inset, floor + 0.2 * i as f32, -9.4),
            Vec3::new(4.5 - inset, floor + 0.2 * (i + 1) as f32, -6.2 - inset),
            Sides::without(&[Sides::BOTTOM]),
        );
    }
    let base = floor + 0.8;
    for x in [-2.6, -1.3, 1.3, 2.6] {
        lathe_at(
            b,
            m.ornament,
            Vec3::new(x, base, -8.4),
            &[
                (0.0, 0.0),
                (0.34, 0.0),
                (0.34, 0.0),
                (0.34, 0.12),
                (0.34, 0.12),
                (0.26, 0.2),
                (0.24, 0.3),
                (0.2, 4.1),
                (0.24, 4.2),
                (0.34, 4.35),
                (0.34, 4.35),
                (0.34, 4.5),
                (0.34, 4.5),
                (0.0, 4.5),
            ],
            24,
        );
    }
    b.cuboid(
        m.ornament,
        Vec3::new(-3.2, base + 4.5, -8.8),
        Vec3::new(3.2, base + 5.1, -8.0),
        Sides::ALL,
    );
    b.cuboid(
        m.gold,
        Vec3::new(-3.3, base + 5.1, -8.9),
        Vec3::new(3.3, base + 5.2, -7.9),
        Sides::ALL,
    );
}

/// Hanging cloth in folds between two points.
pub(super) fn folds(
    b: &mut SceneBuilder,
    material: usize,
    from: Vec3,
    to: Vec3,
    height: f32,
    waves: usize,
) {
    let columns = 6 * waves + 1;
    let along = to - from;
    let across = along.cross(Vec3::Y).normalize();
    b.sheet(material, 5, columns, |row, column| {
        let share = column as f32 / (columns - 1) as f32;
        let fold = 0.14 * (2.0 * PI * waves as f32 * share).sin();
        from + along * share + across * fold + Vec3::Y * (height * row as f32 / 4.0)
    });
}

/// The wall around the stage, its frame and the curtain, drawn aside.
pub(super) fn arch(b: &mut SceneBuilder, m: &Palette) {
    b.node("arch");
    let width = 2.0 * HOUSE.x;
    let hole = (
        Vec2::new(HOUSE.x - ARCH.x, 0.0),
        Vec2::new(HOUSE.x + ARCH.x, STAGE.1 + ARCH.y),
    );
    b.rectangle_with_holes(
        m.plaster,
        Vec3::new(-HOUSE.x, 0.0, 0.0),
        [Vec3::X, Vec3::Y],
        Vec2::new(width, HOUSE.y),
        &[hole],
    );
    let (top, deep) = (STAGE.1 + ARCH.y, -0.6);
    b.room(
        m.gold,
        Vec3::new(-ARCH.x, STAGE.1, deep),
        Vec3::new(ARCH.x, top, 0.0),
        Sides::only(&[Sides::LEFT, Sides::RIGHT, Sides::TOP]),
    );
    for side in [-1.0_f32, 1.0] {
        for (k, (near, far)) in [(0.0_f32, 0.25_f32), (0.35, 0.85), (0.95, 1.1)]
            .into_iter()
            .enumerate()
        {
            let (a, c) = (side * (ARCH.x + near), side * (ARCH.x + far));
            let thick = [0.12, 0.2, 0.08][k];
            let material = if k == 1 { m.ornament } else { m.gold };
            b.cuboid(
                material,
                Vec3::new(a.min(c), STAGE.1, 0.0),
                Vec3::new(a.max(c), top + far, thick),
                Sides::without(&[Sides::BACK]),
            );
            if side > 0.0 {
                b.cuboid(
                    material,
                    Vec3::new(-ARCH.x - near, top + near, 0.0),
                    Vec3::new(ARCH.x + near, top + far, thick),
                    Sides::without(&[Sides::BACK, Sides::LEFT, Sides::RIGHT]),
                );
            }
        }
    }
    b.node("curtain");
    for side in [-1.0, 1.0] {
        folds(
            b,
            m.curtain,
            Vec3::new(side * 5.4, STAGE.1 + 0.04, -0.9),
            Vec3::new(side * 8.6, STAGE.1 + 0.04, -0.9),
            8.6,
            11,
        );
    }
    folds(
        b,
        m.curtain,
        Vec3::new(-8.6, STAGE.1 + 6.9, -0.75),
        Vec3::new(8.6, STAGE.1 + 6.9, -0.75),
        1.7,
        44,
    );
}
