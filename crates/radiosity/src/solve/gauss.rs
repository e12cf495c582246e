//! Gauss elimination with partial pivoting: the direct solver.
//!
//! The elimination in this file is the readable one. Above [`READABLE_UP_TO`] patches `gauss_blocked.rs` does the same
//! by blocks of columns, which keeps numbers in the cache; the readable one stays the oracle of its tests.

use crate::solve::gauss_blocked::BlockedElimination;
use crate::solve::system::{MatrixMethod, System};
use rayon::prelude::*;

/// Patches up to which the readable elimination is used. By blocks it is as fast there, at least four times as fast at
/// 1000 and seven times at 2000.
pub const READABLE_UP_TO: usize = 32;

/// One step eliminates one column of `I - ρ F`, or a block of 128 where the matrix is large; the last one substitutes
/// back and so ends the sweep. Until then radiosities stay as they were.
///
/// It takes `n²` numbers in f64 for each channel and `2/3 n³` operations; channels whose reflectances agree share
/// their elimination.
#[derive(Debug, Clone)]
pub struct Gauss {
    readable_up_to: usize,
    eliminations: Vec<Elimination>,
    blocked: Vec<BlockedElimination>,
    column: usize,
}

impl Default for Gauss {
    fn default() -> Self {
        Self::readable_up_to(READABLE_UP_TO)
    }
}

impl Gauss {
    /// Up to so many patches column by column, above by blocks.
    pub fn readable_up_to(patches: usize) -> Self {
        Self {
            readable_up_to: patches,
            eliminations: Vec::new(),
            blocked: Vec::new(),
            column: 0,
        }
    }

    fn step_readable(&mut self, system: &mut System<'_>) -> bool {
        if self.column == 0 {
            let groups = alike(system).into_iter();
            self.eliminations = groups.map(|g| Elimination::new(system, g)).collect();
        }
        for elimination in &mut self.eliminations {
            elimination.eliminate(self.column);
        }
        self.column += 1;
        if self.column < system.size() {
            return false;
        }
        for elimination in &self.eliminations {
            elimination.substitute(system);
        }
        self.restart();
        true
    }

    fn step_blocked(&mut self, system: &mut System<'_>) -> bool {
        if self.blocked.is_empty() {
            let groups = alike(system).into_iter();
            self.blocked = groups.map(|g| BlockedElimination::new(system, g)).collect();
        }
        let mut is_more = false;
        for elimination in &mut self.blocked {
            is_more |= elimination.eliminate();
        }
        if is_more {
            return false;
        }
        for elimination in &mut self.blocked {
            elimination.substitute(system);
        }
        self.restart();
        true
    }
}

/// One matrix on its way to a triangle, with the right sides of the channels that share it.
#[derive(Debug, Clone)]
struct Elimination {
    channels: Vec<usize>,
    /// Rows of `I - ρ F`, followed by one right side for each channel.
    rows: Vec<Vec<f64>>,
}

impl Elimination {
    fn new(system: &System<'_>, channels: Vec<usize>) -> Self {
        let n = system.size();
        let first = channels[0];
        let row = |i: usize| {
            let mut row = vec![0.0; n + channels.len()];
            row[i] = 1.0;
            let reflectance = system.channels[first].reflectance[i];
            for (j, f) in system.factors(first).row(i) {
                row[j] -= reflectance * f64::from(f);
            }
            for (k, &channel) in channels.iter().enumerate() {
                row[n + k] = system.channels[channel].emission[i];
            }
            row
        };
        Self {
            rows: (0..n).into_par_iter().map(row).collect(),
            channels,
        }
    }

    /// Clears one column below the diagonal.
    fn eliminate(&mut self, column: usize) {
        // The row with the largest entry of the column goes to the diagonal.
        let size = |row: usize| self.rows[row][column].abs();
        let pivot = (column + 1..self.rows.len()).fold(column, |best, row| {
            if size(row) > size(best) { row } else { best }
        });
        self.rows.swap(column, pivot);
        let (above, below) = self.rows.split_at_mut(column + 1);
        let pivot = &above[column];
        if pivot[column] == 0.0 {
            return;
        }
        below.par_iter_mut().with_min_len(16).for_each(|row| {
            let factor = row[column] / pivot[column];
            if factor == 0.0 {
                return;
            }
            for (x, p) in row[column..].iter_mut().zip(&pivot[column..]) {
                *x -= factor * p;
            }
        });
    }

    /// Solves the triangle from the last row up and hands the radiosities out.
    fn substitute(&self, system: &mut System<'_>) {
        let n = self.rows.len();
        for (k, &channel) in self.channels.iter().enumerate() {
            let radiosity = &mut system.channels[channel].radiosity;
            for i in (0..n).rev() {
                let row = &self.rows[i];
                let known: f64 = (i + 1..n).map(|j| row[j] * radiosity[j]).sum();
                // Only ρ = 1 in a closed enclosure gives no pivot; its light is anything, so none.
                radiosity[i] = if row[i] == 0.0 {
                    0.0
                } else {
                    (row[n + k] - known) / row[i]
                };
            }
        }
    }
}

/// Channels with the same matrix and reflectances.
fn alike(system: &System<'_>) -> Vec<Vec<usize>> {
    let mut groups: Vec<Vec<usize>> = Vec::new();
    for (i, channel) in system.channels.iter().enumerate() {
        let same = |group: &&mut Vec<usize>| {
            let first = &system.channels[group[0]];
            first.matrix == channel.matrix && first.reflectance == channel.reflectance
        };
        match groups.iter_mut().find(same) {
            Some(group) => group.push(i),
            None => groups.push(vec![i]),
        }
    }
    groups
}

impl MatrixMethod for Gauss {
    fn step(&mut self, system: &mut System<'_>) -> bool {
        if system.size() <= self.readable_up_to {
            self.step_readable(system)
        } else {
            self.step_blocked(system)
        }
    }

    fn restart(&mut self) {
        self.eliminations.clear();
        self.blocked.clear();
        self.column = 0;
    }
}
