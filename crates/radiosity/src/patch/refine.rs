//! A posteriori refinement of a mesh: elements are cut further, patches stay.

use crate::error::RadiosityError;
use crate::patch::face::Side;
use crate::patch::red_green::{RedTree, Refinement};
use crate::patch::subdivide::{Cell, Vertices};
use crate::patch::{MAX_ELEMENTS, NodeId, NodeKind, PatchMesh, id32};
use crate::stop::Stop;
use std::collections::HashMap;
use std::sync::Arc;

/// A mesh as it was before any refinement, as far as refinement changes it.
#[derive(Debug)]
pub(super) struct Base {
    nodes: usize,
    vertices: usize,
    elements: Vec<NodeId>,
    elements_of_patch: Vec<core::ops::Range<u32>>,
}

/// Face, side, and corners of an element.
type Shape = (u32, Side, u8, [[u32; 3]; 4]);

/// What a refinement would make of a mesh.
#[derive(Debug, Clone)]
pub struct RefinementPlan {
    /// For [`PatchMesh::with_refinement`].
    pub refinement: Refinement,
    /// Elements that the mesh would have.
    pub elements: usize,
}

impl PatchMesh {
    /// Which elements were cut since the mesh was built.
    pub fn refinement(&self) -> &Refinement {
        &self.refinement
    }

    /// Number of elements before any refinement.
    pub fn unrefined_elements(&self) -> usize {
        self.base
            .as_ref()
            .map_or(self.elements.len(), |base| base.elements.len())
    }

    /// Whether a node was made by refinement.
    pub(crate) fn is_refined(&self, id: NodeId) -> bool {
        self.base
            .as_ref()
            .is_some_and(|base| id.index() >= base.nodes)
    }

    /// How often each element was cut out of one of the mesh before any refinement; transitions between levels count as
    /// the cell that they are parts of.
    pub fn levels(&self) -> Vec<u8> {
        let tree = self.red_tree();
        let levels = tree.leaves().into_iter().map(|leaf| {
            let elements = tree.elements_of_leaf(leaf);
            core::iter::repeat_n(tree.level(leaf), elements)
        });
        levels.flatten().collect()
    }

    /// For each element the position of the same one in another refinement of the mesh, if it is there.
    pub(crate) fn elements_kept_of(&self, other: &Self) -> Vec<Option<u32>> {
        let elements = other.elements.iter().enumerate();
        let known: HashMap<Shape, u32> = elements
            .map(|(e, &id)| (other.shape(id), id32(e)))
            .collect();
        let elements = self.elements.iter();
        elements
            .map(|&id| known.get(&self.shape(id)).copied())
            .collect()
    }

    /// What tells an element from others, whatever refinement it is of.
    fn shape(&self, id: NodeId) -> Shape {
        let NodeKind::Surface { face, side, .. } = self.nodes[id.index()].kind else {
            unreachable!("elements are surfaces")
        };
        let polygon = self.polygon(id);
        let corners = polygon.corners.map(|c| c.to_array().map(f32::to_bits));
        (face, side, polygon.count, corners)
    }

    /// Longest edge of the elements before any refinement.
    pub fn longest_unrefined_edge(&self) -> f32 {
        let tree = self.unrefined_tree();
        let edges = tree
            .leaves()
            .into_iter()
            .map(|leaf| tree.longest_edge(leaf));
        edges.fold(0.0, f32::max)
    }

    /// For each element whether the cell that is cut for it has an edge longer than this.
    pub fn are_longer(&self, smallest: f32) -> Vec<bool> {
        let tree = self.red_tree();
        let leaves = tree.leaves().into_iter().map(|leaf| {
            let elements = tree.elements_of_leaf(leaf);
            core::iter::repeat_n(tree.is_longer(leaf, smallest), elements)
        });
        leaves.flatten().collect()
    }

    /// Cuts marked elements with an edge longer than `smallest` into four, and others until neighbours differ by at most
    /// one level. Where a mark is on a transition between levels, the cell is cut that it is a part of. `None` if no
    /// element is to be cut.
    ///
    /// A plan of more than [`MAX_ELEMENTS`] elements ends somewhere beyond that number.
    ///
    /// # Panics
    /// There is not one mark for each element.
    pub fn plan_refinement(&self, marks: &[bool], smallest: f32) -> Option<RefinementPlan> {
        assert_eq!(
            marks.len(),
            self.elements.len(),
            "one mark for each element"
        );
        let mut tree = self.red_tree();
        let mut rest = marks;
        let mut wanted = tree.leaves();
        wanted.retain(|&leaf| {
            let (own, others) = rest.split_at(tree.elements_of_leaf(leaf));
            rest = others;
            own.contains(&true) && tree.is_longer(leaf, smallest)
        });
        for &leaf in &wanted {
            tree.cut(leaf);
        }
        tree.close(MAX_ELEMENTS);
        let elements = tree
            .leaves()
            .into_iter()
            .map(|leaf| tree.elements_of_leaf(leaf));
        (!wanted.is_empty()).then(|| RefinementPlan {
            refinement: tree.record(),
            elements: elements.sum(),
        })
    }

    /// The mesh with other cuts than those it has: patches are the same ones, and so are elements that are in both. The
    /// same refinement gives the same mesh, whatever was between.
    ///
    /// # Errors
    /// A refinement of another mesh, or of more elements than a mesh may have; [`RadiosityError::Stopped`].
    pub fn with_refinement(
        &self,
        refinement: &Refinement,
        stop: Stop<'_>,
    ) -> Result<Self, RadiosityError> {
        let fail = |why: &str| Err(RadiosityError::Option(format!("its refinement {why}")));
        let Some(mut tree) = self.unrefined_tree().replay(refinement, MAX_ELEMENTS) else {
            return fail("does not fit the mesh");
        };
        // Records of our own are balanced; those of a damaged file may not be.
        tree.close(MAX_ELEMENTS);
        let elements = tree
            .leaves()
            .into_iter()
            .map(|leaf| tree.elements_of_leaf(leaf));
        if elements.sum::<usize>() > MAX_ELEMENTS {
            return fail("has more elements than a mesh may have");
        }
        let mut mesh = self.unrefined();
        mesh.refinement = tree.record();
        mesh.grow_refined(tree);
        let report = mesh.report.clone();
        mesh.finish(stop)
            .ok_or(RadiosityError::Stopped("while the mesh was refined"))?;
        // What was told of materials holds for the cells of the first mesh.
        mesh.report = report;
        Ok(mesh)
    }

    /// Red cells of the mesh as it is.
    fn red_tree(&self) -> RedTree {
        let tree = self
            .unrefined_tree()
            .replay(&self.refinement, usize::MAX / 2);
        tree.expect("the record is of this mesh")
    }

    fn unrefined_tree(&self) -> RedTree {
        let (elements, vertices) = match &self.base {
            Some(base) => (&base.elements, base.vertices),
            None => (&self.elements, self.vertices.len()),
        };
        let cells: Vec<Cell> = elements
            .iter()
            .map(|id| self.nodes[id.index()].cell)
            .collect();
        RedTree::new(&cells, self.vertices[..vertices].to_vec())
    }

    /// A copy without any refinement, but for what [`Self::finish`] makes.
    fn unrefined(&self) -> Self {
        let mut mesh = self.clone();
        let base = mesh.base.get_or_insert_with(|| {
            Arc::new(Base {
                nodes: self.nodes.len(),
                vertices: self.vertices.len(),
                elements: self.elements.clone(),
                elements_of_patch: self.elements_of_patch.clone(),
            })
        });
        let base = base.clone();
        mesh.nodes.truncate(base.nodes);
        for id in &base.elements {
            let node = &mut mesh.nodes[id.index()];
            (node.first_child, node.child_count) = (0, 0);
        }
        mesh.vertices.truncate(base.vertices);
        mesh.hard_edges
            .retain(|&(a, b)| a.max(b) < id32(base.vertices));
        mesh.elements.clear();
        mesh.patch_of_element.clear();
        mesh
    }

    /// Makes the nodes of a tree and the cut of elements through them.
    fn grow_refined(&mut self, tree: RedTree) {
        let base = self
            .base
            .clone()
            .expect("a mesh that is refined knows what it was");
        for (patch, range) in base.elements_of_patch.iter().enumerate() {
            let start = id32(self.elements.len());
            for root in range.start as usize..range.end as usize {
                self.grow_below(base.elements[root], root, &tree);
            }
            let end = id32(self.elements.len());
            self.elements_of_patch[patch] = start..end;
            self.patch_of_element.resize(end as usize, id32(patch));
        }
        self.halve_hard_edges(&tree);
        self.vertices = tree.into_positions();
    }

    /// Makes what is below the node of one of the tree's cells.
    fn grow_below(&mut self, id: NodeId, cell: usize, tree: &RedTree) {
        let parts = tree.parts(cell);
        if parts.is_empty() {
            self.elements.push(id);
            return;
        }
        let first = id32(self.nodes.len());
        let kind = self.node_kind(id);
        for &part in &parts {
            self.push_cell(id, kind, part, tree.vertices());
        }
        let node = &mut self.nodes[id.index()];
        (node.first_child, node.child_count) = (first, id32(parts.len()));
        let children = first..first + id32(parts.len());
        if tree.is_leaf(cell) {
            self.elements.extend(children.map(NodeId));
            return;
        }
        for (child, part) in children.zip(tree.red_children(cell)) {
            self.grow_below(NodeId(child), part, tree);
        }
    }

    /// Both halves of a hard edge are hard.
    fn halve_hard_edges(&mut self, tree: &RedTree) {
        let vertices: &Vertices = tree.vertices();
        let mut open: Vec<(u32, u32)> = self.hard_edges.iter().copied().collect();
        while let Some((a, b)) = open.pop() {
            let Some(middle) = vertices.known_middle(a, b) else {
                continue;
            };
            for half in [(a, middle), (middle, b)] {
                let (a, b) = half;
                self.hard_edges.insert((a.min(b), a.max(b)));
                open.push(half);
            }
        }
    }
}
