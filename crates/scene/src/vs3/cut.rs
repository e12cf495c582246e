//! Convex polygons out of convex polygons: what is left of a wall around its windows.
//!
//! A hole's edges cut the wall one after another. What lies outside of an edge is done, what lies inside goes on to the
//! next edge, and what is inside of all is the hole. Every piece is convex, a window may touch the wall's edge or another
//! window, and corners that both have stay the same point bit for bit.

use glam::DVec3;

/// Corners nearer to a line than this share of the wall's size lie on it.
const ON_LINE: f64 = 1e-6;

/// A flat polygon from which holes are cut.
pub struct Sheet {
    normal: DVec3,
    tolerance: f64,
    corners: Vec<DVec3>,
    pieces: Vec<Vec<DVec3>>,
}

impl Sheet {
    /// The whole polygon, convex, counter-clockwise around its normal.
    pub fn new(corners: Vec<DVec3>, normal: DVec3, size: f64) -> Self {
        Self {
            normal,
            tolerance: ON_LINE * size,
            pieces: vec![corners.clone()],
            corners,
        }
    }

    /// Cuts a convex hole, counter-clockwise around the same normal.
    pub fn cut(&mut self, hole: &[DVec3]) {
        for piece in core::mem::take(&mut self.pieces) {
            if self.is_apart(&piece, hole) {
                self.pieces.push(piece);
            } else {
                self.cut_piece(piece, hole);
            }
        }
    }

    /// What is left.
    pub fn pieces(&self) -> &[Vec<DVec3>] {
        &self.pieces
    }

    /// Whether no part of a piece lies in the hole.
    fn is_apart(&self, piece: &[DVec3], hole: &[DVec3]) -> bool {
        let low = |p: &[DVec3]| p.iter().copied().fold(DVec3::INFINITY, DVec3::min);
        let high = |p: &[DVec3]| p.iter().copied().fold(DVec3::NEG_INFINITY, DVec3::max);
        if low(piece).cmpgt(high(hole)).any() || low(hole).cmpgt(high(piece)).any() {
            return true;
        }
        let mut inside = piece.to_vec();
        for (a, b) in edges(hole) {
            let (kept, _) = self.split(&inside, a, b, hole);
            inside = kept;
        }
        inside.is_empty()
    }

    fn cut_piece(&mut self, piece: Vec<DVec3>, hole: &[DVec3]) {
        let mut inside = piece;
        for (a, b) in edges(hole) {
            let (kept, outside) = self.split(&inside, a, b, hole);
            if !outside.is_empty() {
                self.pieces.push(outside);
            }
            inside = kept;
        }
    }

    /// The parts of a convex polygon to the left and to the right of a line; a part without width is empty.
    fn split(
        &self,
        polygon: &[DVec3],
        a: DVec3,
        b: DVec3,
        hole: &[DVec3],
    ) -> (Vec<DVec3>, Vec<DVec3>) {
        let inwards = self.normal.cross(b - a).normalize_or_zero();
        let distances: Vec<f64> = polygon.iter().map(|&p| (p - a).dot(inwards)).collect();
        let reach = |sign: f64| distances.iter().map(|d| sign * d).fold(0.0, f64::max);
        if reach(1.0) <= self.tolerance {
            return (Vec::new(), polygon.to_vec());
        }
        if reach(-1.0) <= self.tolerance {
            return (polygon.to_vec(), Vec::new());
        }
        let (mut left, mut right) = (Vec::new(), Vec::new());
        let n = polygon.len();
        for i in 0..n {
            let (p, q) = (polygon[i], polygon[(i + 1) % n]);
            let (from, to) = (distances[i], distances[(i + 1) % n]);
            if from >= -self.tolerance {
                left.push(p);
            }
            if from <= self.tolerance {
                right.push(p);
            }
            if from.abs() > self.tolerance && to.abs() > self.tolerance && from * to < 0.0 {
                let crossing = self.snapped(p.lerp(q, from / (from - to)), hole);
                left.push(crossing);
                right.push(crossing);
            }
        }
        (left, right)
    }

    /// The corner that this point stands for, if it is that near to one.
    fn snapped(&self, point: DVec3, hole: &[DVec3]) -> DVec3 {
        let corners = hole.iter().chain(&self.corners);
        let mut near = corners.filter(|&&corner| corner.distance(point) <= self.tolerance);
        near.next().copied().unwrap_or(point)
    }
}

fn edges(polygon: &[DVec3]) -> impl Iterator<Item = (DVec3, DVec3)> + '_ {
    (0..polygon.len()).map(|i| (polygon[i], polygon[(i + 1) % polygon.len()]))
}

/// Twice the vector area of a polygon: its direction is the normal of the side from which the corners run
/// counter-clockwise.
pub fn doubled_area(polygon: &[DVec3]) -> DVec3 {
    let from = polygon[0];
    let pairs = polygon.windows(2);
    pairs
        .map(|pair| (pair[0] - from).cross(pair[1] - from))
        .sum()
}
