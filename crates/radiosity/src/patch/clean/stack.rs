//! Faces upon one another in one plane.
//!
//! A poster that lies in the very plane of its wall is met by some rays and missed by others. So of two faces that overlap
//! in a plane and show the same side, that of the smaller node (in one node, the smaller face) is lifted off the other by
//! a few [offsets](crate::visibility::Visibility::offset), some hundred-thousandths of the largest coordinate; what is
//! covered below it counts as buried.

use super::newell_normal;
use crate::patch::box_tree::BoxTree;
use crate::patch::face::WorldFace;
use crate::visibility::Visibility;
use glam::Vec3;
use hemicube_scene::report::counted;
use hemicube_scene::{ImportReport, Scene};
use rayon::prelude::*;
use std::collections::BTreeMap;

/// Offsets by which each layer is lifted: rays start one off a surface, and must start below what lies upon it.
pub const LIFT: f32 = 4.0;
/// Layers above the lowest face that are told apart.
pub const MOST_LAYERS: u32 = 4;
/// Share of the smaller face that must lie upon the other: tiles overlap by rounding.
const LEAST_SHARE: f64 = 1e-3;
/// Largest sine of the angle between two planes that are one.
pub const MOST_TILT: f32 = 1e-4;

/// Lifts faces that lie upon others and tells of which nodes.
pub fn lift(scene: &Scene, faces: &mut [WorldFace], report: &mut ImportReport) {
    let below = covered_by_each(scene, faces);
    if below.iter().all(Vec::is_empty) {
        return;
    }
    let layers = layers(&below, &ranks(scene, faces));
    let step = LIFT * Visibility::largest_offset_of(faces);
    let mut lifted: BTreeMap<u32, (usize, f32)> = BTreeMap::new();
    for (face, &layer) in faces.iter_mut().zip(&layers) {
        if layer == 0 {
            continue;
        }
        let height = step * layer as f32;
        let up = face.normal * height;
        face.corners = face.corners.map(|corner| corner + up);
        let told = lifted.entry(face.instance).or_default();
        *told = (told.0 + 1, told.1.max(height));
    }
    for (instance, (count, height)) in lifted {
        let place = format!("node '{}'", scene.instances[instance as usize].node);
        let what = format!(
            "{} in the plane of others and upon them, lifted by {height:.1e} units",
            counted(count, "face")
        );
        report.warn(place, what);
    }
}

/// For each face, the order in which it gives way: by the area of its node, then by its own.
fn ranks(scene: &Scene, faces: &[WorldFace]) -> Vec<u32> {
    let mut of_node = vec![0.0; scene.instances.len()];
    for face in faces {
        of_node[face.instance as usize] += area(face);
    }
    let mut order: Vec<usize> = (0..faces.len()).collect();
    let key = |&i: &usize| (of_node[faces[i].instance as usize], area(&faces[i]));
    order.par_sort_by(|a, b| {
        let (a, b) = (key(a), key(b));
        b.0.total_cmp(&a.0).then(b.1.total_cmp(&a.1))
    });
    let mut ranks = vec![0; faces.len()];
    for (rank, face) in order.into_iter().enumerate() {
        ranks[face] = crate::index32(rank);
    }
    ranks
}

/// For each face those that overlap it in its plane.
fn covered_by_each(scene: &Scene, faces: &[WorldFace]) -> Vec<Vec<u32>> {
    let diameter = Visibility::diameter_of(faces);
    let tree = BoxTree::new(faces.iter().map(WorldFace::polygon));
    let sides = |face: &WorldFace| scene.materials[face.material as usize].lit_sides();
    faces
        .par_iter()
        .enumerate()
        .map(|(i, face)| {
            let tolerance = 0.5 * Visibility::offset_in(diameter, face.corners[0]);
            let near = tree.near(face.polygon(), tolerance).into_iter();
            near.filter(|&j| {
                let other = &faces[j as usize];
                let cosine = face.normal.dot(other.normal);
                let alike = cosine > 0.0 || (sides(face) == 2 && sides(other) == 2);
                j as usize != i
                    && alike
                    && face.normal.cross(other.normal).length() < MOST_TILT
                    && is_in_plane(face, other, tolerance)
                    && overlap(face, other) > LEAST_SHARE * area(face).min(area(other))
            })
            .collect()
        })
        .collect()
}

/// Whether the smaller of two faces lies in the plane of the other.
fn is_in_plane(a: &WorldFace, b: &WorldFace, tolerance: f32) -> bool {
    let (small, large) = if area(a) < area(b) { (a, b) } else { (b, a) };
    let height = |&corner: &Vec3| (corner - large.corners[0]).dot(large.normal).abs();
    small
        .polygon()
        .iter()
        .all(|corner| height(corner) <= tolerance)
}

/// Layer of each face above those it lies upon, of which each gives way to those of lower rank.
fn layers(covers: &[Vec<u32>], ranks: &[u32]) -> Vec<u32> {
    let mut order: Vec<usize> = (0..covers.len())
        .filter(|&i| !covers[i].is_empty())
        .collect();
    order.sort_unstable_by_key(|&i| ranks[i]);
    let mut layers = vec![0; covers.len()];
    for face in order {
        let below = covers[face]
            .iter()
            .filter(|&&j| ranks[j as usize] < ranks[face]);
        let highest = below.map(|&j| layers[j as usize] + 1).max();
        layers[face] = highest.unwrap_or(0).min(MOST_LAYERS);
    }
    layers
}

fn area(face: &WorldFace) -> f64 {
    0.5 * f64::from(newell_normal(face.polygon()).length())
}

/// Area that two faces of one plane have in common: one clipped by the planes through the other's edges (Sutherland,
/// Hodgman 1974).
fn overlap(a: &WorldFace, b: &WorldFace) -> f64 {
    let mut clipped: Vec<Vec3> = a.polygon().to_vec();
    let edges = b.polygon();
    for (i, &from) in edges.iter().enumerate() {
        let inward = b.normal.cross(edges[(i + 1) % edges.len()] - from);
        clipped = clip(&clipped, |p| (p - from).dot(inward));
        if clipped.len() < 3 {
            return 0.0;
        }
    }
    0.5 * f64::from(newell_normal(&clipped).length())
}

/// The part of a polygon where a linear function is not negative.
fn clip(polygon: &[Vec3], height: impl Fn(Vec3) -> f32) -> Vec<Vec3> {
    let mut kept = Vec::with_capacity(polygon.len() + 1);
    for (i, &a) in polygon.iter().enumerate() {
        let b = polygon[(i + 1) % polygon.len()];
        let (ha, hb) = (height(a), height(b));
        if ha >= 0.0 {
            kept.push(a);
        }
        if (ha < 0.0) != (hb < 0.0) {
            kept.push(a.lerp(b, ha / (ha - hb)));
        }
    }
    kept
}
