//! Rings finer and finer: what each filter makes of frequencies that pixels cannot show.

use super::{named, picture_size};
use crate::sheet::{Cell, sheet};
use crate::{Exhibit, GalleryError, Piece, Request};
use hemicube_raster::Rgb;
use hemicube_raster::antialias::accuracy::{zone_plate, zone_plate_error};
use hemicube_raster::antialias::{Antialiasing, Pattern, render};
use std::fmt::Write as _;

pub(super) const ZONE_PLATE: Exhibit = Exhibit {
    name: "zone-plate",
    about: "Rings up to one cycle per pixel by each pattern and filter: moiré left (noise where samples are jittered), contrast kept",
    needs: &[],
    draw,
};

const WAYS: [&str; 12] = [
    "none",
    "1x1-jittered@0.5",
    "4x4",
    "4x4-jittered@0.125",
    "2x2:bartlett",
    "3x3:bartlett",
    "4x4:bartlett",
    "4x4:bartlett-3x3",
    "4x4:gaussian",
    "4x4:mitchell",
    "4x4:blackman-harris",
    "4x4:lanczos",
];

fn draw(request: &Request) -> Result<Vec<Piece>, GalleryError> {
    let (side, _) = picture_size(request, (256, 256))?;
    let mut cells = Vec::new();
    let mut csv = String::from("antialiasing,left_rms,left_as,contrast_kept\n");
    for name in WAYS {
        let antialiasing = seeded(named(name), request.seed);
        let truth = zone_plate(side as f64);
        let color = |x: f64, y: f64| Rgb::splat(truth(x, y));
        let image = render(&color, (side, side), antialiasing);
        let error = zone_plate_error(antialiasing, side);
        let left = left_as(antialiasing.pattern);
        let figures = format!("{left} {:.3} kept {:.2}", error.moire, error.kept);
        cells.push(Cell::new(image, &[name, &figures]));
        let _ = writeln!(csv, "{name},{:.5},{left},{:.5}", error.moire, error.kept);
    }
    Ok(vec![
        Piece::sheet("", &sheet(&cells, 4))?,
        Piece::csv("", csv),
    ])
}

/// What frequencies become that pixels cannot show: samples on a grid make rings of them that were not there, jittered
/// ones noise of about the same contrast.
fn left_as(pattern: Pattern) -> &'static str {
    match pattern {
        Pattern::Regular => "moiré",
        Pattern::Jittered { .. } => "noise",
    }
}

fn seeded(antialiasing: Antialiasing, seed: u64) -> Antialiasing {
    let pattern: Pattern = antialiasing.pattern.with_seed(seed);
    antialiasing.with_pattern(pattern)
}
