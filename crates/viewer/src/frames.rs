//! How long frames take.

use core::fmt;
use std::time::{Duration, Instant};

/// Frames that are remembered.
const REMEMBERED: usize = 240;

/// Times between frames that follow each other without a pause.
#[derive(Debug, Default)]
pub struct FrameTimes {
    times: Vec<Duration>,
    next: usize,
    last: Option<Instant>,
    /// Whether all of them are remembered, for a report at the end.
    keeps_all: bool,
}

impl FrameTimes {
    /// Remembers all times, not only the last ones.
    pub fn of_all() -> Self {
        Self {
            keeps_all: true,
            ..Self::default()
        }
    }

    /// A frame begins; `follows` tells whether it was asked for right after the one before.
    pub fn tick(&mut self, follows: bool) {
        let now = Instant::now();
        if let Some(last) = self.last.replace(now).filter(|_| follows) {
            self.push(now - last);
        }
    }

    /// Adds a time.
    pub fn push(&mut self, time: Duration) {
        if self.keeps_all || self.times.len() < REMEMBERED {
            self.times.push(time);
        } else {
            self.times[self.next] = time;
            self.next = (self.next + 1) % REMEMBERED;
        }
    }

    /// Mean of the last ones; `None` before there are so many.
    pub fn recent(&self, count: usize) -> Option<Duration> {
        if count == 0 || self.times.len() < count {
            return None;
        }
        // Until the memory is full the newest is the last.
        let end = if self.times.len() < REMEMBERED || self.keeps_all {
            self.times.len()
        } else {
            self.next + self.times.len()
        };
        let at = |i: usize| self.times[i % self.times.len()];
        let total: Duration = (end - count..end).map(at).sum();
        Some(total / u32::try_from(count).unwrap_or(u32::MAX))
    }

    /// Mean, percentiles, most; `None` before two frames.
    pub fn report(&self) -> Option<FrameReport> {
        let mut sorted = self.times.clone();
        sorted.sort_unstable();
        let total: Duration = sorted.iter().sum();
        let at = |percent: usize| sorted.get((sorted.len() - 1) * percent / 100).copied();
        if sorted.is_empty() {
            return None;
        }
        Some(FrameReport {
            frames: sorted.len(),
            mean: total / u32::try_from(sorted.len()).unwrap_or(u32::MAX),
            median: at(50)?,
            p95: at(95)?,
            p99: at(99)?,
            longest: at(100)?,
        })
    }
}

/// What frames took.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FrameReport {
    /// Frames that were counted.
    pub frames: usize,
    /// Mean time.
    pub mean: Duration,
    /// Half of the frames took no longer.
    pub median: Duration,
    /// 95 of 100 took no longer.
    pub p95: Duration,
    /// 99 of 100 took no longer.
    pub p99: Duration,
    /// The longest.
    pub longest: Duration,
}

impl fmt::Display for FrameReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let ms = |time: Duration| 1e3 * time.as_secs_f64();
        write!(
            f,
            "{} frames, {:.1} a second: mean {:.1} ms, median {:.1}, 95 % {:.1}, 99 % {:.1}, longest {:.1}",
            self.frames,
            1.0 / self.mean.as_secs_f64().max(1e-9),
            ms(self.mean),
            ms(self.median),
            ms(self.p95),
            ms(self.p99),
            ms(self.longest)
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn percentiles_of_known_times() {
        let mut frames = FrameTimes::default();
        assert_eq!(frames.report(), None, "no frames yet");
        for i in 1..=100 {
            frames.push(Duration::from_millis(i));
        }
        let report = frames.report().expect("a hundred");
        assert_eq!(report.median, Duration::from_millis(50), "{report}");
        assert_eq!(report.p95, Duration::from_millis(95), "{report}");
        assert_eq!(report.longest, Duration::from_millis(100), "{report}");
        assert!(
            report.to_string().starts_with("100 frames, 19.8 a second"),
            "{report}"
        );
    }

    #[test]
    fn the_last_ones_are_known() {
        let mut frames = FrameTimes::default();
        for i in 1..=1000_u64 {
            frames.push(Duration::from_millis(i));
            let mean = Duration::from_micros(1000 * i - 500);
            let recent = frames.recent(2);
            assert_eq!(recent, (i > 1).then_some(mean), "of {i} and the one before");
        }
        assert_eq!(frames.recent(0), None, "of nothing");
    }

    #[test]
    fn only_the_last_are_remembered() {
        let mut frames = FrameTimes::default();
        for i in 0..10_000 {
            frames.push(Duration::from_millis(i));
        }
        assert_eq!(frames.times.len(), REMEMBERED, "memory is bounded");
        let report = frames.report().expect("many");
        assert!(report.median > Duration::from_millis(9_700), "{report}");
    }
}
