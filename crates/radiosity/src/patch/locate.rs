//! Which part of a face a point lies in: down the forest, by the lines that cut each cell.

use super::face::Side;
use super::{NONE, NodeId, PatchMesh};
use glam::Vec3;

impl PatchMesh {
    /// Position in [`Self::elements`] of the element at a point of a face's side; `None` if that side only absorbs.
    pub fn element_at(&self, face: usize, side: Side, point: Vec3) -> Option<usize> {
        let element = self.descend(&self.element_of_node, face, side, point)?;
        Some(element as usize)
    }

    /// Position in [`Self::patches`] of the patch at a point of a face's side; `None` if that side only absorbs.
    pub fn patch_at(&self, face: usize, side: Side, point: Vec3) -> Option<usize> {
        let patch = self.descend(&self.patch_of_node, face, side, point)?;
        Some(patch as usize)
    }

    /// From the root of a face's side down to the cut; `of_node` holds each node's position in it.
    fn descend(&self, of_node: &[u32], face: usize, side: Side, point: Vec3) -> Option<u32> {
        let mut id = self.roots[face][side as usize]?;
        while of_node[id.index()] == NONE {
            id = self.child_at(id, point);
        }
        Some(of_node[id.index()])
    }

    /// The child that a point lies in, or is nearest to.
    ///
    /// Cells are cut by [`split`](super::subdivide::split) along lines between the vertices of its first cells, so one
    /// to three of them decide; fans around a centre, which are rare, are compared child by child.
    fn child_at(&self, id: NodeId, point: Vec3) -> NodeId {
        let node = &self.nodes[id.index()];
        let child = |i: u32| NodeId(node.first_child + i);
        let corners = |i: u32| self.nodes[child(i).index()].cell.corners;
        let count = |i: u32| self.nodes[child(i).index()].cell.count;
        // On the left of the line from one vertex to another, where its own cell is.
        let left = |from: u32, to: u32| {
            let (a, b) = (self.vertices[from as usize], self.vertices[to as usize]);
            (b - a).cross(point - a).dot(node.normal) >= 0.0
        };
        match (node.cell.count, node.child_count) {
            (_, 2) => {
                let [_, b, c, d] = corners(0);
                let other = corners(1);
                let (from, to) = if count(0) == 4 && !other.contains(&b) {
                    (c, d)
                } else {
                    (b, c)
                };
                child(u32::from(!left(from, to)))
            }
            (4, 4) if count(0) == 4 => {
                let [_, ab, m, da] = corners(0);
                match (left(ab, m), left(m, da)) {
                    (true, true) => child(0),
                    (false, true) => child(1),
                    (false, false) => child(2),
                    (true, false) => child(3),
                }
            }
            (3, 4) => {
                let [_, ab, ca, _] = corners(0);
                let bc = corners(1)[2];
                match (left(ab, ca), left(bc, ab), left(ca, bc)) {
                    (true, ..) => child(0),
                    (_, true, _) => child(1),
                    (.., true) => child(2),
                    _ => child(3),
                }
            }
            _ => self.deepest_child(id, point),
        }
    }

    fn deepest_child(&self, id: NodeId, point: Vec3) -> NodeId {
        let depths = self
            .children(id)
            .map(|child| (child, self.depth_inside(child, point)));
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
