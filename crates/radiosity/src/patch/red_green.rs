//! Regular refinement with triangulated transitions (Bank, Sherman, Weiser 1983).
//!
//! *Red* cells are cut like to like: a quad into four quads, a triangle into four triangles, all edges halved. The tree is
//! *restricted*: leaves that share an edge differ by at most one level. A leaf with an edge that its neighbour has halved
//! is cut along that middle, *green*, so that no vertex hangs on an edge. Green cells are never cut themselves: further
//! refinement starts from the red leaf, so angles do not decay from round to round.

use crate::patch::subdivide::{Cell, Vertices, split_triangle};
use glam::Vec3;
use serde::{Deserialize, Serialize};

/// Levels that no cell goes beyond.
const MAX_LEVEL: u8 = 20;

/// Which cells of a mesh were cut, by their positions: for each element of the mesh before any refinement, in order, a 1 and
/// the same for its four parts if it was cut, else a 0. The default one cuts nothing, of any mesh.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Refinement {
    bytes: Vec<u8>,
    bits: u64,
}

impl Refinement {
    fn push(&mut self, bit: bool) {
        if self.bits.is_multiple_of(8) {
            self.bytes.push(0);
        }
        if let Some(last) = self.bytes.last_mut() {
            *last |= u8::from(bit) << (self.bits % 8);
        }
        self.bits += 1;
    }

    /// In the order in which they were pushed.
    fn iter(&self) -> impl Iterator<Item = bool> + '_ {
        let bits = self
            .bytes
            .iter()
            .flat_map(|byte| (0..8).map(move |bit| byte >> bit & 1 == 1));
        bits.take(usize::try_from(self.bits).unwrap_or(usize::MAX))
    }

    /// Whether no cell is cut.
    pub fn is_empty(&self) -> bool {
        self.bytes.iter().all(|&byte| byte == 0)
    }
}

/// A cell of the tree.
#[derive(Debug, Clone, Copy)]
struct Red {
    cell: Cell,
    level: u8,
    /// First of four; 0 for leaves, since what comes first is a root.
    children: u32,
}

/// The red cells below the elements of a mesh.
#[derive(Debug)]
pub(super) struct RedTree {
    cells: Vec<Red>,
    roots: usize,
    /// An edge has a middle if a red cell along it was cut.
    vertices: Vertices,
}

impl RedTree {
    /// No cell is cut.
    pub(super) fn new(roots: &[Cell], vertices: Vec<Vec3>) -> Self {
        let root = |&cell: &Cell| Red {
            cell,
            level: 0,
            children: 0,
        };
        let cells: Vec<Red> = roots.iter().map(root).collect();
        Self {
            roots: cells.len(),
            cells,
            vertices: Vertices::over(vertices),
        }
    }

    /// Cuts what a record says; `None` if the record is not one of this tree, or of more cells than allowed.
    pub(super) fn replay(mut self, record: &Refinement, most: usize) -> Option<Self> {
        if *record == Refinement::default() {
            return Some(self);
        }
        let mut bits = record.iter();
        for root in 0..self.roots {
            let mut open = vec![root];
            while let Some(cell) = open.pop() {
                if !bits.next()? {
                    continue;
                }
                if self.cells[cell].level >= MAX_LEVEL || self.cells.len() > 2 * most {
                    return None;
                }
                open.extend(self.cut(cell).rev());
            }
        }
        bits.next().is_none().then_some(self)
    }

    /// What [`Self::replay`] takes.
    pub(super) fn record(&self) -> Refinement {
        let mut record = Refinement::default();
        self.visit(|tree, cell| record.push(tree.cells[cell].children != 0));
        record
    }

    /// Leaves, from the first root's on.
    pub(super) fn leaves(&self) -> Vec<usize> {
        let mut leaves = Vec::new();
        self.visit(|tree, cell| {
            if tree.is_leaf(cell) {
                leaves.push(cell);
            }
        });
        leaves
    }

    /// All cells, parents before their children.
    fn visit(&self, mut what: impl FnMut(&Self, usize)) {
        for root in 0..self.roots {
            let mut open = vec![root];
            while let Some(cell) = open.pop() {
                what(self, cell);
                open.extend(self.red_children(cell).rev());
            }
        }
    }

    /// Red children; none of leaves.
    pub(super) fn red_children(&self, cell: usize) -> core::ops::Range<usize> {
        match self.cells[cell].children as usize {
            0 => 0..0,
            first => first..first + 4,
        }
    }

    /// Longest edge of a cell.
    pub(super) fn longest_edge(&self, cell: usize) -> f32 {
        let at = |v: u32| self.vertices.positions[v as usize];
        let edges = edges(self.cells[cell].cell);
        edges
            .map(|(a, b)| at(a).distance(at(b)))
            .fold(0.0, f32::max)
    }

    /// Cuts a leaf into four.
    pub(super) fn cut(&mut self, leaf: usize) -> core::ops::Range<usize> {
        let Red { cell, level, .. } = self.cells[leaf];
        let first = self.cells.len();
        self.cells[leaf].children = crate::index32(first);
        let parts = quarters(cell, &mut self.vertices);
        self.cells.extend(parts.map(|cell| Red {
            cell,
            level: level + 1,
            children: 0,
        }));
        first..first + 4
    }

    /// Cuts leaves until those that share an edge differ by at most one level; they may become more than `most`, and then
    /// it ends early.
    pub(super) fn close(&mut self, most: usize) {
        let mut coarse = self.leaves();
        while !coarse.is_empty() && self.cells.len() <= 2 * most {
            // Cutting one leaf makes others too coarse, but none that are finer.
            coarse.retain(|&leaf| self.cells[leaf].children == 0);
            let too_coarse: Vec<usize> = coarse
                .iter()
                .copied()
                .filter(|&leaf| self.is_too_coarse(leaf))
                .collect();
            for &leaf in &too_coarse {
                coarse.extend(self.cut(leaf));
            }
            if too_coarse.is_empty() {
                break;
            }
        }
    }

    /// Whether a neighbour is two levels finer, or all neighbours are finer.
    fn is_too_coarse(&self, leaf: usize) -> bool {
        let Red { cell, level, .. } = self.cells[leaf];
        if level >= MAX_LEVEL {
            return false;
        }
        let middle = |a, b| self.vertices.known_middle(a, b);
        let mut halved = 0;
        for (a, b) in edges(cell) {
            if let Some(m) = middle(a, b) {
                halved += 1;
                if middle(a, m).is_some() || middle(m, b).is_some() {
                    return true;
                }
            }
        }
        halved == usize::from(cell.count)
    }

    pub(super) fn is_leaf(&self, cell: usize) -> bool {
        self.cells[cell].children == 0
    }

    /// Whether a leaf is to be cut further. As for edges of the first mesh, slack keeps those of just this length whole.
    pub(super) fn is_longer(&self, leaf: usize, smallest: f32) -> bool {
        self.longest_edge(leaf) > smallest * 1.001 && self.cells[leaf].level < MAX_LEVEL
    }

    /// The parts of a cell: red ones, or of a leaf the green ones; none where nothing cuts it.
    pub(super) fn parts(&self, cell: usize) -> Vec<Cell> {
        let children = self.red_children(cell);
        if !children.is_empty() {
            return children.map(|child| self.cells[child].cell).collect();
        }
        green(self.cells[cell].cell, &self.vertices)
    }

    /// Elements that a leaf becomes.
    pub(super) fn elements_of_leaf(&self, leaf: usize) -> usize {
        self.parts(leaf).len().max(1)
    }

    /// Level below its root.
    pub(super) fn level(&self, cell: usize) -> u8 {
        self.cells[cell].level
    }

    pub(super) fn vertices(&self) -> &Vertices {
        &self.vertices
    }

    pub(super) fn into_positions(self) -> Vec<Vec3> {
        self.vertices.positions
    }
}

fn edges(cell: Cell) -> impl Iterator<Item = (u32, u32)> {
    let n = usize::from(cell.count);
    (0..n).map(move |i| (cell.corners[i], cell.corners[(i + 1) % n]))
}

/// Four parts of the same shape as the whole.
fn quarters(cell: Cell, vertices: &mut Vertices) -> [Cell; 4] {
    let [a, b, c, d] = cell.corners;
    let (ab, bc) = (vertices.middle(a, b), vertices.middle(b, c));
    if cell.count == 3 {
        let ca = vertices.middle(c, a);
        return [
            Cell::triangle(a, ab, ca),
            Cell::triangle(ab, b, bc),
            Cell::triangle(ca, bc, c),
            Cell::triangle(ab, bc, ca),
        ];
    }
    let (cd, da) = (vertices.middle(c, d), vertices.middle(d, a));
    let m = vertices.centre(cell);
    [
        Cell::quad(a, ab, m, da),
        Cell::quad(ab, b, bc, m),
        Cell::quad(m, bc, c, cd),
        Cell::quad(da, m, cd, d),
    ]
}

/// Parts of a leaf along the middles that its neighbours put on some of its edges; without further vertices. What lies
/// between all others comes last, so that lines tell them apart one after the other.
fn green(cell: Cell, vertices: &Vertices) -> Vec<Cell> {
    let middles: Vec<Option<u32>> = edges(cell)
        .map(|(a, b)| vertices.known_middle(a, b))
        .collect();
    if middles.iter().all(Option::is_none) {
        return Vec::new();
    }
    if cell.count == 3 {
        return split_triangle(cell, &middles, vertices);
    }
    green_quad(cell, &middles)
}

fn green_quad(cell: Cell, middles: &[Option<u32>]) -> Vec<Cell> {
    let count = middles.iter().flatten().count();
    // Turned so that the first edge is halved and, of two neighbours or three, the one before it is not.
    let turn = (0..4)
        .find(|&k| middles[k].is_some() && (middles[(k + 3) % 4].is_none() || count == 4))
        .expect("an edge is halved");
    let [a, b, c, d] = [0, 1, 2, 3].map(|i| cell.corners[(turn + i) % 4]);
    match [0, 1, 2].map(|i| middles[(turn + i) % 4]) {
        [Some(ab), None, None] => vec![
            Cell::triangle(a, ab, d),
            Cell::triangle(ab, b, c),
            Cell::triangle(ab, c, d),
        ],
        [Some(ab), Some(bc), None] => vec![
            Cell::triangle(a, ab, d),
            Cell::triangle(ab, b, bc),
            Cell::triangle(bc, c, d),
            Cell::triangle(ab, bc, d),
        ],
        [Some(ab), None, Some(cd)] => vec![Cell::quad(a, ab, cd, d), Cell::quad(ab, b, c, cd)],
        [Some(ab), Some(bc), Some(cd)] => vec![
            Cell::triangle(ab, b, bc),
            Cell::triangle(bc, c, cd),
            Cell::quad(a, ab, cd, d),
            Cell::triangle(ab, bc, cd),
        ],
        [None, ..] => unreachable!("the first edge is the halved one"),
    }
}
