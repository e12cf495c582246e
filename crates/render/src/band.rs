//! What each sample of a band of rows sees, found by drawing triangles: for projections that keep lines straight.
//!
//! Nothing is shaded while triangles are drawn: a sample keeps the number of its triangle and where in it the sample
//! lies, so that material and light are evaluated once for what is seen in the end. Only alpha masks are looked at
//! earlier, because holes decide what is seen.

use crate::bins::Bins;
use crate::sight::{Layer, Sights, SurfaceHit, sample_number};
use crate::stage::{Cover, Stage};
use crate::surface::is_hole;
use core::ops::Range;
use hemicube_raster::clip::ClipVertex;
use hemicube_raster::triangle::{Cull, DepthBuffer, draw_triangle};

/// The barycentric weights of the second and third corner, at the corners.
const CORNER_WEIGHTS: [[f32; 2]; 3] = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];

/// Draws one band of the picture.
pub(crate) fn draw_band(stage: &Stage<'_>, bins: &Bins, band: usize) -> Sights {
    let rows = bins.rows(band);
    let count = rows.len() * bins.viewport.width;
    let mut depth = vec![DepthBuffer::EMPTY; count];
    let mut hits = vec![SurfaceHit::EMPTY; count];
    let mut layers = Vec::new();
    let triangles = bins.triangles(band);
    let of_cover = |wanted: Cover| {
        let cover = move |t: &u32| stage.triangles[*t as usize].cover == wanted;
        triangles.iter().copied().filter(cover)
    };
    for t in of_cover(Cover::Opaque) {
        draw(stage, bins, &rows, t, &mut depth, |sample, _, hit| {
            hits[sample] = hit;
            true
        });
    }
    for t in of_cover(Cover::Mask) {
        draw(stage, bins, &rows, t, &mut depth, |sample, _, hit| {
            let solid = !is_hole(stage, &hit);
            if solid {
                hits[sample] = hit;
            }
            solid
        });
    }
    fill_pinholes(bins.viewport.width, &mut hits, &mut depth);
    for t in of_cover(Cover::Transparent) {
        draw(stage, bins, &rows, t, &mut depth, |sample, depth, hit| {
            let sample = sample_number(sample);
            layers.push(Layer { sample, depth, hit });
            false
        });
    }
    Sights::new(hits, layers)
}

/// Gives single samples that see nothing amid samples that do what their left neighbour sees.
///
/// Where edges of a scene meet without sharing their vertices, snapping to the grid of the screen opens gaps of a few
/// hundredths of a sample; one in a million samples falls through and would show a bright sky in a dark corner.
fn fill_pinholes(width: usize, hits: &mut [SurfaceHit], depth: &mut [f32]) {
    let inner_rows = width..hits.len().saturating_sub(width);
    for i in inner_rows.filter(|i| (1..width.saturating_sub(1)).contains(&(i % width))) {
        let around = [i - 1, i + 1, i - width, i + width];
        if !hits[i].exists() && around.iter().all(|&k| hits[k].exists()) {
            (hits[i], depth[i]) = (hits[i - 1], depth[i - 1]);
        }
    }
}

/// Draws the front of a triangle; `fragment` gets the sample's number in the band, its depth and the point.
fn draw(
    stage: &Stage<'_>,
    bins: &Bins,
    rows: &Range<usize>,
    triangle: u32,
    depth: &mut [f32],
    mut fragment: impl FnMut(usize, f32, SurfaceHit) -> bool,
) {
    let corners = stage.triangles[triangle as usize].corners;
    let vertices: [ClipVertex<2>; 3] = core::array::from_fn(|i| {
        ClipVertex::new(bins.positions[corners[i] as usize], CORNER_WEIGHTS[i])
    });
    let (first, width) = (rows.start, bins.viewport.width);
    draw_triangle(
        rows.clone(),
        bins.viewport,
        Cull::Back,
        &vertices,
        depth,
        |x, y, z, &weights| {
            let hit = SurfaceHit { triangle, weights };
            fragment((y - first) * width + x, z, hit)
        },
    );
}
