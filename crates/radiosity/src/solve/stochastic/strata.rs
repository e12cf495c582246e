//! Rays shared out among parts, and what they say of their error.

/// Rays to a part of the coarse cut.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Stratum {
    pub(super) part: usize,
    pub(super) rays: u32,
    /// Rays by which each of its rays counts: all of them where some were sure to be cast, else their probability.
    pub(super) expected_rays: f32,
    /// Standard deviation that one ray alone is thought to have.
    pub(super) deviation: f32,
}

/// What the rays of a receiver say of the error of their mean.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Spread {
    /// Squared standard error that is known.
    pub(super) square: f32,
    /// Squared deviations, as thought, of parts of one ray.
    pub(super) singles: f32,
    /// Squared deviations of parts of several rays: as found, and as thought.
    pub(super) deviations: [f32; 2],
}

impl Spread {
    /// By what each ray brought, stratum by stratum; its mean is over all numbers, also those of no ray.
    ///
    /// Several rays to a part tell its error by their differences. Rays to parts that had one by chance tell theirs
    /// together, by the differences of neighbours: they follow each other by what they are near to.
    pub(super) fn of(numbers: &[f32], strata: &[Stratum]) -> Self {
        let n = numbers.len().max(1) as f32;
        let mut spread = Self::default();
        let mut by_chance = Neighbours::default();
        let mut rest = numbers;
        for stratum in strata {
            let (numbers, others) = rest.split_at((stratum.rays as usize).min(rest.len()));
            rest = others;
            let thought = stratum.deviation.powi(2);
            match *numbers {
                [number] if stratum.expected_rays < 1.0 => by_chance.add(number),
                [_] => spread.singles += thought,
                _ => {
                    let rays = numbers.len() as f32;
                    let variance = variance(numbers);
                    spread.square += rays * variance / (n * n);
                    spread.deviations[0] += variance * (rays / n).powi(2);
                    spread.deviations[1] += thought;
                }
            }
        }
        spread.square += by_chance.square() / (n * n);
        spread
    }
}

/// Of two numbers or more, by the differences of those that follow each other: they were drawn from equal parts of what
/// they may be, in its order, which takes out of their mean what differs from one end of it to the other.
fn variance(numbers: &[f32]) -> f32 {
    let pairs = numbers.windows(2);
    let differences: f32 = pairs.map(|pair| (pair[0] - pair[1]).powi(2)).sum();
    0.5 * differences / (numbers.len() as f32 - 1.0).max(1.0)
}

/// Numbers that follow each other.
#[derive(Default)]
struct Neighbours {
    last: f32,
    count: u16,
    /// Sum of the squared differences.
    differences: f32,
}

impl Neighbours {
    fn add(&mut self, number: f32) {
        if self.count > 0 {
            self.differences += (number - self.last).powi(2);
        }
        self.last = number;
        self.count += 1;
    }

    /// Squared standard error of their sum; of one alone its square.
    fn square(&self) -> f32 {
        let n = f32::from(self.count);
        if self.count == 1 {
            return self.last.powi(2);
        }
        0.5 * self.differences * n / (n - 1.0).max(1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stratum(rays: u32, expected_rays: f32) -> Stratum {
        Stratum {
            part: 0,
            rays,
            expected_rays,
            deviation: 2.0,
        }
    }

    #[test]
    fn parts_of_several_rays_tell_their_error() {
        // Each of four rays differs by 2 from the next.
        let spread = Spread::of(
            &[1.0, 3.0, 1.0, 3.0, 7.0, 7.0, 7.0, 7.0],
            &[stratum(4, 4.0), stratum(4, 4.0)],
        );
        let variance = 0.5 * 4.0;
        assert!(
            (spread.square - 4.0 * variance / 64.0).abs() < 1e-6,
            "{spread:?}"
        );
        assert_eq!(spread.deviations[1], 8.0, "two parts were thought of");
        assert_eq!(spread.singles, 0.0, "none has one ray");
        let rising = Spread::of(&[0.0, 1.0, 2.0, 3.0], &[stratum(4, 4.0)]);
        assert_eq!(rising.square, 4.0 * 0.5 / 16.0, "less, if it rises evenly");
    }

    #[test]
    fn a_single_ray_says_nothing_and_the_same_by_chance_nothing_but_that() {
        let sure = Spread::of(&[5.0, 5.0], &[stratum(1, 1.0), stratum(1, 1.0)]);
        assert_eq!((sure.square, sure.singles), (0.0, 8.0), "two of one ray");
        let chance = [stratum(1, 0.25), stratum(1, 0.5), stratum(1, 0.5)];
        let same = Spread::of(&[5.0, 5.0, 5.0], &chance);
        assert_eq!(
            same.square, 0.0,
            "it does not matter which part had its ray"
        );
        let alone = Spread::of(&[5.0, 0.0, 0.0], &chance[..1]);
        assert_eq!(alone.square, 25.0 / 9.0, "all or nothing");
        let mixed = Spread::of(&[4.0, 0.0, 4.0], &chance);
        assert_eq!(mixed.square, 0.5 * 32.0 * 1.5 / 9.0, "by differences");
        assert_eq!(Spread::of(&[], &[]), Spread::default(), "no rays");
    }
}
