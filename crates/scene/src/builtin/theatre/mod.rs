//! A theatre: a stage behind its arch, raked seats in curved rows, two balconies, a coffered ceiling, many luminaires.
//!
//! The house is 28 x 34 x 14 m, the stage 16 m wide. Luminance in cd/m².

mod house;
mod seats;
mod stage;

use super::build::SceneBuilder;
use crate::{Material, Scene, Units};
use glam::{Vec2, Vec3};
use hemicube_raster::Rgb;
use house::{ceiling, walls};
use seats::{Level, balcony, boxes, stalls};
use stage::{arch, stage};

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
    soffit: usize,
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
        let soffit = light("soffit-lamp", 3600.0, 2600.0, 1500.0);
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
            soffit,
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
            rise: 0.3,
        },
        Level {
            floor: 8.3,
            front: 21.0,
            rows: 6,
            rise: 0.42,
        },
    ] {
        balcony(&mut builder, &palette, &level);
    }
    boxes(&mut builder, &palette);
    builder.views(&[
        (
            "stalls",
            Vec3::new(-4.2, 3.4, 16.2),
            Vec3::new(1.5, 4.4, -2.0),
            66.0,
        ),
        (
            "stage",
            Vec3::new(1.5, 3.6, -5.0),
            Vec3::new(-1.5, 5.4, 20.0),
            74.0,
        ),
        (
            "balcony",
            Vec3::new(6.0, 12.6, 27.0),
            Vec3::new(-2.5, 5.0, 3.0),
            62.0,
        ),
        (
            "boxes",
            Vec3::new(-9.5, 6.2, 13.0),
            Vec3::new(9.0, 5.4, 9.0),
            68.0,
        ),
    ]);
    builder.finish()
}

/// Height of the stalls' floor: a gentle rake from the first row on.
fn rake(z: f32) -> f32 {
    0.13 * (z - ROWS.0).max(0.0)
}
