//! Sobol's sequence in four dimensions (1967), with the direction numbers of Joe and Kuo (2008), scrambled as Owen (1995)
//! proposed by the hash of Laine and Karras (2011) as Burley (2020) applies it.
//!
//! Any `2^k` points from a multiple of `2^k` on are spread as evenly as can be: each dimension has one of them in every
//! `2^k`th part, and so has every way to cut the square of the first two dimensions into `2^k` like rectangles. The error
//! of a smooth integral falls with nearly `n^-1.5`. Seeds give independent sequences, each uniform for itself.

use crate::sampling::hash;

const DIMENSIONS: usize = 4;
const BITS: usize = 32;

/// Degree, inner coefficients and first direction numbers of the primitive polynomials, from the second dimension on.
const POLYNOMIALS: [(usize, u32, [u32; 3]); DIMENSIONS - 1] =
    [(1, 0, [1, 0, 0]), (2, 1, [1, 3, 0]), (3, 1, [1, 3, 1])];

/// What each bit of the index contributes, least first.
const DIRECTIONS: [[u32; BITS]; DIMENSIONS] = directions();

const fn directions() -> [[u32; BITS]; DIMENSIONS] {
    let mut all = [[0; BITS]; DIMENSIONS];
    let mut bit = 0;
    while bit < BITS {
        all[0][bit] = 1 << (BITS - 1 - bit);
        bit += 1;
    }
    let mut dimension = 1;
    while dimension < DIMENSIONS {
        let (degree, coefficients, first) = POLYNOMIALS[dimension - 1];
        let mut bit = 0;
        while bit < BITS {
            all[dimension][bit] = if bit < degree {
                first[bit] << (BITS - 1 - bit)
            } else {
                let before = all[dimension][bit - degree];
                let mut value = before ^ (before >> degree);
                let mut k = 1;
                while k < degree {
                    if coefficients >> (degree - 1 - k) & 1 == 1 {
                        value ^= all[dimension][bit - k];
                    }
                    k += 1;
                }
                value
            };
            bit += 1;
        }
        dimension += 1;
    }
    all
}

/// A scrambled sequence.
#[derive(Debug, Clone, Copy)]
pub struct Sobol4 {
    seeds: [u32; DIMENSIONS],
}

impl Sobol4 {
    /// The sequence of a seed.
    #[expect(clippy::cast_possible_truncation, reason = "halves of a hash")]
    pub fn new(seed: u64) -> Self {
        let (a, b) = (hash(seed, 0), hash(seed, 1));
        Self {
            seeds: [a as u32, (a >> 32) as u32, b as u32, (b >> 32) as u32],
        }
    }

    /// Point `index`, in [0, 1)⁴.
    pub fn point(&self, index: u32) -> [f32; DIMENSIONS] {
        let mut bits = [0_u32; DIMENSIONS];
        let mut rest = index;
        while rest != 0 {
            let bit = rest.trailing_zeros() as usize;
            for (bits, directions) in bits.iter_mut().zip(&DIRECTIONS) {
                *bits ^= directions[bit];
            }
            rest &= rest - 1;
        }
        core::array::from_fn(|d| unit(scramble(bits[d], self.seeds[d])))
    }
}

/// Flips each digit by what the digits before it and the seed say.
fn scramble(bits: u32, seed: u32) -> u32 {
    let mut x = bits.reverse_bits();
    x = x.wrapping_add(seed);
    for factor in [0x6c50_b47c, 0xb82f_1e52, 0xc7af_e638, 0x8d22_f6e6] {
        x ^= x.wrapping_mul(factor);
    }
    x.reverse_bits()
}

fn unit(bits: u32) -> f32 {
    (bits >> 8) as f32 / (1 << 24) as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "points are in [0, 1)"
    )]
    fn cell(x: f32, cells: u32) -> usize {
        (x * cells as f32) as usize
    }

    #[test]
    fn every_part_of_every_dimension_has_one_point() {
        for seed in 0..8 {
            let sequence = Sobol4::new(seed);
            for (start, count) in [(0, 64_u32), (64, 64), (1024, 1024), (192, 32)] {
                let mut seen = vec![[0; DIMENSIONS]; count as usize];
                for index in start..start + count {
                    for (d, &x) in sequence.point(index).iter().enumerate() {
                        seen[cell(x, count)][d] += 1;
                    }
                }
                assert!(
                    seen.iter().flatten().all(|&n| n == 1),
                    "{count} points from {start} on, seed {seed}"
                );
            }
        }
    }

    #[test]
    fn every_like_rectangle_has_one_point() {
        for seed in 0..8 {
            let sequence = Sobol4::new(seed);
            for columns in [1, 2, 4, 8, 16, 32, 64, 128, 256] {
                let rows = 256 / columns;
                let mut seen = vec![0; 256];
                for index in 256..512 {
                    let [x, y, ..] = sequence.point(index);
                    seen[cell(y, rows) * columns as usize + cell(x, columns)] += 1;
                }
                assert!(seen.iter().all(|&n| n == 1), "{columns} x {rows}");
            }
        }
    }

    #[test]
    fn smooth_integrals_come_out_far_better_than_by_chance() {
        // The mean of x y z w is 1/16; the standard deviation of one point is 0.093.
        let error = |count: u32| {
            let errors = (0..32).map(|seed| {
                let sequence = Sobol4::new(seed);
                let products = (0..count).map(|i| sequence.point(i).iter().product::<f32>());
                (f64::from(products.sum::<f32>()) / f64::from(count) - 0.0625).powi(2)
            });
            (errors.sum::<f64>() / 32.0).sqrt()
        };
        for count in [64, 1024] {
            let by_chance = 0.093 / f64::from(count).sqrt();
            let found = error(count);
            assert!(
                found < 0.25 * by_chance,
                "{count} points: {found:.2e}, by chance {by_chance:.2e}"
            );
        }
    }
}
