//! Faces, attributes and accessors.

use super::document::{Builder, F32, assert_warned, triangles};
use glam::{Vec2, Vec3};
use hemicube_scene::Scene;
use serde_json::json;

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
