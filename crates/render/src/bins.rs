//! What of a stage is seen by a camera, and in which bands of rows.

use crate::grid::Grid;
use crate::projection::{clip_from_world, distance_along_view};
use crate::stage::Stage;
use core::ops::Range;
use glam::{DMat4, DVec2, DVec3, Vec4};
use hemicube_raster::clip::{ClipVertex, clip_triangle};
use hemicube_raster::triangle::Viewport;
use hemicube_scene::Camera;
use rayon::prelude::*;

/// Near plane of the first look, as a share of the scene's diameter.
const NEAREST: f64 = 1e-4;

/// The triangles that a camera sees, sorted into bands of rows.
#[derive(Debug)]
pub(crate) struct Bins {
    /// Clip-space positions of the drawn mesh's vertices.
    pub positions: Vec<Vec4>,
    /// Size of the picture in samples.
    pub viewport: Viewport,
    /// Rows of samples of each band; they may overlap.
    rows: Vec<Range<usize>>,
    /// For each band the triangles that may touch it, in the order of the stage.
    bands: Vec<Vec<u32>>,
}

/// Where a triangle is seen.
struct Seen {
    triangle: u32,
    /// Rows of samples.
    rows: Range<usize>,
    /// Least distance along the viewing direction.
    nearest: f64,
}

impl Bins {
    /// Leaves out the triangles of an instance, if one is named.
    pub fn new(stage: &Stage<'_>, camera: &Camera, grid: &Grid, without: Option<usize>) -> Self {
        let viewport = grid.viewport();
        let (far, diameter) = (farthest(stage, camera), diameter(stage));
        // First look with a near plane just in front of the eye: it finds what is seen and how near that comes.
        let start = (NEAREST * diameter).min(0.5 * far);
        let first = project(stage, camera, grid, start, far);
        let seen = seen_triangles(stage, camera, &first, viewport, without);
        // The near plane moves up to the nearest thing in the picture: depths are resolved as finely as they can be.
        let nearest = seen.iter().map(|s| s.nearest).fold(f64::INFINITY, f64::min);
        let near = (0.99 * nearest).clamp(start, 0.9 * far);
        let mut bands = vec![Vec::new(); grid.bands()];
        for Seen { triangle, rows, .. } in seen {
            for band in &mut bands[grid.bands_of(rows)] {
                band.push(triangle);
            }
        }
        Self {
            positions: project(stage, camera, grid, near, far),
            viewport,
            rows: (0..grid.bands()).map(|band| grid.rows(band)).collect(),
            bands,
        }
    }

    /// Rows of samples of a band.
    pub fn rows(&self, band: usize) -> Range<usize> {
        self.rows[band].clone()
    }

    /// Triangles that may touch a band.
    pub fn triangles(&self, band: usize) -> &[u32] {
        &self.bands[band]
    }
}

fn bounds(stage: &Stage<'_>) -> (DVec3, DVec3) {
    let positions = stage.drawn.positions.iter().map(|p| p.as_dvec3());
    let nothing = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    positions.fold(nothing, |(low, high), p| (low.min(p), high.max(p)))
}

fn diameter(stage: &Stage<'_>) -> f64 {
    let (low, high) = bounds(stage);
    low.distance(high)
}

/// A distance along the viewing direction beyond everything; positive also if all lies behind the eye.
fn farthest(stage: &Stage<'_>, camera: &Camera) -> f64 {
    let positions = stage.drawn.positions.iter().map(|p| p.as_dvec3());
    let distances = positions.map(|p| distance_along_view(camera, p));
    let far = distances.fold(0.0, f64::max) * 1.01;
    if far > 0.0 { far } else { 1.0 }
}

/// Clip-space positions of all vertices, in the clip space of the grid's viewport.
fn project(stage: &Stage<'_>, camera: &Camera, grid: &Grid, near: f64, far: f64) -> Vec<Vec4> {
    let aspect = grid.width as f64 / grid.height as f64;
    let (scale, offset) = grid.clip_scale_and_offset();
    let grid_from_clip =
        DMat4::from_translation(offset.extend(0.0)) * DMat4::from_scale(scale.extend(1.0));
    let clip_from_world = grid_from_clip * clip_from_world(camera, aspect, near, far);
    let positions = stage.drawn.positions.par_iter();
    let clip = |p: &glam::Vec3| (clip_from_world * p.as_dvec3().extend(1.0)).as_vec4();
    positions.map(clip).collect()
}

/// The triangles of which a part lies in the picture and that turn their lit side to the eye, in the order of the stage.
fn seen_triangles(
    stage: &Stage<'_>,
    camera: &Camera,
    clip: &[Vec4],
    viewport: Viewport,
    without: Option<usize>,
) -> Vec<Seen> {
    let positions = &stage.drawn.positions;
    let seen = |(triangle, corners): (u32, [u32; 3])| {
        let vertices = corners.map(|c| {
            let distance = distance_along_view(camera, positions[c as usize].as_dvec3());
            ClipVertex::new(clip[c as usize], [narrow(distance)])
        });
        let polygon = clip_triangle(&vertices, DVec2::ONE);
        let corners = polygon.corners();
        let heights = corners.iter().map(|c| c.position.y / c.position.w);
        let (low, high) = heights.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), y| {
            (low.min(y), high.max(y))
        });
        let nearest = corners.iter().map(|c| c.attributes[0]);
        (!corners.is_empty()).then(|| Seen {
            triangle,
            // Snapping moves corners by less than a sample.
            rows: row(viewport, high).saturating_sub(1)
                ..(row(viewport, low) + 2).min(viewport.height),
            nearest: nearest.fold(f64::INFINITY, f64::min),
        })
    };
    let numbers = 0..u32::try_from(stage.triangles.len()).expect("fewer than 2^32 triangles");
    let triangles = numbers.into_par_iter().zip(stage.triangles.par_iter());
    triangles
        .filter(|(_, triangle)| without != Some(stage.instance_of(triangle)))
        .filter_map(|(t, triangle)| seen((t, triangle.corners)))
        .collect()
}

/// Row of a height in [-1, 1].
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "clamped to the picture"
)]
fn row(viewport: Viewport, y: f64) -> usize {
    let last = viewport.height as f64 - 1.0;
    (0.5 * (1.0 - y) * viewport.height as f64).clamp(0.0, last) as usize
}

#[expect(
    clippy::cast_possible_truncation,
    reason = "distances are for choosing a plane"
)]
fn narrow(x: f64) -> f32 {
    x as f32
}
