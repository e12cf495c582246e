//! One environment in all projections.

use super::{file_of, panel_size, sky};
use crate::exhibit::{GalleryError, Piece, Request};
use hemicube_chart::{Canvas, label};
use hemicube_raster::environment::{
    Conversion, ConvertOptions, EnvironmentMap, Layout, Projection, convert,
};
use hemicube_raster::tonemap::{Exposure, ToneMap};
use hemicube_raster::{Image, Rgb};
use std::fmt::Write as _;

/// Panels in a row of the sheet.
const COLUMNS: usize = 4;
const PANEL: (usize, usize) = (384, 288);
const CAPTION: usize = 66;
const GAP: usize = 16;

/// Labelled directions.
pub fn draw(request: &Request) -> Result<Vec<Piece>, GalleryError> {
    let (width, _) = panel_size(request, PANEL)?;
    let rows = (width / 2).clamp(64, 256);
    let source = EnvironmentMap::from_fn(Projection::Cube, rows, 2, sky::labelled);
    sheet(&source, request, |image| image.clone())
}

/// What is in the file, made to fit a display.
pub fn draw_file(request: &Request) -> Result<Vec<Piece>, GalleryError> {
    let source = file_of(request)?;
    let factor = Exposure::Auto.factor(source.texels().iter().map(|c| c.luminance()));
    sheet(&source, request, |image| {
        image.map(|&color| ToneMap::default().apply(color, factor))
    })
}

fn sheet(
    source: &EnvironmentMap,
    request: &Request,
    show: impl Fn(&Image<Rgb>) -> Image<Rgb>,
) -> Result<Vec<Piece>, GalleryError> {
    let (width, height) = panel_size(request, PANEL)?;
    let rows = Projection::ALL.len().div_ceil(COLUMNS);
    let size = (
        GAP + COLUMNS * (width + GAP),
        GAP + rows * (height + CAPTION + GAP),
    );
    let mut canvas = Canvas::new(size.0, size.1);
    let mut table =
        String::from("projection,width,height,solid_angle_error,flux_spread,flux_error\n");
    for (i, projection) in Projection::ALL.into_iter().enumerate() {
        let face_rows = rows_that_fit(projection, width, height);
        let options = ConvertOptions::default().with_rows(face_rows);
        let (map, conversion) = convert(source, projection, &options);
        let left = GAP + (i % COLUMNS) * (width + GAP);
        let top = GAP + (i / COLUMNS) * (height + CAPTION + GAP);
        let lines = caption(&map, &conversion);
        canvas.draw(&label(&lines, width, CAPTION), left, top);
        let image = show(&map.to_image(Layout::default_of(projection)));
        canvas.paste(&image, left, top + CAPTION);
        let _ = writeln!(
            table,
            "{projection},{},{},{:e},{:e},{:e}",
            map.width(),
            map.height(),
            conversion.solid_angle_error,
            conversion.spread(),
            conversion.flux_error()
        );
    }
    Ok(vec![Piece::sheet("", &canvas)?, Piece::csv("", table)])
}

/// Rows of a face so that the whole picture fits a panel.
fn rows_that_fit(projection: Projection, width: usize, height: usize) -> usize {
    match projection {
        Projection::Cube => (width / 4).min(height / 3),
        Projection::LatLong | Projection::Paraboloid => (width / 2).min(height),
        _ => width.min(height),
    }
}

fn caption(map: &EnvironmentMap, conversion: &Conversion) -> Vec<String> {
    let flux = if map.projection().covers_sphere() {
        format!("flux kept to {:.0e}", conversion.flux_error().max(1e-12))
    } else {
        let share = conversion.flux_after[1] / conversion.flux_before[1];
        format!("{:.0} % of the flux: no back", 100.0 * share)
    };
    vec![
        map.projection().name().to_owned(),
        format!(
            "{} x {} x {}, {flux}",
            map.projection().faces(),
            map.width(),
            map.height()
        ),
        format!(
            "solid angle error {:.0e}",
            conversion.solid_angle_error.abs()
        ),
    ]
}
