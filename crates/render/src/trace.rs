//! What each sample of a band sees, found by rays: for projections that bend lines, and for samples off a grid.
//!
//! Each sample's ray is exact. Where it goes on behind a hole, a pane or the back of a one-sided face it starts a
//! hundred-thousandth of the scene's size farther, as rays of the solution do: surfaces that are closer together than
//! that count as one.

use crate::grid::Grid;
use crate::lens::{CameraRay, Lens};
use crate::sight::{Layer, Sights, SurfaceHit, sample_number};
use crate::stage::{Cover, Stage};
use crate::surface::is_hole;
use glam::{DVec3, Vec3};
use hemicube_radiosity::visibility::Hit;

/// Surfaces that a ray may pass: holes, panes, backs.
const MOST_SURFACES: usize = 256;

/// Traces one band of the picture. Of a named instance nothing is seen.
pub(crate) fn trace_band(
    stage: &Stage<'_>,
    lens: &Lens,
    grid: &Grid,
    band: usize,
    without: Option<usize>,
) -> Sights {
    let (rows, columns) = (grid.rows(band), grid.columns());
    let (mut hits, mut layers) = (Vec::with_capacity(rows.len() * columns), Vec::new());
    for row in rows {
        for column in 0..columns {
            let sample = sample_number(hits.len());
            let hit = match lens.ray(grid.position(column, row)) {
                None => SurfaceHit::NO_DIRECTION,
                Some(ray) => trace(stage, &ray, without, |hit, depth| {
                    layers.push(Layer { sample, depth, hit });
                }),
            };
            hits.push(hit);
        }
    }
    Sights::new(hits, layers)
}

/// The nearest surface along a ray that hides what is behind; `layer` gets the transparent ones before it and their
/// distance.
pub(crate) fn trace(
    stage: &Stage<'_>,
    ray: &CameraRay,
    without: Option<usize>,
    mut layer: impl FnMut(SurfaceHit, f32),
) -> SurfaceHit {
    let mesh = stage.solution.mesh();
    let visibility = mesh.visibility();
    let direction = ray.direction.normalize().as_vec3() + Vec3::ZERO;
    let eye = ray.origin.as_vec3();
    let mut start = eye;
    for _ in 0..MOST_SURFACES {
        let Some(met) = visibility.first_hit(start, direction, f32::INFINITY) else {
            return SurfaceHit::EMPTY;
        };
        let hit = seen_at(stage, ray, &met)
            .filter(|hit| without != Some(stage.instance_of(stage.triangle(hit))));
        if let Some(hit) = hit {
            match stage.triangle(&hit).cover {
                Cover::Opaque => return hit,
                Cover::Mask if !is_hole(stage, &hit) => return hit,
                Cover::Mask => {}
                Cover::Transparent => layer(hit, met.point.distance(eye)),
            }
        }
        let normal = mesh.faces()[met.face].normal;
        start = visibility.off_surface(met.point, normal * normal.dot(direction).signum());
    }
    SurfaceHit::EMPTY
}

/// The place in the drawn mesh of a face that was met; none from behind a one-sided one.
fn seen_at(stage: &Stage<'_>, ray: &CameraRay, met: &Hit) -> Option<SurfaceHit> {
    let mesh = stage.solution.mesh();
    let element = mesh.element_at(met.face, met.side, met.point)?;
    let triangles = stage.triangles_of(element);
    let places = triangles.map(|number| {
        let corners = stage.triangles[number].corners;
        let corners = corners.map(|c| stage.drawn.positions[c as usize].as_dvec3());
        (number, barycentric(corners, ray))
    });
    let inside = |[v, w]: [f64; 2]| v.min(w).min(1.0 - v - w);
    let (number, weights) = places.max_by(|a, b| inside(a.1).total_cmp(&inside(b.1)))?;
    let triangle = sample_number(number);
    let weights = within(weights);
    Some(SurfaceHit { triangle, weights })
}

/// Weights of the second and third corner where a line meets a triangle's plane (Möller and Trumbore 1997).
fn barycentric([a, b, c]: [DVec3; 3], ray: &CameraRay) -> [f64; 2] {
    let (e1, e2, offset) = (b - a, c - a, ray.origin - a);
    let p = ray.direction.cross(e2);
    let determinant = e1.dot(p);
    if determinant == 0.0 {
        return [0.0; 2];
    }
    let v = offset.dot(p) / determinant;
    let w = ray.direction.dot(offset.cross(e1)) / determinant;
    [v, w]
}

/// Weights brought into the triangle.
#[expect(clippy::cast_possible_truncation, reason = "weights are kept in f32")]
fn within([v, w]: [f64; 2]) -> [f32; 2] {
    let (v, w) = (v.max(0.0), w.max(0.0));
    let sum = (v + w).max(1.0);
    [(v / sum) as f32, (w / sum) as f32]
}
