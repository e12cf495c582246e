//! Numbers that look random and are the same on every machine, and points that fill a square evenly.

use glam::Vec2;

/// What SplitMix64 adds to its state for each number: 2^64 by the golden ratio, odd.
pub const GOLDEN: u64 = 0x9E37_79B9_7F4A_7C15;

/// Mixes the bits of a number so that each depends on all: the finaliser of SplitMix64 (Steele, Lea and Flood 2014). One
/// to one; 0 stays 0.
#[inline]
pub const fn mix(mut z: u64) -> u64 {
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    z ^ (z >> 31)
}

/// A generator of 2^64 numbers, each once: SplitMix64 (Steele, Lea and Flood 2014).
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SplitMix64 {
    state: u64,
}

impl SplitMix64 {
    /// The numbers of a seed.
    pub const fn new(seed: u64) -> Self {
        Self { state: seed }
    }

    /// The next number.
    #[inline]
    #[expect(clippy::should_implement_trait, reason = "it never ends")]
    pub fn next(&mut self) -> u64 {
        self.state = self.state.wrapping_add(GOLDEN);
        mix(self.state)
    }

    /// The next number as one in [0, 1), a multiple of 2^-24.
    #[inline]
    pub fn unit(&mut self) -> f32 {
        (self.next() >> 40) as f32 / (1 << 24) as f32
    }

    /// The next number as one in [0, 1), a multiple of 2^-53.
    #[inline]
    pub fn unit64(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1_u64 << 53) as f64
    }
}

/// The number in [0, 1) whose binary digits are those of `i` mirrored at the point (van der Corput 1935), the first 24 of
/// them, which an f32 holds exactly.
#[inline]
pub fn radical_inverse(i: u32) -> f32 {
    (i.reverse_bits() >> 8) as f32 / (1_u32 << 24) as f32
}

/// Point `i` of `count` in the unit square: the radical inverse, and the middle of the `i`-th of `count` equal parts
/// (Hammersley 1960). NaN for no points.
#[inline]
pub fn hammersley(i: u32, count: u32) -> Vec2 {
    Vec2::new(radical_inverse(i), (i as f32 + 0.5) / count as f32)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn splitmix_gives_its_published_numbers() {
        let mut random = SplitMix64::new(1_234_567);
        let wanted = [
            6_457_827_717_110_365_317,
            3_203_168_211_198_807_973,
            9_817_491_932_198_370_423,
        ];
        assert_eq!(wanted.map(|_| random.next()), wanted, "of seed 1234567");
        assert!(
            (0..1000).all(|_| (0.0..1.0).contains(&random.unit())),
            "f32"
        );
        assert!(
            (0..1000).all(|_| (0.0..1.0).contains(&random.unit64())),
            "f64"
        );
    }

    #[test]
    fn each_column_and_row_of_a_grid_holds_one_point() {
        let points: Vec<Vec2> = (0..16).map(|i| hammersley(i, 16)).collect();
        for axis in 0..2 {
            let mut cells: Vec<f32> = points.iter().map(|p| (16.0 * p[axis]).floor()).collect();
            cells.sort_by(f32::total_cmp);
            assert!((0..16).all(|i| cells[i] == i as f32), "{cells:?}");
        }
        assert_eq!(
            [1, 2, 3, 6].map(radical_inverse),
            [0.5, 0.25, 0.75, 0.375],
            "mirrored digits"
        );
        assert!(radical_inverse(u32::MAX) < 1.0, "all digits");
    }
}
