//! The entries of a matrix, every one or those that are not zero.

use super::{ratio, to_f32};
use rayon::prelude::*;

/// A square matrix in f32, dense or sparse.
#[derive(Debug, Clone, PartialEq)]
pub struct Entries {
    pub(super) size: usize,
    /// Where each row starts in `columns` and `values`; empty if dense.
    starts: Vec<usize>,
    columns: Vec<u32>,
    pub(super) values: Vec<f32>,
    pub(super) is_sparse: bool,
}

impl Entries {
    pub(super) fn dense(size: usize, values: Vec<f32>) -> Self {
        Self {
            size,
            starts: Vec::new(),
            columns: Vec::new(),
            values,
            is_sparse: false,
        }
    }

    pub(super) fn empty_sparse(size: usize) -> Self {
        Self {
            size,
            starts: vec![0],
            columns: Vec::new(),
            values: Vec::new(),
            is_sparse: true,
        }
    }

    pub(super) fn push_row(&mut self, row: &[(u32, f32)]) {
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
    pub(super) fn map(&self, change: impl Fn(usize, usize, f32) -> f32 + Sync) -> Self {
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
    pub(super) fn symmetrised(&self, areas: &[f64]) -> Self {
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

#[cfg(test)]
mod tests {
    use super::*;

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
        let values = (0..36).map(|k: usize| to_f32((k * 7919 % 101) as f64 / 250.0));
        let dense = Entries::dense(6, values.collect());
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
}
