//! Gauss elimination by blocks of columns: what [`Gauss`](super::Gauss) uses where the matrix is large.
//!
//! It is the elimination of `gauss.rs`, partial pivoting included, in another order (right-looking, as LAPACK's
//! `getrf`; Golub, Van Loan, *Matrix computations*, 3.2.11):
//!
//! ```text
//! for each panel of 64 columns
//!     eliminate within the panel, noting exchanged rows and multipliers
//!     for each strip of columns to its right, in parallel
//!         exchange the same rows
//!         take the panel's rows off one another, then off all rows below: rest -= multipliers · top
//! ```
//!
//! 1. Nearly all work is that product. Column by column, each number of the matrix is fetched for one multiplication;
//!    here for 64 of them.
//! 2. The product goes by 8 rows and 4 columns, whose sums stay in registers. Multipliers are stored by blocks of 8
//!    rows, so that they are read in order.
//! 3. Strips have a fixed width whatever the number of threads, so that the same bits come out.

use crate::solve::system::System;
use rayon::prelude::*;

/// Columns that are eliminated at once.
const PANEL: usize = 64;
/// Columns to its right that one thread brings up to date.
const STRIP: usize = 64;
/// Rows and columns whose sums stay in registers.
const ROWS: usize = 8;
const COLUMNS: usize = 4;

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
        matrix
            .par_chunks_mut(n)
            .enumerate()
            .for_each(|(j, column)| {
                for (i, x) in column.iter_mut().enumerate() {
                    *x = -reflectance[i] * f64::from(factors.get(i, j));
                }
                column[j] += 1.0;
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
        let panel = Panel::eliminated(&mut left[first * n..], n, first);
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

/// What the columns to the right of an eliminated panel need to know of it.
struct Panel {
    n: usize,
    /// Its first column, and the row of its first pivot.
    first: usize,
    width: usize,
    /// The row that each row was exchanged with, in this order.
    exchanges: Vec<usize>,
    /// Multipliers within the panel's rows, column by column; only those below the diagonal count.
    triangle: Vec<f64>,
    /// Multipliers of the rows below: for each block of rows those of each column; zero beyond the last row.
    blocks: Vec<[f64; ROWS]>,
}

impl Panel {
    /// Eliminates the columns of a panel below their pivots.
    fn eliminated(columns: &mut [f64], n: usize, first: usize) -> Self {
        let width = columns.len() / n;
        let mut exchanges = Vec::with_capacity(width);
        for c in 0..width {
            let diagonal = first + c;
            // The row with the largest entry of the column goes to the diagonal.
            let column = &columns[c * n..(c + 1) * n];
            let pivot = (diagonal + 1..n).fold(diagonal, |best, row| {
                if column[row].abs() > column[best].abs() {
                    row
                } else {
                    best
                }
            });
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
        let rows = |column: &[f64]| column[first..first + width].to_vec();
        Self {
            n,
            first,
            width,
            exchanges,
            triangle: columns.chunks(n).flat_map(rows).collect(),
            blocks: blocks(columns, n, first + width),
        }
    }

    /// Does to the columns of a strip what was done to the panel.
    fn bring_up_to_date(&self, strip: &mut [f64]) {
        let (n, first, width) = (self.n, self.first, self.width);
        for column in strip.chunks_mut(n) {
            for (c, &row) in self.exchanges.iter().enumerate() {
                column.swap(first + c, row);
            }
            let top = &mut column[first..first + width];
            for (c, multipliers) in self.triangle.chunks(width).enumerate() {
                let (done, rest) = top.split_at_mut(c + 1);
                subtract(rest, done[c], &multipliers[c + 1..]);
            }
        }
        let groups = strip.chunks(COLUMNS * n);
        let tops: Vec<[f64; COLUMNS]> = groups.flat_map(|columns| self.tops(columns)).collect();
        for (b, block) in self.blocks.chunks(width).enumerate() {
            let row = first + width + b * ROWS;
            let rows = row..(row + ROWS).min(n);
            let groups = strip.chunks_mut(COLUMNS * n);
            for (columns, tops) in groups.zip(tops.chunks(width)) {
                let sums = product(block, tops);
                for (column, sums) in columns.chunks_mut(n).zip(&sums) {
                    let rest = column[rows.clone()].iter_mut().zip(sums);
                    rest.for_each(|(x, sum)| *x -= sum);
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

/// Multipliers from a row on, by blocks of rows.
fn blocks(columns: &[f64], n: usize, from: usize) -> Vec<[f64; ROWS]> {
    let block = |row: usize, column: &[f64]| {
        let mut block = [0.0; ROWS];
        let rows = &column[row..(row + ROWS).min(n)];
        block[..rows.len()].copy_from_slice(rows);
        block
    };
    let of_rows = |row: usize| columns.chunks(n).map(move |column| block(row, column));
    (from..n).step_by(ROWS).flat_map(of_rows).collect()
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
