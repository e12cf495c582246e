//! The hall of a steel mill: crane, ladles, pipes, trusses, and a strip that glows on its way through the stands.
//!
//! 60 x 24 x 17 m, some 30,000 polygons. Luminance in cd/m².

use super::build::{SceneBuilder, Sides};
use crate::{Camera, Material, Scene, Units};
use core::f32::consts::{FRAC_PI_2, TAU};
use glam::{Affine3A, Quat, Vec3};
use hemicube_raster::Rgb;

/// Length (x), height (y) and depth (z).
const HALL: Vec3 = Vec3::new(60.0, 17.0, 24.0);
/// Distance between the frames of the hall.
const BAY: f32 = 5.0;
/// Top of the crane's girders.
const RAIL: f32 = 11.0;
/// The rolling line: its middle in z, its height, half its width.
const LINE: (f32, f32, f32) = (7.0, 0.95, 0.9);

struct Palette {
    floor: usize,
    wall: usize,
    cladding: usize,
    steel: usize,
    rust: usize,
    crane: usize,
    machine: usize,
    roll: usize,
    pipe: usize,
    hot_pipe: usize,
    brick: usize,
    rail: usize,
    strip: usize,
    melt: usize,
    mouth: usize,
    lamp: usize,
    shade: usize,
    skylight: usize,
}

impl Palette {
    fn new(b: &mut SceneBuilder) -> Self {
        let mut light = |name: &str, emission: Rgb| {
            b.material(Material {
                emission,
                ..Material::diffuse(name, Rgb::new(0.3, 0.3, 0.3))
            })
        };
        let strip = light("strip", Rgb::new(9500.0, 3100.0, 420.0));
        let melt = light("melt", Rgb::new(30000.0, 13000.0, 3200.0));
        let mouth = light("furnace-mouth", Rgb::new(16000.0, 6000.0, 1100.0));
        let lamp = light("lamp", Rgb::new(15500.0, 16500.0, 17500.0));
        let skylight = light("skylight", Rgb::new(210.0, 290.0, 430.0));
        Self {
            floor: b.diffuse("floor", 0.17, 0.16, 0.15),
            wall: b.diffuse("wall", 0.32, 0.29, 0.26),
            cladding: b.diffuse("cladding", 0.36, 0.38, 0.40),
            steel: b.diffuse("steelwork", 0.22, 0.24, 0.25),
            rust: b.diffuse("rust", 0.24, 0.12, 0.07),
            crane: b.diffuse("crane", 0.62, 0.42, 0.06),
            machine: b.diffuse("machine", 0.10, 0.22, 0.18),
            roll: b.diffuse("roll", 0.42, 0.41, 0.40),
            pipe: b.diffuse("pipe", 0.47, 0.47, 0.46),
            hot_pipe: b.diffuse("hot-pipe", 0.45, 0.13, 0.08),
            brick: b.diffuse("brick", 0.30, 0.17, 0.12),
            rail: b.diffuse("railing", 0.66, 0.50, 0.08),
            shade: b.diffuse("shade", 0.55, 0.55, 0.54),
            strip,
            melt,
            mouth,
            lamp,
            skylight,
        }
    }
}

/// The hall.
pub(super) fn scene() -> Scene {
    let mut builder = SceneBuilder::new("steel-mill", Units::Photometric);
    let palette = Palette::new(&mut builder);
    hall(&mut builder, &palette);
    frames(&mut builder, &palette);
    lamps(&mut builder, &palette);
    line(&mut builder, &palette);
    stands(&mut builder, &palette);
    furnace(&mut builder, &palette);
    crane(&mut builder, &palette);
    ladles(&mut builder, &palette);
    pipes(&mut builder, &palette);
    walkway(&mut builder, &palette);
    for (name, eye, target, fov) in [
        (
            "hall",
            Vec3::new(2.0, 6.2, 20.5),
            Vec3::new(34.0, 3.4, 8.0),
            62.0_f32,
        ),
        (
            "strip",
            Vec3::new(47.0, 3.1, 12.5),
            Vec3::new(27.0, 1.2, 6.2),
            56.0,
        ),
        (
            "crane",
            Vec3::new(14.0, 1.8, 21.0),
            Vec3::new(29.0, 8.4, 13.0),
            58.0,
        ),
        (
            "furnace",
            Vec3::new(17.5, 2.4, 14.0),
            Vec3::new(3.0, 3.0, 7.5),
            58.0,
        ),
    ] {
        builder.camera(Camera::looking_at(
            name,
            eye,
            target,
            Vec3::Y,
            fov.to_radians(),
        ));
    }
    builder.finish()
}

/// Height of the roof over z: two slopes.
fn roof_at(z: f32) -> f32 {
    HALL.y - 2.4 * (z / HALL.z - 0.5).abs() * 2.0
}

fn hall(b: &mut SceneBuilder, m: &Palette) {
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
    let dent = |i: usize| if i.is_multiple_of(2) { 0.0 } else { 0.12 };
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
fn beam(b: &mut SceneBuilder, material: usize, from: Vec3, to: Vec3, depth: f32, width: f32) {
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
fn bar(b: &mut SceneBuilder, material: usize, from: Vec3, to: Vec3, width: f32) {
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
fn frames(b: &mut SceneBuilder, m: &Palette) {
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
                Vec3::new(to, 3.2, z),
                Vec3::new(from, RAIL - 1.2, z),
                0.1,
            );
        }
    }
}

/// Two chords with posts and diagonals.
fn truss(b: &mut SceneBuilder, m: &Palette, x: f32) {
    let low = roof_at(0.0) - 0.6;
    let panels = 12;
    let z = |i: usize| 0.45 + (HALL.z - 0.9) * i as f32 / panels as f32;
    let top = |i: usize| Vec3::new(x, roof_at(z(i)) - 0.4, z(i));
    let bottom = |i: usize| Vec3::new(x, low, z(i));
    beam(b, m.steel, bottom(0), bottom(panels), 0.24, 0.2);
    beam(b, m.steel, top(0), top(panels / 2), 0.24, 0.2);
    beam(b, m.steel, top(panels / 2), top(panels), 0.24, 0.2);
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
fn lamps(b: &mut SceneBuilder, m: &Palette) {
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

/// A table of rollers, and the strip on it.
fn line(b: &mut SceneBuilder, m: &Palette) {
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
fn stands(b: &mut SceneBuilder, m: &Palette) {
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

fn motor(b: &mut SceneBuilder, m: &Palette, z: f32) {
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

/// A block of brick whose mouths glow, with a chute to the line.
fn furnace(b: &mut SceneBuilder, m: &Palette) {
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
            (glam::Vec2::new(z, 0.8), glam::Vec2::new(z + 1.9, 2.3))
        })
        .collect();
    let flipped: Vec<_> = mouths
        .iter()
        .map(|(a, c)| {
            (
                glam::Vec2::new(high.z - c.x, a.y),
                glam::Vec2::new(high.z - a.x, c.y),
            )
        })
        .collect();
    let origin = Vec3::new(high.x, 0.0, high.z);
    b.rectangle_with_holes(
        m.brick,
        origin,
        [Vec3::NEG_Z, Vec3::Y],
        glam::Vec2::new(high.z - low.z, high.y),
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

/// A bridge of two girders with a trolley, its cabin, ropes and hook.
fn crane(b: &mut SceneBuilder, m: &Palette) {
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

/// One ladle hangs from the crane, three wait on their stands.
fn ladles(b: &mut SceneBuilder, m: &Palette) {
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

fn ladle(b: &mut SceneBuilder, m: &Palette, is_full: bool) {
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

/// Pipes along the northern wall, with flanges, bends and valves.
fn pipes(b: &mut SceneBuilder, m: &Palette) {
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

fn valve(b: &mut SceneBuilder, m: &Palette, place: Vec3, radius: f32) {
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
fn walkway(b: &mut SceneBuilder, m: &Palette) {
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
