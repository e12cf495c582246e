//! The hierarchy: elements under the cells of their face, faces under clusters.
//!
//! Cells are those of the [`PatchMesh`]. Above faces stands a binary tree that is cut, from the top down, where the
//! boxes of both halves have the least surface times faces (the surface area heuristic; Goldsmith, Salmon 1987), between
//! one of sixteen bins and the next (Wald 2007).
//!
//! Nodes are numbered depth first. A node is followed by all that lies below it, so every subtree is a range, and what is
//! summed upwards or pushed downwards is a loop.

use crate::patch::{NodeId, NodeKind, PatchMesh};
use core::ops::Range;
use glam::Vec3;

/// Bins of a cut.
const BINS: usize = 16;
/// Cuts by the heuristic; below, halves have the same number of faces, so that no scene makes a list of the tree.
const MOST_CUTS: u32 = 48;

/// What a node is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Shape {
    /// A face or a part of one.
    Cell(NodeId),
    /// Several faces; clusters are numbered in the order of the nodes.
    Cluster(u32),
}

/// A face, a part of one, or a cluster of faces.
#[derive(Debug, Clone, Copy)]
pub(super) struct Node {
    pub(super) shape: Shape,
    /// Nodes of the subtree, itself included.
    size: u32,
    /// The element, of leaves.
    pub(super) element: Option<u32>,
    /// Its elements, in the order of the leaves.
    first_leaf: u32,
    leaf_count: u32,
    /// Mean of the elements' centres by their exposed areas.
    pub(super) centre: Vec3,
    /// Unit normal; zero of clusters.
    pub(super) normal: Vec3,
    /// Radius around the centre that holds everything.
    pub(super) radius: f32,
    /// Root mean square distance from the centre.
    pub(super) deviation: f32,
    /// Exposed area.
    pub(super) area: f32,
    /// Whether all of it is exposed, which is said of cells only.
    pub(super) is_whole: bool,
}

impl Node {
    pub(super) fn is_cluster(&self) -> bool {
        matches!(self.shape, Shape::Cluster(_))
    }
}

/// All nodes; the root is the first.
#[derive(Debug)]
pub(super) struct Hierarchy {
    nodes: Vec<Node>,
    /// Elements in the order of the leaves, and running sums of their exposed areas, from 0.
    leaves: Vec<u32>,
    areas: Vec<f64>,
    clusters: usize,
}

/// A face with exposed elements, on its way into the tree.
struct Face {
    root: NodeId,
    bounds: Bounds,
}

/// An axis-aligned box.
#[derive(Debug, Clone, Copy)]
struct Bounds {
    low: Vec3,
    high: Vec3,
}

impl Bounds {
    const EMPTY: Self = Self {
        low: Vec3::INFINITY,
        high: Vec3::NEG_INFINITY,
    };

    fn with(self, point: Vec3) -> Self {
        Self {
            low: self.low.min(point),
            high: self.high.max(point),
        }
    }

    fn union(self, other: Self) -> Self {
        Self {
            low: self.low.min(other.low),
            high: self.high.max(other.high),
        }
    }

    fn centre(&self) -> Vec3 {
        (self.low + self.high) * 0.5
    }

    fn surface(&self) -> f32 {
        let size = (self.high - self.low).max(Vec3::ZERO);
        size.x * size.y + size.y * size.z + size.z * size.x
    }
}

impl Hierarchy {
    /// Over all elements with an exposed area; `None` if there are none.
    pub(super) fn new(mesh: &PatchMesh) -> Option<Self> {
        let mut faces = faces_of(mesh);
        if faces.is_empty() {
            return None;
        }
        let mut tree = Self {
            nodes: Vec::with_capacity(2 * mesh.elements().len()),
            leaves: Vec::with_capacity(mesh.elements().len()),
            areas: vec![0.0],
            clusters: 0,
        };
        tree.push_faces(mesh, &mut faces, 0);
        Some(tree)
    }

    /// The number of nodes.
    pub(super) fn len(&self) -> usize {
        self.nodes.len()
    }

    /// The number of clusters.
    pub(super) fn clusters(&self) -> usize {
        self.clusters
    }

    pub(super) fn node(&self, node: u32) -> &Node {
        &self.nodes[node as usize]
    }

    pub(super) fn nodes(&self) -> &[Node] {
        &self.nodes
    }

    /// A node and everything below it.
    pub(super) fn subtree(&self, node: u32) -> Range<usize> {
        node as usize..node as usize + self.node(node).size as usize
    }

    /// The nodes right below a node.
    pub(super) fn children(&self, node: u32) -> impl Iterator<Item = u32> + '_ {
        let end = node + self.node(node).size;
        let first = (node + 1 < end).then_some(node + 1);
        core::iter::successors(first, move |&child| {
            let next = child + self.node(child).size;
            (next < end).then_some(next)
        })
    }

    /// Elements below a node.
    #[cfg(test)]
    fn elements(&self, node: u32) -> &[u32] {
        let node = self.node(node);
        &self.leaves[node.first_leaf as usize..(node.first_leaf + node.leaf_count) as usize]
    }

    /// The element below a node at a share of its exposed area, and how much of that element lies before it, in [0, 1).
    pub(super) fn element_at(&self, node: u32, share: f32) -> (usize, f32) {
        let node = self.node(node);
        let first = node.first_leaf as usize;
        let sums = &self.areas[first..=first + node.leaf_count as usize];
        let last = sums.len() - 2;
        let wanted = sums[0] + f64::from(share) * (sums[last + 1] - sums[0]);
        let at = sums[1..].partition_point(|&sum| sum <= wanted).min(last);
        let within = (wanted - sums[at]) / (sums[at + 1] - sums[at]).max(f64::MIN_POSITIVE);
        let within = super::to_f32(within).clamp(0.0, 0.999_999);
        (self.leaves[first + at] as usize, within)
    }

    /// Adds a cluster of faces, or the cells of a single one.
    fn push_faces(&mut self, mesh: &PatchMesh, faces: &mut [Face], depth: u32) {
        if let [face] = faces {
            self.push_cells(mesh, face.root);
            return;
        }
        let cluster = crate::index32(self.clusters);
        self.clusters += 1;
        let at = self.open(Shape::Cluster(cluster), Vec3::ZERO);
        let middle = cut(faces, depth);
        let (left, right) = faces.split_at_mut(middle);
        self.push_faces(mesh, left, depth + 1);
        self.push_faces(mesh, right, depth + 1);
        self.close(at);
    }

    /// Adds a cell and those below it that have exposed elements.
    fn push_cells(&mut self, mesh: &PatchMesh, id: NodeId) {
        let node = mesh.node(id);
        let at = self.open(Shape::Cell(id), node.normal);
        if let Some(element) = mesh.element_of_node(id) {
            let area = mesh.exposed_area(element);
            self.leaves.push(crate::index32(element));
            let sum = self.areas[self.areas.len() - 1] + f64::from(area);
            self.areas.push(sum);
            let corners = mesh.polygon(id);
            let squares = corners.iter().map(|c| c.distance_squared(node.centroid));
            let radius = squares.fold(0.0, f32::max).sqrt();
            let leaf = &mut self.nodes[at];
            leaf.element = Some(crate::index32(element));
            leaf.size = 1;
            leaf.leaf_count = 1;
            leaf.centre = node.centroid;
            leaf.radius = radius;
            // Of a square.
            leaf.deviation = radius / 3.0_f32.sqrt();
            leaf.area = area;
            leaf.is_whole = area == node.area;
            return;
        }
        for child in mesh.children(id) {
            if is_exposed(mesh, child) {
                self.push_cells(mesh, child);
            }
        }
        self.close(at);
        let whole = &mut self.nodes[at];
        whole.is_whole = (whole.area - node.area).abs() <= 1e-4 * node.area;
    }

    /// Begins a node; what is below it comes next.
    fn open(&mut self, shape: Shape, normal: Vec3) -> usize {
        self.nodes.push(Node {
            shape,
            size: 0,
            element: None,
            first_leaf: crate::index32(self.leaves.len()),
            leaf_count: 0,
            centre: Vec3::ZERO,
            normal,
            radius: 0.0,
            deviation: 0.0,
            area: 0.0,
            is_whole: false,
        });
        self.nodes.len() - 1
    }

    /// Ends a node: it is what its children are.
    fn close(&mut self, at: usize) {
        let id = crate::index32(at);
        self.nodes[at].size = crate::index32(self.nodes.len() - at);
        let children: Vec<Node> = self.children(id).map(|child| *self.node(child)).collect();
        let area: f32 = children.iter().map(|c| c.area).sum();
        let centre = children.iter().map(|c| c.centre * c.area).sum::<Vec3>() / area;
        let reach = children
            .iter()
            .map(|c| c.centre.distance(centre) + c.radius);
        let squares: f32 = children
            .iter()
            .map(|c| c.area * (c.centre.distance_squared(centre) + c.deviation * c.deviation))
            .sum();
        let leaves = crate::index32(self.leaves.len());
        let node = &mut self.nodes[at];
        node.leaf_count = leaves - node.first_leaf;
        node.area = area;
        node.centre = centre;
        node.radius = reach.fold(0.0, f32::max);
        node.deviation = (squares / area).sqrt();
    }
}

/// Whether anything of a cell is exposed.
fn is_exposed(mesh: &PatchMesh, id: NodeId) -> bool {
    match mesh.element_of_node(id) {
        Some(element) => mesh.exposed_area(element) > 0.0,
        None => mesh.children(id).any(|child| is_exposed(mesh, child)),
    }
}

/// The lit sides of faces with something exposed, in the order of the mesh.
fn faces_of(mesh: &PatchMesh) -> Vec<Face> {
    let is_cluster = |id: NodeId| matches!(mesh.node(id).kind, NodeKind::Cluster { .. });
    let ids = (0..mesh.nodes().len()).map(|i| NodeId(crate::index32(i)));
    let roots = ids.filter(|&id| mesh.node(id).parent.is_some_and(is_cluster));
    roots
        .filter(|&root| is_exposed(mesh, root))
        .map(|root| Face {
            root,
            bounds: mesh
                .polygon(root)
                .iter()
                .fold(Bounds::EMPTY, |bounds, &corner| bounds.with(corner)),
        })
        .collect()
}

/// Sorts faces into two parts, and tells how many are in the first.
fn cut(faces: &mut [Face], depth: u32) -> usize {
    let centres = faces.iter().fold(Bounds::EMPTY, |bounds, face| {
        bounds.with(face.bounds.centre())
    });
    let size = centres.high - centres.low;
    let axis = size.max_position();
    let half = faces.len() / 2;
    if size[axis] > 0.0 && depth < MOST_CUTS {
        let scale = BINS as f32 / size[axis];
        let bin = |face: &Face| bin_of((face.bounds.centre()[axis] - centres.low[axis]) * scale);
        if let Some(first) = best_bin(faces, bin) {
            // Stable, so that the order of the mesh decides where nothing else does.
            faces.sort_by_key(|face| bin(face) >= first);
            return faces.partition_point(|face| bin(face) < first);
        }
    }
    faces.sort_by(|a, b| {
        let [a, b] = [a, b].map(|face| face.bounds.centre()[axis]);
        a.total_cmp(&b)
    });
    half
}

/// The first bin of the second part, where the heuristic is least.
fn best_bin(faces: &[Face], bin: impl Fn(&Face) -> usize) -> Option<usize> {
    let mut bins = [(Bounds::EMPTY, 0_usize); BINS];
    for face in faces {
        let (bounds, count) = &mut bins[bin(face)];
        *bounds = bounds.union(face.bounds);
        *count += 1;
    }
    let join = |(a, n): (Bounds, usize), (b, m): (Bounds, usize)| (a.union(b), n + m);
    let cost = |first: usize| {
        let nothing = (Bounds::EMPTY, 0);
        let [left, right] =
            [&bins[..first], &bins[first..]].map(|part| part.iter().copied().fold(nothing, join));
        let is_cut = left.1 > 0 && right.1 > 0;
        let cost = left.0.surface() * left.1 as f32 + right.0.surface() * right.1 as f32;
        is_cut.then_some((cost, first))
    };
    let costs = (1..BINS).filter_map(cost);
    costs
        .min_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, first)| first)
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a cast of floats stops at the ends of the range"
)]
fn bin_of(position: f32) -> usize {
    (position as usize).min(BINS - 1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::patch::PatchOptions;
    use hemicube_scene::builtin;
    use std::sync::Arc;

    fn mesh(name: &str, elements: usize) -> PatchMesh {
        let scene = Arc::new(builtin::scene(name).expect("it is built in"));
        let options = PatchOptions::default().with_elements(elements);
        PatchMesh::build(scene, options).expect("a mesh")
    }

    #[test]
    fn every_element_has_one_leaf_and_parents_are_the_sum_of_their_children() {
        for name in ["cornell", "conference-room"] {
            let mesh = mesh(name, 2000);
            let tree = Hierarchy::new(&mesh).expect("it has elements");
            let mut leaves: Vec<u32> = tree.elements(0).to_vec();
            leaves.sort_unstable();
            let exposed = (0..mesh.elements().len()).filter(|&e| mesh.exposed_area(e) > 0.0);
            let exposed: Vec<u32> = exposed.map(crate::index32).collect();
            assert_eq!(leaves, exposed, "{name}: elements of the root");
            for id in 0..crate::index32(tree.len()) {
                let node = tree.node(id);
                if node.element.is_some() {
                    assert_eq!(tree.children(id).count(), 0, "{name}: leaf {id}");
                    continue;
                }
                let area: f32 = tree.children(id).map(|c| tree.node(c).area).sum();
                assert_eq!(node.area, area, "{name}: area of node {id}");
                for child in tree.children(id) {
                    let below = tree.node(child);
                    let reach = node.centre.distance(below.centre) + below.radius;
                    assert!(reach <= node.radius * 1.0001, "{name}: {child} in {id}");
                    let (all, part) = (tree.subtree(id), tree.subtree(child));
                    assert!(
                        all.start < part.start && part.end <= all.end,
                        "{name}: {part:?} in {all:?}"
                    );
                }
            }
        }
    }

    #[test]
    fn shares_of_the_area_find_elements_by_their_areas() {
        let mesh = mesh("cornell", 500);
        let tree = Hierarchy::new(&mesh).expect("it has elements");
        let mut sum = 0.0;
        for &element in tree.elements(0) {
            let area = f64::from(mesh.exposed_area(element as usize));
            let middle = super::super::to_f32((sum + 0.5 * area) / f64::from(tree.node(0).area));
            let (found, within) = tree.element_at(0, middle);
            assert_eq!(found, element as usize, "at {middle}");
            assert!((within - 0.5).abs() < 0.1, "{within} of it lies before");
            sum += area;
        }
    }
}
