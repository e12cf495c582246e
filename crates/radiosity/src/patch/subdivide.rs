//! Subdivision by edge length.
//!
//! An edge is halved when it is longer than the wanted size. The rule looks at nothing but the edge, so two faces that
//! share an edge halve it alike and in the same vertex: no cracks, no T-vertices, whatever the shapes of the faces.
//! Quads with both pairs of opposite edges halved become four quads, with one pair two; every other combination becomes
//! a fan of triangles around the centre or, for triangles, the usual one, two or four.

use glam::Vec3;
use std::collections::HashMap;

/// Halvings after which recursion stops whatever the size.
const MAX_DEPTH: u32 = 24;

/// A polygon of three or four vertices.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Cell {
    /// Vertex indices; the fourth is unused for triangles.
    pub corners: [u32; 4],
    /// 3 or 4.
    pub count: u8,
}

impl Cell {
    /// A triangle.
    pub fn triangle(a: u32, b: u32, c: u32) -> Self {
        Self {
            corners: [a, b, c, c],
            count: 3,
        }
    }

    /// A quad.
    pub fn quad(a: u32, b: u32, c: u32, d: u32) -> Self {
        Self {
            corners: [a, b, c, d],
            count: 4,
        }
    }

    /// The vertex indices.
    pub fn corners(&self) -> &[u32] {
        &self.corners[..self.count as usize]
    }
}

/// Vertices shared by all faces.
#[derive(Debug, Default)]
pub struct Vertices {
    /// World positions.
    pub positions: Vec<Vec3>,
    by_position: HashMap<[u32; 3], u32>,
    middles: HashMap<(u32, u32), u32>,
}

impl Vertices {
    /// Vertices of which no edge has a middle yet.
    pub(super) fn over(positions: Vec<Vec3>) -> Self {
        Self {
            positions,
            ..Self::default()
        }
    }

    /// The vertex in the middle of an edge, if the edge was halved.
    pub(super) fn known_middle(&self, a: u32, b: u32) -> Option<u32> {
        self.middles.get(&(a.min(b), a.max(b))).copied()
    }

    /// The vertex at exactly this position, new if there is none.
    pub fn at(&mut self, position: Vec3) -> u32 {
        // -0 and 0 are the same place.
        let key = (position + Vec3::ZERO).to_array().map(f32::to_bits);
        *self
            .by_position
            .entry(key)
            .or_insert_with(|| push(&mut self.positions, position))
    }

    /// The vertex in the middle of an edge.
    pub fn middle(&mut self, a: u32, b: u32) -> u32 {
        let positions = &mut self.positions;
        *self.middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
            let middle = (positions[a as usize] + positions[b as usize]) * 0.5;
            push(positions, middle)
        })
    }

    /// The parts into which an edge was halved, from one of its ends to the other.
    pub fn pieces(&self, a: u32, b: u32) -> Vec<(u32, u32)> {
        let mut stack = vec![(a, b)];
        let mut pieces = Vec::new();
        while let Some((a, b)) = stack.pop() {
            match self.middles.get(&(a.min(b), a.max(b))) {
                Some(&middle) => stack.extend([(middle, b), (a, middle)]),
                None => pieces.push((a, b)),
            }
        }
        pieces
    }

    /// A new vertex at a share of the way from one vertex to another.
    pub fn between(&mut self, a: u32, b: u32, t: f64) -> u32 {
        let [from, to] = [a, b].map(|v| self.positions[v as usize].as_dvec3());
        push(&mut self.positions, from.lerp(to, t).as_vec3())
    }

    /// A new vertex.
    pub fn push(&mut self, position: Vec3) -> u32 {
        push(&mut self.positions, position)
    }

    /// A new vertex in the centre of a cell.
    pub(super) fn centre(&mut self, cell: Cell) -> u32 {
        let sum: Vec3 = cell
            .corners()
            .iter()
            .map(|&c| self.positions[c as usize])
            .sum();
        push(&mut self.positions, sum / f32::from(cell.count))
    }
}

fn push(positions: &mut Vec<Vec3>, position: Vec3) -> u32 {
    positions.push(position);
    u32::try_from(positions.len() - 1).expect("a mesh has fewer than 2^32 vertices")
}

/// Whether an edge is halved for a wanted size. The slack keeps edges of exactly the wanted size, or twice, whole.
fn is_long(a: Vec3, b: Vec3, size: f32) -> bool {
    f64::from(a.distance_squared(b)).sqrt() > f64::from(size) * 1.001
}

/// Whether any edge of a polygon is longer than the wanted size.
pub fn any_edge_longer(polygon: &[Vec3], size: f32) -> bool {
    (0..polygon.len()).any(|i| is_long(polygon[i], polygon[(i + 1) % polygon.len()], size))
}

/// The cells that take a cell's place for a wanted size; empty if none of its edges is too long.
pub fn split(cell: Cell, size: f32, depth: u32, vertices: &mut Vertices) -> Vec<Cell> {
    let corners = cell.corners();
    let n = corners.len();
    let long: Vec<bool> = (0..n)
        .map(|i| {
            let (a, b) = (corners[i] as usize, corners[(i + 1) % n] as usize);
            depth < MAX_DEPTH && is_long(vertices.positions[a], vertices.positions[b], size)
        })
        .collect();
    if !long.contains(&true) {
        return Vec::new();
    }
    let middles: Vec<Option<u32>> = (0..n)
        .map(|i| long[i].then(|| vertices.middle(corners[i], corners[(i + 1) % n])))
        .collect();
    if n == 4 {
        split_quad(cell, &middles, vertices)
    } else {
        split_triangle(cell, &middles, vertices)
    }
}

fn split_quad(cell: Cell, middles: &[Option<u32>], vertices: &mut Vertices) -> Vec<Cell> {
    let [a, b, c, d] = cell.corners;
    match *middles {
        [Some(ab), Some(bc), Some(cd), Some(da)] => {
            let m = vertices.centre(cell);
            vec![
                Cell::quad(a, ab, m, da),
                Cell::quad(ab, b, bc, m),
                Cell::quad(m, bc, c, cd),
                Cell::quad(da, m, cd, d),
            ]
        }
        [Some(ab), None, Some(cd), None] => {
            vec![Cell::quad(a, ab, cd, d), Cell::quad(ab, b, c, cd)]
        }
        [None, Some(bc), None, Some(da)] => {
            vec![Cell::quad(a, b, bc, da), Cell::quad(da, bc, c, d)]
        }
        _ => {
            let centre = vertices.centre(cell);
            let mut rim = Vec::with_capacity(8);
            for (&corner, &middle) in cell.corners().iter().zip(middles) {
                rim.push(corner);
                rim.extend(middle);
            }
            (0..rim.len())
                .map(|i| Cell::triangle(rim[i], rim[(i + 1) % rim.len()], centre))
                .collect()
        }
    }
}

pub(super) fn split_triangle(
    cell: Cell,
    middles: &[Option<u32>],
    vertices: &Vertices,
) -> Vec<Cell> {
    let corners = cell.corners();
    let count = middles.iter().flatten().count();
    // Turn the triangle so that the first edge is halved and, of two, the third is not.
    let turn = (0..3)
        .find(|&k| middles[k].is_some() && (count != 2 || middles[(k + 2) % 3].is_none()))
        .expect("an edge is halved");
    let [a, b, c] = [0, 1, 2].map(|i| corners[(turn + i) % 3]);
    let [ab, bc, ca] = [0, 1, 2].map(|i| middles[(turn + i) % 3]);
    match (ab, bc, ca) {
        (Some(ab), Some(bc), Some(ca)) => vec![
            Cell::triangle(a, ab, ca),
            Cell::triangle(ab, b, bc),
            Cell::triangle(ca, bc, c),
            Cell::triangle(ab, bc, ca),
        ],
        (Some(ab), Some(bc), None) => {
            // The quad a, ab, bc, c is cut along its shorter diagonal; the choice is inside the face, so it is free.
            let length = |p: u32, q: u32| {
                vertices.positions[p as usize].distance_squared(vertices.positions[q as usize])
            };
            let mut cells = vec![Cell::triangle(ab, b, bc)];
            if length(a, bc) <= length(ab, c) {
                cells.extend([Cell::triangle(a, ab, bc), Cell::triangle(a, bc, c)]);
            } else {
                cells.extend([Cell::triangle(a, ab, c), Cell::triangle(ab, bc, c)]);
            }
            cells
        }
        (Some(ab), ..) => vec![Cell::triangle(a, ab, c), Cell::triangle(ab, b, c)],
        (None, ..) => unreachable!("the first edge is the halved one"),
    }
}
