//! Documents under construction, and what is asked of them.

use base64::Engine as _;
use hemicube_scene::{Face, Scene, SceneError, open_bytes};
use serde_json::{Value, json};

/// A document under construction: one buffer, views and accessors are appended.
pub struct Builder {
    pub json: Value,
    pub bytes: Vec<u8>,
}

pub const F32: u32 = 5126;

impl Builder {
    pub fn new() -> Self {
        let json = json!({
            "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
            "meshes": [], "materials": [], "accessors": [], "bufferViews": []
        });
        Self {
            json,
            bytes: Vec::new(),
        }
    }

    pub fn push(&mut self, list: &str, item: Value) -> usize {
        let list = self.json[list]
            .as_array_mut()
            .expect("a list of the document");
        list.push(item);
        list.len() - 1
    }

    pub fn view(&mut self, bytes: &[u8]) -> usize {
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        let offset = self.bytes.len();
        self.bytes.extend_from_slice(bytes);
        self.push(
            "bufferViews",
            json!({"buffer": 0, "byteOffset": offset, "byteLength": bytes.len()}),
        )
    }

    pub fn accessor(&mut self, bytes: &[u8], component: u32, kind: &str, count: usize) -> usize {
        let view = self.view(bytes);
        self.push(
            "accessors",
            json!({"bufferView": view, "componentType": component, "type": kind, "count": count}),
        )
    }

    pub fn floats(&mut self, values: &[f32], kind: &str) -> usize {
        let width = match kind {
            "SCALAR" => 1,
            "VEC2" => 2,
            "VEC3" => 3,
            _ => 4,
        };
        let bytes: Vec<u8> = values.iter().flat_map(|v| v.to_le_bytes()).collect();
        self.accessor(&bytes, F32, kind, values.len() / width)
    }

    pub fn indices(&mut self, values: &[u32]) -> usize {
        let bytes: Vec<u8> = values.iter().flat_map(|v| v.to_le_bytes()).collect();
        self.accessor(&bytes, 5125, "SCALAR", values.len())
    }

    pub fn mesh(&mut self, primitive: Value) -> usize {
        self.push("meshes", json!({"name": "lamp", "primitives": [primitive]}))
    }

    /// One triangle in the plane z = 0 as mesh 0.
    pub fn with_triangle() -> Self {
        let mut builder = Self::new();
        let positions = builder.floats(&[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0], "VEC3");
        builder.mesh(json!({"attributes": {"POSITION": positions}}));
        builder
    }

    pub fn text(&self) -> String {
        let mut json = self.json.clone();
        if !self.bytes.is_empty() {
            let data = base64::engine::general_purpose::STANDARD.encode(&self.bytes);
            let uri = format!("data:application/octet-stream;base64,{data}");
            json["buffers"] = json!([{"byteLength": self.bytes.len(), "uri": uri}]);
        }
        json.to_string()
    }

    pub fn open(&self) -> Result<Scene, SceneError> {
        open_text(&self.text())
    }

    pub fn scene(&self) -> Scene {
        self.open().expect("the file is good")
    }

    /// The message, which is one line that begins with the file.
    pub fn refusal(&self) -> String {
        let message = self.open().expect_err("the file is bad").to_string();
        assert_refusal(&message);
        message
    }
}

pub fn assert_refusal(message: &str) {
    assert!(
        message.starts_with("folder/file.gltf: "),
        "it begins with the file: {message}"
    );
    assert!(!message.contains('\n'), "it is one line: {message}");
}

pub fn open_text(text: &str) -> Result<Scene, SceneError> {
    let outcome = open_bytes(text.as_bytes(), "folder/file.gltf", None);
    if let Ok(scene) = &outcome {
        scene.check().expect("what opens is consistent");
        assert_eq!(scene.name, "file", "the name is the stem of the file");
    }
    outcome
}

pub fn warnings(scene: &Scene) -> Vec<String> {
    scene
        .report
        .warnings
        .iter()
        .map(ToString::to_string)
        .collect()
}

pub fn assert_warned(scene: &Scene, part: &str) {
    assert!(
        warnings(scene).iter().any(|w| w.contains(part)),
        "no warning says '{part}': {:?}",
        warnings(scene)
    );
}

/// The corners of all faces of a mesh.
pub fn triangles(scene: &Scene, mesh: usize) -> Vec<[u32; 3]> {
    let corners = |face: &Face| match face {
        Face::Triangle(corners) => *corners,
        Face::Quad(_) => panic!("glTF has no quads"),
    };
    scene.meshes[mesh].faces.iter().map(corners).collect()
}

/// A document with one material, which the triangle uses.
pub fn with_material(material: Value) -> Builder {
    let mut builder = Builder::with_triangle();
    builder.push("materials", material);
    builder.json["meshes"][0]["primitives"][0]["material"] = json!(0);
    builder
}
