//! Circles by the midpoint method.
//!
//! In the octant from the top to the diagonal a circle falls by at most one row from column to column. From the
//! reference point `P = (x, y)` the next pixel is `(x + 1, y)` or `(x + 1, y - 1)`, and the sign of
//! `F(x, y) = x^2 + y^2 - r^2` at the midpoint between the two, `(x + 1, y - 1/2)`, decides. Nothing needs to be
//! multiplied: `F` at the next midpoint differs by `2 x + 3` or `2 x - 2 y + 5`, and these differences themselves by 2
//! or 4 (Bresenham, *A linear algorithm for incremental digital display of circular arcs*, CACM 20(2), 1977, in the
//! midpoint form of Foley and van Dam):
//! ```text
//! x = 0, y = r, d = 1 - r, east = 3, south_east = 5 - 2 r
//! while x <= y:
//!     set the pixel and its seven mirror images
//!     if d < 0: d += east,       east += 2, south_east += 2
//!     else:     d += south_east, east += 2, south_east += 4, y -= 1
//!     x += 1
//! ```
//! On the axes and on the diagonals mirror images coincide; each pixel is drawn once.
//!
//! In closed form `y` is the largest number with `y^2 - y < r^2 - x^2`, so an arc can be entered at any column, and the
//! columns whose pixels are in a window follow from a square root. A circle that crosses the border of its window is
//! drawn octant by octant, from the first visible step of each to the last.
//!
//! # Current state
//! [`draw_circle`] and [`fill_circle`] have whole pixels as centres and radii of up to 2^31 - 1 pixels; [`antialiased`]
//! takes any. Nothing here panics or overflows.

pub mod antialiased;

use crate::target::Target;
use core::ops::Range;
use glam::IVec2;

/// A step along the octant from the top to the diagonal, relative to the centre, y pointing away from it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct OctantStep {
    /// The reference point, a pixel of the circle: `0 <= x <= y`.
    pub point: IVec2,
    /// `F(x + 1, y - 1/2)` less 1/4: negative if the next pixel stays in the row.
    pub decision: i64,
    /// What the decision grows by if it stays.
    pub east: i64,
    /// What the decision grows by if it goes down.
    pub south_east: i64,
}

/// The pixels of a circle's octant by the midpoint method, with all terms.
///
/// ```
/// use hemicube_raster::circle::Octant;
///
/// let rows: Vec<i32> = Octant::new(8).map(|step| step.point.y).collect();
/// assert_eq!(rows, [8, 8, 8, 7, 7, 6]);
/// ```
#[derive(Debug, Clone)]
pub struct Octant {
    x: i64,
    y: i64,
    decision: i64,
    east: i64,
    south_east: i64,
}

impl Octant {
    /// All of the octant. A negative radius has no pixels.
    pub fn new(radius: i32) -> Self {
        let radius = i64::from(radius);
        // At the top the height is the radius: no root is needed.
        Self::at(radius, [0, radius.max(-1)])
    }

    /// From a column on, which is not negative.
    fn from_column(radius: i32, x: i64) -> Self {
        let radius = i64::from(radius);
        let y = if radius < 0 { -1 } else { height(radius, x) };
        Self::at(radius, [x, y])
    }

    /// From a pixel on.
    #[inline(always)]
    fn at(radius: i64, [x, y]: [i64; 2]) -> Self {
        Self {
            x,
            y,
            decision: (x + 1) * (x + 1) + y * y - y - radius * radius,
            east: 2 * x + 3,
            south_east: 2 * (x - y) + 5,
        }
    }

    /// Goes on to the next column.
    #[inline(always)]
    fn advance(&mut self) {
        // All ones if it goes down.
        let down = !(self.decision >> 63);
        self.decision += (self.east & !down) + (self.south_east & down);
        self.east += 2;
        self.south_east += 2 - 2 * down;
        self.y += down;
        self.x += 1;
    }
}

impl Iterator for Octant {
    type Item = OctantStep;

    fn next(&mut self) -> Option<OctantStep> {
        (self.x <= self.y).then(|| {
            let step = OctantStep {
                point: IVec2::new(low_bits(self.x), low_bits(self.y)),
                decision: self.decision,
                east: self.east,
                south_east: self.south_east,
            };
            self.advance();
            step
        })
    }
}

/// Coordinates of what is drawn have 32 bits.
#[expect(clippy::cast_possible_truncation, reason = "what is meant")]
#[inline(always)]
fn low_bits(number: i64) -> i32 {
    number as i32
}

/// The row of the circle nearest to its true height at a column from 0 to the radius: the largest `y` with
/// `y^2 - y < r^2 - x^2`, 0 if there is none.
fn height(radius: i64, x: i64) -> i64 {
    let square = radius * radius - x * x;
    if square <= 0 {
        return 0;
    }
    let root = (square - 1).isqrt();
    root + i64::from(root * root + root < square)
}

/// The last column of the octant whose row is at least `y`, at least 1; -1 if there is none.
fn last_column(radius: i64, y: i64) -> i64 {
    let y = y.min(radius + 1);
    let square = radius * radius - y * y + y;
    if square > 0 { (square - 1).isqrt() } else { -1 }
}

/// One of the eight mirror images of the octant.
#[derive(Debug, Clone, Copy)]
struct Mirror {
    /// x and y change places.
    is_swapped: bool,
    /// 1 or -1.
    right: i64,
    /// 1 or -1.
    down: i64,
}

impl Mirror {
    fn all() -> impl Iterator<Item = Self> {
        (0..8).map(|bits| Self {
            is_swapped: bits & 1 != 0,
            right: 1 - (bits & 2),
            down: 1 - (bits & 4) / 2,
        })
    }

    fn place(self, x: i64, y: i64) -> [i64; 2] {
        let [x, y] = if self.is_swapped { [y, x] } else { [x, y] };
        [self.right * x, self.down * y]
    }

    /// Columns of the octant whose mirror images are in a window relative to the centre, and are drawn by no other.
    fn visible(self, radius: i64, window: &[Range<i64>; 2]) -> Range<i64> {
        let [columns, rows] = window;
        let [columns, rows] = if self.is_swapped {
            [(rows, self.down), (columns, self.right)]
        } else {
            [(columns, self.right), (rows, self.down)]
        };
        // Of two images that coincide on an axis the positive one is drawn, on a diagonal the one that is not swapped.
        let [x_range, y_range] = [columns, rows].map(|(range, sign)| mirrored(range, sign));
        let start = first_column(radius, y_range.end).max(x_range.start);
        let last = last_column(radius, y_range.start.max(1)).min(x_range.end - 1);
        start..(last.min(last_of_octant(radius) - self.leaves_diagonal(radius)) + 1).max(start)
    }

    /// 1 if the octant ends on the diagonal and another image draws that pixel.
    fn leaves_diagonal(self, radius: i64) -> i64 {
        let last = last_of_octant(radius);
        i64::from(self.is_swapped && height(radius, last) == last)
    }
}

/// A range of coordinates on one side of the centre, as distances from it. Distance 0 belongs to the positive side.
fn mirrored(range: &Range<i64>, sign: i64) -> Range<i64> {
    if sign > 0 {
        range.start.max(0)..range.end
    } else {
        (1 - range.end).max(1)..1 - range.start
    }
}

/// The first column of the octant whose row is below `y`.
fn first_column(radius: i64, y: i64) -> i64 {
    if y <= 0 {
        i64::MAX / 2
    } else {
        last_column(radius, y) + 1
    }
}

/// The last column with `x <= y`.
fn last_of_octant(radius: i64) -> i64 {
    // The diagonal is met at r / sqrt(2); the pixel next to it may be beyond.
    let x = (radius * radius / 2).isqrt();
    x + i64::from(height(radius, x + 1) > x)
}

/// Draws a circle of the pixels nearest to it, each once. A negative radius draws nothing, a radius of 0 the centre.
pub fn draw_circle(target: &mut impl Target, center: IVec2, radius: i32) {
    if radius <= 0 {
        if radius == 0 && target.window().contains(center) {
            target.pixel(center.x, center.y);
        }
        return;
    }
    let (around, _) = window_around(target, center);
    let r = i64::from(radius);
    let [columns, rows] = &around;
    let is_inside = |range: &Range<i64>| range.start <= -r && r < range.end;
    if is_inside(columns) && is_inside(rows) {
        draw_whole(target, center, radius);
        return;
    }
    for mirror in Mirror::all() {
        let visible = mirror.visible(r, &around);
        let mut octant = Octant::from_column(radius, visible.start.min(r));
        for _ in visible {
            let [x, y] = mirror.place(octant.x, octant.y);
            target.pixel(
                low_bits(i64::from(center.x) + x),
                low_bits(i64::from(center.y) + y),
            );
            octant.advance();
        }
    }
}

/// The window with the centre as its origin, and the centre.
fn window_around(target: &impl Target, center: IVec2) -> ([Range<i64>; 2], [i64; 2]) {
    let window = target.window();
    let [x, y] = center.to_array().map(i64::from);
    let columns = i64::from(window.left) - x..i64::from(window.right) - x;
    let rows = i64::from(window.top) - y..i64::from(window.bottom) - y;
    ([columns, rows], [x, y])
}

/// Draws a circle of radius 1 or more that is in the window with all its pixels.
#[inline(always)]
fn draw_whole(target: &mut impl Target, center: IVec2, radius: i32) {
    let IVec2 { x: cx, y: cy } = center;
    for [dx, dy] in [[0, -radius], [-radius, 0], [radius, 0], [0, radius]] {
        target.pixel(cx + dx, cy + dy);
    }
    let mut octant = Octant::new(radius);
    octant.advance();
    while octant.x < octant.y {
        let [x, y] = [low_bits(octant.x), low_bits(octant.y)];
        two_rows(target, center, x, y);
        two_rows(target, center, y, x);
        octant.advance();
    }
    if octant.x == octant.y {
        two_rows(target, center, low_bits(octant.x), low_bits(octant.x));
    }
}

/// Sets the two mirror images in each of two rows.
#[inline(always)]
fn two_rows(target: &mut impl Target, center: IVec2, x: i32, y: i32) {
    let IVec2 { x: cx, y: cy } = center;
    target.pixel(cx - x, cy - y);
    target.pixel(cx + x, cy - y);
    target.pixel(cx - x, cy + y);
    target.pixel(cx + x, cy + y);
}

/// Fills a circle: [`draw_circle`]'s pixels and all between them, row by row from the top, each once.
pub fn fill_circle(target: &mut impl Target, center: IVec2, radius: i32) {
    if radius < 0 {
        return;
    }
    let window = target.window();
    let ([columns, rows], [x, y]) = window_around(target, center);
    let radius = i64::from(radius);
    for row in rows.start.max(-radius)..rows.end.min(radius + 1) {
        let half = half_width(radius, row.abs());
        if half >= columns.start && -half < columns.end && !window.is_empty() {
            let span = window.columns_in(x - half..x + half + 1);
            target.span(low_bits(y + row), span);
        }
    }
}

/// The largest column of the circle's pixels in a row from 0 to the radius.
fn half_width(radius: i64, row: i64) -> i64 {
    let steep = if row == 0 {
        radius
    } else {
        last_column(radius, row)
    };
    if steep < row {
        steep
    } else {
        height(radius, row)
    }
}
