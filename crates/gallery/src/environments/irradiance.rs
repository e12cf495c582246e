//! Irradiance by spherical harmonics.

use super::{panel_size, relative_rms, sky};
use crate::exhibit::{GalleryError, Piece, Request};
use crate::sheet::{Cell, sheet};
use glam::{Vec2, Vec3};
use hemicube_chart::{Chart, Curve, Scale};
use hemicube_raster::environment::{
    ConvertOptions, EnvironmentMap, IrradianceSum, Layout, Projection, SphericalHarmonics, convert,
};
use hemicube_raster::tonemap::{Exposure, ToneMap};
use hemicube_raster::{Image, Rgb};
use rayon::prelude::*;
use std::fmt::Write as _;

/// A name and its light from all directions.
type Scene = (&'static str, fn(Vec3) -> Rgb);

const HIGHEST: usize = 8;

/// Degrees of which pictures are shown.
const SHOWN: [usize; 3] = [1, 2, 4];

/// Pictures, and errors by degree.
pub fn draw(request: &Request) -> Result<Vec<Piece>, GalleryError> {
    let (width, _) = panel_size(request, (384, 192))?;
    let rows = width / 2;
    let scenes: [Scene; 2] = [("evening", sky::evening), ("one small lamp", lamp)];
    let (mut curves, mut cells) = (Vec::new(), Vec::new());
    let mut table = String::from("environment,degree,relative_rms\n");
    for (name, light) in scenes {
        let map = EnvironmentMap::from_fn(Projection::Cube, 64, 2, light);
        let sum = IrradianceSum::new(&map);
        let truth = over_normals(rows, |n| sum.irradiance(n));
        let factor = Exposure::Auto.factor(truth.pixels().iter().map(|c| c.luminance()));
        let shown = |image: &Image<Rgb>| image.map(|&c| ToneMap::default().apply(c, factor));
        cells.push(Cell::new(panorama(&map, rows), &[name, "as it is"]));
        cells.push(Cell::new(
            shown(&truth),
            &["irradiance by normal", "sum over all texels"],
        ));
        let mut errors = Vec::new();
        for degree in 0..=HIGHEST {
            let harmonics = SphericalHarmonics::of_map(&map, degree);
            let image = over_normals(rows, |n| harmonics.irradiance(n));
            let error = relative_rms(&image, &truth);
            errors.push((degree as f64, error));
            let _ = writeln!(table, "{name},{degree},{error:.6}");
            if SHOWN.contains(&degree) {
                let title = format!("harmonics to degree {degree}");
                let count = (degree + 1).pow(2);
                let figures = format!("{count} coefficients, RMS {:.2} %", 100.0 * error);
                cells.push(Cell::new(shown(&image), &[&title, &figures]));
            }
        }
        curves.push(Curve::new(name, errors));
    }
    let chart = Chart {
        title: String::from("Irradiance by spherical harmonics"),
        x_label: String::from("degree"),
        y_label: String::from("RMS error / mean"),
        x_scale: Scale::Linear,
        y_scale: Scale::Logarithmic,
        curves,
    };
    Ok(vec![
        Piece::sheet("", &sheet(&cells, 2 + SHOWN.len()))?,
        Piece::chart("-error", &chart, (800, 480)),
        Piece::csv("-error", table),
    ])
}

/// As hard for few harmonics as it gets: a lamp of about 5 degrees and nothing else.
fn lamp(d: Vec3) -> Rgb {
    let cosine = d.normalize().dot(Vec3::new(0.4, 0.5, -0.8).normalize());
    Rgb::splat(100.0 * ((cosine - 1.0) * 600.0).exp())
}

/// A panorama of a function of normals.
fn over_normals(rows: usize, irradiance: impl Fn(Vec3) -> Rgb + Sync) -> Image<Rgb> {
    let size = Vec2::new(2.0 * rows as f32, rows as f32);
    let pixel = |i: usize| {
        let at = Vec2::new((i % (2 * rows)) as f32, (i / (2 * rows)) as f32) + 0.5;
        irradiance(Projection::LatLong.direction(0, at / size))
    };
    let pixels = (0..2 * rows * rows).into_par_iter().map(pixel).collect();
    Image::from_pixels(2 * rows, rows, pixels).expect("one colour for each pixel")
}

/// A map as a panorama made to fit a display.
fn panorama(map: &EnvironmentMap, rows: usize) -> Image<Rgb> {
    let options = ConvertOptions::default().with_rows(rows);
    let image = convert(map, Projection::LatLong, &options)
        .0
        .to_image(Layout::Single);
    let factor = Exposure::Auto.factor(map.texels().iter().map(|c| c.luminance()));
    image.map(|&color| ToneMap::default().apply(color, factor))
}
