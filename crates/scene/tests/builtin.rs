//! The built-in scenes against their sources and against what geometry demands.

use glam::{DVec2, DVec3, Vec2, Vec3, Vec4};
use hemicube_raster::Rgb;
use hemicube_scene::builtin::{self, SceneBuilder, Sides};
use hemicube_scene::{Face, Material, Scene, Units};
use serde_json::Value;

fn scene(name: &str) -> Scene {
    builtin::scene(name).expect("it is in the list")
}

/// Corners of all faces as placed, with the material.
fn faces(scene: &Scene) -> Vec<(String, usize, Vec<Vec3>)> {
    let mut all = Vec::new();
    for instance in &scene.instances {
        let mesh = &scene.meshes[instance.mesh];
        for face in &mesh.faces {
            let place = |&corner: &u32| {
                instance
                    .world_from_mesh
                    .transform_point3(mesh.positions[corner as usize])
            };
            all.push((
                instance.node.clone(),
                mesh.material,
                face.corners().iter().map(place).collect(),
            ));
        }
    }
    all
}

/// Area times normal of a polygon, in f64: sums must balance.
fn vector_area(corners: &[Vec3]) -> DVec3 {
    let at = |i: usize| corners[i].as_dvec3();
    (1..corners.len() - 1)
        .map(|i| (at(i) - at(0)).cross(at(i + 1) - at(0)) * 0.5)
        .sum()
}

#[test]
fn all_of_the_list_are_valid_and_lit() {
    for listed in builtin::list() {
        let scene = scene(listed.name);
        assert!(
            scene.check().is_ok(),
            "{}: {:?}",
            listed.name,
            scene.check()
        );
        assert_eq!(scene.name, listed.name, "name");
        assert!(scene.has_light(), "{} is dark", listed.name);
        assert!(
            !scene.cameras.is_empty(),
            "{} cannot be looked at",
            listed.name
        );
        assert!(
            !listed.description.is_empty() && !listed.description.contains('\n'),
            "{}",
            listed.description
        );
        let mut names: Vec<&str> = scene.cameras.iter().map(|c| c.name.as_str()).collect();
        names.dedup();
        assert_eq!(
            names.len(),
            scene.cameras.len(),
            "{}: cameras have names of their own",
            listed.name
        );
        let mut materials: Vec<&str> = scene.materials.iter().map(|m| m.name.as_str()).collect();
        materials.sort_unstable();
        materials.dedup();
        assert_eq!(
            materials.len(),
            scene.materials.len(),
            "{}: materials have names of their own",
            listed.name
        );
    }
    assert!(builtin::scene("teapot").is_none(), "an unknown name");
}

/// Areas, normals, reflectances and emissions of a file of quads against the scene made from it.
fn agrees_with_its_file(name: &str, json: &str) -> Scene {
    let scene = scene(name);
    let file: Value = serde_json::from_str(json).expect("it is JSON");
    let quads = file["quads"].as_array().expect("it has quads");
    assert_eq!(scene.instances.len(), quads.len(), "one node per quad");
    let band = |value: &Value, i: usize| value[i].as_f64().expect("a number");
    for (quad, instance) in quads.iter().zip(&scene.instances) {
        let (mesh, node) = (&scene.meshes[instance.mesh], &instance.node);
        assert_eq!(Some(node.as_str()), quad["name"].as_str(), "names in order");
        let placed: Vec<DVec3> = mesh
            .faces
            .iter()
            .map(|face| {
                vector_area(
                    &face
                        .corners()
                        .iter()
                        .map(|&c| mesh.positions[c as usize])
                        .collect::<Vec<_>>(),
                )
            })
            .collect();
        let area: f64 = placed.iter().map(|v| v.length()).sum();
        let wanted = quad["area"].as_f64().expect("a number");
        // Coordinates are f32 here and f64 there.
        assert!(
            (area / wanted - 1.0).abs() < 1e-5,
            "{node}: area {area}, not {wanted}"
        );
        let normal = &quad["normal"];
        let normal = DVec3::new(band(normal, 0), band(normal, 1), band(normal, 2));
        assert!(
            placed[0].normalize().dot(normal) > 0.9999,
            "{node}: front {} not {normal}",
            placed[0].normalize()
        );
        let material = &scene.materials[mesh.material];
        for i in 0..3 {
            let (rho, emission) = (band(&quad["reflectance"], i), band(&quad["emission"], i));
            assert!(
                (f64::from(material.base_color[i]) - rho).abs() < 1e-6,
                "{node}: reflectance {i}"
            );
            assert!(
                (f64::from(material.emission[i]) - emission).abs() < 1e-6,
                "{node}: emission {i}"
            );
        }
        let planar = quad["planar_error"].as_f64().expect("a number") < 1e-3;
        assert_eq!(
            matches!(mesh.faces[..], [Face::Quad(_)]),
            planar,
            "{node}: planar quads stay whole"
        );
    }
    assert_eq!(scene.units, Units::Radiometric, "units");
    scene
}

#[test]
fn cornell_is_what_was_measured() {
    let scene = agrees_with_its_file("cornell", include_str!("../src/builtin/cornell.json"));
    assert_eq!(
        scene.face_count(),
        20,
        "18 quads and the halves of the red wall"
    );
    let materials: Vec<&str> = scene.materials.iter().map(|m| m.name.as_str()).collect();
    assert_eq!(
        materials,
        ["white", "light", "green", "red"],
        "shared materials"
    );
    assert_eq!(
        scene.materials[1].base_color,
        Rgb::splat(0.78),
        "the light reflects"
    );
    let camera = scene.camera("front").expect("it has that camera");
    assert_eq!(
        (camera.eye, camera.forward),
        (Vec3::new(278.0, 273.0, -800.0), Vec3::Z),
        "camera"
    );
    let red = scene
        .instances
        .iter()
        .find(|i| i.node == "left_red")
        .expect("the red wall");
    let halves = [Face::Triangle([0, 1, 2]), Face::Triangle([0, 2, 3])];
    assert_eq!(scene.meshes[red.mesh].faces, halves, "split along v0-v2");
}

#[test]
fn two_rooms_are_what_the_file_says_and_closed() {
    let scene = agrees_with_its_file("two-rooms", include_str!("../src/builtin/two_rooms.json"));
    assert_eq!(scene.face_count(), 88, "all of them planar");
    assert!(scene.camera("room-b").is_ok(), "a view of room B");
}

#[test]
fn furnace_is_closed_and_looks_inward() {
    for (reflectance, exitance) in [(0.5, 1.0), (0.9, 2.0)] {
        let scene = builtin::furnace_with(reflectance, exitance);
        let faces = faces(&scene);
        let total: DVec3 = faces.iter().map(|f| vector_area(&f.2)).sum();
        assert!(
            total.length() < 1e-6,
            "a closed surface has no vector area: {total}"
        );
        let flux: f64 = faces
            .iter()
            .map(|f| vector_area(&f.2).dot(f.2[0].as_dvec3()))
            .sum();
        // Flux of the position through the closed surface is three times the volume, negative as normals look in.
        assert!((flux + 24.0).abs() < 1e-5, "flux {flux}");
        assert!(
            (scene.materials[0].emission.r * std::f32::consts::PI - exitance).abs() < 1e-6,
            "exitance"
        );
        assert_eq!(
            scene.materials[0].base_color,
            Rgb::splat(reflectance),
            "reflectance"
        );
        assert_eq!(scene.face_count(), 6, "quads");
    }
}

#[test]
fn plates_face_each_other() {
    for (name, source, receiver) in [
        ("parallel-plates", DVec3::Y, DVec3::NEG_Y),
        ("perpendicular-plates", DVec3::Y, DVec3::Z),
    ] {
        let faces = faces(&scene(name));
        assert_eq!(
            vector_area(&faces[0].2),
            source,
            "{name}: unit area, source"
        );
        assert_eq!(
            vector_area(&faces[1].2),
            receiver,
            "{name}: unit area, receiver"
        );
    }
}

#[test]
fn office_has_sound_faces() {
    let scene = scene("office");
    let count = scene.face_count();
    assert!((3_000..=12_000).contains(&count), "{count} faces");
    for (node, material, corners) in faces(&scene) {
        let area = vector_area(&corners);
        // Leaves have the smallest faces: about 1 mm².
        assert!(
            area.length() > 1e-8,
            "{node}, {}: area {}",
            scene.materials[material].name,
            area.length()
        );
        if let [a, b, c, d] = corners[..] {
            let normal = area.normalize().as_vec3();
            let off = normal
                .dot(b - a)
                .abs()
                .max(normal.dot(c - a).abs())
                .max(normal.dot(d - a).abs());
            assert!(off < 1e-4, "{node}: a corner {off} m off its quad");
            let corner = [a, b, c, d];
            let turns = |i: usize| {
                (corner[(i + 1) % 4] - corner[i])
                    .cross(corner[(i + 2) % 4] - corner[(i + 1) % 4])
                    .dot(normal)
            };
            assert!(
                (0..4).all(|i| turns(i) >= -1e-9),
                "{node}: a quad is not convex"
            );
        }
    }
}

#[test]
fn office_normals_are_on_the_front() {
    let scene = scene("office");
    for mesh in &scene.meshes {
        for face in &mesh.faces {
            let corners: Vec<Vec3> = face
                .corners()
                .iter()
                .map(|&c| mesh.positions[c as usize])
                .collect();
            let front = vector_area(&corners).normalize().as_vec3();
            for &corner in face.corners() {
                let normal = mesh.normals[corner as usize];
                assert!(
                    (normal.length() - 1.0).abs() < 1e-4,
                    "{}: length {}",
                    mesh.name,
                    normal.length()
                );
                // A bar that bends by a right angle has normals of 79 degrees.
                assert!(
                    normal.dot(front) > 0.15,
                    "{}: {normal} on a face towards {front}",
                    mesh.name
                );
            }
        }
    }
}

#[test]
fn office_cameras_stand_in_the_room() {
    let scene = scene("office");
    for name in ["entrance", "desk", "window", "corner"] {
        let camera = scene.camera(name).expect("it is promised");
        assert!(
            camera.eye.cmpgt(Vec3::splat(0.3)).all()
                && camera.eye.cmplt(Vec3::new(5.7, 2.5, 4.3)).all(),
            "{name}: {}",
            camera.eye
        );
        assert!(
            (1.2..=1.7).contains(&camera.eye.y),
            "{name}: height of the eye {}",
            camera.eye.y
        );
        let hemicube_scene::Projection::Perspective { vertical_fov, .. } = camera.projection else {
            panic!("{name} is a perspective view")
        };
        assert!(
            (50.0..=75.0).contains(&vertical_fov.to_degrees()),
            "{name}: {}",
            vertical_fov.to_degrees()
        );
    }
    let (low, high) = scene.bounds().expect("it is not empty");
    assert!(low.y >= 0.0, "nothing goes through the floor: {low}");
    assert!(
        high.cmple(Vec3::new(6.1, 2.84, 4.61)).all()
            && low.cmpge(Vec3::new(-0.21, 0.0, -0.001)).all(),
        "{low} {high}"
    );
}

/// From every camera a sphere of rays: each one ends on the front of something.
#[test]
fn office_is_closed_and_seen_from_the_front() {
    let scene = scene("office");
    let all = faces(&scene);
    let triangles: Vec<(&str, bool, [Vec3; 3])> = all
        .iter()
        .flat_map(|(node, material, c)| {
            let double = scene.materials[*material].double_sided;
            (1..c.len() - 1).map(move |i| (node.as_str(), double, [c[0], c[i], c[i + 1]]))
        })
        .collect();
    for camera in &scene.cameras {
        for i in 0..200_i16 {
            // A spiral of directions around the sphere, off the axes.
            let y = 1.0 - (2.0 * f32::from(i) + 1.0) / 200.0;
            let turn = 2.399_963 * f32::from(i) + 0.1;
            let radius = (1.0 - y * y).sqrt();
            let direction = Vec3::new(radius * turn.cos(), y, radius * turn.sin());
            let nearest = triangles
                .iter()
                .filter_map(|(node, double, t)| {
                    hit(camera.eye, direction, *t).map(|(k, front)| (k, front || *double, *node))
                })
                .min_by(|a, b| a.0.total_cmp(&b.0));
            let Some((_, front, node)) = nearest else {
                panic!("camera {}: nothing towards {direction}", camera.name)
            };
            assert!(
                front,
                "camera {}: the back of '{node}' towards {direction}",
                camera.name
            );
        }
    }
}

/// Distance and side of a ray's hit.
fn hit(from: Vec3, direction: Vec3, [a, b, c]: [Vec3; 3]) -> Option<(f32, bool)> {
    let (ab, ac) = (b - a, c - a);
    let across = direction.cross(ac);
    let volume = ab.dot(across);
    if volume.abs() < 1e-12 {
        return None;
    }
    let offset = from - a;
    let u = offset.dot(across) / volume;
    let v = direction.dot(offset.cross(ab)) / volume;
    let distance = ac.dot(offset.cross(ab)) / volume;
    (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && distance > 1e-4).then_some((distance, volume > 0.0))
}

#[test]
fn office_textures_and_reflectances_are_believable() {
    let scene = scene("office");
    assert_eq!(scene.units, Units::Photometric, "units");
    for image in &scene.images {
        let (width, height) = (image.pixels().width(), image.pixels().height());
        assert!(
            width <= 1024 && height <= 1024,
            "{}: {width} x {height}",
            image.name
        );
        let first = image.pixels().pixels()[0];
        assert!(
            image.pixels().pixels().iter().any(|texel| *texel != first),
            "{} is of one colour",
            image.name
        );
        assert!(
            image.pixels().pixels().iter().all(|texel| texel[3] == 255),
            "{} is opaque",
            image.name
        );
    }
    for (i, material) in scene.materials.iter().enumerate() {
        let mut sum = Rgb::BLACK;
        let side = 24_u8;
        for (x, y) in (0..side).flat_map(|x| (0..side).map(move |y| (x, y))) {
            let at = (Vec2::new(f32::from(x), f32::from(y)) + 0.5) / f32::from(side);
            let surface = scene.surface_at(i, &[at], Vec4::ONE);
            assert!(!surface.clamped, "{}: {surface:?}", material.name);
            sum += surface.reflectance / f32::from(side).powi(2);
        }
        assert!(
            sum.max_band() > 0.02 && sum.max_band() < 0.86,
            "{}: mean reflectance {sum:?}",
            material.name
        );
        assert!(
            material.emission.luminance() < 20_000.0,
            "{}: {:?} cd/m²",
            material.name,
            material.emission
        );
    }
    assert!(
        scene.materials.iter().filter(|m| m.emits()).count() >= 6,
        "several luminaires"
    );
    let used: Vec<usize> = scene.meshes.iter().map(|m| m.material).collect();
    let idle: Vec<&str> = scene
        .materials
        .iter()
        .enumerate()
        .filter(|(i, _)| !used.contains(i))
        .map(|(_, m)| m.name.as_str())
        .collect();
    assert!(idle.is_empty(), "materials that nothing has: {idle:?}");
}

#[test]
fn office_is_the_same_every_time() {
    let (first, second) = (scene("office"), scene("office"));
    assert_eq!(first.meshes, second.meshes, "meshes");
    for (a, b) in first.images.iter().zip(&second.images) {
        assert_eq!(a.encoded(), b.encoded(), "{}", a.name);
    }
}

/// Volume that a closed surface encloses, and its vector area, which is 0.
fn volume(draw: impl FnOnce(&mut SceneBuilder, usize)) -> f64 {
    let mut builder = SceneBuilder::new("solid", Units::Radiometric);
    let material = builder.material(Material::default());
    builder.node("solid");
    draw(&mut builder, material);
    let faces = faces(&builder.finish());
    let total: DVec3 = faces.iter().map(|f| vector_area(&f.2)).sum();
    assert!(total.length() < 1e-5, "not closed: {total}");
    faces
        .iter()
        .map(|f| f.2[0].as_dvec3().dot(vector_area(&f.2)) / 3.0)
        .sum()
}

#[test]
fn built_solids_are_closed_and_look_outward() {
    let pi = std::f64::consts::PI;
    let low = Vec3::new(-0.2, 0.1, -0.3);
    let cases: [(&str, f64, f64); 5] = [
        (
            "cuboid",
            volume(|b, m| b.cuboid(m, low, low + Vec3::new(0.5, 0.25, 1.0), Sides::ALL)),
            0.125,
        ),
        (
            "cylinder",
            volume(|b, m| b.cylinder(m, low, 0.5, 2.0, 64, [true, true])),
            0.5 * pi,
        ),
        ("sphere", volume(|b, m| b.sphere(m, low, 0.5, 64)), pi / 6.0),
        (
            "tube",
            volume(|b, m| b.tube(m, &[low, low + Vec3::X, low + Vec3::X * 2.0], 0.25, 64)),
            pi / 8.0,
        ),
        (
            "rounded",
            volume(|b, m| b.rounded(m, low, low + Vec3::splat(1.0), 0.5, 16)),
            pi / 6.0,
        ),
    ];
    for (name, volume, exact) in cases {
        // Facets lie inside the round shape; 64 of them lose less than 1 %.
        assert!(
            volume > 0.98 * exact && volume < 1.0001 * exact,
            "{name}: volume {volume}, round {exact}"
        );
    }
    let plate = volume(|b, m| b.plate(m, 3, 2, |u, v, w| Vec3::new(2.0 * u, v, 0.5 * w)));
    assert!((plate - 1.0).abs() < 1e-5, "plate: {plate}");
}

/// The part of a convex polygon in the plane on the left of a line (Sutherland and Hodgman 1974).
fn left_of(polygon: &[DVec2], from: DVec2, to: DVec2) -> Vec<DVec2> {
    let side = |p: DVec2| (to - from).perp_dot(p - from);
    let mut kept = Vec::new();
    for (i, &b) in polygon.iter().enumerate() {
        let a = polygon[(i + polygon.len() - 1) % polygon.len()];
        let (da, db) = (side(a), side(b));
        if (da >= 0.0) != (db >= 0.0) {
            kept.push(a.lerp(b, da / (da - db)));
        }
        if db >= 0.0 {
            kept.push(b);
        }
    }
    kept
}

/// The area that two convex polygons of one plane have in common; both counter-clockwise seen against its normal.
fn common_area(a: &[Vec3], b: &[Vec3], normal: DVec3) -> f64 {
    let right = normal.any_orthonormal_vector();
    let up = normal.cross(right);
    let flat = |p: &Vec3| DVec2::new(p.as_dvec3().dot(right), p.as_dvec3().dot(up));
    let other: Vec<DVec2> = b.iter().map(flat).collect();
    let mut rest: Vec<DVec2> = a.iter().map(flat).collect();
    for (i, &from) in other.iter().enumerate() {
        rest = left_of(&rest, from, other[(i + 1) % other.len()]);
    }
    let next = rest.iter().cycle().skip(1);
    let doubled: f64 = rest.iter().zip(next).map(|(p, q)| p.perp_dot(*q)).sum();
    0.5 * doubled.abs()
}

#[test]
fn no_face_lies_upon_another() {
    for listed in builtin::list() {
        let scene = scene(listed.name);
        let all = faces(&scene);
        // By roughly equal normals and then by place, so that neighbours in the list may lie in one plane.
        let mut sides: Vec<([i64; 3], f64, usize)> = (0..all.len())
            .filter_map(|i| {
                let normal = vector_area(&all[i].2).try_normalize()?;
                let key = (normal * 200.0).round().as_i64vec3().to_array();
                Some((key, normal.dot(all[i].2[0].as_dvec3()), i))
            })
            .collect();
        sides.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
        let size = all.iter().flat_map(|(_, _, corners)| corners);
        let size = size.fold(0.0, |most: f32, p| most.max(p.abs().max_element()));
        let mut found = Vec::new();
        for (i, (key, place, face)) in sides.iter().enumerate() {
            let (node, _, corners) = &all[*face];
            let normal = vector_area(corners).normalize();
            let in_plane = |other: &&([i64; 3], f64, usize)| {
                other.0 == *key && other.1 - place < 3e-5 * f64::from(size)
            };
            for (_, _, other) in sides[i + 1..].iter().take_while(in_plane) {
                let (other_node, _, other_corners) = &all[*other];
                let area = common_area(corners, other_corners, normal);
                let smaller = vector_area(corners)
                    .length()
                    .min(vector_area(other_corners).length());
                if area > 1e-3 * smaller {
                    found.push(format!(
                        "{area:.6} of {node} and {other_node} near {}",
                        corners[0]
                    ));
                }
            }
        }
        assert!(found.is_empty(), "{}: {}", listed.name, found.join("\n"));
    }
}
