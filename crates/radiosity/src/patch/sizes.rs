//! The edge lengths at which subdivision stops, chosen from counts or given.
//!
//! A count becomes a size by bisection: cells are counted as the mesher would cut them, without making them. What joints
//! and shadow lines add is not known before; it is taken from a first mesh, see [`Sizes::corrected`].

use crate::cast::nearest;
use crate::error::RadiosityError;
use crate::patch::PatchOptions;
use crate::patch::face::{WorldFace, newell_normal};
use crate::patch::subdivide::{self, Size};
use core::sync::atomic::{AtomicUsize, Ordering};
use glam::Vec3;
use hemicube_scene::Scene;
use rayon::prelude::*;

/// Of scenes of many faces, of which each is at least an element, so many are wanted on top as are asked for, up to a share
/// of the lit sides of one to this: fewer would leave the large faces uncut, on which light is seen.
const SHARE_ON_TOP: usize = 3;

/// Sizes are looked for between the longest length and this share of it.
const LEAST_SIZE: f32 = 1e-5;

/// Steps of bisection: they divide that range into parts of 1.00005.
const BISECTIONS: u32 = 18;

/// A size is chosen so much off the one at which the count changes: there edges of one length may differ by rounding.
const OFF_THE_STEP: f32 = 1.0003;

/// Relative error at which a count is met.
const MET: f64 = 0.03;

/// Sizes that are tried on either side of the one that meets a count for one with fewer fans, their ratio, and by how much
/// they may miss the count.
const GRIDS_TRIED: i32 = 8;
const GRID_STEP: f32 = 1.0017;
const MOST_OFF_FOR_GRIDS: f64 = 0.02;
/// In finer meshes fans are small, and counting takes longer.
const MOST_ELEMENTS_FOR_GRIDS: usize = 200_000;

/// Elements if nothing is said of them.
const DEFAULT_ELEMENTS: usize = 4000;

/// Elements of a patch along an edge and in all, if nothing is said of either.
const PATCH_EDGE: f32 = 3.0;
const ELEMENTS_OF_PATCH: usize = 9;

/// Edges are only halved where more than this share of the lit areas is no parallelogram.
const UNEVEN: f64 = 0.02;

/// Emitters of at most this share of all areas have patches that are so many times finer.
const SMALL_EMITTERS: f64 = 0.05;
const FINER_EMITTERS: f32 = 4.0;

/// The edge lengths at which subdivision stops.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sizes {
    pub(super) element: f32,
    patch: f32,
    /// Patches on emitters, where they are a small part of the scene: a light shoots most and casts the shadows that
    /// people look at.
    emitter_patch: f32,
    /// Whether edges are only halved.
    is_halving: bool,
    /// The elements that are wanted in all, and those that there are before anything cuts them; none if the size is given
    /// or follows from the number of faces.
    aim: Option<Aim>,
}

#[derive(Debug, Clone, Copy)]
struct Aim {
    wanted: usize,
    uncut: usize,
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
        let surfaces = Surfaces::new(scene, faces);
        let (element, aim) = match (options.element_size, options.patch_size) {
            (Some(size), _) => (size, None),
            (None, Some(patch)) if options.elements.is_none() => (patch / PATCH_EDGE, None),
            _ => surfaces.element_size(wanted_elements(options)),
        };
        if surfaces.elements(element, most.saturating_add(1)) > most {
            let elements = surfaces.estimate(element).max(most.saturating_add(1));
            return Err(RadiosityError::TooManyElements { elements, most });
        }
        Ok(surfaces.with_patches(element, aim, options))
    }

    /// Other sizes for a mesh that was cut to so many elements, if those are not about as many as are wanted. What cuts
    /// elements are lines: with finer elements they add more as the root of the number of elements grows.
    pub(super) fn corrected(
        &self,
        scene: &Scene,
        faces: &[WorldFace],
        options: PatchOptions,
        elements: usize,
    ) -> Option<Self> {
        let Aim { wanted, uncut } = self.aim?;
        let off = elements as f64 / wanted as f64 - 1.0;
        if off.abs() <= MET {
            return None;
        }
        let added = (elements as f64 - uncut as f64) / (uncut as f64).sqrt();
        // u + added √u = wanted
        let root = (added * added / 4.0 + wanted as f64).sqrt() - added / 2.0;
        let surfaces = Surfaces::new(scene, faces);
        let (element, aim) = surfaces.element_size_of(wanted, nearest(root * root));
        // Where the number of faces decides, or nothing comes nearer.
        let aim = aim.filter(|aim| aim.uncut != uncut)?;
        Some(surfaces.with_patches(element, Some(aim), options))
    }

    /// What edges of elements are cut to.
    pub(super) fn size(&self) -> Size {
        Size {
            longest: self.element,
            is_halving: self.is_halving,
        }
    }

    pub(super) fn patch_size(&self, scene: &Scene, face: &WorldFace) -> f32 {
        if scene.materials[face.material as usize].emits() {
            self.emitter_patch
        } else {
            self.patch
        }
    }
}

/// A lit face as far as sizes care.
struct Surface {
    face: WorldFace,
    sides: usize,
    emits: bool,
}

/// The lit faces of a scene.
struct Surfaces {
    all: Vec<Surface>,
    sides: usize,
    longest: f32,
    /// Whether emitters are so small a part that their patches are finer.
    are_emitters_small: bool,
    /// Whether so much of them is no parallelogram that edges are only halved.
    is_halving: bool,
}

impl Surfaces {
    fn new(scene: &Scene, faces: &[WorldFace]) -> Self {
        let all: Vec<Surface> = faces
            .iter()
            .map(|face| {
                let material = &scene.materials[face.material as usize];
                Surface {
                    face: *face,
                    sides: material.lit_sides(),
                    emits: material.emits(),
                }
            })
            .collect();
        let area = |surface: &Surface| f64::from(newell_normal(surface.face.polygon()).length());
        let total: f64 = all.iter().map(area).sum();
        let uneven = |surface: &&Surface| !subdivide::is_parallelogram(surface.face.polygon());
        let lit = || all.iter().filter(|surface| surface.sides > 0);
        let uneven: f64 = lit().filter(uneven).map(area).sum();
        let of_lit: f64 = lit().map(area).sum();
        let emitting: f64 = all.iter().filter(|s| s.emits).map(area).sum();
        let lengths = faces.iter().flat_map(|face| {
            let from_first = |&p: &Vec3| p.distance(face.corners[0]);
            face.polygon().iter().map(from_first)
        });
        Self {
            sides: all.iter().map(|s| s.sides).sum(),
            longest: lengths.fold(0.0, f32::max),
            are_emitters_small: emitting <= SMALL_EMITTERS * total,
            is_halving: uneven > UNEVEN * of_lit,
            all,
        }
    }

    fn cut_to(&self, longest: f32) -> Size {
        Size {
            longest,
            is_halving: self.is_halving,
        }
    }

    /// Elements of a size before anything cuts them, counted up to a limit.
    fn elements(&self, size: f32, limit: usize) -> usize {
        self.count(limit, |surface, limit| {
            subdivide::count(surface.face.polygon(), self.cut_to(size), size, limit).cells
        })
    }

    /// Patches among them.
    fn patches(&self, sizes: &Sizes, limit: usize) -> usize {
        self.count(limit, |surface, limit| {
            let size = if surface.emits {
                sizes.emitter_patch
            } else {
                sizes.patch
            };
            subdivide::count(surface.face.polygon(), sizes.size(), size, limit).cells
        })
    }

    /// Sum over all lit sides up to a limit, of numbers that are told the limit.
    fn count(&self, limit: usize, cells: impl Fn(&Surface, usize) -> usize + Sync) -> usize {
        // However the threads take turns, a sum below the limit is whole.
        let sum = AtomicUsize::new(0);
        self.all.par_iter().for_each(|surface| {
            let before = sum.load(Ordering::Relaxed);
            if surface.sides > 0 && before < limit {
                let cells = cells(surface, limit).min(limit);
                sum.fetch_add(surface.sides * cells, Ordering::Relaxed);
            }
        });
        sum.into_inner().min(limit)
    }

    /// About how many elements of a size there would be, however many that are.
    fn estimate(&self, size: f32) -> usize {
        let cells = |surface: &Surface| {
            surface.sides * subdivide::estimate(surface.face.polygon(), self.cut_to(size))
        };
        self.all.iter().map(cells).fold(0, usize::saturating_add)
    }

    /// The least number of patches or elements of which so many are asked for.
    fn least(&self, asked: usize) -> usize {
        self.sides + asked.min(self.sides / SHARE_ON_TOP)
    }

    /// The size of elements of which so many are wanted, if nothing cuts them.
    fn element_size(&self, wanted: usize) -> (f32, Option<Aim>) {
        self.element_size_of(wanted, wanted)
    }

    /// The size at which there are so many elements before anything cuts them, of all that are wanted.
    fn element_size_of(&self, wanted: usize, uncut: usize) -> (f32, Option<Aim>) {
        let least = self.least(wanted);
        let is_met = wanted > least;
        let uncut = if is_met { uncut } else { least };
        let size = self.size_for(uncut, self.longest * LEAST_SIZE, |size, limit| {
            self.elements(size, limit)
        });
        let size = self.with_few_fans(size, uncut);
        let uncut = self.elements(size, uncut.saturating_mul(2));
        (size, is_met.then_some(Aim { wanted, uncut }))
    }

    /// A size near one that gives nearly as many elements, and the fewest fans: where a number of elements falls between those
    /// of two grids, bisection ends at sizes at which opposite edges differ by a piece.
    fn with_few_fans(&self, size: f32, wanted: usize) -> f32 {
        if wanted > MOST_ELEMENTS_FOR_GRIDS {
            return size;
        }
        let limit = 2 * wanted;
        let cost = |size: f32| {
            let off = self.elements(size, limit).abs_diff(wanted) as f64 / wanted as f64;
            let is_near = off <= MOST_OFF_FOR_GRIDS;
            (
                if is_near {
                    self.fans(size, limit)
                } else {
                    usize::MAX
                },
                off,
            )
        };
        let tried = (-GRIDS_TRIED..=GRIDS_TRIED).map(|step| size * GRID_STEP.powi(step));
        let costs = tried.map(|size| (cost(size), size));
        let best = costs.min_by(|((fans, off), _), ((other_fans, other_off), _)| {
            fans.cmp(other_fans).then(off.total_cmp(other_off))
        });
        best.filter(|((fans, _), _)| *fans < usize::MAX)
            .map_or(size, |(_, best)| best)
    }

    /// Fans among the cells of elements of a size.
    fn fans(&self, size: f32, limit: usize) -> usize {
        let lit = self.all.par_iter().filter(|surface| surface.sides > 0);
        let of =
            |s: &Surface| subdivide::count(s.face.polygon(), self.cut_to(size), size, limit).fans;
        lit.map(of).sum()
    }

    /// Patches as they are asked for, above elements of a size.
    fn with_patches(&self, element: f32, aim: Option<Aim>, options: PatchOptions) -> Sizes {
        let sizes = |patch: f32| {
            let patch = patch.max(element);
            let finer = if self.are_emitters_small {
                FINER_EMITTERS
            } else {
                1.0
            };
            Sizes {
                element,
                patch,
                emitter_patch: (patch / finer).max(element),
                is_halving: self.is_halving,
                aim,
            }
        };
        match (options.patch_size, options.patches) {
            (Some(size), _) => sizes(size),
            (None, None) => sizes(PATCH_EDGE * element),
            (None, Some(asked)) => {
                let wanted = self.least(asked).max(asked);
                let count = |size: f32, limit: usize| self.patches(&sizes(size), limit);
                sizes(self.size_for(wanted, element, count))
            }
        }
    }

    /// The size from a least one on at which a number that falls with it is nearest to a wanted one, by bisection.
    fn size_for(&self, wanted: usize, least: f32, count: impl Fn(f32, usize) -> usize) -> f32 {
        let (mut low, mut high) = (least, self.longest.max(least) * 2.0);
        for _ in 0..BISECTIONS {
            let middle = (low * high).sqrt();
            if count(middle, wanted.saturating_add(1)) > wanted {
                low = middle;
            } else {
                high = middle;
            }
        }
        let sizes = [low / OFF_THE_STEP, high * OFF_THE_STEP];
        let [more, fewer] = sizes.map(|size| count(size, wanted.saturating_mul(2)));
        let is_more_nearer = more.abs_diff(wanted) < fewer.abs_diff(wanted);
        sizes[usize::from(!is_more_nearer)]
    }
}

/// Elements to aim at.
fn wanted_elements(options: PatchOptions) -> usize {
    let of_patches = |patches: usize| patches.saturating_mul(ELEMENTS_OF_PATCH);
    let elements = options.elements.or(options.patches.map(of_patches));
    elements.unwrap_or(DEFAULT_ELEMENTS)
}
