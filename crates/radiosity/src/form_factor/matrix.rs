//! All form factors between patches at once: what matrix solvers and thermal engineers work with.

mod enclosure;
mod entries;
mod fill;
mod plan;
mod summed;

use crate::cast::to_f32;
pub use enclosure::{Change, SEAM};
pub use entries::Entries;
pub(crate) use plan::MatrixPlan;

use crate::error::RadiosityError;
use crate::form_factor::{FormFactors, Row, collect_rows};
use crate::patch::{NodeKind, PatchMesh};
use crate::stop::{NEVER, Stop};

/// Rows of a sparse matrix that are computed before the memory is looked at again.
const CHUNK: usize = 256;

/// How a matrix keeps its entries.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Storage {
    /// By the share of pairs that see each other in a sample.
    #[default]
    Auto,
    /// Every entry.
    Dense,
    /// Non-zero entries only (compressed rows).
    Sparse,
}

/// How a matrix is built.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct MatrixOptions {
    /// Most bytes that all entries may take. Default value: 2 GiB.
    pub memory_limit: usize,
    /// How entries are kept. Default value: sparse if less than a quarter of them is not zero.
    pub storage: Storage,
}

impl Default for MatrixOptions {
    fn default() -> Self {
        Self {
            memory_limit: 2 << 30,
            storage: Storage::Auto,
        }
    }
}

/// A difference of an entry from its mirror image, and where.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ReciprocityError {
    /// `|A_i F_ij - A_j F_ji| / min(A_i, A_j)`.
    pub error: f64,
    /// Row of the entry.
    pub row: usize,
    /// Column of the entry.
    pub column: usize,
}

/// Form factors between all patches in one band: entry (i, j) is the share of what leaves patch i that arrives at
/// patch j, the sum over its elements.
///
/// For each row, `Σ_j F_ij + sky + absorbed - transmitted = 1`: light that a pane lets through arrives at it and then
/// once more behind it.
#[derive(Debug, Clone, PartialEq)]
pub struct ViewFactorMatrix {
    entries: Entries,
    areas: Vec<f64>,
    names: Vec<String>,
    sky: Vec<f64>,
    absorbed: Vec<f64>,
    transmitted: Vec<f64>,
}

/// The rows of all patches, one after the other.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct DenseRows {
    /// `F_ij` between patches, `[row][column]`.
    pub values: Vec<f32>,
    /// Share of each row that meets no surface.
    pub sky: Vec<f64>,
    /// Share of each row that backs absorb.
    pub absorbed: Vec<f64>,
}

/// One row on its way into a matrix.
#[derive(Default)]
struct Collected {
    entries: Vec<(u32, f32)>,
    sky: f64,
    absorbed: f64,
    transmitted: f64,
}

impl ViewFactorMatrix {
    /// The factors between the patches of a mesh, one matrix, or three where tinted glass makes bands differ.
    ///
    /// # Errors
    /// More memory than the options allow, told before the rows are computed, by a sample of the pairs if zeros may be
    /// left out; also while they are computed, should the sample have been wrong.
    pub fn build(
        factors: &dyn FormFactors,
        options: MatrixOptions,
    ) -> Result<Vec<Self>, RadiosityError> {
        let plan = MatrixPlan::new(factors, options)?;
        let matrices = Self::build_as(factors, plan, NEVER)?;
        Ok(matrices.expect("nobody stops it"))
    }

    /// As [`Self::build`], of which the plan is made already; none if it was stopped.
    pub(crate) fn build_as(
        factors: &dyn FormFactors,
        plan: MatrixPlan,
        stop: Stop<'_>,
    ) -> Result<Option<Vec<Self>>, RadiosityError> {
        let mesh = factors.mesh().clone();
        let (n, bands, is_sparse) = (plan.n, plan.bands, plan.is_sparse);
        let areas: Vec<f64> = (0..n).map(|p| patch_area(&mesh, p)).collect();
        let names = patch_names(&mesh);
        if !is_sparse && let Some(rows) = factors.dense_rows(stop) {
            if stop() {
                return Ok(None);
            }
            return Ok(Some(vec![Self {
                entries: Entries::dense(n, rows.values),
                areas,
                names,
                sky: rows.sky,
                absorbed: rows.absorbed,
                transmitted: vec![0.0; n],
            }]));
        }
        let mut matrices: Vec<Self> = (0..bands)
            .map(|_| Self {
                entries: Entries::empty_sparse(n),
                areas: areas.clone(),
                names: names.clone(),
                sky: Vec::with_capacity(n),
                absorbed: Vec::with_capacity(n),
                transmitted: Vec::with_capacity(n),
            })
            .collect();
        if !is_sparse {
            for matrix in &mut matrices {
                matrix.entries = Entries::dense(n, vec![0.0; n * n]);
            }
        }
        let patches: Vec<usize> = (0..n).collect();
        for chunk in patches.chunks(CHUNK) {
            let rows: Vec<Vec<Collected>> = collect_rows(factors, chunk, stop, |_, row| {
                (0..bands).map(|band| collect(&mesh, row, band)).collect()
            });
            if stop() {
                return Ok(None);
            }
            for (&p, row) in chunk.iter().zip(&rows) {
                for (matrix, row) in matrices.iter_mut().zip(row) {
                    matrix.push(p, row);
                }
            }
            plan.refuse(matrices.iter().map(|m| m.entries.bytes()).sum())?;
        }
        Ok(Some(matrices))
    }

    fn push(&mut self, row: usize, collected: &Collected) {
        if self.entries.is_sparse {
            self.entries.push_row(&collected.entries);
        } else {
            for &(column, f) in &collected.entries {
                self.entries.values[row * self.entries.size + column as usize] = f;
            }
        }
        self.sky.push(collected.sky);
        self.absorbed.push(collected.absorbed);
        self.transmitted.push(collected.transmitted);
    }

    /// A matrix from its numbers, rows after one another; what is missing to 1 in a row is sky.
    ///
    /// # Errors
    /// Numbers of areas, names and factors that do not fit, areas that are not positive, factors that are not in
    /// [0, 1].
    pub fn from_rows(
        areas: Vec<f64>,
        names: Vec<String>,
        factors: &[f64],
    ) -> Result<Self, RadiosityError> {
        let n = areas.len();
        let fail = |message| Err(RadiosityError::Option(message));
        if names.len() != n || n.checked_mul(n) != Some(factors.len()) {
            let (m, k) = (names.len(), factors.len());
            return fail(format!(
                "{n} areas need {n} names and n x n factors, not {m} and {k}"
            ));
        }
        if let Some(i) = areas.iter().position(|a| !(a.is_finite() && *a > 0.0)) {
            return fail(format!("surface {i}: area {} is not positive", areas[i]));
        }
        if let Some(k) = factors.iter().position(|f| !(0.0..=1.0).contains(f)) {
            let (i, j) = (k / n, k % n);
            return fail(format!(
                "factor ({i}, {j}) is {}, not between 0 and 1",
                factors[k]
            ));
        }
        let sky = factors.chunks(n.max(1)).map(|row| {
            let open = 1.0 - row.iter().sum::<f64>();
            // Below the digits of f32 it is rounding, not a hole.
            if open > 1e-6 { open } else { 0.0 }
        });
        Ok(Self {
            sky: sky.collect(),
            absorbed: vec![0.0; n],
            transmitted: vec![0.0; n],
            entries: Entries::dense(n, factors.iter().map(|&f| to_f32(f)).collect()),
            areas,
            names,
        })
    }

    /// Patches.
    pub fn size(&self) -> usize {
        self.areas.len()
    }

    /// The factors.
    pub fn entries(&self) -> &Entries {
        &self.entries
    }

    /// The factors, taken out.
    pub(crate) fn into_entries(self) -> Entries {
        self.entries
    }

    /// Factor from patch i to patch j.
    pub fn get(&self, i: usize, j: usize) -> f32 {
        self.entries.get(i, j)
    }

    /// Area of each patch, in square scene units.
    pub fn areas(&self) -> &[f64] {
        &self.areas
    }

    /// Name of each patch: the node of the scene that it is of, and its number within that.
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// Share of each row that meets no surface.
    pub fn sky(&self) -> &[f64] {
        &self.sky
    }

    /// Share of each row that backs absorb.
    pub fn absorbed(&self) -> &[f64] {
        &self.absorbed
    }

    /// Share of each row that arrives at panes and is let through.
    pub fn transmitted(&self) -> &[f64] {
        &self.transmitted
    }

    /// What should be 1: factors, sky and absorbed, less what counts twice because a pane let it through.
    pub fn row_sum(&self, i: usize) -> f64 {
        let received: f64 = self.entries.row(i).map(|(_, f)| f64::from(f)).sum();
        received + self.sky[i] + self.absorbed[i] - self.transmitted[i]
    }

    /// The largest `|1 - row sum|`.
    pub fn closure_error(&self) -> f64 {
        let errors = (0..self.size()).map(|i| (1.0 - self.row_sum(i)).abs());
        errors.fold(0.0, f64::max)
    }

    /// The largest `|A_i F_ij - A_j F_ji| / min(A_i, A_j)` and where it is.
    pub fn reciprocity_error(&self) -> ReciprocityError {
        let mut worst = ReciprocityError {
            error: 0.0,
            row: 0,
            column: 0,
        };
        for i in 0..self.size() {
            for (j, f) in self.entries.row(i) {
                let back = self.areas[j] * f64::from(self.entries.get(j, i));
                let difference = (self.areas[i] * f64::from(f) - back).abs();
                let error = ratio(difference, self.areas[i].min(self.areas[j]));
                if error > worst.error {
                    worst = ReciprocityError {
                        error,
                        row: i,
                        column: j,
                    };
                }
            }
        }
        worst
    }

    /// Checks `0 <= F_ij <= 1` and `A_i F_ij <= min(A_i, A_j)`, both up to a tolerance.
    ///
    /// # Errors
    /// The first entry that breaks one of them, by names and numbers.
    pub fn check(&self, tolerance: f64) -> Result<(), RadiosityError> {
        let name = |i: usize| &self.names[i];
        for i in 0..self.size() {
            for (j, f) in self.entries.row(i) {
                let f = f64::from(f);
                if !(-tolerance..=1.0 + tolerance).contains(&f) {
                    return Err(RadiosityError::Option(format!(
                        "form factor from '{}' to '{}' is {f}, not between 0 and 1",
                        name(i),
                        name(j)
                    )));
                }
                let (most, exchange) = (self.areas[i].min(self.areas[j]), self.areas[i] * f);
                if exchange > most * (1.0 + tolerance) {
                    return Err(RadiosityError::Option(format!(
                        "form factor {f} from '{}' to '{}' exchanges {exchange} with areas {} and {}, at most {most}",
                        name(i),
                        name(j),
                        self.areas[i],
                        self.areas[j]
                    )));
                }
            }
        }
        Ok(())
    }
}

/// Area of the exposed elements of a patch.
pub(crate) fn patch_area(mesh: &PatchMesh, patch: usize) -> f64 {
    let elements = mesh.elements_of_patch(patch);
    elements.map(|e| f64::from(mesh.exposed_area(e))).sum()
}

fn patch_names(mesh: &PatchMesh) -> Vec<String> {
    let instances = &mesh.scene().instances;
    let mut counts = vec![0_usize; instances.len()];
    let name = |id| {
        let instance = match mesh.node(id).kind {
            NodeKind::Cluster { instance } => instance,
            NodeKind::Surface { face, .. } => mesh.faces()[face as usize].instance,
        } as usize;
        counts[instance] += 1;
        format!("{} {}", instances[instance].node, counts[instance])
    };
    mesh.patches().iter().copied().map(name).collect()
}

/// Sums a row over the elements of each patch.
fn collect(mesh: &PatchMesh, row: &Row, band: usize) -> Collected {
    let mut collected = Collected {
        sky: f64::from(row.escaped[band]),
        absorbed: f64::from(row.absorbed[band]),
        ..Collected::default()
    };
    // Receivers ascend and a patch's elements are consecutive, so each patch comes up once.
    let mut last: Option<(usize, f64)> = None;
    let transmittance = mesh.transmittance();
    for (&e, &f) in row.receivers.iter().zip(row.band(band)) {
        let e = e as usize;
        let f = f64::from(f);
        collected.transmitted += f * f64::from(transmittance[e][band]);
        let patch = mesh.patch_of_element(e);
        match &mut last {
            Some((open, sum)) if *open == patch => *sum += f,
            _ => {
                let done = last.replace((patch, f));
                collected.entries.extend(done.and_then(entry));
            }
        }
    }
    collected.entries.extend(last.and_then(entry));
    collected
}

fn entry((patch, sum): (usize, f64)) -> Option<(u32, f32)> {
    (sum != 0.0).then(|| (crate::index32(patch), to_f32(sum)))
}
/// `a / b`, 0 where there is nothing to divide by (patches without an exposed point).
fn ratio(a: f64, b: f64) -> f64 {
    if b > 0.0 { a / b } else { 0.0 }
}
#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn impossible_factors_are_refused_by_name() {
        let two = |areas: Vec<f64>, factors: [f64; 4]| {
            ViewFactorMatrix::from_rows(areas, vec!["a".into(), "b".into()], &factors)
        };
        let message = |result: Result<ViewFactorMatrix, RadiosityError>| {
            result.expect_err("it is refused").to_string()
        };
        let nan = message(two(vec![1.0, 1.0], [0.0, f64::NAN, 0.1, 0.0]));
        assert!(nan.contains("(0, 1) is NaN"), "{nan}");
        let flat = message(two(vec![1.0, 0.0], [0.0; 4]));
        assert!(flat.contains("surface 1: area 0"), "{flat}");
        let large = two(vec![2.0, 1.0], [0.0, 0.8, 0.5, 0.0]).expect("each is a factor");
        let large = large
            .check(1e-6)
            .expect_err("1.6 m² cannot be seen of 1 m²");
        assert!(
            large.to_string().contains("from 'a' to 'b'"),
            "the message names both: {large}"
        );
    }
}
