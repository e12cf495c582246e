//! A vase under every two-part mapping.

use super::card::card;
use super::{camera, pairs, surface_point};
use crate::sheet::{Cell, cell_size, sheet};
use crate::stage::{Camera, Fragment, Mesh, Sampling, draw as draw_stage};
use crate::{GalleryError, Piece, Request};
use glam::{Vec2, Vec3};
use hemicube_chart::Canvas;
use hemicube_raster::texture::{Minify, Sampler, Texture};
use hemicube_raster::two_part::{Mapped, OMap, SMap, SurfacePoint, TwoPart};
use hemicube_raster::{Image, Rgb};

/// What has no texture.
const BARE: Rgb = Rgb::new(0.25, 0.24, 0.23);

pub(super) const BACKGROUND: Rgb = Rgb::splat(0.93);

/// Side of a field of the card on the intermediate surface.
const FIELD: f32 = 0.5;

pub(super) fn draw(request: &Request) -> Result<Vec<Piece>, GalleryError> {
    let cell_size = cell_size(request, (1080, 1660), (4, 5), 2)?;
    let vase = Mesh::vase(96);
    let cell = |([s, o], mapping): ([&str; 2], TwoPart)| Cell {
        image: textured(&vase, &mapping, cell_size),
        lines: vec![s.to_owned(), o.to_owned()],
    };
    let cells: Vec<Cell> = pairs().map(cell).collect();
    Ok(vec![
        Piece::sheet("", &sheet(&cells, 4))?,
        Piece::sheet("-seam", &seam(&vase, cell_size))?,
    ])
}

/// The back of the vase, where u jumps from 1 to 0, with footprints from differences between pixels, as a naive program
/// takes them, and with exact ones.
fn seam(vase: &Mesh, size: (usize, usize)) -> Canvas {
    let camera = Camera::new(Vec3::new(0.4, 0.8, -3.2), Vec3::ZERO, 16.0);
    let mapping = TwoPart::new(SMap::cylinder(1.1, 2.4), OMap::IntermediateNormal);
    let card = card((mapping.s.extent(0) / FIELD).round().as_uvec2());
    let picture = |footprint: &(dyn Fn(&SurfacePoint, &Mapped) -> [Vec2; 2] + Sync)| {
        let sampling = Sampling { size, per_side: 1 };
        draw_stage(&camera, sampling, &[vase], BACKGROUND, |fragment| {
            let surface = surface_point(fragment, camera.eye);
            let color = mapping.map(&surface).map_or(BARE, |mapped| {
                let [dx, dy] = footprint(&surface, &mapped);
                let texel = Sampler::default().sample_grad(&card, mapped.texcoord, dx, dy);
                Rgb::new(texel.x, texel.y, texel.z)
            });
            color * shading(fragment)
        })
    };
    let naive = |surface: &SurfacePoint, here: &Mapped| {
        surface.d_point.map(|d| {
            let next = mapping.texcoord(surface.point + d, surface.normal, surface.view);
            next.map_or(Vec2::ZERO, |(texcoord, _)| texcoord - here.texcoord)
        })
    };
    let exact = |_: &SurfacePoint, mapped: &Mapped| mapped.d_texcoord;
    let cells = [
        Cell::new(picture(&naive), &["differences", "a line at the seam"]),
        Cell::new(picture(&exact), &["derivatives", "no line"]),
    ];
    sheet(&cells, 2)
}

/// The vase with the card of the mapping's surface, in light from the upper left.
fn textured(vase: &Mesh, mapping: &TwoPart, size: (usize, usize)) -> Image<Rgb> {
    let fields = |face| (mapping.s.extent(face) / FIELD).round().as_uvec2();
    let cards: Vec<Texture> = (0..distinct_faces(&mapping.s))
        .map(|i| card(fields(i)))
        .collect();
    let sampler = Sampler::default().with_minify(Minify::Ewa);
    let camera = camera();
    let sampling = Sampling { size, per_side: 2 };
    draw_stage(&camera, sampling, &[vase], BACKGROUND, |fragment| {
        let surface = surface_point(fragment, camera.eye);
        let color = mapping.map(&surface).map_or(BARE, |mapped| {
            let card = &cards[mapped.face.min(cards.len() - 1)];
            let [dx, dy] = mapped.d_texcoord;
            let texel = sampler.sample_grad(card, mapped.texcoord, dx, dy);
            Rgb::new(texel.x, texel.y, texel.z)
        });
        color * shading(fragment)
    })
}

/// Faces with textures of other proportions: a can's side and caps.
fn distinct_faces(s: &SMap) -> usize {
    match s {
        SMap::Cylinder { caps: true, .. } => 2,
        _ => 1,
    }
}

/// Soft light from the upper left that leaves no side black; what is seen from inside is darker.
pub(super) fn shading(fragment: &Fragment) -> f32 {
    let light = Vec3::new(-0.5, 0.6, 0.65).normalize();
    let is_outside = fragment.normal.dot(fragment.view) > 0.0;
    let lit = 0.45 + 0.6 * fragment.normal.dot(light).max(0.0);
    if is_outside { lit } else { 0.3 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sheet_is_drawn_in_the_size_asked_for() {
        let request = Request {
            size: Some((240, 420)),
            ..Request::default()
        };
        let pieces = draw(&request).expect("sheets");
        let suffixes: Vec<&str> = pieces.iter().map(|p| p.suffix.as_str()).collect();
        assert_eq!(suffixes, [".png", "-seam.png"]);
        let tiny = Request {
            size: Some((20, 20)),
            ..Request::default()
        };
        assert!(matches!(draw(&tiny), Err(GalleryError::Size { .. })));
    }

    /// Neither the seam of the cylinder nor the pole of the sphere draws a blurred line: neighbouring pixels there have
    /// footprints like anywhere else.
    #[test]
    fn no_footprint_is_as_wide_as_the_texture() {
        let vase = Mesh::vase(96);
        let eye = Vec3::new(0.3, 0.4, -4.3);
        let camera = Camera::new(eye, Vec3::ZERO, 30.0);
        let mapping = TwoPart::new(SMap::cylinder(1.1, 2.4), super::super::O_MAPS[3].1);
        let sampling = Sampling {
            size: (120, 120),
            per_side: 1,
        };
        let wide = std::sync::atomic::AtomicUsize::new(0);
        let seen = std::sync::atomic::AtomicUsize::new(0);
        draw_stage(&camera, sampling, &[&vase], BACKGROUND, |fragment| {
            let surface = surface_point(fragment, eye);
            let mapped = mapping.map(&surface).expect("the side has a texture");
            let [dx, dy] = mapped.d_texcoord;
            let order = std::sync::atomic::Ordering::Relaxed;
            seen.fetch_add(1, order);
            // At the rim of the silhouette footprints are long, but not for the seam's sake.
            let edge_on = fragment.normal.dot(fragment.view).abs() < 0.2;
            if dx.length().max(dy.length()) > 0.1 && !edge_on {
                wide.fetch_add(1, order);
            }
            Rgb::BLACK
        });
        assert!(seen.into_inner() > 2000, "the vase is seen");
        assert_eq!(wide.into_inner(), 0, "the seam is in view and not seen");
    }
}
