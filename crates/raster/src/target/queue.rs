//! Coverage that waits until many rows of it can be handed over at once.

use super::CoverageTarget;

/// Pixels of a run at most.
pub(crate) const LANES: usize = 4;

/// Runs that wait at most.
const RUNS: usize = 32;

/// Short runs of covered pixels that lie apart.
///
/// Rows of a picture beyond the cache are far from each other in memory. With the arithmetic of a row between two of
/// them a processor waits for one at a time; one after the other it waits for many at once.
pub(crate) struct CoverageQueue {
    runs: [Run; RUNS],
    count: usize,
}

#[derive(Clone, Copy)]
struct Run {
    row: i32,
    left: i32,
    count: usize,
    shares: [f32; LANES],
}

impl CoverageQueue {
    pub fn new() -> Self {
        const NONE: Run = Run {
            row: 0,
            left: 0,
            count: 0,
            shares: [0.0; LANES],
        };
        Self {
            runs: [NONE; RUNS],
            count: 0,
        }
    }

    /// Adds the first `count` of some shares of a row's pixels from column `left` on.
    #[inline(always)]
    pub fn push(
        &mut self,
        target: &mut impl CoverageTarget,
        [row, left]: [i32; 2],
        shares: [f32; LANES],
        count: usize,
    ) {
        if self.count == RUNS {
            self.flush(target);
        }
        self.runs[self.count] = Run {
            row,
            left,
            count: count.min(LANES),
            shares,
        };
        self.count += 1;
    }

    /// Hands all over.
    #[inline]
    pub fn flush(&mut self, target: &mut impl CoverageTarget) {
        for run in &self.runs[..self.count] {
            target.cover(run.row, run.left, &run.shares[..run.count]);
        }
        self.count = 0;
    }
}
