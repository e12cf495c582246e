//! Models with faults: vertices that nearly agree, faces turned inside out, faces upon one another in one plane.

use glam::{Affine3A, Vec3};
use hemicube::radiosity::patch::clean::CleanOptions;
use hemicube::radiosity::patch::face::WorldFace;
use hemicube::radiosity::{PatchMesh, PatchOptions};
use hemicube::raster::Rgb;
use hemicube::scene::{Camera, Face, Instance, Material, Mesh, Scene, builtin};
use std::collections::HashSet;
use std::sync::Arc;

/// A box with one mesh, turned inside out if it is a room, each face with vertices of its own.
fn box_mesh(name: &str, material: usize, low: Vec3, high: Vec3, is_room: bool) -> Mesh {
    let corner = |i: usize| {
        Vec3::select(
            glam::BVec3::new(i & 1 == 1, i & 2 == 2, i & 4 == 4),
            high,
            low,
        )
    };
    let sides = [
        [0, 4, 6, 2],
        [1, 3, 7, 5],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 2, 3, 1],
        [4, 5, 7, 6],
    ];
    let mut mesh = Mesh {
        name: name.to_owned(),
        material,
        ..Mesh::default()
    };
    for mut side in sides {
        if is_room {
            side.reverse();
        }
        push_quad(&mut mesh, side.map(corner));
    }
    mesh
}

fn push_quad(mesh: &mut Mesh, corners: [Vec3; 4]) {
    let first = u32::try_from(mesh.positions.len()).expect("few vertices");
    mesh.positions.extend(corners);
    mesh.faces.push(Face::Quad([0, 1, 2, 3].map(|i| first + i)));
}

fn turn(mesh: &mut Mesh, face: usize) {
    let Face::Quad(corners) = &mut mesh.faces[face] else {
        panic!("boxes are of quads")
    };
    corners.reverse();
}

fn scene(meshes: Vec<Mesh>) -> Scene {
    let instances = meshes.iter().enumerate().map(|(i, mesh)| Instance {
        node: mesh.name.clone(),
        mesh: i,
        world_from_mesh: Affine3A::IDENTITY,
        flipped: false,
    });
    let lamp = Material {
        emission: Rgb::splat(100.0),
        ..Material::diffuse("lamp", Rgb::splat(0.2))
    };
    Scene {
        name: "model".to_owned(),
        instances: instances.collect(),
        meshes,
        materials: vec![Material::diffuse("paint", Rgb::splat(0.5)), lamp],
        ..Scene::default()
    }
}

/// A room with a lamp on its ceiling and a crate on its floor.
fn room() -> Scene {
    let mut lamp = Mesh {
        name: "lamp".to_owned(),
        material: 1,
        ..Mesh::default()
    };
    let [a, b, c, d] =
        [(1.0, 1.0), (2.0, 1.0), (2.0, 2.0), (1.0, 2.0)].map(|(x, z)| Vec3::new(x, 2.9, z));
    push_quad(&mut lamp, [a, b, c, d]);
    scene(vec![
        box_mesh("room", 0, Vec3::ZERO, Vec3::splat(3.0), true),
        box_mesh(
            "crate",
            0,
            Vec3::new(0.5, 0.4, 0.5),
            Vec3::new(1.5, 1.0, 1.2),
            false,
        ),
        lamp,
    ])
}

fn mesh(scene: Scene, clean: CleanOptions) -> PatchMesh {
    let options = PatchOptions::whole_faces().with_clean(clean);
    PatchMesh::build(Arc::new(scene), options).expect("it can be cut")
}

/// What a face is, wherever its corners begin.
fn place(face: &WorldFace) -> Vec<[u32; 3]> {
    let bits = |p: &Vec3| (*p + Vec3::ZERO).to_array().map(f32::to_bits);
    let mut corners: Vec<_> = face.polygon().iter().map(bits).collect();
    let least = (0..corners.len()).min_by_key(|&i| corners[i]).unwrap_or(0);
    corners.rotate_left(least);
    corners
}

fn places(mesh: &PatchMesh) -> HashSet<Vec<[u32; 3]>> {
    mesh.faces().iter().map(place).collect()
}

fn said(mesh: &PatchMesh) -> String {
    let lines: Vec<String> = mesh
        .report()
        .warnings
        .iter()
        .map(ToString::to_string)
        .collect();
    lines.join("\n")
}

#[test]
fn models_without_faults_keep_their_bits() {
    for name in ["cornell", "two-rooms", "parallel-plates"] {
        let scene = builtin::scene(name).expect("it is built in");
        let [a, b] =
            [CleanOptions::default(), CleanOptions::none()].map(|clean| mesh(scene.clone(), clean));
        assert!(a.faces() == b.faces(), "{name}: {}", said(&a));
    }
}

#[test]
fn scenes_that_are_only_rounded_keep_their_faces() {
    for name in ["office", "steel-mill", "chapel", "conference-room"] {
        let scene = builtin::scene(name).expect("it is built in");
        let [a, b] =
            [CleanOptions::default(), CleanOptions::none()].map(|clean| mesh(scene.clone(), clean));
        let moves = a.faces().iter().zip(b.faces()).flat_map(|(a, b)| {
            let corners = a.polygon().iter().zip(b.polygon());
            corners.map(|(p, q)| p.distance(*q))
        });
        let farthest = moves.fold(0.0, f32::max);
        let reach = a.visibility().diameter();
        assert!(
            farthest <= 2e-6 * reach,
            "{name}: {farthest} of {reach}; {}",
            said(&a)
        );
    }
}

#[test]
fn nearly_equal_vertices_become_one_and_details_stay() {
    let mut model = room();
    let count = mesh(model.clone(), CleanOptions::default())
        .vertices()
        .len();
    assert_eq!(count, 8 + 8 + 4, "corners of three boxes, one of them flat");
    for (i, p) in model.meshes[0].positions.iter_mut().enumerate() {
        let shift = [3e-6, -2e-6, 1e-6][i % 3];
        *p += Vec3::new(shift, -shift, 0.5 * shift);
    }
    let rough = mesh(model.clone(), CleanOptions::none());
    assert!(rough.vertices().len() > count, "the corners differ");
    let clean = mesh(model.clone(), CleanOptions::default());
    assert_eq!(
        clean.vertices().len(),
        count,
        "the room has eight corners again"
    );
    assert_eq!(said(&clean), "", "rounding is not worth a word");

    // A crate of a few micrometres is not a fault.
    model.meshes[1] = box_mesh("crate", 0, Vec3::splat(0.5), Vec3::splat(0.500_005), false);
    let tiny = mesh(model.clone(), CleanOptions::default().with_weld(0.01));
    assert_eq!(
        tiny.faces().len(),
        6 + 6 + 1,
        "no face has lost its area: {}",
        said(&tiny)
    );
    let of_crate = tiny.faces().iter().filter(|face| face.instance == 1);
    let crate_corners: HashSet<Vec<[u32; 3]>> = of_crate.map(place).collect();
    assert_eq!(crate_corners.len(), 6, "nor its place");
}

#[test]
fn a_wider_weld_closes_wider_gaps_only_if_asked() {
    let mut model = room();
    for p in &mut model.meshes[0].positions[..4] {
        *p += Vec3::new(0.004, 0.0, -0.003);
    }
    let as_it_is = mesh(model.clone(), CleanOptions::default());
    assert_eq!(as_it_is.vertices().len(), 12 + 8 + 4, "a gap of 5 mm stays");
    let welded = mesh(model, CleanOptions::default().with_weld(0.01));
    assert!(said(&welded).contains("vertices: "), "{}", said(&welded));
    assert_eq!(
        welded.vertices().len(),
        8 + 8 + 4,
        "unless it is asked to close"
    );
}

#[test]
fn faces_that_disagree_turn_to_what_sees_them() {
    let whole = mesh(room(), CleanOptions::default());
    assert_eq!(said(&whole), "", "nothing is wrong with it");
    // A minority and a majority of the crate's faces, and of the room's.
    for (model, wrong) in [
        (1, vec![0]),
        (1, vec![0, 1, 2, 3, 5]),
        (0, vec![1, 4]),
        (0, vec![0, 1, 2, 4, 5]),
    ] {
        let mut broken = room();
        for &face in &wrong {
            turn(&mut broken.meshes[model], face);
        }
        let mended = mesh(broken.clone(), CleanOptions::default());
        assert_eq!(
            places(&mended),
            places(&whole),
            "mesh {model}, faces {wrong:?}"
        );
        let told = format!("{} of 6 connected faces turned around", wrong.len());
        assert!(said(&mended).contains(&told), "{}", said(&mended));
        let as_it_is = mesh(broken, CleanOptions::none());
        assert_ne!(
            places(&as_it_is),
            places(&whole),
            "the test is about something"
        );
    }
}

#[test]
fn whole_shells_turn_to_the_light_only_if_asked() {
    let mut broken = room();
    for face in 0..6 {
        turn(&mut broken.meshes[1], face);
    }
    let whole = mesh(room(), CleanOptions::default());
    let kept = mesh(broken.clone(), CleanOptions::default());
    assert_ne!(
        places(&kept),
        places(&whole),
        "a shell that agrees is not touched"
    );
    let asked = CleanOptions::default().with_turn_to_light(true);
    assert_eq!(places(&mesh(broken, asked)), places(&whole), "unless asked");
    assert_eq!(
        places(&mesh(room(), asked)),
        places(&whole),
        "what is right stays"
    );
}

#[test]
fn cameras_decide_where_nothing_shines() {
    let mut broken = room();
    broken.meshes.truncate(2);
    broken.instances.truncate(2);
    broken.sky = Rgb::splat(1.0);
    for face in [0, 2, 3, 5] {
        turn(&mut broken.meshes[0], face);
    }
    let eye = Vec3::new(2.5, 1.5, 2.5);
    broken.cameras = vec![Camera::looking_at(
        "inside",
        eye,
        Vec3::splat(1.0),
        Vec3::Y,
        1.0,
    )];
    // Outside there is a sky; to begin with, let there be none.
    broken.sky = Rgb::BLACK;
    let inward = mesh(broken, CleanOptions::default());
    let of_room: Vec<&WorldFace> = inward.faces().iter().filter(|f| f.instance == 0).collect();
    for face in of_room {
        let centre = face.polygon().iter().sum::<Vec3>() / 4.0;
        assert!(
            face.normal.dot(Vec3::splat(1.5) - centre) > 0.0,
            "{centre} faces the room"
        );
    }
}

#[test]
fn a_moebius_strip_is_told_and_left_alone() {
    let mut strip = Mesh {
        name: "strip".to_owned(),
        ..Mesh::default()
    };
    let n = 12_u16;
    let rim = |i: u16, side: f32| {
        let turn = f32::from(i) / f32::from(n) * core::f32::consts::TAU;
        // Half a turn of the strip on the way around.
        let tilt = 0.5 * turn;
        let radius = 1.0 + side * 0.3 * tilt.cos();
        Vec3::new(
            radius * turn.cos(),
            side * 0.3 * tilt.sin(),
            radius * turn.sin(),
        )
    };
    for i in 0..n {
        let last = i + 1 == n;
        let (j, flip) = if last { (0, -1.0) } else { (i + 1, 1.0) };
        let [a, b, c, d] = [rim(i, -1.0), rim(i, 1.0), rim(j, flip), rim(j, -flip)];
        let first = u32::try_from(strip.positions.len()).expect("few vertices");
        strip.positions.extend([a, b, c, d]);
        strip
            .faces
            .push(Face::Triangle([first, first + 1, first + 2]));
        strip
            .faces
            .push(Face::Triangle([first, first + 2, first + 3]));
    }
    let mut model = room();
    let ring = scene(vec![strip]);
    model.meshes[1] = ring.meshes[0].clone();
    let [clean, raw] =
        [CleanOptions::default(), CleanOptions::none()].map(|c| mesh(model.clone(), c));
    assert_eq!(places(&clean), places(&raw), "nothing can be done");
    assert!(said(&clean).contains("Möbius"), "{}", said(&clean));
}

/// The room with a poster in the plane of the wall at x = 0, on both sides lit or not.
fn with_poster(double_sided: bool) -> Scene {
    let mut poster = Mesh {
        name: "poster".to_owned(),
        material: 2,
        ..Mesh::default()
    };
    let corners =
        [(1.0, 1.0), (2.0, 1.0), (2.0, 2.0), (1.0, 2.0)].map(|(y, z)| Vec3::new(0.0, y, z));
    push_quad(&mut poster, corners);
    let mut model = room();
    let mut paper = Material::diffuse("paper", Rgb::splat(0.9));
    paper.double_sided = double_sided;
    model.materials.push(paper);
    model.instances.push(Instance {
        node: "poster".to_owned(),
        mesh: model.meshes.len(),
        world_from_mesh: Affine3A::IDENTITY,
        flipped: false,
    });
    model.meshes.push(poster);
    model
}

#[test]
fn a_poster_in_its_wall_is_lifted_and_buries_the_wall() {
    for double_sided in [false, true] {
        let model = with_poster(double_sided);
        let options = PatchOptions::default().with_element_size(0.251);
        let mesh = PatchMesh::build(Arc::new(model), options).expect("it can be cut");
        assert!(
            said(&mesh).contains("node 'poster': 1 face in the plane"),
            "{}",
            said(&mesh)
        );
        let poster = mesh
            .faces()
            .iter()
            .find(|f| f.instance == 3)
            .expect("it is there");
        let height = poster.corners[0].x;
        assert!(height > 1e-5 && height < 1e-3, "lifted by {height}");
        let exposed = |of: &dyn Fn(&WorldFace) -> bool| -> f32 {
            let elements = mesh.elements().iter().enumerate();
            elements
                .filter(|(_, id)| match mesh.node(**id).kind {
                    hemicube::radiosity::patch::NodeKind::Surface { face, .. } => {
                        of(&mesh.faces()[face as usize])
                    }
                    hemicube::radiosity::patch::NodeKind::Cluster { .. } => false,
                })
                .map(|(e, _)| mesh.exposed_area(e))
                .sum()
        };
        let wall = exposed(&|f| f.instance == 0 && f.normal.x > 0.9);
        assert!((wall - 8.0).abs() < 0.08, "9 m² but for the poster: {wall}");
        let rays = (0..64_u16).map(|i| {
            let (y, z) = (f32::from(i % 8), f32::from(i / 8));
            let target = Vec3::new(0.0, 1.06 + 0.125 * y, 1.06 + 0.125 * z);
            let origin = Vec3::new(2.9, 1.5, 2.8);
            mesh.visibility()
                .first_hit(origin, (target - origin).normalize(), 10.0)
        });
        let on_poster = rays
            .flatten()
            .filter(|hit| mesh.faces()[hit.face].instance == 3)
            .count();
        assert_eq!(on_poster, 64, "every ray to the poster meets it");
    }
}

#[test]
fn stacks_rise_by_layers_and_neighbours_stay() {
    let mut model = with_poster(false);
    let label = [(1.2, 1.2), (1.4, 1.2), (1.4, 1.4), (1.2, 1.4)].map(|(y, z)| Vec3::new(0.0, y, z));
    let mut sticker = Mesh {
        name: "sticker".to_owned(),
        material: 1,
        ..Mesh::default()
    };
    push_quad(&mut sticker, label);
    model.instances.push(Instance {
        node: "sticker".to_owned(),
        mesh: model.meshes.len(),
        world_from_mesh: Affine3A::IDENTITY,
        flipped: false,
    });
    model.meshes.push(sticker);
    let mesh = mesh(model, CleanOptions::default());
    let x = |instance: u32| {
        let face = mesh.faces().iter().find(|f| f.instance == instance);
        face.expect("it is there").corners[0].x
    };
    assert!(
        x(3) > 0.0 && (x(4) / x(3) - 2.0).abs() < 1e-3,
        "{} and {}",
        x(3),
        x(4)
    );
    let room = mesh.faces().iter().filter(|f| f.instance < 3);
    assert!(
        room.flat_map(|f| f.polygon())
            .all(|p| p.x == 0.0 || p.x >= 0.5),
        "walls that only touch stay"
    );
}
