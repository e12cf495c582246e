//! Gauss elimination by blocks of columns: what [`Gauss`](super::Gauss) uses where the matrix is large.
//!
//! It is the elimination of `gauss.rs`, partial pivoting included, in another order (right-looking, as LAPACK's
//! `getrf`; Golub, Van Loan, *Matrix computations*, 3.2.11; the panel by halves as Toledo 1997, *Locality of reference
//! in LU decomposition with partial pivoting*):
//!
//! ```text
//! for each panel of 128 columns
//!     eliminate within the panel, by halves down to 16 columns, noting exchanged rows and multipliers
//!     for each strip of columns to its right, in parallel
//!         exchange the same rows
//!         top = inverse of the panel's triangle · top; rest -= multipliers · top
//! ```
//!
//! 1. Nearly all work is that last product. Column by column, each number of the matrix is fetched for one
//!    multiplication; here for 128 of them.
//! 2. The product goes by 12 rows and 4 columns, whose sums stay in registers: twelve vectors of four are as many as
//!    leave room for what is multiplied. Multipliers are stored by blocks of 12 rows, so that they are read in order.
//! 3. The panel is a narrow matrix, of which the same holds: eliminated in one piece, its columns were fetched 64 times
//!    by one thread while the others waited.
//! 4. The triangle is solved for many columns; its inverse turns that into products, too. Multipliers are at most 1, and
//!    the inverse of so small a triangle as exact as its solution.
//! 5. What a core can do at most is 58 GFLOP/s on the machine where this was measured; of that it reaches 50 % at 1000
//!    patches, 60 % at 2000 and 64 % at 4000 (CPU time of one thread, matrix and right sides included). Panels of 64
//!    columns in one piece with 8 rows to a block reached 30, 50 and 33 %; the `faer` crate (0.24) reaches 52, 58 and 68 %.
//! 6. Strips have a fixed width whatever the number of threads, so that the same bits come out.

use crate::solve::system::System;
use core::ops::Range;
use rayon::prelude::*;

/// Columns that are eliminated in one step.
const PANEL: usize = 128;
/// Columns of a panel that are eliminated one by one.
const NARROW: usize = 16;
/// Columns to the right of a panel, and to the right within it, that one thread brings up to date.
const STRIP: usize = 64;
const STRIP_WITHIN: usize = 16;
/// Columns that are filled together.
const TOGETHER: usize = 16;
/// Rows and columns whose sums stay in registers.
const ROWS: usize = 12;
const COLUMNS: usize = 4;
/// Blocks of rows that stay in the second cache while all columns of a strip use them: 400 kB.
const NEAR: usize = 32;

/// One matrix on its way to a triangle, with the right sides of the channels that share it.
#[derive(Debug, Clone)]
pub(super) struct BlockedElimination {
    channels: Vec<usize>,
    n: usize,
    /// Columns of `I - ρ F`, followed by one right side for each channel.
    columns: Vec<f64>,
    done: usize,
}

impl BlockedElimination {
    pub(super) fn new(system: &System<'_>, channels: Vec<usize>) -> Self {
        let n = system.size();
        let factors = system.factors(channels[0]);
        let reflectance = &system.channels[channels[0]].reflectance;
        let mut columns = vec![0.0; n * (n + channels.len())];
        let (matrix, right) = columns.split_at_mut(n * n);
        // A few columns together: rows of factors are read, and each line of the cache has several columns.
        let together = matrix.par_chunks_mut(TOGETHER * n).enumerate();
        together.for_each(|(k, columns)| {
            for (i, &rho) in reflectance.iter().enumerate() {
                for (j, column) in (k * TOGETHER..).zip(columns.chunks_mut(n)) {
                    column[i] = f64::from(u8::from(i == j)) - rho * f64::from(factors.get(i, j));
                }
            }
        });
        for (column, &channel) in right.chunks_mut(n).zip(&channels) {
            column.copy_from_slice(&system.channels[channel].emission);
        }
        Self {
            channels,
            n,
            columns,
            done: 0,
        }
    }

    /// Eliminates the next columns; says whether there are more.
    pub(super) fn eliminate(&mut self) -> bool {
        let (n, first) = (self.n, self.done);
        let width = PANEL.min(n - first);
        let (left, right) = self.columns.split_at_mut((first + width) * n);
        let panel = &mut left[first * n..];
        let exchanges = eliminate(panel, n, first);
        let panel = Panel::new(panel, n, first, exchanges);
        right
            .par_chunks_mut(STRIP * n)
            .for_each(|strip| panel.bring_up_to_date(strip));
        self.done += width;
        self.done < n
    }

    /// Solves the triangle from the last row up and hands the radiosities out.
    pub(super) fn substitute(&mut self, system: &mut System<'_>) {
        let n = self.n;
        let (matrix, right) = self.columns.split_at_mut(n * n);
        for (b, &channel) in right.chunks_mut(n).zip(&self.channels) {
            for (j, column) in matrix.chunks(n).enumerate().rev() {
                // Only ρ = 1 in a closed enclosure gives no pivot; its light is anything, so none.
                b[j] = if column[j] == 0.0 {
                    0.0
                } else {
                    b[j] / column[j]
                };
                let (above, known) = b.split_at_mut(j);
                subtract(above, known[0], &column[..j]);
            }
            system.channels[channel].radiosity.copy_from_slice(b);
        }
    }
}

/// Eliminates the columns of a panel below their pivots, of which the first is in row `first`; the row that each pivot's
/// row was exchanged with, in this order.
fn eliminate(columns: &mut [f64], n: usize, first: usize) -> Vec<usize> {
    let width = columns.len() / n;
    if width <= NARROW {
        return eliminate_narrow(columns, n, first);
    }
    let half = (width / 2).next_multiple_of(NARROW);
    let (left, right) = columns.split_at_mut(half * n);
    let exchanges = eliminate(left, n, first);
    let panel = Panel::new(left, n, first, exchanges);
    right
        .par_chunks_mut(STRIP_WITHIN * n)
        .for_each(|strip| panel.bring_up_to_date(strip));
    let later = eliminate(right, n, first + half);
    for column in left.chunks_mut(n) {
        exchange(&mut column[first + half..], &later, first + half);
    }
    let mut exchanges = panel.exchanges;
    exchanges.extend(later);
    exchanges
}

/// As [`eliminate`], column by column.
fn eliminate_narrow(columns: &mut [f64], n: usize, first: usize) -> Vec<usize> {
    let width = columns.len() / n;
    let mut exchanges = Vec::with_capacity(width);
    for c in 0..width {
        let diagonal = first + c;
        let pivot = pivot(&columns[c * n..(c + 1) * n], diagonal);
        exchanges.push(pivot);
        columns.chunks_mut(n).for_each(|c| c.swap(diagonal, pivot));
        let (done, rest) = columns.split_at_mut((c + 1) * n);
        let column = &mut done[c * n..];
        let pivot = column[diagonal];
        let multipliers = &mut column[diagonal + 1..];
        if pivot != 0.0 {
            multipliers.iter_mut().for_each(|x| *x /= pivot);
        }
        for other in rest.chunks_mut(n) {
            let factor = other[diagonal];
            subtract(&mut other[diagonal + 1..], factor, multipliers);
        }
    }
    exchanges
}

/// The row with the largest entry of a column from the diagonal on; the first of several.
fn pivot(column: &[f64], diagonal: usize) -> usize {
    let below = column.iter().enumerate().skip(diagonal + 1);
    let start = (diagonal, column[diagonal].abs());
    let larger = |best: (usize, f64), (row, x): (usize, &f64)| {
        if x.abs() > best.1 {
            (row, x.abs())
        } else {
            best
        }
    };
    below.fold(start, larger).0
}

/// Exchanges rows of a column, of which the first is row `first` of the matrix.
fn exchange(column: &mut [f64], exchanges: &[usize], first: usize) {
    for (c, &row) in exchanges.iter().enumerate() {
        column.swap(c, row - first);
    }
}

/// What the columns to the right of an eliminated panel need to know of it.
struct Panel {
    n: usize,
    /// Row of its first pivot.
    first: usize,
    width: usize,
    /// The row that each row was exchanged with, in this order.
    exchanges: Vec<usize>,
    /// Inverse of the triangle of multipliers within the panel's rows, less the identity: for each block of rows those
    /// of each column.
    inverse: Vec<[f64; ROWS]>,
    /// Multipliers of the rows below with their signs turned, likewise; zero beyond the last row.
    blocks: Vec<[f64; ROWS]>,
}

impl Panel {
    fn new(columns: &[f64], n: usize, first: usize, exchanges: Vec<usize>) -> Self {
        let width = columns.len() / n;
        Self {
            n,
            first,
            width,
            exchanges,
            inverse: blocks(&inverse_triangle(columns, n, first), width, 0, 1.0),
            blocks: blocks(columns, n, first + width, -1.0),
        }
    }

    /// Does to the columns of a strip what was done to the panel.
    fn bring_up_to_date(&self, strip: &mut [f64]) {
        let (n, first, width) = (self.n, self.first, self.width);
        for column in strip.chunks_mut(n) {
            exchange(&mut column[first..], &self.exchanges, first);
        }
        self.multiply_add(&self.inverse, strip, first..first + width);
        self.multiply_add(&self.blocks, strip, first + width..n);
    }

    /// Adds the product of blocks of rows with the panel's rows to some rows of a strip.
    fn multiply_add(&self, blocks: &[[f64; ROWS]], strip: &mut [f64], rows: Range<usize>) {
        let n = self.n;
        let groups = strip.chunks(COLUMNS * n);
        let tops: Vec<[f64; COLUMNS]> = groups.flat_map(|columns| self.tops(columns)).collect();
        let near = blocks.chunks(self.width * NEAR);
        for (near, start) in near.zip(rows.clone().step_by(ROWS * NEAR)) {
            let groups = strip.chunks_mut(COLUMNS * n);
            for (columns, tops) in groups.zip(tops.chunks(self.width)) {
                for (block, row) in near.chunks(self.width).zip((start..).step_by(ROWS)) {
                    let sums = product(block, tops);
                    for (column, sums) in columns.chunks_mut(n).zip(&sums) {
                        add(&mut column[row..rows.end], sums);
                    }
                }
            }
        }
    }

    /// The panel's rows of some columns, row by row; zero for columns that are not there.
    fn tops(&self, columns: &[f64]) -> Vec<[f64; COLUMNS]> {
        let mut tops = vec![[0.0; COLUMNS]; self.width];
        for (c, column) in columns.chunks(self.n).enumerate() {
            for (top, &x) in tops.iter_mut().zip(&column[self.first..]) {
                top[c] = x;
            }
        }
        tops
    }
}

/// The inverse of a panel's triangle of multipliers, which has ones on its diagonal, less the identity; column by column.
fn inverse_triangle(columns: &[f64], n: usize, first: usize) -> Vec<f64> {
    let width = columns.len() / n;
    let mut inverse = vec![0.0; width * width];
    for (j, column) in inverse.chunks_mut(width).enumerate() {
        column[j] = 1.0;
        for (c, multipliers) in columns.chunks(n).enumerate().skip(j) {
            let (done, rest) = column.split_at_mut(c + 1);
            subtract(rest, done[c], &multipliers[first + c + 1..first + width]);
        }
        column[j] = 0.0;
    }
    inverse
}

/// Rows of some columns from one on, by blocks of rows, with a sign.
fn blocks(columns: &[f64], n: usize, from: usize, sign: f64) -> Vec<[f64; ROWS]> {
    let width = columns.len() / n;
    let mut blocks = vec![[0.0; ROWS]; (n - from).div_ceil(ROWS) * width];
    for (c, column) in columns.chunks(n).enumerate() {
        let of_column = blocks.iter_mut().skip(c).step_by(width);
        for (block, rows) in of_column.zip(column[from..].chunks(ROWS)) {
            block.iter_mut().zip(rows).for_each(|(x, y)| *x = sign * y);
        }
    }
    blocks
}

/// Adds sums to the rows of a column, as many as there are.
fn add(column: &mut [f64], sums: &[f64; ROWS]) {
    if let Some(column) = column.first_chunk_mut::<ROWS>() {
        column.iter_mut().zip(sums).for_each(|(x, sum)| *x += sum);
    } else {
        column.iter_mut().zip(sums).for_each(|(x, sum)| *x += sum);
    }
}

/// `multipliers · top` for the rows of one block in some columns.
fn product(block: &[[f64; ROWS]], tops: &[[f64; COLUMNS]]) -> [[f64; ROWS]; COLUMNS] {
    let mut sums = [[0.0; ROWS]; COLUMNS];
    for (multipliers, top) in block.iter().zip(tops) {
        for c in 0..COLUMNS {
            for lane in 0..ROWS {
                sums[c][lane] = multiply_add(multipliers[lane], top[c], sums[c][lane]);
            }
        }
    }
    sums
}

/// `a b + c`, in one instruction where there is one; elsewhere that would be a call of a function.
#[inline]
fn multiply_add(a: f64, b: f64, c: f64) -> f64 {
    if cfg!(any(target_feature = "fma", target_arch = "aarch64")) {
        a.mul_add(b, c)
    } else {
        a * b + c
    }
}

/// `x -= factor · y`
fn subtract(x: &mut [f64], factor: f64, y: &[f64]) {
    if factor == 0.0 {
        return;
    }
    for (x, y) in x.iter_mut().zip(y) {
        *x -= factor * y;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::hash;

    /// Signed numbers of all sizes, so that nearly every pivot is another row.
    fn random_columns(n: usize) -> Vec<f64> {
        let number = |k: usize| hash(k as u64, 7) as f64 / u64::MAX as f64 - 0.5;
        (0..n * n).map(number).collect()
    }

    #[test]
    fn by_halves_is_the_same_as_column_by_column() {
        for n in [1, 5, 16, 17, 40, 65, 150] {
            let original = random_columns(n);
            let (mut halves, mut narrow) = (original.clone(), original.clone());
            let exchanges = eliminate(&mut halves, n, 0);
            assert_eq!(
                exchanges,
                eliminate_narrow(&mut narrow, n, 0),
                "pivots of {n}"
            );
            let moved = exchanges.iter().enumerate().filter(|&(i, &row)| row != i);
            assert!(n < 16 || moved.count() > n / 2, "rows of {n} are exchanged");
            for (a, b) in halves.iter().zip(&narrow) {
                assert!((a - b).abs() < 1e-9 * b.abs().max(1.0), "{n}: {a} and {b}");
            }
        }
    }

    /// `P A = L U`
    #[test]
    fn triangles_multiply_to_the_matrix() {
        let n = 150;
        let mut original = random_columns(n);
        let mut columns = original.clone();
        let exchanges = eliminate(&mut columns, n, 0);
        for (j, column) in original.chunks_mut(n).enumerate() {
            exchange(column, &exchanges, 0);
            for (i, &wanted) in column.iter().enumerate() {
                let lower = |k: usize| if k == i { 1.0 } else { columns[k * n + i] };
                let upper = |k: usize| columns[j * n + k];
                let product: f64 = (0..=i.min(j)).map(|k| lower(k) * upper(k)).sum();
                assert!(
                    (product - wanted).abs() < 1e-11,
                    "({i}, {j}): {product}, {wanted}"
                );
            }
        }
    }

    #[test]
    fn a_column_of_zeros_harms_nothing() {
        let n = 40;
        let mut columns = random_columns(n);
        columns[20 * n..21 * n].fill(0.0);
        eliminate(&mut columns, n, 0);
        assert!(columns.iter().all(|x| x.is_finite()), "no division by zero");
    }
}
