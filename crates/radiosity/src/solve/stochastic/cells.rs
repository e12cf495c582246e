//! Groups of patches near each other that look the same way: what hides a lamp from one mostly hides it from the others.
//!
//! All patches of a cell share a cut of the tree of lamps, so what rays found from each of them can be summed up, and
//! a patch that knows little takes the word of its cell.

use super::lights::{Lights, Place};
use glam::{UVec3, Vec3};
use rayon::prelude::*;

/// Most patches of a cell.
const PATCHES: usize = 16;

/// Rays of a cell for which its share counts in that of a patch.
const TRUST: f32 = 2.0;

/// Rays to a part of a cut, and those that brought light. Halved where they would not fit.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(super) struct Found {
    rays: u8,
    lit: u8,
}

/// Of all patches of a cell.
#[derive(Debug, Clone, Copy, Default)]
struct Tries {
    rays: u32,
    lit: u32,
}

/// A group of patches.
pub(super) struct Cell {
    pub(super) patches: Vec<u32>,
    /// What holds them.
    pub(super) around: Place,
    pub(super) cut: Vec<u32>,
    /// What rays found, for each patch the parts of the cut; empty as long as nothing is known.
    pub(super) found: Vec<Found>,
    tries: Vec<Tries>,
}

impl Cell {
    fn new(patches: Vec<u32>, places: &[Place], lights: &Lights) -> Self {
        let around = Place::around(patches.iter().map(|&patch| &places[patch as usize]));
        Self {
            cut: lights.parts(&around),
            around,
            patches,
            found: Vec::new(),
            tries: Vec::new(),
        }
    }

    /// Sums up what its patches have found.
    pub(super) fn sum_up(&mut self) {
        self.tries = vec![Tries::default(); self.cut.len()];
        for of_patch in self.found.chunks_exact(self.cut.len().max(1)) {
            for (sum, found) in self.tries.iter_mut().zip(of_patch) {
                sum.rays += u32::from(found.rays);
                sum.lit += u32::from(found.lit);
            }
        }
    }

    /// Share of the rays to a part that bring light, for a patch that has found something: that of the cell as long as it
    /// knows little, and between none and all as long as the cell does.
    pub(super) fn share(&self, part: usize, found: Found) -> f32 {
        let tries = self.tries.get(part).copied().unwrap_or_default();
        let of_cell = (tries.lit as f32 + 0.25) / (tries.rays as f32 + 0.5);
        (f32::from(found.lit) + TRUST * of_cell) / (f32::from(found.rays) + TRUST)
    }
}

impl Found {
    /// Counts a ray.
    pub(super) fn count(&mut self, is_lit: bool) {
        if self.rays == u8::MAX {
            self.rays /= 2;
            self.lit /= 2;
        }
        self.rays += 1;
        self.lit += u8::from(is_lit);
    }
}

/// Groups of patches by where they are; none if there are no lamps.
pub(super) fn cells(places: &[Place], lights: &Lights) -> Vec<Cell> {
    let groups = groups(places).into_par_iter();
    groups
        .map(|patches| Cell::new(patches, places, lights))
        .collect()
}

/// Patches that face the same of six ways, in the order of a space-filling curve, cut to pieces.
fn groups(places: &[Place]) -> Vec<Vec<u32>> {
    let nothing = (Vec3::INFINITY, Vec3::NEG_INFINITY);
    let (low, high) = places.iter().fold(nothing, |(low, high), place| {
        (low.min(place.centroid), high.max(place.centroid))
    });
    let size = (high - low).max_element().max(f32::MIN_POSITIVE);
    let mut order: Vec<(u32, u32, u32)> = places
        .iter()
        .enumerate()
        .map(|(patch, place)| {
            let along = (place.centroid - low) / size;
            (way(place.normal), morton(along), crate::index32(patch))
        })
        .collect();
    order.par_sort_unstable();
    order
        .chunk_by(|a, b| a.0 == b.0)
        .flat_map(|same_way| same_way.chunks(PATCHES))
        .map(|group| group.iter().map(|&(.., patch)| patch).collect())
        .collect()
}

/// Which side of a cube a direction goes through.
fn way(normal: Vec3) -> u32 {
    let axis = normal.abs().max_position();
    2 * crate::index32(axis) + u32::from(normal[axis] < 0.0)
}

/// Position along Morton's curve of a point in the unit cube.
fn morton(point: Vec3) -> u32 {
    let cells = (point * 1023.0).as_uvec3().min(UVec3::splat(1023));
    let spread = |x: u32| (0..10).fold(0, |code, bit| code | (x >> bit & 1) << (3 * bit));
    spread(cells.x) | spread(cells.y) << 1 | spread(cells.z) << 2
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbours_that_look_the_same_way_share_a_cell() {
        let place = |i: u16| {
            Place::point(
                Vec3::new(f32::from(i % 40), 0.0, f32::from(i / 40)),
                if i.is_multiple_of(2) {
                    Vec3::Y
                } else {
                    Vec3::X
                },
            )
        };
        let places: Vec<Place> = (0..1600).map(place).collect();
        let cells = cells(&places, &Lights::new(&[]));
        let mut seen = vec![0; places.len()];
        let mut distances = 0.0;
        for cell in &cells {
            assert!(cell.patches.len() <= PATCHES, "{}", cell.patches.len());
            for &patch in &cell.patches {
                let (first, place) = (&places[cell.patches[0] as usize], &places[patch as usize]);
                assert_eq!(first.normal, place.normal, "they look the same way");
                distances += first.centroid.distance(place.centroid);
                seen[patch as usize] += 1;
            }
        }
        // Two places of the grid are 21 apart in the mean; where the curve jumps, so are neighbours.
        let mean = distances / places.len() as f32;
        assert!(mean < 6.0, "they are {mean} apart");
        assert!(seen.iter().all(|&n| n == 1), "each is in one cell");
    }
}
