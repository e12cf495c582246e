//! Opening a scene by the name a user gives.

use crate::gltf::uri::read;
use crate::report::counted;
use crate::{ImportReport, Scene, SceneError, gltf, obj, stl, vs3};
use std::path::Path;

/// Opens a file (`.glb`, `.gltf`, `.obj`, `.stl`, `.vs3`) or a built-in scene.
///
/// A file of that name comes first; what it is, its content decides, then its ending.
///
/// # Errors
/// One line: what is wrong, where, how to mend it.
pub fn open(name_or_path: &str) -> Result<Scene, SceneError> {
    let path = Path::new(name_or_path);
    if path.is_file() {
        return open_path(path);
    }
    if let Some(scene) = crate::builtin::scene(name_or_path) {
        return Ok(scene);
    }
    match std::fs::metadata(path) {
        // A folder or a forbidden file: reading it says which.
        Ok(_) => open_path(path),
        Err(error) if error.kind() == std::io::ErrorKind::PermissionDenied => open_path(path),
        Err(_) => Err(SceneError::Unknown(one_line(name_or_path))),
    }
}

/// Opens a file.
///
/// # Errors
/// One line that starts with the path.
pub fn open_path(path: &Path) -> Result<Scene, SceneError> {
    let bytes = read(path).map_err(|source| SceneError::Read {
        path: path.to_path_buf(),
        source,
    })?;
    let folder = path
        .parent()
        .filter(|folder| !folder.as_os_str().is_empty())
        .unwrap_or(Path::new("."));
    open_bytes(&bytes, &path.to_string_lossy(), Some(folder))
}

/// Opens a file that is in memory: `name` is its name in messages, `folder` where the files beside it are, if anywhere.
///
/// # Errors
/// One line that starts with the name.
pub fn open_bytes(bytes: &[u8], name: &str, folder: Option<&Path>) -> Result<Scene, SceneError> {
    let ending = Path::new(name)
        .extension()
        .map(|e| e.to_string_lossy().to_lowercase());
    let text = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    let looks_like_gltf = bytes.starts_with(b"glTF") || text.trim_ascii_start().starts_with(b"{");
    match ending.as_deref() {
        _ if looks_like_gltf => gltf::import(bytes, name, folder),
        Some("gltf" | "glb") => gltf::import(bytes, name, folder),
        Some("obj") => obj::import(bytes, name, folder),
        Some("stl") => stl::import(bytes, name),
        Some("vs3") => vs3::import(bytes, name),
        _ if stl::is_stl(bytes) => stl::import(bytes, name),
        _ => Err(SceneError::Format(one_line(name))),
    }
}

/// What a file without faces is told: the first of the warnings may say why there are none.
pub(crate) fn no_triangles(report: &ImportReport) -> String {
    match report.warnings.as_slice() {
        [] => String::from("contains no triangles; export it with its meshes"),
        [first] => format!("contains no triangles that can be used: {first}"),
        [first, rest @ ..] => {
            let more = rest.len() + report.unlisted;
            format!(
                "contains no triangles that can be used: {first} (and {} more)",
                counted(more, "warning")
            )
        }
    }
}

/// A file's name without folder and ending.
pub(crate) fn stem(name: &str) -> String {
    let stem = Path::new(name)
        .file_stem()
        .map(|stem| stem.to_string_lossy());
    one_line(stem.as_deref().unwrap_or(name))
}

/// The scene if it holds what [`Scene::check`] promises; the message gets the file's name.
pub(crate) fn checked(scene: Scene, file: &str) -> Result<Scene, SceneError> {
    match scene.check() {
        Ok(()) => Ok(scene),
        Err(error) => Err(SceneError::Check(one_line(&format!("{file}: {error}")))),
    }
}

/// Text of a file as part of a line: control characters, line ends among them, become spaces.
pub(crate) fn one_line(text: &str) -> String {
    let is_break = |c: char| c.is_control() || matches!(c, '\u{2028}' | '\u{2029}');
    text.chars()
        .map(|c| if is_break(c) { ' ' } else { c })
        .collect()
}
