//! The edge lengths at which subdivision stops, chosen from counts or given.

use crate::error::RadiosityError;
use crate::patch::PatchOptions;
use crate::patch::face::{WorldFace, newell_normal};
use glam::Vec3;
use hemicube_scene::Scene;

/// The edge lengths at which subdivision stops.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sizes {
    pub(super) element: f32,
    patch: f32,
    /// Patches on emitters, where they are a small part of the scene: a light shoots most and casts the shadows that
    /// people look at.
    emitter_patch: f32,
}

impl Sizes {
    pub(super) fn choose(
        scene: &Scene,
        faces: &[WorldFace],
        options: PatchOptions,
        most: usize,
    ) -> Result<Self, RadiosityError> {
        if let Some(elements) = options.elements.max(options.patches).filter(|&n| n > most) {
            return Err(RadiosityError::TooManyElements { elements, most });
        }
        let sided = |face: &WorldFace| scene.materials[face.material as usize].lit_sides();
        let by_count = |count: usize| size_for_count(faces, sided, count);
        let patch = options.patch_size.or_else(|| options.patches.map(by_count));
        let element = match (options.element_size, options.elements, patch) {
            (Some(size), ..) => size,
            (None, Some(count), _) => by_count(count),
            (None, None, Some(patch)) => patch / 3.0,
            (None, None, None) => by_count(4000),
        };
        let patch = patch.unwrap_or(3.0 * element).max(element);
        let needed: usize = faces
            .iter()
            .map(|f| sided(f) * cells_of(f, element, most))
            .fold(0, usize::saturating_add);
        if needed > most {
            let elements = needed;
            return Err(RadiosityError::TooManyElements { elements, most });
        }
        let area = |face: &WorldFace| f64::from(newell_normal(face.polygon()).length());
        let total: f64 = faces.iter().map(area).sum();
        let emitting: f64 = faces
            .iter()
            .filter(|f| scene.materials[f.material as usize].emits())
            .map(area)
            .sum();
        let emitter_patch = if emitting <= 0.05 * total {
            (patch / 4.0).max(element)
        } else {
            patch
        };
        Ok(Self {
            element,
            patch,
            emitter_patch,
        })
    }

    pub(super) fn patch_size(&self, scene: &Scene, face: &WorldFace) -> f32 {
        if scene.materials[face.material as usize].emits() {
            self.emitter_patch
        } else {
            self.patch
        }
    }
}

/// The smallest size that gives at most so many cells beyond one for each lit side of a face, by bisection.
fn size_for_count(faces: &[WorldFace], sided: impl Fn(&WorldFace) -> usize, count: usize) -> f32 {
    let longest = faces
        .iter()
        .flat_map(|f| f.polygon().iter().map(|&p| p.distance(f.corners[0])))
        .fold(0.0, f32::max);
    let sides: usize = faces.iter().map(&sided).sum();
    let count = count.saturating_add(sides);
    let cells = |size: f32| -> usize {
        let mut sum: usize = 0;
        for face in faces {
            sum = sum.saturating_add(sided(face) * cells_of(face, size, count));
            if sum > count {
                break;
            }
        }
        sum
    };
    let (mut low, mut high) = (longest * 1e-5, longest * 2.0);
    for _ in 0..24 {
        let middle = (low * high).sqrt();
        if cells(middle) > count {
            low = middle;
        } else {
            high = middle;
        }
    }
    high
}

/// How many cells a face becomes, estimated by its edges and stopped above a limit.
fn cells_of(face: &WorldFace, size: f32, limit: usize) -> usize {
    let polygon = face.polygon();
    let pieces = |a: Vec3, b: Vec3| -> usize {
        let halvings = (a.distance(b) / (size * 1.001))
            .log2()
            .ceil()
            .clamp(0.0, 24.0);
        1_usize << halving_count(halvings)
    };
    let cells = match *polygon {
        [a, b, c, d] => pieces(a, b)
            .max(pieces(c, d))
            .saturating_mul(pieces(b, c).max(pieces(d, a))),
        [a, b, c] => {
            let mut sides = [pieces(a, b), pieces(b, c), pieces(c, a)];
            sides.sort_unstable();
            sides[1].saturating_mul(sides[2])
        }
        _ => unreachable!("a face has three or four corners"),
    };
    cells.min(limit.saturating_add(1))
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "between 0 and 24"
)]
fn halving_count(halvings: f32) -> u32 {
    halvings as u32
}
