//! A tree over boxes, asked which of them come near a box or a point.

use glam::{Vec3, Vec3A};
use obvhs::BvhBuildParams;
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::builder::build_bvh2;
use std::time::Duration;

/// Boxes that one question finds at most: where thousands of faces lie in one place, all pairs of them would take
/// their square.
pub const MOST_FOUND: usize = 4096;

/// A tree over the boxes of things, which are known by their number.
pub struct BoxTree(Option<Bvh2>);

impl BoxTree {
    /// Over the boxes of point sets.
    pub fn new<'a>(sets: impl Iterator<Item = &'a [Vec3]>) -> Self {
        let boxes: Vec<Aabb> = sets.map(around).collect();
        let parameters = BvhBuildParams::fast_build();
        Self((!boxes.is_empty()).then(|| build_bvh2(&boxes, parameters, &mut Duration::default())))
    }

    /// The things whose boxes come within a distance of the box around some points, in ascending order; perhaps a few
    /// that are farther, and at most [`MOST_FOUND`].
    pub fn near(&self, points: &[Vec3], distance: f32) -> Vec<u32> {
        let mut found = Vec::new();
        let Some(tree) = &self.0 else { return found };
        let bounds = around(points);
        let reach = Vec3A::splat(distance);
        let bounds = Aabb::new(bounds.min - reach, bounds.max + reach);
        tree.aabb_traverse(bounds, |tree, node| {
            let node = &tree.nodes[node as usize];
            let first = node.first_index as usize;
            found.extend(&tree.primitive_indices[first..first + node.prim_count as usize]);
            found.len() < MOST_FOUND
        });
        found.sort_unstable();
        found
    }
}

fn around(points: &[Vec3]) -> Aabb {
    let nothing = Aabb::new(Vec3A::INFINITY, Vec3A::NEG_INFINITY);
    points.iter().fold(nothing, |bounds, &p| {
        Aabb::new(bounds.min.min(p.into()), bounds.max.max(p.into()))
    })
}
