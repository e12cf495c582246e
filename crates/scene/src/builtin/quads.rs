//! Scenes written as lists of quads in JSON: the project's reference rooms.

use crate::{Face, Instance, Material, Mesh, Scene, Units};
use glam::{Affine3A, Vec3};
use hemicube_raster::Rgb;
use serde::Deserialize;

/// Quads whose fourth corner lies farther from the plane of the others become two triangles (units of the file).
const PLANAR: f32 = 1e-3;

/// What is read of such a file; its areas and normals serve tests.
#[derive(Deserialize)]
struct QuadFile {
    name: String,
    quads: Vec<Quad>,
}

#[derive(Deserialize)]
struct Quad {
    name: String,
    vertices: [[f32; 3]; 4],
    reflectance: [f32; 3],
    emission: [f32; 3],
}

/// Reads a file of this crate: one mesh and one node per quad, named as it is; quads of equal reflectance and emission
/// share a material. `material_name` names the material of the first of them, given quad and reflectance.
pub(super) fn scene(json: &str, material_name: impl Fn(&str, Rgb) -> String) -> Scene {
    let file: QuadFile = serde_json::from_str(json).expect("the built-in file is valid");
    let mut scene = Scene {
        name: file.name,
        units: Units::Radiometric,
        ..Scene::default()
    };
    for quad in file.quads {
        let (reflectance, emission) = (Rgb::from(quad.reflectance), Rgb::from(quad.emission));
        let same = |m: &Material| m.base_color == reflectance && m.emission == emission;
        let material = scene.materials.iter().position(same).unwrap_or_else(|| {
            let name = material_name(&quad.name, reflectance);
            scene
                .materials
                .push(Material::diffuse(name, reflectance).with_emission(emission));
            scene.materials.len() - 1
        });
        let positions = quad.vertices.map(Vec3::from_array);
        let mesh = Mesh {
            name: quad.name.clone(),
            material,
            positions: positions.to_vec(),
            faces: faces(positions),
            ..Mesh::default()
        };
        scene.instances.push(Instance {
            node: quad.name,
            mesh: scene.meshes.len(),
            world_from_mesh: Affine3A::IDENTITY,
            flipped: false,
        });
        scene.meshes.push(mesh);
    }
    scene
}

/// The quad, or its halves on either side of the diagonal from corner 0 to 2 if it is not planar.
fn faces([a, b, c, d]: [Vec3; 4]) -> Vec<Face> {
    let distance = (b - a).cross(c - a).normalize_or_zero().dot(d - a).abs();
    if distance <= PLANAR {
        vec![Face::Quad([0, 1, 2, 3])]
    } else {
        vec![Face::Triangle([0, 1, 2]), Face::Triangle([0, 2, 3])]
    }
}
