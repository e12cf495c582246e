//! Highlights by model and exponent.

use super::{BACKGROUND, main_light};
use crate::sheet::{Cell, cell_size, sheet};
use crate::stage::{Camera, Mesh, Sampling, draw as draw_stage};
use crate::{GalleryError, Piece, Request};
use glam::{Quat, Vec3};
use hemicube_raster::Rgb;
use hemicube_raster::reflection::{BlinnPhong, Phong};

const EXPONENTS: [f32; 4] = [5.0, 20.0, 80.0, 320.0];

/// A model of an exponent, for a normal, a light and a view.
type Model = fn(f32, Vec3, Vec3, Vec3) -> f32;

/// Each model by name: the classic lobes, then those that keep energy, under a light that gives both the same picture at
/// an exponent of 20.
const MODELS: [(&str, Model); 4] = [
    ("Phong", |n, normal, l, v| Phong::new(n).lobe(normal, l, v)),
    ("Blinn-Phong", |n, normal, l, v| {
        BlinnPhong::new(n).lobe(normal, l, v)
    }),
    ("Phong, normalised", |n, normal, l, v| {
        let unit = Phong::new(20.0).reflectance(Vec3::Z, Vec3::Z, Vec3::Z);
        Phong::new(n).reflectance(normal, l, v) / unit
    }),
    ("Blinn-Phong, normalised", |n, normal, l, v| {
        let unit = BlinnPhong::new(20.0).reflectance(Vec3::Z, Vec3::Z, Vec3::Z);
        BlinnPhong::new(n).reflectance(normal, l, v) / unit
    }),
];

pub(super) fn draw(request: &Request) -> Result<Vec<Piece>, GalleryError> {
    let cell_size = cell_size(request, (960, 1160), (4, 4), 2)?;
    let ring = Mesh::torus(0.86, 0.14, 128).moved(Quat::from_rotation_x(0.5), Vec3::ZERO);
    let meshes = [&Mesh::sphere(0.62, 128), &ring];
    let colors = [Rgb::new(0.35, 0.06, 0.05), Rgb::new(0.05, 0.12, 0.3)];
    let camera = Camera::new(Vec3::new(0.0, 0.0, 5.2), Vec3::ZERO, 24.0);
    let sampling = Sampling {
        size: cell_size,
        per_side: 2,
    };
    let mut cells = Vec::new();
    for (name, model) in MODELS {
        for exponent in EXPONENTS {
            let image = draw_stage(&camera, sampling, &meshes, BACKGROUND, |f| {
                let light = main_light();
                let cosine = f.normal.dot(light).max(0.0);
                let gloss = model(exponent, f.normal, light, f.view);
                let color = colors[f.mesh] * (0.1 + cosine);
                (color + Rgb::splat(0.5 * gloss * cosine.sqrt())).map(|c| c.min(1.0))
            });
            cells.push(Cell {
                image,
                lines: vec![name.to_owned(), format!("exponent {exponent}")],
            });
        }
    }
    Ok(vec![Piece::sheet("", &sheet(&cells, 4))?])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sixteen_spheres_are_drawn() {
        let request = Request {
            size: Some((160, 320)),
            ..Request::default()
        };
        assert_eq!(draw(&request).expect("a sheet").len(), 1);
    }

    /// A narrower normalised highlight is brighter, a classic one is not.
    #[test]
    fn normalised_peaks_grow_with_the_exponent() {
        let peak = |model: Model, n| model(n, Vec3::Z, Vec3::Z, Vec3::Z);
        for (name, model) in MODELS {
            let growth = peak(model, 320.0) / peak(model, 20.0);
            let grows = name.ends_with("normalised");
            assert!(
                if grows { growth > 10.0 } else { growth == 1.0 },
                "{name}: {growth}"
            );
        }
    }
}
