//! Sums over patches: matrices between faces or objects.

use super::{
    CHUNK, Collected, Entries, MatrixOptions, MatrixPlan, ViewFactorMatrix, collect, patch_area,
    ratio, to_f32,
};
use crate::error::RadiosityError;
use crate::form_factor::matrix::DenseRows;
use crate::form_factor::surfaces::Surfaces;
use crate::form_factor::{FormFactors, Row, collect_rows};
use crate::patch::PatchMesh;
use crate::stop::Stop;

impl ViewFactorMatrix {
    /// The factors between surfaces, each the sum over its patches: `F_IJ = Σ_i A_i Σ_j F_ij / A_I`; shares of sky,
    /// backs and panes likewise. Where tinted glass makes bands differ, it is the mean of the three.
    ///
    /// Rows are summed as they are computed, so the memory is that of the surfaces, however many patches there are;
    /// only where rows come cheaper all at once, and they fit, is there a matrix of patches, too. `stop` is asked about
    /// once for each row; after it has said so, the rest stays empty.
    ///
    /// # Errors
    /// As [`Self::build`].
    pub fn build_by(
        factors: &dyn FormFactors,
        surfaces: &Surfaces,
        options: MatrixOptions,
        stop: Stop<'_>,
    ) -> Result<Self, RadiosityError> {
        let mesh = factors.mesh().clone();
        let plan = MatrixPlan::of_surfaces(factors, surfaces, options)?;
        let patches = mesh.patches().len();
        let fits = patches.saturating_mul(patches).saturating_mul(4) <= options.memory_limit;
        if !plan.is_sparse
            && fits
            && let Some(rows) = factors.dense_rows(stop)
        {
            return Ok(Self::summed_by(&mesh, rows, surfaces));
        }
        let mut summer = Summer::new(surfaces.names().to_vec(), plan.is_sparse)
            .with_exchanges(surfaces.contact_exchanges());
        // Stable, so that patches of one surface keep their order.
        let mut patches: Vec<(usize, usize)> = (0..mesh.patches().len())
            .filter_map(|p| Some((surfaces.of_patch(p)?, p)))
            .collect();
        patches.sort_by_key(|&(surface, _)| surface);
        for chunk in patches.chunks(CHUNK) {
            let positions: Vec<usize> = chunk.iter().map(|&(_, p)| p).collect();
            let rows = collect_rows(factors, &positions, stop, |_, row| mean_row(&mesh, row));
            for (&(surface, p), row) in chunk.iter().zip(&rows) {
                let of = |patch| surfaces.of_patch(patch);
                summer.add(surface, patch_area(&mesh, p), row, of);
            }
            plan.refuse(summer.matrix.entries.bytes())?;
        }
        Ok(summer.finish())
    }

    /// The sums of rows that are all there.
    fn summed_by(mesh: &PatchMesh, rows: DenseRows, surfaces: &Surfaces) -> Self {
        let n = mesh.patches().len();
        if n == surfaces.len() && (0..n).all(|p| surfaces.of_patch(p) == Some(p)) {
            return Self {
                entries: Entries::dense(n, rows.values),
                areas: (0..n).map(|p| patch_area(mesh, p)).collect(),
                names: surfaces.names().to_vec(),
                sky: rows.sky,
                absorbed: rows.absorbed,
                transmitted: vec![0.0; n],
            };
        }
        let mut summer = Summer::new(surfaces.names().to_vec(), false)
            .with_exchanges(surfaces.contact_exchanges());
        let mut patches: Vec<(usize, usize)> = (0..n)
            .filter_map(|p| Some((surfaces.of_patch(p)?, p)))
            .collect();
        patches.sort_by_key(|&(surface, _)| surface);
        for (surface, p) in patches {
            let row = rows.values[p * n..(p + 1) * n].iter().enumerate();
            let row = Collected {
                entries: row.map(|(j, &f)| (crate::index32(j), f)).collect(),
                sky: rows.sky[p],
                absorbed: rows.absorbed[p],
                transmitted: 0.0,
            };
            let of = |patch| surfaces.of_patch(patch);
            summer.add(surface, patch_area(mesh, p), &row, of);
        }
        summer.finish()
    }

    /// The matrix between groups of rows: `groups` has the group of each row, `names` a name for each group.
    ///
    /// `F_IJ = Σ_i A_i Σ_j F_ij / A_I`, and shares of sky, backs and panes likewise. Closure and reciprocity survive it.
    ///
    /// # Errors
    /// A row without a group, a group without a name or without a row.
    pub fn summed(&self, groups: &[usize], names: Vec<String>) -> Result<Self, RadiosityError> {
        let fail = |message| Err(RadiosityError::Option(message));
        let (rows, count) = (self.size(), names.len());
        if groups.len() != rows {
            return fail(format!(
                "{rows} rows need {rows} groups, not {}",
                groups.len()
            ));
        }
        if let Some(row) = groups.iter().position(|&group| group >= count) {
            return fail(format!("row {row}: group {} of {count}", groups[row]));
        }
        let mut has_row = vec![false; count];
        groups.iter().for_each(|&group| has_row[group] = true);
        if let Some(empty) = has_row.iter().position(|&has| !has) {
            return fail(format!("group '{}' has no row", names[empty]));
        }
        let mut order: Vec<usize> = (0..rows).collect();
        order.sort_by_key(|&row| groups[row]);
        let mut summer = Summer::new(names, self.entries.is_sparse);
        for row in order {
            let collected = Collected {
                entries: self
                    .entries
                    .row(row)
                    .map(|(j, f)| (crate::index32(j), f))
                    .collect(),
                sky: self.sky[row],
                absorbed: self.absorbed[row],
                transmitted: self.transmitted[row],
            };
            summer.add(groups[row], self.areas[row], &collected, |j| {
                Some(groups[j])
            });
        }
        Ok(summer.finish())
    }
}

/// A matrix that grows by rows of patches, those of one surface after another.
struct Summer {
    matrix: ViewFactorMatrix,
    /// Exchange areas that are known beforehand: row, column, area; rows ascending.
    exchanges: Vec<(u32, u32, f64)>,
    /// Sums of the surface at work, times area.
    sums: Vec<f64>,
    /// Columns in which it has a sum.
    touched: Vec<u32>,
    sky: f64,
    absorbed: f64,
    transmitted: f64,
    area: f64,
}

impl Summer {
    fn new(names: Vec<String>, is_sparse: bool) -> Self {
        let n = names.len();
        let entries = if is_sparse {
            Entries::empty_sparse(n)
        } else {
            Entries::dense(n, vec![0.0; n * n])
        };
        Self {
            matrix: ViewFactorMatrix {
                entries,
                areas: Vec::with_capacity(n),
                names,
                sky: Vec::with_capacity(n),
                absorbed: Vec::with_capacity(n),
                transmitted: Vec::with_capacity(n),
            },
            exchanges: Vec::new(),
            sums: vec![0.0; n],
            touched: Vec::new(),
            sky: 0.0,
            absorbed: 0.0,
            transmitted: 0.0,
            area: 0.0,
        }
    }

    /// The same with exchange that no patch tells of, over areas of its own.
    fn with_exchanges(self, exchanges: Vec<(u32, u32, f64)>) -> Self {
        Self { exchanges, ..self }
    }

    /// Adds the row of one patch; what arrives at a column of no surface counts as absorbed.
    fn add(
        &mut self,
        surface: usize,
        area: f64,
        row: &Collected,
        of_column: impl Fn(usize) -> Option<usize>,
    ) {
        while self.matrix.areas.len() < surface {
            self.push();
        }
        self.area += area;
        self.sky += area * row.sky;
        self.absorbed += area * row.absorbed;
        self.transmitted += area * row.transmitted;
        for &(column, f) in &row.entries {
            let exchange = area * f64::from(f);
            let Some(to) = of_column(column as usize) else {
                self.absorbed += exchange;
                continue;
            };
            self.exchange(to, exchange);
        }
    }

    fn exchange(&mut self, to: usize, exchange: f64) {
        if self.sums[to] == 0.0 {
            self.touched.push(crate::index32(to));
        }
        self.sums[to] += exchange;
    }

    /// Adds what the surface at work exchanges where it is covered, or covers.
    fn exchange_in_contact(&mut self) {
        let row = self.matrix.areas.len();
        let first = self
            .exchanges
            .partition_point(|&(r, ..)| (r as usize) < row);
        let end = self.exchanges.partition_point(|&(r, ..)| r as usize <= row);
        for k in first..end {
            let (_, column, area) = self.exchanges[k];
            self.area += area;
            self.exchange(column as usize, area);
        }
    }

    /// Ends the surface at work.
    fn push(&mut self) {
        self.exchange_in_contact();
        self.touched.sort_unstable();
        self.touched.dedup();
        let area = self.area;
        let entry = |&column: &u32| {
            let sum = core::mem::take(&mut self.sums[column as usize]);
            (column, to_f32(ratio(sum, area)))
        };
        let collected = Collected {
            entries: self
                .touched
                .iter()
                .map(entry)
                .filter(|&(_, f)| f != 0.0)
                .collect(),
            sky: ratio(self.sky, area),
            absorbed: ratio(self.absorbed, area),
            transmitted: ratio(self.transmitted, area),
        };
        self.matrix.push(self.matrix.areas.len(), &collected);
        self.matrix.areas.push(area);
        self.touched.clear();
        (self.sky, self.absorbed, self.transmitted) = (0.0, 0.0, 0.0);
        self.area = 0.0;
    }

    fn finish(mut self) -> ViewFactorMatrix {
        while self.matrix.areas.len() < self.matrix.names.len() {
            self.push();
        }
        self.matrix
    }
}

/// A row of a patch, the mean over the bands.
fn mean_row(mesh: &PatchMesh, row: &Row) -> Collected {
    if row.bands == 1 && !mesh.visibility().is_tinted() {
        return collect(mesh, row, 0);
    }
    let bands = [0, 1, 2].map(|band| collect(mesh, row, band));
    let mean = |of: fn(&Collected) -> f64| bands.iter().map(of).sum::<f64>() / 3.0;
    let mut entries: Vec<(u32, f32)> = bands
        .iter()
        .flat_map(|b| b.entries.iter().copied())
        .collect();
    entries.sort_by_key(|&(column, _)| column);
    entries.dedup_by(|later, kept| {
        let same = later.0 == kept.0;
        if same {
            kept.1 += later.1;
        }
        same
    });
    entries.iter_mut().for_each(|(_, f)| *f /= 3.0);
    Collected {
        entries,
        sky: mean(|band| band.sky),
        absorbed: mean(|band| band.absorbed),
        transmitted: mean(|band| band.transmitted),
    }
}
