//! Wedges of lamps and occluders, and the lines in which they meet faces.

use super::lights::Lamp;
use super::outlines::Outlines;
use super::{MOST_LINES, sight};
use crate::patch::PatchMesh;
use crate::patch::box_tree::BoxTree;
use crate::patch::constraints::joints::Target;
use crate::patch::constraints::plane::{Line, Segment, nearest_in_space};
use crate::patch::face::WorldFace;
use crate::patch::sizes::Sizes;
use glam::{DVec3, Vec3};

/// Edges of occluders shorter than this share of an element cast no lines.
const LEAST_EDGE: f64 = 0.25;
/// Where penumbrae are wider than so many elements, their borders are not worth cutting.
const MOST_ELEMENTS: f64 = 4.0;
/// Lines this share of an element apart are one, and shorter ones none.
const SAME: f64 = 0.02;

/// What spans a wedge.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Wedge {
    /// A lamp's corner and an occluder's edge.
    VertexEdge(DVec3, [DVec3; 2]),
    /// A lamp's edge and an occluder's corner.
    EdgeVertex([DVec3; 2], DVec3),
}

impl Wedge {
    /// Its part from the occluder on, so far that it leaves the scene.
    fn polygon(&self, reach: f64) -> Vec<DVec3> {
        let beyond =
            |from: DVec3, through: DVec3| through + (through - from).normalize_or_zero() * reach;
        match *self {
            Self::VertexEdge(lamp, [a, b]) => vec![a, b, beyond(lamp, b), beyond(lamp, a)],
            Self::EdgeVertex([a, b], corner) => vec![corner, beyond(a, corner), beyond(b, corner)],
        }
    }

    /// Whether what spans it lies in a line.
    fn is_flat(&self) -> bool {
        let (apex, [a, b]) = match *self {
            Self::VertexEdge(lamp, edge) => (lamp, edge),
            Self::EdgeVertex(edge, corner) => (corner, edge),
        };
        let (a, b) = (a - apex, b - apex);
        a.cross(b).length() <= 1e-6 * a.length() * b.length()
    }
}

/// Casts the lines of shadows.
pub struct Caster<'a> {
    pub(super) mesh: &'a PatchMesh,
    outlines: &'a Outlines<'a>,
    /// Faces that are large enough to be cut.
    receivers: Vec<usize>,
    tree: BoxTree,
    pub(super) element_size: f64,
    tolerance: f64,
}

impl<'a> Caster<'a> {
    pub fn new(mesh: &'a PatchMesh, outlines: &'a Outlines<'a>, sizes: Sizes) -> Self {
        let is_receiver = |&face: &usize| {
            let sides = mesh.roots[face].iter().flatten().count();
            sides > 0 && mesh.is_large(face, sizes)
        };
        let receivers: Vec<usize> = (0..mesh.faces.len()).filter(is_receiver).collect();
        Self {
            tree: BoxTree::new(receivers.iter().map(|&face| mesh.faces[face].polygon())),
            receivers,
            outlines,
            element_size: f64::from(sizes.element),
            tolerance: mesh.tolerance(),
            mesh,
        }
    }

    /// The wedges of a lamp with the outlines in front of it.
    pub fn wedges(&self, lamp: &Lamp) -> Vec<Wedge> {
        let outlines = self.outlines;
        let least = LEAST_EDGE * self.element_size;
        let is_long = |[a, b]: [DVec3; 2]| a.distance(b) >= least;
        let in_front = |ends: [DVec3; 2]| ends.iter().any(|&p| lamp.faces(p));
        let edges = outlines.edges.iter().filter(|edge| {
            let ends = outlines.ends(edge);
            is_long(ends) && in_front(ends)
        });
        let mut wedges = Vec::new();
        let mut is_on_outline = vec![false; outlines.points.len()];
        for edge in edges {
            for &corner in &lamp.corners {
                if outlines.is_outline(edge, corner) {
                    edge.ends
                        .iter()
                        .for_each(|&end| is_on_outline[end as usize] = true);
                    wedges.push(Wedge::VertexEdge(corner, outlines.ends(edge)));
                }
            }
        }
        for (&point, _) in outlines
            .points
            .iter()
            .zip(is_on_outline)
            .filter(|(_, is)| *is)
        {
            if lamp.faces(point) {
                wedges.extend(
                    lamp.edges
                        .iter()
                        .map(|&edge| Wedge::EdgeVertex(edge, point)),
                );
            }
        }
        wedges.retain(|wedge| !wedge.is_flat());
        wedges
    }

    /// The lines that a wedge casts on faces, as far as they are seen from the lamp.
    pub fn lines(&self, lamp: &Lamp, wedge: &Wedge) -> Vec<(usize, Segment)> {
        let polygon = wedge.polygon(2.0 * f64::from(self.mesh.visibility.diameter()));
        let corners: Vec<Vec3> = polygon.iter().map(|p| p.as_vec3()).collect();
        #[expect(clippy::cast_possible_truncation, reason = "a length of the scene")]
        let near = self.tree.near(&corners, self.tolerance as f32);
        let mut lines = Vec::new();
        for receiver in near {
            let face = self.receivers[receiver as usize];
            if !self.is_lit_from(face, lamp) {
                continue;
            }
            let mut segments = Vec::new();
            Target::new(&self.mesh.faces[face], self.tolerance)
                .meet_corners(&polygon, &mut segments);
            for segment in segments {
                let seen = sight::seen_parts(self, lamp, wedge, face, segment);
                lines.extend(seen.into_iter().map(|line| (face, line)));
            }
        }
        lines
    }

    fn is_lit_from(&self, face: usize, lamp: &Lamp) -> bool {
        let is_two_sided = self.mesh.roots[face][1].is_some();
        let face: &WorldFace = &self.mesh.faces[face];
        let height = |p: DVec3| (p - face.corners[0].as_dvec3()).dot(face.normal.as_dvec3());
        is_two_sided || lamp.corners.iter().any(|&p| height(p) > self.tolerance)
    }

    /// Whether a penumbra at a point is so narrow that its border is worth cutting along.
    pub(super) fn is_narrow(&self, lamp: &Lamp, wedge: &Wedge, point: DVec3) -> bool {
        let (from_lamp, occluder) = match *wedge {
            Wedge::VertexEdge(corner, edge) => {
                let (t, _) = nearest_in_space(point, edge);
                let occluder = edge[0].lerp(edge[1], t);
                (corner.distance(occluder), occluder)
            }
            Wedge::EdgeVertex([a, b], corner) => (a.midpoint(b).distance(corner), corner),
        };
        let width = lamp.size() * point.distance(occluder) / from_lamp.max(1e-300);
        width <= MOST_ELEMENTS * self.element_size
    }

    /// Keeps a line unless it is too short, there is one like it, or there are too many.
    pub fn keep(&self, kept: &mut Vec<Line>, line: Line) {
        let same = SAME * self.element_size;
        let [a, b] = line.ends;
        let is_like = |other: &Line| {
            [a, b]
                .iter()
                .all(|&p| nearest_in_space(p, other.ends).1 <= same)
        };
        if a.distance(b) > same && kept.len() < MOST_LINES && !kept.iter().any(is_like) {
            kept.push(line);
        }
    }
}
