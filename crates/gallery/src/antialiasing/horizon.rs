//! A checkerboard up to the horizon: every frequency there is, in one picture.

use super::{named, picture_size};
use crate::sheet::{Cell, sheet};
use crate::{Exhibit, GalleryError, Piece, Request};
use hemicube_raster::Rgb;
use hemicube_raster::antialias::render;

pub(super) const CHECKERBOARD_HORIZON: Exhibit = Exhibit {
    name: "checkerboard-horizon",
    about: "A checkerboard in perspective by each pattern and filter: moiré, noise and blur towards the horizon",
    needs: &[],
    draw,
};

const WAYS: [&str; 9] = [
    "none",
    "1x1-jittered@0.5",
    "4x4",
    "4x4-jittered@0.125",
    "4x4:bartlett",
    "4x4-jittered@0.125:bartlett",
    "4x4:mitchell",
    "4x4:gaussian",
    "16x16:bartlett",
];

fn draw(request: &Request) -> Result<Vec<Piece>, GalleryError> {
    let (width, height) = picture_size(request, (384, 256))?;
    let cells = WAYS.map(|name| {
        let antialiasing = named(name);
        let pattern = antialiasing.pattern.with_seed(request.seed);
        let picture = |x: f64, y: f64| color(x / width as f64, y / height as f64);
        let image = render(
            &picture,
            (width, height),
            antialiasing.with_pattern(pattern),
        );
        Cell::new(image, &[name])
    });
    Ok(vec![Piece::sheet("", &sheet(&cells, 3))?])
}

/// Squares on a floor below a horizon at a quarter of the height; x and y in parts of the picture.
fn color(x: f64, y: f64) -> Rgb {
    const HORIZON: f64 = 0.25;
    let below = y - HORIZON;
    if below <= 0.0 {
        return Rgb::new(0.35, 0.55, 0.85);
    }
    let (across, ahead) = (2.0 * (x - 0.5) / below, 1.0 / below);
    let is_light = (across.floor() + ahead.floor()).rem_euclid(2.0) == 0.0;
    if is_light {
        Rgb::splat(0.9)
    } else {
        Rgb::new(0.12, 0.02, 0.02)
    }
}
