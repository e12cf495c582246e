//! Coordinates in the plane of a face, and segments clipped to convex polygons there.

use glam::{DVec2, DVec3, Vec3};

/// A segment in space.
pub type Segment = [DVec3; 2];

/// A line along which cells of a face are cut.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Line {
    /// Its ends.
    pub ends: Segment,
    /// Whether light itself may jump there, not only its slope.
    pub jumps: bool,
}

/// An orthonormal frame in a plane: what is counter-clockwise around the normal is so in the plane.
#[derive(Debug, Clone, Copy)]
pub struct Plane {
    origin: DVec3,
    u: DVec3,
    v: DVec3,
    normal: DVec3,
}

impl Plane {
    /// Through a point, across a unit normal.
    pub fn new(origin: Vec3, normal: Vec3) -> Self {
        let normal = normal.as_dvec3().normalize_or(DVec3::Z);
        let u = normal.any_orthonormal_vector();
        Self {
            origin: origin.as_dvec3(),
            u,
            v: normal.cross(u),
            normal,
        }
    }

    /// The foot of the perpendicular from a point.
    pub fn flat(&self, point: DVec3) -> DVec2 {
        let offset = point - self.origin;
        DVec2::new(offset.dot(self.u), offset.dot(self.v))
    }

    /// A point of the plane in space.
    pub fn lifted(&self, point: DVec2) -> DVec3 {
        self.origin + self.u * point.x + self.v * point.y
    }

    /// Signed distance of a point from the plane, positive on the side of the normal.
    pub fn height(&self, point: DVec3) -> f64 {
        (point - self.origin).dot(self.normal)
    }

    /// The feet of a polygon's corners.
    pub fn flat_polygon(&self, polygon: &[Vec3]) -> Vec<DVec2> {
        polygon.iter().map(|p| self.flat(p.as_dvec3())).collect()
    }

    /// The feet of a segment's ends.
    pub fn flat_segment(&self, segment: Segment) -> [DVec2; 2] {
        segment.map(|p| self.flat(p))
    }
}

/// The part of a segment inside a convex polygon.
#[derive(Debug, Clone, Copy)]
pub struct Inside {
    /// Its ends, in the direction of the segment.
    pub ends: [DVec2; 2],
    /// Number of the polygon's edge that cut the segment there; none where the segment itself ends inside.
    pub edges: [Option<usize>; 2],
}

/// Clips a segment to a convex counter-clockwise polygon (Cyrus, Beck 1978). `None` if nothing of it is inside; what
/// only runs along an edge is outside.
pub fn clip([from, to]: [DVec2; 2], polygon: &[DVec2]) -> Option<Inside> {
    let (mut enter, mut leave) = ((0.0, None), (1.0, None));
    for (i, &a) in polygon.iter().enumerate() {
        let edge = polygon[(i + 1) % polygon.len()] - a;
        if edge == DVec2::ZERO {
            continue;
        }
        let (h0, h1) = (edge.perp_dot(from - a), edge.perp_dot(to - a));
        if h0 <= 0.0 && h1 <= 0.0 {
            return None;
        }
        let t = h0 / (h0 - h1);
        if h0 < 0.0 && t > enter.0 {
            enter = (t, Some(i));
        } else if h1 < 0.0 && t < leave.0 {
            leave = (t, Some(i));
        }
    }
    (enter.0 < leave.0).then(|| Inside {
        ends: [enter, leave].map(|(t, _)| from.lerp(to, t)),
        edges: [enter.1, leave.1],
    })
}

/// Where along a segment the foot of the perpendicular from a point lies, from 0 to 1, and its distance from the point.
pub fn nearest_on(point: DVec2, [a, b]: [DVec2; 2]) -> (f64, f64) {
    let edge = b - a;
    let length2 = edge.length_squared();
    if length2 == 0.0 {
        return (0.0, point.distance(a));
    }
    let t = ((point - a).dot(edge) / length2).clamp(0.0, 1.0);
    (t, point.distance(a + edge * t))
}

/// As [`nearest_on`], in space.
pub fn nearest_in_space(point: DVec3, [a, b]: Segment) -> (f64, f64) {
    let edge = b - a;
    let length2 = edge.length_squared();
    if length2 == 0.0 {
        return (0.0, point.distance(a));
    }
    let t = ((point - a).dot(edge) / length2).clamp(0.0, 1.0);
    (t, point.distance(a + edge * t))
}

/// A point as it is stored.
pub fn stored(point: DVec3) -> Vec3 {
    point.as_vec3()
}

#[cfg(test)]
mod tests {
    use super::*;

    const SQUARE: [DVec2; 4] = [DVec2::ZERO, DVec2::X, DVec2::ONE, DVec2::Y];

    #[test]
    fn segments_are_clipped_and_know_the_edges_that_cut_them() {
        let through = clip([DVec2::new(-1.0, 0.5), DVec2::new(2.0, 0.5)], &SQUARE)
            .expect("it crosses the square");
        assert!(
            through.ends[0].distance(DVec2::new(0.0, 0.5)) < 1e-12,
            "enters at the left"
        );
        assert_eq!(through.edges, [Some(3), Some(1)], "left and right edge");
        let inner = clip([DVec2::splat(0.2), DVec2::splat(0.4)], &SQUARE).expect("it is inside");
        assert_eq!(inner.edges, [None, None], "it ends inside");
    }

    #[test]
    fn what_runs_along_an_edge_or_outside_is_not_inside() {
        for ends in [
            [DVec2::ZERO, DVec2::X],
            [DVec2::new(0.2, 1.0), DVec2::new(0.8, 1.0)],
            [DVec2::new(0.8, 1.3), DVec2::new(1.3, 0.8)],
            [DVec2::splat(0.5), DVec2::splat(0.5)],
        ] {
            let part = clip(ends, &SQUARE);
            let length = part.map_or(0.0, |p| p.ends[0].distance(p.ends[1]));
            assert!(length == 0.0, "{ends:?}: {part:?}");
        }
    }
}
