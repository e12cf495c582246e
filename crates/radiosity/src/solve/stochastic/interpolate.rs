//! From patches to the elements on them: light that was counted on a patch varies over it as its neighbours' does.
//!
//! A corner takes the mean of the patches around it, by area and within the crease angle, an element the values of the
//! corners by mean value coordinates (Floater 2003). What arrived at the patch stays as much as it was.

use crate::patch::{NodeId, PatchMesh};
use glam::Vec3;
use rayon::prelude::*;

/// Cosine of the largest angle between normals over which light is averaged (40°).
const CREASE: f32 = 0.766;

/// Which patches share corners.
pub(super) struct Interpolation {
    /// First of [`Self::around`] for each corner of each patch, corners of a patch one after the other.
    starts: Vec<u32>,
    /// First corner of each patch.
    corners: Vec<u32>,
    /// Patches around the corners, themselves included.
    around: Vec<u32>,
    areas: Vec<f64>,
}

impl Interpolation {
    pub(super) fn new(mesh: &PatchMesh, areas: Vec<f64>) -> Self {
        let of_vertex = patches_of_vertices(mesh);
        let (mut starts, mut corners, mut around) = (vec![0], vec![0], Vec::new());
        for &id in mesh.patches() {
            let normal = mesh.node(id).normal;
            for &vertex in mesh.corners(id) {
                let near = of_vertex.iter_of(vertex).filter(|&patch| {
                    let other: NodeId = mesh.patches()[patch as usize];
                    mesh.node(other).normal.dot(normal) >= CREASE
                });
                around.extend(near);
                starts.push(crate::index32(around.len()));
            }
            corners.push(crate::index32(starts.len() - 1));
        }
        Self {
            starts,
            corners,
            around,
            areas,
        }
    }

    /// Irradiance of the elements by that of the patches.
    pub(super) fn to_elements(&self, mesh: &PatchMesh, patches: &[f32], elements: &mut [f32]) {
        let mut slices = Vec::with_capacity(patches.len());
        let mut rest = elements;
        for patch in 0..patches.len() {
            let (slice, after) = rest.split_at_mut(mesh.elements_of_patch(patch).len());
            slices.push(slice);
            rest = after;
        }
        slices
            .into_par_iter()
            .enumerate()
            .with_min_len(64)
            .for_each(|(patch, slice)| self.fill(mesh, patches, patch, slice));
    }

    fn fill(&self, mesh: &PatchMesh, patches: &[f32], patch: usize, elements: &mut [f32]) {
        let mean = patches[patch];
        elements.fill(mean);
        if elements.len() < 2 || mean <= 0.0 {
            return;
        }
        let values = self.corner_values(patches, patch);
        let id = mesh.patches()[patch];
        let (polygon, normal) = (mesh.polygon(id), mesh.node(id).normal);
        let range = mesh.elements_of_patch(patch);
        for (value, e) in elements.iter_mut().zip(range.clone()) {
            let point = mesh.node(mesh.elements()[e]).centroid;
            let weights = mean_value_coordinates(&polygon, normal, point);
            *value = values.iter().zip(weights).map(|(v, w)| v * w).sum();
        }
        let area = |e: usize| f64::from(mesh.exposed_area(e));
        let flux: f64 = elements
            .iter()
            .zip(range)
            .map(|(&v, e)| f64::from(v) * area(e))
            .sum();
        let scale = f64::from(mean) * self.areas[patch] / flux;
        if scale.is_finite() && flux > 0.0 {
            let scale = super::to_f32(scale);
            elements.iter_mut().for_each(|value| *value *= scale);
        } else {
            elements.fill(mean);
        }
    }

    fn corner_values(&self, patches: &[f32], patch: usize) -> Vec<f32> {
        let corners = self.corners[patch] as usize..self.corners[patch + 1] as usize;
        let value = |corner: usize| {
            let range = self.starts[corner] as usize..self.starts[corner + 1] as usize;
            let (mut sum, mut weights) = (0.0, 0.0);
            for &other in &self.around[range] {
                let area = self.areas[other as usize];
                sum += f64::from(patches[other as usize]) * area;
                weights += area;
            }
            if weights > 0.0 {
                super::to_f32(sum / weights)
            } else {
                patches[patch]
            }
        };
        corners.map(value).collect()
    }
}

/// Lists of patches around vertices, end to end.
struct OfVertex {
    starts: Vec<u32>,
    patches: Vec<u32>,
}

impl OfVertex {
    fn iter_of(&self, vertex: u32) -> impl Iterator<Item = u32> + '_ {
        let v = vertex as usize;
        let range = self.starts[v] as usize..self.starts[v + 1] as usize;
        self.patches[range].iter().copied()
    }
}

fn patches_of_vertices(mesh: &PatchMesh) -> OfVertex {
    let mut starts = vec![0_u32; mesh.vertices().len() + 1];
    let corners = || {
        let patches = mesh.patches().iter().enumerate();
        patches.flat_map(|(patch, &id)| mesh.corners(id).iter().map(move |&v| (patch, v as usize)))
    };
    for (_, vertex) in corners() {
        starts[vertex + 1] += 1;
    }
    for v in 1..starts.len() {
        starts[v] += starts[v - 1];
    }
    let mut next = starts.clone();
    let mut patches = vec![0; starts.last().copied().unwrap_or(0) as usize];
    for (patch, vertex) in corners() {
        patches[next[vertex] as usize] = crate::index32(patch);
        next[vertex] += 1;
    }
    OfVertex { starts, patches }
}

/// Weights of the corners of a convex polygon at a point inside it; they sum to 1, are positive and linear along edges.
fn mean_value_coordinates(polygon: &[Vec3], normal: Vec3, point: Vec3) -> [f32; 4] {
    let n = polygon.len();
    let offset = |i: usize| polygon[i % n] - point;
    // Tangent of half the angle under which an edge is seen, sin / (1 + cos).
    let tangent = |i: usize| {
        let (a, b) = (offset(i), offset(i + 1));
        let product = a.length() * b.length();
        a.cross(b).dot(normal)
            / (product + a.dot(b))
                .max(1e-6 * product)
                .max(f32::MIN_POSITIVE)
    };
    let mut weights = [0.0; 4];
    for (i, weight) in weights.iter_mut().enumerate().take(n) {
        let sum = tangent(i + n - 1) + tangent(i);
        *weight = sum.max(0.0) / offset(i).length().max(f32::MIN_POSITIVE);
    }
    let sum: f32 = weights.iter().sum();
    if sum > 0.0 && sum.is_finite() {
        weights.map(|w| w / sum)
    } else {
        core::array::from_fn(|i| if i < n { 1.0 / n as f32 } else { 0.0 })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mean_value_coordinates_reproduce_the_point() {
        let quads: [&[Vec3]; 2] = [
            &[Vec3::ZERO, Vec3::X * 4.0, Vec3::new(2.0, 1.0, 0.0), Vec3::Y],
            &[Vec3::ZERO, Vec3::X, Vec3::new(0.2, 0.7, 0.0)],
        ];
        for polygon in quads {
            for shares in [[0.1, 0.2, 0.3, 0.4], [0.7, 0.1, 0.1, 0.1]] {
                let total: f32 = shares[..polygon.len()].iter().sum();
                let pairs = || polygon.iter().zip(shares);
                let point: Vec3 = pairs().map(|(&p, s)| p * s / total).sum();
                let weights = mean_value_coordinates(polygon, Vec3::Z, point);
                let back: Vec3 = polygon.iter().zip(weights).map(|(&p, w)| p * w).sum();
                assert!(back.distance(point) < 1e-5, "{point} came out as {back}");
                assert!(
                    (weights.iter().sum::<f32>() - 1.0).abs() < 1e-6,
                    "they sum to 1"
                );
            }
        }
    }
}
