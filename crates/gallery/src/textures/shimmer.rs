//! Shimmering in numbers: how much a picture changes from frame to frame while the eye moves slowly.

use super::plane::{Plane, checks, rms};
use super::{Filter, Prefiltered, size};
use crate::{Exhibit, GalleryError, Piece, Request};
use glam::DVec2;
use hemicube_chart::{Chart, Curve, Scale};
use rayon::prelude::*;

pub(super) const EXHIBIT: Exhibit = Exhibit {
    name: "shimmer",
    about: "change between the frames of a slow move over a fine texture, by filter, beyond what a perfect one changes",
    needs: &[],
    draw,
};

/// Size of the frames, and points of the perfect picture along a side of a pixel.
const MEASURED: (usize, usize) = (160, 120);
const FRAMES: usize = 24;
const POINTS: usize = 24;

/// Move from frame to frame in texture coordinates: a third of a pixel in the foreground.
const STEP: DVec2 = DVec2::new(0.000_7, 0.000_9);

/// What a filter changes between frames, in linear light.
struct Shimmer {
    name: &'static str,
    /// Mean absolute change of each row below the horizon.
    rows: Vec<f64>,
    /// Mean absolute difference of each row between its changes and those of the perfect picture.
    wrong: Vec<f64>,
    /// RMS error of all frames.
    error: f64,
}

impl Shimmer {
    fn change(&self) -> f64 {
        mean(&self.rows)
    }
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

fn draw(request: &Request) -> Result<Vec<Piece>, GalleryError> {
    let size = size(request, (1000, 560))?;
    let (ideal, filters) = measured(&Plane::new(MEASURED.0, MEASURED.1), FRAMES, POINTS);
    let mut table = String::from("filter,change,ideal,excess,wrong_change,rms_error\n");
    for filter in &filters {
        let (change, perfect) = (filter.change(), mean(&ideal));
        table += &format!(
            "\"{}\",{change:.5},{perfect:.5},{:.5},{:.5},{:.5}\n",
            filter.name,
            change - perfect,
            mean(&filter.wrong),
            filter.error
        );
    }
    let chart = |y_label: &str, curves: Vec<Curve>| Chart {
        title: String::from("Shimmering of a slow move"),
        x_label: String::from("rows below the horizon"),
        y_label: y_label.to_owned(),
        x_scale: Scale::Linear,
        y_scale: Scale::Linear,
        curves,
    };
    let curve = |name: &str, rows: &[f64]| {
        let points = (0..).map(f64::from).zip(rows.iter().copied());
        Curve::new(name, points.collect())
    };
    let wrong = filters.iter().map(|f| curve(f.name, &f.wrong));
    let wrong = chart(
        "mean change per frame that the ideal has not",
        wrong.collect(),
    );
    let excess = filters
        .iter()
        .map(|f| curve(f.name, &difference(&f.rows, &ideal)));
    let excess = chart("mean change per frame less the ideal's", excess.collect());
    Ok(vec![
        Piece::chart("", &wrong, size),
        Piece::chart("-excess", &excess, size),
        Piece::csv("", table),
    ])
}

fn difference(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a - b).collect()
}

/// The change of the perfect picture by row, and what each filter does.
fn measured(plane: &Plane, frames: usize, points: usize) -> (Vec<f64>, Vec<Shimmer>) {
    let planes: Vec<Plane> = (0..frames).map(|i| plane.moved(STEP * i as f64)).collect();
    let perfect: Vec<Vec<f32>> = planes.iter().map(|p| p.reference(points)).collect();
    let texture = Prefiltered::new(&checks());
    let shimmer = |(name, filter): (&'static str, Filter)| {
        let frame = |plane: &Plane| {
            plane
                .pixels()
                .iter()
                .map(|p| filter.sample(&texture, p))
                .collect()
        };
        let found: Vec<Vec<f32>> = planes.par_iter().map(frame).collect();
        Shimmer {
            name,
            rows: changes_by_row(&found, plane.rows()),
            wrong: changes_by_row(&differences(&found, &perfect), plane.rows()),
            error: rms(&found.concat(), &perfect.concat()),
        }
    };
    let filters = Filter::all().map(shimmer).into_iter().collect();
    (changes_by_row(&perfect, plane.rows()), filters)
}

fn changes_by_row(frames: &[Vec<f32>], rows: usize) -> Vec<f64> {
    let width = frames[0].len() / rows;
    let change = |row: usize| {
        let row = row * width..(row + 1) * width;
        let pairs = frames
            .windows(2)
            .flat_map(|pair| pair[0][row.clone()].iter().zip(&pair[1][row.clone()]));
        pairs.map(|(a, b)| f64::from((b - a).abs())).sum::<f64>()
            / (width * (frames.len() - 1)) as f64
    };
    (0..rows).map(change).collect()
}

/// What each frame lacks of the perfect one: its change is the difference of the changes.
fn differences(found: &[Vec<f32>], perfect: &[Vec<f32>]) -> Vec<Vec<f32>> {
    let frames = found.iter().zip(perfect);
    let frame = |(a, b): (&Vec<f32>, &Vec<f32>)| a.iter().zip(b).map(|(a, b)| a - b).collect();
    frames.map(frame).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn point_sampling_shimmers_and_ewa_does_not() {
        let (ideal, filters) = measured(&Plane::new(48, 36), 3, 16);
        let wrong = |name: &str| {
            let filter = filters
                .iter()
                .find(|f| f.name == name)
                .expect("it is measured");
            mean(&filter.wrong)
        };
        assert!(
            wrong("point") > 5.0 * wrong("EWA, 16"),
            "{} {}",
            wrong("point"),
            wrong("EWA, 16")
        );
        assert!(mean(&ideal) > 0.0, "the eye moves");
    }

    #[test]
    fn still_pictures_do_not_change() {
        let frames = vec![vec![0.5; 12]; 4];
        assert_eq!(changes_by_row(&frames, 3), [0.0; 3], "three rows");
        let wrong = changes_by_row(&differences(&frames, &frames), 3);
        assert_eq!(wrong, [0.0; 3], "nothing is missing");
    }
}
