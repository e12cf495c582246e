//! The surfaces of a scene that may stand between others, found by the shafts of pairs and of blocks of pairs.

use super::flat_surfaces::FlatSurfaces;
use super::shaft::{Bounds, Occluder};
use crate::form_factor::polygon::FlatPolygon;
use crate::patch::PatchMesh;
use crate::patch::face::WorldFace;
use glam::Vec3;
use obvhs::BvhBuildParams;
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::builder::build_bvh2;
use rayon::prelude::*;
use std::time::Duration;

/// Faces above which it is not checked which of them have something on both sides: that takes the square of them.
const MANY_FACES: usize = 20_000;
/// Lengths below this share of the scene's size are rounding: coordinates are f32.
const ROUNDING: f64 = 1e-6;

/// A flat surface that may stand between others.
#[derive(Debug, Clone, Copy)]
pub struct Obstacle {
    /// Its geometry.
    pub occluder: Occluder,
    /// Which of the [`FlatSurfaces`] it is, or is of.
    pub surface: u32,
    /// Whether light may pass straight through.
    pub transmits: bool,
}

/// All of them with a tree over their boxes.
pub struct Occluders {
    obstacles: Vec<Obstacle>,
    tree: Option<Bvh2>,
    rounding: f64,
}

impl core::fmt::Debug for Occluders {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("Occluders")
            .field("obstacles", &self.obstacles.len())
            .finish_non_exhaustive()
    }
}

impl Occluders {
    /// Of the faces of a mesh, without those that have the whole scene on one side.
    pub fn new(mesh: &PatchMesh, surfaces: &FlatSurfaces) -> Self {
        let faces = mesh.faces();
        let rounding = ROUNDING * f64::from(mesh.visibility().diameter());
        let corners: Vec<Vec3> = faces.iter().flat_map(|f| f.polygon().to_vec()).collect();
        let may_occlude: Vec<bool> = faces
            .par_iter()
            .map(|face| faces.len() > MANY_FACES || divides(face, &corners, rounding))
            .collect();
        let mut obstacles = Vec::new();
        let mut is_done = vec![false; surfaces.outlines.len()];
        for ((face, &surface), &may_occlude) in
            faces.iter().zip(&surfaces.of_face).zip(&may_occlude)
        {
            if is_done[surface as usize] {
                continue;
            }
            let outline = surfaces.outlines[surface as usize].clone();
            is_done[surface as usize] = outline.is_some();
            if !may_occlude {
                continue;
            }
            let outline =
                outline.unwrap_or_else(|| face.polygon().iter().map(|c| c.as_dvec3()).collect());
            obstacles.push(Obstacle {
                occluder: Occluder::new(FlatPolygon::from_corners(&outline)),
                surface,
                transmits: mesh.scene().materials[face.material as usize].may_transmit(),
            });
        }
        let boxes: Vec<Aabb> = obstacles.iter().map(|o| aabb(&o.occluder.bounds)).collect();
        let tree = (!boxes.is_empty()).then(|| {
            build_bvh2(
                &boxes,
                BvhBuildParams::medium_build(),
                &mut Duration::default(),
            )
        });
        Self {
            obstacles,
            tree,
            rounding,
        }
    }

    /// Lengths below this are rounding.
    pub fn rounding(&self) -> f64 {
        self.rounding
    }

    /// Those whose box touches the shaft of two boxes, in a fixed order.
    pub fn between<'a>(&'a self, a: &Bounds, b: &Bounds, found: &mut Vec<&'a Obstacle>) {
        found.clear();
        let Some(tree) = &self.tree else { return };
        let mut open = vec![0_u32];
        while let Some(index) = open.pop() {
            let node = &tree.nodes[index as usize];
            if !bounds(&node.aabb).meets_shaft(a, b) {
                continue;
            }
            if node.prim_count == 0 {
                open.extend([node.first_index, node.first_index + 1]);
                continue;
            }
            let leaf = node.first_index as usize..(node.first_index + node.prim_count) as usize;
            let obstacles = tree.primitive_indices[leaf]
                .iter()
                .map(|&i| &self.obstacles[i as usize]);
            found.extend(obstacles.filter(|o| o.occluder.bounds.meets_shaft(a, b)));
        }
    }
}

/// Whether points lie on both sides of a face's plane.
fn divides(face: &WorldFace, points: &[Vec3], rounding: f64) -> bool {
    let (origin, normal) = (face.corners[0].as_dvec3(), face.normal.as_dvec3());
    let (mut above, mut below) = (false, false);
    points.iter().any(|p| {
        let height = (p.as_dvec3() - origin).dot(normal);
        above |= height > rounding;
        below |= height < -rounding;
        above && below
    })
}

fn aabb(bounds: &Bounds) -> Aabb {
    // One step of f32 outwards, so that nothing is lost by rounding.
    let low = bounds.low.as_vec3() - bounds.low.as_vec3().abs() * 1e-6;
    let high = bounds.high.as_vec3() + bounds.high.as_vec3().abs() * 1e-6;
    Aabb::new(low.into(), high.into())
}

fn bounds(aabb: &Aabb) -> Bounds {
    Bounds {
        low: Vec3::from(aabb.min).as_dvec3(),
        high: Vec3::from(aabb.max).as_dvec3(),
    }
}
