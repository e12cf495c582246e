//! Light that glitters on a bumpy plane, near and far.

use crate::sheet::{Cell, cell_size, sheet};
use crate::stage::{Camera, Fragment, Mesh, Sampling, draw as draw_stage};
use crate::{GalleryError, Piece, Request};
use core::f32::consts::TAU;
use glam::{Vec2, Vec3};
use hemicube_chart::{Chart, Curve, Scale};
use hemicube_raster::bump::{HeightMap, SlopeMoments, SlopePyramid};
use hemicube_raster::random::SplitMix64;
use hemicube_raster::reflection::BlinnPhong;
use hemicube_raster::{Image, Rgb};
use std::fmt::Write as _;

/// Texels along each side of the height map.
const TEXELS: usize = 256;

/// Its side on the plane.
const TILE: f32 = 2.0;

/// Of the surface between its bumps.
const EXPONENT: f32 = 300.0;

/// Half the side of the plane.
const REACH: f32 = 400.0;

/// Samples along each side of a pixel of the truth.
const TRUTH: usize = 12;

/// What a pixel's radiance is multiplied by to be shown.
const EXPOSURE: f32 = 0.35;

pub(super) fn draw(request: &Request) -> Result<Vec<Piece>, GalleryError> {
    let cell_size = cell_size(request, (1310, 330), (5, 1), 3)?;
    let water = Water::new(request.seed);
    let pictures: Vec<Image<Rgb>> = METHODS
        .iter()
        .map(|(_, _, per_side, radiance)| water.picture(cell_size, *per_side, *radiance))
        .collect();
    let rows: Vec<Row> = rows(&pictures);
    let cells = METHODS.iter().zip(&pictures).enumerate();
    let is_shown = |&(i, _): &(usize, _)| i != AGAIN;
    let cells = cells
        .filter(is_shown)
        .map(|(i, ((name, how, _, _), image))| Cell {
            image: image.map(|c| (SKY * 0.25 + *c * EXPOSURE).map(|c| c / (1.0 + c))),
            lines: vec![
                (*name).to_owned(),
                (*how).to_owned(),
                if i < AGAIN {
                    format!("far off by {:.0} %", 100.0 * far_error(&rows, i))
                } else {
                    format!("noise: {:.0} %", 100.0 * far_error(&rows, AGAIN))
                },
            ],
        });
    let cells: Vec<Cell> = cells.collect();
    Ok(vec![
        Piece::sheet("", &sheet(&cells, 5))?,
        Piece::chart("-by-distance", &chart(&rows), (960, 520)),
        Piece::csv("", table(&rows)),
    ])
}

const SKY: Rgb = Rgb::new(0.25, 0.36, 0.5);

/// A way to see bumps: its name, what it does, samples along each side of a pixel, radiance of a sample.
type Method = (
    &'static str,
    &'static str,
    usize,
    fn(&Water, &Fragment) -> f32,
);

/// All ways, the truth last. It is drawn twice, from other samples: their difference is the noise that is in every error.
const METHODS: [Method; 6] = [
    ("no filter", "one sample a pixel", 1, Water::point),
    ("mean normal", "mipmapped", 1, Water::mean_normal),
    ("Toksvig", "wider exponent", 1, Water::toksvig),
    ("LEAN", "moments of slopes", 1, Water::lean),
    ("truth again", "other samples", TRUTH, Water::scattered::<1>),
    ("truth", "144 samples a pixel", TRUTH, Water::scattered::<0>),
];

/// The second truth.
const AGAIN: usize = METHODS.len() - 2;

/// A plane of waves before a low sun.
struct Water {
    heights: HeightMap,
    pyramid: SlopePyramid,
}

impl Water {
    /// Forty waves of random directions, of 3 to 14 crests a tile.
    fn new(seed: u64) -> Self {
        let mut random = SplitMix64::new(seed);
        let waves: Vec<(Vec2, f32, f32)> = (0..40)
            .map(|_| {
                let length = 3.0 + 11.0 * random.unit();
                let direction = Vec2::from_angle(TAU * random.unit());
                // Whole crests, so that the tile repeats.
                let crests = (direction * length).round() * TAU;
                let slope = 0.022 * TILE;
                (
                    crests,
                    TAU * random.unit(),
                    slope / crests.length().max(1.0),
                )
            })
            .collect();
        let height = |uv: Vec2| {
            let wave = |&(crests, phase, height): &(Vec2, f32, f32)| {
                height * (crests.dot(uv) + phase).sin()
            };
            waves.iter().map(wave).sum()
        };
        let heights = HeightMap::from_fn(TEXELS, TEXELS, height).expect("a map of this size");
        let per_length = Vec2::splat(1.0 / TILE);
        let moments = heights.slope_moments().map(|m| m.scaled(per_length));
        Self {
            pyramid: SlopePyramid::new(moments),
            heights,
        }
    }

    fn picture(
        &self,
        size: (usize, usize),
        per_side: usize,
        radiance: fn(&Self, &Fragment) -> f32,
    ) -> Image<Rgb> {
        let plane = Mesh::plane(2.0 * REACH, 1);
        let camera = Camera::new(Vec3::new(0.0, 2.0, 0.0), Vec3::new(0.0, 1.35, -4.0), 30.0);
        let sampling = Sampling { size, per_side };
        draw_stage(&camera, sampling, &[&plane], Rgb::BLACK, |f| {
            Rgb::splat(radiance(self, f))
        })
    }

    /// Texture coordinate and its derivatives; the plane's own texture spans all of it.
    fn texcoord(f: &Fragment) -> (Vec2, [Vec2; 2]) {
        let flat = |p: Vec3| Vec2::new(p.x, p.z) / TILE;
        (flat(f.position), f.d_position.map(flat))
    }

    fn moments(&self, f: &Fragment) -> SlopeMoments {
        let (texcoord, d) = Self::texcoord(f);
        self.pyramid.sample(texcoord, d)
    }

    fn point(&self, f: &Fragment) -> f32 {
        let slopes = self.heights.sample(Self::texcoord(f).0).slopes / TILE;
        mirror(slopes, EXPONENT, f)
    }

    /// A point somewhere in the sample's share of the pixel: a regular grid of points would beat with the waves.
    fn scattered<const SEED: u64>(&self, f: &Fragment) -> f32 {
        let (texcoord, [dx, dy]) = Self::texcoord(f);
        let place = u64::from(texcoord.x.to_bits()) << 32 | u64::from(texcoord.y.to_bits());
        let mut random = SplitMix64::new(place ^ SEED << 60);
        let (right, down) = (random.unit() - 0.5, random.unit() - 0.5);
        let moved = texcoord + dx * right + dy * down;
        mirror(self.heights.sample(moved).slopes / TILE, EXPONENT, f)
    }

    fn mean_normal(&self, f: &Fragment) -> f32 {
        mirror(self.moments(f).mean, EXPONENT, f)
    }

    fn toksvig(&self, f: &Fragment) -> f32 {
        let moments = self.moments(f);
        mirror(moments.mean, moments.toksvig_exponent(EXPONENT), f)
    }

    fn lean(&self, f: &Fragment) -> f32 {
        // Beckmann's alpha of the same spread: alpha^2 / 2 = 1 / exponent.
        let alpha = (2.0 / EXPONENT).sqrt();
        let half = half_vector(f);
        let local = Vec3::new(half.x, half.z, half.y);
        0.25 * self.moments(f).normal_distribution(local, alpha)
    }
}

/// Sun's light mirrored by facets around one normal, without what all methods share.
fn mirror(slopes: Vec2, exponent: f32, f: &Fragment) -> f32 {
    let normal = Vec3::new(-slopes.x, 1.0, -slopes.y).normalize();
    0.25 * BlinnPhong::new(exponent).normal_distribution(normal.dot(half_vector(f)))
}

fn half_vector(f: &Fragment) -> Vec3 {
    let sun = Vec3::new(0.0, 0.25, -1.0).normalize();
    (sun + f.view).normalize_or_zero()
}

/// A row of pixels: how far away the plane is there, the truth's mean radiance, and by how much each method is off: the
/// mean difference of a pixel over that mean.
#[derive(Debug)]
struct Row {
    distance: f64,
    radiance: f64,
    error: Vec<f64>,
}

/// The rows that show the plane, from near to far.
fn rows(pictures: &[Image<Rgb>]) -> Vec<Row> {
    let (width, height) = (pictures[0].width(), pictures[0].height());
    let pixels = |i: usize, y: usize| {
        let row = &pictures[i].pixels()[y * width..(y + 1) * width];
        row.iter().map(|c| f64::from(c.r))
    };
    let truth = pictures.len() - 1;
    // The camera looks down by atan(0.65 / 4), half the picture is 15 degrees.
    let down = |y: usize| {
        let share = (2.0 * (y as f64 + 0.5) / height as f64) - 1.0;
        (0.65_f64 / 4.0).atan() + (share * 15.0_f64.to_radians().tan()).atan()
    };
    let row = |y: usize| {
        let light: f64 = pixels(truth, y).sum();
        let off = |i| {
            let pairs = pixels(i, y).zip(pixels(truth, y));
            pairs.map(|(a, b)| (a - b).abs()).sum::<f64>() / light
        };
        Row {
            distance: 2.0 / down(y).sin(),
            radiance: light / width as f64,
            error: (0..truth).map(off).collect(),
        }
    };
    let seen = (0..height).rev().filter(|&y| down(y) > 0.01).map(row);
    seen.filter(|row| row.distance < f64::from(REACH)).collect()
}

/// Mean error of the farther half of the rows; the truth has none.
fn far_error(rows: &[Row], method: usize) -> f64 {
    let far = &rows[rows.len() / 2..];
    let errors = far.iter().filter_map(|row| row.error.get(method));
    errors.sum::<f64>() / far.len().max(1) as f64
}

fn chart(rows: &[Row]) -> Chart {
    let curve = |(i, (name, ..)): (usize, &Method)| {
        let points = rows.iter().map(|row| (row.distance, row.error[i]));
        Curve::new(*name, points.collect())
    };
    Chart {
        title: String::from("Glitter of a bumpy plane"),
        x_label: String::from("distance in metres"),
        y_label: String::from("mean difference from the truth, over its mean"),
        x_scale: Scale::Logarithmic,
        y_scale: Scale::Logarithmic,
        curves: METHODS[..METHODS.len() - 1]
            .iter()
            .enumerate()
            .map(curve)
            .collect(),
    }
}

fn table(rows: &[Row]) -> String {
    let methods = &METHODS[..METHODS.len() - 1];
    let names: Vec<&str> = methods.iter().map(|(name, ..)| *name).collect();
    let mut table = format!(
        "distance,true radiance,error of {}\n",
        names.join(",error of ")
    );
    for row in rows {
        let _ = write!(table, "{:.3},{:.5}", row.distance, row.radiance);
        for error in &row.error {
            let _ = write!(table, ",{error:.5}");
        }
        table.push('\n');
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Far away a pixel covers many waves. Measured there: without a filter pixels are off by 101 % of their mean, with
    /// mean normals by 47 %, by Toksvig 17 % and by LEAN 13 %, of which the truth's own noise is some 5 %.
    #[test]
    fn moments_keep_the_light_that_mean_normals_lose() {
        let water = Water::new(0);
        let size = (60, 80);
        let pictures: Vec<Image<Rgb>> = METHODS
            .iter()
            .map(|(_, _, per_side, radiance)| water.picture(size, *per_side, *radiance))
            .collect();
        let rows = rows(&pictures);
        assert!(rows.len() > 40, "{} rows", rows.len());
        let errors: Vec<f64> = (0..5).map(|i| far_error(&rows, i)).collect();
        let [none, mean, toksvig, lean, noise] = errors[..] else {
            panic!("five of them");
        };
        assert!(noise < 0.1, "{errors:?}");
        assert!(lean < 0.16 && toksvig < 0.2, "{errors:?}");
        assert!(mean > 0.4 && none > 0.9, "{errors:?}");
    }

    #[test]
    fn pieces_are_a_sheet_a_chart_and_a_table() {
        let request = Request {
            size: Some((150, 150)),
            ..Request::default()
        };
        let pieces = draw(&request).expect("pieces");
        let suffixes: Vec<&str> = pieces.iter().map(|p| p.suffix.as_str()).collect();
        assert_eq!(suffixes, [".png", "-by-distance.svg", ".csv"]);
    }
}
