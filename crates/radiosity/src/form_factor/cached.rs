//! Rows kept in memory for solvers that ask for them again.

use crate::form_factor::matrix::DenseRows;
use crate::form_factor::{FormFactors, Row};
use crate::patch::{NodeId, PatchMesh};
use crate::stop::Stop;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, OnceLock};

/// Keeps the rows of another method as long as they fit a budget.
#[derive(Debug)]
pub struct Cached<F> {
    inner: F,
    /// One for each patch; other nodes' rows are not kept.
    rows: Vec<OnceLock<Row>>,
    budget: usize,
    used: AtomicUsize,
}

impl<F: FormFactors> Cached<F> {
    /// Keeps at most `budget` bytes of rows.
    pub fn new(inner: F, budget: usize) -> Self {
        let mut rows = Vec::new();
        rows.resize_with(inner.mesh().patches().len(), OnceLock::new);
        Self {
            inner,
            rows,
            budget,
            used: AtomicUsize::new(0),
        }
    }

    /// Keeps a row if the budget allows.
    fn keep(&self, slot: &OnceLock<Row>, row: &Row) {
        let bytes = row.bytes();
        if self.used.fetch_add(bytes, Ordering::Relaxed) + bytes <= self.budget {
            slot.get_or_init(|| row.clone());
        } else {
            self.used.fetch_sub(bytes, Ordering::Relaxed);
        }
    }
}

impl<F: FormFactors> FormFactors for Cached<F> {
    fn mesh(&self) -> &Arc<PatchMesh> {
        self.inner.mesh()
    }

    fn fill_row(&self, source: NodeId, row: &mut Row) {
        let patch = self.inner.mesh().patch_of_node(source);
        let Some(slot) = patch.map(|patch| &self.rows[patch]) else {
            return self.inner.fill_row(source, row);
        };
        if let Some(kept) = slot.get() {
            row.clone_from(kept);
            return;
        }
        self.inner.fill_row(source, row);
        self.keep(slot, row);
    }

    fn fill_rows(&self, sources: &[NodeId], rows: &mut [Row]) {
        let slot = |source| Some(&self.rows[self.inner.mesh().patch_of_node(source)?]);
        let mut missing = Vec::new();
        for (i, (&source, row)) in sources.iter().zip(&mut *rows).enumerate() {
            match slot(source).and_then(OnceLock::get) {
                Some(kept) => row.clone_from(kept),
                None => missing.push(i),
            }
        }
        let wanted: Vec<NodeId> = missing.iter().map(|&i| sources[i]).collect();
        let mut found: Vec<Row> = missing
            .iter()
            .map(|&i| core::mem::take(&mut rows[i]))
            .collect();
        self.inner.fill_rows(&wanted, &mut found);
        for (i, row) in missing.into_iter().zip(found) {
            if let Some(slot) = slot(sources[i]) {
                self.keep(slot, &row);
            }
            rows[i] = row;
        }
    }

    fn rows_at_once(&self) -> usize {
        self.inner.rows_at_once()
    }

    fn dense_rows(&self, stop: Stop<'_>) -> Option<DenseRows> {
        self.inner.dense_rows(stop)
    }

    fn most_receivers(&self, source: NodeId) -> usize {
        self.inner.most_receivers(source)
    }

    fn sampled_pairs(&self) -> u64 {
        self.inner.sampled_pairs()
    }

    fn rays(&self) -> u64 {
        self.inner.rays()
    }
}
