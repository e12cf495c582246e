//! Edges of the mesh over a picture: which surface a sample sees decides whether it lies on a line, so lines are hidden
//! where surfaces are, bend with the projection, and are as smooth as the picture.

use crate::lens::{CameraRay, Lens};
use crate::options::MeshOverlay;
use crate::sight::SurfaceHit;
use crate::stage::Stage;
use crate::surface::place;
use glam::{DVec2, DVec3};
use hemicube_radiosity::NodeId;
use hemicube_raster::Rgb;

/// Half the width of a line in pixels, in pictures of up to so many rows; beyond, lines grow with the picture.
const HALF_WIDTH: f64 = 0.55;
const ROWS: f64 = 1000.0;

/// Cells fade out where they are narrower than this many half widths.
const FADING: f64 = 8.0;

/// Brightest band from which on lines are darker than what they lie on; below it they are lighter.
const MIDDLE: f32 = 0.06;

/// Edges of elements or patches.
#[derive(Debug)]
pub(crate) struct MeshLines<'a> {
    stage: &'a Stage<'a>,
    lens: Lens,
    overlay: MeshOverlay,
    half_width: f64,
    /// Distance of samples in pixels.
    spacing: f64,
}

impl<'a> MeshLines<'a> {
    /// Over a picture of so many rows.
    pub fn new(
        stage: &'a Stage<'a>,
        lens: Lens,
        overlay: MeshOverlay,
        rows: usize,
        spacing: f64,
    ) -> Self {
        Self {
            stage,
            lens,
            overlay,
            half_width: HALF_WIDTH * (rows as f64 / ROWS).max(1.0),
            spacing,
        }
    }

    /// A displayed colour with the lines that a sample at a place, in pixels, sees on a surface.
    pub fn over(&self, color: Rgb, hit: &SurfaceHit, at: DVec2) -> Rgb {
        let share = self.share(hit, at).unwrap_or(0.0);
        if share <= 0.0 {
            return color;
        }
        let line = if color.max_band() > MIDDLE {
            color * 0.1
        } else {
            color.lerp(Rgb::WHITE, 0.35)
        };
        color.lerp(line, share)
    }

    /// How much of a sample is line.
    fn share(&self, hit: &SurfaceHit, at: DVec2) -> Option<f32> {
        if !hit.exists() {
            return None;
        }
        let steps = self.steps(hit, &self.lens.ray(at)?);
        let mesh = self.stage.solution.mesh();
        let id = self.cell(hit);
        let normal = mesh.node(id).normal.as_dvec3();
        let point = place(self.stage, hit).0.as_dvec3();
        let centre = mesh.node(id).centroid.as_dvec3();
        let polygon = mesh.polygon(id);
        let (mut nearest, mut radius) = (f64::INFINITY, f64::INFINITY);
        for i in 0..polygon.len() {
            let (a, b) = (
                polygon[i].as_dvec3(),
                polygon[(i + 1) % polygon.len()].as_dvec3(),
            );
            let inward = normal.cross(b - a).normalize_or_zero();
            let per_pixel = DVec2::new(inward.dot(steps[0]), inward.dot(steps[1])).length();
            // A surface seen along itself has no pixels.
            let pixels = |p: DVec3| inward.dot(p - a).abs() / per_pixel.max(f64::MIN_POSITIVE);
            nearest = nearest.min(pixels(point));
            radius = radius.min(pixels(centre));
        }
        let cover = ((self.half_width - nearest) / self.spacing + 0.5).clamp(0.0, 1.0);
        let fading = (radius / (FADING * self.half_width)).clamp(0.0, 1.0);
        Some(narrow(cover * fading))
    }

    /// The element or patch that a sample sees.
    fn cell(&self, hit: &SurfaceHit) -> NodeId {
        let mesh = self.stage.solution.mesh();
        let element = self.stage.triangle(hit).element as usize;
        match self.overlay {
            MeshOverlay::Elements => mesh.elements()[element],
            MeshOverlay::Patches => mesh.patches()[mesh.patch_of_element(element)],
        }
    }

    /// How the point that is seen moves on its plane from pixel to pixel (Igehy 1999).
    fn steps(&self, hit: &SurfaceHit, ray: &CameraRay) -> [DVec3; 2] {
        let normal = self
            .stage
            .solution
            .mesh()
            .node(self.cell(hit))
            .normal
            .as_dvec3();
        let offset = place(self.stage, hit).0.as_dvec3() - ray.origin;
        let distance = offset.dot(ray.direction) / ray.direction.length_squared();
        let slope = ray.direction.dot(normal);
        [0, 1].map(|k| {
            let beside = ray.origin_steps[k] + ray.direction_steps[k] * distance;
            beside - ray.direction * (beside.dot(normal) / slope)
        })
    }
}

#[expect(clippy::cast_possible_truncation, reason = "a share is kept in f32")]
fn narrow(x: f64) -> f32 {
    x as f32
}
