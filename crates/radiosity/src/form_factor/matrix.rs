//! All form factors between patches at once: what matrix solvers and thermal engineers work with.

mod summed;

use crate::error::RadiosityError;
use crate::form_factor::{FormFactors, Row};
use crate::patch::{NodeKind, PatchMesh};
use crate::solve::system::fitting;
use crate::stop::{NEVER, Stop};
use rayon::prelude::*;

/// Share of non-zero entries below which a matrix is stored sparsely.
const SPARSE_BELOW: f64 = 0.25;
/// Rows computed ahead to learn how many entries are zero.
const SAMPLED_ROWS: usize = 16;
/// Rows of a sparse matrix that are computed before the memory is looked at again.
const CHUNK: usize = 256;

/// How a matrix keeps its entries.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Storage {
    /// By the share of zeros in some rows computed ahead.
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

/// A square matrix in f32, dense or sparse.
#[derive(Debug, Clone, PartialEq)]
pub struct Entries {
    size: usize,
    /// Where each row starts in `columns` and `values`; empty if dense.
    starts: Vec<usize>,
    columns: Vec<u32>,
    values: Vec<f32>,
    is_sparse: bool,
}

impl Entries {
    fn dense(size: usize, values: Vec<f32>) -> Self {
        Self {
            size,
            starts: Vec::new(),
            columns: Vec::new(),
            values,
            is_sparse: false,
        }
    }

    fn empty_sparse(size: usize) -> Self {
        Self {
            size,
            starts: vec![0],
            columns: Vec::new(),
            values: Vec::new(),
            is_sparse: true,
        }
    }

    fn push_row(&mut self, row: &[(u32, f32)]) {
        self.columns.extend(row.iter().map(|&(column, _)| column));
        self.values.extend(row.iter().map(|&(_, value)| value));
        self.starts.push(self.values.len());
    }

    /// Rows, which are as many as columns.
    pub fn size(&self) -> usize {
        self.size
    }

    /// Whether zeros are left out.
    pub fn is_sparse(&self) -> bool {
        self.is_sparse
    }

    /// Bytes that the entries take.
    pub fn bytes(&self) -> usize {
        4 * (self.values.len() + self.columns.len()) + size_of::<usize>() * self.starts.len()
    }

    /// Column and value of the kept entries of a row, columns ascending.
    pub fn row(&self, row: usize) -> impl Iterator<Item = (usize, f32)> + '_ {
        let range = if self.is_sparse {
            self.starts[row]..self.starts[row + 1]
        } else {
            row * self.size..(row + 1) * self.size
        };
        let columns = self.is_sparse.then(|| &self.columns[range.clone()]);
        let values = self.values[range].iter().enumerate();
        values.map(move |(k, &value)| (columns.map_or(k, |columns| columns[k] as usize), value))
    }

    /// One entry.
    pub fn get(&self, row: usize, column: usize) -> f32 {
        if !self.is_sparse {
            return self.values[row * self.size + column];
        }
        let range = self.starts[row]..self.starts[row + 1];
        let found = self.columns[range.clone()].binary_search_by(|&c| (c as usize).cmp(&column));
        found.map_or(0.0, |k| self.values[range.start + k])
    }

    /// Product of a row with a vector.
    pub fn dot(&self, row: usize, vector: &[f64]) -> f64 {
        self.dots(row, [vector])[0]
    }

    /// Products of a row with several vectors, in one pass over the row; each is the same as alone, bit for bit.
    pub fn dots<const K: usize>(&self, row: usize, vectors: [&[f64]; K]) -> [f64; K] {
        if self.is_sparse {
            let mut sums = [0.0; K];
            for (j, f) in self.row(row) {
                for (sum, vector) in sums.iter_mut().zip(vectors) {
                    *sum += f64::from(f) * vector[j];
                }
            }
            return sums;
        }
        // Eight sums at once: one alone waits for each addition before it starts the next.
        const LANES: usize = 8;
        let values = &self.values[row * self.size..(row + 1) * self.size];
        let (values, last_values) = values.as_chunks::<LANES>();
        let vectors = vectors.map(|vector| vector[..self.size].as_chunks::<LANES>());
        let mut sums = [[0.0; LANES]; K];
        for (block, f) in values.iter().enumerate() {
            for (sums, (vector, _)) in sums.iter_mut().zip(&vectors) {
                let x = &vector[block];
                for lane in 0..LANES {
                    sums[lane] += f64::from(f[lane]) * x[lane];
                }
            }
        }
        core::array::from_fn(|k| {
            let rest = last_values.iter().zip(vectors[k].1);
            sums[k].iter().sum::<f64>() + rest.map(|(&f, x)| f64::from(f) * x).sum::<f64>()
        })
    }

    /// Each entry after `change(row, column, entry)`.
    fn map(&self, change: impl Fn(usize, usize, f32) -> f32 + Sync) -> Self {
        let mut mapped = self.clone();
        mapped.change(change);
        mapped
    }

    /// Each entry becomes `change(row, column, entry)`.
    fn change(&mut self, change: impl Fn(usize, usize, f32) -> f32 + Sync) {
        if self.is_sparse {
            for row in 0..self.size {
                for k in self.starts[row]..self.starts[row + 1] {
                    self.values[k] = change(row, self.columns[k] as usize, self.values[k]);
                }
            }
            return;
        }
        let rows = self.values.par_chunks_mut(self.size.max(1)).enumerate();
        rows.for_each(|(row, values)| {
            for (column, value) in values.iter_mut().enumerate() {
                *value = change(row, column, *value);
            }
        });
    }

    /// Rows and columns exchanged.
    pub fn transposed(&self) -> Self {
        let n = self.size;
        if !self.is_sparse {
            let mut values = vec![0.0; n * n];
            let rows = values.par_chunks_mut(n.max(1)).enumerate();
            rows.for_each(|(row, values)| {
                for (column, value) in values.iter_mut().enumerate() {
                    *value = self.values[column * n + row];
                }
            });
            return Self::dense(n, values);
        }
        let mut starts = vec![0; n + 1];
        for &column in &self.columns {
            starts[column as usize + 1] += 1;
        }
        for i in 0..n {
            starts[i + 1] += starts[i];
        }
        let mut next = starts.clone();
        let mut columns = vec![0; self.columns.len()];
        let mut values = vec![0.0; self.values.len()];
        for row in 0..n {
            for k in self.starts[row]..self.starts[row + 1] {
                let to = &mut next[self.columns[k] as usize];
                columns[*to] = crate::index32(row);
                values[*to] = self.values[k];
                *to += 1;
            }
        }
        Self {
            size: n,
            starts,
            columns,
            values,
            is_sparse: true,
        }
    }

    /// The same exchange seen by the receivers: entry (j, i) is `F_ij A_i / A_j`. Equal to itself where reciprocity
    /// is exact; where it is not, gathering by these rows conserves energy, gathering by the original ones does not.
    pub fn reciprocal(&self, areas: &[f64]) -> Self {
        let mut mirrored = self.transposed();
        mirrored.change(|j, i, f| to_f32(ratio(f64::from(f) * areas[i], areas[j])));
        mirrored
    }

    /// [`Self::reciprocal`] in the same memory, where that can be.
    pub(crate) fn into_reciprocal(mut self, areas: &[f64]) -> Self {
        /// Rows and columns that are exchanged together, so that both stay in the cache.
        const TILE: usize = 32;
        if self.is_sparse {
            return self.reciprocal(areas);
        }
        let n = self.size;
        let mirror =
            |f: f32, from: usize, to: usize| to_f32(ratio(f64::from(f) * areas[from], areas[to]));
        for (top, left) in (0..n)
            .step_by(TILE)
            .flat_map(|top| (top..n).step_by(TILE).map(move |left| (top, left)))
        {
            for i in top..(top + TILE).min(n) {
                for j in left.max(i)..(left + TILE).min(n) {
                    let (there, back) = (self.values[i * n + j], self.values[j * n + i]);
                    self.values[j * n + i] = mirror(there, i, j);
                    self.values[i * n + j] = mirror(back, j, i);
                }
            }
        }
        self
    }

    /// The mean of the exchange as both sides have it. Rows of patches without an exposed point stay as they are:
    /// they exchange nothing.
    fn symmetrised(&self, areas: &[f64]) -> Self {
        let mirrored = self.reciprocal(areas);
        let weight = |i: usize, j: usize| match (areas[i] > 0.0, areas[j] > 0.0) {
            (true, true) => 0.5,
            (true, false) => 0.0,
            (false, _) => 1.0,
        };
        if !self.is_sparse {
            return self.map(|i, j, f| weight(i, j) * f + 0.5 * mirrored.get(i, j));
        }
        let mut mean = Self::empty_sparse(self.size);
        let mut merged: Vec<(u32, f32)> = Vec::new();
        for i in 0..self.size {
            let own = self.row(i).map(|(j, f)| (j, weight(i, j) * f));
            let other = mirrored.row(i).map(|(j, f)| (j, 0.5 * f));
            merged.clear();
            merged.extend(own.chain(other).map(|(j, f)| (crate::index32(j), f)));
            merged.sort_by_key(|&(j, _)| j);
            merged.dedup_by(|later, kept| {
                let same = later.0 == kept.0;
                if same {
                    kept.1 += later.1;
                }
                same
            });
            mean.push_row(&merged);
        }
        mean
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
    /// More memory than the options allow, told before the rows are computed (by a sample of them, if sparse).
    pub fn build(
        factors: &dyn FormFactors,
        options: MatrixOptions,
    ) -> Result<Vec<Self>, RadiosityError> {
        let plan = MatrixPlan::new(factors, options)?;
        let matrices = Self::build_as(factors, plan, options, NEVER)?;
        Ok(matrices.expect("nobody stops it"))
    }

    /// As [`Self::build`], of which the plan is made already; none if it was stopped.
    pub(crate) fn build_as(
        factors: &dyn FormFactors,
        plan: MatrixPlan,
        options: MatrixOptions,
        stop: Stop<'_>,
    ) -> Result<Option<Vec<Self>>, RadiosityError> {
        let mesh = factors.mesh().clone();
        let MatrixPlan {
            n,
            bands,
            is_sparse,
            ..
        } = plan;
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
            let rows: Vec<Vec<Collected>> = chunk
                .par_iter()
                .map_init(Row::default, |row, &p| {
                    if !stop() {
                        factors.fill_row(mesh.patches()[p], row);
                    }
                    (0..bands).map(|band| collect(&mesh, row, band)).collect()
                })
                .collect();
            if stop() {
                return Ok(None);
            }
            for (&p, row) in chunk.iter().zip(&rows) {
                for (matrix, row) in matrices.iter_mut().zip(row) {
                    matrix.push(p, row);
                }
            }
            let bytes: usize = matrices.iter().map(|m| m.entries.bytes()).sum();
            if bytes > options.memory_limit {
                return Err(too_large(n, bytes, options.memory_limit));
            }
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

    /// The nearest factors that obey both closure and reciprocity.
    ///
    /// Works on exchange areas `X_ij = A_i F_ij`, first made symmetric by the mean of both sides, then changed by the
    /// least weighted squares `Σ ΔX_ij² / X_ij` such that all rows close (after Larsen and Howell 1986; the weights are
    /// those of sampled factors, whose variance grows with the factor). With multipliers λ of the rows that is
    /// `X_ij (1 + λ_i + λ_j)`, for the sky `S_i (1 + λ_i)`: zeros stay zero, an open share stays in the sky column.
    /// What became negative is set to zero and all of it repeated. Absorbed and transmitted shares are kept.
    ///
    /// Some enclosures have no such factors (two plates of different size and nothing else): the result is then
    /// reciprocal and as near to closed as the iteration came; `closure_error` tells. It takes the memory of three
    /// matrices while it works.
    pub fn enclosure_corrected(&self) -> Self {
        const ROUNDS: usize = 30;
        let mut corrected = self.clone();
        corrected.entries = self.entries.symmetrised(&self.areas);
        let mut best = corrected.clone();
        for _ in 0..ROUNDS {
            let lambda = corrected.multipliers();
            corrected.entries = corrected.entries.map(|i, j, f| {
                if self.areas[i] > 0.0 {
                    to_f32((f64::from(f) * (1.0 + lambda[i] + lambda[j])).max(0.0))
                } else {
                    f
                }
            });
            for (sky, lambda) in corrected.sky.iter_mut().zip(&lambda) {
                *sky = (*sky * (1.0 + lambda)).max(0.0);
            }
            let (error, least) = (corrected.closure_error(), best.closure_error());
            if error.is_nan() || error >= least {
                break;
            }
            best = corrected.clone();
            // Beyond it only the rounding of f32 is left.
            if error < 1e-7 {
                break;
            }
        }
        best
    }

    /// Solves `(Σ_j X_ij + S_i) λ_i + Σ_j X_ij λ_j = A_i (1 - row sum)` by conjugate gradients, preconditioned by
    /// the diagonal; only semi-definite where two groups of patches see nothing but each other, which is no harm.
    fn multipliers(&self) -> Vec<f64> {
        let n = self.size();
        let diagonal: Vec<f64> = (0..n)
            .map(|i| {
                let row: f64 = self.entries.row(i).map(|(_, f)| f64::from(f)).sum();
                self.areas[i] * (row + self.sky[i])
            })
            .collect();
        let apply = |x: &[f64]| -> Vec<f64> {
            let row = |i: usize| diagonal[i] * x[i] + self.areas[i] * self.entries.dot(i, x);
            (0..n).into_par_iter().map(row).collect()
        };
        let precondition = |r: &[f64]| -> Vec<f64> {
            r.iter()
                .zip(&diagonal)
                .map(|(&r, &d)| ratio(r, d))
                .collect()
        };
        let mut x = vec![0.0; n];
        let mut r: Vec<f64> = (0..n)
            .map(|i| self.areas[i] * (1.0 - self.row_sum(i)))
            .collect();
        let mut z = precondition(&r);
        let mut direction = z.clone();
        let mut rz = dot(&r, &z);
        let enough = rz * 1e-24;
        for _ in 0..(2 * n).max(10) {
            let image = apply(&direction);
            let curvature = dot(&direction, &image);
            if rz <= enough || curvature <= 0.0 {
                break;
            }
            let step = rz / curvature;
            for i in 0..n {
                x[i] += step * direction[i];
                r[i] -= step * image[i];
            }
            z = precondition(&r);
            let next = dot(&r, &z);
            let keep = next / rz;
            rz = next;
            for i in 0..n {
                direction[i] = z[i] + keep * direction[i];
            }
        }
        x
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

/// How a matrix will be stored, decided before its rows are computed.
#[derive(Debug, Clone, Copy)]
pub(crate) struct MatrixPlan {
    n: usize,
    /// Matrices: one, or one for each band.
    bands: usize,
    is_sparse: bool,
    bytes: usize,
}

impl MatrixPlan {
    /// Looks at a sample of the rows where storage is to be chosen.
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
        let dense = n.saturating_mul(n).saturating_mul(4 * bands);
        let share = if options.storage == Storage::Dense {
            1.0
        } else {
            sampled_share(factors, n)
        };
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
        if bytes > options.memory_limit {
            return Err(too_large(n, bytes, options.memory_limit));
        }
        Ok(Self {
            n,
            bands,
            is_sparse,
            bytes,
        })
    }

    /// What all entries will take, about.
    pub(crate) fn bytes(&self) -> usize {
        self.bytes
    }
}

/// Share of entries that are not zero in some rows, evenly picked.
fn sampled_share(factors: &dyn FormFactors, n: usize) -> f64 {
    let mesh = factors.mesh();
    let rows = n.min(SAMPLED_ROWS);
    let counts: Vec<usize> = (0..rows)
        .into_par_iter()
        .map_init(Row::default, |row, k| {
            factors.fill_row(mesh.patches()[k * n / rows], row);
            collect(mesh, row, 0).entries.len()
        })
        .collect();
    ratio(counts.iter().sum::<usize>() as f64, (rows * n) as f64)
}

fn too_large(n: usize, bytes: usize, limit: usize) -> RadiosityError {
    let mib = |bytes: usize| (bytes >> 20) + 1;
    RadiosityError::Option(format!(
        "the form factors between {n} patches take about {} MiB, {} MiB are allowed; use at most {} patches, or a \
         solver that shoots",
        mib(bytes),
        limit >> 20,
        fitting(n, bytes, limit)
    ))
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "an estimate; the cast saturates"
)]
fn to_bytes(bytes: f64) -> usize {
    bytes as usize
}

/// `a / b`, 0 where there is nothing to divide by (patches without an exposed point).
fn ratio(a: f64, b: f64) -> f64 {
    if b > 0.0 { a / b } else { 0.0 }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[expect(clippy::cast_possible_truncation, reason = "factors are kept in f32")]
fn to_f32(x: f64) -> f32 {
    x as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A cube with each entry off by up to 5 %, in a fixed pattern.
    fn noisy_cube(open: f64) -> ViewFactorMatrix {
        let exact = |i: usize, j: usize| match (i, j) {
            _ if i == j => 0.0,
            _ if i / 2 == j / 2 => 0.199_824_895_7,
            _ => 0.200_043_776_1,
        };
        let noise = |k: usize| 1.0 + 0.05 * ((k * 7919 % 101) as f64 / 50.5 - 1.0);
        let factors: Vec<f64> = (0..36)
            .map(|k| exact(k / 6, k % 6) * noise(k) * (1.0 - open))
            .collect();
        let names = (0..6).map(|i| format!("face {i}")).collect();
        let mut matrix =
            ViewFactorMatrix::from_rows(vec![1.0; 6], names, &factors).expect("a matrix");
        matrix.sky = vec![open; 6];
        matrix
    }

    #[test]
    fn correction_closes_noisy_matrices_and_keeps_reciprocity() {
        for open in [0.0, 0.3] {
            let noisy = noisy_cube(open);
            assert!(noisy.closure_error() > 1e-3, "it is noisy");
            assert!(noisy.reciprocity_error().error > 1e-3, "it is noisy");
            let corrected = noisy.enclosure_corrected();
            let (closure, reciprocity) = (
                corrected.closure_error(),
                corrected.reciprocity_error().error,
            );
            assert!(closure < 1e-6, "closure {closure:e} with sky {open}");
            assert!(
                reciprocity < 1e-6,
                "reciprocity {reciprocity:e} with sky {open}"
            );
            corrected.check(1e-6).expect("factors are possible");
            let change =
                (0..36).map(|k| (corrected.get(k / 6, k % 6) - noisy.get(k / 6, k % 6)).abs());
            assert!(
                change.fold(0.0, f32::max) < 0.03,
                "entries change no more than their noise"
            );
        }
    }

    fn two_plates(areas: [f64; 2], there: f64, back: f64) -> ViewFactorMatrix {
        let names = vec!["a".into(), "b".into()];
        let mut plates =
            ViewFactorMatrix::from_rows(areas.to_vec(), names, &[0.0, there, back, 0.0])
                .expect("a matrix");
        plates.sky = vec![0.0; 2];
        plates
    }

    #[test]
    fn correction_of_two_facing_plates() {
        // Only the sum of both multipliers is determined.
        let equal = two_plates([2.0, 2.0], 0.9, 0.8).enclosure_corrected();
        assert!(equal.closure_error() < 1e-6, "each sees but the other");
        // A larger plate cannot send everything to a smaller one that sends everything back.
        let unequal = two_plates([1.0, 2.0], 1.0, 0.5).enclosure_corrected();
        assert!(
            unequal.reciprocity_error().error < 1e-6,
            "reciprocity is kept"
        );
        let closure = unequal.closure_error();
        assert!(
            closure > 0.1 && closure <= 0.5 + 1e-6,
            "what cannot close is told and not made worse: {closure}"
        );
    }

    #[test]
    fn reciprocal_in_place_is_the_same() {
        let n = 75;
        let factors: Vec<f64> = (0..n * n)
            .map(|k| (k * 7919 % 101) as f64 / 101.0)
            .collect();
        let areas: Vec<f64> = (0..n).map(|i| ((i * 31 + 7) % 13) as f64).collect();
        let entries = Entries::dense(n, factors.iter().map(|&f| to_f32(f)).collect());
        let expected = entries.reciprocal(&areas);
        assert_eq!(
            expected.get(3, 70),
            to_f32(f64::from(entries.get(70, 3)) * areas[70] / areas[3]),
            "the exchange seen from the other side"
        );
        assert_eq!(entries.into_reciprocal(&areas), expected, "in place");
    }

    #[test]
    fn transposing_twice_changes_nothing() {
        let dense = noisy_cube(0.0).entries;
        let mut sparse = Entries::empty_sparse(6);
        for i in 0..6 {
            let row: Vec<(u32, f32)> = dense
                .row(i)
                .filter(|&(_, f)| f > 0.2)
                .map(|(j, f)| (crate::index32(j), f))
                .collect();
            sparse.push_row(&row);
        }
        for entries in [dense, sparse] {
            assert_eq!(entries.transposed().transposed(), entries, "twice is never");
            assert_eq!(
                entries.transposed().get(2, 5),
                entries.get(5, 2),
                "entries are mirrored"
            );
        }
    }

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
