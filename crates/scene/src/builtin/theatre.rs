//! A theatre: a stage behind its arch, raked seats in curved rows, two balconies, a coffered ceiling, many luminaires.
//!
//! The house is 28 x 34 x 14 m, the stage 16 m wide. Luminance in cd/m².

use super::build::{SceneBuilder, Sides};
use crate::{Camera, Material, Scene, Units};
use core::f32::consts::PI;
use glam::{Affine3A, Quat, Vec2, Vec3};
use hemicube_raster::Rgb;

/// Half the width of the house, its depth and height.
const HOUSE: Vec3 = Vec3::new(14.0, 14.0, 34.0);
/// Half the width and the height of the arch.
const ARCH: Vec2 = Vec2::new(8.0, 8.2);
/// Depth of the stage, and its floor above that of the first row.
const STAGE: (f32, f32) = (12.0, 1.1);
/// Centre of the rows' curves in z: far behind the stage.
const CENTRE: f32 = -16.0;
/// Distance of the first row from the edge of the stage, and between rows.
const ROWS: (f32, f32) = (3.4, 1.0);
/// Width of a seat.
const SEAT: f32 = 0.56;

struct Palette {
    carpet: usize,
    wood: usize,
    boards: usize,
    plaster: usize,
    ornament: usize,
    ceiling: usize,
    gold: usize,
    plush: usize,
    frame: usize,
    curtain: usize,
    black: usize,
    cloth: usize,
    dome: usize,
    globe: usize,
    step: usize,
    footlight: usize,
    spot: usize,
    exit: usize,
}

impl Palette {
    fn new(b: &mut SceneBuilder) -> Self {
        let mut light = |name: &str, r: f32, g: f32, blue: f32| {
            b.material(Material {
                emission: Rgb::new(r, g, blue),
                ..Material::diffuse(name, Rgb::new(0.6, 0.6, 0.6))
            })
        };
        let dome = light("coffer-lamp", 9200.0, 6900.0, 4100.0);
        let globe = light("globe", 5200.0, 3600.0, 1900.0);
        let step = light("step-light", 1500.0, 1000.0, 500.0);
        let footlight = light("footlight", 14000.0, 10500.0, 6800.0);
        let spot = light("spot", 90_000.0, 78_000.0, 60_000.0);
        let exit = light("exit-sign", 30.0, 260.0, 70.0);
        let both = |name: &str, r: f32, g: f32, blue: f32| Material {
            double_sided: true,
            ..Material::diffuse(name, Rgb::new(r, g, blue))
        };
        Self {
            carpet: b.diffuse("carpet", 0.24, 0.035, 0.035),
            wood: b.diffuse("walnut", 0.22, 0.12, 0.065),
            boards: b.diffuse("boards", 0.30, 0.20, 0.12),
            plaster: b.diffuse("plaster", 0.66, 0.58, 0.46),
            ornament: b.diffuse("ornament", 0.72, 0.66, 0.56),
            ceiling: b.diffuse("ceiling", 0.70, 0.66, 0.58),
            gold: b.diffuse("gold", 0.68, 0.48, 0.17),
            plush: b.diffuse("plush", 0.42, 0.035, 0.045),
            frame: b.diffuse("seat-frame", 0.10, 0.065, 0.04),
            curtain: b.material(both("curtain", 0.40, 0.03, 0.035)),
            black: b.diffuse("drapes", 0.03, 0.03, 0.035),
            cloth: b.diffuse("backcloth", 0.36, 0.46, 0.62),
            dome,
            globe,
            step,
            footlight,
            spot,
            exit,
        }
    }
}

/// The theatre.
pub(super) fn scene() -> Scene {
    let mut builder = SceneBuilder::new("theatre", Units::Photometric);
    let palette = Palette::new(&mut builder);
    walls(&mut builder, &palette);
    ceiling(&mut builder, &palette);
    stage(&mut builder, &palette);
    arch(&mut builder, &palette);
    stalls(&mut builder, &palette);
    for level in [
        Level {
            floor: 4.6,
            front: 17.0,
            rows: 7,
        },
        Level {
            floor: 8.3,
            front: 21.0,
            rows: 6,
        },
    ] {
        balcony(&mut builder, &palette, &level);
    }
    boxes(&mut builder, &palette);
    for (name, eye, target, fov) in [
        (
            "stalls",
            Vec3::new(-4.2, 4.4, 24.5),
            Vec3::new(1.5, 3.7, -2.0),
            66.0_f32,
        ),
        (
            "stage",
            Vec3::new(1.5, 3.6, -5.0),
            Vec3::new(-1.5, 5.4, 20.0),
            74.0,
        ),
        (
            "balcony",
            Vec3::new(7.5, 11.4, 29.5),
            Vec3::new(-2.5, 3.6, 3.0),
            62.0,
        ),
        (
            "boxes",
            Vec3::new(-9.5, 6.2, 13.0),
            Vec3::new(9.0, 5.4, 9.0),
            68.0,
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

/// Height of the stalls' floor: a gentle rake from the first row on.
fn rake(z: f32) -> f32 {
    0.13 * (z - ROWS.0).max(0.0)
}

fn walls(b: &mut SceneBuilder, m: &Palette) {
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
fn sconce(b: &mut SceneBuilder, m: &Palette, place: Vec3, side: f32) {
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
        b.tube(m.gold, &[place + out * 0.18, end], 0.014, 6);
        b.sphere(m.globe, end + Vec3::Y * 0.11, 0.09, 10);
    }
}

/// Coffers in rows, each a stepped box with a lamp in its middle; a ring of light around the chandelier.
fn ceiling(b: &mut SceneBuilder, m: &Palette) {
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
fn chandelier(b: &mut SceneBuilder, m: &Palette) {
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
            b.sphere(m.globe, out * radius + Vec3::Y * (y + 0.12), 0.085, 10);
        }
    }
}

fn stage(b: &mut SceneBuilder, m: &Palette) {
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
                low + Vec3::new(0.22, 0.02, -0.001),
                low + Vec3::new(0.02, 0.02, -0.001),
                low + Vec3::new(0.02, 0.12, -0.001),
                low + Vec3::new(0.22, 0.12, -0.001),
            ],
        );
        b.quad(
            m.frame,
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
fn lantern(b: &mut SceneBuilder, m: &Palette, place: Vec3, tilt: f32) {
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
fn scenery(b: &mut SceneBuilder, m: &Palette, floor: f32) {
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
fn folds(b: &mut SceneBuilder, material: usize, from: Vec3, to: Vec3, height: f32, waves: usize) {
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
fn arch(b: &mut SceneBuilder, m: &Palette) {
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

/// A seat that looks along -z, on its floor.
fn seat(b: &mut SceneBuilder, m: &Palette) {
    let half = 0.5 * SEAT;
    b.rounded(
        m.plush,
        Vec3::new(0.06 - half, 0.36, -0.22),
        Vec3::new(half - 0.06, 0.48, 0.2),
        0.04,
        1,
    );
    b.plate(m.plush, 4, 3, |u, v, w| {
        let x = (1.0 - 2.0 * u) * (half - 0.06);
        let hollow = 0.03 * (1.0 - (2.0 * u - 1.0).powi(2));
        Vec3::new(x, 0.5 + 0.5 * v, 0.22 + 0.1 * v + hollow - 0.07 * w)
    });
    for x in [-half + 0.005, half - 0.045] {
        b.cuboid(
            m.frame,
            Vec3::new(x, 0.0, -0.16),
            Vec3::new(x + 0.04, 0.6, 0.22),
            Sides::without(&[Sides::BOTTOM]),
        );
        b.cuboid(
            m.wood,
            Vec3::new(x - 0.002, 0.6, -0.2),
            Vec3::new(x + 0.042, 0.64, 0.24),
            Sides::ALL,
        );
    }
}

/// A row of seats on a circle around the stage, from angle to angle, but for the aisles.
fn row_of_seats(
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
    let mut angle = first;
    while angle <= -first + 1e-4 {
        let x = radius * angle.sin();
        if aisles.iter().all(|aisle| (x - aisle).abs() > 0.85) {
            let z = CENTRE + radius * angle.cos();
            let place = Affine3A::from_rotation_translation(
                Quat::from_rotation_y(angle),
                Vec3::new(x, floor, z),
            );
            b.part(place, |b| seat(b, m));
        }
        angle += step;
    }
}

fn stalls(b: &mut SceneBuilder, m: &Palette) {
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

/// A balcony: height of its lowest floor, where its front stands in the middle, how many rows it has.
struct Level {
    floor: f32,
    front: f32,
    rows: usize,
}

/// Treads that rise towards the back, a front with lamps on it, seats.
fn balcony(b: &mut SceneBuilder, m: &Palette, level: &Level) {
    let (columns, reach) = (29, HOUSE.x);
    let name = if level.floor < 6.0 { "lower" } else { "upper" };
    let at = |radius: f32, column: usize, y: f32| {
        let x = reach * (column as f32 / (columns - 1) as f32 * 2.0 - 1.0);
        let z = CENTRE + (radius * radius - x * x).max(0.0).sqrt();
        Vec3::new(x, y, z.min(HOUSE.z))
    };
    let radius = level.front - CENTRE;
    let rise = 0.42;
    b.node(&format!("{name}-balcony"));
    // Underside, front, and the parapet's top and inner side.
    let last = radius + level.rows as f32 * ROWS.1;
    b.sheet(m.ceiling, 4, columns, |row, column| {
        let share = row as f32 / 3.0;
        let to_wall = at(last, column, 0.0).with_z(HOUSE.z);
        let from = at(radius, column, 0.0);
        from.lerp(to_wall, share) + Vec3::Y * (level.floor - 0.35 + 0.5 * share)
    });
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
        b.sphere(m.globe, place, 0.075, 10);
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
fn boxes(b: &mut SceneBuilder, m: &Palette) {
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
                b.part(turn, |b| seat(b, m));
            }
        }
    }
}

/// A body of revolution around an upright axis through a place.
fn lathe_at(
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
