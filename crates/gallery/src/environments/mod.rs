//! Environment mapping: projections, blur by roughness, irradiance, parallax.

mod irradiance;
mod parallax;
mod projections;
mod sky;
mod spheres;

use crate::exhibit::{Exhibit, GalleryError, Request};
use crate::sheet::picture_size;
use hemicube_raster::environment::{EnvironmentMap, open_map};
use hemicube_raster::{Image, Rgb};

/// The exhibits of this module.
pub(crate) const EXHIBITS: &[Exhibit] = &[
    Exhibit {
        name: "environment-projections",
        about: "one environment with labelled directions in all eight projections, and what conversion does to its light",
        needs: &[],
        draw: projections::draw,
    },
    Exhibit {
        name: "environment-projections-file",
        about: "the same of a panorama or a cube from a file, or from the files of its faces (a folder, or a name with {face})",
        needs: &["panorama.hdr"],
        draw: projections::draw_file,
    },
    Exhibit {
        name: "environment-spheres",
        about: "balls that reflect an environment: by roughness, by lobe; looked up for each pixel and for each vertex",
        needs: &[],
        draw: spheres::draw,
    },
    Exhibit {
        name: "environment-spheres-file",
        about: "the same in a panorama or a cube from a file, or from the files of its faces (a folder, or a name with {face})",
        needs: &["panorama.hdr"],
        draw: spheres::draw_file,
    },
    Exhibit {
        name: "irradiance-map",
        about: "irradiance by spherical harmonics of growing degree beside the sum over all directions, and the errors",
        needs: &[],
        draw: irradiance::draw,
    },
    Exhibit {
        name: "parallax-correction",
        about: "mirrors in a room: maps of the nearest place, blended and box-projected, beside traced rays",
        needs: &[],
        draw: parallax::draw,
    },
];

/// The size of panels, checked.
fn panel_size(request: &Request, default: (usize, usize)) -> Result<(usize, usize), GalleryError> {
    picture_size(request, default, 64..=2048)
}

/// The map that an exhibit was given: a picture, a folder of faces, or a name with `{face}` in it.
fn file_of(request: &Request) -> Result<EnvironmentMap, GalleryError> {
    let path = request.files.first().ok_or_else(|| GalleryError::File {
        path: "panorama.hdr".into(),
        why: String::from("was not given"),
    })?;
    Ok(open_map(path, None)?.map)
}

/// Root of the mean squared difference of all bands, relative to the mean of the second picture.
fn relative_rms(found: &Image<Rgb>, truth: &Image<Rgb>) -> f64 {
    let (mut squares, mut sum) = (0.0, 0.0);
    for (a, b) in found.pixels().iter().zip(truth.pixels()) {
        for band in 0..3 {
            squares += f64::from(a[band] - b[band]).powi(2);
            sum += f64::from(b[band]);
        }
    }
    let count = 3.0 * truth.pixels().len() as f64;
    (squares / count).sqrt() / (sum / count)
}
