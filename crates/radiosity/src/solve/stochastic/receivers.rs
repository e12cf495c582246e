//! Where shots of reflected light are counted: on elements, or on patches where there are too many of them.

use crate::patch::PatchMesh;
use crate::patch::exposure::ExposedArea;
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

/// Numbers of elements, so many of each, as one slice for each patch.
pub(super) fn by_patch<'a, T>(
    mesh: &PatchMesh,
    mut numbers: &'a mut [T],
    width: usize,
) -> Vec<&'a mut [T]> {
    let mut of_patches = Vec::with_capacity(mesh.patches().len());
    for patch in 0..mesh.patches().len() {
        let count = mesh.elements_of_patch(patch).len();
        let (of_patch, rest) = numbers.split_at_mut(count * width);
        of_patches.push(of_patch);
        numbers = rest;
    }
    of_patches
}

/// Where the rays of an element start.
pub(super) struct Start {
    area: ExposedArea,
    normal: Vec3,
}

impl Start {
    /// None if nothing of the element is exposed.
    pub(super) fn new(mesh: &PatchMesh, element: usize) -> Option<Self> {
        let area = mesh.exposed(element);
        let normal = mesh.node(mesh.elements()[element]).normal;
        (area.area() > 0.0).then_some(Self { area, normal })
    }

    /// A point by area, and the normal there.
    pub(super) fn point(&self, sample: [f32; 2]) -> (Vec3, Vec3) {
        (self.area.point(sample), self.normal)
    }
}
