//! How the error of anisotropic filters falls with the anisotropy that they are allowed.

use super::plane::{Plane, checks, rms};
use super::{Filter, Prefiltered, size};
use crate::{Exhibit, GalleryError, Piece, Request};
use hemicube_chart::{Chart, Curve, Scale};
use hemicube_raster::texture::{Minify, Sampler};
use rayon::prelude::*;

pub(super) const EXHIBIT: Exhibit = Exhibit {
    name: "ewa-error",
    about: "RMS error of EWA and of samples along the footprint against the anisotropy allowed, beside trilinear",
    needs: &[],
    draw,
};

/// Size of the picture that is measured, and points of its reference along a side of a pixel.
const MEASURED: (usize, usize) = (240, 180);
const POINTS: usize = 64;

const LIMITS: [f32; 7] = [1.0, 2.0, 4.0, 8.0, 16.0, 32.0, 64.0];

fn draw(request: &Request) -> Result<Vec<Piece>, GalleryError> {
    let size = size(request, (900, 520))?;
    let curves = measured(&Plane::new(MEASURED.0, MEASURED.1), POINTS);
    let mut table = String::from("max_anisotropy");
    for (name, _) in &curves {
        table += &format!(",\"{name}\"");
    }
    for (i, limit) in LIMITS.iter().enumerate() {
        table += &format!("\n{limit}");
        for (_, errors) in &curves {
            table += &format!(",{:.5}", errors[i]);
        }
    }
    let curve = |(name, errors): &(&'static str, Vec<f64>)| {
        let limits = LIMITS.iter().map(|limit| f64::from(*limit));
        Curve::new(*name, limits.zip(errors.iter().copied()).collect())
    };
    let chart = Chart {
        title: String::from("A chequered plane to the horizon"),
        x_label: String::from("largest anisotropy"),
        y_label: format!("RMS error against {} points per pixel", POINTS * POINTS),
        x_scale: Scale::Octaves,
        y_scale: Scale::Logarithmic,
        curves: curves.iter().map(curve).collect(),
    };
    Ok(vec![
        Piece::chart("", &chart, size),
        Piece::csv("", table + "\n"),
    ])
}

/// RMS errors for each limit by each filter.
fn measured(plane: &Plane, points: usize) -> Vec<(&'static str, Vec<f64>)> {
    let (pixels, reference) = (plane.pixels(), plane.reference(points));
    let texture = Prefiltered::new(&checks());
    let filters = [
        ("trilinear", Sampler::default()),
        (
            "along the footprint",
            Sampler::default().with_minify(Minify::Anisotropic),
        ),
        (
            "EWA, radius 1",
            Sampler::default()
                .with_minify(Minify::Ewa)
                .with_ewa_radius(1.0),
        ),
        (
            "EWA, radius 0.78",
            Sampler::default().with_minify(Minify::Ewa),
        ),
    ];
    let error = |sampler: Sampler| {
        let filter = Filter::Mip(sampler);
        let found: Vec<f32> = pixels
            .par_iter()
            .map(|p| filter.sample(&texture, p))
            .collect();
        rms(&found, &reference)
    };
    let errors = |sampler: Sampler| {
        LIMITS
            .map(|limit| error(sampler.with_max_anisotropy(limit)))
            .to_vec()
    };
    filters
        .map(|(name, sampler)| (name, errors(sampler)))
        .to_vec()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_fall_with_anisotropy() {
        let curves = measured(&Plane::new(48, 36), 16);
        for (name, errors) in &curves[1..] {
            assert!(errors[4] < 0.5 * errors[0], "{name}: {errors:?}");
        }
        let trilinear = &curves[0].1;
        assert!(
            trilinear.iter().all(|e| e == &trilinear[0]),
            "trilinear knows no anisotropy"
        );
    }
}
