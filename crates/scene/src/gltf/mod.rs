//! glTF 2.0 comes in: `.gltf` with its buffers and pictures beside it or inlined, and `.glb`.
//!
//! # What is read
//! - Geometry: triangles, triangle strips and fans, with and without indices, sparse accessors, every component type,
//!   normalised integers, `KHR_mesh_quantization`. One [`Mesh`](crate::Mesh) per primitive, placed by one
//!   [`Instance`](crate::Instance) per node; `EXT_mesh_gpu_instancing` places it many times.
//! - The default scene, else the first one, else every node without a parent; `KHR_node_visibility` hides.
//! - Materials: base colour, metallic, roughness, emission (`KHR_materials_emissive_strength`), transmission
//!   (`KHR_materials_transmission`), alpha modes, `doubleSided`, `KHR_materials_pbrSpecularGlossiness` (its diffuse
//!   part), `KHR_materials_unlit` (counts as diffuse), `KHR_texture_transform`; vertex colours `COLOR_0`.
//! - PNG and JPEG pictures, wrap modes; cameras; `KHR_lights_punctual` (its `range` is a hint for renderers and is not
//!   used: light does not end).
//!
//! # What is not read
//! - Points and lines (with a warning), skins, morph targets and animations (rest pose, with a warning).
//! - Normal, occlusion and roughness textures, filters, tangents, and extensions that change only reflections.
//! - Draco and meshopt compression, Basis, WebP and DDS pictures: refused where the file requires them, otherwise the
//!   file's fallback is used.
//!
//! # What a damaged file does
//! Nothing that a file says is believed: every index, count, stride and length is checked against the bytes that are
//! there. What makes the file as a whole doubtful is refused with one line; a bad triangle, a missing picture, an
//! attribute of the wrong length is left out with a [`Warning`](crate::Warning).

mod accessor;
mod buffers;
pub mod container;
mod document;
mod extension;
mod geometry;
mod light;
mod material;
mod nodes;
mod texture;
pub(crate) mod uri;

use crate::open::{checked, one_line, stem};
use crate::{Scene, SceneError};
use std::path::Path;

/// What every reader of the importer looks at: the document and the bytes it speaks of.
#[derive(Clone, Copy)]
struct Source<'a> {
    /// The JSON part.
    root: &'a gltf::json::Root,
    /// Every buffer's bytes, as long as the file says.
    buffers: &'a [std::borrow::Cow<'a, [u8]>],
    /// Where relative names are looked for; `None` if there are no files beside this one.
    folder: Option<&'a Path>,
}

/// Reads a glTF file from memory: `file` names it in messages, `folder` is where the files beside it are.
///
/// # Errors
/// One line that starts with `file`: what is wrong, where, how to mend it.
pub fn import(bytes: &[u8], file: &str, folder: Option<&Path>) -> Result<Scene, SceneError> {
    let invalid = |message: String| SceneError::Invalid(one_line(&format!("{file}: {message}")));
    let unsupported =
        |message: String| SceneError::Unsupported(one_line(&format!("{file}: {message}")));
    let container = container::split(bytes).map_err(|refusal| match refusal {
        container::Refusal::Version1 => unsupported(String::from(document::VERSION_1)),
        container::Refusal::Damaged(message) => invalid(message),
    })?;
    let json = document::checked_text(container.json).map_err(invalid)?;
    document::check_version(json).map_err(unsupported)?;
    let mut scene = Scene {
        name: stem(file),
        ..Scene::default()
    };
    let root = document::parse(json, &mut scene.report).map_err(invalid)?;
    document::check_extensions(&root).map_err(unsupported)?;
    let buffers = buffers::load(&root, container.binary, folder).map_err(invalid)?;
    let source = Source {
        root: &root,
        buffers: &buffers,
        folder,
    };

    document::report_what_is_ignored(&root, &mut scene.report);
    material::read_all(source, &mut scene);
    nodes::read_scene(source, &mut scene).map_err(invalid)?;
    checked(scene, file)
}

/// The name in the file in one line, or `kind number` where there is none.
fn name_or(name: Option<&String>, kind: &str, number: usize) -> String {
    match name {
        Some(name) if !name.trim().is_empty() => one_line(name),
        _ => format!("{kind} {number}"),
    }
}
