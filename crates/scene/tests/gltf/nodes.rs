//! Where meshes, cameras and lights are placed.

use super::document::{Builder, assert_warned, warnings};
use glam::Vec3;
use hemicube_scene::{LightKind, Projection};
use serde_json::{Value, json};

#[test]
fn a_mesh_that_two_nodes_share_is_stored_once() {
    let mut builder = Builder::with_triangle();
    builder.json["nodes"] = json!([
        {"name": "parent", "mesh": 0, "translation": [1, 2, 3], "scale": [2, 2, 2], "children": [1]},
        {"mesh": 0, "matrix": [-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 5, 0, 0, 1]}
    ]);
    let scene = builder.scene();
    assert_eq!(
        (scene.meshes.len(), scene.instances.len()),
        (1, 2),
        "one mesh, two instances"
    );
    let names: Vec<&str> = scene.instances.iter().map(|i| i.node.as_str()).collect();
    assert_eq!(
        names,
        ["parent", "node 1"],
        "a node without a name has its number"
    );
    let mirrored = &scene.instances[1].world_from_mesh;
    assert_eq!(
        mirrored.transform_point3(Vec3::X),
        Vec3::new(9.0, 2.0, 3.0),
        "parent from child, then world from parent"
    );
    assert!(
        mirrored.matrix3.determinant() < 0.0,
        "the mirroring is kept"
    );
    assert!(!scene.instances[1].flipped, "and is no flip");
}

#[test]
fn a_negative_scale_is_kept_and_a_rotation_need_not_be_of_unit_length() {
    let mut builder = Builder::with_triangle();
    builder.json["nodes"] = json!([{"mesh": 0, "scale": [-2, 1, 1], "rotation": [0, 0, 5, 5]}]);
    let scene = builder.scene();
    let image = scene.instances[0].world_from_mesh.transform_point3(Vec3::X);
    assert!(
        image.distance(Vec3::new(0.0, -2.0, 0.0)) < 1e-6,
        "x is scaled to -2 and turned by 90 degrees: {image}"
    );
}

#[test]
fn the_scene_is_the_default_the_first_or_all_roots() {
    let mut builder = Builder::with_triangle();
    builder.json["nodes"] = json!([{"mesh": 0, "name": "a"}, {"mesh": 0, "name": "b", "children": [2]}, {"mesh": 0, "name": "c"}]);
    builder.json["scenes"] = json!([{"nodes": [0]}, {"nodes": [2]}]);
    let nodes = |builder: &Builder| -> String {
        builder
            .scene()
            .instances
            .iter()
            .map(|i| i.node.clone())
            .collect()
    };
    builder.json["scene"] = json!(1);
    assert_eq!(nodes(&builder), "c", "the default scene");
    builder
        .json
        .as_object_mut()
        .expect("a document")
        .remove("scene");
    assert_eq!(nodes(&builder), "a", "the first scene");
    builder.json["scenes"] = json!([]);
    assert_eq!(nodes(&builder), "abc", "all roots with their children");
    builder.json["scenes"] = json!([{}]);
    assert!(
        builder.refusal().contains("contains no triangles"),
        "a scene without nodes is allowed, but empty"
    );
}

#[test]
fn nodes_below_themselves_are_refused() {
    let mut builder = Builder::with_triangle();
    builder.json["nodes"] = json!([{"mesh": 0, "children": [1]}, {"children": [0]}]);
    assert!(
        builder.refusal().contains("node 1: node 0 is below itself"),
        "{}",
        builder.refusal()
    );
}

#[test]
fn a_node_of_two_parents_is_placed_once() {
    let mut builder = Builder::with_triangle();
    builder.json["nodes"] =
        json!([{"children": [1, 2]}, {"children": [3]}, {"children": [3]}, {"mesh": 0}]);
    let scene = builder.scene();
    assert_eq!(scene.instances.len(), 1, "placed where it was first");
    assert_warned(&scene, "node 3: node 2 has it too");
}

#[test]
fn a_chain_of_many_nodes_needs_no_stack() {
    const DEPTH: usize = 200_000;
    let mut builder = Builder::with_triangle();
    let mut nodes: Vec<Value> = (1..DEPTH)
        .map(|child| json!({"children": [child], "translation": [1, 0, 0]}))
        .collect();
    nodes.push(json!({"mesh": 0}));
    builder.json["nodes"] = Value::Array(nodes);
    let moved = builder.scene().instances[0]
        .world_from_mesh
        .transform_point3(Vec3::ZERO);
    assert_eq!(moved.x, (DEPTH - 1) as f32, "every node's step counts");
}

#[test]
fn a_camera_looks_along_minus_z_of_its_node() {
    let mut builder = Builder::with_triangle();
    builder.json["cameras"] = json!([
        {"type": "perspective", "perspective": {"yfov": 0.8, "znear": 0.1, "aspectRatio": 1.5}},
        {"type": "orthographic", "orthographic": {"xmag": 2, "ymag": 3, "znear": 0, "zfar": 9}},
        {"type": "perspective", "perspective": {"yfov": 0, "znear": 0.1}}
    ]);
    builder.json["nodes"] = json!([{"mesh": 0, "children": [1, 2, 3]},
        {"name": "view", "camera": 0, "translation": [1, 2, 3], "rotation": [0, 1, 0, 1], "scale": [7, 7, 7]},
        {"camera": 1}, {"camera": 2}]);
    let scene = builder.scene();
    assert_eq!(scene.cameras.len(), 2, "the third has no angle");
    assert_warned(&scene, "camera 'camera 2'");
    let camera = scene.camera("view").expect("it has its node's name");
    assert_eq!(
        camera.eye,
        Vec3::new(1.0, 2.0, 3.0),
        "it is at the node's origin"
    );
    assert!(
        camera.forward.distance(Vec3::NEG_X) < 1e-6,
        "90 degrees about y turn -z to -x: {}",
        camera.forward
    );
    assert!(camera.up.distance(Vec3::Y) < 1e-6, "upright: {}", camera.up);
    assert_eq!(
        camera.projection,
        Projection::Perspective {
            vertical_fov: 0.8,
            aspect: Some(1.5)
        },
        "perspective"
    );
    let parallel = Projection::Orthographic {
        half_width: 2.0,
        half_height: 3.0,
    };
    assert_eq!(scene.cameras[1].projection, parallel, "orthographic");
}

#[test]
fn lights_stand_where_their_nodes_are() {
    let mut builder = Builder::with_triangle();
    builder.json["extensionsRequired"] = json!(["KHR_lights_punctual"]);
    builder.json["extensions"] = json!({"KHR_lights_punctual": {"lights": [
        {"type": "point", "name": "bulb", "color": [1, 0.5, 0], "intensity": 40},
        {"type": "spot", "intensity": 10, "spot": {"innerConeAngle": 0.2, "outerConeAngle": 0.4}},
        {"type": "directional", "intensity": 1000},
        {"type": "spot", "spot": {"innerConeAngle": 1.0, "outerConeAngle": 0.5}},
        {"type": "point", "intensity": -1},
        {"type": "laser"}
    ]}});
    let light = |index: usize| json!({"KHR_lights_punctual": {"light": index}});
    let down = json!([-1, 0, 0, 1]); // -90 degrees about x: -z becomes -y
    builder.json["nodes"] = json!([
        {"mesh": 0, "children": [1, 2, 3, 4, 5, 6, 7], "scale": [2, 2, 2]},
        {"translation": [1, 2, 3], "extensions": light(0)},
        {"translation": [0, 5, 0], "rotation": down, "extensions": light(1)},
        {"rotation": down, "extensions": light(2)},
        {"extensions": light(3)}, {"extensions": light(4)}, {"extensions": light(5)}, {"extensions": light(6)}
    ]);
    let scene = builder.scene();
    assert_eq!(
        scene.lights.len(),
        5,
        "five make sense: {:?}",
        warnings(&scene)
    );
    let near = |a: Vec3, b: Vec3| a.distance(b) < 1e-5;
    match scene.lights[0].kind {
        LightKind::Point {
            position,
            intensity,
        } => {
            assert_eq!(
                position,
                Vec3::new(2.0, 4.0, 6.0),
                "the parent's scale moves it"
            );
            assert_eq!(
                intensity.to_array(),
                [40.0, 20.0, 0.0],
                "colour x intensity, whatever the scale"
            );
        }
        ref other => panic!("a point light came in as {other:?}"),
    }
    match scene.lights[1].kind {
        LightKind::Spot {
            position,
            direction,
            inner_angle,
            outer_angle,
            ..
        } => {
            assert!(
                near(position, Vec3::Y * 10.0) && near(direction, Vec3::NEG_Y),
                "at {position} to {direction}"
            );
            assert_eq!((inner_angle, outer_angle), (0.2, 0.4), "its cone");
        }
        ref other => panic!("a spot light came in as {other:?}"),
    }
    match scene.lights[2].kind {
        LightKind::Directional {
            direction,
            irradiance,
        } => {
            assert!(near(direction, Vec3::NEG_Y), "it shines down: {direction}");
            assert_eq!(irradiance.r, 1000.0, "lx");
        }
        ref other => panic!("a directional light came in as {other:?}"),
    }
    match scene.lights[3].kind {
        LightKind::Spot {
            inner_angle,
            outer_angle,
            ..
        } => assert!(inner_angle < outer_angle, "inner < outer"),
        ref other => panic!("a spot light came in as {other:?}"),
    }
    for part in [
        "cone angles 1 and 0.5",
        "is negative",
        "type 'laser'",
        "light 6 of 6",
    ] {
        assert_warned(&scene, part);
    }
}

#[test]
fn what_does_not_move_is_said() {
    let mut builder = Builder::with_triangle();
    builder.json["meshes"][0]["primitives"][0]["targets"] = json!([{"POSITION": 0}]);
    // The node of a target may be missing, which gltf-json does not know.
    builder.json["animations"] =
        json!([{"channels": [{"sampler": 0, "target": {"path": "pointer"}}], "samplers": []}]);
    let scene = builder.scene();
    assert_warned(&scene, "animations: are not read; the rest pose is taken");
    assert_warned(&scene, "morph targets: are not read");
}

#[test]
fn copies_by_gpu_instancing_are_placed() {
    let mut builder = Builder::with_triangle();
    let translations = builder.floats(&[1.0, 0.0, 0.0, 2.0, 0.0, 0.0], "VEC3");
    let copies = json!({"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": translations}}});
    builder.json["nodes"] = json!([{"mesh": 0, "scale": [10, 10, 10], "extensions": copies}]);
    let scene = builder.scene();
    let at: Vec<f32> = scene
        .instances
        .iter()
        .map(|i| i.world_from_mesh.translation.x)
        .collect();
    assert_eq!(at, [10.0, 20.0], "world from node x node from copy");
}

#[test]
fn a_hidden_node_hides_what_is_below_it() {
    let mut builder = Builder::with_triangle();
    builder.json["nodes"] = json!([{"mesh": 0, "children": [1]}, {"children": [2],
        "extensions": {"KHR_node_visibility": {"visible": false}}}, {"mesh": 0}]);
    let scene = builder.scene();
    assert_eq!(scene.instances.len(), 1, "the visible one");
    assert_warned(&scene, "node 'node 1': KHR_node_visibility hides it");
}
