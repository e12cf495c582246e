//! Faces of the scene in the world: what is left when instances, mirrors, flips and triangle pairs are resolved.

use glam::{Vec2, Vec3, Vec4};
use hemicube_scene::report::counted;
use hemicube_scene::{Face, ImportReport, Instance, Mesh, Scene, SurfaceSample};
use serde::{Deserialize, Serialize};
use std::collections::HashSet;

/// A triangle or planar convex quad in the world, with the way back to where it came from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WorldFace {
    /// World positions of the corners, counter-clockwise seen from the front; the fourth repeats the third for
    /// triangles.
    pub corners: [Vec3; 4],
    /// Indices of the corners in the mesh, in the same order.
    pub mesh_corners: [u32; 4],
    /// 3 or 4.
    pub corner_count: u8,
    /// Unit normal of the front.
    pub normal: Vec3,
    /// Index of the scene's instance.
    pub instance: u32,
    /// Number of the face in its mesh; of the first one for two merged triangles.
    pub face: u32,
    /// Index of the scene's material.
    pub material: u32,
}

/// One of the two sides of a face.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub enum Side {
    /// The side from which the corners run counter-clockwise.
    Front,
    /// The other one.
    Back,
}

impl WorldFace {
    /// The corners.
    pub fn polygon(&self) -> &[Vec3] {
        &self.corners[..self.corner_count as usize]
    }

    /// The one or two triangles of the face, as corner numbers; quads are cut from corner 0 to corner 2.
    pub fn triangles(&self) -> &'static [[usize; 3]] {
        if self.corner_count == 4 {
            &[[0, 1, 2], [0, 2, 3]]
        } else {
            &[[0, 1, 2]]
        }
    }

    /// Weights of the mesh's vertices at a point of the face: three corners and their barycentric coordinates.
    pub fn weights_at(&self, point: Vec3) -> ([u32; 3], [f32; 3]) {
        let candidates = self.triangles();
        let (corners, weights) = candidates
            .iter()
            .map(|&corners| {
                (
                    corners,
                    barycentric(corners.map(|c| self.corners[c]), point),
                )
            })
            .max_by(|a, b| smallest(a.1).total_cmp(&smallest(b.1)))
            .expect("a face has a triangle");
        let clamped = weights.map(|w| w.clamp(0.0, 1.0));
        let sum = clamped.iter().sum::<f32>().max(1e-30);
        (
            corners.map(|c| self.mesh_corners[c]),
            clamped.map(|w| w / sum),
        )
    }

    /// Reflectance, emission and transmittance of the scene's material at a point of the face.
    pub fn surface_at(&self, scene: &Scene, point: Vec3) -> SurfaceSample {
        let mesh = &scene.meshes[scene.instances[self.instance as usize].mesh];
        if mesh.texcoords.is_empty() && mesh.colors.is_empty() {
            return scene.surface_at(self.material as usize, &[], Vec4::ONE);
        }
        let (corners, weights) = self.weights_at(point);
        let color = if mesh.colors.is_empty() {
            Vec4::ONE
        } else {
            weighted(&mesh.colors, corners, weights)
        };
        let mut texcoords = [Vec2::ZERO; 4];
        let sets = mesh.texcoords.len().min(texcoords.len());
        for (at, set) in texcoords.iter_mut().zip(&mesh.texcoords) {
            *at = weighted(set, corners, weights);
        }
        scene.surface_at(self.material as usize, &texcoords[..sets], color)
    }
}

/// Weighted mean of three vertices' attributes.
fn weighted<T>(values: &[T], corners: [u32; 3], weights: [f32; 3]) -> T
where
    T: Copy + core::ops::Mul<f32, Output = T> + core::ops::Add<Output = T>,
{
    let at = |i: usize| values[corners[i] as usize] * weights[i];
    at(0) + at(1) + at(2)
}

fn smallest(weights: [f32; 3]) -> f32 {
    weights[0].min(weights[1]).min(weights[2])
}

/// Barycentric coordinates of the foot of the perpendicular from `point` (Ericson, Real-Time Collision Detection, 3.4).
fn barycentric([a, b, c]: [Vec3; 3], point: Vec3) -> [f32; 3] {
    let (e0, e1, e2) = (b - a, c - a, point - a);
    let (d00, d01, d11) = (e0.dot(e0), e0.dot(e1), e1.dot(e1));
    let (d20, d21) = (e2.dot(e0), e2.dot(e1));
    let denominator = d00 * d11 - d01 * d01;
    if denominator <= 0.0 {
        return [1.0, 0.0, 0.0];
    }
    let v = (d11 * d20 - d01 * d21) / denominator;
    let w = (d00 * d21 - d01 * d20) / denominator;
    [1.0 - v - w, v, w]
}

/// All faces of a scene in the world. Faces without area and copies of others are left out with a warning; neighbouring
/// triangles that make a planar convex quad become one.
///
/// A copy lies upon another face of the same material corner by corner, both turned the same way. The two halve the
/// light between them at random, and no tree of boxes parts them: a ray would try every one of a thousand copies.
pub fn world_faces(scene: &Scene, report: &mut ImportReport) -> Vec<WorldFace> {
    let mut faces = Vec::with_capacity(scene.face_count());
    let mut known = HashSet::with_capacity(scene.face_count());
    for (number, instance) in scene.instances.iter().enumerate() {
        let mesh = &scene.meshes[instance.mesh];
        let (mut i, mut copies) = (0, 0);
        while i < mesh.faces.len() {
            let quad = merged_quad(mesh, i);
            let face = quad.unwrap_or(mesh.faces[i]);
            match placed(number, instance, mesh, face, i) {
                Some(face) if known.insert(PlaceKey::new(&face)) => faces.push(face),
                Some(_) => copies += 1,
                None => report.warn(
                    format!("mesh '{}', triangle {i}", mesh.name),
                    "its area is 0; it was left out",
                ),
            }
            i += if quad.is_some() { 2 } else { 1 };
        }
        if copies > 0 {
            report.warn(
                format!("node '{}'", instance.node),
                format!(
                    "{} upon others of the same material; left out",
                    counted(copies, "face")
                ),
            );
        }
    }
    faces
}

/// Faces that agree in all of this are copies of each other.
#[derive(Debug, PartialEq, Eq, Hash)]
struct PlaceKey {
    material: u32,
    /// From the least one on, so that it does not matter where a face begins.
    corners: [[u32; 3]; 4],
}

impl PlaceKey {
    fn new(face: &WorldFace) -> Self {
        let polygon = face.polygon();
        // Adding 0 makes -0 and 0 the same.
        let at = |i: usize| {
            let corner = polygon[i % polygon.len()] + Vec3::ZERO;
            corner.to_array().map(f32::to_bits)
        };
        let least = (0..polygon.len()).min_by_key(|&i| at(i)).unwrap_or(0);
        let mut corners = [at(least); 4];
        for (i, corner) in corners.iter_mut().enumerate().take(polygon.len()) {
            *corner = at(least + i);
        }
        Self {
            material: face.material,
            corners,
        }
    }
}

/// The face in the world, or `None` if it has no area there.
fn placed(
    number: usize,
    instance: &Instance,
    mesh: &Mesh,
    face: Face,
    index: usize,
) -> Option<WorldFace> {
    let mut mesh_corners = match face {
        Face::Triangle([a, b, c]) => [a, b, c, c],
        Face::Quad(corners) => corners,
    };
    let corner_count = face.corners().len();
    // A mirror turns the winding around; so does the user's wish.
    if (instance.world_from_mesh.matrix3.determinant() < 0.0) != instance.flipped {
        mesh_corners[..corner_count].reverse();
        if corner_count == 3 {
            mesh_corners[3] = mesh_corners[2];
        }
    }
    let corners = mesh_corners.map(|c| {
        instance
            .world_from_mesh
            .transform_point3(mesh.positions[c as usize])
    });
    let normal = newell_normal(&corners[..corner_count]);
    let longest = (0..corner_count)
        .map(|i| corners[i].distance_squared(corners[(i + 1) % corner_count]))
        .fold(0.0, f32::max);
    // Twice the area against the longest edge: below this the normal is made of rounding errors.
    if !normal.is_finite() || normal.length() <= 1e-6 * longest || longest == 0.0 {
        return None;
    }
    let index32 = |i: usize| u32::try_from(i).expect("a scene has fewer than 2^32 faces");
    Some(WorldFace {
        corners,
        mesh_corners,
        corner_count: if corner_count == 4 { 4 } else { 3 },
        normal: normal.normalize(),
        instance: index32(number),
        face: index32(index),
        material: index32(mesh.material),
    })
}

/// Twice the vector area of a polygon (Newell's method): its direction is the normal of the side from which the corners
/// run counter-clockwise.
pub fn newell_normal(polygon: &[Vec3]) -> Vec3 {
    let origin = polygon[0];
    let edges = polygon
        .windows(2)
        .map(|pair| (pair[0] - origin).cross(pair[1] - origin));
    edges.sum()
}

/// The quad of triangles `i` and `i + 1`, if they are two halves of a planar convex one.
fn merged_quad(mesh: &Mesh, i: usize) -> Option<Face> {
    let (Face::Triangle(first), Face::Triangle(second)) =
        (*mesh.faces.get(i)?, *mesh.faces.get(i + 1)?)
    else {
        return None;
    };
    // Rotate both so that the shared edge runs from c to a in the first and from a to c in the second.
    let rotations = |t: [u32; 3]| [t, [t[1], t[2], t[0]], [t[2], t[0], t[1]]];
    let (quad, _) = rotations(first)
        .into_iter()
        .flat_map(|one| rotations(second).map(|two| (one, two)))
        .find(|(one, two)| same_corner(mesh, one[0], two[0]) && same_corner(mesh, one[2], two[1]))
        .map(|([a, b, c], [_, _, d])| ([a, b, c, d], ()))?;
    is_planar_and_convex(quad.map(|corner| mesh.positions[corner as usize]))
        .then_some(Face::Quad(quad))
}

/// Whether two vertices agree in position and in everything that a surface takes from them.
fn same_corner(mesh: &Mesh, a: u32, b: u32) -> bool {
    let (i, j) = (a as usize, b as usize);
    a == b
        || (mesh.positions[i] == mesh.positions[j]
            && mesh.texcoords.iter().all(|set| set[i] == set[j])
            && (mesh.colors.is_empty() || mesh.colors[i] == mesh.colors[j]))
}

fn is_planar_and_convex(corners: [Vec3; 4]) -> bool {
    let doubled_area = newell_normal(&corners);
    let Some(normal) = doubled_area.try_normalize() else {
        return false;
    };
    let size = doubled_area.length().sqrt();
    let flat = corners
        .iter()
        .all(|&c| (c - corners[0]).dot(normal).abs() <= 1e-4 * size);
    // Texture coordinates follow the two triangles, so a strong bend in a corner does no harm; a reflex one would.
    let convex = (0..4).all(|i| {
        let (before, here, after) = (corners[(i + 3) % 4], corners[i], corners[(i + 1) % 4]);
        (here - before).cross(after - here).dot(normal) > 1e-3 * doubled_area.length()
    });
    flat && convex
}
