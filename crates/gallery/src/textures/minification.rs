//! A chequered plane to the horizon by every filter, with its error against 4096 points per pixel.

use super::plane::{Plane, checks, rms};
use super::{Filter, Prefiltered, size};
use crate::sheet::{Cell, sheet};
use crate::{Exhibit, GalleryError, Piece, Request};
use rayon::prelude::*;

pub(super) const EXHIBIT: Exhibit = Exhibit {
    name: "minification",
    about: "a chequered plane to the horizon by point sampling, mipmaps, ripmaps, summed areas and EWA, with RMS errors",
    needs: &[],
    draw,
};

/// Points of the reference along a side of a pixel: 4096 in all.
const POINTS: usize = 64;

fn draw(request: &Request) -> Result<Vec<Piece>, GalleryError> {
    let (width, height) = size(request, (320, 240))?;
    let plane = Plane::new(width, height);
    let (pixels, reference) = (plane.pixels(), plane.reference(POINTS));
    let texture = Prefiltered::new(&checks());
    let (mut cells, mut table) = (Vec::new(), String::from("filter,rms_error\n"));
    for (name, filter) in Filter::all() {
        let found: Vec<f32> = pixels
            .par_iter()
            .map(|p| filter.sample(&texture, p))
            .collect();
        let error = rms(&found, &reference);
        table += &format!("\"{name}\",{error:.5}\n");
        cells.push(Cell {
            image: plane.picture(&found),
            lines: vec![String::from(name), format!("RMS error {error:.4}")],
        });
    }
    cells.push(Cell {
        image: plane.picture(&reference),
        lines: vec![
            String::from("reference"),
            format!("{} points per pixel", POINTS * POINTS),
        ],
    });
    Ok(vec![
        Piece::sheet("", &sheet(&cells, 3))?,
        Piece::csv("", table),
    ])
}
