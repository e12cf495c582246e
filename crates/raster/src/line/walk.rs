//! What all ways along a line share: its axes, and which of its steps are in a window.

use crate::target::Window;
use core::ops::Range;
use glam::{DVec2, IVec2};

/// A line as `length` steps of one pixel along its major axis.
#[derive(Debug, Clone, Copy)]
pub(super) struct Walk {
    from: IVec2,
    /// The major axis is y.
    pub is_steep: bool,
    /// 1 or -1.
    pub along_step: i64,
    /// 1 or -1.
    pub across_step: i64,
    /// Steps from the first to the last pixel.
    pub length: i64,
    /// Pixels by which the last is off the first across the major axis, not negative.
    pub rise: i64,
}

impl Walk {
    /// Along the longer axis.
    pub fn new(from: IVec2, to: IVec2) -> Self {
        let [dx, dy] = [to.x.abs_diff(from.x), to.y.abs_diff(from.y)];
        Self::along(from, to, dy > dx)
    }

    /// Along y or along x, whichever is longer.
    pub fn along(from: IVec2, to: IVec2, is_steep: bool) -> Self {
        let [dx, dy] = [[from.x, to.x], [from.y, to.y]].map(|[a, b]| i64::from(b) - i64::from(a));
        let [along, across] = if is_steep { [dy, dx] } else { [dx, dy] };
        let sign = |d: i64| if d < 0 { -1 } else { 1 };
        Self {
            from,
            is_steep,
            along_step: sign(along),
            across_step: sign(across),
            length: along.abs(),
            rise: across.abs(),
        }
    }

    /// First coordinates along and across.
    pub fn start(&self) -> [i64; 2] {
        let [x, y] = self.from.to_array().map(i64::from);
        if self.is_steep { [y, x] } else { [x, y] }
    }

    /// Change across for a step along, with its sign; 0 for a point.
    pub fn slope(&self) -> f64 {
        if self.length == 0 {
            return 0.0;
        }
        (self.across_step * self.rise) as f64 / self.length as f64
    }

    /// Coordinate along after so many steps.
    pub fn along_at(&self, step: i64) -> i64 {
        self.start()[0] + self.along_step * step
    }

    /// The pixel after so many steps, at a coordinate across.
    #[expect(clippy::cast_possible_truncation, reason = "between both ends")]
    pub fn pixel(&self, step: i64, across: i64) -> IVec2 {
        let [along, across] = [self.along_at(step) as i32, across as i32];
        if self.is_steep {
            IVec2::new(across, along)
        } else {
            IVec2::new(along, across)
        }
    }

    /// The point of the true line after so many steps.
    pub fn ideal(&self, step: i64) -> DVec2 {
        let along = self.along_at(step) as f64;
        let share = step as f64 / self.length.max(1) as f64;
        let across = self.start()[1] as f64 + share * (self.across_step * self.rise) as f64;
        if self.is_steep {
            DVec2::new(across, along)
        } else {
            DVec2::new(along, across)
        }
    }

    /// Length of a step on the true line.
    pub fn step_length(&self) -> f64 {
        let [along, across] = [self.length as f64, self.rise as f64];
        along.hypot(across) / along.max(1.0)
    }

    /// Steps whose coordinate along is in the window, and the numbers of steps across that are.
    pub fn inside(&self, window: &Window) -> [Range<i64>; 2] {
        let columns = [window.left, window.right].map(i64::from);
        let rows = [window.top, window.bottom].map(i64::from);
        let [along, across] = if self.is_steep {
            [rows, columns]
        } else {
            [columns, rows]
        };
        let start = self.start();
        let along = steps_inside(start[0], self.along_step, along);
        let across = steps_inside(start[1], self.across_step, across);
        [
            along.start.max(0)..along.end.min(self.length + 1),
            across.start.max(0)..across.end.min(self.rise + 1),
        ]
    }

    /// The steps in a window of a way that has gone `across(step)` pixels across, by bisection: this never falls.
    pub fn visible(&self, window: &Window, across: impl Fn(i64) -> i64) -> Range<i64> {
        let [along, rises] = self.inside(window);
        if along.is_empty() || rises.is_empty() || window.is_empty() {
            return 0..0;
        }
        let first_above = |least: i64| partition(along.clone(), |step| across(step) < least);
        first_above(rises.start)..first_above(rises.end)
    }
}

/// The steps of length `step` (1 or -1) from `start` that are between two bounds, the upper one excluded.
fn steps_inside(start: i64, step: i64, [low, high]: [i64; 2]) -> Range<i64> {
    if step > 0 {
        low - start..high - start
    } else {
        start - high + 1..start - low + 1
    }
}

/// The first of a range for which something that holds first holds no more.
fn partition(range: Range<i64>, holds: impl Fn(i64) -> bool) -> i64 {
    let (mut low, mut high) = (range.start, range.end);
    while low < high {
        let middle = low + (high - low) / 2;
        if holds(middle) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    low
}
