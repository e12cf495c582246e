//! Bresenham's line: an integer error term says when to step across.
//!
//! J. E. Bresenham, *Algorithm for computer control of a digital plotter*, IBM Systems Journal 4(1), 1965. In its plain
//! form, for a line from the origin to (dx, dy) with 0 <= dy <= dx:
//! ```text
//! e = 2 dy - dx
//! for x in 0..=dx:
//!     set (x, y)
//!     if e >= 0: y += 1, e -= 2 dx
//!     e += 2 dy
//! ```
//! Where the fast form departs from it:
//! 1. `y` at column `x` is `floor((2 dy x + dx) / (2 dx))`, so a walk can start at any column with the right error term,
//!    and the first column with a given `y` follows by a division: clipping jumps to the first pixel inside.
//! 2. The comparison becomes a mask; a branch would be mispredicted at every second pixel of some slopes.
//! 3. Lines that are flat are drawn by runs (Bresenham, *Run length slice algorithm for incremental lines*, 1985): a
//!    quotient and a remainder say how long the next one is.

use super::Step;
use super::walk::Walk;
use crate::target::{Target, Window};
use core::ops::Range;
use glam::IVec2;

/// Steps along with an integer error term `e = 2 dy - dx`, scaled so that there is no fraction: exact in all octants.
///
/// The term of a [`Step`] is the error term after its pixel: not negative if the next step goes across. It is twice
/// the length of the line times the distance of the true line, one step on, beyond the middle between the two pixels
/// that can follow.
///
/// ```
/// use glam::IVec2;
/// use hemicube_raster::line::Bresenham;
///
/// let there: Vec<IVec2> = Bresenham::new(IVec2::ZERO, IVec2::new(-7, 3)).map(|s| s.pixel).collect();
/// let mut back: Vec<IVec2> = Bresenham::new(IVec2::new(-7, 3), IVec2::ZERO).map(|s| s.pixel).collect();
/// back.reverse();
/// assert_eq!(there, back);
/// ```
#[derive(Debug, Clone)]
pub struct Bresenham {
    walk: Walk,
    steps: Range<i64>,
    /// Steps across so far.
    risen: i64,
    error: i64,
}

impl Bresenham {
    /// The whole line, both ends included.
    pub fn new(from: IVec2, to: IVec2) -> Self {
        let walk = Walk::new(from, to);
        Self::of_steps(walk, 0..walk.length + 1)
    }

    /// Its pixels in a window.
    pub fn within(from: IVec2, to: IVec2, window: &Window) -> Self {
        let walk = Walk::new(from, to);
        Self::of_steps(walk, visible(&walk, window))
    }

    pub(super) fn of_steps(walk: Walk, steps: Range<i64>) -> Self {
        let (risen, error) = state(&walk, steps.start);
        Self {
            walk,
            steps,
            risen,
            error,
        }
    }
}

impl Iterator for Bresenham {
    type Item = Step<i64>;

    fn next(&mut self) -> Option<Step<i64>> {
        let step = self.steps.next()?;
        let across = self.walk.start()[1] + self.walk.across_step * self.risen;
        let error = self.error;
        if error >= 0 {
            self.risen += 1;
            self.error -= 2 * self.walk.length;
        }
        self.error += 2 * self.walk.rise;
        Some(Step {
            pixel: self.walk.pixel(step, across),
            ideal: self.walk.ideal(step),
            error,
        })
    }
}

/// 1 for lines on which the pixel of smaller coordinate comes next: there a tie does not step yet.
fn tie(walk: &Walk) -> i64 {
    i64::from(walk.across_step < 0)
}

/// The longest line whose products fit into 64 bits.
const SHORT: i64 = 1 << 30;

/// `floor(n / d)` and the remainder, in 64 bits where both fit: that is far quicker.
#[expect(
    clippy::cast_possible_truncation,
    reason = "quotients are steps, at most 2^33, and remainders are below 2^34"
)]
#[inline(always)]
fn divide(walk: &Walk, [a, b, c]: [i64; 3], divisor: i64) -> (i64, i64) {
    if walk.length < SHORT {
        let n = 2 * a * b + c;
        (n.div_euclid(divisor), n.rem_euclid(divisor))
    } else {
        let n = 2 * i128::from(a) * i128::from(b) + i128::from(c);
        let d = i128::from(divisor);
        (n.div_euclid(d) as i64, n.rem_euclid(d) as i64)
    }
}

/// Steps across after so many steps along, and the error term.
#[inline(always)]
fn state(walk: &Walk, step: i64) -> (i64, i64) {
    let Walk { rise, length, .. } = *walk;
    let (risen, remainder) = if step == 0 {
        (0, length - tie(walk))
    } else {
        divide(walk, [rise, step, length - tie(walk)], 2 * length)
    };
    (risen, remainder + 2 * rise - 2 * length)
}

/// The first step that has risen so far, at least 1, on a line that rises: `ceil((2 length k - length + tie) / 2 rise)`,
/// and what rounding has added to it, in units of `1 / (2 rise)`.
#[inline(always)]
fn first_step(walk: &Walk, risen: i64) -> (i64, i64) {
    let divisor = 2 * walk.rise;
    let rounded_up = divisor - 1 - walk.length + tie(walk);
    let (step, remainder) = divide(walk, [walk.length, risen, rounded_up], divisor);
    (step, divisor - 1 - remainder)
}

/// The steps of a line in a window.
#[inline(always)]
pub(super) fn visible(walk: &Walk, window: &Window) -> Range<i64> {
    let [along, rises] = walk.inside(window);
    let mut steps = along;
    if rises.is_empty() || steps.is_empty() || window.is_empty() {
        return 0..0;
    }
    if rises.start > 0 {
        steps.start = steps.start.max(first_step(walk, rises.start).0);
    }
    if rises.end <= walk.rise {
        steps.end = steps.end.min(first_step(walk, rises.end).0);
    }
    steps
}

/// How many times longer than high a line is from which on it is drawn by runs, if it is not too short for their setup.
const FLAT: i64 = 6;
const LONG: i64 = 48;

/// Draws the pixels of [`Bresenham`]'s line, both ends included, as fast as they can be set.
pub fn draw_line(target: &mut impl Target, from: IVec2, to: IVec2) {
    let walk = Walk::new(from, to);
    let steps = visible(&walk, &target.window());
    draw_steps(target, &walk, steps);
}

/// Draws some steps of a line, all of them in the target's window.
#[inline]
pub(super) fn draw_steps(target: &mut impl Target, walk: &Walk, steps: Range<i64>) {
    if steps.is_empty() {
    } else if walk.is_steep {
        draw_pixels(walk, steps, |along, across| target.pixel(across, along));
    } else if walk.rise == 0 || walk.length >= LONG.max(FLAT * walk.rise) {
        draw_runs(target, walk, steps);
    } else {
        draw_pixels(walk, steps, |along, across| target.pixel(along, across));
    }
}

/// Hands over the coordinates of each pixel along and across.
#[inline(always)]
fn draw_pixels(walk: &Walk, steps: Range<i64>, mut pixel: impl FnMut(i32, i32)) {
    let (risen, mut error) = state(walk, steps.start);
    let [along_step, across_step] = [walk.along_step, walk.across_step].map(low_bits);
    let mut along = low_bits(walk.along_at(steps.start));
    let mut across = low_bits(walk.start()[1] + walk.across_step * risen);
    let (rise, length) = (2 * walk.rise, 2 * walk.length);
    for _ in steps {
        pixel(along, across);
        // All ones if the next step goes across.
        let mask = !(error >> 63);
        error += rise - (length & mask);
        along = along.wrapping_add(along_step);
        across = across.wrapping_add(across_step & low_bits(mask));
    }
}

/// Coordinates have 32 bits.
#[expect(clippy::cast_possible_truncation, reason = "what is meant")]
#[inline(always)]
fn low_bits(number: i64) -> i32 {
    number as i32
}

/// Draws a line that is not steep, run by run.
#[inline(always)]
fn draw_runs(target: &mut impl Target, walk: &Walk, steps: Range<i64>) {
    let mut run = Runs::new(walk, steps.start);
    let mut start = steps.start;
    let mut row = walk.start()[1] + walk.across_step * run.risen;
    while start < steps.end {
        let end = run.end.min(steps.end);
        let [first, last] = [walk.along_at(start), walk.along_at(end - 1)].map(low_bits);
        target.span(low_bits(row), first.min(last)..first.max(last) + 1);
        start = end;
        row += walk.across_step;
        run.advance();
    }
}

/// The runs of a line: where the present one ends is the first step that has risen by one more,
/// `ceil((2 length k - length + tie) / (2 rise))` for the `k`th, which grows by `length / rise` each time.
#[derive(Debug)]
struct Runs {
    risen: i64,
    /// Step behind the last of the present run.
    end: i64,
    /// What `end` is too large by, in units of `1 / (2 rise)`.
    remainder: i64,
    quotient_step: i64,
    remainder_step: i64,
    divisor: i64,
}

impl Runs {
    /// From the run to which a step belongs.
    #[inline(always)]
    fn new(walk: &Walk, step: i64) -> Self {
        let (risen, _) = state(walk, step);
        let divisor = 2 * walk.rise;
        if divisor == 0 {
            return Self {
                risen,
                end: walk.length + 1,
                remainder: 0,
                quotient_step: 0,
                remainder_step: 0,
                divisor: 1,
            };
        }
        let (end, remainder) = first_step(walk, risen + 1);
        Self {
            risen,
            end,
            remainder,
            quotient_step: 2 * walk.length / divisor,
            remainder_step: 2 * walk.length % divisor,
            divisor,
        }
    }

    #[inline(always)]
    fn advance(&mut self) {
        self.remainder -= self.remainder_step;
        self.end += self.quotient_step;
        if self.remainder < 0 {
            self.remainder += self.divisor;
            self.end += 1;
        }
    }
}
