//! How the light came along.

/// The state at one time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Moment {
    /// Seconds of solving so far.
    pub seconds: f64,
    /// Steps so far.
    pub steps: u64,
    /// Unshot share of the emitted flux.
    pub unshot: f64,
    /// Relative error against the finished light, where that is known.
    pub error: Option<f64>,
    /// What can be said of the error before that: the share of light that the ambient estimate says is still to come, or
    /// the noise of rays. `None` for methods on a matrix.
    pub estimate: Option<f64>,
}

/// Moments of which at most [`Self::MOST`] are kept: when they are too many, every second one goes and only every second of
/// those to come is taken.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct History {
    moments: Vec<Moment>,
    /// Moments that are skipped between two that are kept.
    skip: u32,
    skipped: u32,
}

impl History {
    /// Most moments that are kept.
    pub const MOST: usize = 512;

    /// Adds a moment.
    pub fn push(&mut self, moment: Moment) {
        if self.skipped < self.skip {
            self.skipped += 1;
            return;
        }
        self.skipped = 0;
        self.moments.push(moment);
        if self.moments.len() > Self::MOST {
            let mut keep = false;
            self.moments.retain(|_| {
                keep = !keep;
                keep
            });
            self.skip = self.skip * 2 + 1;
        }
    }

    /// All that were kept, in order.
    pub fn moments(&self) -> &[Moment] {
        &self.moments
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_thins_out_and_stays_in_order() {
        let mut history = History::default();
        for i in 0..100_000_u32 {
            history.push(Moment {
                seconds: f64::from(i),
                steps: u64::from(i),
                unshot: 0.0,
                error: None,
                estimate: None,
            });
        }
        let moments = history.moments();
        assert!(
            (200..=History::MOST).contains(&moments.len()),
            "{}",
            moments.len()
        );
        assert!(
            moments.is_sorted_by(|a, b| a.seconds < b.seconds),
            "in order"
        );
        assert_eq!(moments[0].steps, 0, "the first is kept");
        assert!(
            moments.last().is_some_and(|m| m.steps > 99_000),
            "and a late one"
        );
        let gaps: Vec<u64> = moments
            .windows(2)
            .map(|w| w[1].steps - w[0].steps)
            .collect();
        let (low, high) = (gaps.iter().min(), gaps.iter().max());
        assert!(
            low.zip(high).is_some_and(|(l, h)| *h <= 3 * l),
            "evenly: {low:?} {high:?}"
        );
    }
}
