//! What is damaged, foreign or out of range: one line that names it, and no memory for what is not there.

use super::document::{Builder, F32, assert_refusal, open_text};
use hemicube_scene::{SceneError, open_bytes};
use serde_json::{Value, json};

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
