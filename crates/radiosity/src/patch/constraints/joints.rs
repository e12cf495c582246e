//! Where faces meet: the segments along which other faces cross a face or stand on it.
//!
//! Light leaks where an element reaches from one side of a wall to the other, so elements are cut along these segments
//! and are afterwards wholly on one side. What lies in the plane of a face (the foot of a box, a rug) cuts it along its
//! outline.

use super::plane::{Plane, Segment, clip, nearest_on};
use crate::patch::box_tree::BoxTree;
use crate::patch::face::WorldFace;
use glam::{DVec2, DVec3, Vec3};

/// Contours smaller than this share of an element's size do not cut: three table legs of 5 cm would add more elements
/// to a floor than they make visible. [`exposure`](crate::patch::exposure) knows the share of an element that they cover.
const LEAST_CONTOUR: f64 = 0.25;
/// Segments that one face keeps at most.
const MOST_OF_FACE: usize = 2048;

/// Finds joints between the faces of a scene.
pub struct Joints<'a> {
    faces: &'a [WorldFace],
    tree: BoxTree,
    /// For each face how many of its sides receive light.
    lit_sides: Vec<usize>,
    /// Distance below which things touch.
    tolerance: f64,
    element_size: f64,
}

impl<'a> Joints<'a> {
    /// Over the faces of a scene, of which so many sides are lit.
    pub fn new(
        faces: &'a [WorldFace],
        lit_sides: Vec<usize>,
        tolerance: f64,
        element_size: f64,
    ) -> Self {
        Self {
            tree: BoxTree::new(faces.iter().map(WorldFace::polygon)),
            faces,
            lit_sides,
            tolerance,
            element_size,
        }
    }

    /// The segments along which other faces meet a face, and whether some were left out because there are too many.
    pub fn of_face(&self, face: usize) -> (Vec<Segment>, bool) {
        let target = Target::new(&self.faces[face], self.tolerance);
        let (mut segments, mut is_crowded) = (Vec::new(), false);
        #[expect(clippy::cast_possible_truncation, reason = "a length of the scene")]
        let reach = self.tolerance as f32;
        for other in self.tree.near(self.faces[face].polygon(), reach) {
            if other as usize == face {
                continue;
            }
            if segments.len() >= MOST_OF_FACE {
                is_crowded = true;
                break;
            }
            let other = self.faces[other as usize].polygon();
            if self.lit_sides[face] == 1 && target.is_behind(other) {
                continue;
            }
            target.meet(other, &mut segments);
        }
        let segments = without_small_contours(
            segments,
            LEAST_CONTOUR * self.element_size,
            4.0 * self.tolerance,
        );
        (segments, is_crowded)
    }
}

/// A face that others meet.
pub struct Target {
    plane: Plane,
    polygon: Vec<DVec2>,
    tolerance: f64,
}

impl Target {
    /// Things touch it within a tolerance.
    pub fn new(face: &WorldFace, tolerance: f64) -> Self {
        let plane = Plane::new(face.corners[0], face.normal);
        Self {
            polygon: plane.flat_polygon(face.polygon()),
            plane,
            tolerance,
        }
    }

    /// Whether a polygon only touches the face from behind.
    fn is_behind(&self, other: &[Vec3]) -> bool {
        let mut heights = other.iter().map(|p| self.plane.height(p.as_dvec3()));
        let lies_in_plane = heights.clone().all(|h| h.abs() <= self.tolerance);
        !lies_in_plane && heights.all(|h| h <= self.tolerance)
    }

    /// Adds the segments along which a convex polygon meets the face, without those along the face's own edges.
    pub fn meet(&self, other: &[Vec3], segments: &mut Vec<Segment>) {
        let corners: Vec<DVec3> = other.iter().map(|p| p.as_dvec3()).collect();
        self.meet_corners(&corners, segments);
    }

    /// As [`Self::meet`].
    pub fn meet_corners(&self, corners: &[DVec3], segments: &mut Vec<Segment>) {
        let heights: Vec<f64> = corners.iter().map(|&p| self.snapped_height(p)).collect();
        if heights.iter().all(|&h| h == 0.0) {
            for i in 0..corners.len() {
                self.keep([corners[i], corners[(i + 1) % corners.len()]], segments);
            }
        } else if let Some(segment) = section(corners, &heights) {
            self.keep(segment, segments);
        }
    }

    /// Height of a point over the plane, 0 within the tolerance.
    fn snapped_height(&self, point: DVec3) -> f64 {
        let height = self.plane.height(point);
        if height.abs() <= self.tolerance {
            0.0
        } else {
            height
        }
    }

    /// Keeps the part of a segment that is inside the face.
    fn keep(&self, segment: Segment, segments: &mut Vec<Segment>) {
        let Some(inside) = clip(self.plane.flat_segment(segment), &self.polygon) else {
            return;
        };
        let [a, b] = inside.ends;
        if a.distance(b) > 4.0 * self.tolerance && !self.is_along_an_edge([a, b]) {
            segments.push([a, b].map(|p| self.plane.lifted(p)));
        }
    }

    fn is_along_an_edge(&self, ends: [DVec2; 2]) -> bool {
        let n = self.polygon.len();
        (0..n).any(|i| {
            let edge = [self.polygon[i], self.polygon[(i + 1) % n]];
            ends.iter()
                .all(|&p| nearest_on(p, edge).1 <= self.tolerance)
        })
    }
}

/// The segment in which a convex polygon crosses a plane or touches it with an edge, from the heights of its corners;
/// none if it stays off the plane or touches it with a corner.
fn section(corners: &[DVec3], heights: &[f64]) -> Option<Segment> {
    let mut ends: Vec<DVec3> = Vec::with_capacity(2);
    for i in 0..corners.len() {
        let next = (i + 1) % corners.len();
        let (h0, h1) = (heights[i], heights[next]);
        if h0 == 0.0 {
            ends.push(corners[i]);
        } else if h0 * h1 < 0.0 {
            ends.push(corners[i].lerp(corners[next], h0 / (h0 - h1)));
        }
    }
    match *ends {
        [a, b] => Some([a, b]),
        _ => None,
    }
}

/// The segments without those whose contour, that is what hangs together by its ends, is smaller than some size.
fn without_small_contours(segments: Vec<Segment>, least: f64, tolerance: f64) -> Vec<Segment> {
    let mut contour: Vec<usize> = (0..segments.len()).collect();
    fn root(contour: &mut [usize], mut i: usize) -> usize {
        while contour[i] != i {
            contour[i] = contour[contour[i]];
            i = contour[i];
        }
        i
    }
    let places: Vec<[Vec3; 2]> = segments.iter().map(|s| s.map(|p| p.as_vec3())).collect();
    let tree = BoxTree::new(places.iter().map(|ends| &ends[..]));
    #[expect(clippy::cast_possible_truncation, reason = "a length of the scene")]
    let reach = 2.0 * tolerance as f32;
    for (i, ends) in places.iter().enumerate() {
        for end in ends {
            let near = tree.near(core::slice::from_ref(end), reach).into_iter();
            for j in near.map(|j| j as usize).take_while(|&j| j < i) {
                if are_joined(segments[i], segments[j], tolerance) {
                    let (a, b) = (root(&mut contour, i), root(&mut contour, j));
                    contour[a.max(b)] = a.min(b);
                }
            }
        }
    }
    let of: Vec<usize> = (0..segments.len()).map(|i| root(&mut contour, i)).collect();
    let mut boxes = vec![(DVec3::INFINITY, DVec3::NEG_INFINITY); segments.len()];
    for (segment, &contour) in segments.iter().zip(&of) {
        let (low, high) = &mut boxes[contour];
        for end in segment {
            (*low, *high) = (low.min(*end), high.max(*end));
        }
    }
    let is_large = |contour: usize| boxes[contour].0.distance(boxes[contour].1) >= least;
    let kept = segments.into_iter().zip(of);
    kept.filter(|&(_, contour)| is_large(contour))
        .map(|(segment, _)| segment)
        .collect()
}

fn are_joined(a: Segment, b: Segment, tolerance: f64) -> bool {
    a.iter().any(|p| {
        b.iter()
            .any(|q| p.distance_squared(*q) <= tolerance * tolerance)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn floor() -> Target {
        let corners = [
            Vec3::ZERO,
            Vec3::Z * 4.0,
            Vec3::new(4.0, 0.0, 4.0),
            Vec3::X * 4.0,
        ];
        let face = WorldFace {
            corners,
            mesh_corners: [0; 4],
            corner_count: 4,
            normal: Vec3::Y,
            instance: 0,
            face: 0,
            material: 0,
        };
        Target::new(&face, 1e-5)
    }

    fn met(polygon: &[Vec3]) -> Vec<Segment> {
        let mut segments = Vec::new();
        floor().meet(polygon, &mut segments);
        segments
    }

    fn assert_between(segments: &[Segment], a: Vec3, b: Vec3) {
        let [[p, q]] = segments else {
            panic!("one segment, not {segments:?}")
        };
        let (a, b) = (a.as_dvec3(), b.as_dvec3());
        let off = (p.distance(a) + q.distance(b)).min(p.distance(b) + q.distance(a));
        assert!(off < 1e-9, "{segments:?} is {off} off");
    }

    #[test]
    fn a_wall_through_the_floor_meets_it_up_to_the_floors_edge() {
        let wall = [
            Vec3::new(1.0, -1.0, 1.0),
            Vec3::new(6.0, -1.0, 1.0),
            Vec3::new(6.0, 2.0, 1.0),
            Vec3::new(1.0, 2.0, 1.0),
        ];
        assert_between(
            &met(&wall),
            Vec3::new(1.0, 0.0, 1.0),
            Vec3::new(4.0, 0.0, 1.0),
        );
    }

    #[test]
    fn a_wall_on_the_floor_meets_it_along_its_foot() {
        let (a, b) = (Vec3::new(1.0, 0.0, 1.0), Vec3::new(2.0, 0.0, 3.0));
        assert_between(&met(&[a, b, b + Vec3::Y, a + Vec3::Y]), a, b);
        assert!(
            floor().is_behind(&[a, b, b - Vec3::Y]),
            "one below it touches from behind"
        );
    }

    #[test]
    fn corners_and_common_edges_do_not_count() {
        let corner = Vec3::new(1.0, 0.0, 1.0);
        let tip = [
            corner,
            corner + Vec3::new(-0.5, 1.0, 0.0),
            corner + Vec3::new(0.5, 1.0, 0.0),
        ];
        assert!(met(&tip).is_empty(), "a tip on the floor");
        let wall = [
            Vec3::ZERO,
            Vec3::X * 4.0,
            Vec3::new(4.0, 3.0, 0.0),
            Vec3::Y * 3.0,
        ];
        assert!(met(&wall).is_empty(), "a wall along the floor's edge");
    }

    #[test]
    fn what_lies_in_the_plane_cuts_along_its_outline() {
        let at = |x: f32, z: f32| Vec3::new(x, 0.0, z);
        let rug = [at(3.0, 1.0), at(3.0, 2.0), at(5.0, 2.0), at(5.0, 1.0)];
        assert_eq!(met(&rug).len(), 3, "one of its edges is beyond the floor");
    }

    #[test]
    fn small_contours_do_not_cut() {
        let side = |a: DVec3, b: DVec3| [a, b];
        let square = |s: f64| {
            let p = [DVec3::ZERO, DVec3::X, DVec3::new(1.0, 0.0, 1.0), DVec3::Z].map(|p| p * s);
            (0..4)
                .map(|i| side(p[i], p[(i + 1) % 4]))
                .collect::<Vec<_>>()
        };
        let both = [
            square(0.1),
            square(0.9)
                .iter()
                .map(|s| s.map(|p| p + DVec3::X * 3.0))
                .collect(),
        ];
        let kept = without_small_contours(both.concat(), 0.5, 1e-6);
        assert_eq!(kept.len(), 4, "the larger square: {kept:?}");
        assert!(kept.iter().all(|s| s[0].x >= 3.0), "{kept:?}");
    }
}
