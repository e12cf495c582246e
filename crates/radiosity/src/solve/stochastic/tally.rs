//! Sums of many rays from many threads that do not depend on their order.
//!
//! Floating-point sums would: what is added here is a whole multiple of a unit, far smaller than what a ray carries.

use core::sync::atomic::{AtomicI64, Ordering};

/// Sums in fixed point.
pub(super) struct Tally {
    unit: f64,
    sums: Vec<AtomicI64>,
}

impl Tally {
    /// So many sums, of which none exceeds `bound` on the way to its end.
    pub(super) fn new(count: usize, bound: f64) -> Self {
        /// One bit is the sign's, one is kept free.
        const STEPS: f64 = (1_u64 << 62) as f64;
        let mut sums = Vec::new();
        sums.resize_with(count, AtomicI64::default);
        Self {
            unit: bound.max(f64::MIN_POSITIVE * STEPS) / STEPS,
            sums,
        }
    }

    /// What one carries, in units.
    #[expect(
        clippy::cast_possible_truncation,
        reason = "a cast of floats stops at the largest integer"
    )]
    pub(super) fn units(&self, amount: f64) -> i64 {
        (amount / self.unit).round() as i64
    }

    /// Adds to a sum.
    pub(super) fn add(&self, index: usize, units: i64) {
        self.sums[index].fetch_add(units, Ordering::Relaxed);
    }

    /// A sum.
    pub(super) fn get(&self, index: usize) -> f64 {
        self.sums[index].load(Ordering::Relaxed) as f64 * self.unit
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rayon::prelude::*;

    #[test]
    fn sums_are_the_same_in_any_order() {
        let amounts: Vec<f64> = (0..10_000).map(|i| f64::from(i).sin() / 7.0).collect();
        let sum = |threads: usize, backwards: bool| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
            let tally = Tally::new(1, 2000.0);
            let mut amounts = amounts.clone();
            if backwards {
                amounts.reverse();
            }
            pool.expect("threads").install(|| {
                amounts
                    .par_iter()
                    .for_each(|&a| tally.add(0, tally.units(a)));
            });
            tally.get(0)
        };
        assert_eq!(sum(1, false), sum(4, true), "integers add in any order");
        let exact: f64 = amounts.iter().sum();
        assert!((sum(2, false) - exact).abs() < 1e-11, "units are small");
    }
}
