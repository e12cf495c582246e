//! Where interreflected light is counted: on elements, or on patches where there are too many of them.

use super::source::Source;
use crate::patch::PatchMesh;
use crate::patch::exposure::ExposedArea;
use crate::patch::face::Side;
use core::ops::Range;
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

    /// The receivers of a patch.
    pub(super) fn of_patch(self, mesh: &PatchMesh, patch: usize) -> Range<usize> {
        match self {
            Self::Elements => mesh.elements_of_patch(patch),
            Self::Patches => patch..patch + 1,
        }
    }

    /// The patch of a receiver.
    pub(super) fn patch_of(self, mesh: &PatchMesh, receiver: usize) -> usize {
        match self {
            Self::Elements => mesh.patch_of_element(receiver),
            Self::Patches => receiver,
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

/// Where the rays of a receiver start.
pub(super) enum Start {
    /// On an element, with its normal.
    Element(ExposedArea, Vec3),
    /// On the elements of a patch, by their areas.
    Patch(Source, Vec<(ExposedArea, Vec3)>),
}

impl Start {
    /// None if nothing of the receiver is exposed.
    pub(super) fn new(mesh: &PatchMesh, receivers: Receivers, receiver: usize) -> Option<Self> {
        let element = |e: usize| (mesh.exposed(e), mesh.node(mesh.elements()[e]).normal);
        match receivers {
            Receivers::Elements => {
                let (area, normal) = element(receiver);
                (area.area() > 0.0).then_some(Self::Element(area, normal))
            }
            Receivers::Patches => {
                let source = Source::new(mesh, receiver, |e| f64::from(mesh.exposed_area(e)));
                let elements = mesh.elements_of_patch(receiver).map(element);
                (source.total() > 0.0).then(|| Self::Patch(source, elements.collect()))
            }
        }
    }

    /// A point by area, and the normal there.
    pub(super) fn point(&self, [u, v]: [f32; 2]) -> (Vec3, Vec3) {
        match self {
            Self::Element(area, normal) => (area.point([u, v]), *normal),
            Self::Patch(source, elements) => {
                let choice = source.choose(u);
                let (area, normal) = &elements[choice.element - source.first];
                (area.point([choice.rest, v]), *normal)
            }
        }
    }
}
