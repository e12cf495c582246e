//! What elements of a patch say of each other's reflected light (shrinkage towards a mean: Stein 1956; Efron, Morris 1975).
//!
//! Each element gathers by rays of its own, few where there are many elements. Light that surfaces at a distance `R` send
//! to a patch of radius `r` differs over it by some `r / R` of itself (the split sphere of Ward, Rubinstein, Clear 1988),
//! with `R` the harmonic mean of the distances that rays found. So the others' word is worth
//!
//! ```text
//! p = WORTH (R / r)²
//! ```
//!
//! rays to an element, but no more than they had themselves, and less where estimates differ from what is said of them by
//! more than both explain: in the open a patch is as good as one receiver, under a seat or in the gap between two bodies
//! every element sees for itself. An estimate of `n` rays moves by `p / (n + p)` of the way to the light of its patch, so
//! that with more rays nothing is left of what the patch says, and of its error.

use super::emitters::place_of;
use super::estimates::Estimates;
use super::interpolate::Interpolation;
use crate::patch::PatchMesh;
use rayon::prelude::*;

/// Rays that the word of a patch is worth where other surfaces are as far off as it is large. In the theatre 30 leaves a
/// tenth less error than 8 in the open and a little more close to other surfaces; 1 hardly helps.
const WORTH: f64 = 16.0;
/// Worth of a word where nothing is around.
const MOST_WORTH: f64 = 1e9;
/// Elements for which that counts when the patch's own are asked how much they differ.
const FORESEEN: f64 = 4.0;
/// Least factor by which they may find that they differ less.
const LEAST_EXCESS: f64 = 0.25;

/// How the elements' estimates of one kind of light are joined with those around them.
#[derive(Debug, Clone, Default)]
pub(super) struct Shrinkage {
    /// What the elements count for in the light of their patches.
    weights: Vec<f32>,
    /// Which part of the way to the light of its patch each goes.
    pulls: Vec<f32>,
    /// What is left of each squared error.
    left: Vec<f32>,
}

/// What elements know of one kind of light.
#[derive(Clone, Copy)]
pub(super) struct Known<'a> {
    pub(super) estimates: &'a Estimates,
    /// Irradiance by them, summed over channels.
    pub(super) light: &'a [f32],
    /// Sums of the inverse distances that rays met surfaces at, and how many rays those were.
    pub(super) nearness: (&'a [f32], &'a [u32]),
}

impl Shrinkage {
    pub(super) fn new(mesh: &PatchMesh, interpolation: &Interpolation, known: Known<'_>) -> Self {
        let foreseen: Vec<Vec<Word>> = (0..mesh.patches().len())
            .into_par_iter()
            .map(|patch| known.words(mesh, patch))
            .collect();
        let shrinkage = Self {
            weights: foreseen.iter().flatten().map(Word::weight).collect(),
            ..Self::default()
        };
        let mut said = vec![0.0; known.light.len()];
        let patches = shrinkage.of_patches(mesh, known.light);
        interpolation.to_elements(mesh, &patches, &mut said);
        let joined: Vec<Vec<[f32; 3]>> = foreseen
            .into_par_iter()
            .enumerate()
            .map(|(patch, mut words)| {
                let excess = known.excess(mesh, patch, &words, &said);
                words.iter_mut().for_each(|word| word.worth /= excess);
                join(&words)
            })
            .collect();
        let column = |i: usize| joined.iter().flatten().map(|row| row[i]).collect();
        Self {
            weights: column(0),
            pulls: column(1),
            left: column(2),
        }
    }

    /// What is left of an element's squared error; all of it as long as nothing is joined.
    pub(super) fn left(&self, element: usize) -> f64 {
        self.left.get(element).map_or(1.0, |&left| f64::from(left))
    }

    /// Light of the patches by that of their elements.
    pub(super) fn of_patches(&self, mesh: &PatchMesh, elements: &[f32]) -> Vec<f32> {
        let patches = (0..mesh.patches().len()).into_par_iter();
        let mean = |patch: usize| {
            let (mut sum, mut weights) = (0.0, 0.0);
            for e in mesh.elements_of_patch(patch) {
                let weight = f64::from(self.weights[e]);
                sum += weight * f64::from(elements[e]);
                weights += weight;
            }
            if weights > 0.0 {
                super::to_f32(sum / weights)
            } else {
                0.0
            }
        };
        patches.map(mean).collect()
    }

    /// Moves the elements' light towards what their patches say of them.
    pub(super) fn pull(&self, elements: &mut [f32], said: &[f32]) {
        let pairs = elements.par_iter_mut().zip(said).zip(&self.pulls);
        pairs.for_each(|((value, said), pull)| *value += pull * (said - *value));
    }
}

impl Known<'_> {
    /// What the elements of a patch have, and what is foreseen of what others say of them.
    fn words(&self, mesh: &PatchMesh, patch: usize) -> Vec<Word> {
        let radius = f64::from(place_of(mesh, mesh.patches()[patch]).radius);
        let (sums, counts) = self.nearness;
        let word = |e: usize| {
            let nearness = f64::from(sums[e]) / f64::from(counts[e].max(1));
            Word {
                rays: f64::from(self.estimates.rays()[e]),
                worth: (WORTH / (radius * nearness).powi(2)).min(MOST_WORTH),
            }
        };
        mesh.elements_of_patch(patch).map(word).collect()
    }

    /// By how much the variance is larger than foreseen by which elements differ from what is said of them. What is foreseen
    /// counts as much as [`FORESEEN`] elements.
    fn excess(&self, mesh: &PatchMesh, patch: usize, words: &[Word], said: &[f32]) -> f64 {
        let elements = mesh.elements_of_patch(patch);
        let square = |e: usize| self.estimates.square(e);
        let rays: f64 = words.iter().map(|word| word.rays).sum();
        let squares = words.iter().zip(elements.clone());
        let of_ray = squares
            .map(|(word, e)| word.rays.powi(2) * square(e))
            .sum::<f64>()
            / rays;
        let (mut found, mut foreseen) = (0.0, 0.0);
        for (word, e) in words.iter().zip(elements) {
            let weight = f64::from(word.weight());
            let difference = f64::from(self.light[e] - said[e]);
            found += weight * (difference.powi(2) - square(e));
            foreseen += weight * of_ray / word.worth;
        }
        let prior = foreseen * FORESEEN / words.len() as f64;
        let excess = (found + prior) / (foreseen + prior);
        if excess.is_finite() {
            excess.clamp(LEAST_EXCESS, MOST_WORTH)
        } else {
            1.0
        }
    }
}

/// Rays of an element, and rays that a word on it is worth.
#[derive(Debug, Clone, Copy)]
struct Word {
    rays: f64,
    worth: f64,
}

impl Word {
    /// Rays of a mean of many of which an estimate is as good.
    fn weight(&self) -> f32 {
        let sum = (self.rays + self.worth).max(f64::MIN_POSITIVE);
        super::to_f32(self.rays * self.worth / sum)
    }
}

/// For the elements of a patch: weights, pulls and what is left of squared errors.
///
/// An element's light as the word of the others has the variance of their mean and that by which it differs from them,
/// all in units of a ray's variance. The mean over all has its own estimate in it, of which the pull is freed.
fn join(words: &[Word]) -> Vec<[f32; 3]> {
    let total: f64 = words.iter().map(|word| f64::from(word.weight())).sum();
    words
        .iter()
        .map(|word| {
            let own = f64::from(word.weight());
            let others = total - own;
            if others <= 1e-6 * total {
                return [own, 0.0, 1.0];
            }
            let said = word.worth * others / (word.worth + others);
            let pull = said * total / (others * (word.rays + said));
            [own, pull.min(1.0), word.rays / (word.rays + said)]
        })
        .map(|row| row.map(super::to_f32))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::super::to_f32;
    use super::*;

    fn words(known: &[(f64, f64)]) -> Vec<Word> {
        let word = |&(rays, worth): &(f64, f64)| Word { rays, worth };
        known.iter().map(word).collect()
    }

    #[test]
    fn in_the_open_a_patch_is_one_receiver() {
        let known = words(&[(16.0, 1e9), (48.0, 1e9)]);
        for (row, word) in join(&known).iter().zip(&known) {
            let rays = to_f32(word.rays);
            assert!(
                (row[0] / rays - 1.0).abs() < 1e-5,
                "each ray counts: {row:?}"
            );
            assert!((row[1] - 1.0).abs() < 1e-5, "all say the same: {row:?}");
            assert!((row[2] - rays / 64.0).abs() < 1e-5, "by 64 rays: {row:?}");
        }
    }

    #[test]
    fn what_is_close_to_others_sees_for_itself() {
        let joined = join(&words(&[(16.0, 1e-3), (16.0, 100.0), (16.0, 100.0)]));
        let [close, open, _] = joined[..] else {
            panic!("three elements");
        };
        assert!(close[..2].iter().all(|&x| x < 1e-3), "{close:?}");
        assert!(close[2] > 0.999, "nothing is gained: {close:?}");
        // The mean of the other open one and the close one is as good as so many rays, what it says of this one as `said`.
        let others = 1600.0 / 116.0 + 1e-3;
        let said = 100.0 * others / (100.0 + others);
        let left = to_f32(16.0 / (16.0 + said));
        assert!((open[2] - left).abs() < 1e-3, "{open:?} for {left}");
    }

    #[test]
    fn with_more_rays_less_is_left_of_the_word_of_others() {
        let pull = |rays: f64| join(&words(&[(rays, 4.0), (rays, 4.0)]))[0][1];
        assert!(
            pull(16.0) > 4.0 * pull(128.0),
            "{} and {}",
            pull(16.0),
            pull(128.0)
        );
        let alone = join(&words(&[(64.0, 4.0)]));
        assert_eq!(alone[0][1..], [0.0, 1.0], "there are no others");
        let nothing = join(&words(&[(0.0, 4.0), (0.0, 4.0)]));
        assert!(
            nothing.iter().flatten().all(|x| x.is_finite()),
            "{nothing:?}"
        );
    }
}
