//! Whether a convex polygon stands between two others: all of it, nothing, or in part.
//!
//! The *shaft* of two convex polygons is their convex hull: all segments between them. Where they lie on different sides
//! of an occluder's plane, the shaft cuts that plane in the convex hull of the points at which the segments between their
//! corners cross it. An occluder that holds all of these hides the pair; one with an edge that has all of them outside
//! does not touch it. Only what is left has to be sampled (after Haines, Wallace 1991).

use crate::form_factor::polygon::FlatPolygon;
use glam::DVec3;

/// What an occluder does to a pair.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Blocks {
    /// It is not in the shaft.
    Nothing,
    /// Some of it may be in the shaft.
    Part,
    /// Every segment between the two crosses it.
    All,
}

/// A convex polygon that may stand between others, with the planes through its edges.
#[derive(Debug, Clone, Copy)]
pub struct Occluder {
    /// Its corners and normal.
    pub polygon: FlatPolygon,
    /// Box around it.
    pub bounds: Bounds,
    /// Of each edge: unit normal of the plane through it that stands on the polygon, inwards.
    edges: [DVec3; MOST_CORNERS],
}

/// An axis-aligned box.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounds {
    /// Smallest coordinates.
    pub low: DVec3,
    /// Largest coordinates.
    pub high: DVec3,
}

impl Bounds {
    /// Nothing.
    pub const EMPTY: Self = Self {
        low: DVec3::INFINITY,
        high: DVec3::NEG_INFINITY,
    };

    /// Around points.
    pub fn around(points: &[DVec3]) -> Self {
        points.iter().fold(Self::EMPTY, |bounds, &p| Self {
            low: bounds.low.min(p),
            high: bounds.high.max(p),
        })
    }

    /// Around both.
    pub fn union(self, other: Self) -> Self {
        Self {
            low: self.low.min(other.low),
            high: self.high.max(other.high),
        }
    }

    /// Whether a box touches the shaft of two boxes.
    ///
    /// The shaft is the union over t in [0, 1] of the boxes between the two, whose sides move linearly: each side
    /// bounds t from one end.
    pub fn meets_shaft(&self, a: &Self, b: &Self) -> bool {
        let (mut from, mut to) = (0.0_f64, 1.0_f64);
        // The side starts at `start` and moves by `change`; it must not be above `most`.
        let mut at_most = |start: f64, change: f64, most: f64| {
            let room = most - start;
            if change > 0.0 {
                to = to.min(room / change);
            } else if change < 0.0 {
                from = from.max(room / change);
            } else if room < 0.0 {
                to = -1.0;
            }
        };
        for axis in 0..3 {
            at_most(a.low[axis], b.low[axis] - a.low[axis], self.high[axis]);
            at_most(-a.high[axis], a.high[axis] - b.high[axis], -self.low[axis]);
        }
        from <= to
    }
}

impl Occluder {
    /// From a convex polygon of three to six corners.
    pub fn new(polygon: FlatPolygon) -> Self {
        let corners = polygon.corners();
        let mut edges = [DVec3::ZERO; MOST_CORNERS];
        for (i, edge) in edges.iter_mut().take(corners.len()).enumerate() {
            let along = corners[(i + 1) % corners.len()] - corners[i];
            *edge = polygon.normal.cross(along).normalize_or_zero();
        }
        Self {
            bounds: Bounds::around(corners),
            edges,
            polygon,
        }
    }

    /// Whether a corner of it is more than `tolerance` above a plane.
    pub fn rises_above(&self, origin: DVec3, normal: DVec3, tolerance: f64) -> bool {
        let corners = self.polygon.corners().iter();
        corners
            .into_iter()
            .any(|&c| (c - origin).dot(normal) > tolerance)
    }

    /// What it does to a pair of convex polygons. Lengths below `tolerance` are rounding.
    pub fn blocks(&self, a: &[DVec3], b: &[DVec3], tolerance: f64) -> Blocks {
        let heights_a = self.heights(a);
        let heights_b = self.heights(b);
        let (low_a, high_a) = range(&heights_a[..a.len()]);
        let (low_b, high_b) = range(&heights_b[..b.len()]);
        let on_one_side = (low_a >= -tolerance && low_b >= -tolerance)
            || (high_a <= tolerance && high_b <= tolerance);
        if on_one_side {
            return Blocks::Nothing;
        }
        let between = (low_a >= -tolerance && high_b <= tolerance)
            || (high_a <= tolerance && low_b >= -tolerance);
        if !between {
            return if self.has_both_outside(a, b, tolerance) {
                Blocks::Nothing
            } else {
                Blocks::Part
            };
        }
        let mut is_all = true;
        for (i, &edge) in self
            .edges
            .iter()
            .take(self.polygon.corners().len())
            .enumerate()
        {
            let origin = self.polygon.corners()[i];
            let mut depths_b = [0.0; MOST_CORNERS];
            for (depth, &corner) in depths_b.iter_mut().zip(b) {
                *depth = (corner - origin).dot(edge);
            }
            let mut is_outside = true;
            for (&corner, &height_a) in a.iter().zip(&heights_a) {
                let depth_a = (corner - origin).dot(edge);
                for (&depth_b, &height_b) in depths_b.iter().zip(&heights_b).take(b.len()) {
                    // Depth of the crossing point, times a length that is not negative.
                    let depth = depth_a * height_b.abs() + depth_b * height_a.abs();
                    let length = height_a.abs() + height_b.abs();
                    is_outside &= depth <= tolerance * length;
                    is_all &= depth >= -tolerance * length && length > tolerance;
                }
            }
            if is_outside {
                return Blocks::Nothing;
            }
        }
        if is_all { Blocks::All } else { Blocks::Part }
    }

    /// Whether both polygons lie outside one edge.
    fn has_both_outside(&self, a: &[DVec3], b: &[DVec3], tolerance: f64) -> bool {
        let corners = self.polygon.corners();
        corners.iter().zip(&self.edges).any(|(&origin, &edge)| {
            let is_outside = |&c: &DVec3| (c - origin).dot(edge) <= tolerance;
            a.iter().all(is_outside) && b.iter().all(is_outside)
        })
    }

    fn heights(&self, corners: &[DVec3]) -> [f64; MOST_CORNERS] {
        let (origin, normal) = (self.polygon.corners()[0], self.polygon.normal);
        let mut heights = [0.0; MOST_CORNERS];
        for (height, &corner) in heights.iter_mut().zip(corners) {
            *height = (corner - origin).dot(normal);
        }
        heights
    }
}

/// Corners of a quad that was cut by a plane, and one to spare.
const MOST_CORNERS: usize = 6;

fn range(values: &[f64]) -> (f64, f64) {
    let nothing = (f64::INFINITY, f64::NEG_INFINITY);
    values
        .iter()
        .fold(nothing, |(low, high), &v| (low.min(v), high.max(v)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::hash;

    fn square(centre: DVec3, half: f64) -> [DVec3; 4] {
        [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]
            .map(|(x, y)| centre + half * DVec3::new(x, y, 0.0))
    }

    fn occluder(corners: &[DVec3]) -> Occluder {
        Occluder::new(FlatPolygon::from_corners(corners))
    }

    #[test]
    fn a_screen_hides_all_a_part_or_nothing() {
        let (below, above) = (square(DVec3::ZERO, 0.5), square(DVec3::Z, 0.5));
        let screen =
            |centre: DVec3, half| occluder(&square(centre, half)).blocks(&below, &above, 1e-9);
        assert_eq!(screen(DVec3::Z * 0.5, 0.5), Blocks::All, "as large as both");
        assert_eq!(screen(DVec3::Z * 0.5, 0.4), Blocks::Part, "smaller");
        assert_eq!(
            screen(DVec3::new(1.1, 0.0, 0.5), 0.5),
            Blocks::Nothing,
            "beside"
        );
        assert_eq!(
            screen(DVec3::new(0.0, 0.0, 1.5), 5.0),
            Blocks::Nothing,
            "behind"
        );
        assert_eq!(
            screen(DVec3::ZERO, 5.0),
            Blocks::Nothing,
            "in the plane of one"
        );
    }

    /// Points of two triangles and a screen, against the verdict on them.
    #[test]
    fn verdicts_agree_with_random_segments() {
        let mut count = 0;
        let mut random = || {
            count += 1;
            (hash(count, 3) >> 11) as f64 / (1_u64 << 53) as f64
        };
        let (mut all, mut nothing) = (0, 0);
        for _ in 0..3000 {
            let mut point = |z: f64| DVec3::new(random(), random(), z + 0.3 * random());
            let a = [point(0.0), point(0.0), point(0.0)];
            let b = [point(1.0), point(1.0), point(1.0)];
            let (size, middle) = (
                3.0 * random(),
                DVec3::new(2.0 * random(), 2.0 * random(), 0.65),
            );
            let screen = [0.0, 1.0, 2.0].map(|k: f64| {
                let (sine, cosine) = (k * core::f64::consts::TAU / 3.0).sin_cos();
                middle + size * DVec3::new(cosine, sine, 0.0)
            });
            let screen = occluder(&screen);
            let verdict = screen.blocks(&a, &b, 1e-12);
            for _ in 0..50 {
                let mut on = |t: &[DVec3; 3]| {
                    let (u, v) = (random(), random());
                    let u = u.sqrt();
                    t[0] * (1.0 - u) + t[1] * (u * (1.0 - v)) + t[2] * (u * v)
                };
                let (x, y) = (on(&a), on(&b));
                let at = x.lerp(y, (0.65 - x.z) / (y.z - x.z));
                let inside = screen.edges.iter().zip(screen.polygon.corners());
                let is_hit = inside.take(3).all(|(edge, &c)| (at - c).dot(*edge) > 0.0);
                match verdict {
                    Blocks::All => assert!(is_hit, "{at} is hidden"),
                    Blocks::Nothing => assert!(!is_hit, "{at} is clear"),
                    Blocks::Part => {}
                }
            }
            all += usize::from(verdict == Blocks::All);
            nothing += usize::from(verdict == Blocks::Nothing);
        }
        assert!(all > 500 && nothing > 200, "{all} hidden, {nothing} clear");
    }

    #[test]
    fn boxes_beside_a_shaft_are_told_from_boxes_in_it() {
        let unit = |x: f64, y: f64, z: f64| Bounds {
            low: DVec3::new(x, y, z),
            high: DVec3::new(x + 1.0, y + 1.0, z + 1.0),
        };
        let (a, b) = (unit(0.0, 0.0, 0.0), unit(8.0, 8.0, 0.0));
        assert!(unit(4.0, 4.0, 0.5).meets_shaft(&a, &b), "on the diagonal");
        assert!(unit(4.0, 5.5, 0.0).meets_shaft(&a, &b), "it touches");
        assert!(
            !unit(2.0, 6.0, 0.0).meets_shaft(&a, &b),
            "in the corner of the box around both"
        );
        assert!(!unit(4.0, 4.0, 2.0).meets_shaft(&a, &b), "above");
        assert!(unit(0.2, 0.2, 0.2).meets_shaft(&a, &b), "at one end");
        assert!(
            unit(0.0, 0.0, 0.0).meets_shaft(&a, &a),
            "a shaft of one box"
        );
    }
}
