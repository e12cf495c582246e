//! Enclosures cut into equal quads, as engineers bring them: each quad a face of its own.

use glam::{Affine3A, Vec3};
use hemicube::scene::{Face, Instance, Material, Mesh, Scene};

/// The unit cube seen from inside, each face n × n quads.
pub fn cube(n: u32) -> Scene {
    scene(
        "cube",
        &[("walls", box_mesh(Vec3::ZERO, Vec3::ONE, n, true))],
    )
}

/// A room of 4 × 4 × 3 m, its faces n × n quads, with a cube of 1 m floating at its centre, its faces m × m quads.
pub fn room_with_cube(n: u32, m: u32) -> Scene {
    let size = Vec3::new(4.0, 3.0, 4.0);
    let corner = 0.5 * size - Vec3::splat(0.5);
    scene(
        "room with a floating cube",
        &[
            ("room", box_mesh(Vec3::ZERO, size, n, true)),
            ("cube", box_mesh(corner, corner + 1.0, m, false)),
        ],
    )
}

fn scene(name: &str, meshes: &[(&str, Mesh)]) -> Scene {
    Scene {
        name: name.into(),
        instances: (0..meshes.len())
            .map(|mesh| Instance {
                node: meshes[mesh].0.into(),
                mesh,
                world_from_mesh: Affine3A::IDENTITY,
                flipped: false,
            })
            .collect(),
        meshes: meshes.iter().map(|(_, mesh)| mesh.clone()).collect(),
        materials: vec![Material::default()],
        ..Scene::default()
    }
}

/// The six faces of a box, lit inside or outside.
fn box_mesh(low: Vec3, high: Vec3, n: u32, inside: bool) -> Mesh {
    let size = high - low;
    let mut mesh = Mesh::default();
    for axis in 0..3 {
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        for at_high in [false, true] {
            let first = u32::try_from(mesh.positions.len()).expect("few vertices");
            let at = |i: u32, j: u32| first + i * (n + 1) + j;
            for i in 0..=n {
                for j in 0..=n {
                    let mut p = if at_high { high } else { low };
                    p[u] = low[u] + size[u] * (i as f32 / n as f32);
                    p[v] = low[v] + size[v] * (j as f32 / n as f32);
                    mesh.positions.push(p);
                }
            }
            for i in 0..n {
                for j in 0..n {
                    // u × v is the axis: seen from the side of larger coordinates these run counter-clockwise.
                    let quad = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
                    let [a, b, c, d] = quad;
                    let turned = at_high == inside;
                    mesh.faces
                        .push(Face::Quad(if turned { [a, d, c, b] } else { quad }));
                }
            }
        }
    }
    mesh
}
