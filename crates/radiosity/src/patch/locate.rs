//! Which part of a face a point lies in: down the forest, by the lines that cut each cell.
//!
//! [`split`](super::subdivide::split) cuts cells along lines between the vertices of its first cells, so one to three of
//! them decide between the parts. They are kept apart from the nodes, a cache line for each cut, since a ray that arrives
//! at a wall of thousands of patches reads one for every level. Fans around a centre and cells that were cut along lines,
//! which are rare, are compared child by child.

use super::face::Side;
use super::{NONE, NodeId, PatchMesh};
use glam::{Vec3, Vec4};

/// Where the walk goes on: tagged in its highest bits.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Way(u32);

const TAG: u32 = 3 << 30;
const CUT: u32 = 0;
const PATCH: u32 = 1 << 30;
const ELEMENT: u32 = 2 << 30;
const NOWHERE: Way = Way(u32::MAX);

/// A cell that is cut into parts.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(64))]
struct Cut {
    /// Planes through the cutting lines: normal, and minus the distance from the origin.
    lines: [Vec4; 3],
    /// By the number that [`Cut::part`] gives.
    parts: [Way; 4],
}

/// How the lines decide.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    /// The first line, and on its far side the second, and so on.
    Chain,
    /// Two lines that cross.
    Cross,
    /// No lines: a fan, of the node that stands in place of the first part. The second part is where its ways begin.
    Fan,
}

/// Finds parts of faces.
#[derive(Debug, Clone, Default)]
pub(super) struct Locator {
    cuts: Vec<Cut>,
    kinds: Vec<Kind>,
    /// For each face's front and back.
    roots: Vec<[Way; 2]>,
    /// From each patch to its elements.
    patches: Vec<Way>,
    /// Cuts of the children of fans, each fan's in their order.
    fans: Vec<Way>,
}

impl Cut {
    /// Which part a point is in.
    #[inline]
    fn part(&self, kind: Kind, point: Vec4) -> usize {
        let beyond = |line: usize| self.lines[line].dot(point) < 0.0;
        match kind {
            Kind::Cross => match (beyond(0), beyond(1)) {
                (false, false) => 0,
                (true, false) => 1,
                (true, true) => 2,
                (false, true) => 3,
            },
            _ => (0..3).find(|&line| !beyond(line)).unwrap_or(3),
        }
    }
}

impl Locator {
    pub(super) fn new(mesh: &PatchMesh) -> Self {
        let mut locator = Self {
            patches: vec![NOWHERE; mesh.patches.len()],
            ..Self::default()
        };
        for roots in &mesh.roots {
            let ways = roots.map(|root| root.map_or(NOWHERE, |root| locator.way_to(mesh, root)));
            locator.roots.push(ways);
        }
        locator.cuts.shrink_to_fit();
        locator
    }

    /// The way to a node, with all that lies below it.
    fn way_to(&mut self, mesh: &PatchMesh, id: NodeId) -> Way {
        let patch = mesh.patch_of_node[id.index()];
        if patch == NONE {
            return self.way_below(mesh, id);
        }
        let below = self.way_below(mesh, id);
        self.patches[patch as usize] = below;
        Way(PATCH | patch)
    }

    fn way_below(&mut self, mesh: &PatchMesh, id: NodeId) -> Way {
        let element = mesh.element_of_node[id.index()];
        if element != NONE {
            return Way(ELEMENT | element);
        }
        let (kind, lines) = if mesh.node(id).is_cut {
            (Kind::Fan, [Vec4::ZERO; 3])
        } else {
            lines_of(mesh, id)
        };
        let index = self.cuts.len();
        self.cuts.push(Cut {
            lines,
            parts: [NOWHERE; 4],
        });
        self.kinds.push(kind);
        if kind == Kind::Fan {
            let ways: Vec<Way> = mesh
                .children(id)
                .map(|child| self.way_to(mesh, child))
                .collect();
            let start = crate::index32(self.fans.len());
            self.fans.extend(ways);
            self.cuts[index].parts = [Way(id.0), Way(start), NOWHERE, NOWHERE];
        } else {
            for (i, child) in mesh.children(id).enumerate() {
                let way = self.way_to(mesh, child);
                // A line that is not there leaves everything on its near side.
                self.cuts[index].parts[i] = way;
            }
        }
        Way(CUT | crate::index32(index))
    }

    /// Walks until it meets something with this tag.
    #[inline]
    fn walk(&self, mesh: &PatchMesh, mut way: Way, tag: u32, point: Vec3) -> Option<usize> {
        let homogeneous = point.extend(1.0);
        loop {
            if way == NOWHERE {
                return None;
            }
            let index = (way.0 & !TAG) as usize;
            way = match way.0 & TAG {
                found if found == tag => return Some(index),
                PATCH => self.patches[index],
                _ => {
                    let (cut, kind) = (&self.cuts[index], self.kinds[index]);
                    if kind == Kind::Fan {
                        let child = mesh.deepest_child(NodeId(cut.parts[0].0), point);
                        self.fans[cut.parts[1].0 as usize + child]
                    } else {
                        cut.parts[cut.part(kind, homogeneous)]
                    }
                }
            };
        }
    }
}

/// The lines that tell a node's children apart.
fn lines_of(mesh: &PatchMesh, id: NodeId) -> (Kind, [Vec4; 3]) {
    let node = &mesh.nodes[id.index()];
    let cells: Vec<_> = mesh
        .children(id)
        .map(|c| mesh.nodes[c.index()].cell)
        .collect();
    // Positive on the left of the line from one vertex to another, seen against the normal.
    let line = |from: u32, to: u32| {
        let (a, b) = (mesh.vertices[from as usize], mesh.vertices[to as usize]);
        let inward = node.normal.cross(b - a);
        inward.extend(-inward.dot(a))
    };
    // The edges of a cell that are also edges of some others.
    let shared = |first: usize, others: core::ops::Range<usize>| -> Vec<Vec4> {
        let corners = cells[first].corners();
        let edges = (0..corners.len()).map(|i| (corners[i], corners[(i + 1) % corners.len()]));
        let is_shared = |&(a, b): &(u32, u32)| {
            let mut others = cells[others.clone()].iter().map(|cell| cell.corners());
            others.any(|corners| corners.contains(&a) && corners.contains(&b))
        };
        edges.filter(is_shared).map(|(a, b)| line(a, b)).collect()
    };
    let none = Vec4::ZERO;
    let n = cells.len();
    if n > 4 {
        return (Kind::Fan, [none; 3]);
    }
    if n == 4
        && cells[0].count == 4
        && let ([a], [b]) = (&shared(0, 1..2)[..], &shared(0, 3..4)[..])
    {
        return (Kind::Cross, [*a, *b, none]);
    }
    // One line after the other parts a cell from all later ones.
    let mut lines = [none; 3];
    for (i, found) in lines.iter_mut().enumerate().take(n - 1) {
        match shared(i, i + 1..n)[..] {
            [line] => *found = line,
            _ => return (Kind::Fan, [none; 3]),
        }
    }
    (Kind::Chain, lines)
}

impl PatchMesh {
    /// Position in [`Self::elements`] of the element at a point of a face's side; `None` if that side only absorbs.
    pub fn element_at(&self, face: usize, side: Side, point: Vec3) -> Option<usize> {
        let root = self.locator.roots[face][side as usize];
        self.locator.walk(self, root, ELEMENT, point)
    }

    /// Position in [`Self::patches`] of the patch at a point of a face's side; `None` if that side only absorbs.
    pub fn patch_at(&self, face: usize, side: Side, point: Vec3) -> Option<usize> {
        let root = self.locator.roots[face][side as usize];
        self.locator.walk(self, root, PATCH, point)
    }

    /// Which of a node's children a point lies deepest in.
    fn deepest_child(&self, id: NodeId, point: Vec3) -> usize {
        let depths = self
            .children(id)
            .map(|child| self.depth_inside(child, point))
            .enumerate();
        let (child, _) = depths
            .max_by(|a, b| a.1.total_cmp(&b.1))
            .expect("a node above a cut has children");
        child
    }

    /// Smallest signed distance of a point from the edges of a node, positive inside.
    fn depth_inside(&self, id: NodeId, point: Vec3) -> f32 {
        let node = &self.nodes[id.index()];
        let polygon = self.polygon(id);
        let n = polygon.len();
        (0..n)
            .map(|i| {
                let (a, b) = (polygon[i], polygon[(i + 1) % n]);
                let edge = b - a;
                edge.cross(point - a).dot(node.normal) / edge.length().max(1e-30)
            })
            .fold(f32::INFINITY, f32::min)
    }
}

#[cfg(test)]
mod tests {
    use crate::patch::{NodeKind, PatchMesh, PatchOptions};
    use crate::sampling::point_in_polygon;
    use hemicube_scene::builtin;
    use std::sync::Arc;

    #[test]
    fn points_of_elements_and_patches_are_found_again() {
        for builtin in builtin::list() {
            let name = builtin.name;
            let scene = Arc::new(builtin::scene(name).expect("it is built in"));
            let options = PatchOptions::default()
                .with_elements(3000)
                .with_patches(200);
            let mesh = PatchMesh::build(scene, options).expect("a mesh");
            let (mut missed, mut tried) = (0, 0);
            for (e, &id) in mesh.elements().iter().enumerate() {
                let NodeKind::Surface { face, side } = mesh.node(id).kind else {
                    unreachable!("elements are surfaces")
                };
                for i in 0..8 {
                    // Not quite to the edges, where neighbours are as good.
                    let point = point_in_polygon(&mesh.polygon(id), i, 1)
                        .lerp(mesh.node(id).centroid, 0.01);
                    let found = mesh.element_at(face as usize, side, point);
                    let patch = mesh.patch_at(face as usize, side, point);
                    missed +=
                        usize::from(found != Some(e) || patch != Some(mesh.patch_of_element(e)));
                    tried += 1;
                }
            }
            assert!(
                missed == 0,
                "{name}: {missed} of {tried} points are not found again"
            );
        }
    }
}
