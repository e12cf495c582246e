//! STL files: what is read is what was written, what is damaged is told.

use glam::Vec3;
use hemicube_scene::{Face, Scene, SceneError, open_bytes};

fn opened(bytes: &[u8], name: &str) -> Result<Scene, SceneError> {
    let scene = open_bytes(bytes, name, None)?;
    scene.check().expect("what opens is consistent");
    Ok(scene)
}

fn scene(bytes: &[u8]) -> Scene {
    opened(bytes, "folder/part.stl").unwrap_or_else(|e| panic!("the file is good: {e}"))
}

fn refused(bytes: &[u8]) -> String {
    let message = opened(bytes, "part.stl")
        .expect_err("it is refused")
        .to_string();
    assert!(
        message.starts_with("part.stl: "),
        "it names the file: {message}"
    );
    assert_eq!(message.lines().count(), 1, "one line: {message}");
    message
}

fn warnings(scene: &Scene) -> Vec<String> {
    scene
        .report
        .warnings
        .iter()
        .map(ToString::to_string)
        .collect()
}

fn nodes(scene: &Scene) -> Vec<&str> {
    scene.instances.iter().map(|i| i.node.as_str()).collect()
}

fn facet(normal: &str, corners: [&str; 3]) -> String {
    let [a, b, c] = corners;
    format!(
        "facet normal {normal}\n outer loop\n  vertex {a}\n  vertex {b}\n  vertex {c}\n endloop\nendfacet\n"
    )
}

/// A binary file of these triangles, each a normal and three corners.
fn binary(header: &[u8], triangles: &[[Vec3; 4]]) -> Vec<u8> {
    let mut bytes = header.to_vec();
    bytes.resize(80, 0);
    bytes.extend(u32::try_from(triangles.len()).expect("a few").to_le_bytes());
    for triangle in triangles {
        for number in triangle.iter().flat_map(|v| v.to_array()) {
            bytes.extend(number.to_le_bytes());
        }
        bytes.extend([0, 0]);
    }
    bytes
}

const UP: [Vec3; 4] = [Vec3::Z, Vec3::ZERO, Vec3::X, Vec3::Y];

#[test]
fn solids_of_a_text_file_are_nodes() {
    let up = facet("0 0 1", ["0 0 0", "1 0 0", "0 1 0"]);
    let text = format!(
        "solid Deckel oben\r\n{up}endsolid Deckel oben\r\nSOLID\n{}endsolid\nsolid Deckel oben\n{up}{up}endsolid\n",
        up.to_uppercase()
    );
    let scene = scene(text.as_bytes());
    assert_eq!(
        nodes(&scene),
        ["Deckel oben", "part", "Deckel oben (2)"],
        "names, each once"
    );
    assert_eq!(
        scene.materials[2].name, "Deckel oben (2)",
        "materials are called so too"
    );
    assert_eq!(
        scene.meshes[0].positions,
        [Vec3::ZERO, Vec3::X, Vec3::Y],
        "its corners"
    );
    assert_eq!(
        scene.meshes[0].faces,
        [Face::Triangle([0, 1, 2])],
        "its winding"
    );
    assert_eq!(scene.meshes[2].faces.len(), 2, "all triangles");
    assert_eq!(scene.meshes[2].positions.len(), 3, "corners are shared");
    assert!(scene.report.warnings.is_empty(), "{:?}", warnings(&scene));
}

#[test]
fn a_binary_file_is_one_solid() {
    for (header, name) in [
        (&b"solid Bracket 7"[..], "Bracket 7"),
        (b"Exported from somewhere", "part"),
        (b"", "part"),
        (b"solid facet", "facet"),
        (b"\xff\xfe\x00", "part"),
    ] {
        let scene = scene(&binary(header, &[UP, UP]));
        assert_eq!(nodes(&scene), [name], "{header:?}");
        assert_eq!(scene.meshes[0].faces.len(), 2, "both triangles");
    }
}

#[test]
fn content_decides_not_the_ending() {
    let text = format!(
        "solid a\n{}endsolid\n",
        facet("0 0 1", ["0 0 0", "1 0 0", "0 1 0"])
    );
    for bytes in [text.into_bytes(), binary(b"solid facet", &[UP])] {
        let scene = opened(&bytes, "upload").expect("it is STL");
        assert_eq!(scene.face_count(), 1, "its triangle");
    }
}

#[test]
fn normals_that_disagree_are_told_once() {
    let down = [Vec3::NEG_Z, Vec3::ZERO, Vec3::X, Vec3::Y];
    let none = [Vec3::ZERO, Vec3::ZERO, Vec3::X, Vec3::Y];
    let scene = scene(&binary(b"", &[UP, down, none, down]));
    assert_eq!(scene.report.warnings.len(), 1, "{:?}", warnings(&scene));
    assert!(
        warnings(&scene)[0].contains("normals of 2 of 4"),
        "{:?}",
        warnings(&scene)
    );
    assert!(
        scene.meshes[0]
            .faces
            .iter()
            .all(|&face| face == Face::Triangle([0, 1, 2])),
        "the winding decides"
    );
}

#[test]
fn triangles_that_cannot_be_used_are_left_out() {
    let flat = [Vec3::Z, Vec3::ZERO, Vec3::ZERO, Vec3::Y];
    let nan = [Vec3::Z, Vec3::ZERO, Vec3::NAN, Vec3::Y];
    let mut bytes = binary(b"", &[flat, UP, nan]);
    bytes.extend(b"tail");
    let scene = scene(&bytes);
    assert_eq!(scene.face_count(), 1, "the good one");
    let told = warnings(&scene).join("; ");
    for part in [
        "1 triangle without an area",
        "triangle 3: a coordinate is not finite",
        "4 bytes after",
    ] {
        assert!(told.contains(part), "'{part}' is not in: {told}");
    }
}

#[test]
fn damaged_text_is_told_by_its_lines() {
    let good = facet("0 0 1", ["0 0 0", "1 0 0", "0 1 0"]);
    let word = facet("0 0 1", ["0 0 0", "1 zero 0", "0 1 0"]);
    let text = format!(
        "solid a\n{good}{word}facet normal 0 0 1\nvertex 1 2 3\nendfacet\nhello\nfacet normal\nvertex 0 0 0\nvertex 1 0 0\n"
    );
    let scene = scene(text.as_bytes());
    assert_eq!(scene.face_count(), 1, "the good one");
    let told = warnings(&scene).join("; ");
    for part in [
        "line 9: a vertex",
        "line 16: the facet has 1 vertices",
        "line 20: the facet has 2",
        "1 line without a meaning",
    ] {
        assert!(told.contains(part), "'{part}' is not in: {told}");
    }
}

#[test]
fn what_is_no_stl_is_refused_in_one_line() {
    let whole = binary(b"", &[UP, UP, UP]);
    assert!(
        refused(&whole[..200]).contains("3 triangles, there is room for 2"),
        "cut off"
    );
    assert!(
        refused(&whole[..40]).contains("40 bytes"),
        "a part of the header"
    );
    assert!(refused(b"").contains("0 bytes"), "nothing");
    assert!(
        refused(b"solid empty\nendsolid empty\n").contains("no triangles"),
        "an empty solid"
    );
    assert!(
        refused(&binary(b"", &[])).contains("no triangles"),
        "no triangles"
    );
    let mut huge = vec![0; 84];
    huge[80..84].copy_from_slice(&u32::MAX.to_le_bytes());
    assert!(
        refused(&huge).contains("4294967295 triangles"),
        "memory is not taken for them"
    );
    let nan = [Vec3::Z, Vec3::ZERO, Vec3::NAN, Vec3::Y];
    assert!(
        refused(&binary(b"", &[nan])).contains("not finite"),
        "the reason"
    );
}

#[test]
fn any_cut_of_a_text_file_opens_or_is_refused() {
    let text = format!(
        "solid a\n{}endsolid a\n",
        facet("0 0 1", ["0 0 0", "1 0 0", "0 1 0"])
    );
    for end in 0..text.len() {
        if let Err(error) = open_bytes(&text.as_bytes()[..end], "part.stl", None) {
            assert_eq!(
                error.to_string().lines().count(),
                1,
                "cut at {end}: {error}"
            );
        }
    }
}
