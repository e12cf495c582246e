//! Environments that need no file.

use glam::Vec3;
use hemicube_raster::Rgb;

/// Letters of 3 x 5 cells, rows from the top.
const GLYPHS: [(char, [u8; 5]); 5] = [
    ('+', [0b000, 0b010, 0b111, 0b010, 0b000]),
    ('-', [0b000, 0b000, 0b111, 0b000, 0b000]),
    ('X', [0b101, 0b101, 0b010, 0b101, 0b101]),
    ('Y', [0b101, 0b101, 0b010, 0b010, 0b010]),
    ('Z', [0b111, 0b001, 0b010, 0b100, 0b111]),
];

/// The six directions with a colour each: colour, and its label, of two letters.
const SIDES: [([f32; 3], &str); 6] = [
    ([0.80, 0.20, 0.15], "+X"),
    ([0.15, 0.60, 0.65], "-X"),
    ([0.25, 0.65, 0.20], "+Y"),
    ([0.60, 0.25, 0.60], "-Y"),
    ([0.20, 0.30, 0.80], "-Z"),
    ([0.75, 0.60, 0.15], "+Z"),
];

/// Directions labelled with their axes, with lines every 15 degrees of latitude and longitude.
pub fn labelled(d: Vec3) -> Rgb {
    let (face, u, v) = side_of(d);
    let (color, label) = SIDES[face];
    let color = Rgb::from(color);
    if is_ink(label, u, v) {
        return Rgb::WHITE;
    }
    let degrees = |x: f32| x.to_degrees() / 15.0;
    let latitude = degrees(d.normalize().y.clamp(-1.0, 1.0).asin());
    let longitude = degrees(d.x.atan2(-d.z));
    let near = |x: f32, width: f32| (x - x.round()).abs() < width;
    let shrink = d.x.hypot(d.z) / d.length();
    if near(latitude, 0.04) || near(longitude, 0.04 / shrink.max(0.08)) {
        return color * 0.35;
    }
    color
}

/// The side of a cube that a direction meets, and where, as an eye in the middle sees it: right and up from -1 to 1.
fn side_of(d: Vec3) -> (usize, f32, f32) {
    let a = d.abs();
    if a.x >= a.y && a.x >= a.z {
        let (face, right) = if d.x > 0.0 { (0, d.z) } else { (1, -d.z) };
        (face, right / a.x, d.y / a.x)
    } else if a.y >= a.z {
        let (face, up) = if d.y > 0.0 { (2, d.z) } else { (3, -d.z) };
        (face, d.x / a.y, up / a.y)
    } else {
        let (face, right) = if d.z < 0.0 { (4, d.x) } else { (5, -d.x) };
        (face, right / a.z, d.y / a.z)
    }
}

/// Whether a place on a side is part of its label: seven cells of 0.12 wide and five high.
fn is_ink(label: &str, right: f32, up: f32) -> bool {
    let (column, row) = ((right / 0.12 + 3.5).floor(), (2.5 - up / 0.12).floor());
    if !(0.0..7.0).contains(&column) || !(0.0..5.0).contains(&row) {
        return false;
    }
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "cells from 0 to 6"
    )]
    let (column, row) = (column as usize, row as usize);
    let letter = label.chars().nth(column / 4);
    let glyph = GLYPHS.iter().find(|(c, _)| Some(*c) == letter);
    column % 4 < 3 && glyph.is_some_and(|(_, rows)| rows[row] >> (2 - column % 4) & 1 == 1)
}

/// An evening: a low sun, two lamps behind, and a tiled ground.
pub fn evening(d: Vec3) -> Rgb {
    let d = d.normalize();
    let spot = |to: Vec3, sharp: f32| ((d.dot(to.normalize()) - 1.0) * sharp).exp();
    let lamps = Rgb::new(14.0, 11.0, 7.0)
        * (spot(Vec3::new(-0.9, 0.5, 0.8), 900.0) + spot(Vec3::new(0.8, 0.7, 0.9), 900.0));
    if d.y < 0.0 {
        let (x, z) = (1.5 * d.x / d.y, 1.5 * d.z / d.y);
        let is_dark = (x.floor() + z.floor()).rem_euclid(2.0) < 1.0;
        let tile = Rgb::new(0.42, 0.36, 0.30) * if is_dark { 0.45 } else { 1.0 };
        // Far tiles are too small to be seen; they fade into their mean.
        return Rgb::new(0.30, 0.26, 0.22).lerp(tile, (-6.0 * d.y).min(1.0));
    }
    let blue = Rgb::new(0.18, 0.32, 0.70);
    let horizon = Rgb::new(1.1, 0.62, 0.35);
    let sun = Rgb::new(60.0, 38.0, 18.0) * spot(Vec3::new(0.45, 0.22, -1.0), 1200.0);
    let glow = Rgb::new(1.6, 0.8, 0.3) * spot(Vec3::new(0.45, 0.22, -1.0), 12.0);
    blue.lerp(horizon, (-5.0 * d.y).exp()) + sun + glow + lamps
}
