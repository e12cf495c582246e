//! The distortion of every two-part mapping.

use super::mapping::BACKGROUND;
use super::{camera, pairs, surface_point};
use crate::sheet::{Cell, cell_size, sheet};
use crate::stage::{Camera, Mesh, Sampling, draw as draw_stage};
use crate::{GalleryError, Piece, Request};
use glam::{Vec2, Vec3};
use hemicube_chart::Canvas;
use hemicube_raster::two_part::{Distortion, DistortionSummary, SurfacePoint, TwoPart};
use hemicube_raster::{Image, Rgb};
use std::fmt::Write as _;

/// What has no texture, or texture of no area.
const BARE: Rgb = Rgb::splat(0.2);

pub(super) fn draw(request: &Request) -> Result<Vec<Piece>, GalleryError> {
    let cell_size = cell_size(request, (1080, 1760), (4, 5), 3)?;
    let vase = Mesh::vase(192);
    let all: Vec<_> = pairs()
        .map(|(names, mapping)| (names, mapping, summary(&vase, &mapping)))
        .collect();
    let of_all = |color: fn(&Distortion) -> Rgb, text: fn(&DistortionSummary) -> [f64; 3]| {
        let cells = all.iter().map(|([s, o], mapping, summary)| {
            let figures = summary.as_ref().map_or_else(
                || String::from("no texture anywhere"),
                |summary| figures(text(summary)),
            );
            Cell {
                image: picture(&vase, mapping, cell_size, color),
                lines: vec![(*s).to_owned(), (*o).to_owned(), figures],
            }
        });
        sheet(&cells.collect::<Vec<_>>(), 4)
    };
    let mut table = String::from(
        "intermediate surface,object map,mapped share,area min,area mean,area max,anisotropy min,anisotropy mean,anisotropy max\n",
    );
    for ([s, o], _, summary) in &all {
        let Some(d) = summary else { continue };
        let ([a, b, c], [e, f, g]) = (d.area, d.anisotropy);
        let _ = writeln!(
            table,
            "\"{s}\",{o},{:.4},{a:.4},{b:.4},{c:.4},{e:.4},{f:.4},{g:.4}",
            d.mapped
        );
    }
    Ok(vec![
        Piece::sheet("-area", &of_all(area_color, |d| d.area))?,
        Piece::sheet("-anisotropy", &of_all(anisotropy_color, |d| d.anisotropy))?,
        Piece::sheet("-legend", &legend())?,
        Piece::csv("", table),
    ])
}

/// What the colours mean, and the figures below the pictures.
fn legend() -> Canvas {
    const SIZE: (usize, usize) = (420, 30);
    let ramp = |color: fn(&Distortion) -> Rgb, at: fn(f64) -> Distortion| {
        let shade = |i: usize| color(&at((i % SIZE.0) as f64 / SIZE.0 as f64));
        Image::from_pixels(SIZE.0, SIZE.1, (0..SIZE.0 * SIZE.1).map(shade).collect())
            .expect("a colour for each pixel")
    };
    let area = ramp(area_color, |share| Distortion {
        major: 16.0_f64.powf(2.0 * share - 1.0),
        minor: 1.0,
    });
    let anisotropy = ramp(anisotropy_color, |share| Distortion {
        major: 16.0_f64.powf(share),
        minor: 1.0,
    });
    let figures = "figures: smallest | geometric mean | largest";
    let cells = [
        Cell::new(
            area,
            &[
                "texture area on the surface",
                "1/16 to 16, white: 1",
                figures,
            ],
        ),
        Cell::new(
            anisotropy,
            &["anisotropy", "1 to 16 times as long as wide", figures],
        ),
    ];
    sheet(&cells, 1)
}

/// Smallest, mean and largest.
fn figures([low, mean, high]: [f64; 3]) -> String {
    let short = |x: f64| {
        if x.is_infinite() || x >= 1e4 {
            String::from(">10000")
        } else if x < 0.01 {
            String::from("<0.01")
        } else if x < 10.0 {
            format!("{x:.2}")
        } else {
            format!("{x:.0}")
        }
    };
    format!("{} | {} | {}", short(low), short(mean), short(high))
}

/// In lengths on the intermediate surface, so that 1 is what an isometric mapping has.
fn distortion(mapping: &TwoPart, surface: &SurfacePoint) -> Option<Distortion> {
    let mapped = mapping.map(surface)?;
    let extent = mapping.s.extent(mapped.face);
    Distortion::of(surface.d_point, mapped.d_texcoord.map(|d: Vec2| d * extent))
}

fn picture(
    vase: &Mesh,
    mapping: &TwoPart,
    size: (usize, usize),
    color: fn(&Distortion) -> Rgb,
) -> Image<Rgb> {
    let camera = camera();
    let sampling = Sampling { size, per_side: 2 };
    draw_stage(&camera, sampling, &[vase], BACKGROUND, |fragment| {
        let surface = surface_point(fragment, camera.eye);
        let found = distortion(mapping, &surface);
        let facing = fragment.normal.dot(fragment.view).abs();
        found.map_or(BARE, |d| color(&d)) * (0.55 + 0.45 * facing)
    })
}

/// Over all of the mesh, at the middle of each triangle, with the normals interpolated over it.
fn summary(mesh: &Mesh, mapping: &TwoPart) -> Option<DistortionSummary> {
    let Camera { eye, .. } = camera();
    DistortionSummary::of(mesh.triangles.iter().map(|triangle| {
        let [a, b, c] = triangle.map(|i| mesh.vertices[i as usize]);
        let d_point = [b.position - a.position, c.position - a.position];
        let mean = |p: Vec3, q: Vec3, r: Vec3| (p + q + r) / 3.0;
        let point = mean(a.position, b.position, c.position);
        let surface = SurfacePoint {
            point,
            normal: mean(a.normal, b.normal, c.normal),
            view: eye - point,
            d_point,
            d_normal: [b.normal - a.normal, c.normal - a.normal],
            d_view: d_point.map(|d| -d),
        };
        let area = 0.5 * f64::from(d_point[0].cross(d_point[1]).length());
        (area, distortion(mapping, &surface))
    }))
}

/// White where the texture has the surface's size; red where it is squeezed, blue where it is stretched, deepest at 16
/// times the area.
fn area_color(d: &Distortion) -> Rgb {
    let octaves = d.area().log2() / 4.0;
    let far = narrow(octaves.abs().min(1.0));
    let end = if octaves > 0.0 {
        Rgb::new(0.55, 0.01, 0.02)
    } else {
        Rgb::new(0.01, 0.07, 0.5)
    };
    ramp(end, far)
}

/// White where squares stay squares; the darker green the longer they become, deepest at 16 times as long as wide.
fn anisotropy_color(d: &Distortion) -> Rgb {
    let octaves = narrow((d.anisotropy().log2() / 4.0).min(1.0));
    ramp(Rgb::new(0.0, 0.12, 0.05), octaves)
}

fn ramp(end: Rgb, share: f32) -> Rgb {
    Rgb::splat(0.95).lerp(end, share.sqrt())
}

#[expect(clippy::cast_possible_truncation, reason = "a share in [0, 1]")]
fn narrow(share: f64) -> f32 {
    share as f32
}

#[cfg(test)]
mod tests {
    use super::*;
    use hemicube_raster::two_part::{OMap, SMap};

    #[test]
    fn tube_in_its_own_cylinder_is_not_distorted() {
        let tube = Mesh::parametric(64, 4, |u, v| {
            let (sin, cos) = ((u - 0.5) * core::f32::consts::TAU).sin_cos();
            let normal = Vec3::new(sin, 0.0, cos);
            (normal + Vec3::Y * (1.0 - 2.0 * v), normal)
        });
        let wrapped = TwoPart::new(SMap::cylinder(1.0, 2.0), OMap::IntermediateNormal);
        let found = summary(&tube, &wrapped).expect("a texture");
        // Chords are shorter than arcs: 64 of them by 0.08 % in the middle.
        for value in found.area.into_iter().chain(found.anisotropy) {
            assert!((value - 1.0).abs() < 2e-3, "{found:?}");
        }
        assert_eq!(found.mapped, 1.0);
    }

    #[test]
    fn table_has_a_row_for_each_pair() {
        let request = Request {
            size: Some((100, 560)),
            ..Request::default()
        };
        let pieces = draw(&request).expect("sheets and a table");
        let suffixes: Vec<&str> = pieces.iter().map(|p| p.suffix.as_str()).collect();
        assert_eq!(
            suffixes,
            ["-area.png", "-anisotropy.png", "-legend.png", ".csv"]
        );
        let table = String::from_utf8(pieces[3].bytes.clone()).expect("text");
        assert_eq!(table.lines().count(), 21, "{table}");
    }
}
