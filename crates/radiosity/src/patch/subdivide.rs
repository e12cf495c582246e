//! Subdivision by edge length.
//!
//! An edge is to become as few equal pieces of at most the wanted size as can be, or the next power of two of them, and is cut at one of the pieces' ends,
//! as near to its middle as there is one; its parts go on in the same way. The rule looks at nothing but the edge, so two
//! faces that share an edge cut it alike and in the same vertex: no cracks, no T-vertices, whatever the shapes of the
//! faces. Quads with both pairs of opposite edges cut become four quads, with one pair two; every other combination
//! becomes a fan of triangles around the centre or, for triangles, the usual one, two or four.

use crate::cast::nearest;
use glam::{DVec3, Vec3};
use std::collections::HashMap;

/// Pieces that an edge becomes at most, whatever the size.
const MOST_PIECES: f64 = (1_u32 << 24) as f64;

/// Share of the coordinates of its ends below which an edge is not cut: some steps of an f32.
const ROUNDING: f32 = 1e-6;

/// Edges are longer than a wanted size if they are by more than this factor.
const SLACK: f64 = 1.001;

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

/// What corners of cells are, for those who cut them.
pub(super) trait Corners {
    /// A corner.
    type Id: Copy;
    /// Where it is.
    fn position(&self, corner: Self::Id) -> Vec3;
    /// A corner at a share of the way along an edge.
    fn on_edge(&mut self, edge: [Self::Id; 2], share: f64) -> Self::Id;
    /// A new corner.
    fn inside(&mut self, position: Vec3) -> Self::Id;
}

/// Corners that nobody keeps: places.
#[derive(Debug)]
pub(super) struct Loose;

impl Corners for Loose {
    type Id = Vec3;

    fn position(&self, corner: Vec3) -> Vec3 {
        corner
    }

    fn on_edge(&mut self, [from, to]: [Vec3; 2], share: f64) -> Vec3 {
        from.as_dvec3().lerp(to.as_dvec3(), share).as_vec3()
    }

    fn inside(&mut self, position: Vec3) -> Vec3 {
        position
    }
}

/// Vertices shared by all faces.
#[derive(Debug, Default)]
pub struct Vertices {
    /// World positions.
    pub positions: Vec<Vec3>,
    by_position: HashMap<[u32; 3], u32>,
    /// Where edges were cut: a vertex between the two.
    middles: HashMap<(u32, u32), u32>,
}

impl Corners for Vertices {
    type Id = u32;

    fn position(&self, corner: u32) -> Vec3 {
        self.positions[corner as usize]
    }

    fn on_edge(&mut self, [from, to]: [u32; 2], share: f64) -> u32 {
        let positions = &mut self.positions;
        *self
            .middles
            .entry((from.min(to), from.max(to)))
            .or_insert_with(|| {
                let [from, to] = [from, to].map(|v| positions[v as usize]);
                push(positions, Loose.on_edge([from, to], share))
            })
    }

    fn inside(&mut self, position: Vec3) -> u32 {
        push(&mut self.positions, position)
    }
}

impl Vertices {
    /// Vertices of which no edge has a middle yet.
    pub(super) fn over(positions: Vec<Vec3>) -> Self {
        Self {
            positions,
            ..Self::default()
        }
    }

    /// The vertex at which an edge was cut, if it was.
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
        self.on_edge([a, b], 0.5)
    }

    /// The parts into which an edge was cut, from one of its ends to the other.
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

/// What edges are cut to.
#[derive(Debug, Clone, Copy)]
pub struct Size {
    /// The longest that they may be.
    pub longest: f32,
    /// Whether edges are only halved. Pieces of any number meet a count of elements better, and leave parallelograms in rows
    /// and columns; halves leave triangles and trapezoids regular.
    pub is_halving: bool,
}

/// Pieces of at most a wanted size that an edge becomes. The slack keeps edges of exactly the wanted size, or twice, whole.
fn pieces(a: Vec3, b: Vec3, size: Size) -> f64 {
    let length = f64::from(a.distance_squared(b)).sqrt();
    // Pieces that rounding could make nothing of would never end.
    let least = ROUNDING * a.abs().max(b.abs()).max_element();
    let pieces = (length / (f64::from(size.longest.max(least)) * SLACK)).ceil();
    let pieces = pieces.clamp(1.0, MOST_PIECES);
    if size.is_halving {
        pieces.log2().ceil().exp2()
    } else {
        pieces
    }
}

/// Whether any edge of a polygon is longer than the wanted size.
pub fn any_edge_longer(polygon: &[Vec3], longest: f32) -> bool {
    let size = Size {
        longest,
        is_halving: false,
    };
    (0..polygon.len()).any(|i| pieces(polygon[i], polygon[(i + 1) % polygon.len()], size) > 1.0)
}

/// Whether opposite sides are as long as each other and run the same way.
pub(super) fn is_parallelogram(polygon: &[Vec3]) -> bool {
    let [a, b, c, d] = *polygon else { return false };
    (b - a).abs_diff_eq(c - d, 1e-4 * b.distance(a))
}

/// The share of an edge at which it is cut for a wanted size; none if it is not too long.
fn cut_at(from: Vec3, to: Vec3, size: Size) -> Option<f64> {
    let pieces = pieces(from, to, size);
    let share = (pieces / 2.0).floor() / pieces;
    (pieces > 1.0).then(|| {
        if runs_along(to - from) {
            share
        } else {
            1.0 - share
        }
    })
}

/// Tells the two ways along an edge apart: opposite edges of a parallelogram run the same way, whatever its corners'
/// order, and an edge runs the same way for all faces.
fn runs_along(way: Vec3) -> bool {
    /// No edge of the many that run along an axis or half-way between two is square to it.
    const WAY: Vec3 = Vec3::new(0.871, 0.412, 0.268);
    let along = WAY.dot(way);
    along > 0.0 || (along == 0.0 && way.to_array() > [0.0; 3])
}

/// A part of a cell: three or four corners, and how many.
type Part<Id> = ([Id; 4], usize);

/// The cells that take a cell's place for a wanted size; empty if none of its edges is too long.
pub fn split(cell: Cell, size: Size, vertices: &mut Vertices) -> Vec<Cell> {
    let parts = parts(cell.corners(), size, vertices).into_iter();
    parts.map(cell_of_part).collect()
}

fn cell_of_part((corners, count): Part<u32>) -> Cell {
    match count {
        3 => Cell::triangle(corners[0], corners[1], corners[2]),
        _ => Cell { corners, count: 4 },
    }
}

/// Cells that are counted and not made.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(super) struct Counted {
    pub(super) cells: usize,
    /// Quads among the cells above them that became fans, because opposite edges have different numbers of pieces.
    pub(super) fans: usize,
}

/// The cells that a polygon becomes that are cut for a size as long as they have an edge longer than `whole`; they are
/// counted no further than a limit.
pub(super) fn count(polygon: &[Vec3], size: Size, whole: f32, limit: usize) -> Counted {
    if whole <= size.longest
        && let Some(cells) = cells_of_parallelogram(polygon, size)
    {
        let cells = cells.min(limit);
        return Counted { cells, fans: 0 };
    }
    let mut open: Vec<Part<Vec3>> = vec![part(polygon)];
    let mut counted = Counted::default();
    while let Some((corners, n)) = open.pop() {
        let cell = &corners[..n];
        let is_open = any_edge_longer(cell, whole) && open.len() + counted.cells < limit;
        let parts = if is_open {
            parts(cell, size, &mut Loose)
        } else {
            Vec::new()
        };
        counted.cells += usize::from(parts.is_empty());
        counted.fans += usize::from(n == 4 && parts.len() > 4);
        open.extend(parts);
    }
    counted
}

/// About how many cells a polygon becomes, by its longest edges.
pub(super) fn estimate(polygon: &[Vec3], size: Size) -> usize {
    let n = polygon.len();
    let mut edges: Vec<f64> = (0..n)
        .map(|i| pieces(polygon[i], polygon[(i + 1) % n], size))
        .collect();
    edges.sort_by(f64::total_cmp);
    // The two longest of a triangle; of a quad the longest and, with luck, one of its neighbours.
    let [across, along] = if n == 3 {
        [edges[1], edges[2]]
    } else {
        [edges[1], edges[3]]
    };
    nearest(across * along)
}

/// Cells of a parallelogram, which are cut in rows and columns.
fn cells_of_parallelogram(polygon: &[Vec3], size: Size) -> Option<usize> {
    let [a, b, c, d] = *polygon else { return None };
    let sides = [[a, b], [b, c], [d, c], [a, d]];
    let [ab, bc, dc, ad] = sides.map(|[from, to]| pieces(from, to, size));
    let is_even = (b - a).abs_diff_eq(c - d, 1e-4 * size.longest);
    (is_even && ab == dc && bc == ad).then(|| nearest(ab * bc))
}

fn part<Id: Copy>(corners: &[Id]) -> Part<Id> {
    let last = corners[corners.len() - 1];
    let at = |i: usize| corners.get(i).copied().unwrap_or(last);
    ([at(0), at(1), at(2), at(3)], corners.len())
}

/// The parts that take a polygon's place for a wanted size; empty if none of its edges is too long.
fn parts<C: Corners>(corners: &[C::Id], size: Size, vertices: &mut C) -> Vec<Part<C::Id>> {
    let n = corners.len();
    let mut cuts = [None; 4];
    for (i, cut) in cuts.iter_mut().enumerate().take(n) {
        let edge = [corners[i], corners[(i + 1) % n]];
        let [from, to] = edge.map(|corner| vertices.position(corner));
        *cut = cut_at(from, to, size).map(|share| vertices.on_edge(edge, share));
    }
    match *corners {
        _ if cuts.iter().all(Option::is_none) => Vec::new(),
        [a, b, c, d] => parts_of_quad([a, b, c, d], cuts, vertices),
        [a, b, c] => parts_of_triangle([a, b, c], [cuts[0], cuts[1], cuts[2]], vertices),
        _ => unreachable!("cells have three or four corners"),
    }
}

fn parts_of_quad<C: Corners>(
    [a, b, c, d]: [C::Id; 4],
    cuts: [Option<C::Id>; 4],
    vertices: &mut C,
) -> Vec<Part<C::Id>> {
    match cuts {
        [Some(ab), Some(bc), Some(cd), Some(da)] => {
            let [from, to] = [[ab, cd], [bc, da]]
                .map(|line| line.map(|corner| vertices.position(corner).as_dvec3()));
            let m = vertices.inside(crossing(from, to));
            vec![
                part(&[a, ab, m, da]),
                part(&[ab, b, bc, m]),
                part(&[m, bc, c, cd]),
                part(&[da, m, cd, d]),
            ]
        }
        [Some(ab), None, Some(cd), None] => vec![part(&[a, ab, cd, d]), part(&[ab, b, c, cd])],
        [None, Some(bc), None, Some(da)] => vec![part(&[a, b, bc, da]), part(&[da, bc, c, d])],
        _ => {
            let sum: Vec3 = [a, b, c, d]
                .map(|corner| vertices.position(corner))
                .iter()
                .sum();
            let centre = vertices.inside(sum / 4.0);
            let mut rim = Vec::with_capacity(8);
            for (corner, cut) in [a, b, c, d].into_iter().zip(cuts) {
                rim.push(corner);
                rim.extend(cut);
            }
            let triangle = |i: usize| part(&[rim[i], rim[(i + 1) % rim.len()], centre]);
            (0..rim.len()).map(triangle).collect()
        }
    }
}

/// Where two segments of one plane cross; the mean of their ends if they are parallel.
fn crossing([a, b]: [DVec3; 2], [c, d]: [DVec3; 2]) -> Vec3 {
    let across = (b - a).cross(d - c);
    let share = (c - a).cross(d - c).dot(across) / across.length_squared();
    if share.is_finite() {
        a.lerp(b, share.clamp(0.0, 1.0)).as_vec3()
    } else {
        ((a + b + c + d) / 4.0).as_vec3()
    }
}

/// The cells that take a triangle's place, of which some edges are cut.
pub(super) fn split_triangle(cell: Cell, cuts: &[Option<u32>], vertices: &Vertices) -> Vec<Cell> {
    let [a, b, c, _] = cell.corners;
    let parts = parts_of_triangle([a, b, c], [cuts[0], cuts[1], cuts[2]], vertices);
    parts.into_iter().map(cell_of_part).collect()
}

fn parts_of_triangle<C: Corners>(
    corners: [C::Id; 3],
    cuts: [Option<C::Id>; 3],
    vertices: &C,
) -> Vec<Part<C::Id>> {
    let count = cuts.iter().flatten().count();
    // Turn the triangle so that the first edge is cut and, of two, the third is not.
    let turn = (0..3)
        .find(|&k| cuts[k].is_some() && (count != 2 || cuts[(k + 2) % 3].is_none()))
        .expect("an edge is cut");
    let [a, b, c] = [0, 1, 2].map(|i| corners[(turn + i) % 3]);
    match [0, 1, 2].map(|i| cuts[(turn + i) % 3]) {
        [Some(ab), Some(bc), Some(ca)] => vec![
            part(&[a, ab, ca]),
            part(&[ab, b, bc]),
            part(&[ca, bc, c]),
            part(&[ab, bc, ca]),
        ],
        [Some(ab), Some(bc), None] => {
            // The quad a, ab, bc, c is cut along its shorter diagonal; the choice is inside the face, so it is free.
            let length = |p, q| vertices.position(p).distance_squared(vertices.position(q));
            let mut parts = vec![part(&[ab, b, bc])];
            if length(a, bc) <= length(ab, c) {
                parts.extend([part(&[a, ab, bc]), part(&[a, bc, c])]);
            } else {
                parts.extend([part(&[a, ab, c]), part(&[ab, bc, c])]);
            }
            parts
        }
        [Some(ab), ..] => vec![part(&[a, ab, c]), part(&[ab, b, c])],
        [None, ..] => unreachable!("the first edge is the cut one"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::hash;

    /// A number in [0, 1) by two others.
    fn random(i: u64, k: u64) -> f32 {
        (hash(i, k) >> 40) as f32 / (1_u32 << 24) as f32
    }

    /// A convex polygon in a plane that no axis lies in.
    fn polygon(i: u64) -> Vec<Vec3> {
        let n = 3 + i % 2;
        let corner = |k: u64| {
            let angle = core::f32::consts::TAU * (k as f32 + 0.6 * random(i, k)) / n as f32;
            Vec3::new(3.0, 1.0, 2.0)
                + Vec3::X * angle.cos()
                + Vec3::new(0.0, 0.8, 0.6) * angle.sin()
        };
        (0..n).map(corner).collect()
    }

    fn size(longest: f32) -> Size {
        Size {
            longest,
            is_halving: false,
        }
    }

    /// The cells that a polygon becomes.
    fn leaves(polygon: &[Vec3], size: Size, vertices: &mut Vertices) -> Vec<Cell> {
        let ids: Vec<u32> = polygon.iter().map(|&p| vertices.at(p)).collect();
        let mut open = vec![cell_of_part(part(&ids))];
        let mut leaves = Vec::new();
        while let Some(cell) = open.pop() {
            let parts = split(cell, size, vertices);
            if parts.is_empty() {
                leaves.push(cell);
            }
            open.extend(parts);
        }
        leaves
    }

    #[test]
    fn cells_are_counted_as_they_are_made() {
        for i in 0..200 {
            let (polygon, longest) = (polygon(i), 0.05 + 0.5 * random(i, 9));
            let size = Size {
                longest,
                is_halving: i % 2 == 1,
            };
            let mut vertices = Vertices::default();
            let cells = leaves(&polygon, size, &mut vertices);
            let counted = count(&polygon, size, longest, usize::MAX).cells;
            assert_eq!(counted, cells.len(), "polygon {i}");
            assert!(
                count(&polygon, size, longest, 3).cells <= 3 + 8,
                "polygon {i}: a limit"
            );
            for cell in &cells {
                let corners: Vec<Vec3> = cell
                    .corners()
                    .iter()
                    .map(|&c| vertices.positions[c as usize])
                    .collect();
                assert!(
                    !any_edge_longer(&corners, longest),
                    "polygon {i}: small enough"
                );
            }
        }
    }

    #[test]
    fn a_rectangle_becomes_rows_and_columns() {
        let at = |x: f32, y: f32| Vec3::new(x, y, 0.0);
        let polygon = [at(0.0, 0.0), at(7.0, 0.0), at(7.0, 3.0), at(0.0, 3.0)];
        let mut vertices = Vertices::default();
        let cells = leaves(&polygon, size(1.0), &mut vertices);
        assert_eq!(cells.len(), 21, "7 × 3 squares");
        assert_eq!(
            count(&polygon, size(1.0), 1.0, 100).cells,
            21,
            "counted in one step"
        );
        assert_eq!(vertices.positions.len(), 8 * 4, "which share their corners");
        assert!(
            cells.iter().all(|cell| cell.count == 4),
            "all of them quads"
        );
    }

    #[test]
    fn halves_of_triangles_are_like_them() {
        let at = |x: f32, y: f32| Vec3::new(x, y, 0.0);
        let polygon = [at(0.0, 0.0), at(7.0, 0.0), at(3.0, 6.0)];
        let mut vertices = Vertices::default();
        let size = Size {
            longest: 1.5,
            is_halving: true,
        };
        let cells = leaves(&polygon, size, &mut vertices);
        assert_eq!(cells.len(), 64, "each edge becomes eight");
        for cell in cells {
            let [a, b, c] = [0, 1, 2].map(|i| vertices.positions[cell.corners()[i] as usize]);
            let area = (b - a).cross(c - a).length();
            assert!((area * 64.0 / 42.0 - 1.0).abs() < 1e-4, "of one area");
        }
    }

    #[test]
    fn both_faces_at_an_edge_cut_it_alike() {
        for i in 0..200 {
            let corners = polygon(i);
            let (a, b) = (corners[0], corners[1]);
            let size = size(0.03 + 0.5 * random(i, 9));
            let [there, back] = [cut_at(a, b, size), cut_at(b, a, size)];
            assert_eq!(there.is_some(), back.is_some(), "edge {i}: or not at all");
            let sum = there.unwrap_or(0.5) + back.unwrap_or(0.5);
            assert!((sum - 1.0).abs() < 1e-12, "edge {i}: in one place");
        }
    }

    #[test]
    fn sizes_below_rounding_end() {
        let far = Vec3::splat(1e6);
        let polygon = [far, far + Vec3::X, far + Vec3::ONE, far + Vec3::Y];
        let mut vertices = Vertices::default();
        let cells = leaves(&polygon, size(1e-30), &mut vertices);
        assert!(
            cells.len() < 64,
            "{} cells of some steps of an f32",
            cells.len()
        );
    }
}
