//! The JSON part: is it glTF 2.0, and can what it requires be done?

use crate::ImportReport;
use gltf::json::Root;
use serde::Deserialize;
use serde::de::{DeserializeSeed, Deserializer, IgnoredAny, MapAccess, SeqAccess, Visitor};
use serde_json::Value;
use std::collections::HashMap;
use std::fmt;

/// What a file of the old format is told.
pub const VERSION_1: &str =
    "it is glTF 1.0, only 2.0 can be read; convert it with `gltf-pipeline` or export it again";

const REST_POSE: &str = "are not read; the rest pose is taken";

/// Extensions that are read.
const READ: &[&str] = &[
    "EXT_mesh_gpu_instancing",
    "KHR_lights_punctual",
    "KHR_materials_emissive_strength",
    "KHR_materials_pbrSpecularGlossiness",
    "KHR_materials_transmission",
    "KHR_materials_unlit",
    "KHR_mesh_quantization",
    "KHR_node_visibility",
    "KHR_texture_transform",
];

/// Extensions without which the diffuse solution is the same: reflections, variants, metadata, animation.
const HARMLESS: &[&str] = &[
    "KHR_animation_pointer",
    "KHR_materials_anisotropy",
    "KHR_materials_clearcoat",
    "KHR_materials_dispersion",
    "KHR_materials_ior",
    "KHR_materials_iridescence",
    "KHR_materials_sheen",
    "KHR_materials_specular",
    "KHR_materials_variants",
    "KHR_materials_volume",
    "KHR_xmp",
    "KHR_xmp_json_ld",
];

/// The JSON as text: UTF-8, well-formed, and every index one that fits 32 bits.
///
/// The last is looked at here because the types of `gltf-json` cut larger numbers off silently.
pub fn checked_text(json: &[u8]) -> Result<&str, String> {
    let json = json.strip_prefix(b"\xef\xbb\xbf").unwrap_or(json);
    let text = std::str::from_utf8(json).map_err(|e| {
        format!(
            "not valid glTF: byte {} of its JSON is not UTF-8; save it as UTF-8",
            e.valid_up_to()
        )
    })?;
    let text = text.trim_end_matches('\0');
    let mut reader = serde_json::Deserializer::from_str(text);
    let outcome = IndexCheck { is_index: false }
        .deserialize(&mut reader)
        .and_then(|()| reader.end());
    outcome.map(|()| text).map_err(|e| not_valid(&e))
}

/// Refuses other versions of glTF by name.
pub fn check_version(json: &str) -> Result<(), String> {
    #[derive(Deserialize)]
    struct Head {
        asset: Option<Asset>,
    }
    #[derive(Deserialize)]
    #[serde(rename_all = "camelCase")]
    struct Asset {
        version: Option<String>,
        min_version: Option<String>,
    }
    // What is not even a head is left to the full reading, which says it better.
    let Ok(head) = serde_json::from_str::<Head>(json) else {
        return Ok(());
    };
    let Some(asset) = head.asset else {
        // In glTF 1.0 the asset is optional and collections are objects.
        #[derive(Deserialize)]
        struct Version1 {
            #[serde(rename = "buffers")]
            _buffers: HashMap<String, IgnoredAny>,
        }
        let is_version_1 = serde_json::from_str::<Version1>(json).is_ok();
        return if is_version_1 {
            Err(String::from(VERSION_1))
        } else {
            Ok(())
        };
    };
    let (version, min_version) = (asset.version.as_deref(), asset.min_version.as_deref());
    match (
        version.and_then(major_and_minor),
        min_version.and_then(major_and_minor),
    ) {
        (Some((1, _)), _) => Err(String::from(VERSION_1)),
        (Some((2, _)) | None, Some(needed)) if needed > (2, 0) => Err(too_new(needed)),
        (Some(stated), _) if stated.0 != 2 => Err(too_new(stated)),
        _ => Ok(()),
    }
}

fn major_and_minor(version: &str) -> Option<(u32, u32)> {
    let (major, minor) = version.split_once('.')?;
    Some((major.parse().ok()?, minor.parse().ok()?))
}

fn too_new((major, minor): (u32, u32)) -> String {
    format!("it is for glTF {major}.{minor}, only 2.0 can be read; export it again as glTF 2.0")
}

/// The document in the types of `gltf-json`; nothing in it is validated beyond its shape.
pub fn parse(json: &str, report: &mut ImportReport) -> Result<Root, String> {
    serde_json::from_str(json)
        .or_else(|error| without_the_unread(json, report).ok_or_else(|| not_valid(&error)))
}

/// The document once more, without what is not read anyway and with what the specification lets a file leave out.
///
/// The crate wants nodes in every scene and a node for every animation's target; glTF 2.0 does not.
fn without_the_unread(json: &str, report: &mut ImportReport) -> Option<Root> {
    let mut value: Value = serde_json::from_str(json).ok()?;
    let document = value.as_object_mut()?;
    let animations = document.remove("animations");
    for scene in document
        .get_mut("scenes")
        .and_then(Value::as_array_mut)
        .into_iter()
        .flatten()
    {
        scene
            .as_object_mut()?
            .entry("nodes")
            .or_insert_with(|| Value::Array(Vec::new()));
    }
    let root = Root::deserialize(value).ok()?;
    if animations.is_some() {
        report.warn("animations", REST_POSE);
    }
    Some(root)
}

/// What serde says in one bearable line; it may quote a whole inlined buffer.
fn not_valid(error: &serde_json::Error) -> String {
    let message = error.to_string();
    let count = message.chars().count();
    if count <= 400 {
        return format!("not valid glTF: {message}");
    }
    let head: String = message.chars().take(200).collect();
    let tail: String = message.chars().skip(count - 160).collect();
    format!("not valid glTF: {head} ... {tail}")
}

/// Refuses extensions that the file requires and this program does not have, all of them by name.
pub fn check_extensions(root: &Root) -> Result<(), String> {
    let known = |name: &str| READ.contains(&name) || HARMLESS.contains(&name);
    let missing: Vec<&str> = root
        .extensions_required
        .iter()
        .map(String::as_str)
        .filter(|name| !known(name))
        .collect();
    if missing.is_empty() {
        return Ok(());
    }
    let names = missing.join(", ");
    let names: String = names.chars().take(300).collect();
    Err(format!(
        "it requires {names}, which cannot be read; export it again without compression and with PNG or JPEG textures"
    ))
}

/// Says once what of the document is not taken into account.
pub fn report_what_is_ignored(root: &Root, report: &mut ImportReport) {
    if !root.animations.is_empty() {
        report.warn("animations", REST_POSE);
    }
    if root.nodes.iter().any(|node| node.skin.is_some()) {
        report.warn("skins", REST_POSE);
    }
    if root
        .meshes
        .iter()
        .flat_map(|mesh| &mesh.primitives)
        .any(|p| p.targets.is_some())
    {
        report.warn("morph targets", REST_POSE);
    }
    for name in root
        .extensions_required
        .iter()
        .filter(|name| HARMLESS.contains(&name.as_str()))
    {
        report.warn(
            "extensions",
            format!("{name} is required by the file; it is left out, diffuse light is the same"),
        );
    }
}

/// Walks any JSON and refuses a number that is no 32-bit index where `gltf-json` would read one.
struct IndexCheck {
    is_index: bool,
}

/// Keys whose numbers `gltf-json` cuts off to 32 bits.
const INDEX_KEYS: &[&str] = &[
    "buffer",
    "bufferView",
    "camera",
    "children",
    "componentType",
    "indices",
    "index",
    "input",
    "joints",
    "material",
    "mesh",
    "mode",
    "node",
    "nodes",
    "output",
    "sampler",
    "scene",
    "skeleton",
    "skin",
    "source",
    "target",
    "wrapS",
    "wrapT",
    "attributes",
    "targets",
    "inverseBindMatrices",
    "magFilter",
    "minFilter",
];

impl<'de> DeserializeSeed<'de> for IndexCheck {
    type Value = ();
    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<(), D::Error> {
        deserializer.deserialize_any(self)
    }
}

impl<'de> Visitor<'de> for IndexCheck {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("JSON")
    }

    fn visit_u64<E: serde::de::Error>(self, value: u64) -> Result<(), E> {
        if self.is_index && value > u64::from(u32::MAX) {
            return Err(E::custom(format!("{value} is no index or code of glTF")));
        }
        Ok(())
    }

    fn visit_i64<E>(self, _: i64) -> Result<(), E> {
        Ok(())
    }

    fn visit_f64<E>(self, _: f64) -> Result<(), E> {
        Ok(())
    }

    fn visit_bool<E>(self, _: bool) -> Result<(), E> {
        Ok(())
    }

    fn visit_str<E>(self, _: &str) -> Result<(), E> {
        Ok(())
    }

    fn visit_unit<E>(self) -> Result<(), E> {
        Ok(())
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut items: A) -> Result<(), A::Error> {
        while items
            .next_element_seed(Self {
                is_index: self.is_index,
            })?
            .is_some()
        {}
        Ok(())
    }

    fn visit_map<A: MapAccess<'de>>(self, mut entries: A) -> Result<(), A::Error> {
        while let Some(key) = entries.next_key::<String>()? {
            if key == "extras" || key == "extensions" {
                entries.next_value::<IgnoredAny>()?;
            } else {
                // The names of attributes are the file's own; their values are indices.
                let is_index =
                    INDEX_KEYS.contains(&key.as_str()) || (self.is_index && is_attribute(&key));
                entries.next_value_seed(Self { is_index })?;
            }
        }
        Ok(())
    }
}

fn is_attribute(key: &str) -> bool {
    key.starts_with('_') || key.starts_with(|c: char| c.is_ascii_uppercase())
}
