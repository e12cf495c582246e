//! Mirrors in a room, by maps and by rays.

use super::{panel_size, relative_rms};
use crate::exhibit::{GalleryError, Piece, Request};
use crate::sheet::{Cell, sheet};
use glam::Vec3;
use hemicube_raster::environment::{
    Bounds, Choice, EnvironmentMap, EnvironmentSet, Probe, Projection, reflected,
};
use hemicube_raster::{Image, Rgb};
use rayon::prelude::*;
use std::fmt::Write as _;

/// Samples in each direction of a pixel.
const SAMPLES: usize = 2;

const ROOM: Bounds = Bounds {
    low: Vec3::new(-3.0, 0.0, -4.0),
    high: Vec3::new(3.0, 3.0, 4.0),
};

/// The piece of furniture that box projection knows nothing of.
const CHEST: Bounds = Bounds {
    low: Vec3::new(1.6, 0.0, -3.2),
    high: Vec3::new(2.6, 1.1, -1.8),
};

/// A mirror ball.
const BALL: (Vec3, f32) = (Vec3::new(-0.6, 0.9, -1.2), 0.9);

/// Where maps are taken.
const PLACES: [Vec3; 2] = [Vec3::new(-1.5, 1.3, 1.5), Vec3::new(1.2, 1.3, -0.4)];

const EYE: Vec3 = Vec3::new(0.4, 1.6, 3.6);

/// Four pictures and their errors.
pub fn draw(request: &Request) -> Result<Vec<Piece>, GalleryError> {
    let (width, height) = panel_size(request, (420, 320))?;
    let probe = |position: Vec3| Probe {
        position,
        map: EnvironmentMap::from_fn(Projection::Cube, 256, 2, |d| matte(position, d)),
        room: Some(ROOM),
    };
    let set = EnvironmentSet::new(PLACES.map(probe).to_vec());
    let truth = picture(width, height, matte);
    let mut table = String::from("lookup,relative_rms\n");
    let mut cells = vec![Cell::new(truth.clone(), &["traced rays", "the truth"])];
    let ways = [
        (Choice::Nearest, "nearest map"),
        (Choice::Blend, "two maps blended"),
        (Choice::BoxProjected, "blended and box-projected"),
    ];
    for (choice, name) in ways {
        let image = picture(width, height, |point, d| set.radiance(point, d, choice));
        let error = relative_rms(&image, &truth);
        let _ = writeln!(table, "{name},{error:.6}");
        let figures = format!("RMS error {:.1} % of mean", 100.0 * error);
        cells.push(Cell::new(image, &[name, &figures]));
    }
    Ok(vec![
        Piece::sheet("", &sheet(&cells, 2))?,
        Piece::csv("", table),
    ])
}

/// The room with ball and floor as mirrors; `mirrored` is what they show: light at a point from a direction.
fn picture(width: usize, height: usize, mirrored: impl Fn(Vec3, Vec3) -> Rgb + Sync) -> Image<Rgb> {
    let forward = (Vec3::new(-0.1, 0.75, -2.0) - EYE).normalize();
    let right = forward.cross(Vec3::Y).normalize();
    let up = right.cross(forward);
    let scale = 1.1 / height as f32;
    let sample = |x: f32, y: f32| {
        let (x, y) = (
            (x - width as f32 / 2.0) * scale,
            (height as f32 / 2.0 - y) * scale,
        );
        seen((forward + right * x + up * y).normalize(), &mirrored)
    };
    let pixel = |i: usize| {
        let at = |from: usize, k: usize| from as f32 + (k as f32 + 0.5) / SAMPLES as f32;
        let samples = (0..SAMPLES * SAMPLES)
            .map(|k| sample(at(i % width, k % SAMPLES), at(i / width, k / SAMPLES)));
        samples.sum::<Rgb>() / (SAMPLES * SAMPLES) as f32
    };
    let pixels = (0..width * height).into_par_iter().map(pixel).collect();
    Image::from_pixels(width, height, pixels).expect("one colour for each pixel")
}

/// What the eye sees in a direction of unit length.
fn seen(d: Vec3, mirrored: &impl Fn(Vec3, Vec3) -> Rgb) -> Rgb {
    let (point, color, normal) = hit(EYE, d);
    if let Some(distance) = ball_at(EYE, d).filter(|&t| t < point.distance(EYE)) {
        let point = EYE + distance * d;
        let normal = (point - BALL.0) / BALL.1;
        return 0.9 * mirrored(point + 1e-4 * normal, reflected(normal, -d));
    }
    if normal == Vec3::Y && point.y < 0.01 {
        return 0.5 * color + 0.5 * mirrored(point + 1e-4 * normal, reflected(normal, -d));
    }
    color
}

/// Light from a direction, all surfaces matte, the ball left out: what maps are made of and what a mirror shows.
fn matte(from: Vec3, d: Vec3) -> Rgb {
    hit(from, d).1
}

/// Where a ray ends: point, colour, normal.
fn hit(from: Vec3, d: Vec3) -> (Vec3, Rgb, Vec3) {
    if let Some((distance, normal)) = chest_at(from, d) {
        let light = 0.35 + 0.65 * normal.dot(Vec3::new(-0.3, 0.8, 0.5)).max(0.0);
        return (
            from + distance * d,
            Rgb::new(0.75, 0.55, 0.2) * light,
            normal,
        );
    }
    let wall = |axis: usize| {
        let wall = if d[axis] > 0.0 {
            ROOM.high[axis]
        } else {
            ROOM.low[axis]
        };
        if d[axis] == 0.0 {
            f32::INFINITY
        } else {
            (wall - from[axis]) / d[axis]
        }
    };
    let axis = (0..3)
        .min_by(|&a, &b| wall(a).total_cmp(&wall(b)))
        .unwrap_or(0);
    let point = from + wall(axis) * d;
    let mut normal = Vec3::ZERO;
    normal[axis] = -d[axis].signum();
    (point, wall_color(point, normal), normal)
}

/// Tiles of 1 metre, another colour on each wall, and a lamp in the ceiling.
fn wall_color(point: Vec3, normal: Vec3) -> Rgb {
    let cell = |x: f32| (x + 100.001).floor();
    let is_dark = (cell(point.x) + cell(point.y) + cell(point.z)).rem_euclid(2.0) < 1.0;
    if normal == Vec3::NEG_Y {
        let is_lamp = point.x.abs() < 0.8 && point.z.abs() < 1.2;
        return Rgb::splat(if is_lamp { 1.0 } else { 0.5 });
    }
    let color = match (normal.x, normal.z) {
        (x, _) if x > 0.0 => Rgb::new(0.65, 0.15, 0.12),
        (x, _) if x < 0.0 => Rgb::new(0.15, 0.45, 0.2),
        (_, z) if z > 0.0 => Rgb::new(0.2, 0.3, 0.65),
        (_, z) if z < 0.0 => Rgb::new(0.55, 0.5, 0.2),
        _ => Rgb::new(0.4, 0.36, 0.32),
    };
    color * if is_dark { 0.6 } else { 1.0 }
}

/// Distance and normal where a ray enters the chest (slabs; Kay and Kajiya 1986).
fn chest_at(from: Vec3, d: Vec3) -> Option<(f32, Vec3)> {
    let (a, b) = ((CHEST.low - from) / d, (CHEST.high - from) / d);
    let (near, far) = (a.min(b), a.max(b));
    let (enter, leave) = (near.max_element(), far.min_element());
    if !(enter > 0.0 && enter < leave) {
        return None;
    }
    let axis = (0..3).find(|&axis| near[axis] == enter)?;
    let mut normal = Vec3::ZERO;
    normal[axis] = -d[axis].signum();
    Some((enter, normal))
}

/// Distance where a ray of unit length meets the ball.
fn ball_at(from: Vec3, d: Vec3) -> Option<f32> {
    let to = from - BALL.0;
    let half = to.dot(d);
    let root = half * half - to.length_squared() + BALL.1 * BALL.1;
    (root > 0.0 && half < 0.0).then(|| -half - root.sqrt())
}
