//! Weights that combine samples into pixels.

use super::Factor;
use crate::sinc::sinc;
use core::f64::consts::{PI, TAU};

/// How the samples around a pixel's centre are weighted; the same in both directions, so a filter is separable.
///
/// Weights are divided by their sum: what is flat stays flat. [`Self::Mitchell`] and [`Self::Lanczos`] have negative
/// lobes, so beside a bright edge a value may fall below 0 or rise above the brightest sample.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Filter {
    /// All samples of the pixel alike.
    Box,
    /// A triangle of `2 k - 1` taps `1, 2, ..., k, ..., 2, 1`, two boxes of `k` taps one after the other: 3x3 taps
    /// (over 16) for `k = 2`, 5x5 (over 81) for 3, 7x7 (over 256) for 4.
    ///
    /// Its response `((1 / k) sin(pi k f) / sin(pi f))^2` is 0 exactly at the multiples of `1 / k` cycles per sample,
    /// where the grid of pixels would fold frequencies to 0: it belongs to supersampling by `k` in each direction
    /// ([`Self::for_factor`]). With any other factor these frequencies stay, and show as ripple on fine patterns.
    Bartlett {
        /// The factor to which its width belongs.
        factor: Factor,
    },
    /// `exp(-x^2 / (2 sigma^2))` with sigma half a pixel, lowered to reach 0 at 2 pixels.
    Gaussian,
    /// Mitchell and Netravali 1988 with B = C = 1/3, 2 pixels to each side.
    Mitchell,
    /// The four-term window of Harris 1978, 1.5 pixels to each side.
    BlackmanHarris,
    /// `sinc(x) sinc(x / 3)`, 3 pixels to each side: the sharpest, with visible ringing.
    Lanczos,
}

/// Cosines of the Blackman-Harris window; they alternate in sign.
const BLACKMAN_HARRIS: [f64; 4] = [0.35875, 0.48829, 0.14128, 0.01168];

impl Filter {
    /// The Bartlett filter that leaves no ripple with a factor.
    pub const fn for_factor(factor: Factor) -> Self {
        Self::Bartlett { factor }
    }

    /// The factor of supersampling to which the filter's width is bound; `None` if it is defined in pixels and fits any.
    pub const fn factor(self) -> Option<Factor> {
        match self {
            Self::Bartlett { factor } => Some(factor),
            _ => None,
        }
    }

    /// Reach to each side in pixels, for filters that are defined in pixels.
    fn radius(self) -> f64 {
        match self {
            Self::Box | Self::Bartlett { .. } => 0.5,
            Self::Gaussian | Self::Mitchell => 2.0,
            Self::BlackmanHarris => 1.5,
            Self::Lanczos => 3.0,
        }
    }

    /// Height of a kernel that is defined in pixels at a distance in pixels, up to a factor.
    fn height(self, x: f64) -> f64 {
        let x = x.abs();
        if x >= self.radius() {
            return 0.0;
        }
        match self {
            Self::Box | Self::Bartlett { .. } => 1.0,
            Self::Gaussian => (-2.0 * x * x).exp() - (-8.0_f64).exp(),
            Self::Mitchell if x < 1.0 => (7.0 * x * x * x - 12.0 * x * x + 16.0 / 3.0) / 6.0,
            Self::Mitchell => (-7.0 / 3.0 * x * x * x + 12.0 * x * x - 20.0 * x + 32.0 / 3.0) / 6.0,
            Self::BlackmanHarris => {
                let phase = TAU * (x / 3.0 + 0.5);
                let [a, b, c, d] = BLACKMAN_HARRIS;
                a - b * phase.cos() + c * (2.0 * phase).cos() - d * (3.0 * phase).cos()
            }
            Self::Lanczos => sinc(PI * x) * sinc(PI * x / 3.0),
        }
    }

    /// Number of taps in one direction with so many samples per pixel.
    ///
    /// The middle of the taps is the pixel's centre. Filters defined in pixels have as many as reach the kernel, odd
    /// with an odd factor and even with an even one: samples then lie in the middles of the pixel's cells.
    pub fn tap_count(self, factor: Factor) -> usize {
        match self {
            Self::Box => factor.get(),
            Self::Bartlett { factor } => 2 * factor.get() - 1,
            _ => {
                let reach = 2.0 * self.radius() * factor.get() as f64;
                let mut count = factor.get();
                while ((count + 2) as f64) < reach + 1.0 {
                    count += 2;
                }
                count
            }
        }
    }

    /// The weights in one direction with so many samples per pixel, symmetric, of sum 1.
    pub fn weights(self, factor: Factor) -> Vec<f64> {
        let count = self.tap_count(factor);
        let middle = (count - 1) as f64 / 2.0;
        let height = |tap: usize| match self {
            Self::Bartlett { .. } => (tap + 1).min(count - tap) as f64,
            _ => self.height((tap as f64 - middle) / factor.get() as f64),
        };
        let heights: Vec<f64> = (0..count).map(height).collect();
        let sum: f64 = heights.iter().sum();
        heights.iter().map(|h| h / sum).collect()
    }

    /// Factor by which the filter passes a wave of so many cycles per pixel, in one direction:
    /// `H(f) = Σ_t w_t cos(2 pi f (t - middle) / k)`.
    pub fn response(self, factor: Factor, cycles_per_pixel: f64) -> f64 {
        let weights = self.weights(factor);
        let middle = (weights.len() - 1) as f64 / 2.0;
        let phase = |tap: usize| TAU * cycles_per_pixel * (tap as f64 - middle);
        let k = factor.get() as f64;
        let taps = weights.iter().enumerate();
        taps.map(|(tap, w)| w * (phase(tap) / k).cos()).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn factor(k: usize) -> Factor {
        Factor::new(k).expect("in range")
    }

    fn all(k: usize) -> [Filter; 6] {
        let bartlett = Filter::for_factor(factor(k));
        use Filter::{BlackmanHarris, Box, Gaussian, Lanczos, Mitchell};
        [Box, bartlett, Gaussian, Mitchell, BlackmanHarris, Lanczos]
    }

    #[test]
    fn bartlett_weights_are_those_of_the_textbook() {
        for (k, row, whole) in [
            (2, vec![1.0, 2.0, 1.0], 16.0),
            (3, vec![1.0, 2.0, 3.0, 2.0, 1.0], 81.0),
            (4, vec![1.0, 2.0, 3.0, 4.0, 3.0, 2.0, 1.0], 256.0),
        ] {
            let weights = Filter::for_factor(factor(k)).weights(factor(k));
            for (i, a) in weights.iter().enumerate() {
                for (j, b) in weights.iter().enumerate() {
                    let expected = row[i] * row[j] / whole;
                    assert!((a * b - expected).abs() < 1e-15, "k = {k}, tap {i}, {j}");
                }
            }
        }
    }

    #[test]
    fn bartlett_removes_what_folds_to_zero_only_with_its_own_factor() {
        for k in 2..=8 {
            for width in 2..=8 {
                let filter = Filter::for_factor(factor(width));
                let worst = (1..k).map(|m| filter.response(factor(k), m as f64).abs());
                let worst = worst.fold(0.0, f64::max);
                // Taps of twice the width, or a multiple of it, have the same zeros and more; they only blur.
                let fits = width % k == 0;
                assert_eq!(worst < 1e-12, fits, "{width} taps with factor {k}: {worst}");
            }
        }
    }

    #[test]
    fn weights_are_symmetric_and_sum_to_one() {
        for k in 1..=Factor::MAX {
            for filter in all(k) {
                let weights = filter.weights(factor(k));
                let sum: f64 = weights.iter().sum();
                assert!((sum - 1.0).abs() < 1e-12, "{filter:?} {k}: {sum}");
                let mut mirrored = weights.clone();
                mirrored.reverse();
                let differ = weights.iter().zip(&mirrored).map(|(a, b)| (a - b).abs());
                assert!(differ.fold(0.0, f64::max) < 1e-15, "{filter:?} {k}");
                assert_eq!(weights.len(), filter.tap_count(factor(k)), "{filter:?} {k}");
            }
        }
    }

    #[test]
    fn kernels_are_continuous_and_reach_zero() {
        for filter in [Filter::Gaussian, Filter::Mitchell, Filter::Lanczos] {
            assert!(
                filter.height(filter.radius() - 1e-9).abs() < 1e-8,
                "{filter:?}"
            );
            let (below, above) = (filter.height(1.0 - 1e-9), filter.height(1.0 + 1e-9));
            assert!((below - above).abs() < 1e-7, "{filter:?}");
        }
        // The window's end is 6e-5 of its height, as Harris gives it.
        assert!(Filter::BlackmanHarris.height(1.5 - 1e-9) < 1e-4, "end");
        assert!(
            (Filter::BlackmanHarris.height(0.0) - 1.0).abs() < 1e-12,
            "top"
        );
    }

    #[test]
    fn low_frequencies_pass_and_high_ones_do_not() {
        let k = factor(8);
        for filter in all(8) {
            assert!((filter.response(k, 0.0) - 1.0).abs() < 1e-12, "{filter:?}");
            assert!(filter.response(k, 0.1) > 0.85, "{filter:?}");
            assert!(filter.response(k, 1.5).abs() < 0.25, "{filter:?}");
        }
    }
}
