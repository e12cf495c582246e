//! How fine a mesh is.

use crate::error::RadiosityError;
use crate::patch::clean::CleanOptions;
use serde::{Deserialize, Serialize};

/// Longer than an edge between any two places that a mesh may have.
const LONGER_THAN_ANY_EDGE: f32 = 1e10;

/// How fine the mesh is. Sizes are edge lengths in scene units; counts choose the size that comes nearest to them.
///
/// Elements are met within 5 %, with those that joints and discontinuities add. Each lit side of a face is at least one: of
/// fewer than 4/3 of these sides there are as many as are asked for on top of the sides, at most a third of them, and what
/// cuts them. Patches are whole branches of the tree that cutting makes, so their number is met within a factor of two where
/// all faces are alike, and within some percent in most scenes.
///
/// Triangles, and quads whose opposite edges differ by a piece, become irregular triangles. Cells of the chosen size are
/// what joints and discontinuities cut: edges inside a cut cell may be as long as its diagonal.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct PatchOptions {
    /// Longest edge of a patch. Default value: three element sizes.
    pub patch_size: Option<f32>,
    /// Longest edge of an element. Default value: a third of the patch size, or by `elements`.
    pub element_size: Option<f32>,
    /// Number of patches to aim at if there is no `patch_size`. Default value: by `patch_size`.
    pub patches: Option<usize>,
    /// Number of elements to aim at if there is no `element_size`. Default value: nine for each of `patches`, or
    /// 4000.
    pub elements: Option<usize>,
    /// How the model is mended first. Default value: all that is sure to be a fault.
    pub clean: CleanOptions,
    /// Whether elements are cut where other faces meet them and in vertices of other faces that lie in their edges, see
    /// [`constraints`](crate::patch::constraints). Default value: yes.
    pub joints: bool,
    /// Whether elements are cut along the borders of shadows and penumbrae, see
    /// [`discontinuities`](crate::patch::discontinuities). Default value: no.
    pub discontinuities: bool,
}

impl Default for PatchOptions {
    fn default() -> Self {
        Self {
            patch_size: None,
            element_size: None,
            patches: None,
            elements: None,
            clean: CleanOptions::default(),
            joints: true,
            discontinuities: false,
        }
    }
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
            .with_joints(false)
    }

    /// Whether elements are cut where other faces meet them.
    pub fn with_joints(self, joints: bool) -> Self {
        Self { joints, ..self }
    }

    /// Whether elements are cut along the borders of shadows.
    pub fn with_discontinuities(self, discontinuities: bool) -> Self {
        Self {
            discontinuities,
            ..self
        }
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
            if count == Some(0) {
                return Err(RadiosityError::Option(format!("{name} 0 are too few")));
            }
        }
        Ok(())
    }
}
