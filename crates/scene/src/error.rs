//! Why a scene cannot be used.

use std::path::PathBuf;

/// A scene that cannot be opened or used; each message is one line: what, where, how to mend it.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SceneError {
    /// The file could not be read.
    #[error("{}: {}", path.display(), hemicube_raster::io_error::in_words(source))]
    Read {
        /// Which file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// Neither a file nor a built-in scene.
    #[error(
        "'{0}' is neither a file nor a built-in scene; `hemicube scenes` lists the built-in ones"
    )]
    Unknown(String),
    /// The name's ending is not one of a format that can be read.
    #[error(
        "{0}: not a scene format that can be read; convert it to .glb, .gltf, .obj, .stl or .vs3"
    )]
    Format(String),
    /// The file is damaged or breaks its format's rules.
    #[error("{0}")]
    Invalid(String),
    /// The file needs what this program does not have.
    #[error("{0}")]
    Unsupported(String),
    /// A scene breaks a rule of [`Scene::check`](crate::Scene::check), or an option does not fit it.
    #[error("{0}")]
    Check(String),
}
