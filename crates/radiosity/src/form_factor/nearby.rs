//! The surfaces within a distance of a point.

use crate::patch::PatchMesh;
use core::fmt;
use glam::{Vec3, Vec3A};
use obvhs::BvhBuildParams;
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::builder::build_bvh2;
use std::time::Duration;

/// A surface of a mesh.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Surface {
    /// By its position in [`PatchMesh::elements`].
    Element(usize),
    /// By its position in [`PatchMesh::faces`].
    Obstruction(u32),
}

/// A tree over elements with an exposed part, and over faces that only block.
pub(super) struct Nearby {
    tree: Bvh2,
    surfaces: Vec<Surface>,
}

impl fmt::Debug for Nearby {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Nearby")
            .field("surfaces", &self.surfaces.len())
            .finish_non_exhaustive()
    }
}

impl Nearby {
    pub(super) fn new(mesh: &PatchMesh) -> Self {
        let exposed = |&e: &usize| mesh.exposed_area(e) > 0.0;
        let elements = (0..mesh.elements().len()).filter(exposed);
        let mut blocking: Vec<u32> = mesh.obstructions().iter().map(|&(face, _)| face).collect();
        // Cells of one face follow one another.
        blocking.dedup();
        let surfaces: Vec<Surface> = elements
            .map(Surface::Element)
            .chain(blocking.into_iter().map(Surface::Obstruction))
            .collect();
        let boxes: Vec<Aabb> = surfaces
            .iter()
            .map(|&surface| match surface {
                Surface::Element(e) => around(&mesh.polygon(mesh.elements()[e])),
                Surface::Obstruction(face) => around(mesh.faces()[face as usize].polygon()),
            })
            .collect();
        let tree = if boxes.is_empty() {
            Bvh2::default()
        } else {
            let parameters = BvhBuildParams::fast_build();
            build_bvh2(&boxes, parameters, &mut Duration::default())
        };
        Self { tree, surfaces }
    }

    /// Calls `visit` with all surfaces whose boxes come within a distance of a point, in any order, and perhaps with some
    /// that are farther.
    pub(super) fn around(&self, point: Vec3, distance: f32, mut visit: impl FnMut(Surface)) {
        // Rounding must not lose a surface at exactly that distance.
        let reach = Vec3A::splat(distance + 1e-5 * (distance + point.abs().max_element()));
        let centre = Vec3A::from(point);
        let bounds = Aabb::new(centre - reach, centre + reach);
        self.tree.aabb_traverse(bounds, |tree, node| {
            let node = &tree.nodes[node as usize];
            let first = node.first_index as usize;
            for &i in &tree.primitive_indices[first..first + node.prim_count as usize] {
                visit(self.surfaces[i as usize]);
            }
            true
        });
    }
}

fn around(polygon: &[Vec3]) -> Aabb {
    let points: Vec<Vec3A> = polygon.iter().map(|&p| p.into()).collect();
    Aabb::from_points(&points)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::patch::PatchOptions;
    use hemicube_scene::builtin;
    use std::sync::Arc;

    #[test]
    fn none_that_is_near_is_missed() {
        let scene = Arc::new(builtin::scene("office").expect("it is built in"));
        let options = PatchOptions::default().with_elements(3000);
        let mesh = PatchMesh::build(scene, options).expect("it can be cut");
        let nearby = Nearby::new(&mesh);
        for &patch in mesh.patches().iter().step_by(37) {
            let centre = mesh.node(patch).centroid;
            for distance in [0.01, 0.3, 2.0, 100.0] {
                let mut found = vec![0; mesh.elements().len()];
                nearby.around(centre, distance, |surface| {
                    if let Surface::Element(e) = surface {
                        found[e] += 1;
                    }
                });
                for (e, &id) in mesh.elements().iter().enumerate() {
                    let corner = |&c: &Vec3| c.distance(centre) <= distance;
                    let is_near = mesh.polygon(id).iter().any(corner);
                    assert!(found[e] <= 1, "element {e} is visited once");
                    let wanted = is_near && mesh.exposed_area(e) > 0.0;
                    assert!(!wanted || found[e] == 1, "element {e} is near {patch:?}");
                }
            }
        }
    }
}
