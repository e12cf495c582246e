//! Gauss elimination by blocks of columns: what [`Gauss`](super::Gauss) uses where the matrix is large.
//!
//! It is the elimination of `gauss.rs`, partial pivoting included, in another order: a panel of columns is eliminated
//! at once (by `faer`), the exchanges of rows and then one matrix product bring all columns to its right up to date.
//! Each number of the panel is thus used once for every column while it is in the cache. Columns to the right are
//! split at fixed places whatever the number of threads, and `faer` itself works on one thread, so that the same bits
//! come out.

use crate::solve::system::System;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::lu::partial_pivoting::factor::{lu_in_place, lu_in_place_scratch};
use faer::linalg::matmul::matmul;
use faer::linalg::triangular_solve::{
    solve_unit_lower_triangular_in_place, solve_upper_triangular_in_place,
};
use faer::{Accum, MatMut, MatRef, Par};
use rayon::prelude::*;

/// Columns that are eliminated at once.
const PANEL: usize = 64;
/// Columns to its right that one thread brings up to date.
const STRIP: usize = 128;

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
        let panel = MatMut::from_column_major_slice_mut(&mut left[first * n..], n, width);
        let (_, mut panel) = panel.split_at_row_mut(first);

        // Factor the panel: below the diagonal multipliers, above it the triangle
        let rows = n - first;
        let (mut order, mut back) = (vec![0_usize; rows], vec![0_usize; rows]);
        let scratch = lu_in_place_scratch::<usize, f64>(rows, width, Par::Seq, Default::default());
        let mut memory = MemBuffer::new(scratch);
        lu_in_place(
            panel.as_mut(),
            &mut order,
            &mut back,
            Par::Seq,
            MemStack::new(&mut memory),
            Default::default(),
        );

        // The same exchanges and eliminations in all columns to the right
        let panel = panel.as_ref();
        right
            .par_chunks_mut(STRIP * n)
            .for_each(|strip| update(strip, n, first, panel, &order));
        self.done += width;
        self.done < n
    }

    /// Solves the triangle and hands the radiosities out.
    pub(super) fn substitute(&mut self, system: &mut System<'_>) {
        let n = self.n;
        let (matrix, right) = self.columns.split_at_mut(n * n);
        let triangle = MatRef::from_column_major_slice(matrix, n, n);
        let count = self.channels.len();
        let mut solutions = MatMut::from_column_major_slice_mut(right, n, count);
        solve_upper_triangular_in_place(triangle, solutions.as_mut(), Par::Seq);
        for (column, &channel) in right.chunks(n).zip(&self.channels) {
            // Only ρ = 1 in a closed enclosure gives no pivot; its light is anything, so none.
            let light = |&b: &f64| if b.is_finite() { b } else { 0.0 };
            let radiosities = column.iter().map(light);
            system.channels[channel].radiosity = radiosities.collect();
        }
    }
}

/// Brings some columns up to date: exchanges rows as the panel did, then takes off what it eliminates.
fn update(columns: &mut [f64], n: usize, first: usize, panel: MatRef<'_, f64>, order: &[usize]) {
    let width = panel.ncols();
    let mut before = vec![0.0; order.len()];
    for column in columns.chunks_mut(n) {
        let rows = &mut column[first..];
        before.copy_from_slice(rows);
        for (x, &from) in rows.iter_mut().zip(order) {
            *x = before[from];
        }
    }
    let count = columns.len() / n;
    let strip = MatMut::from_column_major_slice_mut(columns, n, count);
    let (_, strip) = strip.split_at_row_mut(first);
    let (mut top, mut rest) = strip.split_at_row_mut(width);
    let (triangle, multipliers) = panel.split_at_row(width);
    solve_unit_lower_triangular_in_place(triangle, top.as_mut(), Par::Seq);
    matmul(
        rest.as_mut(),
        Accum::Add,
        multipliers,
        top.as_ref(),
        -1.0,
        Par::Seq,
    );
}
