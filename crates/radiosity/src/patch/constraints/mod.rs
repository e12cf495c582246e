//! Lines along which elements are cut before any light is known.
//!
//! Faces are cut by the lengths of their edges; here the smallest of those cells are cut once more, where something
//! crosses them: other faces that meet the face (`joints.rs`), vertices of other faces in its edges, and the borders of
//! shadows ([`discontinuities`](super::discontinuities)). A cell that nothing crosses stays the quad that it is, and
//! patches, which are made of whole cells, stay as they are.
//!
//! 1. Points are gathered on the edges of cells (`edges.rs`); both cells along an edge get the same ones, so no crack
//!    opens and no vertex hangs.
//! 2. Inside each cell, segments snap to points that are near and are cut where they cross (`arrangement.rs`).
//! 3. A constrained Delaunay triangulation fills the cell, pairs of triangles become quads (`triangulate.rs`).
//!
//! A line may be moved by a hundredth of a cell's size to the next point or edge, so that rounding and lines that nearly
//! agree make no slivers.
//!
//! Joints are on by default: they add 7 % to the elements of the Cornell box and 10 % to those of two rooms, at most a
//! quarter in scenes of much furniture, and little to the time of a mesh (153,590 faces of the theatre: 3.8 to 4.8 s in a
//! build for tests). A closed room with a sunk block, whose light is known, loses 0.59 % of it instead of 0.73 %.

mod arrangement;
mod edges;
pub(super) mod joints;
mod leaves;
pub(super) mod plane;
mod triangulate;

use self::edges::{Edge, EdgePoints, edge};
use self::joints::Joints;
use self::plane::Line;
use super::face::WorldFace;
use super::sizes::Sizes;
use super::subdivide::{Cell, Vertices, any_edge_longer};
use super::{NodeId, NodeKind, PatchMesh};
use crate::stop::Stop;
use glam::Vec3;
use rayon::prelude::*;
use serde::Serialize;
use std::collections::{BTreeMap, HashMap};

/// Faces without an edge longer than this share of an element's size are not cut where others meet them.
const LEAST_FACE: f32 = 0.5;

/// What cut the elements of a mesh.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
pub struct CutCounts {
    /// Segments along which faces meet.
    pub joints: usize,
    /// Segments of shadow borders.
    pub shadow_lines: usize,
    /// Points on edges of cells, from lines that cross them and from vertices of other faces.
    pub edge_points: usize,
    /// Cells that were cut.
    pub cells: usize,
    /// Elements that they became.
    pub elements: usize,
    /// Faces or cells of which some segments do not cut, because there are too many.
    pub crowded: usize,
}

impl PatchMesh {
    /// For each face the lines along which its cells are to be cut; none if it was stopped.
    pub(super) fn lines(&mut self, sizes: Sizes, stop: Stop<'_>) -> Option<Vec<Vec<Line>>> {
        let mut lines = vec![Vec::new(); self.faces.len()];
        if self.options.joints {
            lines = self.joints(sizes, stop)?;
            self.cuts.joints = lines.iter().map(Vec::len).sum();
        }
        if self.options.discontinuities {
            self.add_shadow_lines(&mut lines, sizes, stop)?;
        }
        Some(lines)
    }

    /// The segments along which faces meet.
    fn joints(&mut self, sizes: Sizes, stop: Stop<'_>) -> Option<Vec<Vec<Line>>> {
        let sides = |face: &WorldFace| self.scene.materials[face.material as usize].lit_sides();
        let lit_sides: Vec<usize> = self.faces.iter().map(sides).collect();
        let is_worth_it = |face: usize| lit_sides[face] > 0 && self.is_large(face, sizes);
        let joints = Joints::new(
            &self.faces,
            lit_sides.clone(),
            self.tolerance(),
            f64::from(sizes.element),
        );
        let faces = (0..self.faces.len()).into_par_iter();
        let found: Option<Vec<(Vec<Line>, bool)>> = faces
            .map(|face| {
                (!stop()).then(|| {
                    if !is_worth_it(face) {
                        return (Vec::new(), false);
                    }
                    let (segments, is_crowded) = joints.of_face(face);
                    let lines = segments.into_iter().map(|ends| Line { ends, jumps: true });
                    (lines.collect(), is_crowded)
                })
            })
            .collect();
        let (lines, crowded): (Vec<_>, Vec<_>) = found?.into_iter().unzip();
        self.cuts.crowded += crowded.into_iter().filter(|&is_crowded| is_crowded).count();
        Some(lines)
    }

    /// One line about segments that were left out.
    fn warn_of_crowds(&mut self) {
        let crowded = self.cuts.crowded;
        if crowded > 0 {
            let what = format!(
                "{} met by so many edges of others that some of those do not cut elements; light may leak there, smaller \
                 elements help",
                match crowded {
                    1 => String::from("1 face or cell is"),
                    _ => format!("{crowded} faces or cells are"),
                }
            );
            self.report.warn("cuts", what);
        }
    }

    /// Whether a face is so large that cutting it makes elements of about the size that was asked for.
    pub(super) fn is_large(&self, face: usize, sizes: Sizes) -> bool {
        any_edge_longer(self.faces[face].polygon(), LEAST_FACE * sizes.element)
    }

    /// Distance below which things touch: as close as rays can tell.
    pub(super) fn tolerance(&self) -> f64 {
        let corners = self.faces.iter().flat_map(WorldFace::polygon);
        let reach = corners.fold(Vec3::ZERO, |reach, p| reach.max(p.abs()));
        f64::from(self.visibility.offset(reach))
    }

    /// Cuts the smallest cells along lines, of which each face has a list, and in vertices of other faces; none if it
    /// was stopped.
    pub(super) fn cut_cells(
        &mut self,
        lines: &[Vec<Line>],
        vertices: &mut Vertices,
        stop: Stop<'_>,
    ) -> Option<()> {
        let (mut edges, twins) = EdgePoints::new(&self.outlines(), vertices, self.tolerance());
        self.replace_vertices(&twins);
        let (crossed, crowded) = leaves::crossed(self, lines, &mut edges, vertices);
        self.cuts.crowded += crowded;
        self.warn_of_crowds();
        if crossed.is_empty() && edges.is_empty() {
            return Some(());
        }
        let leaves = self.leaves_to_cut(crossed, &edges);
        let cuts: Option<Vec<leaves::Cut>> = leaves
            .par_iter()
            .map(|(id, lines)| {
                (!stop()).then(|| leaves::cut(self, *id, lines, &edges, &vertices.positions))
            })
            .collect();
        let before = self.nodes.len();
        for ((leaf, _), cut) in leaves.iter().zip(cuts?) {
            self.push_cut(*leaf, cut, vertices);
        }
        self.cuts.edge_points = edges.count();
        self.cuts.elements = self.nodes.len() - before;
        Some(())
    }

    /// Puts other vertices in the place of some.
    fn replace_vertices(&mut self, twins: &HashMap<u32, u32>) {
        if twins.is_empty() {
            return;
        }
        for node in &mut self.nodes {
            let corners = node.cell.corners;
            node.cell.corners = corners.map(|v| *twins.get(&v).unwrap_or(&v));
        }
    }

    /// The edges of all lit faces, each once.
    fn outlines(&self) -> Vec<Edge> {
        let mut outlines: Vec<Edge> = Vec::new();
        for &root in self.roots.iter().flatten().flatten() {
            let corners = self.corners(root);
            let n = corners.len();
            outlines.extend((0..n).map(|i| edge(corners[i], corners[(i + 1) % n])));
        }
        outlines.par_sort_unstable();
        outlines.dedup();
        outlines
    }

    /// The cells without children that lines cross or that have points on edges, in the order of their ids.
    fn leaves_to_cut(
        &self,
        crossed: Vec<(NodeId, Vec<Line>)>,
        edges: &EdgePoints,
    ) -> Vec<(NodeId, Vec<Line>)> {
        let mut lines_of: BTreeMap<NodeId, Vec<Line>> = crossed.into_iter().collect();
        if !edges.is_empty() {
            let has_points = |id: &NodeId| {
                let corners = self.corners(*id);
                let n = corners.len();
                (0..n).any(|i| !edges.between(corners[i], corners[(i + 1) % n]).is_empty())
            };
            let ids = (0..self.nodes.len()).map(|i| NodeId(crate::index32(i)));
            let is_leaf = |id: &NodeId| {
                let node = self.node(*id);
                matches!(node.kind, NodeKind::Surface { .. }) && node.child_count == 0
            };
            let with_points: Vec<NodeId> = ids.filter(|id| is_leaf(id) && has_points(id)).collect();
            for id in with_points {
                lines_of.entry(id).or_default();
            }
        }
        lines_of.into_iter().collect()
    }

    /// Hangs the parts of a cell below it.
    fn push_cut(&mut self, leaf: NodeId, cut: leaves::Cut, vertices: &mut Vertices) {
        let mut ids = cut.outline;
        ids.extend(cut.inner.into_iter().map(|p| vertices.push(p)));
        let jumps = cut.jumps.iter().map(|&[a, b]| edge(ids[a], ids[b]));
        self.hard_edges.extend(jumps);
        if cut.cells.is_empty() {
            return;
        }
        self.cuts.cells += 1;
        let first_child = crate::index32(self.nodes.len());
        let kind = self.node_kind(leaf);
        for corners in &cut.cells {
            let corner = |i: usize| ids[corners[i]];
            let cell = match corners.len() {
                3 => Cell::triangle(corner(0), corner(1), corner(2)),
                _ => Cell::quad(corner(0), corner(1), corner(2), corner(3)),
            };
            self.push_cell(leaf, kind, cell, vertices);
        }
        let node = &mut self.nodes[leaf.index()];
        node.first_child = first_child;
        node.child_count = crate::index32(cut.cells.len());
        node.is_cut = true;
    }
}
