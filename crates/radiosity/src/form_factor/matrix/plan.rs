//! How a matrix will be stored, decided before its rows are computed, so that what does not fit costs no time.

use super::fill::{Fill, Groups, estimate};
use super::{MatrixOptions, Storage};
use crate::error::RadiosityError;
use crate::form_factor::FormFactors;
use crate::form_factor::surfaces::Surfaces;
use crate::solve::system::fitting;

/// Share of non-zero entries below which a matrix is stored sparsely.
const SPARSE_BELOW: f64 = 0.25;
/// Dense matrices of surfaces up to this size are not worth a look at how many of their entries are zero, in bytes.
const SMALL: usize = 16 << 20;

/// What rows and columns stand for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Between {
    Patches,
    Surfaces,
}

/// How a matrix will be stored.
#[derive(Debug, Clone, Copy)]
pub(crate) struct MatrixPlan {
    between: Between,
    pub(super) n: usize,
    /// Matrices: one, or one for each band.
    pub(super) bands: usize,
    pub(super) is_sparse: bool,
    /// The estimate by which that was chosen.
    fill: Option<Fill>,
    limit: usize,
    bytes: usize,
}

impl MatrixPlan {
    /// Of the matrices between patches. Looks at a sample of the pairs where storage is to be chosen.
    ///
    /// # Errors
    /// More memory than the options allow.
    pub(crate) fn new(
        factors: &dyn FormFactors,
        options: MatrixOptions,
    ) -> Result<Self, RadiosityError> {
        let mesh = factors.mesh();
        let n = mesh.patches().len();
        let bands = if mesh.visibility().is_tinted() { 3 } else { 1 };
        let fill = || estimate(factors, &Groups::of_patches(mesh));
        Self::decide(Between::Patches, n, bands, options, fill)
    }

    /// Of the matrix between surfaces.
    ///
    /// # Errors
    /// More memory than the options allow.
    pub(super) fn of_surfaces(
        factors: &dyn FormFactors,
        surfaces: &Surfaces,
        mut options: MatrixOptions,
    ) -> Result<Self, RadiosityError> {
        let n = surfaces.len();
        let dense = n.saturating_mul(n).saturating_mul(4);
        if options.storage == Storage::Auto && dense <= SMALL.min(options.memory_limit) {
            options.storage = Storage::Dense;
        }
        let fill = || estimate(factors, &Groups::of_surfaces(factors.mesh(), surfaces));
        Self::decide(Between::Surfaces, n, 1, options, fill)
    }

    fn decide(
        between: Between,
        n: usize,
        bands: usize,
        options: MatrixOptions,
        fill: impl FnOnce() -> Fill,
    ) -> Result<Self, RadiosityError> {
        let dense = n.saturating_mul(n).saturating_mul(4 * bands);
        let fill = (options.storage != Storage::Dense).then(fill);
        let share = fill.map_or(1.0, |fill| fill.share);
        let is_sparse = match options.storage {
            Storage::Auto => share < SPARSE_BELOW,
            Storage::Dense => false,
            Storage::Sparse => true,
        };
        // A sparse entry takes a column besides its value.
        let bytes = if is_sparse {
            to_bytes(2.0 * dense as f64 * share)
        } else {
            dense
        };
        let plan = Self {
            between,
            n,
            bands,
            is_sparse,
            fill,
            limit: options.memory_limit,
            bytes,
        };
        plan.refuse(bytes)?;
        Ok(plan)
    }

    /// What all entries will take: exactly if all are kept, else about.
    pub(crate) fn bytes(&self) -> usize {
        self.bytes
    }

    /// Refuses more bytes than are allowed.
    pub(super) fn refuse(&self, bytes: usize) -> Result<(), RadiosityError> {
        if bytes <= self.limit {
            return Ok(());
        }
        let (n, needed, limit) = (self.n, (bytes >> 20) + 1, self.limit >> 20);
        let kept = self.kept();
        Err(RadiosityError::Option(match self.between {
            Between::Patches => format!(
                "the form factors between {n} patches take about {needed} MiB ({kept}), {limit} MiB are allowed; use \
                 at most {} patches, or a solver that shoots",
                fitting(n, bytes, self.limit)
            ),
            Between::Surfaces => format!(
                "the {n} x {n} form factors take about {needed} MiB ({kept}), {limit} MiB are free for them; sum them \
                 over objects, or leave faces out: about {} surfaces fit",
                fitting(n, bytes, self.limit)
            ),
        }))
    }

    /// Which entries are kept, and how that is known.
    fn kept(&self) -> String {
        let Some(Fill { share, pairs }) = self.fill else {
            return String::from("every entry is kept");
        };
        let what = if self.is_sparse {
            "of which zeros are left out"
        } else {
            "so every entry is kept"
        };
        let percent = 100.0 * share;
        format!("of {pairs} pairs that were tried {percent:.2} % see each other, {what}")
    }
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "an estimate; the cast saturates"
)]
fn to_bytes(bytes: f64) -> usize {
    bytes as usize
}
