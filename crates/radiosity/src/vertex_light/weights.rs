//! Weights of the elements around a vertex: those that are exact where light is linear.

use super::fan::normal_of;
use crate::patch::PatchMesh;
use glam::{Mat2, Vec2};

/// Share of the areas' sum below which corrected weights are too small to trust.
const LEAST_WEIGHT: f32 = 0.1;

/// Standard deviations of the centres along an axis beyond whose number a slope along it says nothing about the vertex:
/// two rows of equal elements at a border are 2 away.
const FARTHEST: f32 = 4.0;

/// Weights of elements whose centres a vertex lies amid, or that are all buried: those weigh 0.
pub(super) fn amid(mesh: &PatchMesh, vertex: u32, elements: &[u32]) -> Option<Vec<f32>> {
    let areas = exposed_areas(mesh, elements);
    let total: f32 = areas.iter().sum();
    if total <= 0.0 {
        return Some(areas);
    }
    balanced(&offsets(mesh, vertex, elements), &areas)
        .filter(|weights| weights.iter().sum::<f32>() > LEAST_WEIGHT * total)
        .map(normalized)
}

/// Weights of elements beside a vertex: light is the plane through theirs with the least squared error, weighted by
/// exposed areas. Some weights are negative.
///
/// `w = a / Σa - a (d - m) · S⁺ m` with mean offset `m` and `S = Σ a (d - m)(d - m)ᵀ`. Axes of `S` along which the vertex
/// is too far off for the elements to tell are left out of its inverse; a single element has just its own value.
pub(super) fn beside(mesh: &PatchMesh, vertex: u32, elements: &[u32]) -> Vec<f32> {
    let areas = exposed_areas(mesh, elements);
    let total: f32 = areas.iter().sum();
    let offsets = offsets(mesh, vertex, elements);
    let pairs = || offsets.iter().zip(&areas);
    let mean = pairs().map(|(&d, &area)| d * area).sum::<Vec2>() / total;
    let spread = second_moments(pairs().map(|(&d, &area)| (d - mean, area)));
    let tilt = tilt(spread, mean, total);
    let weight = |(&d, &area): (&Vec2, &f32)| area / total - area * (d - mean).dot(tilt);
    pairs().map(weight).collect()
}

/// `S⁺ m`, of the axes along which `m` is near enough.
fn tilt(spread: Mat2, mean: Vec2, total: f32) -> Vec2 {
    let is_near = |&(axis, moment): &(Vec2, f32)| {
        let off = mean.dot(axis);
        off * off * total <= FARTHEST * FARTHEST * moment && moment > 0.0
    };
    let axes = principal_axes(spread).into_iter();
    axes.filter(is_near)
        .map(|(axis, moment)| axis * (mean.dot(axis) / moment))
        .sum()
}

/// Eigenvectors of a symmetric matrix with their eigenvalues.
fn principal_axes(m: Mat2) -> [(Vec2, f32); 2] {
    let (a, b, c) = (m.x_axis.x, m.x_axis.y, m.y_axis.y);
    let axis = Vec2::from_angle(0.5 * f32::atan2(2.0 * b, a - c));
    [axis, axis.perp()].map(|axis| (axis, axis.dot(m * axis)))
}

/// Weights with `Σ w d = 0` in the plane of the elements: `a (1 + λ·d)`, without those whose weight were negative. `None`
/// if the vertex is not amid the others' centres.
fn balanced(offsets: &[Vec2], areas: &[f32]) -> Option<Vec<f32>> {
    let mut kept = areas.to_vec();
    // Each round leaves out an element at least, and three must remain.
    loop {
        let lambda = balance(offsets, &kept)?;
        let weight = |(d, area): (&Vec2, &f32)| area * (1.0 + lambda.dot(*d));
        let weights: Vec<f32> = offsets.iter().zip(&kept).map(weight).collect();
        if weights.iter().all(|&weight| weight >= 0.0) {
            return Some(weights);
        }
        for (area, weight) in kept.iter_mut().zip(weights) {
            *area = if weight < 0.0 { 0.0 } else { *area };
        }
    }
}

/// `λ` with `Σ a (1 + λ·d) d = 0`; `None` if the offsets lie on a line.
fn balance(offsets: &[Vec2], areas: &[f32]) -> Option<Vec2> {
    let pairs = || offsets.iter().copied().zip(areas.iter().copied());
    let first: Vec2 = pairs().map(|(d, area)| d * area).sum();
    let second = second_moments(pairs());
    let spread = second.x_axis.x + second.y_axis.y;
    let is_flat = second.determinant() <= 1e-3 * spread * spread;
    (!is_flat).then(|| second.inverse() * -first)
}

/// `Σ a d dᵀ`
fn second_moments(pairs: impl Iterator<Item = (Vec2, f32)>) -> Mat2 {
    pairs.fold(Mat2::ZERO, |sum, (d, area)| {
        sum + Mat2::from_cols(d * d.x, d * d.y) * area
    })
}

fn exposed_areas(mesh: &PatchMesh, elements: &[u32]) -> Vec<f32> {
    let areas = elements.iter().map(|&e| mesh.exposed_area(e as usize));
    areas.collect()
}

/// The same weights with a sum of 1.
fn normalized(mut weights: Vec<f32>) -> Vec<f32> {
    let sum: f32 = weights.iter().sum();
    weights.iter_mut().for_each(|weight| *weight /= sum);
    weights
}

/// Offsets of elements' centres from a vertex, in their plane.
fn offsets(mesh: &PatchMesh, vertex: u32, elements: &[u32]) -> Vec<Vec2> {
    let at = mesh.vertices()[vertex as usize];
    let (right, up) = normal_of(mesh, elements[0]).any_orthonormal_pair();
    let offset = |&e: &u32| {
        let d = mesh.node(mesh.elements()[e as usize]).centroid - at;
        Vec2::new(d.dot(right), d.dot(up))
    };
    elements.iter().map(offset).collect()
}
