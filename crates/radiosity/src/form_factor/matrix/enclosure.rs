//! Corrected factors of enclosures: rows that sum to 1, and pairs that agree.

use super::{ViewFactorMatrix, ratio, to_f32};
use rayon::prelude::*;

/// Share of a row that an enclosure without an opening may lose through its seams.
pub const SEAM: f64 = 1e-3;

/// How much a correction changed factors.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Change {
    /// The largest change of a factor.
    pub largest: f64,
    /// Row of that factor.
    pub row: usize,
    /// Column of that factor.
    pub column: usize,
    /// Root of the mean squared change over the factors that are not zero.
    pub rms: f64,
    /// The largest change of a row's share of the sky.
    pub sky: f64,
}

impl ViewFactorMatrix {
    /// How far these factors are from those that they were made of by [`Self::enclosure_corrected`].
    ///
    /// # Panics
    /// If the matrices have different sizes.
    pub fn change_from(&self, before: &Self) -> Change {
        assert!(
            self.size() == before.size(),
            "{} rows are no correction of {}",
            self.size(),
            before.size()
        );
        let (mut largest, mut at, mut squares, mut count) = (0.0, [0, 0], 0.0, 0_usize);
        for row in 0..self.size() {
            // A correction adds entries where only the mirror image was there, and takes none away.
            for (column, f) in self.entries.row(row) {
                let was = before.entries.get(row, column);
                let change = (f64::from(f) - f64::from(was)).abs();
                count += usize::from(f != 0.0 || was != 0.0);
                squares += change * change;
                if change > largest {
                    (largest, at) = (change, [row, column]);
                }
            }
        }
        let sky = self.sky.iter().zip(&before.sky);
        Change {
            largest,
            row: at[0],
            column: at[1],
            rms: ratio(squares, count as f64).sqrt(),
            sky: sky.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max),
        }
    }

    /// The nearest factors that obey both closure and reciprocity.
    ///
    /// Works on exchange areas `X_ij = A_i F_ij`, first made symmetric by the mean of both sides, then changed by the
    /// least weighted squares `Σ ΔX_ij² / X_ij` such that all rows close (after Larsen and Howell 1986; the weights are
    /// those of sampled factors, whose variance grows with the factor). With multipliers λ of the rows that is
    /// `X_ij (1 + λ_i + λ_j)`, for the sky `S_i (1 + λ_i)`: zeros stay zero. What became negative is set to zero and all
    /// of it repeated. Absorbed and transmitted shares are kept.
    ///
    /// A share of the sky up to [`SEAM`] is what slips through seams, or the method's error, and goes to the surfaces:
    /// without any opening rows then sum to 1 without the sky, as thermal models want it. More than that is an opening;
    /// it stays in the sky's column, as little changed as a factor.
    ///
    /// Some enclosures have no such factors (two plates of different size and nothing else): the result is then
    /// reciprocal and as near to closed as the iteration came; `closure_error` tells. It takes the memory of three
    /// matrices while it works.
    pub fn enclosure_corrected(&self) -> Self {
        const ROUNDS: usize = 30;
        let mut corrected = self.clone();
        corrected.entries = self.entries.symmetrised(&self.areas);
        for sky in corrected.sky.iter_mut().filter(|sky| **sky <= SEAM) {
            *sky = 0.0;
        }
        let mut best = corrected.clone();
        for _ in 0..ROUNDS {
            let lambda = corrected.multipliers();
            corrected.entries = corrected.entries.map(|i, j, f| {
                if self.areas[i] > 0.0 {
                    to_f32((f64::from(f) * (1.0 + lambda[i] + lambda[j])).max(0.0))
                } else {
                    f
                }
            });
            for (sky, lambda) in corrected.sky.iter_mut().zip(&lambda) {
                *sky = (*sky * (1.0 + lambda)).max(0.0);
            }
            let (error, least) = (corrected.closure_error(), best.closure_error());
            if error.is_nan() || error >= least {
                break;
            }
            best = corrected.clone();
            // Beyond it only the rounding of f32 is left.
            if error < 1e-7 {
                break;
            }
        }
        best
    }

    /// Solves `(Σ_j X_ij + S_i) λ_i + Σ_j X_ij λ_j = A_i (1 - row sum)` by conjugate gradients, preconditioned by
    /// the diagonal; only semi-definite where two groups of patches see nothing but each other, which is no harm.
    fn multipliers(&self) -> Vec<f64> {
        let n = self.size();
        let diagonal: Vec<f64> = (0..n)
            .map(|i| {
                let row: f64 = self.entries.row(i).map(|(_, f)| f64::from(f)).sum();
                self.areas[i] * (row + self.sky[i])
            })
            .collect();
        let apply = |x: &[f64]| -> Vec<f64> {
            let row = |i: usize| diagonal[i] * x[i] + self.areas[i] * self.entries.dot(i, x);
            (0..n).into_par_iter().map(row).collect()
        };
        let precondition = |r: &[f64]| -> Vec<f64> {
            r.iter()
                .zip(&diagonal)
                .map(|(&r, &d)| ratio(r, d))
                .collect()
        };
        let mut x = vec![0.0; n];
        let mut r: Vec<f64> = (0..n)
            .map(|i| self.areas[i] * (1.0 - self.row_sum(i)))
            .collect();
        let mut z = precondition(&r);
        let mut direction = z.clone();
        let mut rz = dot(&r, &z);
        let enough = rz * 1e-24;
        for _ in 0..(2 * n).max(10) {
            let image = apply(&direction);
            let curvature = dot(&direction, &image);
            if rz <= enough || curvature <= 0.0 {
                break;
            }
            let step = rz / curvature;
            for i in 0..n {
                x[i] += step * direction[i];
                r[i] -= step * image[i];
            }
            z = precondition(&r);
            let next = dot(&r, &z);
            let keep = next / rz;
            rz = next;
            for i in 0..n {
                direction[i] = z[i] + keep * direction[i];
            }
        }
        x
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A cube with each entry off by up to 5 %, in a fixed pattern.
    fn noisy_cube(open: f64) -> ViewFactorMatrix {
        let exact = |i: usize, j: usize| match (i, j) {
            _ if i == j => 0.0,
            _ if i / 2 == j / 2 => 0.199_824_895_7,
            _ => 0.200_043_776_1,
        };
        let noise = |k: usize| 1.0 + 0.05 * ((k * 7919 % 101) as f64 / 50.5 - 1.0);
        let factors: Vec<f64> = (0..36)
            .map(|k| exact(k / 6, k % 6) * noise(k) * (1.0 - open))
            .collect();
        let names = (0..6).map(|i| format!("face {i}")).collect();
        let mut matrix =
            ViewFactorMatrix::from_rows(vec![1.0; 6], names, &factors).expect("a matrix");
        matrix.sky = vec![open; 6];
        matrix
    }

    #[test]
    fn correction_closes_noisy_matrices_and_keeps_reciprocity() {
        for open in [0.0, 0.3] {
            let noisy = noisy_cube(open);
            assert!(noisy.closure_error() > 1e-3, "it is noisy");
            assert!(noisy.reciprocity_error().error > 1e-3, "it is noisy");
            let corrected = noisy.enclosure_corrected();
            let (closure, reciprocity) = (
                corrected.closure_error(),
                corrected.reciprocity_error().error,
            );
            assert!(closure < 1e-6, "closure {closure:e} with sky {open}");
            assert!(
                reciprocity < 1e-6,
                "reciprocity {reciprocity:e} with sky {open}"
            );
            corrected.check(1e-6).expect("factors are possible");
            let changes: Vec<f64> = (0..36)
                .map(|k| {
                    f64::from(corrected.get(k / 6, k % 6)) - f64::from(noisy.get(k / 6, k % 6))
                })
                .collect();
            let most = changes.iter().fold(0.0_f64, |most, c| most.max(c.abs()));
            assert!(most < 0.03, "entries change no more than their noise");
            let told = corrected.change_from(&noisy);
            assert_eq!(told.largest, most, "the largest change");
            let there = f64::from(corrected.get(told.row, told.column));
            let was = f64::from(noisy.get(told.row, told.column));
            assert_eq!((there - was).abs(), most, "and where it is");
            // The diagonal is zero and stays so.
            let rms = (changes.iter().map(|c| c * c).sum::<f64>() / 30.0).sqrt();
            assert!(
                (told.rms - rms).abs() < 1e-12,
                "RMS {}, not {rms}",
                told.rms
            );
            assert_eq!(
                told.sky > 0.0,
                open > 0.0,
                "the sky's column is changed if there is one"
            );
        }
    }

    #[test]
    fn what_slips_through_seams_goes_to_the_surfaces() {
        let mut leaky = noisy_cube(0.0);
        leaky.sky = vec![SEAM; 6];
        leaky.sky[5] = 0.2;
        let corrected = leaky.enclosure_corrected();
        assert_eq!(corrected.sky[..5], [0.0; 5], "seams are closed");
        assert!(
            corrected.sky[5] > 0.15,
            "an opening stays open: {:?}",
            corrected.sky
        );
        assert!(corrected.closure_error() < 1e-6, "rows sum to 1");
    }

    fn two_plates(areas: [f64; 2], there: f64, back: f64) -> ViewFactorMatrix {
        let names = vec!["a".into(), "b".into()];
        let mut plates =
            ViewFactorMatrix::from_rows(areas.to_vec(), names, &[0.0, there, back, 0.0])
                .expect("a matrix");
        plates.sky = vec![0.0; 2];
        plates
    }

    #[test]
    fn correction_of_two_facing_plates() {
        // Only the sum of both multipliers is determined.
        let equal = two_plates([2.0, 2.0], 0.9, 0.8).enclosure_corrected();
        assert!(equal.closure_error() < 1e-6, "each sees but the other");
        // A larger plate cannot send everything to a smaller one that sends everything back.
        let unequal = two_plates([1.0, 2.0], 1.0, 0.5).enclosure_corrected();
        assert!(
            unequal.reciprocity_error().error < 1e-6,
            "reciprocity is kept"
        );
        let closure = unequal.closure_error();
        assert!(
            closure > 0.1 && closure <= 0.5 + 1e-6,
            "what cannot close is told and not made worse: {closure}"
        );
    }
}
