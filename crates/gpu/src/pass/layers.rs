//! What lets light through, from the farthest to the nearest.

use crate::hemicube::count;
use crate::pass::geometry::{Cover, Geometry};
use core::ops::Range;
use glam::Vec3;
use hemicube_scene::{Camera, Projection};

/// Triangles to be drawn one after the other.
#[derive(Debug, Default)]
pub(crate) struct Layers {
    /// The farthest first.
    pub(crate) triangles: Vec<[u32; 3]>,
    /// Neighbours of one run: its number, and their indices.
    pub(crate) ranges: Vec<(usize, Range<u32>)>,
}

impl Layers {
    /// Sorts the transparent triangles by the distance of their middles.
    pub(crate) fn new(geometry: &Geometry, camera: &Camera) -> Self {
        let mut all = Vec::new();
        for (number, run) in geometry.runs.iter().enumerate() {
            if run.cover == Cover::Transparent {
                let of_run = run.indices.start as usize / 3..run.indices.end as usize / 3;
                for triangle in &geometry.order[of_run] {
                    let corner = |i: usize| geometry.positions[triangle[i] as usize];
                    let middle = (corner(0) + corner(1) + corner(2)) / 3.0;
                    all.push((distance(camera, middle), number, *triangle));
                }
            }
        }
        // The sort is stable: of equals the first in the scene.
        all.sort_by(|a, b| b.0.total_cmp(&a.0));
        let mut layers = Self::default();
        for (_, number, triangle) in all {
            let first = count(3 * layers.triangles.len());
            layers.triangles.push(triangle);
            match layers.ranges.last_mut() {
                Some((last, range)) if *last == number => range.end += 3,
                _ => layers.ranges.push((number, first..first + 3)),
            }
        }
        layers
    }
}

fn distance(camera: &Camera, point: Vec3) -> f32 {
    let way = point - camera.eye;
    match camera.projection {
        Projection::Orthographic { .. } => way.dot(camera.forward),
        _ => way.length(),
    }
}
