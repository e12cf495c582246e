//! How long steps are where a window draws on the same device.
//!
//! A queue does one thing after the other: pictures wait behind steps, and steps behind pictures. What counts is how long
//! a step itself keeps the device, not how long somebody waits for it, so the device's own clock is asked where it has
//! one. Two steps are under way at a time: while one is read, the device has the next. Where a single hemicube takes longer
//! than a step may, pictures would wait for two of those; then there is one at a time.

use crate::buffer::empty;
use crate::context::Context;
pub(super) use hemicube_shaders::memory::{CLOCK_BYTES, STEPS_UNDER_WAY as UNDER_WAY};
use std::time::{Duration, Instant};
use wgpu::{
    Buffer, BufferUsages, CommandEncoder, ComputePassTimestampWrites, Features, QuerySet, QueryType,
};

/// Most hemicubes of a step.
pub(super) const MOST_HEMICUBES: u32 = 32;

/// A step of one hemicube that takes so many times as long as it may is alone under way.
const TOO_LONG: f64 = 1.5;

/// How long steps may be, and how many hemicubes they have therefore.
#[derive(Debug)]
pub(super) struct Pace {
    /// How long a step may keep the device.
    step_time: Duration,
    pub(super) hemicubes: u32,
    /// Steps that stay under way when one has been submitted.
    pub(super) keeps: usize,
    /// The device's clock.
    pub(super) clock: Option<Clock>,
    /// When the last step was seen to be done.
    seen: Option<Instant>,
}

impl Pace {
    /// The first step has one hemicube.
    pub(super) fn new(context: &Context, step_time: Duration) -> Self {
        Self {
            step_time,
            hemicubes: 1,
            keeps: 0,
            clock: Clock::new(context),
            seen: None,
        }
    }

    /// A step of so many hemicubes is done, which was submitted then; `clock` is what the device's clock says of it.
    ///
    /// Without such a clock it is taken to have begun when it was submitted, or when the one before it was done: pictures
    /// in between count, too.
    pub(super) fn note(&mut self, hemicubes: u32, submitted: Instant, clock: Option<Duration>) {
        let now = Instant::now();
        let begin = self.seen.map_or(submitted, |seen| seen.max(submitted));
        let took = clock.unwrap_or(now - begin);
        self.hemicubes = paced(hemicubes, took, self.step_time);
        self.keeps = kept(self.hemicubes, took, self.step_time);
        self.seen = Some(now);
    }
}

/// Hemicubes of the next step, if so many took so long and a step is to take `wanted`. It grows to twice as many at most:
/// one step may have been quick because others left the device alone.
fn paced(hemicubes: u32, took: Duration, wanted: Duration) -> u32 {
    let fits = wanted.as_secs_f64() / took.as_secs_f64().max(1e-6);
    let next = f64::from(hemicubes) * fits.min(2.0);
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "between 1 and 32"
    )]
    let next = next.clamp(1.0, f64::from(MOST_HEMICUBES)) as u32;
    next
}

/// Steps that stay under way, if the next has so many hemicubes and the last took so long.
fn kept(next: u32, took: Duration, wanted: Duration) -> usize {
    let is_too_long = next == 1 && took.as_secs_f64() > TOO_LONG * wanted.as_secs_f64();
    if is_too_long { 0 } else { UNDER_WAY - 1 }
}

/// The device's clock, read when a step begins and when it ends.
#[derive(Debug)]
pub(super) struct Clock {
    queries: QuerySet,
    /// Nanoseconds of a tick.
    period: f64,
    resolved: Buffer,
}

impl Clock {
    /// The clock of a device that has one.
    fn new(context: &Context) -> Option<Self> {
        let device = &context.device;
        let has_clock = device.features().contains(Features::TIMESTAMP_QUERY);
        has_clock.then(|| Self {
            queries: device.create_query_set(&wgpu::QuerySetDescriptor {
                label: Some("step"),
                ty: QueryType::Timestamp,
                count: 2,
            }),
            period: f64::from(context.queue.get_timestamp_period()),
            resolved: empty(
                device,
                "times of a step",
                CLOCK_BYTES,
                BufferUsages::QUERY_RESOLVE | BufferUsages::COPY_SRC,
            ),
        })
    }

    /// Read when a pass begins, which is the first of a step.
    pub(super) fn at_begin(&self) -> ComputePassTimestampWrites<'_> {
        ComputePassTimestampWrites {
            query_set: &self.queries,
            beginning_of_pass_write_index: Some(0),
            end_of_pass_write_index: None,
        }
    }

    /// Read when a pass ends, which is the last of a step.
    pub(super) fn at_end(&self) -> ComputePassTimestampWrites<'_> {
        ComputePassTimestampWrites {
            query_set: &self.queries,
            beginning_of_pass_write_index: None,
            end_of_pass_write_index: Some(1),
        }
    }

    /// Copies both readings to a place in a buffer; returns their bytes.
    pub(super) fn copy(&self, encoder: &mut CommandEncoder, to: &Buffer, at: u64) -> u64 {
        encoder.resolve_query_set(&self.queries, 0..2, &self.resolved, 0);
        encoder.copy_buffer_to_buffer(&self.resolved, 0, to, at, CLOCK_BYTES);
        CLOCK_BYTES
    }

    /// The time between two readings; none if they are not in order, as after a reset of the clock.
    pub(super) fn between(&self, words: &[u32]) -> Option<Duration> {
        let [begin, end] = [0, 2].map(|i| u64::from(words[i]) | u64::from(words[i + 1]) << 32);
        let ticks = end.checked_sub(begin).filter(|_| begin > 0)?;
        Some(Duration::from_secs_f64(ticks as f64 * self.period * 1e-9))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_become_as_long_as_they_may_be() {
        let after = |each: f64, wanted: f64| {
            let mut hemicubes = 1;
            for _ in 0..20 {
                let took = Duration::from_secs_f64(each * f64::from(hemicubes));
                hemicubes = paced(hemicubes, took, Duration::from_secs_f64(wanted));
            }
            hemicubes
        };
        assert_eq!(after(1e-3, 8e-3), 8, "as many as fit");
        assert_eq!(after(1e-5, 8e-3), MOST_HEMICUBES, "no more than that");
        assert_eq!(after(1.0, 8e-3), 1, "one at least");
        let quick = paced(4, Duration::ZERO, Duration::from_millis(8));
        assert_eq!(quick, 8, "twice as many at most");
    }

    #[test]
    fn long_hemicubes_are_alone_under_way() {
        let wanted = Duration::from_millis(8);
        let kept = |next, millis| kept(next, Duration::from_millis(millis), wanted);
        assert_eq!(
            kept(1, 40),
            0,
            "one hemicube is more than a picture can wait for"
        );
        assert_eq!(kept(1, 9), 1, "it takes about as long as it may");
        assert_eq!(kept(3, 8), 1, "as long as it may");
        assert_eq!(kept(4, 60), 1, "the next step is shorter");
    }

    #[test]
    fn a_step_counts_from_the_one_before_where_there_is_no_clock() {
        let mut pace = Pace {
            step_time: Duration::from_secs(80),
            hemicubes: 1,
            keeps: 0,
            clock: None,
            seen: None,
        };
        let ago = |seconds| Instant::now() - Duration::from_secs(seconds);
        pace.note(4, ago(160), None);
        assert_eq!(pace.hemicubes, 1, "a little more than half of them fits");
        pace.seen = Some(ago(40));
        pace.note(4, ago(160), None);
        assert_eq!(pace.hemicubes, 7, "a little less than twice as many fit");
        let by_clock = Some(Duration::from_secs(40));
        pace.note(3, ago(160), by_clock);
        assert_eq!(pace.hemicubes, 6, "exactly twice as many fit");
    }
}
