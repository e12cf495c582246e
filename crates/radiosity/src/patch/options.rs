//! How fine a mesh is.

use crate::error::RadiosityError;
use crate::patch::MAX_ELEMENTS;
use crate::patch::clean::CleanOptions;
use serde::{Deserialize, Serialize};

/// Longer than an edge between any two places that a mesh may have.
const LONGER_THAN_ANY_EDGE: f32 = 1e10;

/// How fine the mesh is. Sizes are edge lengths in scene units; counts choose the size that stays just below them.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct PatchOptions {
    /// Longest edge of a patch. Default value: three element sizes.
    pub patch_size: Option<f32>,
    /// Longest edge of an element. Default value: a third of the patch size, or by `elements`.
    pub element_size: Option<f32>,
    /// Number of patches to aim at if there is no `patch_size`, beyond one for each lit side of a face.
    pub patches: Option<usize>,
    /// Number of elements to aim at if there is no `element_size`, beyond one for each lit side of a face.
    /// Default value: 4000.
    pub elements: Option<usize>,
    /// How the model is mended first. Default value: all that is sure to be a fault; files that do not say were solved
    /// without.
    #[serde(default = "CleanOptions::none")]
    pub clean: CleanOptions,
}

impl PatchOptions {
    /// A mesh of about so many elements.
    pub fn with_elements(self, elements: usize) -> Self {
        Self {
            elements: Some(elements),
            ..self
        }
    }

    /// A mesh of about so many patches.
    pub fn with_patches(self, patches: usize) -> Self {
        Self {
            patches: Some(patches),
            ..self
        }
    }

    /// Elements with edges of at most this length.
    pub fn with_element_size(self, size: f32) -> Self {
        Self {
            element_size: Some(size),
            ..self
        }
    }

    /// The faces as they are: each lit side of a face is one patch and one element, and nothing is mended.
    pub fn whole_faces() -> Self {
        Self::default()
            .with_element_size(LONGER_THAN_ANY_EDGE)
            .with_clean(CleanOptions::none())
    }

    /// Patches with edges of at most this length.
    pub fn with_patch_size(self, size: f32) -> Self {
        Self {
            patch_size: Some(size),
            ..self
        }
    }

    /// How the model is mended first.
    pub fn with_clean(self, clean: CleanOptions) -> Self {
        Self { clean, ..self }
    }

    pub(super) fn check(&self) -> Result<(), RadiosityError> {
        for (name, size) in [
            ("patch size", self.patch_size),
            ("element size", self.element_size),
            ("distance of vertices to weld", self.clean.weld),
        ] {
            if let Some(size) = size.filter(|s| !s.is_finite() || *s <= 0.0) {
                return Err(RadiosityError::Option(format!(
                    "{name} {size} is not a positive length"
                )));
            }
        }
        for (name, count) in [("patches", self.patches), ("elements", self.elements)] {
            if let Some(count) = count.filter(|&n| n == 0 || n > MAX_ELEMENTS) {
                return Err(RadiosityError::Option(format!(
                    "{name} {count} is not between 1 and {MAX_ELEMENTS}"
                )));
            }
        }
        Ok(())
    }
}
