//! glTF files made in memory: what is read is what was written, what is damaged is named.

use base64::Engine as _;
use glam::{Vec2, Vec3};
use hemicube_scene::{
    AlphaMode, Face, LightKind, Magnify, Minify, Projection, ReliefKind, Scene, SceneError,
    TextureUse, Wrap, open_bytes,
};
use serde_json::{Value, json};

/// A document under construction: one buffer, views and accessors are appended.
struct Builder {
    json: Value,
    bytes: Vec<u8>,
}

const F32: u32 = 5126;

impl Builder {
    fn new() -> Self {
        let json = json!({
            "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
            "meshes": [], "materials": [], "accessors": [], "bufferViews": []
        });
        Self {
            json,
            bytes: Vec::new(),
        }
    }

    fn push(&mut self, list: &str, item: Value) -> usize {
        let list = self.json[list]
            .as_array_mut()
            .expect("a list of the document");
        list.push(item);
        list.len() - 1
    }

    fn view(&mut self, bytes: &[u8]) -> usize {
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        let offset = self.bytes.len();
        self.bytes.extend_from_slice(bytes);
        self.push(
            "bufferViews",
            json!({"buffer": 0, "byteOffset": offset, "byteLength": bytes.len()}),
        )
    }

    fn accessor(&mut self, bytes: &[u8], component: u32, kind: &str, count: usize) -> usize {
        let view = self.view(bytes);
        self.push(
            "accessors",
            json!({"bufferView": view, "componentType": component, "type": kind, "count": count}),
        )
    }

    fn floats(&mut self, values: &[f32], kind: &str) -> usize {
        let width = match kind {
            "SCALAR" => 1,
            "VEC2" => 2,
            "VEC3" => 3,
            _ => 4,
        };
        let bytes: Vec<u8> = values.iter().flat_map(|v| v.to_le_bytes()).collect();
        self.accessor(&bytes, F32, kind, values.len() / width)
    }

    fn indices(&mut self, values: &[u32]) -> usize {
        let bytes: Vec<u8> = values.iter().flat_map(|v| v.to_le_bytes()).collect();
        self.accessor(&bytes, 5125, "SCALAR", values.len())
    }

    fn mesh(&mut self, primitive: Value) -> usize {
        self.push("meshes", json!({"name": "lamp", "primitives": [primitive]}))
    }

    /// One triangle in the plane z = 0 as mesh 0.
    fn with_triangle() -> Self {
        let mut builder = Self::new();
        let positions = builder.floats(&[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0], "VEC3");
        builder.mesh(json!({"attributes": {"POSITION": positions}}));
        builder
    }

    fn text(&self) -> String {
        let mut json = self.json.clone();
        if !self.bytes.is_empty() {
            let data = base64::engine::general_purpose::STANDARD.encode(&self.bytes);
            let uri = format!("data:application/octet-stream;base64,{data}");
            json["buffers"] = json!([{"byteLength": self.bytes.len(), "uri": uri}]);
        }
        json.to_string()
    }

    fn open(&self) -> Result<Scene, SceneError> {
        open_text(&self.text())
    }

    fn scene(&self) -> Scene {
        self.open().expect("the file is good")
    }

    /// The message, which is one line that begins with the file.
    fn refusal(&self) -> String {
        let message = self.open().expect_err("the file is bad").to_string();
        assert_refusal(&message);
        message
    }
}

fn assert_refusal(message: &str) {
    assert!(
        message.starts_with("folder/file.gltf: "),
        "it begins with the file: {message}"
    );
    assert!(!message.contains('\n'), "it is one line: {message}");
}

fn open_text(text: &str) -> Result<Scene, SceneError> {
    let outcome = open_bytes(text.as_bytes(), "folder/file.gltf", None);
    if let Ok(scene) = &outcome {
        scene.check().expect("what opens is consistent");
        assert_eq!(scene.name, "file", "the name is the stem of the file");
    }
    outcome
}

fn warnings(scene: &Scene) -> Vec<String> {
    scene
        .report
        .warnings
        .iter()
        .map(ToString::to_string)
        .collect()
}

fn assert_warned(scene: &Scene, part: &str) {
    assert!(
        warnings(scene).iter().any(|w| w.contains(part)),
        "no warning says '{part}': {:?}",
        warnings(scene)
    );
}

/// The corners of all faces of a mesh.
fn triangles(scene: &Scene, mesh: usize) -> Vec<[u32; 3]> {
    let corners = |face: &Face| match face {
        Face::Triangle(corners) => *corners,
        Face::Quad(_) => panic!("glTF has no quads"),
    };
    scene.meshes[mesh].faces.iter().map(corners).collect()
}

fn square_with(mode: u32, indices: Option<&[u32]>) -> Scene {
    let mut builder = Builder::new();
    let corners = [
        0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 1.0, 0.0, 2.0, 1.0, 0.0,
    ];
    let positions = builder.floats(&corners, "VEC3");
    let mut primitive = json!({"attributes": {"POSITION": positions}, "mode": mode});
    if let Some(indices) = indices {
        primitive["indices"] = json!(builder.indices(indices));
    }
    builder.mesh(primitive);
    builder.scene()
}

#[test]
fn a_strip_turns_every_second_triangle_around() {
    let scene = square_with(5, None);
    assert_eq!(
        triangles(&scene, 0),
        [[0, 1, 2], [1, 3, 2], [2, 3, 4]],
        "glTF 2.0, section 3.7.2.1"
    );
}

#[test]
fn a_fan_shares_its_first_vertex() {
    let scene = square_with(6, Some(&[0, 1, 3, 2]));
    assert_eq!(
        triangles(&scene, 0),
        [[1, 3, 0], [3, 2, 0]],
        "glTF 2.0, section 3.7.2.1"
    );
}

#[test]
fn points_and_lines_are_left_out_with_a_warning() {
    let mut builder = Builder::with_triangle();
    builder.json["meshes"][0]["primitives"] =
        json!([{"attributes": {"POSITION": 0}, "mode": 1}, {"attributes": {"POSITION": 0}}]);
    let scene = builder.scene();
    assert_eq!(scene.meshes.len(), 1, "the lines are no mesh");
    assert_eq!(
        scene.meshes[0].name, "lamp.1",
        "the primitive's number is in the name"
    );
    assert_warned(&scene, "mesh 'lamp.0': it is made of points or lines");
}

#[test]
fn indices_of_every_width_are_read() {
    for (component, bytes) in [
        (5121, vec![2, 0, 1]),
        (5123, vec![2, 0, 0, 0, 1, 0]),
        (5125, vec![2, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0]),
    ] {
        let mut builder = Builder::with_triangle();
        let indices = builder.accessor(&bytes, component, "SCALAR", 3);
        builder.json["meshes"][0]["primitives"][0]["indices"] = json!(indices);
        assert_eq!(
            triangles(&builder.scene(), 0),
            [[2, 0, 1]],
            "component type {component}"
        );
    }
}

#[test]
fn an_index_out_of_range_costs_its_triangle() {
    let scene = square_with(4, Some(&[0, 1, 2, 0, 1, 9, 2, 2, 3, 1, 3, 2, 0]));
    assert_eq!(
        triangles(&scene, 0),
        [[0, 1, 2], [1, 3, 2]],
        "the good ones remain"
    );
    assert_warned(&scene, "mesh 'lamp', triangle 1: vertex 9 of 5; left out");
    assert_warned(
        &scene,
        "mesh 'lamp', triangle 2: a vertex is used twice; left out",
    );
    assert_warned(&scene, "its last 1 corners are no whole triangle");
}

#[test]
fn vertices_that_no_face_uses_are_left_out() {
    let scene = square_with(4, Some(&[4, 2, 3]));
    assert_eq!(scene.meshes[0].positions.len(), 3, "three are used");
    assert_eq!(triangles(&scene, 0), [[2, 0, 1]], "they keep their order");
    assert_eq!(
        scene.meshes[0].positions[2],
        Vec3::new(2.0, 1.0, 0.0),
        "the old vertex 4"
    );
}

#[test]
fn a_vertex_that_is_not_finite_costs_its_triangles() {
    let mut builder = Builder::new();
    let nan = f32::NAN;
    let corners = [
        0.0,
        0.0,
        0.0,
        1.0,
        0.0,
        0.0,
        0.0,
        1.0,
        0.0,
        nan,
        1.0,
        0.0,
        f32::INFINITY,
        0.0,
        0.0,
    ];
    let positions = builder.floats(&corners, "VEC3");
    let indices = builder.indices(&[0, 1, 2, 1, 3, 2, 1, 2, 4]);
    builder.mesh(json!({"attributes": {"POSITION": positions}, "indices": indices}));
    let scene = builder.scene();
    assert_eq!(triangles(&scene, 0), [[0, 1, 2]], "one triangle is whole");
    assert_warned(
        &scene,
        "mesh 'lamp', triangle 1: vertex 3 is at [NaN, 1.0, 0.0]; left out",
    );
    assert_warned(&scene, "mesh 'lamp', triangle 2: vertex 4");
}

#[test]
fn attributes_that_are_not_finite_become_zero_with_one_warning() {
    let mut builder = Builder::with_triangle();
    let normals = builder.floats(&[f32::NAN, 0.0, 0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 1.0], "VEC3");
    let texcoords = builder.floats(&[0.0, f32::INFINITY, 0.25, 0.5, 1.0, 1.0], "VEC2");
    let colors = builder.floats(&[f32::NAN, 0.5, 2.0, 1.0, 1.0, 1.0, 0.0, 0.0, 0.0], "VEC3");
    builder.json["meshes"][0]["primitives"][0]["attributes"] =
        json!({"POSITION": 0, "NORMAL": normals, "TEXCOORD_0": texcoords, "COLOR_0": colors});
    let scene = builder.scene();
    let mesh = &scene.meshes[0];
    assert_eq!(
        mesh.normals,
        [Vec3::ZERO, Vec3::Z, Vec3::Z],
        "unit length or 0"
    );
    assert_eq!(
        mesh.texcoords[0],
        [Vec2::ZERO, Vec2::new(0.25, 0.5), Vec2::ONE],
        "finite or 0"
    );
    assert_eq!(
        mesh.colors[0].to_array(),
        [0.0, 0.5, 1.0, 1.0],
        "within 0 and 1, alpha 1 where there is none"
    );
    for attribute in ["NORMAL", "TEXCOORD_0", "COLOR_0"] {
        assert_warned(&scene, &format!("mesh 'lamp': {attribute}: 1 vertices"));
    }
    assert_eq!(scene.report.warnings.len(), 3, "one warning each");
}

#[test]
fn attributes_of_the_wrong_length_are_left_out() {
    let mut builder = Builder::with_triangle();
    let normals = builder.floats(&[0.0, 0.0, 1.0], "VEC3");
    let second = builder.floats(&[0.0, 0.0, 1.0, 0.0, 0.0, 1.0], "VEC2");
    builder.json["meshes"][0]["primitives"][0]["attributes"] =
        json!({"POSITION": 0, "NORMAL": normals, "TEXCOORD_1": second, "TEXCOORD_0": 77});
    let scene = builder.scene();
    assert!(
        scene.meshes[0].normals.is_empty(),
        "one normal for three vertices"
    );
    assert_eq!(
        scene.meshes[0].texcoords[0],
        [Vec2::ZERO; 3],
        "the gap below set 1 is filled"
    );
    assert_eq!(
        scene.meshes[0].texcoords[1][2],
        Vec2::Y,
        "set 1 keeps its number"
    );
    assert_warned(&scene, "NORMAL: 1 elements for 3 vertices; left out");
    assert_warned(&scene, "TEXCOORD_0: accessor 77 of 3; left out");
}

#[test]
fn a_sparse_accessor_replaces_what_it_names() {
    let mut builder = Builder::with_triangle();
    let indices = builder.view(&[2]);
    let value: Vec<u8> = [7.0_f32, 8.0, 9.0]
        .iter()
        .flat_map(|v| v.to_le_bytes())
        .collect();
    let values = builder.view(&value);
    builder.json["accessors"][0]["sparse"] = json!({
        "count": 1, "indices": {"bufferView": indices, "componentType": 5121}, "values": {"bufferView": values}
    });
    let positions = &builder.scene().meshes[0].positions;
    assert_eq!(
        positions,
        &[Vec3::ZERO, Vec3::X, Vec3::new(7.0, 8.0, 9.0)],
        "vertex 2 alone is replaced"
    );
    builder.json["accessors"][0]["sparse"]["count"] = json!(4);
    assert!(
        builder.refusal().contains("4 values for 3 elements"),
        "{}",
        builder.refusal()
    );
}

#[test]
fn a_sparse_accessor_without_a_view_starts_from_zeros() {
    let mut builder = Builder::new();
    let indices = builder.view(&[1, 0, 2, 0]);
    let values: Vec<u8> = [1.0_f32, 0.0, 0.0, 0.0, 1.0, 0.0]
        .iter()
        .flat_map(|v| v.to_le_bytes())
        .collect();
    let values = builder.view(&values);
    let sparse = json!({
        "count": 2, "indices": {"bufferView": indices, "componentType": 5123}, "values": {"bufferView": values}
    });
    builder.push(
        "accessors",
        json!({"componentType": F32, "type": "VEC3", "count": 3, "sparse": sparse}),
    );
    builder.mesh(json!({"attributes": {"POSITION": 0}}));
    assert_eq!(
        builder.scene().meshes[0].positions,
        [Vec3::ZERO, Vec3::X, Vec3::Y],
        "zeros where nothing is said"
    );
}

#[test]
fn quantised_attributes_and_strides_are_read() {
    let mut builder = Builder::new();
    // Three signed bytes and one of padding per vertex.
    let positions = builder.accessor(&[0, 0, 0, 9, 100, 0, 0, 9, 0, 0x9C, 0, 9], 5120, "VEC3", 3);
    builder.json["bufferViews"][positions]["byteStride"] = json!(4);
    let texcoords = builder.accessor(
        &[0, 0, 0xFF, 0xFF, 0, 0x80, 0, 0, 0, 0, 0, 0],
        5123,
        "VEC2",
        3,
    );
    builder.json["accessors"][texcoords]["normalized"] = json!(true);
    let colors = builder.accessor(&[255, 0, 51, 255, 0, 0, 0, 0, 0, 0, 0, 0], 5121, "VEC4", 3);
    builder.json["accessors"][colors]["normalized"] = json!(true);
    builder.json["extensionsRequired"] = json!(["KHR_mesh_quantization"]);
    let attributes = json!({"POSITION": positions, "TEXCOORD_0": texcoords, "COLOR_0": colors});
    builder.mesh(json!({"attributes": attributes}));
    let scene = builder.scene();
    let mesh = &scene.meshes[0];
    assert_eq!(
        mesh.positions,
        [Vec3::ZERO, Vec3::X * 100.0, Vec3::Y * -100.0],
        "plain integers"
    );
    assert_eq!(mesh.texcoords[0][0], Vec2::new(0.0, 1.0), "65535 is 1");
    assert_eq!(
        mesh.texcoords[0][1],
        Vec2::new(32_768.0 / 65_535.0, 0.0),
        "a fraction of 65535"
    );
    assert_eq!(
        mesh.colors[0].to_array(),
        [1.0, 0.0, 0.2, 1.0],
        "fractions of 255"
    );
}

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

/// A document with one material, which the triangle uses.
fn with_material(material: Value) -> Builder {
    let mut builder = Builder::with_triangle();
    builder.push("materials", material);
    builder.json["meshes"][0]["primitives"][0]["material"] = json!(0);
    builder
}

#[test]
fn a_primitive_without_material_has_that_of_the_specification() {
    let scene = Builder::with_triangle().scene();
    let material = &scene.materials[scene.meshes[0].material];
    assert_eq!(material.base_color.to_array(), [1.0; 3], "white");
    assert_eq!(
        (material.metallic, material.double_sided),
        (1.0, false),
        "metallic 1, one-sided"
    );
}

#[test]
fn emission_is_factor_times_strength() {
    let strong = json!({"KHR_materials_emissive_strength": {"emissiveStrength": 200}});
    let scene = with_material(
        json!({"name": "tube", "emissiveFactor": [1, 0.5, 0.25], "extensions": strong}),
    )
    .scene();
    assert_eq!(
        scene.materials[0].emission.to_array(),
        [200.0, 100.0, 50.0],
        "cd/m2"
    );
    assert!(scene.has_light(), "so there is light");
    let scene = with_material(json!({"emissiveFactor": [-1, 0.5, 1e39]})).scene();
    assert_eq!(
        scene.materials[0].emission.to_array(),
        [0.0, 0.5, 0.0],
        "neither negative nor infinite"
    );
    assert_eq!(
        scene.materials[0].name, "material 0",
        "a material without a name has its number"
    );
    assert_warned(&scene, "material 'material 0': emission");
}

#[test]
fn factors_out_of_range_are_clamped_with_a_warning() {
    let pbr =
        json!({"baseColorFactor": [2, 0.5, -1, 1e39], "metallicFactor": 3, "roughnessFactor": -1});
    let scene = with_material(json!({"pbrMetallicRoughness": pbr})).scene();
    let material = &scene.materials[0];
    assert_eq!(
        material.base_color.to_array(),
        [1.0, 0.5, 0.0],
        "base colour"
    );
    assert_eq!(
        (material.alpha, material.metallic, material.roughness),
        (1.0, 1.0, 0.0),
        "other factors"
    );
    for key in ["baseColorFactor", "metallicFactor", "roughnessFactor"] {
        assert_warned(&scene, key);
    }
}

#[test]
fn material_extensions_are_read() {
    let scene = with_material(json!({
        "doubleSided": true, "alphaMode": "MASK", "alphaCutoff": 0.25,
        "extensions": {"KHR_materials_unlit": {}, "KHR_materials_transmission": {"transmissionFactor": 0.75}}
    }))
    .scene();
    let material = &scene.materials[0];
    assert!(
        material.double_sided && material.unlit,
        "double-sided and unlit"
    );
    assert_eq!(
        material.alpha_mode,
        AlphaMode::Mask { cutoff: 0.25 },
        "mask"
    );
    assert_eq!(material.transmission, 0.75, "transmission");
    assert_warned(&scene, "counts as diffuse");
    let glossy =
        json!({"KHR_materials_pbrSpecularGlossiness": {"diffuseFactor": [0.1, 0.2, 0.3, 0.5]}});
    let scene = with_material(json!({"alphaMode": "BLEND", "extensions": glossy})).scene();
    let material = &scene.materials[0];
    assert_eq!(
        material.base_color.to_array(),
        [0.1, 0.2, 0.3],
        "the diffuse colour"
    );
    assert_eq!((material.metallic, material.alpha), (0.0, 0.5), "no metal");
    assert_eq!(material.alpha_mode, AlphaMode::Blend, "blend");
}

/// A material whose base colour texture has a transform, and the picture it needs.
fn with_texture(transform: Value) -> Builder {
    let image = hemicube_raster::Image::filled(1, 1, [255, 128, 0, 255]);
    let image = hemicube_scene::TextureImage::from_pixels("dot", image);
    let data = base64::engine::general_purpose::STANDARD.encode(image.encoded());
    let info = json!({"index": 0, "extensions": {"KHR_texture_transform": transform}});
    let mut builder = with_material(json!({"pbrMetallicRoughness": {"baseColorTexture": info}}));
    builder.json["images"] = json!([{"uri": format!("data:image/png;base64,{data}")}]);
    builder.json["samplers"] = json!([{"wrapS": 33071, "wrapT": 33648}]);
    builder.json["textures"] = json!([{"source": 0, "sampler": 0}]);
    builder
}

#[test]
fn texture_transforms_hit_the_markers_of_the_khronos_test_model() {
    // TextureTransformTest: the tip of the arrow, (0.778, 0.778) in the picture, must come to lie under the marker.
    let tip = Vec2::splat(0.777_817_5);
    for (transform, marker, tolerance) in [
        (
            json!({"rotation": core::f32::consts::FRAC_PI_8}),
            Vec2::new(0.420_951_8, 1.016_267_5),
            1e-5,
        ),
        // The markers of these two are placed by eye.
        (json!({"scale": [1.5, 1.5]}), Vec2::splat(0.518_545), 1e-3),
        (
            json!({"offset": [-0.2, -0.1], "rotation": 0.3, "scale": [1.5, 1.5]}),
            Vec2::new(0.43, 0.75),
            0.03,
        ),
    ] {
        let scene = with_texture(transform.clone()).scene();
        let slot = scene.materials[0]
            .base_color_texture
            .expect("the texture is used");
        let found = slot.coordinates(marker);
        assert!(
            found.distance(tip) < tolerance,
            "{transform}: {found}, not {tip}"
        );
    }
}

#[test]
fn the_worked_example_of_the_texture_transform_specification() {
    let transform = json!({"offset": [0, 1], "rotation": core::f32::consts::FRAC_PI_2, "scale": [0.5, 0.5], "texCoord": 1});
    let scene = with_texture(transform).scene();
    let slot = scene.materials[0]
        .base_color_texture
        .expect("the texture is used");
    assert_eq!(
        slot.texcoord_set, 1,
        "texCoord of the extension comes first"
    );
    for (from, to) in [
        (Vec2::ZERO, Vec2::Y),
        (Vec2::ONE, Vec2::splat(0.5)),
        (Vec2::X, Vec2::new(0.0, 0.5)),
    ] {
        assert!(
            slot.coordinates(from).distance(to) < 1e-6,
            "{from} is {}, not {to}",
            slot.coordinates(from)
        );
    }
    let texture = scene.textures[slot.texture];
    assert_eq!(
        texture.wrap,
        [Wrap::ClampToEdge, Wrap::MirroredRepeat],
        "wrap modes of the sampler"
    );
    assert_warned(&scene, "needs TEXCOORD_1, which it lacks");
}

#[test]
fn what_only_pictures_use_is_read() {
    let mut builder = with_texture(json!({}));
    let material = &mut builder.json["materials"][0];
    material["normalTexture"] = json!({"index": 0, "scale": 0.5, "texCoord": 0});
    material["pbrMetallicRoughness"]["metallicRoughnessTexture"] = json!({"index": 0});
    builder.json["samplers"][0]["magFilter"] = json!(9728);
    builder.json["samplers"][0]["minFilter"] = json!(9729);
    let scene = builder.scene();
    let material = &scene.materials[0];
    let relief = material.relief.expect("the normal map is used");
    assert_eq!(relief.kind, ReliefKind::Normal { scale: 0.5 }, "its scale");
    assert!(material.roughness_texture.is_some(), "roughness");
    assert_eq!(
        material.roughness_texture, material.metallic_texture,
        "one picture"
    );
    assert_eq!(material.slots().count(), 4, "all slots");
    let texture = scene.textures[relief.slot.texture];
    assert_eq!(
        (texture.magnify, texture.minify),
        (Magnify::Nearest, Minify::Linear),
        "filters of the sampler"
    );
}

#[test]
fn mip_chains_are_made_once_and_shared() {
    let scene = with_texture(json!({})).scene();
    let image = &scene.images[0];
    let wrap = [Wrap::Repeat; 2];
    let chain: *const _ = image.chain(wrap, TextureUse::Color);
    assert_eq!(
        chain,
        image.clone().chain(wrap, TextureUse::Color),
        "the clone has the same"
    );
    let data: *const _ = image.chain(wrap, TextureUse::Data);
    assert_ne!(chain, data, "another use is another chain");
}

#[test]
fn a_picture_that_cannot_be_used_costs_its_slot() {
    for (image, part) in [
        (
            json!({"uri": "data:image/png;base64,AAAA"}),
            "neither PNG, JPEG nor WebP",
        ),
        (json!({"uri": "data:image/png;base64,%%"}), "not base64"),
        (json!({"uri": "missing.png"}), "no folder is known"),
        (
            json!({"uri": "https://example.org/a.png"}),
            "not a file beside this one",
        ),
        (json!({"uri": "/etc/hostname"}), "not a relative file name"),
        (
            json!({"uri": "%2Fetc%2Fhostname"}),
            "not a relative file name",
        ),
        (json!({"bufferView": 5}), "buffer view 5 of 1"),
        (json!({}), "it names no data"),
    ] {
        let mut builder = with_texture(json!({}));
        builder.json["images"] = json!([image]);
        let scene = builder.scene();
        assert!(
            scene.materials[0].base_color_texture.is_none(),
            "{image}: the slot is dropped"
        );
        assert_warned(&scene, part);
    }
    let mut builder = with_texture(json!({}));
    builder.json["textures"] = json!([{"extensions": {"EXT_texture_webp": {"source": 0}}}]);
    assert_warned(
        &builder.scene(),
        "has no picture except by EXT_texture_webp",
    );
}

#[test]
fn a_picture_is_decoded_once_for_all_its_textures() {
    let mut builder = with_texture(json!({}));
    builder.json["textures"] = json!([{"source": 0}, {"source": 0}]);
    builder.json["materials"][0]["emissiveTexture"] = json!({"index": 1});
    let scene = builder.scene();
    assert_eq!(
        (scene.images.len(), scene.textures.len()),
        (1, 2),
        "one picture, two textures"
    );
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

#[test]
fn accessors_beyond_their_bytes_are_refused() {
    let change = |path: &str, value: Value| {
        let mut builder = Builder::with_triangle();
        *builder
            .json
            .pointer_mut(path)
            .unwrap_or_else(|| panic!("{path} is there")) = value;
        builder.refusal()
    };
    for (path, value, part) in [
        (
            "/accessors/0/count",
            json!(4),
            "mesh 'lamp': POSITION: accessor 0: 4 elements of 12 bytes",
        ),
        (
            "/accessors/0/count",
            json!(4_000_000_000_u32),
            "4000000000 elements",
        ),
        (
            "/accessors/0/count",
            json!(u64::MAX),
            "more than 32-bit indices reach",
        ),
        ("/accessors/0/type", json!("VEC2"), "not VEC3"),
        ("/accessors/0/type", json!("MAT4"), "neither SCALAR"),
        ("/accessors/0/componentType", json!(1), "componentType"),
        ("/accessors/0/bufferView", json!(3), "buffer view 3 of 1"),
        (
            "/bufferViews/0/byteOffset",
            json!(u64::MAX),
            "bytes 18446744073709551615 + 36 of buffer 0",
        ),
        (
            "/bufferViews/0/byteLength",
            json!(37),
            "bytes 0 + 37 of buffer 0, which has 36",
        ),
        ("/bufferViews/0/buffer", json!(1), "buffer 1 of 1"),
        (
            "/meshes/0/primitives/0/attributes/POSITION",
            json!(9),
            "accessor 9 of 1",
        ),
        ("/nodes/0/mesh", json!(2), "mesh 2 of 1"),
        ("/scenes/0/nodes", json!([7]), "node 7 of 1"),
        ("/scene", json!(1), "scene 1 of 1"),
    ] {
        let message = change(path, value);
        assert!(
            message.contains(part),
            "{path}: '{part}' is not in: {message}"
        );
    }
}

#[test]
fn strides_and_offsets_that_do_not_fit_are_refused() {
    let mut builder = Builder::with_triangle();
    builder.json["bufferViews"][0]["byteStride"] = json!(8);
    assert!(
        builder
            .refusal()
            .contains("12 bytes do not fit a stride of 8"),
        "{}",
        builder.refusal()
    );
    builder.json["bufferViews"][0]["byteStride"] = json!(u64::MAX);
    assert!(
        builder.refusal().contains("need more than the 36"),
        "{}",
        builder.refusal()
    );
    builder.json["bufferViews"][0]["byteStride"] = json!(12);
    builder.json["accessors"][0]["byteOffset"] = json!(u64::MAX - 3);
    assert!(
        builder.refusal().contains("need more than the 36"),
        "{}",
        builder.refusal()
    );
}

#[test]
fn a_count_without_bytes_allocates_nothing() {
    let mut builder = Builder::with_triangle();
    builder.json["accessors"][0] =
        json!({"componentType": F32, "type": "VEC3", "count": 4_294_967_295_u32});
    assert!(
        builder.refusal().contains("its accessors have no data"),
        "{}",
        builder.refusal()
    );
    let mut builder = Builder::with_triangle();
    builder.json["meshes"][0]["primitives"][0]["indices"] = json!(1);
    builder.push(
        "accessors",
        json!({"componentType": 5125, "type": "SCALAR", "count": 4_294_967_295_u32}),
    );
    assert!(
        builder.refusal().contains("its accessors have no data"),
        "{}",
        builder.refusal()
    );
}

#[test]
fn an_index_of_more_than_32_bits_is_not_cut_off() {
    let mut builder = Builder::with_triangle();
    builder.json["nodes"][0]["mesh"] = json!(4_294_967_296_u64);
    assert!(
        builder.refusal().contains("4294967296 is no index"),
        "{}",
        builder.refusal()
    );
    let mut builder = Builder::with_triangle();
    builder.json["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = json!(4_294_967_296_u64);
    assert!(
        builder.refusal().contains("4294967296 is no index"),
        "{}",
        builder.refusal()
    );
}

#[test]
fn buffers_that_are_short_empty_or_elsewhere_are_refused() {
    let document = |buffer: Value| {
        let mut builder = Builder::with_triangle();
        builder.bytes.clear();
        builder.json["buffers"] = json!([buffer]);
        builder.refusal()
    };
    for (buffer, part) in [
        (
            json!({"byteLength": 36, "uri": "data:;base64,AAAA"}),
            "36 bytes are stated, 3 are there",
        ),
        (
            json!({"byteLength": 0, "uri": "data:;base64,AAAA"}),
            "it is empty",
        ),
        (json!({"byteLength": 36}), "it names no data"),
        (json!({"byteLength": 36, "uri": "data:nothing"}), "no comma"),
        (
            json!({"byteLength": 36, "uri": "file:///etc/passwd"}),
            "not a file beside this one",
        ),
        (
            json!({"byteLength": 36, "uri": "C:\\data.bin"}),
            "not a file beside this one",
        ),
        (
            json!({"byteLength": 36, "uri": ""}),
            "not a relative file name",
        ),
    ] {
        let message = document(buffer);
        assert!(message.contains(part), "'{part}' is not in: {message}");
    }
}

#[test]
fn what_the_file_requires_and_we_lack_is_named() {
    let mut builder = Builder::with_triangle();
    builder.json["extensionsRequired"] = json!([
        "KHR_draco_mesh_compression",
        "KHR_texture_transform",
        "KHR_texture_basisu"
    ]);
    let error = builder.open().expect_err("it cannot be read");
    assert!(matches!(error, SceneError::Unsupported(_)), "{error:?}");
    let message = builder.refusal();
    assert!(
        message.contains("KHR_draco_mesh_compression, KHR_texture_basisu, which"),
        "{message}"
    );
    assert!(
        message.contains("without compression"),
        "it says a way out: {message}"
    );
}

#[test]
fn other_versions_are_refused_by_name() {
    for (text, part) in [
        (r#"{"asset": {"version": "1.0"}}"#, "glTF 1.0"),
        (r#"{"buffers": {"a": {}}, "meshes": {}}"#, "glTF 1.0"),
        (
            r#"{"asset": {"version": "2.0", "minVersion": "2.1"}}"#,
            "glTF 2.1",
        ),
        (r#"{"asset": {"version": "3.0"}}"#, "glTF 3.0"),
    ] {
        let error = open_text(text).expect_err("it is another version");
        assert!(matches!(error, SceneError::Unsupported(_)), "{error:?}");
        assert!(error.to_string().contains(part), "{error}");
    }
}

#[test]
fn what_is_not_gltf_is_said_in_one_line_with_its_place() {
    for (text, part) in [
        (
            "{\n\"asset\": {\"version\": \"2.0\"},\n\"nodes\": 5}",
            "line 3",
        ),
        ("{\n\"asset\": {\"version\": \"2.0\"},\n", "line 3"),
        ("", "line 1"),
        ("{\"asset\": {\"version\": 2}}", "column"),
    ] {
        let message = open_text(text).expect_err("it is not glTF").to_string();
        assert_refusal(&message);
        assert!(
            message.contains("not valid glTF") && message.contains(part),
            "{message}"
        );
    }
    let deep = format!("{}{}", "{\"a\":".repeat(100_000), "}".repeat(100_000));
    assert!(
        open_text(&deep).is_err(),
        "nesting without end is refused, not followed"
    );
    let error = open_bytes(b"{\"asset\": \"\xff\"}", "folder/file.gltf", None)
        .expect_err("it is not UTF-8");
    assert_refusal(&error.to_string());
    assert!(
        error
            .to_string()
            .contains("byte 11 of its JSON is not UTF-8"),
        "{error}"
    );
}

#[test]
fn a_glb_with_its_buffer_inside_opens_and_a_damaged_one_does_not() {
    let mut builder = Builder::with_triangle();
    builder.json["buffers"] = json!([{"byteLength": builder.bytes.len()}]);
    let mut json = builder.json.to_string().into_bytes();
    json.resize(json.len().next_multiple_of(4), b' ');
    let mut glb = b"glTF".to_vec();
    let word = |n: usize| u32::try_from(n).expect("a small file").to_le_bytes();
    glb.extend(word(2));
    glb.extend(word(12 + 8 + json.len() + 8 + builder.bytes.len()));
    glb.extend(word(json.len()));
    glb.extend(b"JSON");
    glb.extend(&json);
    glb.extend(word(builder.bytes.len()));
    glb.extend(b"BIN\0");
    glb.extend(&builder.bytes);
    // Whatever its name, its first bytes say what it is.
    let scene = open_bytes(&glb, "folder/file.obj", None).expect("a good .glb");
    assert_eq!(scene.face_count(), 1, "one triangle");

    let refusal = |glb: &[u8]| {
        let message = open_bytes(glb, "folder/file.gltf", None)
            .expect_err("a damaged .glb")
            .to_string();
        assert_refusal(&message);
        message
    };
    // Every cut and every changed byte of the headers: an error or a scene, never a panic.
    for length in 0..glb.len() {
        refusal(&glb[..length]);
    }
    let mut changed = glb.clone();
    changed[4] = 1;
    assert!(
        refusal(&changed).contains("glTF 1.0"),
        "{}",
        refusal(&changed)
    );
    changed[4] = 7;
    assert!(
        refusal(&changed).contains("version 7"),
        "{}",
        refusal(&changed)
    );
    let mut changed = glb.clone();
    changed[15] = 0xFF;
    assert!(
        refusal(&changed).contains("chunk 0 of the .glb has"),
        "{}",
        refusal(&changed)
    );
    for place in 0..glb.len() {
        for value in [0, 0x7F, 0xFF] {
            let mut changed = glb.clone();
            changed[place] = value;
            if let Ok(scene) = open_bytes(&changed, "folder/file.gltf", None) {
                assert!(
                    scene.check().is_ok(),
                    "byte {place} = {value} opens to something inconsistent"
                );
            }
        }
    }
}
