//! Growth of the forest: clusters, surfaces, and the cells below them.

use crate::patch::constraints::CutCounts;
use crate::patch::face::{Side, newell_normal};
use crate::patch::sizes::Sizes;
use crate::patch::subdivide::{Cell, Vertices, any_edge_longer, split};
use crate::patch::{Node, NodeId, NodeKind, PatchMesh, id32, to_f32};
use crate::stop::Stop;
use glam::Vec3;
use hemicube_scene::ImportReport;

/// Meshes that are made at most until one has as many elements as wanted; the second does it mostly.
const MOST_TRIALS: u32 = 4;

impl PatchMesh {
    /// Makes clusters, surfaces and everything below, of other sizes if what cuts elements makes too many of them; none if
    /// it was stopped.
    pub(super) fn grow_to_count(&mut self, mut sizes: Sizes, stop: Stop<'_>) -> Option<()> {
        let report = self.report.clone();
        for _ in 1..MOST_TRIALS {
            self.grow(sizes, stop)?;
            let elements = self.elements.len();
            match sizes.corrected(&self.scene, &self.faces, self.options, elements) {
                None => return Some(()),
                Some(others) => sizes = others,
            }
            self.fell(&report);
        }
        self.grow(sizes, stop)
    }

    /// Takes away what [`Self::grow`] has made.
    fn fell(&mut self, report: &ImportReport) {
        self.roots.fill([None; 2]);
        self.obstructions.clear();
        self.nodes.clear();
        self.patches.clear();
        self.elements.clear();
        self.patch_of_element.clear();
        self.elements_of_patch.clear();
        self.hard_edges.clear();
        self.cuts = CutCounts::default();
        self.report = report.clone();
    }

    /// Makes clusters, surfaces and everything below, and lists the cuts; none if it was stopped.
    pub(super) fn grow(&mut self, sizes: Sizes, stop: Stop<'_>) -> Option<()> {
        let mut vertices = Vertices::default();
        let mut first = 0;
        while first < self.faces.len() {
            let instance = self.faces[first].instance;
            let end = first
                + self.faces[first..]
                    .iter()
                    .take_while(|f| f.instance == instance)
                    .count();
            self.grow_cluster(instance, first..end, sizes, &mut vertices, stop)?;
            first = end;
        }
        if self.options.joints || self.options.discontinuities {
            let lines = self.lines(sizes, stop)?;
            self.cut_cells(&lines, &mut vertices, stop)?;
        }
        self.vertices = vertices.positions;
        self.list_cuts(sizes);
        // Arrays that doubled hold up to twice what they need, and stay as long as the mesh.
        self.vertices.shrink_to_fit();
        self.nodes.shrink_to_fit();
        self.elements.shrink_to_fit();
        self.patch_of_element.shrink_to_fit();
        Some(())
    }

    fn grow_cluster(
        &mut self,
        instance: u32,
        faces: core::ops::Range<usize>,
        sizes: Sizes,
        vertices: &mut Vertices,
        stop: Stop<'_>,
    ) -> Option<()> {
        let material = |face: usize| &self.scene.materials[self.faces[face].material as usize];
        if faces.clone().all(|face| material(face).lit_sides() == 0) {
            for face in faces {
                let cell = cell_of(self.faces[face].polygon(), vertices);
                self.obstructions.push((id32(face), cell));
            }
            return Some(());
        }
        let cluster = NodeId(id32(self.nodes.len()));
        let blank = Node {
            parent: None,
            first_child: cluster.0 + 1,
            child_count: 0,
            kind: NodeKind::Cluster { instance },
            cell: Cell {
                corners: [0; 4],
                count: 0,
            },
            is_cut: false,
            area: 0.0,
            centroid: Vec3::ZERO,
            normal: Vec3::ZERO,
        };
        self.nodes.push(blank);
        // Children of a node are consecutive, so all surfaces come before anything below them.
        for face in faces.clone() {
            let lit = self.scene.materials[self.faces[face].material as usize].lit_sides();
            for &side in &[Side::Front, Side::Back][..lit] {
                self.push_surface(cluster, face, side, vertices);
            }
        }
        let surfaces = cluster.0 + 1..id32(self.nodes.len());
        for surface in surfaces.clone() {
            if stop() {
                return None;
            }
            self.subdivide_surface(NodeId(surface), sizes, vertices);
        }
        let below = &self.nodes[surfaces.start as usize..surfaces.end as usize];
        let area: f64 = below.iter().map(|n| f64::from(n.area)).sum();
        let weighted: Vec3 = below.iter().map(|n| n.centroid * n.area).sum();
        let node = &mut self.nodes[cluster.index()];
        node.child_count = surfaces.end - surfaces.start;
        node.area = to_f32(area);
        node.centroid = weighted / node.area;
        Some(())
    }

    fn push_surface(&mut self, cluster: NodeId, face: usize, side: Side, vertices: &mut Vertices) {
        let mut polygon = self.faces[face].polygon().to_vec();
        if side == Side::Back {
            polygon.reverse();
        }
        let cell = cell_of(&polygon, vertices);
        let id = self.push_cell(
            cluster,
            NodeKind::Surface {
                face: id32(face),
                side,
            },
            cell,
            vertices,
        );
        self.roots[face][side as usize] = Some(id);
    }

    pub(super) fn push_cell(
        &mut self,
        parent: NodeId,
        kind: NodeKind,
        cell: Cell,
        vertices: &Vertices,
    ) -> NodeId {
        let polygon: Vec<Vec3> = cell
            .corners()
            .iter()
            .map(|&c| vertices.positions[c as usize])
            .collect();
        let doubled = newell_normal(&polygon);
        // Parts of a face share its plane; slivers would lose the direction of their own.
        let normal = match (kind, self.node_kind(parent)) {
            (_, NodeKind::Surface { .. }) => self.nodes[parent.index()].normal,
            _ => doubled.normalize_or_zero(),
        };
        let node = Node {
            parent: Some(parent),
            first_child: 0,
            child_count: 0,
            kind,
            cell,
            is_cut: false,
            area: 0.5 * doubled.dot(normal).max(0.0),
            centroid: polygon.iter().sum::<Vec3>() / f32::from(cell.count),
            normal,
        };
        self.nodes.push(node);
        NodeId(id32(self.nodes.len() - 1))
    }

    pub(super) fn node_kind(&self, id: NodeId) -> NodeKind {
        self.nodes[id.index()].kind
    }

    /// Cuts a surface until no edge is too long.
    fn subdivide_surface(&mut self, surface: NodeId, sizes: Sizes, vertices: &mut Vertices) {
        let mut stack = vec![surface];
        while let Some(id) = stack.pop() {
            let node = &self.nodes[id.index()];
            let (cell, kind) = (node.cell, node.kind);
            let cells = split(cell, sizes.size(), vertices);
            if cells.is_empty() {
                continue;
            }
            let first_child = id32(self.nodes.len());
            for &child in &cells {
                let child = self.push_cell(id, kind, child, vertices);
                stack.push(child);
            }
            self.nodes[id.index()].first_child = first_child;
            self.nodes[id.index()].child_count = id32(cells.len());
        }
    }

    /// Lists the two cuts through the forest.
    pub(super) fn list_cuts(&mut self, sizes: Sizes) {
        for face in 0..self.faces.len() {
            let patch_size = sizes.patch_size(&self.scene, &self.faces[face]);
            for root in self.roots[face].into_iter().flatten() {
                self.list_cuts_of(root, patch_size);
            }
        }
    }

    fn list_cuts_of(&mut self, surface: NodeId, patch_size: f32) {
        // Depth first, so that the elements below one patch are consecutive.
        let mut stack = vec![(surface, None)];
        while let Some((id, patch)) = stack.pop() {
            let node = &self.nodes[id.index()];
            let (is_element, is_whole) = (node.child_count == 0, node.is_cut);
            let starts_patch = patch.is_none()
                && (is_element || is_whole || !any_edge_longer(&self.polygon(id), patch_size));
            let patch = if starts_patch {
                self.patches.push(id);
                let start = id32(self.elements.len());
                self.elements_of_patch.push(start..start);
                Some(id32(self.patches.len() - 1))
            } else {
                patch
            };
            if is_element {
                let patch = patch.expect("an element lies below a patch");
                self.elements.push(id);
                self.patch_of_element.push(patch);
                self.elements_of_patch[patch as usize].end = id32(self.elements.len());
            }
            stack.extend(self.children(id).map(|child| (child, patch)));
        }
    }
}

/// The vertices of a face.
fn cell_of(polygon: &[Vec3], vertices: &mut Vertices) -> Cell {
    let mut at = |i: usize| vertices.at(polygon[i]);
    match polygon.len() {
        3 => Cell::triangle(at(0), at(1), at(2)),
        4 => Cell::quad(at(0), at(1), at(2), at(3)),
        _ => unreachable!("a face has three or four corners"),
    }
}
