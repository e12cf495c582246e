//! Irradiance by spherical harmonics.

use super::{panel_size, relative_rms, sky};
use crate::exhibit::{GalleryError, Piece, Request};
use glam::Vec3;
use hemicube_chart::{Canvas, Chart, Curve, Scale, label};
use hemicube_raster::environment::{
    ConvertOptions, EnvironmentMap, Layout, Projection, SphericalHarmonics, convert,
    irradiance_by_texels,
};
use hemicube_raster::tonemap::{Exposure, ToneMap};
use hemicube_raster::{Image, Rgb};
use std::fmt::Write as _;

/// A name and its light from all directions.
type Scene = (&'static str, fn(Vec3) -> Rgb);

const GAP: usize = 16;
const CAPTION: usize = 44;
const HIGHEST: usize = 8;

/// Pictures, and errors by degree.
pub fn draw(request: &Request) -> Result<Vec<Piece>, GalleryError> {
    let (width, _) = panel_size(request, (384, 192))?;
    let (width, height) = (width / 2 * 2, width / 2);
    let scenes: [Scene; 2] = [("evening", sky::evening), ("one small lamp", lamp)];
    // Rows of the panorama of normals for which both ways are computed.
    let rows = (height / 8).clamp(8, 24);
    let mut curves = Vec::new();
    let mut table = String::from("environment,degree,relative_rms\n");
    let mut canvas = Canvas::new(GAP + 5 * (width + GAP), GAP + 2 * (height + CAPTION + GAP));
    for (row, (name, light)) in scenes.into_iter().enumerate() {
        let map = EnvironmentMap::from_fn(Projection::Cube, 64, 2, light);
        let truth = over_normals(rows, |n| irradiance_by_texels(&map, n));
        let factor = Exposure::Auto.factor(truth.pixels().iter().map(|c| c.luminance()));
        let mut put = |column: usize, lines: [String; 2], image: &Image<Rgb>| {
            let (left, top) = (
                GAP + column * (width + GAP),
                GAP + row * (height + CAPTION + GAP),
            );
            canvas.draw(&label(&lines, width, CAPTION), left, top);
            canvas.paste(image, left, top + CAPTION);
        };
        let shown = |image: &Image<Rgb>| {
            let large = enlarged(image, height);
            large.map(|&color| ToneMap::default().apply(color, factor))
        };
        put(
            0,
            [name.to_owned(), String::from("as it is")],
            &panorama(&map, height),
        );
        put(
            1,
            [
                String::from("irradiance"),
                String::from("sum over all texels"),
            ],
            &shown(&truth),
        );
        let mut errors = Vec::new();
        for degree in 0..=HIGHEST {
            let harmonics = SphericalHarmonics::of_map(&map, degree);
            let image = over_normals(rows, |n| harmonics.irradiance(n));
            let error = relative_rms(&image, &truth);
            errors.push((degree as f64, error));
            let _ = writeln!(table, "{name},{degree},{error}");
            if let Some(column) = [1, 2, 4].iter().position(|&d| d == degree) {
                let lines = [
                    format!("harmonics to degree {degree}"),
                    format!(
                        "{} numbers a band, RMS {:.2} %",
                        (degree + 1).pow(2),
                        100.0 * error
                    ),
                ];
                put(2 + column, lines, &shown(&image));
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
        Piece::sheet("", &canvas)?,
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
fn over_normals(rows: usize, irradiance: impl Fn(Vec3) -> Rgb) -> Image<Rgb> {
    let pixel = |i: usize| {
        let (x, y) = (i % (2 * rows), i / (2 * rows));
        let at = glam::Vec2::new(x as f32 + 0.5, y as f32 + 0.5) / glam::Vec2::new(2.0, 1.0);
        irradiance(Projection::LatLong.direction(0, at / rows as f32))
    };
    let pixels = (0..2 * rows * rows).map(pixel).collect();
    Image::from_pixels(2 * rows, rows, pixels).expect("one colour for each pixel")
}

/// The same panorama with more pixels, smooth.
fn enlarged(image: &Image<Rgb>, rows: usize) -> Image<Rgb> {
    let map = EnvironmentMap::from_image(Projection::LatLong, image).expect("finite, and 2:1");
    EnvironmentMap::from_fn(Projection::LatLong, rows, 1, |d| map.radiance(d))
        .to_image(Layout::Single)
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
