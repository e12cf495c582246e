//! Where the samples of a picture lie.

use crate::random::{GOLDEN, mix};

/// How samples are moved away from the points of their grid.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Pattern {
    /// Not at all: errors have a pattern (moiré), and are small.
    #[default]
    Regular,
    /// Each on its own by a random vector: errors become noise, which the eye forgives, and are larger on most edges.
    Jittered {
        /// How far at most in x and in y, in pixels; half the distance of two samples fills the plane evenly.
        /// What is not finite counts as 0. Default value: [`Pattern::JITTER`].
        bound: f64,
        /// Which random vectors; one of them depends on the seed and on the sample's place alone. Default value: 0.
        seed: u64,
    },
}

impl Pattern {
    /// The bound of jitter if nothing else is asked for: a sixth of a pixel.
    pub const JITTER: f64 = 1.0 / 6.0;

    /// Jitter by at most a sixth of a pixel.
    pub const fn jittered() -> Self {
        Self::Jittered {
            bound: Self::JITTER,
            seed: 0,
        }
    }

    /// The same with other random numbers, if there are any.
    #[must_use]
    pub const fn with_seed(mut self, new: u64) -> Self {
        if let Self::Jittered { seed, .. } = &mut self {
            *seed = new;
        }
        self
    }

    /// Vector by which the sample of a column and a row of the grid is moved, in pixels.
    pub(super) fn offset(self, column: usize, row: usize) -> [f64; 2] {
        match self {
            Self::Regular => [0.0; 2],
            Self::Jittered { bound, .. } if !bound.is_finite() => [0.0; 2],
            Self::Jittered { bound, seed } => {
                let bits = hash(seed, column as u64, row as u64);
                [bits >> 32, bits & 0xffff_ffff].map(|half| bound * signed_unit(half))
            }
        }
    }
}

/// 32 bits as a number in (-1, 1).
fn signed_unit(bits: u64) -> f64 {
    (bits as f64 + 0.5) / f64::from(1_u32 << 31) - 1.0
}

/// A hash of a seed and two numbers, mixed after each of them.
fn hash(seed: u64, column: u64, row: u64) -> u64 {
    let step = |state: u64, value: u64| mix(state.wrapping_add(GOLDEN) ^ value);
    step(step(mix(seed), column), row)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn offsets(seed: u64) -> Vec<[f64; 2]> {
        let pattern = Pattern::jittered().with_seed(seed);
        let places = (0..10_000).map(|i| (i % 100, i / 100));
        places.map(|(x, y)| pattern.offset(x, y)).collect()
    }

    #[test]
    fn jitter_is_bounded_uniform_and_uncorrelated() {
        let offsets = offsets(3);
        let moment = |f: &dyn Fn(&[f64; 2], &[f64; 2]) -> f64| {
            let pairs = offsets.iter().zip(&offsets[1..]);
            pairs.map(|(a, b)| f(a, b)).sum::<f64>()
                / (offsets.len() - 1) as f64
                / Pattern::JITTER.powi(2)
        };
        let largest = offsets
            .iter()
            .flatten()
            .fold(0.0, |m: f64, d| m.max(d.abs()));
        assert!(largest <= Pattern::JITTER && largest > 0.99 * Pattern::JITTER);
        // Means of 10 000 numbers of variance 1/3 (or 1/9 for products): four standard errors.
        assert!((moment(&|a, _| a[0] * a[0]) - 1.0 / 3.0).abs() < 0.015, "x");
        assert!((moment(&|a, _| a[1] * a[1]) - 1.0 / 3.0).abs() < 0.015, "y");
        assert!(moment(&|a, _| a[0] * a[1]).abs() < 0.015, "x with y");
        assert!(moment(&|a, b| a[0] * b[0]).abs() < 0.015, "neighbours");
    }

    #[test]
    fn seeds_differ_and_repeat() {
        assert_eq!(offsets(1), offsets(1), "the same seed");
        let same = offsets(1)
            .iter()
            .zip(offsets(2))
            .filter(|(a, b)| **a == *b)
            .count();
        assert_eq!(same, 0, "places with the same offset");
    }

    #[test]
    fn bound_that_is_no_number_moves_nothing() {
        for bound in [f64::NAN, f64::INFINITY] {
            let pattern = Pattern::Jittered { bound, seed: 0 };
            assert_eq!(pattern.offset(3, 4), [0.0; 2], "{bound}");
        }
    }
}
