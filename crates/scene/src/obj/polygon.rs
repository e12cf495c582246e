//! Polygons into the faces of the project: triangles, and quads where they are planar and convex.

use glam::{DVec2, DVec3, Vec3};

/// A polygon of more corners is a mistake, or meant to make the triangulation run for hours.
const MAX_CORNERS: usize = 10_000;

/// A corner may lie this far from the plane, relative to the size of the quad; six digits of a text file are finer.
const FLATNESS: f64 = 1e-4;

/// A part of a polygon by numbers of its corners.
#[derive(Debug, Clone, Copy)]
pub enum Piece {
    Triangle([usize; 3]),
    Quad([usize; 4]),
}

/// Splits polygons; keeps its memory between them.
#[derive(Default)]
pub struct Polygons {
    pieces: Vec<Piece>,
    /// Corners without those that repeat the one before.
    corners: Vec<usize>,
    earcut: earcut::Earcut<f64>,
    flat: Vec<[f64; 2]>,
    triangles: Vec<usize>,
}

impl Polygons {
    /// The pieces of a polygon with the same turning sense; the error says why there are none.
    pub fn split(
        &mut self,
        count: usize,
        at: impl Fn(usize) -> Vec3,
        vertex: impl Fn(usize) -> u32,
    ) -> Result<&[Piece], String> {
        self.pieces.clear();
        if count < 3 {
            return Err(format!("it has {count} corners"));
        }
        if count > MAX_CORNERS {
            return Err(format!(
                "its {count} corners are more than {MAX_CORNERS}; split it"
            ));
        }
        self.corners.clear();
        self.corners
            .extend((0..count).filter(|&i| vertex(i) != vertex((i + count - 1) % count)));
        let at = |i: usize| at(i).as_dvec3();
        match *self.corners.as_slice() {
            [a, b, c] => self.pieces.push(Piece::Triangle([a, b, c])),
            [a, b, c, d] if vertex(a) != vertex(c) && vertex(b) != vertex(d) => {
                self.quad([a, b, c, d], at);
            }
            [_, _, _, _] | [_, _] | [_] | [] => {}
            _ => self.polygon(at),
        }
        if self.pieces.is_empty() {
            return Err(String::from("it uses a vertex twice or has no area"));
        }
        Ok(&self.pieces)
    }

    fn quad(&mut self, corners: [usize; 4], at: impl Fn(usize) -> DVec3) {
        let p = corners.map(&at);
        let [a, b, c, d] = corners;
        let diagonal_normal = (p[2] - p[0]).cross(p[3] - p[1]);
        let size = (p[2] - p[0]).length().max((p[3] - p[1]).length());
        let Some(normal) = diagonal_normal.try_normalize() else {
            // No area as a whole; its halves may cancel out, and are then what there is.
            return self
                .pieces
                .extend([Piece::Triangle([a, b, c]), Piece::Triangle([a, c, d])]);
        };
        // The diagonals are in parallel planes; the corners are as far from their middle as the planes are apart / 2.
        let distance = (p[1] - p[0]).dot(normal).abs() / 2.0;
        if distance > FLATNESS * size {
            return self
                .pieces
                .extend([Piece::Triangle([a, b, c]), Piece::Triangle([a, c, d])]);
        }
        let turns = |i: usize| {
            let (before, after) = (p[(i + 1) % 4] - p[i], p[(i + 2) % 4] - p[(i + 1) % 4]);
            before.cross(after).dot(normal) > 1e-6 * before.length() * after.length()
        };
        if (0..4).all(turns) {
            self.pieces.push(Piece::Quad(corners));
        } else {
            self.polygon(at);
        }
    }

    /// Cuts ears off, seen along the polygon's normal (Newell's method: the sum over the edges).
    fn polygon(&mut self, at: impl Fn(usize) -> DVec3) {
        let corners = &self.corners;
        let origin = at(corners[0]);
        let next = |i: usize| at(corners[(i + 1) % corners.len()]) - origin;
        let normal: DVec3 = (0..corners.len())
            .map(|i| (at(corners[i]) - origin).cross(next(i)))
            .sum();
        let Some(normal) = normal.try_normalize() else {
            return;
        };
        let (right, up) = normal.any_orthonormal_pair();
        self.flat.clear();
        self.flat.extend(corners.iter().map(|&i| {
            let p = at(i) - origin;
            [p.dot(right), p.dot(up)]
        }));
        self.earcut
            .earcut_slice::<usize>(&self.flat, &[], &mut self.triangles);
        for &[a, b, c] in self.triangles.as_chunks::<3>().0 {
            let [pa, pb, pc] = [a, b, c].map(|i| DVec2::from(self.flat[i]));
            // The normal points to the viewer, so counter-clockwise is the front.
            let is_front = (pb - pa).perp_dot(pc - pa) >= 0.0;
            let [a, b, c] = [a, b, c].map(|i| corners[i]);
            self.pieces.push(Piece::Triangle(if is_front {
                [a, b, c]
            } else {
                [a, c, b]
            }));
        }
    }
}
