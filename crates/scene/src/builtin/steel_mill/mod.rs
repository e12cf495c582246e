//! The hall of a steel mill: crane, ladles, pipes, trusses, and a strip that glows on its way through the stands.
//!
//! 60 x 24 x 17 m, some 30,000 polygons. Luminance in cd/m².

mod crane;
mod furnace;
mod hall;
mod line;
mod pipes;

use super::build::SceneBuilder;
use crate::{Material, Scene, Units};
use crane::crane;
use furnace::{furnace, ladles};
use glam::Vec3;
use hall::{frames, hall, lamps};
use hemicube_raster::Rgb;
use line::{line, stands};
use pipes::{pipes, walkway};

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
    builder.views(&[
        (
            "hall",
            Vec3::new(2.0, 6.2, 20.5),
            Vec3::new(34.0, 3.4, 8.0),
            62.0,
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
    ]);
    builder.finish()
}
