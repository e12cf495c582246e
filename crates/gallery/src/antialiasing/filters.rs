//! Filters as curves: their weights over distance, and what they pass over frequency.

use crate::{Exhibit, GalleryError, Piece, Request};
use hemicube_chart::{Chart, Curve, Scale};
use hemicube_raster::antialias::{Factor, Filter};
use std::fmt::Write as _;

pub(super) const FILTERS: Exhibit = Exhibit {
    name: "filters",
    about: "Kernels and frequency responses of all pixel filters; Bartlett widths with and without their own factor",
    needs: &[],
    draw,
};

/// Samples per pixel for the curves: fine enough to see the kernels themselves.
const FINE: usize = 32;

fn draw(request: &Request) -> Result<Vec<Piece>, GalleryError> {
    let size = request.size.unwrap_or((900, 520));
    let (fine, four) = (factor(FINE), factor(4));
    let filters = |factor| {
        [
            Filter::Box,
            Filter::for_factor(factor),
            Filter::Gaussian,
            Filter::Mitchell,
            Filter::BlackmanHarris,
            Filter::Lanczos,
        ]
    };
    let widths = [2, 3, 4].map(|k| Filter::for_factor(factor(k)));
    let kernels = filters(fine).map(|filter| Curve::new(short_name(filter), kernel(filter, fine)));
    let responses =
        filters(fine).map(|filter| Curve::new(short_name(filter), response(filter, fine)));
    let pairing = widths.map(|filter| Curve::new(filter.to_string(), response(filter, four)));
    Ok(vec![
        Piece::chart(
            "-kernels",
            &chart(
                "Pixel filters",
                "distance from the pixel's centre, pixels",
                "weight per pixel",
                kernels.to_vec(),
            ),
            size,
        ),
        Piece::chart(
            "-responses",
            &chart(
                "What pixel filters pass",
                "cycles per pixel; pixels can show 0.5",
                "amplitude",
                responses.to_vec(),
            ),
            size,
        ),
        Piece::chart(
            "-pairing",
            &chart(
                "Bartlett filters with 4x4 samples: only 7x7 has its zeros at 1, 2, 3",
                "cycles per pixel",
                "amplitude",
                pairing.to_vec(),
            ),
            size,
        ),
        Piece::csv("", table(&filters(four), four)),
    ])
}

fn factor(k: usize) -> Factor {
    Factor::new(k).expect("between 1 and 32")
}

/// The name without its width.
fn short_name(filter: Filter) -> String {
    match filter {
        Filter::Bartlett { .. } => String::from("bartlett"),
        other => other.to_string(),
    }
}

/// Weight over distance, scaled to an area of 1.
fn kernel(filter: Filter, factor: Factor) -> Vec<(f64, f64)> {
    let weights = filter.weights(factor);
    let k = factor.get() as f64;
    let middle = (weights.len() - 1) as f64 / 2.0;
    let points = weights.iter().enumerate();
    points
        .map(|(tap, w)| ((tap as f64 - middle) / k, w * k))
        .collect()
}

fn response(filter: Filter, factor: Factor) -> Vec<(f64, f64)> {
    let frequencies = (0..=400).map(|i| f64::from(i) / 100.0);
    frequencies
        .map(|f| (f, filter.response(factor, f)))
        .collect()
}

fn chart(title: &str, x_label: &str, y_label: &str, curves: Vec<Curve>) -> Chart {
    Chart {
        title: title.to_owned(),
        x_label: x_label.to_owned(),
        y_label: y_label.to_owned(),
        x_scale: Scale::Linear,
        y_scale: Scale::Linear,
        curves,
    }
}

/// Weights of a row with 4 samples per pixel.
fn table(filters: &[Filter], factor: Factor) -> String {
    let mut csv = String::from("filter,tap,distance_px,weight\n");
    for &filter in filters {
        let weights = filter.weights(factor);
        let middle = (weights.len() - 1) as f64 / 2.0;
        for (tap, weight) in weights.iter().enumerate() {
            let distance = (tap as f64 - middle) / factor.get() as f64;
            let _ = writeln!(csv, "{filter},{tap},{distance},{weight:.9}");
        }
    }
    csv
}
