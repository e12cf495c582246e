//! The constraints inside one cell as points and segments between them that do not cross.
//!
//! Ends snap to points that are near, segments bend to points that they nearly touch, and where two cross they are cut
//! in a new point: snap rounding (Hobby 1999) without a grid, so nothing is thinner than the snapping distance but by
//! what the edges of the cell bring.

use super::plane::{clip, nearest_on};
use glam::DVec2;

/// Steps after which what is left of the segments is left out; a cell of thirty crossing lines takes some two thousand.
const MOST_STEPS: usize = 10_000;
/// Segments that one cell keeps at most: the first ones.
pub const MOST_SEGMENTS: usize = 32;

/// Points and segments in a convex cell.
#[derive(Debug, Clone)]
pub struct Arrangement {
    /// Those of the outline come first, counter-clockwise.
    pub points: Vec<DVec2>,
    /// The two edges of the cell that meet in each point of the outline, or one twice.
    pub sides: Vec<[usize; 2]>,
    /// Segments between points that do not cross.
    pub segments: Vec<[usize; 2]>,
    snap: f64,
}

impl Arrangement {
    /// A cell with points on its edges, each list from one corner to the next by shares of the way, and distances
    /// within which things snap together.
    pub fn new(corners: &[DVec2], on_edges: &[Vec<f64>], snap: f64) -> Self {
        let n = corners.len();
        let (mut points, mut sides) = (Vec::new(), Vec::new());
        for (i, shares) in on_edges.iter().enumerate() {
            points.push(corners[i]);
            sides.push([(i + n - 1) % n, i]);
            for &t in shares {
                points.push(corners[i].lerp(corners[(i + 1) % n], t));
                sides.push([i, i]);
            }
        }
        Self {
            points,
            sides,
            segments: Vec::new(),
            snap,
        }
    }

    /// Adds segments, each as far as it is inside the cell.
    pub fn add(&mut self, corners: &[DVec2], segments: &[[DVec2; 2]]) {
        let mut open: Vec<[usize; 2]> = Vec::new();
        for &segment in segments {
            if let Some(inside) = clip(segment, corners) {
                open.push([0, 1].map(|end| self.end(inside.ends[end], inside.edges[end])));
            }
        }
        open.reverse();
        let mut steps = 0;
        while let Some(segment) = open.pop() {
            steps += 1;
            if steps > MOST_STEPS {
                break;
            }
            self.add_one(segment, &mut open);
        }
    }

    /// The point for an end of a segment: of those on the edge that cut it the nearest, else one nearby or a new one.
    fn end(&mut self, at: DVec2, edge: Option<usize>) -> usize {
        let nearest = |points: &mut dyn Iterator<Item = usize>| {
            points.min_by(|&a, &b| {
                let distance = |i: usize| self.points[i].distance_squared(at);
                distance(a).total_cmp(&distance(b))
            })
        };
        let on_edge = |&i: &usize| edge.is_none_or(|e| self.sides[i].contains(&e));
        let found = if edge.is_some() {
            nearest(&mut (0..self.sides.len()).filter(on_edge))
        } else {
            // On an edge, points may lie half as far again: a snapping distance along and one across.
            let near = |&i: &usize| self.points[i].distance(at) < 1.5 * self.snap;
            nearest(&mut (0..self.points.len()).filter(near))
        };
        found.unwrap_or_else(|| self.push(at))
    }

    fn push(&mut self, at: DVec2) -> usize {
        self.points.push(at);
        self.points.len() - 1
    }

    /// Adds a segment, or what it falls apart into to `open`.
    fn add_one(&mut self, [a, b]: [usize; 2], open: &mut Vec<[usize; 2]>) {
        let is_known = |s: &&[usize; 2]| **s == [a, b] || **s == [b, a];
        if a == b || self.is_on_outline(a, b) || self.segments.iter().any(|s| is_known(&s)) {
            return;
        }
        if let Some(point) = self.point_beside(a, b) {
            open.extend([[point, b], [a, point]]);
            return;
        }
        for i in 0..self.segments.len() {
            let [c, d] = self.segments[i];
            if let Some(at) = self.crossing([a, b], [c, d]) {
                let point = self.end(at, None);
                self.segments.swap_remove(i);
                open.extend([[c, point], [point, d], [point, b], [a, point]]);
                return;
            }
        }
        self.segments.push([a, b]);
    }

    /// Whether two points lie on one edge of the cell.
    fn is_on_outline(&self, a: usize, b: usize) -> bool {
        let count = self.sides.len();
        a < count
            && b < count
            && self.sides[a]
                .iter()
                .any(|side| self.sides[b].contains(side))
    }

    /// A point that a segment nearly touches between its ends.
    fn point_beside(&self, a: usize, b: usize) -> Option<usize> {
        let ends = [self.points[a], self.points[b]];
        let others = (0..self.points.len()).filter(|&i| i != a && i != b);
        let beside = others.filter_map(|i| {
            let (t, distance) = nearest_on(self.points[i], ends);
            (distance < self.snap && t > 0.0 && t < 1.0).then_some((distance, i))
        });
        beside.min_by(|x, y| x.0.total_cmp(&y.0)).map(|(_, i)| i)
    }

    /// Where two segments cross between their ends.
    fn crossing(&self, [a, b]: [usize; 2], [c, d]: [usize; 2]) -> Option<DVec2> {
        if a == c || a == d || b == c || b == d {
            return None;
        }
        let [a, b, c, d] = [a, b, c, d].map(|i| self.points[i]);
        let (along, other) = (b - a, d - c);
        let (hc, hd) = (along.perp_dot(c - a), along.perp_dot(d - a));
        let (ha, hb) = (other.perp_dot(a - c), other.perp_dot(b - c));
        (hc * hd < 0.0 && ha * hb < 0.0).then(|| a.lerp(b, ha / (ha - hb)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SQUARE: [DVec2; 4] = [DVec2::ZERO, DVec2::X, DVec2::ONE, DVec2::Y];

    fn square(on_edges: [&[f64]; 4]) -> Arrangement {
        Arrangement::new(&SQUARE, &on_edges.map(<[f64]>::to_vec), 0.01)
    }

    #[test]
    fn lines_that_cross_are_cut_where_they_do() {
        let mut cell = square([&[], &[0.5], &[0.5], &[0.5]]);
        let flat = [DVec2::new(-1.0, 0.5), DVec2::new(2.0, 0.5)];
        let steep = [DVec2::new(0.5, 0.25), DVec2::new(0.5, 1.5)];
        cell.add(&SQUARE, &[flat, steep]);
        assert_eq!(
            cell.points.len(),
            9,
            "an end and a crossing beside the outline"
        );
        assert_eq!(cell.segments.len(), 4, "{:?}", cell.segments);
    }

    #[test]
    fn a_third_line_goes_through_the_crossing_of_two() {
        let mut cell = square([&[], &[], &[], &[]]);
        let through = |angle: f64| {
            let d = DVec2::from_angle(angle) * 0.3;
            [
                DVec2::splat(0.5) - d,
                DVec2::splat(0.5) + d + DVec2::new(0.0, 0.004),
            ]
        };
        cell.add(&SQUARE, &[through(0.3), through(1.3), through(2.3)]);
        assert_eq!(
            cell.points.len(),
            4 + 6 + 1,
            "one crossing: {:?}",
            cell.points
        );
        assert_eq!(cell.segments.len(), 6, "{:?}", cell.segments);
    }

    #[test]
    fn what_runs_along_an_edge_is_left_out() {
        let mut cell = square([&[0.4], &[], &[], &[]]);
        cell.add(
            &SQUARE,
            &[[DVec2::new(-0.2, 0.001), DVec2::new(0.4, 0.002)]],
        );
        assert!(cell.segments.is_empty(), "{:?}", cell.segments);
    }

    #[test]
    fn no_two_of_many_lines_cross() {
        let mut cell = square([&[], &[], &[], &[]]);
        let at = |i: usize| {
            let x = (i as f64 * 0.618_034).fract();
            let y = (i as f64 * 0.414_214).fract();
            DVec2::new(x, y) * 0.9 + 0.05
        };
        let lines: Vec<[DVec2; 2]> = (0..32).map(|i| [at(2 * i + 1), at(2 * i + 2)]).collect();
        cell.add(&SQUARE, &lines);
        for (i, &one) in cell.segments.iter().enumerate() {
            for &other in &cell.segments[..i] {
                assert!(cell.crossing(one, other).is_none(), "{one:?} and {other:?}");
            }
        }
        assert!(
            cell.segments.len() > 100,
            "{} segments",
            cell.segments.len()
        );
    }
}
