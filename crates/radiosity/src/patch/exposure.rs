//! Which parts of an element are out in the open.
//!
//! Furniture stands on floors, pillars run through ceilings: an element that is partly inside a solid would average
//! its light over a part that nobody sees, and a dark rim would follow every contact. So irradiance and radiosity are
//! means over the exposed part. A point is buried if every probing ray from it meets the absorbing back of a face.

use crate::patch::face::Side;
use crate::patch::{PatchMesh, Polygon};
use crate::sampling::{cosine_direction, point_in_polygon, point2, polygon_point};
use crate::stop::Stop;
use crate::visibility::Visibility;
use glam::Vec3;
use rayon::prelude::*;

/// Points that are probed on each element, as many as a mask has bits.
const POINTS: u32 = 16;
/// Rays of which all must meet backs. The first goes along the normal and decides nearly always; as many as this it
/// takes to tell the inside of a solid from the floor under a one-sided roof.
const RAYS: u32 = 70;

/// Which of an element's probed points are exposed, as a bit mask.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ExposedPoints(u16);

impl ExposedPoints {
    const ALL: Self = Self(u16::MAX);

    /// Exposed share of the area, to a sixteenth.
    pub fn share(self) -> f32 {
        self.0.count_ones() as f32 / POINTS as f32
    }
}

/// The exposed part of an element, to take points from.
#[derive(Debug, Clone, Copy)]
pub struct ExposedArea {
    polygon: Polygon,
    area: f32,
    points: ExposedPoints,
}

impl ExposedArea {
    pub(super) fn new(polygon: Polygon, area: f32, points: ExposedPoints) -> Self {
        Self {
            polygon,
            area,
            points,
        }
    }

    /// The whole element.
    pub fn polygon(&self) -> &[Vec3] {
        &self.polygon
    }

    /// Area of the whole element.
    pub fn whole_area(&self) -> f32 {
        self.area
    }

    /// Area of the exposed part.
    pub fn area(&self) -> f32 {
        self.area * self.points.share()
    }

    /// A point of the exposed part for one of the unit square: uniform where all is exposed, else one of the probed
    /// points.
    pub fn point(&self, sample: [f32; 2]) -> Vec3 {
        let count = self.points.0.count_ones();
        if count == POINTS || count == 0 {
            return polygon_point(&self.polygon, sample);
        }
        let wanted = nth(sample[0], count);
        let bit = (0..POINTS)
            .filter(|bit| self.points.0 >> bit & 1 == 1)
            .nth(wanted as usize);
        point_in_polygon(&self.polygon, bit.unwrap_or(0), 0)
    }
}

/// One of `count` for a number in [0, 1).
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "between 0 and 15"
)]
fn nth(sample: f32, count: u32) -> u32 {
    ((sample * count as f32) as u32).min(count - 1)
}

/// Probes all elements of a mesh; none if it was stopped.
pub(super) fn of_elements(mesh: &PatchMesh, stop: Stop<'_>) -> Option<Vec<ExposedPoints>> {
    mesh.elements()
        .par_iter()
        .map(|&id| {
            if stop() {
                return None;
            }
            let (polygon, normal) = (mesh.polygon(id), mesh.node(id).normal);
            let exposed = |bit: u32| {
                !is_buried(
                    mesh.visibility(),
                    point_in_polygon(&polygon, bit, 0),
                    normal,
                )
            };
            // Nearly all elements are exposed all over, which a few points tell.
            let first = (0..4).filter(|&bit| exposed(bit)).count();
            let corners = polygon.iter().filter(|&&c| {
                !is_buried(mesh.visibility(), c.lerp(centre(&polygon), 0.05), normal)
            });
            if first == 4 && corners.count() == polygon.len() {
                return Some(ExposedPoints::ALL);
            }
            Some(ExposedPoints(
                (0..POINTS)
                    .filter(|&bit| exposed(bit))
                    .fold(0, |mask, bit| mask | 1 << bit),
            ))
        })
        .collect()
}

fn centre(polygon: &[Vec3]) -> Vec3 {
    polygon.iter().sum::<Vec3>() / polygon.len() as f32
}

fn is_buried(visibility: &Visibility, point: Vec3, normal: Vec3) -> bool {
    let origin = visibility.off_surface(point, normal);
    (0..RAYS).all(|i| {
        let direction = if i == 0 {
            normal
        } else {
            cosine_direction(normal, point2(i, 1))
        };
        let hit = visibility.first_hit(origin, direction, f32::INFINITY);
        // Fronts of obstructions do not receive, but no solid begins behind the viewer there.
        hit.is_some_and(|hit| hit.side == Side::Back && !visibility.receives(hit.face, hit.side))
    })
}
