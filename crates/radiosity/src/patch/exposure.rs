//! Which parts of an element are out in the open.
//!
//! Furniture stands on floors, pillars run through ceilings: an element that is partly inside a solid would average
//! its light over a part that nobody sees, and a dark rim would follow every contact. So irradiance and radiosity are
//! means over the exposed part. A point is buried if every probing ray from it meets the absorbing back of a face.

use crate::patch::clean::stack::{LIFT, MOST_LAYERS, MOST_TILT};
use crate::patch::face::Side;
use crate::patch::{NodeId, PatchMesh, Polygon};
use crate::sampling::{cosine_direction, point_in_polygon, point2, polygon_point};
use crate::stop::Stop;
use crate::visibility::{Hit, Visibility};
use glam::Vec3;
use rayon::prelude::*;

/// Points of which each element remembers whether they are exposed, as many as a mask has bits.
const POINTS: u32 = 16;
/// Points that tell that an element is exposed all over: of meshes of few elements, which are large, more.
const FIRST_POINTS: u32 = 4;
const FIRST_POINTS_OF_FEW: u32 = 64;
const FEW_ELEMENTS: usize = 1000;
/// Points that measure the exposed areas of all elements that are partly buried, least and most of one.
const MEASURING_POINTS: usize = 1 << 14;
const LEAST_MEASURING_POINTS: usize = 64;
const MOST_MEASURING_POINTS: usize = 1 << 11;
/// Rays of which all must meet backs. The first goes along the normal and decides nearly always; as many as this it
/// takes to tell the inside of a solid from the floor under a one-sided roof.
const RAYS: u32 = 70;

/// Which of an element's probed points are exposed, as a bit mask.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ExposedPoints(u16);

impl ExposedPoints {
    const ALL: Self = Self(u16::MAX);
}

/// What is known of an element's exposure.
#[derive(Debug, Clone, Copy)]
pub(super) struct Exposure {
    /// Some of its points.
    pub(super) points: ExposedPoints,
    /// Share of the area.
    pub(super) share: f32,
}

/// The exposed part of an element, to take points from.
#[derive(Debug, Clone, Copy)]
pub struct ExposedArea {
    polygon: Polygon,
    whole_area: f32,
    area: f32,
    points: ExposedPoints,
}

impl ExposedArea {
    pub(super) fn new(polygon: Polygon, whole_area: f32, area: f32, points: ExposedPoints) -> Self {
        Self {
            polygon,
            whole_area,
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
        self.whole_area
    }

    /// Area of the exposed part.
    pub fn area(&self) -> f32 {
        self.area
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

/// The exposed parts of a patch's elements, to take points from, each by its area.
#[derive(Debug)]
pub struct ExposedParts {
    /// With running sums of the areas.
    parts: Vec<(f32, ExposedArea)>,
}

impl ExposedParts {
    /// Of a patch of which something is buried; `None` if all of it is exposed, or nothing, and for other nodes.
    pub fn of(mesh: &PatchMesh, id: NodeId) -> Option<Self> {
        let elements = mesh.elements_of_patch(mesh.patch_of_node(id)?);
        let is_whole = |e: usize| mesh.exposed_area(e) == mesh.node(mesh.elements()[e]).area;
        if elements.clone().all(is_whole) {
            return None;
        }
        let mut sum = 0.0;
        let exposed = elements
            .map(|e| mesh.exposed(e))
            .filter(|part| part.area() > 0.0);
        let parts: Vec<(f32, ExposedArea)> = exposed
            .map(|part| {
                sum += part.area();
                (sum, part)
            })
            .collect();
        (!parts.is_empty()).then_some(Self { parts })
    }

    /// The part at a share of the area, and how much of that part lies before it, in [0, 1).
    pub fn at(&self, share: f32) -> (&ExposedArea, f32) {
        let last = self.parts.len() - 1;
        let wanted = share * self.parts[last].0;
        let i = self
            .parts
            .partition_point(|&(sum, _)| sum <= wanted)
            .min(last);
        let start = if i == 0 { 0.0 } else { self.parts[i - 1].0 };
        let (end, part) = &self.parts[i];
        let within = (wanted - start) / (end - start).max(1e-30);
        (part, within.clamp(0.0, 0.999_999))
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
pub(super) fn of_elements(mesh: &PatchMesh, stop: Stop<'_>) -> Option<Vec<Exposure>> {
    let first_points = if mesh.elements().len() <= FEW_ELEMENTS {
        FIRST_POINTS_OF_FEW
    } else {
        FIRST_POINTS
    };
    let elements = mesh.elements().par_iter();
    let points: Option<Vec<Option<ExposedPoints>>> = elements
        .map(|&id| (!stop()).then(|| partial(mesh, id, first_points)))
        .collect();
    let points = points?;
    let partial = points.iter().filter(|points| points.is_some()).count();
    let measuring =
        (MEASURING_POINTS / partial.max(1)).clamp(LEAST_MEASURING_POINTS, MOST_MEASURING_POINTS);
    let measuring = crate::index32(measuring);
    let elements = mesh.elements().par_iter().zip(points);
    elements
        .map(|(&id, points)| {
            (!stop()).then(|| match points {
                None => Exposure {
                    points: ExposedPoints::ALL,
                    share: 1.0,
                },
                Some(points) => Exposure {
                    points,
                    share: share(mesh, id, points, measuring),
                },
            })
        })
        .collect()
}

/// The exposed points of an element; none if it seems to be exposed all over.
fn partial(mesh: &PatchMesh, id: NodeId, first_points: u32) -> Option<ExposedPoints> {
    let (polygon, normal) = (mesh.polygon(id), mesh.node(id).normal);
    let is_exposed = |point: Vec3| !is_buried(mesh.visibility(), point, normal);
    let probed = |point: u32| is_exposed(point_in_polygon(&polygon, point, 0));
    let mut corners = polygon.iter();
    if (0..first_points).all(probed) && corners.all(|&c| is_exposed(c.lerp(centre(&polygon), 0.05)))
    {
        return None;
    }
    let exposed = (0..POINTS).filter(|&bit| probed(bit));
    Some(ExposedPoints(exposed.fold(0, |mask, bit| mask | 1 << bit)))
}

/// The exposed share of an element's area; 0 where no exposed point is known.
fn share(mesh: &PatchMesh, id: NodeId, points: ExposedPoints, count: u32) -> f32 {
    if points.0 == 0 {
        return 0.0;
    }
    let (polygon, normal) = (mesh.polygon(id), mesh.node(id).normal);
    let is_exposed = |&point: &u32| {
        !is_buried(
            mesh.visibility(),
            point_in_polygon(&polygon, point, 0),
            normal,
        )
    };
    (0..count).filter(is_exposed).count() as f32 / count as f32
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
        hit.is_some_and(|hit| {
            (hit.side == Side::Back && !visibility.receives(hit.face, hit.side))
                || lies_upon(visibility, &hit, point, normal)
        })
    })
}

/// Whether what was hit is a layer upon the surface (see [`stack`](super::clean::stack)) that lets no light through.
fn lies_upon(visibility: &Visibility, hit: &Hit, point: Vec3, normal: Vec3) -> bool {
    let height = (hit.point - point).dot(normal);
    height < (MOST_LAYERS as f32 + 0.5) * LIFT * visibility.largest_offset()
        && visibility.normal(hit.face).cross(normal).length() < MOST_TILT
        && visibility.transmittance_at(hit.face, hit.point).is_black()
}
