//! Spheres in a box: geometry for visibility alone, of as many triangles as wanted.

use glam::Vec3;
use hemicube::radiosity::Visibility;
use hemicube::radiosity::patch::face::WorldFace;
use hemicube::radiosity::sampling::hash;
use hemicube::scene::{Material, Scene};
use std::sync::Arc;

/// Edge of the box, in metres. One of its corners is the origin.
pub const SIDE: f32 = 10.0;

/// A number in [0, 1), the same for the same arguments.
pub fn random(seed: u64, index: u64) -> f32 {
    (hash(seed, index) >> 40) as f32 / (1 << 24) as f32
}

/// A point in the unit cube, the same for the same arguments.
pub fn random_point(seed: u64, index: u64) -> Vec3 {
    Vec3::from_array([0, 1, 2].map(|axis| random(seed, 3 * index + axis)))
}

/// Twelve triangles of a box, then `count` spheres of `2 (stacks - 1) slices` triangles each, that may overlap.
pub fn spheres_in_a_box(count: u64, stacks: usize, slices: usize) -> Vec<[Vec3; 3]> {
    let mut triangles = Vec::new();
    for axis in 0..3 {
        for height in [0.0, SIDE] {
            let corner = |a: f32, b: f32| {
                let mut corner = Vec3::ZERO;
                corner[axis] = height;
                corner[(axis + 1) % 3] = a * SIDE;
                corner[(axis + 2) % 3] = b * SIDE;
                corner
            };
            let [a, b, c, d] = [
                corner(0.0, 0.0),
                corner(1.0, 0.0),
                corner(1.0, 1.0),
                corner(0.0, 1.0),
            ];
            triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    for number in 0..count {
        let radius = 0.3 + 0.7 * random(1, number);
        let room = Vec3::splat(SIDE - 2.0 * radius);
        let centre = Vec3::splat(radius) + random_point(2, number) * room;
        sphere(&mut triangles, centre, radius, stacks, slices);
    }
    triangles
}

fn sphere(triangles: &mut Vec<[Vec3; 3]>, centre: Vec3, radius: f32, stacks: usize, slices: usize) {
    let point = |i: usize, j: usize| {
        let polar = i as f32 / stacks as f32 * core::f32::consts::PI;
        let azimuth = (j % slices) as f32 / slices as f32 * core::f32::consts::TAU;
        let ring = if i.is_multiple_of(stacks) {
            0.0
        } else {
            polar.sin()
        };
        centre + radius * Vec3::new(ring * azimuth.cos(), polar.cos(), ring * azimuth.sin())
    };
    for i in 0..stacks {
        for j in 0..slices {
            let [a, b] = [point(i, j), point(i, j + 1)];
            let [c, d] = [point(i + 1, j + 1), point(i + 1, j)];
            if i > 0 {
                triangles.push([a, b, c]);
            }
            if i + 1 < stacks {
                triangles.push([a, c, d]);
            }
        }
    }
}

/// What sees what among triangles, each a face of its own.
pub fn visibility(triangles: &[[Vec3; 3]]) -> Visibility {
    let face = |&[a, b, c]: &[Vec3; 3]| WorldFace {
        corners: [a, b, c, c],
        mesh_corners: [0; 4],
        corner_count: 3,
        normal: (b - a).cross(c - a).normalize_or_zero(),
        instance: 0,
        face: 0,
        material: 0,
    };
    let scene = Scene {
        materials: vec![Material::default()],
        ..Scene::default()
    };
    Visibility::new(Arc::new(scene), triangles.iter().map(face).collect())
}

/// Segments between random points of the box, a little off its walls.
pub fn random_segments(count: u64, seed: u64) -> Vec<(Vec3, Vec3)> {
    let point = |i| Vec3::splat(0.01) + random_point(seed, i) * (SIDE - 0.02);
    (0..count)
        .map(|i| (point(2 * i), point(2 * i + 1)))
        .collect()
}

/// Distance along a ray at which it meets a triangle in exact enough arithmetic (Möller and Trumbore 1997, in f64),
/// and how far inside of the triangle that is, as the smallest of its barycentric coordinates.
pub fn meet(origin: Vec3, direction: Vec3, triangle: &[Vec3; 3]) -> Option<(f64, f64)> {
    let [o, d] = [origin, direction].map(Vec3::as_dvec3);
    let [a, b, c] = triangle.map(Vec3::as_dvec3);
    let (ab, ac) = (b - a, c - a);
    let across = d.cross(ac);
    let determinant = ab.dot(across);
    if determinant == 0.0 {
        return None;
    }
    let u = (o - a).dot(across) / determinant;
    let turned = (o - a).cross(ab);
    let v = d.dot(turned) / determinant;
    Some((ac.dot(turned) / determinant, u.min(v).min(1.0 - u - v)))
}
