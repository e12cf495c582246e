//! Ellipses with horizontal and vertical axes, by the midpoint method.
//!
//! In the first quadrant there are two regions. From the top to where the slope is -1, each column has one pixel, the
//! nearest to the true height; from there on each row has one. With `F(x, y) = b^2 x^2 + a^2 y^2 - a^2 b^2`, the sign
//! at the midpoint `(x + 1, y - 1/2)` says whether the next column's pixel is a row lower, and `F` follows by first- and
//! second-order differences as for a [circle](crate::circle) (Foley and van Dam, *Computer Graphics: Principles and
//! Practice*, 2nd edition, section 3.4). The second region is the first one of the ellipse with its axes swapped.
//!
//! Where the two meet, the pixel of one region may be a knight's move from that of the other; one pixel is then drawn
//! between them. So the tips of flat ellipses are drawn as well, which plain forms of the method lose. Where they touch,
//! nothing is drawn between them; a circle of some radii has a pixel on the diagonal there.
//!
//! Products of four radii have 124 bits: the terms are of 128 bits. In closed form the height at column `x` is
//! `(m + 1) / 2` for the largest `m` with `a^2 m^2 <= 4 b^2 (a^2 - x^2)`; so arcs can be entered at any column.
//!
//! # Current state
//! Radii of up to 2^31 - 1 pixels, no rotation. Nothing here panics or overflows.

use crate::target::Target;
use core::ops::{AddAssign, Range};
use glam::IVec2;

/// The largest `x >= 0` with `x^2 den <= num`; `den` is not 0, and the result has at most 33 bits.
fn floor_sqrt(num: u128, den: u128) -> i64 {
    let root = match (u64::try_from(num), u64::try_from(den)) {
        (Ok(num), Ok(den)) => {
            let is_below = |x: u64| (x * x).checked_mul(den).is_some_and(|s| s <= num);
            corrected(num as f64 / den as f64, is_below)
        }
        _ => {
            let square = |x: u64| u128::from(x).pow(2);
            let is_below = |x: u64| square(x).checked_mul(den).is_some_and(|s| s <= num);
            corrected(num as f64 / den as f64, is_below)
        }
    };
    i64::try_from(root).expect("a square root has 33 bits")
}

/// The last number of which something holds, given about its square: f64 has 53 bits, so its root misses by one at most.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "the square root of a number that is not negative, below 2^33"
)]
#[inline(always)]
fn corrected(square: f64, holds: impl Fn(u64) -> bool) -> u64 {
    let mut root = square.sqrt() as u64;
    while !holds(root) {
        root -= 1;
    }
    while holds(root + 1) {
        root += 1;
    }
    root
}

fn wide(number: i64) -> u128 {
    u128::from(number.unsigned_abs())
}

/// The first region of an ellipse with the radii `a` along x and `b` along y, both at least 1.
#[derive(Debug, Clone, Copy)]
struct Region {
    a: i64,
    b: i64,
}

impl Region {
    /// The last column before the slope passes -1: `x <= a^2 / sqrt(a^2 + b^2)`.
    fn last(self) -> i64 {
        let [a2, b2] = [self.a, self.b].map(|r| wide(r).pow(2));
        floor_sqrt(a2 * a2, a2 + b2)
    }

    /// The row nearest to the true height at a column from 0 to `a`. No ellipse of whole radii passes exactly between
    /// two rows.
    fn height(self, x: i64) -> i64 {
        let [a, b, x] = [self.a, self.b, x].map(wide);
        (floor_sqrt(4 * b * b * (a * a - x * x), a * a) + 1) / 2
    }

    /// The last column whose height is at least `y`, at least 1; -1 if there is none.
    fn last_at(self, y: i64) -> i64 {
        if y > self.b {
            return -1;
        }
        let [a, b, m] = [self.a, self.b, 2 * y - 1].map(wide);
        floor_sqrt(a * a * (4 * b * b - m * m), 4 * b * b)
    }

    fn walk(self, x: i64) -> Walk<i128> {
        let [a2, b2] = [self.a, self.b].map(|r| i128::from(r).pow(2));
        let height = self.height(x);
        let [column, y] = [x, height].map(i128::from);
        // 4 F(x + 1, y - 1/2). Terms of huge radii may wrap; their sum is far smaller and right again.
        let inside = b2.wrapping_mul(4 * (column + 1).pow(2));
        let above = a2.wrapping_mul((2 * y - 1).pow(2) - (2 * i128::from(self.b)).pow(2));
        Walk {
            x,
            y: height,
            decision: inside.wrapping_add(above),
            east: 4 * b2 * (2 * column + 3),
            south: 8 * a2 * (1 - y),
            east_step: 8 * b2,
            south_step: 8 * a2,
        }
    }
}

/// The largest radius of which all terms, below 16 times its cube, fit into 64 bits.
const SMALL: i64 = 1 << 19;

/// The midpoint method in a region, with terms of 64 or 128 bits.
#[derive(Debug)]
struct Walk<T> {
    x: i64,
    y: i64,
    /// `4 F(x + 1, y - 1/2)`
    decision: T,
    /// What the decision grows by for a column.
    east: T,
    /// What it grows by more if the row changes.
    south: T,
    east_step: T,
    south_step: T,
}

impl Walk<i128> {
    /// In 64 bits, for a small radius.
    #[expect(clippy::cast_possible_truncation, reason = "small terms")]
    fn narrowed(&self) -> Walk<i64> {
        Walk {
            x: self.x,
            y: self.y,
            decision: self.decision as i64,
            east: self.east as i64,
            south: self.south as i64,
            east_step: self.east_step as i64,
            south_step: self.south_step as i64,
        }
    }
}

impl<T: Copy + AddAssign + PartialOrd + Default> Walk<T> {
    #[inline(always)]
    fn advance(&mut self) {
        // On the axis the midpoint below is beyond the tip, not inside of the ellipse.
        let falls = self.decision >= T::default() && self.y > 0;
        self.decision += self.east;
        self.east += self.east_step;
        self.x += 1;
        if falls {
            self.decision += self.south;
            self.south += self.south_step;
            self.y -= 1;
        }
    }

    #[inline(always)]
    fn run(mut self, steps: Range<i64>, mut pixel: impl FnMut(i64, i64)) {
        for _ in steps {
            pixel(self.x, self.y);
            self.advance();
        }
    }
}

/// The pixels of an ellipse in its first quadrant.
#[derive(Debug, Clone, Copy)]
struct Quadrant {
    first: Region,
    /// Last column of the first region.
    last_x: i64,
    /// Last row of the second region.
    last_y: i64,
    /// Between the regions.
    link: Option<[i64; 2]>,
}

impl Quadrant {
    fn new(a: i64, b: i64) -> Self {
        let first = Region { a, b };
        let second = Region { a: b, b: a };
        let [x, last_y] = [first.last(), second.last()];
        let [y, right] = [first.height(x), second.height(last_y)];
        // Both regions may end in the same pixel; the first one draws it.
        let is_shared = x == right && y == last_y;
        let link = if y - last_y >= 2 {
            Some([second.height(last_y + 1).clamp(x, right), last_y + 1])
        } else if right - x >= 2 {
            Some([x + 1, first.height(x + 1).clamp(last_y, y)])
        } else {
            None
        };
        Self {
            first,
            last_x: x,
            last_y: last_y - i64::from(is_shared),
            link,
        }
    }

    fn second(&self) -> Region {
        Region {
            a: self.first.b,
            b: self.first.a,
        }
    }

    /// The largest column in a row from 0 to `b`.
    fn half_width(&self, row: i64) -> i64 {
        if row <= self.last_y {
            return self.second().height(row);
        }
        let linked = self.link.map_or(-1, |[x, y]| if y >= row { x } else { -1 });
        self.first.last_at(row).min(self.last_x).max(linked)
    }
}

/// Draws an ellipse with horizontal and vertical radii in pixels: each column or row gets the pixel nearest to it where
/// it is flat or steep, each once. With a radius of 0 it is a line, with a negative one nothing.
pub fn draw_ellipse(target: &mut impl Target, center: IVec2, radii: IVec2) {
    if radii.min_element() <= 0 {
        draw_flat(target, center, radii);
        return;
    }
    let [a, b] = radii.to_array().map(i64::from);
    let quadrant = Quadrant::new(a, b);
    let window = target.window();
    let place = Place::new(target, center);
    let [x, y] = place.center;
    if window.contains_box(x - a..x + a + 1, y - b..y + b + 1) {
        draw_whole(target, &place, &quadrant);
        return;
    }
    for signs in [[1, 1], [-1, 1], [1, -1], [-1, -1]] {
        let [columns, rows] = place.mirrored(signs);
        let steps = visible(quadrant.first, quadrant.last_x, &columns, &rows);
        draw_arc(quadrant.first, steps, |x, y| {
            place.set(target, signs, [x, y]);
        });
        let steps = visible(quadrant.second(), quadrant.last_y, &rows, &columns);
        draw_arc(quadrant.second(), steps, |y, x| {
            place.set(target, signs, [x, y]);
        });
        if let Some([x, y]) = quadrant.link
            && columns.contains(&x)
            && rows.contains(&y)
        {
            place.set(target, signs, [x, y]);
        }
    }
}

/// The steps of a region whose pixels are within ranges of columns and rows.
fn visible(region: Region, last: i64, columns: &Range<i64>, rows: &Range<i64>) -> Range<i64> {
    let below = match rows.end {
        ..=0 => i64::MAX,
        end => region.last_at(end) + 1,
    };
    let start = columns.start.max(below);
    let in_rows = match rows.start {
        ..=0 => last,
        start => region.last_at(start),
    };
    start..last.min(in_rows).min(columns.end - 1).saturating_add(1)
}

#[inline(always)]
fn draw_arc(region: Region, steps: Range<i64>, pixel: impl FnMut(i64, i64)) {
    if steps.is_empty() {
        return;
    }
    let walk = region.walk(steps.start);
    if region.a.max(region.b) <= SMALL {
        walk.narrowed().run(steps, pixel);
    } else {
        walk.run(steps, pixel);
    }
}

/// Draws an ellipse that is in the window with all its pixels.
#[inline(always)]
fn draw_whole(target: &mut impl Target, place: &Place, quadrant: &Quadrant) {
    let mut four = |x: i64, y: i64| {
        place.set(target, [1, 1], [x, y]);
        if x > 0 {
            place.set(target, [-1, 1], [x, y]);
        }
        if y > 0 {
            place.set(target, [1, -1], [x, y]);
        }
        if x > 0 && y > 0 {
            place.set(target, [-1, -1], [x, y]);
        }
    };
    draw_arc(quadrant.first, 0..quadrant.last_x + 1, &mut four);
    draw_arc(quadrant.second(), 0..quadrant.last_y + 1, |y, x| four(x, y));
    if let Some([x, y]) = quadrant.link {
        four(x, y);
    }
}

/// Where an ellipse is drawn.
#[derive(Debug)]
struct Place {
    center: [i64; 2],
    /// Columns and rows of the window.
    window: [Range<i64>; 2],
}

impl Place {
    fn new(target: &impl Target, center: IVec2) -> Self {
        let window = target.window();
        Self {
            center: center.to_array().map(i64::from),
            window: [window.left..window.right, window.top..window.bottom]
                .map(|range| i64::from(range.start)..i64::from(range.end)),
        }
    }

    /// Columns and rows of the window as distances from the centre in a quadrant; distance 0 belongs to the positive
    /// side.
    fn mirrored(&self, signs: [i64; 2]) -> [Range<i64>; 2] {
        [0, 1].map(|axis| {
            let (range, center) = (&self.window[axis], self.center[axis]);
            if signs[axis] > 0 {
                (range.start - center).max(0)..range.end - center
            } else {
                (center - range.end + 1).max(1)..center - range.start + 1
            }
        })
    }

    #[expect(clippy::cast_possible_truncation, reason = "a pixel of the window")]
    #[inline(always)]
    fn set(&self, target: &mut impl Target, signs: [i64; 2], [x, y]: [i64; 2]) {
        let [cx, cy] = self.center;
        target.pixel((cx + signs[0] * x) as i32, (cy + signs[1] * y) as i32);
    }
}

/// An ellipse of which one radius is 0 is a row or a column of pixels.
fn draw_flat(target: &mut impl Target, center: IVec2, radii: IVec2) {
    if radii.min_element() < 0 {
        return;
    }
    let window = target.window();
    let ends = [center.saturating_sub(radii), center.saturating_add(radii)];
    for row in ends[0].y.max(window.top)..=ends[1].y.min(window.bottom.saturating_sub(1)) {
        draw_span(target, i64::from(center.x), i64::from(radii.x), row);
    }
}

/// Draws what is in the window of a row that reaches so far to both sides of a column.
fn draw_span(target: &mut impl Target, center: i64, half: i64, row: i32) {
    let window = target.window();
    if window.left < window.right {
        let columns = window.columns_in(center - half..center + half + 1);
        if !columns.is_empty() {
            target.span(row, columns);
        }
    }
}

/// Fills an ellipse: [`draw_ellipse`]'s pixels and all between them, row by row from the top, each once.
pub fn fill_ellipse(target: &mut impl Target, center: IVec2, radii: IVec2) {
    if radii.min_element() <= 0 {
        draw_flat(target, center, radii);
        return;
    }
    let [a, b] = radii.to_array().map(i64::from);
    let quadrant = Quadrant::new(a, b);
    let window = target.window();
    let y = i64::from(center.y);
    let rows = i64::from(window.top).max(y - b)..i64::from(window.bottom).min(y + b + 1);
    for row in rows {
        let half = quadrant.half_width((row - y).abs());
        draw_span(target, i64::from(center.x), half, low_bits(row));
    }
}

#[expect(clippy::cast_possible_truncation, reason = "a row of the window")]
fn low_bits(row: i64) -> i32 {
    row as i32
}
