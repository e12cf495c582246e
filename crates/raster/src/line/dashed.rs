//! Dashes along a line, measured on the true line, so that they look alike in all directions.

use super::bresenham::{draw_steps, visible};
use super::walk::Walk;
use crate::target::Target;
use core::ops::Range;
use glam::IVec2;

/// A pattern of dashes and gaps, repeated along a line, and how far into it a line begins.
///
/// ```
/// use hemicube_raster::line::Dashes;
///
/// let dashes = Dashes::new(&[5.0, 3.0], 6.0)?;
/// let on: Vec<_> = dashes.intervals(0.0..20.0).collect();
/// assert_eq!(on, [2.0..7.0, 10.0..15.0, 18.0..23.0]);
/// # Ok::<(), hemicube_raster::line::DashError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Dashes {
    /// Where each dash of a period begins and ends.
    dashes: Vec<Range<f64>>,
    period: f64,
    /// In [0, period).
    phase: f64,
}

/// A pattern of dashes that cannot be drawn.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DashError {
    /// A length is negative or not finite.
    #[error("dash {index} is {length} pixels long; give a length that is finite and not negative")]
    Length {
        /// Its place in the pattern.
        index: usize,
        /// What it is.
        length: f64,
    },
    /// The pattern would repeat more often than pixels can show, or never.
    #[error(
        "a pattern of {period} pixels is repeated; let its dashes and gaps sum up to 0.25 to 1e15"
    )]
    Period {
        /// The sum of its lengths.
        period: f64,
    },
    /// The phase is not finite.
    #[error("a phase of {phase} pixels; give a finite one")]
    Phase {
        /// What it is.
        phase: f64,
    },
}

impl Dashes {
    /// A dash, a gap, a dash and so on, by their lengths in pixels; an odd number of them is taken twice, as in SVG. A
    /// line begins `phase` pixels into the pattern.
    pub fn new(lengths: &[f64], phase: f64) -> Result<Self, DashError> {
        let is_bad = |length: &f64| !(length.is_finite() && *length >= 0.0);
        if let Some(index) = lengths.iter().position(is_bad) {
            let length = lengths[index];
            return Err(DashError::Length { index, length });
        }
        let repeats = 1 + lengths.len() % 2;
        let ends: Vec<f64> = std::iter::repeat_n(lengths, repeats)
            .flatten()
            .scan(0.0, |end, length| {
                *end += length;
                Some(*end)
            })
            .collect();
        let period = ends.last().copied().unwrap_or(0.0);
        if !(0.25..=1e15).contains(&period) {
            return Err(DashError::Period { period });
        }
        let start = |k: usize| if k == 0 { 0.0 } else { ends[k - 1] };
        let dashes = (0..ends.len()).step_by(2).map(|k| start(k)..ends[k]);
        Self {
            dashes: dashes.collect(),
            period,
            phase: 0.0,
        }
        .with_phase(phase)
    }

    /// The same pattern from another phase on.
    pub fn with_phase(mut self, phase: f64) -> Result<Self, DashError> {
        if !phase.is_finite() {
            return Err(DashError::Phase { phase });
        }
        let phase = phase.rem_euclid(self.period);
        // The remainder of a small negative number is rounded to the period itself.
        self.phase = if phase < self.period { phase } else { 0.0 };
        Ok(self)
    }

    /// How far into the pattern a line begins, in pixels.
    pub fn phase(&self) -> f64 {
        self.phase
    }

    /// Length after which the pattern repeats, in pixels.
    pub fn period(&self) -> f64 {
        self.period
    }

    /// The dashes, by their distances from the line's beginning, that meet a part of the line; whole ones, in order.
    ///
    /// A dash has the same bits whatever the part is. A part that is not finite has no dashes, nor has one more than
    /// 2^52 periods away from the beginning, where f64 does not tell them apart.
    pub fn intervals(&self, part: Range<f64>) -> impl Iterator<Item = Range<f64>> + '_ {
        let period_at = |distance: f64| ((distance + self.phase) / self.period).floor();
        let periods = whole_range(period_at(part.start), period_at(part.end));
        let starts = periods.map(|n| n as f64 * self.period - self.phase);
        let dashes = starts.flat_map(|start| {
            let moved = move |dash: &Range<f64>| start + dash.start..start + dash.end;
            self.dashes.iter().map(moved)
        });
        dashes.filter(move |dash| dash.end >= part.start && dash.start < part.end)
    }
}

/// The whole numbers from the first to the last, none unless both are exact.
#[expect(clippy::cast_possible_truncation, reason = "below 2^52")]
fn whole_range(first: f64, last: f64) -> Range<i64> {
    const EXACT: f64 = (1_u64 << 52) as f64;
    if first.abs() <= EXACT && last.abs() <= EXACT {
        first as i64..last as i64 + 1
    } else {
        0..0
    }
}

/// Draws those pixels of [`Bresenham`](super::Bresenham)'s line that lie on dashes: the pixel at `t` of the true line's
/// length does if `t` is in one of [`Dashes::intervals`], whose ends do not count.
///
/// The pattern is that of the whole line, wherever it enters the window. For the next side of a polygon, go on with a
/// phase that has grown by this line's length.
pub fn draw_dashed_line(target: &mut impl Target, from: IVec2, to: IVec2, dashes: &Dashes) {
    let walk = Walk::new(from, to);
    let steps = visible(&walk, &target.window());
    if steps.is_empty() {
        return;
    }
    let step_length = walk.step_length().max(f64::MIN_POSITIVE);
    let distance = |step: i64| step as f64 * step_length;
    // Clipped steps, so that all numbers are small enough for an i64.
    let first_from = |distance: f64| first_step_from(distance / step_length, &steps);
    // From one step earlier and to one later, because a product and a quotient are rounded.
    let part = distance(steps.start - 1)..distance(steps.end);
    for dash in dashes.intervals(part) {
        draw_steps(target, &walk, first_from(dash.start)..first_from(dash.end));
    }
}

/// The first of some steps that is not before `step`; the one behind the last if all are.
#[expect(clippy::cast_possible_truncation, reason = "clamped to the steps")]
fn first_step_from(step: f64, steps: &Range<i64>) -> i64 {
    let step = step.ceil();
    step.clamp(steps.start as f64, steps.end as f64) as i64
}
