//! Plants in pots.

use super::super::build::SceneBuilder;
use super::paint::hash;
use super::palette::Palette;
use glam::{Affine3A, Vec3};
use std::f32::consts::{PI, TAU};

/// The angle between one leaf and the next around a stem.
const GOLDEN: f32 = 2.399_963;

pub(super) fn draw(b: &mut SceneBuilder, m: &Palette) {
    fig(b, m, "fig tree", Vec3::new(0.52, 0.0, 4.12), 1.62, 34);
    fig(b, m, "young fig", Vec3::new(2.74, 0.0, 0.36), 1.12, 20);
    snake_plant(b, m, Vec3::new(0.34, 0.0, 0.26));
    for (i, z) in [1.18, 3.32].into_iter().enumerate() {
        herb(
            b,
            m,
            &format!("sill plant {}", i + 1),
            Vec3::new(-0.03, 0.80, z),
            0.055,
        );
    }
    trailing(b, m, Vec3::new(5.05, 2.12, 0.20));
    branches(b, m, Vec3::new(5.76, 0.74 + 0.28, 2.42));
}

/// A pot of this height with earth in it; gives the height of the earth.
fn pot(b: &mut SceneBuilder, material: usize, soil: usize, radius: f32, height: f32) -> f32 {
    let (foot, rim) = (radius * 0.74, radius * 1.03);
    let earth = height * 0.9;
    b.lathe(
        material,
        &[
            (0.0, 0.002),
            (foot, 0.002),
            (foot, 0.002),
            (radius, height * 0.86),
            (rim, height * 0.88),
            (rim, height),
            (rim, height),
            (radius * 0.92, height),
            (radius * 0.92, height),
            (radius * 0.9, earth),
        ],
        18,
    );
    b.lathe(
        soil,
        &[
            (radius * 0.9, earth),
            (radius * 0.5, earth * 1.02),
            (0.0, earth * 1.03),
        ],
        18,
    );
    earth
}

/// A leaf from `base` along `out`, which is of unit length: it rises and then droops.
fn leaf(
    b: &mut SceneBuilder,
    material: usize,
    base: Vec3,
    out: Vec3,
    length: f32,
    width: f32,
    droop: f32,
    rows: usize,
) {
    let side = out.cross(Vec3::Y).normalize_or(Vec3::X);
    b.sheet(material, rows, 3, |row, column| {
        let t = row as f32 / (rows - 1) as f32;
        let centre = base + out * (length * t) - Vec3::Y * (droop * length * t * t);
        let half = (width * 0.5 * (PI * (0.04 + 0.92 * t).powf(0.9)).sin()).max(0.0015);
        let across = column as f32 - 1.0;
        centre + side * (half * across) + Vec3::Y * (0.25 * half * across.abs())
    });
}

/// A slender stem with large leaves all around.
fn fig(b: &mut SceneBuilder, m: &Palette, name: &str, place: Vec3, height: f32, leaves: i32) {
    b.node_at(name, Affine3A::from_translation(place));
    let earth = pot(
        b,
        m.ceramic,
        m.soil,
        0.10 + 0.045 * height,
        0.20 + 0.06 * height,
    );
    let stem = |t: f32| {
        Vec3::new(
            0.04 * (3.0 * t).sin(),
            earth - 0.01 + (height - earth) * t,
            0.03 * (4.0 * t).sin(),
        )
    };
    let path: Vec<Vec3> = (0..=6).map(|i| stem(i as f32 / 6.0)).collect();
    b.tube(m.bark, &path, 0.011, 7);
    let seed = leaves.cast_unsigned();
    for i in 0..leaves {
        let t = 0.26 + 0.74 * (i as f32 + 0.5) / leaves as f32;
        let angle = GOLDEN * i as f32;
        let rise = 0.25 + 0.75 * t * t + 0.25 * hash(i, 1, seed);
        let out = Vec3::new(angle.cos(), rise, angle.sin()).normalize();
        let size = (0.20 + 0.09 * hash(i, 2, seed)) * (1.15 - 0.45 * t);
        let start = stem(t);
        leaf(b, m.leaf, start, out, size + 0.03, size * 0.62, 0.55, 5);
    }
}

/// Upright blades that twist.
fn snake_plant(b: &mut SceneBuilder, m: &Palette, place: Vec3) {
    b.node_at("snake plant", Affine3A::from_translation(place));
    let earth = pot(b, m.clay, m.soil, 0.13, 0.26);
    for i in 0..11 {
        let angle = GOLDEN * i as f32;
        let (sin, cos) = angle.sin_cos();
        let out = Vec3::new(cos, 0.0, sin);
        let height = 0.42 + 0.30 * hash(i, 3, 7);
        let foot = out * (0.015 + 0.007 * i as f32) + Vec3::Y * (earth - 0.005);
        b.sheet(m.blade, 6, 3, |row, column| {
            let t = row as f32 / 5.0;
            let turn = angle + 1.2 * t;
            let side = Vec3::new(-turn.sin(), 0.0, turn.cos());
            let half = 0.028 * (1.0 - t.powi(3)).max(0.03) * (0.7 + 0.6 * t);
            let across = column as f32 - 1.0;
            foot + out * (0.10 * t * t)
                + Vec3::Y * (height * t)
                + side * (half * across)
                + out * (0.3 * half * across.abs())
        });
    }
}

/// A small pot with a tuft.
fn herb(b: &mut SceneBuilder, m: &Palette, name: &str, place: Vec3, radius: f32) {
    b.node_at(name, Affine3A::from_translation(place));
    let earth = pot(b, m.clay, m.soil, radius, radius * 1.9);
    for i in 0..16 {
        let angle = GOLDEN * i as f32;
        let out = Vec3::new(angle.cos(), 0.6 + 1.4 * hash(i, 4, 9), angle.sin()).normalize();
        leaf(
            b,
            m.blade,
            Vec3::Y * (earth - 0.003),
            out,
            0.10 + 0.06 * hash(i, 5, 9),
            0.028,
            0.5,
            4,
        );
    }
}

/// A pot on the shelf from which shoots hang.
fn trailing(b: &mut SceneBuilder, m: &Palette, place: Vec3) {
    b.node_at("trailing plant", Affine3A::from_translation(place));
    let earth = pot(b, m.ceramic, m.soil, 0.085, 0.14);
    for shoot in 0..5 {
        let angle = PI * (0.5 - 0.62 + 0.31 * shoot as f32);
        let out = Vec3::new(angle.cos(), 0.0, angle.sin().abs());
        let fall = 0.25 + 0.13 * ((shoot * 3) % 5) as f32;
        let point = |t: f32| {
            let reach = 0.20 * (1.0 - (1.0 - t).powi(3));
            out * (0.03 + reach)
                + Vec3::Y * (earth + 0.05 * (PI * (2.0 * t).min(1.0)).sin() - fall * t * t)
        };
        let path: Vec<Vec3> = (0..=6).map(|i| point(i as f32 / 6.0)).collect();
        b.tube(m.leaf, &path, 0.0025, 3);
        for i in 1..9 {
            let turn = angle + GOLDEN * i as f32;
            let direction = Vec3::new(turn.cos(), -0.1, turn.sin().abs()).normalize();
            leaf(
                b,
                m.leaf,
                point(i as f32 / 8.0),
                direction,
                0.075,
                0.05,
                0.5,
                4,
            );
        }
    }
}

/// Bare branches with buds in the vase.
fn branches(b: &mut SceneBuilder, m: &Palette, place: Vec3) {
    b.node_at("branches", Affine3A::from_translation(place));
    for i in 0..5 {
        let (sin, cos) = (TAU * (i as f32 + 0.2) / 5.0).sin_cos();
        let tilt = 0.14 + 0.05 * hash(i, 6, 3);
        let point = |t: f32| {
            Vec3::new(
                0.7 * tilt * cos * t * (1.0 + t),
                0.52 * t * (1.0 - 0.1 * tilt),
                tilt * sin * t * (1.0 + t),
            )
        };
        let path: Vec<Vec3> = (0..=5).map(|k| point(k as f32 / 5.0)).collect();
        b.tube(m.bark, &path, 0.003, 4);
        for k in 0..5 {
            let at = point(0.4 + 0.12 * k as f32)
                + Vec3::new(0.008 * (k as f32).sin(), 0.0, 0.008 * (k as f32).cos());
            b.sphere(m.linen, at, 0.011, 4);
        }
    }
}
