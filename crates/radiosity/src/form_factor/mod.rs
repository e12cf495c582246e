//! Form factors: which share of the light that leaves one node arrives where.

pub mod analytic;
mod arrivals;
pub mod cached;
pub mod delta_factors;
pub mod estimate;
pub mod hemicube;
pub mod hemisphere;
pub mod kind;
pub mod matrix;
mod nearby;
pub mod nusselt;
pub mod nusselt_rows;
pub mod polygon;
pub mod raycast;
pub mod surfaces;
mod viewpoints;

pub use analytic::{Analytic, AnalyticOptions};
pub use cached::Cached;
pub use estimate::{Estimate, EstimatedRow, Sampler, Sampling};
pub use hemisphere::{Hemisphere, HemisphereOptions};
pub use kind::{FormFactorKind, FormFactorOptions};
pub use matrix::{MatrixOptions, Storage, ViewFactorMatrix};
pub use nusselt_rows::{Nusselt, NusseltOptions};
pub use raycast::{RayCast, RayCastOptions};
pub use surfaces::{Overlap, Surfaces, SurfacesBy};

use crate::patch::{NodeId, PatchMesh};
use crate::stop::Stop;
use rayon::prelude::*;
use std::sync::Arc;

/// One row of form factors: everything that leaves a node, accounted for.
///
/// For each band, `Σ_e fractions_e (1 - transmittance_e) + absorbed + escaped = 1`: what arrives at an element and is
/// not let through, what backs of one-sided surfaces absorb, and what meets nothing.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Row {
    /// 1 if the factors hold for all bands, 3 if glass makes them differ.
    pub bands: usize,
    /// Elements that receive something, by their position in [`PatchMesh::elements`], ascending.
    pub receivers: Vec<u32>,
    /// Form factors `F_Pe` to the receivers, `[band][receiver]`.
    pub fractions: Vec<f32>,
    /// Share that arrives at backs which do not receive, per band.
    pub absorbed: [f32; 3],
    /// Share that meets no surface, per band.
    pub escaped: [f32; 3],
}

impl Row {
    /// The factors of one band.
    pub fn band(&self, band: usize) -> &[f32] {
        let n = self.receivers.len();
        let band = if self.bands == 1 { 0 } else { band };
        &self.fractions[band * n..(band + 1) * n]
    }

    /// Empties the row for another number of bands.
    pub fn clear(&mut self, bands: usize) {
        self.bands = bands;
        self.receivers.clear();
        self.fractions.clear();
        self.absorbed = [0.0; 3];
        self.escaped = [0.0; 3];
    }

    /// The left side of the sum that should be 1, in one band.
    pub fn sum(&self, mesh: &PatchMesh, band: usize) -> f64 {
        let received: f64 = self
            .receivers
            .iter()
            .zip(self.band(band))
            .map(|(&e, &f)| f64::from(f) * f64::from(1.0 - mesh.transmittance()[e as usize][band]))
            .sum();
        received + f64::from(self.absorbed[band]) + f64::from(self.escaped[band])
    }

    /// Bytes that it takes.
    pub fn bytes(&self) -> usize {
        size_of::<Self>() + 4 * (self.receivers.len() + self.fractions.len())
    }
}

/// A way to form factors: one verb.
pub trait FormFactors: Send + Sync {
    /// The mesh between whose nodes the factors are.
    fn mesh(&self) -> &Arc<PatchMesh>;

    /// Fills the row of one node: the shares of what leaves it that arrive at each element.
    ///
    /// The same node always gives the same row, bit for bit, on any number of threads.
    fn fill_row(&self, source: NodeId, row: &mut Row);

    /// Fills the rows of several nodes, each as [`Self::fill_row`] would.
    ///
    /// # Panics
    /// There are not as many rows as nodes.
    fn fill_rows(&self, sources: &[NodeId], rows: &mut [Row]) {
        assert_eq!(sources.len(), rows.len(), "a row for each node");
        sources
            .par_iter()
            .zip(rows)
            .for_each(|(&source, row)| self.fill_row(source, row));
    }

    /// How many rows [`Self::fill_rows`] should be asked for at once. Methods that work on each row with all threads, or
    /// on one row a thread, say 1.
    fn rows_at_once(&self) -> usize {
        1
    }

    /// The rows of all patches at once, where a method has a cheaper way to them than one after the other.
    ///
    /// Rows are not scaled: what they lack to 1 is the method's error. `stop` is asked about once for each row; after
    /// it has said so, the rest stays empty.
    fn dense_rows(&self, stop: Stop<'_>) -> Option<matrix::DenseRows> {
        let _ = stop;
        None
    }

    /// Most elements that the row of a node can reach: ways that follow rays reach no more than they have rays, those
    /// that ask for each pair all that are in sight.
    fn most_receivers(&self, source: NodeId) -> usize {
        let _ = source;
        usize::MAX
    }

    /// Pairs whose visibility had to be sampled so far, by methods that need not sample as a rule.
    fn sampled_pairs(&self) -> u64 {
        0
    }

    /// Rays cast so far, where rays are cast.
    fn rays(&self) -> u64 {
        0
    }
}

impl<F: FormFactors + ?Sized> FormFactors for Box<F> {
    fn mesh(&self) -> &Arc<PatchMesh> {
        (**self).mesh()
    }

    fn fill_row(&self, source: NodeId, row: &mut Row) {
        (**self).fill_row(source, row);
    }

    fn fill_rows(&self, sources: &[NodeId], rows: &mut [Row]) {
        (**self).fill_rows(sources, rows);
    }

    fn rows_at_once(&self) -> usize {
        (**self).rows_at_once()
    }

    fn dense_rows(&self, stop: Stop<'_>) -> Option<matrix::DenseRows> {
        (**self).dense_rows(stop)
    }

    fn most_receivers(&self, source: NodeId) -> usize {
        (**self).most_receivers(source)
    }

    fn sampled_pairs(&self) -> u64 {
        (**self).sampled_pairs()
    }

    fn rays(&self) -> u64 {
        (**self).rays()
    }
}

/// What `collect` makes of the rows of some patches, given by their positions, in their order. `stop` is asked about once
/// for each row; after it has said so, rows are empty.
pub(crate) fn collect_rows<T: Send>(
    factors: &dyn FormFactors,
    patches: &[usize],
    stop: Stop<'_>,
    collect: impl Fn(usize, &mut Row) -> T + Sync,
) -> Vec<T> {
    let mesh = factors.mesh();
    let at_once = factors.rows_at_once();
    if at_once <= 1 {
        let filled = |row: &mut Row, &p: &usize| {
            row.clear(1);
            if !stop() {
                factors.fill_row(mesh.patches()[p], row);
            }
            collect(p, row)
        };
        return patches.par_iter().map_init(Row::default, filled).collect();
    }
    let mut rows = vec![Row::default(); at_once];
    let mut collected = Vec::with_capacity(patches.len());
    for patches in patches.chunks(at_once) {
        let rows = &mut rows[..patches.len()];
        rows.iter_mut().for_each(|row| row.clear(1));
        if !stop() {
            let sources: Vec<NodeId> = patches.iter().map(|&p| mesh.patches()[p]).collect();
            factors.fill_rows(&sources, rows);
        }
        let jobs: Vec<_> = patches.iter().zip(rows).collect();
        collected.par_extend(jobs.into_par_iter().map(|(&p, row)| collect(p, row)));
    }
    collected
}
