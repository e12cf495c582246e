//! The triangles that rays meet.

use crate::hemicube::count;
use glam::Vec3;
use hemicube_radiosity::patch::face::Side;
use hemicube_radiosity::patch::{NodeKind, PatchMesh};
use hemicube_shaders::raycast as twins;

/// The triangles of all elements, turning counter-clockwise around their normals, and then of obstructions.
pub(super) fn triangles(mesh: &PatchMesh) -> Vec<twins::RayTriangle> {
    let mut triangles = Vec::new();
    let mut add = |corners: &[Vec3], element: u32, both_sides: bool| {
        for k in 1..corners.len() - 1 {
            let [a, b, c] = [0, k, k + 1].map(|i| corners[i].to_array());
            let both_sides = u32::from(both_sides);
            triangles.push(twins::RayTriangle {
                a,
                element,
                b,
                both_sides,
                c,
                padding: 0,
            });
        }
    };
    for (e, &id) in mesh.elements().iter().enumerate() {
        let NodeKind::Surface { face, .. } = mesh.node(id).kind else {
            unreachable!("elements are surfaces")
        };
        let both = mesh.visibility().receives(face as usize, Side::Back);
        let polygon = mesh.polygon(id);
        let (first, second) = (polygon[1] - polygon[0], polygon[2] - polygon[0]);
        let turns = first.cross(second).dot(mesh.node(id).normal) >= 0.0;
        let mut corners = polygon.to_vec();
        if !turns {
            corners.reverse();
        }
        add(&corners, count(e), both);
    }
    for (_, cell) in mesh.obstructions() {
        let corners: Vec<Vec3> = cell
            .corners()
            .iter()
            .map(|&c| mesh.vertices()[c as usize])
            .collect();
        add(&corners, count(mesh.elements().len()), false);
    }
    triangles
}
