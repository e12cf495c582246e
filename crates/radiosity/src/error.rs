//! Why something could not be computed.

use hemicube_scene::SceneError;

/// A radiosity solution could not be made, stored or read; each message is one line.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RadiosityError {
    /// The scene itself cannot be used.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// Every face was left out.
    #[error("scene '{0}': no surface has an area, so there is nothing to light")]
    NoSurfaces(String),
    /// Nothing gives light.
    #[error(
        "scene '{0}': nothing gives light; make a material emit with --emit MATERIAL=R,G,B (radiance, * matches all) or add a sky with --sky R,G,B"
    )]
    NoLight(String),
    /// An option is out of its range.
    #[error("{0}")]
    Option(String),
    /// A mesh would have more elements than wanted at most.
    #[error(
        "the mesh would have {elements} elements or more, at most {most} fit; ask for fewer or larger ones, or leave out what cuts them"
    )]
    TooManyElements {
        /// As far as they were counted.
        elements: usize,
        /// What was allowed.
        most: usize,
    },
    /// A file holds no solution, or a damaged one.
    #[error("{0}")]
    File(String),
    /// It was asked to stop before there was light to return.
    #[error("stopped {0}, before there was light to keep")]
    Stopped(&'static str),
    /// Light would grow without bound.
    #[error("{0}")]
    Divergent(String),
}
