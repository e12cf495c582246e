//! What part of a texture a sample sees.

use crate::lens::CameraRay;
use crate::sight::SurfaceHit;
use crate::stage::Stage;
use crate::surface::corners;
use glam::{DVec3, Vec2};
use hemicube_scene::TextureSlot;

/// How a point's barycentric weights change to the next sample to the right and to the one below.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Footprint {
    steps: [[f32; 2]; 2],
}

impl Footprint {
    /// The footprint of a ray at its hit, exact to first order: the ray's differentials are carried to the triangle's
    /// plane (Igehy 1999, equations 10 to 12). `spacing` is the distance of samples in pixels. A ray along the plane has
    /// an infinite one, which samplers bound.
    pub fn new(stage: &Stage<'_>, hit: &SurfaceHit, ray: &CameraRay, spacing: f64) -> Self {
        let [a, b, c] = corners(stage.triangle(hit)).map(|c| stage.drawn.positions[c].as_dvec3());
        let (e1, e2) = (b - a, c - a);
        let normal = e1.cross(e2);
        let [v, w] = hit.weights.map(f64::from);
        let offset = a + e1 * v + e2 * w - ray.origin;
        let distance = offset.dot(ray.direction) / ray.direction.length_squared();
        let slope = ray.direction.dot(normal);
        let square = normal.length_squared();
        let step = |k: usize| {
            let beside = (ray.origin_steps[k] + ray.direction_steps[k] * distance) * spacing;
            let on_plane = beside - ray.direction * (beside.dot(normal) / slope);
            let weight = |area: DVec3| narrow(area.dot(normal) / square);
            [weight(on_plane.cross(e2)), weight(e1.cross(on_plane))]
        };
        Self {
            steps: [step(0), step(1)],
        }
    }

    /// How the coordinates of a texture change to the next sample to the right and to the one below.
    pub fn of_texture(&self, stage: &Stage<'_>, hit: &SurfaceHit, slot: TextureSlot) -> [Vec2; 2] {
        if slot.texcoord_set > 1 {
            return [Vec2::ZERO; 2];
        }
        let [a, b, c] =
            corners(stage.triangle(hit)).map(|c| stage.drawn.texcoords[c][slot.texcoord_set]);
        self.steps
            .map(|[v, w]| slot.transform.matrix2 * ((b - a) * v + (c - a) * w))
    }
}

#[expect(
    clippy::cast_possible_truncation,
    reason = "footprints are kept in f32"
)]
fn narrow(x: f64) -> f32 {
    x as f32
}
