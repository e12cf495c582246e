//! One environment in all projections.

use super::{file_of, panel_size, sky};
use crate::exhibit::{GalleryError, Piece, Request};
use crate::sheet::{Cell, sheet};
use hemicube_raster::environment::{
    Conversion, ConvertOptions, EnvironmentMap, Layout, Projection, convert,
};
use hemicube_raster::tonemap::{Exposure, ToneMap};
use hemicube_raster::{Image, Rgb};
use std::fmt::Write as _;

/// Panels in a row of the sheet.
const COLUMNS: usize = 4;
const PANEL: (usize, usize) = (384, 288);

/// Labelled directions.
pub fn draw(request: &Request) -> Result<Vec<Piece>, GalleryError> {
    let (width, _) = panel_size(request, PANEL)?;
    let rows = (width / 2).clamp(64, 256);
    let source = EnvironmentMap::from_fn(Projection::Cube, rows, 2, sky::labelled);
    in_all(&source, request, |image| image.clone())
}

/// What is in the file, made to fit a display.
pub fn draw_file(request: &Request) -> Result<Vec<Piece>, GalleryError> {
    let source = file_of(request)?;
    let factor = Exposure::Auto.factor(source.texels().iter().map(|c| c.luminance()));
    in_all(&source, request, |image| {
        image.map(|&color| ToneMap::default().apply(color, factor))
    })
}

fn in_all(
    source: &EnvironmentMap,
    request: &Request,
    show: impl Fn(&Image<Rgb>) -> Image<Rgb>,
) -> Result<Vec<Piece>, GalleryError> {
    let (width, height) = panel_size(request, PANEL)?;
    let mut table = String::from(
        "projection,faces,width,height,solid_angle_relative_error,flux_relative_change_before_spreading,flux_relative_change\n",
    );
    let mut cells = Vec::new();
    for projection in Projection::ALL {
        let face_rows = rows_that_fit(projection, width, height);
        let options = ConvertOptions::default().with_rows(face_rows);
        let (map, conversion) = convert(source, projection, &options);
        cells.push(Cell {
            image: show(&map.to_image(Layout::default_of(projection))),
            lines: caption(&map, &conversion),
        });
        let _ = writeln!(
            table,
            "{projection},{},{},{},{:.16},{:.9},{:.9}",
            projection.faces(),
            map.width(),
            map.height(),
            conversion.solid_angle_error,
            conversion.spread(),
            conversion.flux_error()
        );
    }
    Ok(vec![
        Piece::sheet("", &sheet(&cells, COLUMNS))?,
        Piece::csv("", table),
    ])
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
    let (projection, width, height) = (map.projection(), map.width(), map.height());
    let size = match projection.faces() {
        1 => format!("{width} x {height} pixels"),
        faces => format!("{faces} faces of {width} x {height} pixels"),
    };
    let light = if projection.covers_sphere() {
        String::from(within(conversion.flux_error()))
    } else {
        let share = conversion.flux_after[1] / conversion.flux_before[1];
        format!("what lies ahead: {:.0} % of the light", 100.0 * share)
    };
    vec![projection.name().to_owned(), size, light]
}

/// How far the light of a whole map is from what it was.
fn within(error: f64) -> &'static str {
    match error {
        e if e < 1e-6 => "light kept to 1 in a million",
        e if e < 1e-3 => "light kept to 1 in a thousand",
        _ => "light not kept",
    }
}
