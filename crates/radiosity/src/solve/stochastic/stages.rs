//! What the stages of the work cost.

use core::ops::Add;
use core::time::Duration;

/// What a stage of the work has cost so far.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Stage {
    /// Rays that were cast.
    pub rays: u64,
    /// Time spent.
    pub time: Duration,
}

impl Stage {
    /// Rays a second; 0 where no time was spent.
    pub fn rate(self) -> f64 {
        let seconds = self.time.as_secs_f64();
        if seconds > 0.0 {
            self.rays as f64 / seconds
        } else {
            0.0
        }
    }
}

impl Add for Stage {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self {
            rays: self.rays + other.rays,
            time: self.time + other.time,
        }
    }
}

/// What the stages have cost so far.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Stages {
    /// Shadow rays to emitters.
    pub direct: Stage,
    /// Rays that shoot what is unshot.
    pub spreading: Stage,
    /// Rays that gather.
    pub gathering: Stage,
}

impl Stages {
    /// With their names, in the order of the work.
    pub fn named(self) -> [(&'static str, Stage); 3] {
        [
            ("direct", self.direct),
            ("spreading", self.spreading),
            ("gathering", self.gathering),
        ]
    }

    /// Rays of all stages.
    pub fn rays(self) -> u64 {
        self.named().into_iter().map(|(_, stage)| stage.rays).sum()
    }
}

impl Add for Stages {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self {
            direct: self.direct + other.direct,
            spreading: self.spreading + other.spreading,
            gathering: self.gathering + other.gathering,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rates_are_of_all_the_work() {
        let stage = |rays, seconds| Stage {
            rays,
            time: Duration::from_secs(seconds),
        };
        let sum = stage(300, 1) + stage(100, 3);
        assert_eq!(sum.rate(), 100.0, "400 rays in 4 seconds");
        assert_eq!(Stage::default().rate(), 0.0, "no time");
        let stages = Stages {
            direct: stage(1, 1),
            spreading: stage(2, 1),
            gathering: stage(4, 1),
        };
        assert_eq!((stages + stages).rays(), 14, "all of them, twice");
    }
}
