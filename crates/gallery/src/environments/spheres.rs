//! Balls that reflect an environment.

use super::{file_of, panel_size, relative_rms, sky};
use crate::exhibit::{GalleryError, Piece, Request};
use crate::sheet::{Cell, sheet};
use core::f32::consts::PI;
use glam::Vec3;
use hemicube_raster::environment::{
    EnvironmentMap, EnvironmentPyramid, Lobe, PrefilterOptions, PrefilteredEnvironment, Projection,
    reflected,
};
use hemicube_raster::tonemap::{Exposure, ToneMap};
use hemicube_raster::{Image, Rgb};
use rayon::prelude::*;

const PANEL: (usize, usize) = (220, 220);
const ROUGHNESSES: [f32; 5] = [0.0, 0.25, 0.5, 0.75, 1.0];

/// Slices of the balls whose vertices look the environment up; half as many stacks.
const SLICES: [usize; 4] = [16, 32, 64, 128];

/// Samples in each direction of a pixel.
const SAMPLES: usize = 3;

/// An evening that needs no file.
pub fn draw(request: &Request) -> Result<Vec<Piece>, GalleryError> {
    let (width, _) = panel_size(request, PANEL)?;
    let rows = width.clamp(64, 256);
    let source = EnvironmentMap::from_fn(Projection::Cube, rows, 2, sky::evening);
    balls(source, request)
}

/// What is in the file.
pub fn draw_file(request: &Request) -> Result<Vec<Piece>, GalleryError> {
    balls(file_of(request)?, request)
}

fn balls(source: EnvironmentMap, request: &Request) -> Result<Vec<Piece>, GalleryError> {
    let (width, height) = panel_size(request, PANEL)?;
    let side = width.min(height);
    let factor = Exposure::Auto.factor(source.texels().iter().map(|c| c.luminance()));
    let pyramid = EnvironmentPyramid::new(source);
    let columns = ROUGHNESSES.len();
    let mut cells = Vec::new();
    let mut put = |image: &Image<Rgb>, lines: [&str; 2]| {
        let shown = image.map(|&color| ToneMap::default().apply(color, factor));
        cells.push(Cell::new(shown, &lines));
    };
    for (name, lobe) in [("GGX", Lobe::Ggx), ("Phong, as wide", Lobe::Phong)] {
        let options = PrefilterOptions::default()
            .with_rows(side.clamp(32, 128))
            .with_levels(columns)
            .with_lobe(lobe);
        let blurred = PrefilteredEnvironment::new(&pyramid, &options);
        for roughness in ROUGHNESSES {
            let image = ball(side, |n| blurred.radiance(reflected(n, Vec3::Z), roughness));
            put(&image, [name, &format!("roughness {roughness}")]);
        }
    }
    let look_up = |n: Vec3| pyramid.base().radiance(reflected(n, Vec3::Z));
    let truth = ball(side, look_up);
    put(&truth, ["looked up per pixel", ""]);
    for slices in SLICES {
        let vertices = Vertices::new(slices, look_up);
        let image = ball(side, |n| vertices.light(n));
        let error = 100.0 * relative_rms(&image, &truth);
        let name = format!("per vertex, {slices}");
        put(&image, [&name, &format!("RMS {error:.0} % of mean")]);
    }
    Ok(vec![Piece::sheet("", &sheet(&cells, columns))?])
}

/// A ball seen from far away at +z, before black; `light` is asked with normals.
fn ball(side: usize, light: impl Fn(Vec3) -> Rgb + Sync) -> Image<Rgb> {
    let sample = |x: f32, y: f32| {
        let (x, y) = (2.06 * x - 1.03, 1.03 - 2.06 * y);
        let square = x * x + y * y;
        if square < 1.0 {
            light(Vec3::new(x, y, (1.0 - square).sqrt()))
        } else {
            Rgb::BLACK
        }
    };
    let pixel = |i: usize| {
        let at =
            |k: usize, from: usize| ((from * SAMPLES + k) as f32 + 0.5) / (side * SAMPLES) as f32;
        let samples = (0..SAMPLES * SAMPLES)
            .map(|k| sample(at(k % SAMPLES, i % side), at(k / SAMPLES, i / side)));
        samples.sum::<Rgb>() / (SAMPLES * SAMPLES) as f32
    };
    let pixels = (0..side * side).into_par_iter().map(pixel).collect();
    Image::from_pixels(side, side, pixels).expect("one colour for each pixel")
}

/// Light looked up at the vertices of a ball's quads, between which it is bilinear (Gouraud).
struct Vertices {
    slices: usize,
    light: Vec<Rgb>,
}

impl Vertices {
    fn new(slices: usize, light: impl Fn(Vec3) -> Rgb) -> Self {
        let stacks = slices / 2;
        let vertex = |i: usize| {
            let (slice, stack) = (i % (slices + 1), i / (slices + 1));
            let (azimuth, polar) = (
                2.0 * PI * slice as f32 / slices as f32,
                PI * stack as f32 / stacks as f32,
            );
            let (sin, cos) = polar.sin_cos();
            light(Vec3::new(sin * azimuth.sin(), cos, sin * azimuth.cos()))
        };
        Self {
            slices,
            light: (0..(slices + 1) * (stacks + 1)).map(vertex).collect(),
        }
    }

    fn light(&self, n: Vec3) -> Rgb {
        let azimuth = n.x.atan2(n.z).rem_euclid(2.0 * PI) / (2.0 * PI);
        let (x, y) = (
            azimuth * self.slices as f32,
            n.y.clamp(-1.0, 1.0).acos() / PI * (self.slices / 2) as f32,
        );
        let low = |x: f32, most: usize| {
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "a quad"
            )]
            let low = x as usize;
            low.min(most - 1)
        };
        let (i, j) = (low(x, self.slices), low(y, self.slices / 2));
        let at = |i: usize, j: usize| self.light[j * (self.slices + 1) + i];
        let upper = at(i, j).lerp(at(i + 1, j), x - i as f32);
        let lower = at(i, j + 1).lerp(at(i + 1, j + 1), x - i as f32);
        upper.lerp(lower, y - j as f32)
    }
}
