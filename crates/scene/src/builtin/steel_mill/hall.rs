//! Shell, columns, trusses and lamps.

use super::super::build::{SceneBuilder, Sides};
use super::{BAY, HALL, Palette, RAIL};
use glam::{Affine3A, Quat, Vec3};

/// Depth of the cladding's waves.
const DENT: f32 = 0.12;

/// Height of the roof over z: two slopes.
pub(super) fn roof_at(z: f32) -> f32 {
    HALL.y - 2.4 * (z / HALL.z - 0.5).abs() * 2.0
}

pub(super) fn hall(b: &mut SceneBuilder, m: &Palette) {
    b.node("floor");
    b.room(m.floor, Vec3::ZERO, HALL, Sides::only(&[Sides::BOTTOM]));
    b.node("plinth");
    let low = 3.0;
    let shell = Vec3::new(HALL.x, low, HALL.z);
    b.room(
        m.wall,
        Vec3::ZERO,
        shell,
        Sides::without(&[Sides::TOP, Sides::BOTTOM]),
    );
    b.node("cladding");
    // Corrugated sheets above the plinth.
    // Edges of the waves along the long and the short walls.
    let waves = [2 * 67 + 1, 2 * 27 + 1];
    let dent = |i: usize| if i.is_multiple_of(2) { 0.0 } else { DENT };
    let eaves = roof_at(0.0);
    let n = waves[0];
    let x = move |i: usize| HALL.x * i as f32 / (n - 1) as f32;
    b.sheet(m.cladding, 2, n, |row, i| {
        Vec3::new(x(i), if row == 0 { low } else { eaves }, -dent(i))
    });
    b.sheet(m.cladding, 2, n, |row, i| {
        Vec3::new(
            x(n - 1 - i),
            if row == 0 { low } else { eaves },
            HALL.z + dent(i),
        )
    });
    let n = waves[1];
    let z = move |i: usize| HALL.z * i as f32 / (n - 1) as f32;
    b.sheet(m.cladding, 2, n, |row, i| {
        let z = z(n - 1 - i);
        Vec3::new(-dent(i), if row == 0 { low } else { roof_at(z) }, z)
    });
    b.sheet(m.cladding, 2, n, |row, i| {
        Vec3::new(
            HALL.x + dent(i),
            if row == 0 { low } else { roof_at(z(i)) },
            z(i),
        )
    });
    flashing(b, m, [low, eaves]);
    roof(b, m);
}

/// Strips that close the waves of the cladding above the plinth and below the roof.
fn flashing(b: &mut SceneBuilder, m: &Palette, [low, eaves]: [f32; 2]) {
    b.node("flashing");
    let up = |[x0, x1]: [f32; 2], [z0, z1]: [f32; 2]| {
        [(x0, z0), (x0, z1), (x1, z1), (x1, z0)].map(|(x, z)| Vec3::new(x, low, z))
    };
    let down = |[x0, x1]: [f32; 2], [z0, z1]: [f32; 2], height: fn(f32) -> f32| {
        [(x0, z0), (x1, z0), (x1, z1), (x0, z1)].map(|(x, z)| Vec3::new(x, height(z), z))
    };
    for across in [[-DENT, 0.0], [HALL.z, HALL.z + DENT]] {
        b.quad(m.cladding, up([0.0, HALL.x], across));
        let below = down([0.0, HALL.x], across, |_| 0.0);
        b.quad(m.cladding, below.map(|p| p.with_y(eaves)));
    }
    for across in [[-DENT, 0.0], [HALL.x, HALL.x + DENT]] {
        b.quad(m.cladding, up(across, [0.0, HALL.z]));
        for slope in [[0.0, 0.5 * HALL.z], [0.5 * HALL.z, HALL.z]] {
            b.quad(m.cladding, down(across, slope, roof_at));
        }
    }
}

fn roof(b: &mut SceneBuilder, m: &Palette) {
    b.node("roof");
    for bay in 0..12 {
        let (from, to) = (BAY * bay as f32, BAY * (bay + 1) as f32);
        // A band of glass in each slope of every second bay.
        let bands: &[(f32, f32, bool)] = if bay % 2 == 1 {
            &[
                (0.0, 6.0, false),
                (6.0, 9.0, true),
                (9.0, 12.0, false),
                (12.0, 15.0, false),
                (15.0, 18.0, true),
                (18.0, 24.0, false),
            ]
        } else {
            &[
                (0.0, 6.0, false),
                (6.0, 12.0, false),
                (12.0, 18.0, false),
                (18.0, 24.0, false),
            ]
        };
        for &(near, far, glazed) in bands {
            let at = |x: f32, z: f32| Vec3::new(x, roof_at(z), z);
            let material = if glazed { m.skylight } else { m.cladding };
            b.quad(
                material,
                [at(from, near), at(to, near), at(to, far), at(from, far)],
            );
        }
    }
}

/// A beam of I-shaped section between two points, standing upright as far as it can.
pub(super) fn beam(
    b: &mut SceneBuilder,
    material: usize,
    from: Vec3,
    to: Vec3,
    depth: f32,
    width: f32,
) {
    let along = to - from;
    let length = along.length();
    let axis = along / length;
    let side = if axis.y.abs() > 0.99 {
        Vec3::X
    } else {
        axis.cross(Vec3::Y).normalize()
    };
    let up = side.cross(axis);
    let part = Affine3A::from_mat3_translation(glam::Mat3::from_cols(axis, up, side), from);
    let flange = 0.12 * depth;
    let (d, w) = (depth * 0.5, width * 0.5);
    let open = Sides::without(&[Sides::LEFT, Sides::RIGHT]);
    b.part(part, |b| {
        b.cuboid(
            material,
            Vec3::new(0.0, d - flange, -w),
            Vec3::new(length, d, w),
            open,
        );
        b.cuboid(
            material,
            Vec3::new(0.0, -d, -w),
            Vec3::new(length, flange - d, w),
            open,
        );
        let web = Sides::only(&[Sides::BACK, Sides::FRONT]);
        b.cuboid(
            material,
            Vec3::new(0.0, flange - d, -0.1 * w),
            Vec3::new(length, d - flange, 0.1 * w),
            web,
        );
    });
}

/// A square bar between two points.
pub(super) fn bar(b: &mut SceneBuilder, material: usize, from: Vec3, to: Vec3, width: f32) {
    let along = to - from;
    let axis = along.normalize();
    let part = Affine3A::from_rotation_translation(Quat::from_rotation_arc(Vec3::X, axis), from);
    let w = width * 0.5;
    b.part(part, |b| {
        let ends = Sides::without(&[Sides::LEFT, Sides::RIGHT]);
        b.cuboid(
            material,
            Vec3::new(0.0, -w, -w),
            Vec3::new(along.length(), w, w),
            ends,
        );
    });
}

/// Columns with brackets, girders of the crane, and a truss over each pair of columns.
pub(super) fn frames(b: &mut SceneBuilder, m: &Palette) {
    for i in 0..=12 {
        let x = (BAY * i as f32).clamp(0.3, HALL.x - 0.3);
        b.node(&format!("frame-{}", i + 1));
        for (z, inward) in [(0.45, 1.0), (HALL.z - 0.45, -1.0)] {
            beam(
                b,
                m.steel,
                Vec3::new(x, 0.0, z),
                Vec3::new(x, roof_at(0.0) - 0.3, z),
                0.55,
                0.34,
            );
            beam(
                b,
                m.steel,
                Vec3::new(x, RAIL - 1.0, z + 0.2 * inward),
                Vec3::new(x, RAIL - 1.0, z + 1.25 * inward),
                0.5,
                0.3,
            );
            bar(
                b,
                m.steel,
                Vec3::new(x, RAIL - 2.3, z + 0.2 * inward),
                Vec3::new(x, RAIL - 1.25, z + 1.1 * inward),
                0.14,
            );
        }
        truss(b, m, x);
    }
    b.node("crane-girders");
    for z in [1.45, HALL.z - 1.45] {
        beam(
            b,
            m.steel,
            Vec3::new(0.0, RAIL - 0.4, z),
            Vec3::new(HALL.x, RAIL - 0.4, z),
            0.7,
            0.4,
        );
        b.cuboid(
            m.roll,
            Vec3::new(0.0, RAIL - 0.05, z - 0.05),
            Vec3::new(HALL.x, RAIL + 0.07, z + 0.05),
            Sides::without(&[Sides::LEFT, Sides::RIGHT, Sides::BOTTOM]),
        );
    }
    b.node("purlins");
    for i in 1..12 {
        let z = 2.0 * i as f32;
        beam(
            b,
            m.steel,
            Vec3::new(0.0, roof_at(z) - 0.16, z),
            Vec3::new(HALL.x, roof_at(z) - 0.16, z),
            0.22,
            0.12,
        );
    }
    b.node("bracing");
    for bay in [0, 3, 5, 8, 11] {
        let (from, to) = (BAY * bay as f32 + 0.4, BAY * (bay + 1) as f32 - 0.4);
        for z in [0.3, HALL.z - 0.3] {
            bar(
                b,
                m.rust,
                Vec3::new(from, 3.2, z),
                Vec3::new(to, RAIL - 1.2, z),
                0.1,
            );
            bar(
                b,
                m.rust,
                Vec3::new(to, 3.2, z + 0.12),
                Vec3::new(from, RAIL - 1.2, z + 0.12),
                0.1,
            );
        }
    }
}

/// Two chords with posts and diagonals.
pub(super) fn truss(b: &mut SceneBuilder, m: &Palette, x: f32) {
    let low = roof_at(0.0) - 0.6;
    let panels = 12;
    let z = |i: usize| 0.45 + (HALL.z - 0.9) * i as f32 / panels as f32;
    let top = |i: usize| Vec3::new(x, roof_at(z(i)) - 0.4, z(i));
    let bottom = |i: usize| Vec3::new(x, low, z(i));
    beam(b, m.steel, bottom(0), bottom(panels), 0.24, 0.2);
    // The upper chords end a little before the columns and before each other.
    for end in [0, panels] {
        let (eaves, ridge) = (top(end), top(panels / 2));
        beam(
            b,
            m.steel,
            eaves.lerp(ridge, 0.03),
            eaves.lerp(ridge, 0.99),
            0.24,
            0.2,
        );
    }
    for i in 1..panels {
        bar(b, m.steel, bottom(i), top(i), 0.1);
        let (from, to) = if i <= panels / 2 {
            (bottom(i), top(i - 1))
        } else {
            (bottom(i), top(i + 1))
        };
        bar(b, m.steel, from, to, 0.08);
        // Gusset plates.
        let plate = Vec3::new(0.06, 0.2, 0.24);
        b.cuboid(m.steel, bottom(i) - plate, bottom(i) + plate, Sides::ALL);
    }
}

/// Two rows of lamps under the trusses.
pub(super) fn lamps(b: &mut SceneBuilder, m: &Palette) {
    for i in 0..20 {
        let (column, row) = (i / 2, i % 2);
        let x = 5.0 + 5.55 * column as f32;
        let z = if row == 0 { 6.4 } else { 17.6 };
        b.node_at(
            &format!("lamp-{}", i + 1),
            Affine3A::from_translation(Vec3::new(x, 12.6, z)),
        );
        let hood = [
            (0.34, 0.0),
            (0.30, 0.14),
            (0.12, 0.36),
            (0.12, 0.36),
            (0.10, 0.55),
            (0.10, 0.55),
            (0.0, 0.55),
        ];
        b.lathe(m.shade, &hood, 16);
        let inside = [
            (0.0, 0.30),
            (0.10, 0.30),
            (0.28, 0.13),
            (0.32, 0.0),
            (0.32, 0.0),
            (0.34, 0.0),
        ];
        b.lathe(m.shade, &inside, 16);
        b.lathe(
            m.lamp,
            &[(0.0, 0.06), (0.12, 0.10), (0.14, 0.2), (0.08, 0.29)],
            12,
        );
        bar(
            b,
            m.steel,
            Vec3::new(0.0, 0.55, 0.0),
            Vec3::new(0.0, 1.4, 0.0),
            0.05,
        );
    }
}
