//! What each sample of a band of rows sees: the nearest surface, and the layers of glass before it.
//!
//! Nothing is shaded while triangles are drawn: a sample keeps the number of its triangle and where in it the sample
//! lies, so that material and light are evaluated once for what is seen in the end. Only alpha masks are looked at
//! earlier, because holes decide what is seen.

use crate::bins::Bins;
use crate::shade::is_hole;
use crate::stage::{Cover, Stage};
use core::ops::Range;
use hemicube_raster::clip::ClipVertex;
use hemicube_raster::triangle::{Cull, DepthBuffer, draw_triangle};

/// A point of a triangle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct SurfaceHit {
    /// Index into the stage's triangles, [`Self::NOTHING`] if nothing was hit.
    pub triangle: u32,
    /// Barycentric weights of the second and third corner, perspective-correct.
    pub weights: [f32; 2],
}

impl SurfaceHit {
    const NOTHING: u32 = u32::MAX;

    /// Whether there is a surface at all.
    pub fn exists(&self) -> bool {
        self.triangle != Self::NOTHING
    }
}

/// A transparent surface before the nearest opaque one of a sample.
#[derive(Debug, Clone, Copy)]
struct Layer {
    sample: u32,
    depth: f32,
    hit: SurfaceHit,
}

/// What the samples of a band see.
#[derive(Debug)]
pub(crate) struct Band {
    hits: Vec<SurfaceHit>,
    /// Sorted by sample, then from far to near.
    layers: Vec<Layer>,
}

/// The barycentric weights of the second and third corner, at the corners.
const CORNER_WEIGHTS: [[f32; 2]; 3] = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];

impl Band {
    /// Draws one band.
    pub fn draw(stage: &Stage<'_>, bins: &Bins, band: usize) -> Self {
        let rows = bins.rows(band);
        let count = rows.len() * bins.viewport.width;
        let nothing = SurfaceHit {
            triangle: SurfaceHit::NOTHING,
            weights: [0.0; 2],
        };
        let mut depth = vec![DepthBuffer::EMPTY; count];
        let mut hits = vec![nothing; count];
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
                let sample = u32::try_from(sample).expect("a band has fewer than 2^32 samples");
                layers.push(Layer { sample, depth, hit });
                false
            });
        }
        // The sort is stable: of equal depths the first drawn stays behind.
        layers.sort_by(|a, b| a.sample.cmp(&b.sample).then(b.depth.total_cmp(&a.depth)));
        Self { hits, layers }
    }

    /// The nearest surface that hides what is behind, for a sample counted row by row from the band's first.
    pub fn hit(&self, sample: usize) -> &SurfaceHit {
        &self.hits[sample]
    }

    /// The transparent surfaces before it, from far to near.
    pub fn layers(&self, sample: usize) -> impl Iterator<Item = &SurfaceHit> {
        let start = self
            .layers
            .partition_point(|l| (l.sample as usize) < sample);
        let of_sample = move |l: &&Layer| l.sample as usize == sample;
        self.layers[start..]
            .iter()
            .take_while(of_sample)
            .map(|l| &l.hit)
    }
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
