//! What samples see: the nearest surface that hides what is behind, and the layers of glass before it.

use crate::band::draw_band;
use crate::bins::Bins;
use crate::grid::Grid;
use crate::lens::Lens;
use crate::projection::keeps_lines;
use crate::stage::Stage;
use crate::trace::trace_band;
use hemicube_scene::Camera;

/// A point of a triangle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct SurfaceHit {
    /// Index into the stage's triangles, or one of the marks below.
    pub triangle: u32,
    /// Barycentric weights of the second and third corner, perspective-correct.
    pub weights: [f32; 2],
}

impl SurfaceHit {
    const NOTHING: u32 = u32::MAX;
    const OUTSIDE: u32 = u32::MAX - 1;

    /// No surface: what is behind everything shows.
    pub const EMPTY: Self = Self {
        triangle: Self::NOTHING,
        weights: [0.0; 2],
    };

    /// The projection has no direction there: outside of a fisheye's disc.
    pub const NO_DIRECTION: Self = Self {
        triangle: Self::OUTSIDE,
        weights: [0.0; 2],
    };

    /// Whether there is a surface.
    pub fn exists(&self) -> bool {
        self.triangle < Self::OUTSIDE
    }

    /// Whether there is a direction at all.
    pub fn is_inside(&self) -> bool {
        self.triangle != Self::OUTSIDE
    }
}

/// A transparent surface before the nearest opaque one of a sample.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Layer {
    pub sample: u32,
    /// Grows with the distance from the eye.
    pub depth: f32,
    pub hit: SurfaceHit,
}

/// What the samples of a band see, row by row from the band's first.
#[derive(Debug)]
pub(crate) struct Sights {
    hits: Vec<SurfaceHit>,
    /// Sorted by sample, then from far to near.
    layers: Vec<Layer>,
}

impl Sights {
    /// Hits of all samples, and layers in any order.
    pub fn new(hits: Vec<SurfaceHit>, mut layers: Vec<Layer>) -> Self {
        // The sort is stable: of equal depths the first drawn stays behind.
        layers.sort_by(|a, b| a.sample.cmp(&b.sample).then(b.depth.total_cmp(&a.depth)));
        Self { hits, layers }
    }

    /// The nearest surface that hides what is behind.
    pub fn hit(&self, sample: usize) -> &SurfaceHit {
        &self.hits[sample]
    }

    /// The transparent surfaces before it, from far to near.
    pub fn layers(&self, sample: usize) -> impl Iterator<Item = &SurfaceHit> {
        let start = self
            .layers
            .partition_point(|l| (l.sample as usize) < sample);
        let of_sample = move |l: &&Layer| l.sample as usize == sample;
        self.layers[start..]
            .iter()
            .take_while(of_sample)
            .map(|l| &l.hit)
    }
}

/// Finds what bands see: by drawing triangles where projection and pattern allow it, which is quicker, else by rays.
#[derive(Debug)]
pub(crate) struct SightFinder<'s> {
    stage: &'s Stage<'s>,
    grid: &'s Grid,
    lens: Lens,
    /// If triangles are drawn.
    bins: Option<Bins>,
    /// Instance that is not seen.
    without: Option<usize>,
}

impl<'s> SightFinder<'s> {
    /// For a camera that passed its door. Of an instance that is named nothing is seen.
    pub fn new(
        stage: &'s Stage<'s>,
        camera: &Camera,
        grid: &'s Grid,
        without: Option<usize>,
    ) -> Self {
        let draws = grid.is_regular && keeps_lines(camera.projection);
        Self {
            bins: draws.then(|| Bins::new(stage, camera, grid, without)),
            lens: Lens::new(camera, grid.width, grid.height),
            stage,
            grid,
            without,
        }
    }

    /// What a band sees.
    pub fn band(&self, band: usize) -> Sights {
        match &self.bins {
            Some(bins) => draw_band(self.stage, bins, band),
            None => trace_band(self.stage, &self.lens, self.grid, band, self.without),
        }
    }
}

/// A sample's number as layers keep it.
pub(crate) fn sample_number(sample: usize) -> u32 {
    u32::try_from(sample).expect("a band has fewer than 2^32 samples")
}
