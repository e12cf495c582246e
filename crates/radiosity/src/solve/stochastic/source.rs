//! What a patch shoots, element by element.

use crate::patch::PatchMesh;

/// The elements of a patch, to be chosen in proportion to what they shoot.
pub(super) struct Source {
    /// The first of them among the mesh's elements.
    pub(super) first: usize,
    /// Running sums of the magnitudes.
    sums: Vec<f64>,
}

/// An element that was chosen.
pub(super) struct Choice {
    /// Its position among the mesh's elements.
    pub(super) element: usize,
    /// Its probability.
    pub(super) probability: f64,
    /// What the number that chose it says within the element, in [0, 1).
    pub(super) rest: f32,
}

impl Source {
    /// `magnitude` says how much an element shoots; negative numbers count as 0.
    pub(super) fn new(mesh: &PatchMesh, patch: usize, magnitude: impl Fn(usize) -> f64) -> Self {
        let elements = mesh.elements_of_patch(patch);
        let mut sum = 0.0;
        let first = elements.start;
        let add = |e: usize| {
            sum += magnitude(e).max(0.0);
            sum
        };
        Self {
            first,
            sums: elements.map(add).collect(),
        }
    }

    /// What all of them shoot.
    pub(super) fn total(&self) -> f64 {
        self.sums.last().copied().unwrap_or(0.0)
    }

    /// The element for a number in [0, 1). There must be something to shoot.
    pub(super) fn choose(&self, sample: f32) -> Choice {
        let wanted = f64::from(sample) * self.total();
        let found = self.sums.partition_point(|&sum| sum <= wanted);
        let index = found.min(self.sums.len() - 1);
        let start = if index == 0 {
            0.0
        } else {
            self.sums[index - 1]
        };
        let share = self.sums[index] - start;
        Choice {
            element: self.first + index,
            probability: share / self.total(),
            rest: super::to_f32((wanted - start) / share).clamp(0.0, 0.999_999_9),
        }
    }
}
