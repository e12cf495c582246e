//! Where interreflected light is counted: on elements, or on patches where there are too many of them.

use crate::patch::PatchMesh;
use crate::patch::face::Side;
use glam::Vec3;

/// A cut through the mesh whose nodes count what arrives.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Receivers {
    /// Each element.
    Elements,
    /// Each patch; its elements take over its light by [interpolation](super::interpolate).
    Patches,
}

impl Receivers {
    /// The elements, if there are at most so many.
    pub(super) fn of(mesh: &PatchMesh, most_elements: usize) -> Self {
        if mesh.elements().len() <= most_elements {
            Self::Elements
        } else {
            Self::Patches
        }
    }

    /// The receiver over an element.
    pub(super) fn of_element(self, mesh: &PatchMesh, element: usize) -> usize {
        match self {
            Self::Elements => element,
            Self::Patches => mesh.patch_of_element(element),
        }
    }

    /// The receiver at a point of a face's side; none if that side only absorbs.
    pub(super) fn at(
        self,
        mesh: &PatchMesh,
        face: usize,
        side: Side,
        point: Vec3,
    ) -> Option<usize> {
        match self {
            Self::Elements => mesh.element_at(face, side, point),
            Self::Patches => mesh.patch_at(face, side, point),
        }
    }

    /// Exposed areas.
    pub(super) fn areas(self, mesh: &PatchMesh) -> Vec<f64> {
        let area = |e: usize| f64::from(mesh.exposed_area(e));
        match self {
            Self::Elements => (0..mesh.elements().len()).map(area).collect(),
            Self::Patches => (0..mesh.patches().len())
                .map(|patch| mesh.elements_of_patch(patch).map(area).sum())
                .collect(),
        }
    }
}
