//! All pairs of patches at once, each computed but once.

use super::{Analytic, Block, Scratch};
use crate::form_factor::matrix::DenseRows;
use crate::stop::Stop;
use rayon::prelude::*;
use std::sync::atomic::{AtomicBool, Ordering};

/// Rows below which the mirror image is taken without further cutting.
const SMALL: usize = 64;
/// Rows that are mirrored together: as many f32 as fill a cache line.
const STRIP: usize = 16;

/// The rows of all patches, which are the elements.
pub fn dense_rows(factors: &Analytic, stop: Stop<'_>) -> DenseRows {
    let n = factors.ends.len();
    let areas: Vec<f64> = (0..n)
        .map(|e| f64::from(factors.mesh.exposed_area(e)))
        .collect();
    let mut values = vec![0.0_f32; n * n];
    let mut rest = &mut values[..];
    let mut jobs = Vec::with_capacity(factors.blocks.len());
    for (number, block) in factors.blocks.iter().enumerate() {
        let (rows, others) = rest.split_at_mut(block.elements.len() * n);
        jobs.push((number, block, rows));
        rest = others;
    }
    let is_over = AtomicBool::new(false);
    jobs.into_par_iter()
        .for_each_init(Scratch::default, |scratch, (number, block, rows)| {
            // Asked once for each row.
            if block.elements.clone().any(|_| stop()) {
                is_over.store(true, Ordering::Relaxed);
            }
            for other in &factors.blocks[number..] {
                if is_over.load(Ordering::Relaxed) {
                    return;
                }
                fill(factors, block, other, &areas, rows, scratch);
            }
        });
    if is_over.into_inner() {
        return DenseRows {
            values,
            sky: vec![0.0; n],
            absorbed: vec![0.0; n],
        };
    }
    mirror(&mut values, n, 0, &areas);
    let lost: Vec<(f64, f64)> = values
        .par_chunks(n)
        .zip(factors.mesh.patches())
        .map(|(row, &patch)| {
            let received: f64 = row.iter().map(|&f| f64::from(f)).sum();
            factors.lost(patch, received)
        })
        .collect();
    let (sky, absorbed) = lost.into_iter().unzip();
    DenseRows {
        values,
        sky,
        absorbed,
    }
}

/// Fills what two blocks exchange above the diagonal, into the rows of the first.
fn fill<'a>(
    factors: &'a Analytic,
    block: &Block,
    other: &Block,
    areas: &[f64],
    rows: &mut [f32],
    scratch: &mut Scratch<'a>,
) {
    let n = areas.len();
    factors
        .occluders
        .between(&block.bounds, &other.bounds, &mut scratch.of_blocks);
    let candidates = core::mem::take(&mut scratch.of_blocks);
    for (i, row) in block.elements.clone().zip(rows.chunks_mut(n)) {
        if areas[i] == 0.0 {
            continue;
        }
        let from = &factors.ends[i];
        factors.towards(from, &other.bounds, &candidates, &mut scratch.of_row);
        for j in other.elements.clone() {
            let to = &factors.ends[j];
            if j > i && to.surface != from.surface && areas[j] > 0.0 {
                row[j] = super::to_f32(f64::from(factors.pair(from, to, scratch).r) / areas[i]);
            }
        }
    }
    scratch.of_blocks = candidates;
}

/// `F_ji = F_ij A_i / A_j` below the diagonal of rows from `first` on, in halves that need nothing of each other.
fn mirror(rows: &mut [f32], n: usize, first: usize, areas: &[f64]) {
    let count = rows.len() / n;
    if count <= SMALL {
        for i in 1..count {
            for j in 0..i {
                let ratio = ratio(areas[first + j], areas[first + i]);
                rows[i * n + first + j] = ratio * rows[j * n + first + i];
            }
        }
        return;
    }
    let half = count / 2;
    let (above, below) = rows.split_at_mut(half * n);
    below
        .par_chunks_mut(STRIP * n)
        .enumerate()
        .for_each(|(strip, rows)| {
            let start = first + half + strip * STRIP;
            for j in 0..half {
                let from = &above[j * n + start..];
                for (k, row) in rows.chunks_mut(n).enumerate() {
                    row[first + j] = ratio(areas[first + j], areas[start + k]) * from[k];
                }
            }
        });
    rayon::join(
        || mirror(above, n, first, areas),
        || mirror(below, n, first + half, areas),
    );
}

fn ratio(a: f64, b: f64) -> f32 {
    if b > 0.0 { super::to_f32(a / b) } else { 0.0 }
}
