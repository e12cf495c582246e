//! Pictures in windows.

use crate::{Shader, shader};

/// Puts a picture into its place: vertex stage `cover`, fragment stages `exact` and `stretched`.
pub const PANE: Shader = shader!("pane");

pub(crate) const SHADERS: [Shader; 1] = [PANE];
