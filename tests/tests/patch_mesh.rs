//! The patch mesh: areas, cuts, shared vertices.

use glam::{Affine3A, Vec3};
use hemicube::radiosity::{PatchMesh, PatchOptions};
use hemicube::raster::Rgb;
use hemicube::scene::{Face, Instance, Material, Mesh, Scene, builtin};
use std::collections::HashMap;
use std::sync::Arc;

fn mesh_of(scene: Scene, options: PatchOptions) -> PatchMesh {
    PatchMesh::build(Arc::new(scene), options).expect("the scene can be cut")
}

fn builtin_mesh(name: &str, options: PatchOptions) -> PatchMesh {
    mesh_of(builtin::scene(name).expect("it is built in"), options)
}

#[test]
fn both_cuts_have_the_area_of_the_scene() {
    for name in ["cornell", "two-rooms", "office"] {
        let coarse = builtin_mesh(name, PatchOptions::default().with_element_size(1e6));
        let fine = builtin_mesh(
            name,
            PatchOptions::default()
                .with_elements(3000)
                .with_patches(300),
        );
        let area = |mesh: &PatchMesh, ids: &[_]| {
            ids.iter()
                .map(|&id| f64::from(mesh.node(id).area))
                .sum::<f64>()
        };
        let whole = area(&coarse, coarse.elements());
        for (cut, ids) in [("elements", fine.elements()), ("patches", fine.patches())] {
            let sum = area(&fine, ids);
            assert!(
                (sum / whole - 1.0).abs() < 1e-5,
                "{name}: {cut} have {sum}, the faces {whole}"
            );
        }
    }
}

#[test]
fn elements_lie_under_their_patch_and_on_their_face() {
    let mesh = builtin_mesh(
        "cornell",
        PatchOptions::default()
            .with_elements(2000)
            .with_patches(200),
    );
    for patch in 0..mesh.patches().len() {
        let ids = mesh.elements_of_patch(patch);
        let below: f64 = ids
            .clone()
            .map(|e| f64::from(mesh.node(mesh.elements()[e]).area))
            .sum();
        let area = f64::from(mesh.node(mesh.patches()[patch]).area);
        assert!(
            (below / area - 1.0).abs() < 1e-4,
            "patch {patch}: {below} in elements, {area} itself"
        );
        assert!(
            ids.into_iter().all(|e| mesh.patch_of_element(e) == patch),
            "patch {patch}: the way back"
        );
    }
}

#[test]
fn a_point_finds_its_element() {
    use hemicube::radiosity::patch::{NodeKind, face::Side};
    for name in ["cornell", "office"] {
        let mesh = builtin_mesh(name, PatchOptions::default().with_elements(2000));
        for (e, &id) in mesh.elements().iter().enumerate() {
            let node = mesh.node(id);
            let NodeKind::Surface { face, side } = node.kind else {
                panic!("elements are surfaces")
            };
            assert_eq!(
                mesh.element_at(face as usize, side, node.centroid),
                Some(e),
                "{name}: element {e}"
            );
            if side == Side::Front
                && mesh.element_at(face as usize, Side::Back, node.centroid) == Some(e)
            {
                panic!("{name}: element {e} is on both sides");
            }
        }
    }
}

/// Edges that a vertex of the mesh lies on, without ending there.
fn t_vertices(mesh: &PatchMesh) -> usize {
    let mut cells: HashMap<[i64; 3], Vec<u32>> = HashMap::new();
    let size = 0.05_f32;
    #[expect(clippy::cast_possible_truncation, reason = "cells of a small scene")]
    let cell = |p: Vec3| (p / size).floor().to_array().map(|x| x as i64);
    for (v, &p) in mesh.vertices().iter().enumerate() {
        cells
            .entry(cell(p))
            .or_default()
            .push(u32::try_from(v).expect("few vertices"));
    }
    let mut count = 0;
    for &id in mesh.elements() {
        let corners = mesh.corners(id);
        for i in 0..corners.len() {
            let (a, b) = (corners[i], corners[(i + 1) % corners.len()]);
            let (pa, pb) = (mesh.vertices()[a as usize], mesh.vertices()[b as usize]);
            let middle = cell((pa + pb) * 0.5);
            let around =
                (-1..=1).flat_map(|x| (-1..=1).flat_map(move |y| (-1..=1).map(move |z| [x, y, z])));
            let near = around
                .filter_map(|d| cells.get(&[middle[0] + d[0], middle[1] + d[1], middle[2] + d[2]]))
                .flatten();
            let inside = |v: u32| {
                let p = mesh.vertices()[v as usize];
                let t = (p - pa).dot(pb - pa) / pa.distance_squared(pb);
                v != a
                    && v != b
                    && (0.01..0.99).contains(&t)
                    && (pa + (pb - pa) * t).distance(p) < 1e-5
            };
            count += near.filter(|&&v| inside(v)).count();
        }
    }
    count
}

#[test]
fn shared_edges_have_shared_vertices() {
    use glam::Vec3;
    use hemicube::scene::Units;
    use hemicube::scene::builtin::SceneBuilder;
    // A tetrahedron-like fan of very different triangles, and quads that share edges with them.
    let mut builder = SceneBuilder::new("fan", Units::Photometric);
    let grey = builder.diffuse("grey", 0.5, 0.5, 0.5);
    builder.node("fan");
    let top = Vec3::new(0.1, 0.9, 0.2);
    let ring = [
        Vec3::X,
        Vec3::new(0.3, 0.0, 0.9),
        Vec3::new(-0.8, 0.1, 0.4),
        Vec3::new(-0.2, 0.0, -1.1),
    ];
    for i in 0..4 {
        let (a, b) = (ring[i], ring[(i + 1) % 4]);
        builder.quad(grey, [a, b, b - Vec3::Y, a - Vec3::Y]);
        builder.quad(grey, [b, a, a.lerp(top, 0.5), b.lerp(top, 0.5)]);
    }
    let scene = builder.finish();
    for size in [0.4, 0.17, 0.06] {
        let mesh = mesh_of(
            scene.clone(),
            PatchOptions::default().with_element_size(size),
        );
        assert_eq!(
            t_vertices(&mesh),
            0,
            "element size {size}, {} elements",
            mesh.elements().len()
        );
    }
    let furnace = builtin_mesh("furnace", PatchOptions::default().with_elements(700));
    assert_eq!(t_vertices(&furnace), 0, "the furnace");
}

#[test]
fn sizes_and_counts_are_kept() {
    for count in [100, 1000, 10_000] {
        // What is cut where faces meet comes on top.
        let options = PatchOptions::default()
            .with_elements(count)
            .with_joints(false);
        let mesh = builtin_mesh("cornell", options);
        let elements = mesh.elements().len();
        assert!(
            elements <= count + count / 4 + 40 && elements * 5 >= count,
            "{elements} elements for {count}"
        );
    }
    let mesh = builtin_mesh(
        "two-rooms",
        PatchOptions::default()
            .with_element_size(0.3)
            .with_patch_size(0.9)
            .with_joints(false),
    );
    for &id in mesh.elements() {
        let polygon = mesh.polygon(id);
        let longest =
            (0..polygon.len()).map(|i| polygon[i].distance(polygon[(i + 1) % polygon.len()]));
        assert!(
            longest.fold(0.0, f32::max) <= 0.3 * 1.002,
            "an edge longer than 0.3 m"
        );
    }
}

/// A unit triangle, placed as told.
fn triangle(placed: &[Affine3A]) -> Scene {
    let mut scene = Scene {
        name: String::from("triangle"),
        ..Scene::default()
    };
    scene
        .materials
        .push(Material::diffuse("grey", Rgb::splat(0.5)));
    scene.meshes.push(Mesh {
        name: String::from("triangle"),
        positions: vec![Vec3::ZERO, Vec3::X, Vec3::Z],
        faces: vec![Face::Triangle([0, 1, 2])],
        ..Mesh::default()
    });
    for &world_from_mesh in placed {
        scene.instances.push(Instance {
            node: String::from("node"),
            mesh: 0,
            world_from_mesh,
            flipped: false,
        });
    }
    scene
}

#[test]
fn twenty_thousand_copies_in_one_place_count_once() {
    let mesh = mesh_of(
        triangle(&[Affine3A::IDENTITY; 20_000]),
        PatchOptions::default(),
    );
    assert_eq!(mesh.faces().len(), 1, "faces that are left");
    assert_eq!(mesh.report().unlisted, 18_999, "one warning a node");
    let back_to_back = Affine3A::from_scale(Vec3::new(1.0, -1.0, 1.0));
    let mesh = mesh_of(
        triangle(&[Affine3A::IDENTITY, back_to_back]),
        PatchOptions::default(),
    );
    assert_eq!(mesh.faces().len(), 2, "sides of a sheet are no copies");
}

#[test]
fn coordinates_whose_areas_overflow_are_refused() {
    for size in [1e10, 1e12, 1e15, 1e18, 1e19] {
        let scene = Arc::new(triangle(&[Affine3A::from_scale(Vec3::splat(size))]));
        let error = PatchMesh::build(scene, PatchOptions::default())
            .expect_err("it is refused")
            .to_string();
        assert!(
            error.contains("--unit") && !error.contains('\n'),
            "size {size}: {error}"
        );
    }
}

#[test]
fn senseless_sizes_are_refused() {
    let scene = Arc::new(builtin::scene("furnace").expect("it is built in"));
    let bad = [
        PatchOptions::default().with_element_size(0.0),
        PatchOptions::default().with_element_size(-1.0),
        PatchOptions::default().with_patch_size(f32::NAN),
        PatchOptions::default().with_elements(0),
        PatchOptions::default().with_element_size(1e-5),
    ];
    for options in bad {
        let error = PatchMesh::build(scene.clone(), options).expect_err("it is refused");
        assert!(!error.to_string().contains('\n'), "in one line: {error}");
    }
}

#[test]
fn there_are_as_many_elements_as_are_asked_for() {
    // The faces of a furnace and of the plates are all alike; the chapel has 3553 lit sides, and joints add a tenth.
    let scenes = [
        "cornell",
        "two-rooms",
        "furnace",
        "parallel-plates",
        "chapel",
    ];
    for (name, asked) in scenes
        .iter()
        .flat_map(|name| [(name, 2000), (name, 20_000)])
    {
        let options = PatchOptions::default().with_elements(asked);
        let mesh = builtin_mesh(name, options);
        let (made, sides) = (mesh.elements().len(), mesh.lit_sides());
        if 3 * asked < 4 * sides {
            assert!(
                made > sides,
                "{name}: {made} elements, one for each of {sides} sides"
            );
            continue;
        }
        let off = made as f64 / asked as f64 - 1.0;
        assert!(off.abs() < 0.05, "{name}: {made} elements for {asked}");
    }
}

#[test]
fn patches_are_about_as_many_as_are_asked_for() {
    for (name, asked) in [("cornell", 400), ("two-rooms", 400), ("cornell", 2000)] {
        let options = PatchOptions::default()
            .with_elements(8000)
            .with_patches(asked);
        let made = builtin_mesh(name, options).patches().len();
        let off = made as f64 / asked as f64 - 1.0;
        assert!(off.abs() < 0.1, "{name}: {made} patches for {asked}");
    }
}

#[test]
fn more_elements_asked_for_are_never_fewer() {
    let mut before = 0;
    for asked in [30, 31, 100, 101, 500, 510, 4000, 4100, 9000] {
        let made = builtin_mesh("cornell", PatchOptions::default().with_elements(asked));
        let made = made.elements().len();
        assert!(
            made * 50 >= before * 49,
            "{made} elements for {asked}, {before} for fewer"
        );
        before = made;
    }
}
