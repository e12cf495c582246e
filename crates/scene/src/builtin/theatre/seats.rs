//! Stalls, balconies and boxes.

use super::super::build::{SceneBuilder, Sides};
use super::{CENTRE, HOUSE, Palette, ROWS, SEAT, rake};
use core::f32::consts::PI;
use glam::{Affine3A, Quat, Vec3};

/// A seat that looks along -z, on its floor, without what it stands on.
pub(super) fn seat(b: &mut SceneBuilder, m: &Palette) {
    let half = 0.5 * SEAT - 0.02;
    b.cuboid(
        m.plush,
        Vec3::new(-half, 0.36, -0.22),
        Vec3::new(half, 0.48, 0.2),
        Sides::without(&[Sides::LEFT, Sides::RIGHT]),
    );
    let half = half - 0.02;
    b.plate(m.plush, 3, 2, |u, v, w| {
        let x = (1.0 - 2.0 * u) * half;
        let hollow = 0.03 * (1.0 - (2.0 * u - 1.0).powi(2));
        Vec3::new(x, 0.5 + 0.5 * v, 0.22 + 0.1 * v + hollow - 0.07 * w)
    });
}

/// A standard with an arm rest, on one side of a seat; neighbours share it.
pub(super) fn standard(b: &mut SceneBuilder, m: &Palette, side: f32) {
    let x = 0.5 * side * SEAT;
    b.cuboid(
        m.frame,
        Vec3::new(x - 0.02, 0.0, -0.16),
        Vec3::new(x + 0.02, 0.6, 0.22),
        Sides::without(&[Sides::BOTTOM, Sides::TOP]),
    );
    b.cuboid(
        m.wood,
        Vec3::new(x - 0.032, 0.6, -0.2),
        Vec3::new(x + 0.032, 0.64, 0.24),
        Sides::ALL,
    );
}

/// A row of seats on a circle around the stage, from angle to angle, but for the aisles.
pub(super) fn row_of_seats(
    b: &mut SceneBuilder,
    m: &Palette,
    radius: f32,
    floor: f32,
    reach: f32,
    aisles: &[f32],
) {
    let limit = (reach / radius).asin();
    let count = (2.0 * limit * radius / SEAT).floor();
    let step = SEAT / radius;
    let first = -0.5 * (count - 1.0) * step;
    let is_free = |angle: f32| {
        let x = radius * angle.sin();
        angle <= -first + 1e-4 && aisles.iter().all(|aisle| (x - aisle).abs() > 0.85)
    };
    let mut angle = first;
    while angle <= -first + 1e-4 {
        if is_free(angle) {
            let place = Affine3A::from_rotation_translation(
                Quat::from_rotation_y(angle),
                Vec3::new(radius * angle.sin(), floor, CENTRE + radius * angle.cos()),
            );
            b.part(place, |b| {
                seat(b, m);
                standard(b, m, -1.0);
                if !is_free(angle + step) {
                    standard(b, m, 1.0);
                }
            });
        }
        angle += step;
    }
}

pub(super) fn stalls(b: &mut SceneBuilder, m: &Palette) {
    for row in 0..24 {
        b.node(&format!("stalls-row-{}", row + 1));
        let z = ROWS.0 + 0.6 + ROWS.1 * row as f32;
        let radius = z - CENTRE;
        // Each row on a tread of its own, which the rake cuts.
        row_of_seats(b, m, radius, rake(z) + 0.02, 12.2, &[-5.6, 5.6]);
    }
    b.node("aisle-lights");
    for row in (0..24).step_by(2) {
        let z = ROWS.0 + 0.6 + ROWS.1 * row as f32;
        for x in [-6.4_f32, -4.8, 4.8, 6.4] {
            let radius = z - CENTRE;
            let z = CENTRE + (radius * radius - x * x).sqrt();
            let low = Vec3::new(x - 0.03, rake(z) + 0.03, z - 0.05);
            b.cuboid(
                m.step,
                low,
                low + Vec3::new(0.06, 0.1, 0.1),
                Sides::without(&[Sides::BOTTOM]),
            );
        }
    }
}

/// A balcony: height of its lowest floor, where its front stands in the middle, how many rows it has, by how much each is
/// higher than the one before. One below another has to rise gently.
pub(super) struct Level {
    pub floor: f32,
    pub front: f32,
    pub rows: usize,
    pub rise: f32,
}

/// A square lamp below a ceiling.
fn soffit_lamp(b: &mut SceneBuilder, m: &Palette, place: Vec3) {
    let (low, high) = (
        place - Vec3::new(0.24, 0.09, 0.24),
        place + Vec3::new(0.24, 0.06, 0.24),
    );
    b.cuboid(
        m.gold,
        low,
        high,
        Sides::without(&[Sides::TOP, Sides::BOTTOM]),
    );
    b.cuboid(m.soffit, low, high, Sides::only(&[Sides::BOTTOM]));
}

/// Treads that rise towards the back, a front with lamps on it, seats.
pub(super) fn balcony(b: &mut SceneBuilder, m: &Palette, level: &Level) {
    let (columns, reach) = (29, HOUSE.x);
    let name = if level.floor < 6.0 { "lower" } else { "upper" };
    let at = |radius: f32, column: usize, y: f32| {
        let x = reach * (column as f32 / (columns - 1) as f32 * 2.0 - 1.0);
        let z = CENTRE + (radius * radius - x * x).max(0.0).sqrt();
        Vec3::new(x, y, z.min(HOUSE.z))
    };
    let radius = level.front - CENTRE;
    let rise = level.rise;
    b.node(&format!("{name}-balcony"));
    // Underside, front, and the parapet's top and inner side.
    let last = radius + level.rows as f32 * ROWS.1;
    let underside = |share: f32, column: usize| {
        let to_wall = at(last, column, 0.0).with_z(HOUSE.z);
        let from = at(radius, column, 0.0);
        from.lerp(to_wall, share) + Vec3::Y * (level.floor - 0.35 + 0.5 * share)
    };
    b.sheet(m.ceiling, 13, columns, |row, column| {
        underside(row as f32 / 12.0, column)
    });
    for column in (2..columns).step_by(4) {
        for share in [0.1, 0.62] {
            soffit_lamp(b, m, underside(share, column));
        }
    }
    b.sheet(m.ornament, 6, columns, |row, column| {
        let y = level.floor - 0.35 + 1.25 * row as f32 / 5.0;
        let bulge = 0.18 * (PI * row as f32 / 5.0).sin();
        at(radius - bulge, columns - 1 - column, y)
    });
    b.sheet(m.wood, 2, columns, |row, column| {
        at(radius + 0.2 * (1 - row) as f32, column, level.floor + 0.9)
    });
    b.sheet(m.ornament, 2, columns, |row, column| {
        at(radius + 0.2, column, level.floor + 0.9 * row as f32)
    });
    for row in 0..level.rows {
        let (near, far) = (
            radius + 0.2 + ROWS.1 * row as f32,
            radius + 0.2 + ROWS.1 * (row + 1) as f32,
        );
        let y = level.floor + rise * row as f32;
        b.sheet(m.carpet, 2, columns, |step, column| {
            let far = if row + 1 == level.rows {
                at(far, column, y).with_z(HOUSE.z)
            } else {
                at(far, column, y)
            };
            if step == 0 { far } else { at(near, column, y) }
        });
        if row > 0 {
            b.sheet(m.wood, 2, columns, |step, column| {
                at(near, columns - 1 - column, y - rise * (1 - step) as f32)
            });
        }
    }
    b.node(&format!("{name}-balcony-lamps"));
    for i in 0..22 {
        let x = 12.6 * ((i as f32 + 0.5) / 11.0 - 1.0);
        let front = radius - 0.22;
        let z = CENTRE + (front * front - x * x).sqrt();
        let place = Vec3::new(x, level.floor + 0.25, z - 0.12);
        b.sphere(m.globe, place, 0.075, 8);
        b.tube(
            m.gold,
            &[
                place + Vec3::new(0.0, -0.08, 0.0),
                Vec3::new(x, level.floor + 0.12, z + 0.04),
            ],
            0.014,
            6,
        );
    }
    for row in 0..level.rows {
        b.node(&format!("{name}-row-{}", row + 1));
        let radius = radius + 0.2 + ROWS.1 * row as f32 + 0.62;
        row_of_seats(
            b,
            m,
            radius,
            level.floor + rise * row as f32 + 0.005,
            12.6,
            &[-5.0, 5.0],
        );
    }
}

/// Three boxes on either side, each with a lamp over its chairs.
pub(super) fn boxes(b: &mut SceneBuilder, m: &Palette) {
    for side in [-1.0_f32, 1.0] {
        for i in 0..3 {
            b.node(&format!(
                "box-{}-{}",
                if side < 0.0 { "left" } else { "right" },
                i + 1
            ));
            let (near, far) = (3.0 + 3.7 * i as f32, 5.6 + 3.7 * i as f32);
            let floor = 3.6 + 0.35 * i as f32;
            let (wall, edge) = (side * HOUSE.x, side * (HOUSE.x - 2.0));
            let (from, to) = (wall.min(edge), wall.max(edge));
            let closed = if side < 0.0 {
                Sides::LEFT
            } else {
                Sides::RIGHT
            };
            b.cuboid(
                m.ornament,
                Vec3::new(from, floor - 0.3, near),
                Vec3::new(to, floor, far),
                Sides::without(&[closed]),
            );
            let rail = if side < 0.0 {
                (to - 0.12, to)
            } else {
                (from, from + 0.12)
            };
            b.cuboid(
                m.ornament,
                Vec3::new(rail.0, floor, near),
                Vec3::new(rail.1, floor + 0.85, far),
                Sides::without(&[Sides::BOTTOM]),
            );
            b.cuboid(
                m.plush,
                Vec3::new(rail.0 - 0.03, floor + 0.85, near - 0.03),
                Vec3::new(rail.1 + 0.03, floor + 0.93, far + 0.03),
                Sides::ALL,
            );
            b.sphere(
                m.globe,
                Vec3::new(wall - side * 0.5, floor + 2.1, 0.5 * (near + far)),
                0.11,
                12,
            );
            for k in 0..3 {
                let place = Vec3::new(
                    wall - side * 1.2,
                    floor + 0.005,
                    near + 0.5 + 0.8 * k as f32,
                );
                let turn =
                    Affine3A::from_rotation_translation(Quat::from_rotation_y(side * 0.9), place);
                b.part(turn, |b| {
                    seat(b, m);
                    standard(b, m, -1.0);
                    standard(b, m, 1.0);
                });
            }
        }
    }
}
