//! Why the program ends without having done what was asked.

use hemicube::radiosity::RadiosityError;
use hemicube::raster::image::{ImageError, ReadError};
use hemicube::render::RenderError;
use hemicube::scene::SceneError;

/// Why the program ends early; messages are one line: what, where, how to mend it.
#[derive(Debug)]
pub enum Failure {
    /// The command line asks for what makes no sense: exit code 2.
    Usage(String),
    /// It could not be done: exit code 1.
    Failed(String),
    /// Ctrl-C came and there was nothing to write: exit code 130. What was reached has been printed.
    Interrupted,
}

impl Failure {
    /// What to print, without the program's name.
    pub fn message(&self) -> Option<&str> {
        match self {
            Self::Usage(message) | Self::Failed(message) => Some(message),
            Self::Interrupted => None,
        }
    }

    /// The program's exit code.
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::Usage(_) => 2,
            Self::Failed(_) => 1,
            Self::Interrupted => 130,
        }
    }
}

impl From<SceneError> for Failure {
    fn from(error: SceneError) -> Self {
        Self::Failed(error.to_string())
    }
}

impl From<RadiosityError> for Failure {
    fn from(error: RadiosityError) -> Self {
        Self::Failed(error.to_string())
    }
}

impl From<RenderError> for Failure {
    fn from(error: RenderError) -> Self {
        Self::Failed(error.to_string())
    }
}

impl From<ReadError> for Failure {
    fn from(error: ReadError) -> Self {
        Self::Failed(error.to_string())
    }
}

impl From<ImageError> for Failure {
    fn from(error: ImageError) -> Self {
        Self::Failed(error.to_string())
    }
}

/// Text on one line whatever names and messages from elsewhere contain.
pub fn one_line(text: &str) -> String {
    let spaced: String = text
        .chars()
        .map(|c| if c.is_control() { ' ' } else { c })
        .collect();
    spaced.trim_end().to_owned()
}
