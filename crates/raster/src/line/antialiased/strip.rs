//! Coverage of pixels by a strip between two parallel edges, in closed form.

use super::{clamped, narrow};
use crate::stroke::Bar;
use crate::target::CoverageTarget;
use core::ops::Range;
use glam::DVec2;

/// What a bar looks like from its middle: two parallel edges without ends.
pub(super) struct Strip {
    /// Across the strip.
    normal: DVec2,
    /// A point in its middle.
    origin: DVec2,
    half: f64,
    edge: EdgeProfile,
    /// The sides on which it is, one next to the other.
    sides: [HalfPlane; 2],
    /// What ends it; `end_count` of them.
    ends: [HalfPlane; 4],
    end_count: usize,
    /// Half the interval of columns whose pixels' centres are near enough to be touched in a row.
    reach: f64,
    /// Rows in which no pixel that it touches sees an end; empty if it is so flat that it does not matter.
    pub free_rows: Range<i32>,
}

/// The points with `normal · p >= offset`.
#[derive(Debug, Clone, Copy)]
struct HalfPlane {
    normal: DVec2,
    offset: f64,
    /// `1 / normal.x`, or 0.
    inverse: f64,
}

impl HalfPlane {
    fn through(point: DVec2, normal: DVec2) -> Self {
        Self {
            normal,
            offset: normal.dot(point),
            inverse: if normal.x == 0.0 { 0.0 } else { 1.0 / normal.x },
        }
    }

    /// How far from the edge the centre of a pixel is whose corner lies on it.
    fn footprint(&self) -> f64 {
        0.5 * (self.normal.x.abs() + self.normal.y.abs())
    }

    /// The interval of columns of a row whose pixels' centres are inside by a margin.
    #[inline(always)]
    fn columns(&self, row_centre: f64, margin: f64) -> [f64; 2] {
        let missing = margin + self.offset - self.normal.y * row_centre;
        let x = missing * self.inverse - 0.5;
        if self.normal.x > 0.0 {
            [x, f64::INFINITY]
        } else if self.normal.x < 0.0 {
            [f64::NEG_INFINITY, x]
        } else if missing <= 0.0 {
            [f64::NEG_INFINITY, f64::INFINITY]
        } else {
            [f64::INFINITY, f64::NEG_INFINITY]
        }
    }
}

/// The share of a unit square on one side of a straight edge, as a function of the centre's distance from it.
#[derive(Debug, Clone, Copy)]
struct EdgeProfile {
    /// Up to this distance the edge runs through two opposite sides: `(a - b) / 2`.
    middle: f32,
    /// The smaller component of the normal.
    b: f32,
    /// `1 / a`
    per_a: f32,
    /// `1 / (2 a b)`
    per_2ab: f32,
}

impl EdgeProfile {
    fn new(normal: DVec2) -> Self {
        let (x, y) = (normal.x.abs(), normal.y.abs());
        let (a, b) = (x.max(y), x.min(y));
        // Below, the corner's part of at most b / 2a is not to be seen.
        let per_2ab = if b > 1e-7 { 1.0 / (2.0 * a * b) } else { 0.0 };
        Self {
            middle: narrow(0.5 * (a - b)),
            b: narrow(b),
            per_a: narrow(1.0 / a),
            per_2ab: narrow(per_2ab),
        }
    }

    /// The share of the square that is inside if its centre is so far inside.
    #[inline(always)]
    fn share(&self, distance: f32) -> f32 {
        let short = self.middle - distance.abs();
        let corner = (short + self.b).max(0.0).min(self.b);
        let outside = short.max(0.0) * self.per_a + corner * corner * self.per_2ab;
        // 0 for 1, the sign bit for the other side.
        0.5 + (0.5 - outside).copysign(distance)
    }
}

impl Strip {
    pub fn new(bar: &Bar, rows: &Range<i32>) -> Self {
        let normal = bar.direction.perp();
        let side = normal * bar.half;
        let from = HalfPlane::through(bar.from, bar.direction);
        let to = HalfPlane::through(bar.to, -bar.direction);
        let mut ends = [from, to, from, to];
        let mut end_count = 2;
        for (at, trim, sign) in [(bar.from, bar.trims[0], 1.0), (bar.to, bar.trims[1], -1.0)] {
            if let Some(bisector) = trim.and_then(DVec2::try_normalize) {
                ends[end_count] = HalfPlane::through(at, bisector * sign);
                end_count += 1;
            }
        }
        let sides = [
            HalfPlane::through(bar.from - side, normal),
            HalfPlane::through(bar.from + side, -normal),
        ];
        let mut strip = Self {
            normal,
            origin: bar.from,
            half: bar.half,
            edge: EdgeProfile::new(normal),
            reach: (bar.half + sides[0].footprint()) * sides[0].inverse.abs(),
            sides,
            ends,
            end_count,
            free_rows: 0..0,
        };
        strip.free_rows = strip.free_rows(rows);
        strip
    }

    fn ends(&self) -> &[HalfPlane] {
        &self.ends[..self.end_count]
    }

    /// The rows in which the whole width of the strip, with a pixel around, is between its ends.
    ///
    /// The corner of the strip that comes nearest to an end in a row is a point of one of its sides, moved outwards by
    /// half the diagonal of a pixel; the distance from the end is linear along it.
    fn free_rows(&self, rows: &Range<i32>) -> Range<i32> {
        let along = -self.normal.perp();
        if along.y.abs() < 0.1 {
            return 0..0;
        }
        let mut free = [f64::NEG_INFINITY, f64::INFINITY];
        for end in self.ends() {
            let growth = end.normal.dot(along) / along.y;
            if growth.abs() < 1e-9 {
                return 0..0;
            }
            for outwards in [-1.0, 1.0] {
                let point = self.origin + self.normal * (outwards * (self.half + 1.0));
                let missing = end.offset + 1.0 - end.normal.dot(point);
                let bound = point.y + missing / growth;
                if growth > 0.0 {
                    free[0] = free[0].max(bound);
                } else {
                    free[1] = free[1].min(bound);
                }
            }
        }
        let [first, last] = free.map(|y| y - 0.5);
        clamped(first.ceil(), rows)..clamped(last.floor() + 1.0, rows)
    }

    /// The columns that are not beside the strip or beyond its ends.
    #[inline(always)]
    pub fn touched(&self, row: i32, columns: &Range<i32>) -> Range<i32> {
        let centre = f64::from(row) + 0.5;
        let mut interval = [f64::NEG_INFINITY, f64::INFINITY];
        for side in &self.sides {
            narrow_interval(&mut interval, side.columns(centre, -side.footprint()));
        }
        if !self.free_rows.contains(&row) {
            for end in self.ends() {
                narrow_interval(&mut interval, end.columns(centre, -end.footprint()));
            }
        }
        within(interval, columns)
    }

    /// Those of the columns whose pixels see no end.
    #[inline(always)]
    pub fn free(&self, row: i32, touched: &Range<i32>) -> Range<i32> {
        if self.free_rows.contains(&row) {
            return touched.clone();
        }
        let centre = f64::from(row) + 0.5;
        let mut interval = [f64::NEG_INFINITY, f64::INFINITY];
        for end in self.ends() {
            narrow_interval(&mut interval, end.columns(centre, end.footprint()));
        }
        within(interval, touched)
    }

    /// Covers the pixels of rows, those that see an end by `exactly`, and all of a strip that is not narrow.
    #[inline(always)]
    pub fn cover<T: CoverageTarget>(
        &self,
        target: &mut T,
        rows: Range<i32>,
        columns: &Range<i32>,
        exactly: impl Fn(&mut T, Range<i32>),
    ) {
        if !self.is_narrow() {
            return exactly(target, rows);
        }
        let start = self.free_rows.start.clamp(rows.start, rows.end);
        let end = self.free_rows.end.clamp(start, rows.end);
        exactly(target, rows.start..start);
        self.cover_rows(target, start..end, columns);
        exactly(target, end..rows.end);
    }

    /// Whether a row has so few of its pixels that they are found all at once.
    fn is_narrow(&self) -> bool {
        2.0 * self.reach < MANY as f64 && !self.free_rows.is_empty()
    }

    /// Covers pixels of rows that see no end, all of a narrow strip's row at once.
    #[inline(always)]
    fn cover_rows(&self, target: &mut impl CoverageTarget, rows: Range<i32>, columns: &Range<i32>) {
        // An interval of a length below N has at most N whole numbers.
        match 2.0 * self.reach {
            length if length < 3.0 => self.cover_few::<3, 4>(target, rows, columns),
            length if length < 4.0 => self.cover_few::<4, 4>(target, rows, columns),
            length if length < 6.0 => self.cover_few::<6, LANES>(target, rows, columns),
            length if length < 8.0 => self.cover_few::<8, LANES>(target, rows, columns),
            length if length < 12.0 => self.cover_few::<12, MANY>(target, rows, columns),
            _ => self.cover_few::<MANY, MANY>(target, rows, columns),
        }
    }

    /// `N` pixels of each row, computed as `WIDTH` at once; those that the strip does not touch are covered by 0.
    ///
    /// In blocks: first the coverages of all rows, then the target. Rows of a picture lie far apart in memory, and with
    /// little to do between them a processor waits for many at once.
    #[inline(always)]
    fn cover_few<const N: usize, const WIDTH: usize>(
        &self,
        target: &mut impl CoverageTarget,
        rows: Range<i32>,
        columns: &Range<i32>,
    ) {
        let mut shares = [[0.0; WIDTH]; BLOCK];
        let mut top = rows.start;
        while top < rows.end {
            let count = (top..rows.end).len().min(BLOCK);
            let (firsts, inside) = self.first_pixels(top);
            for (shares, inside) in shares[..count].iter_mut().zip(&inside) {
                *shares = self.shares_from(*inside);
            }
            for ((row, first), shares) in (top..).zip(&firsts[..count]).zip(&shares) {
                cover_within::<N>(target, row, *first, &shares[..N], columns);
            }
            top = top.saturating_add(16);
        }
    }

    /// Of each row from `top` on: the first column whose pixel's centre is within reach, and how far inside of both
    /// sides it is, the other side's counted as negative.
    #[inline(always)]
    fn first_pixels(&self, top: i32) -> ([f64; BLOCK], [[f32; 2]; BLOCK]) {
        let drift = -self.normal.y * self.sides[0].inverse;
        let down = f64::from(top) + 0.5 - self.origin.y;
        let left = self.origin.x - self.reach - 0.5;
        let mut firsts = [0.0; BLOCK];
        let mut inside = [[0.0; 2]; BLOCK];
        for row in 0..BLOCK {
            let down = down + row as f64;
            let first = (left + drift * down).ceil();
            let right = first + 0.5 - self.origin.x;
            let distance = self.normal.x * right + self.normal.y * down;
            firsts[row] = first;
            inside[row] = [narrow(distance + self.half), narrow(distance - self.half)];
        }
        (firsts, inside)
    }

    /// The shares of pixels of a row of which the first one is so far inside.
    #[inline(always)]
    fn shares_from<const WIDTH: usize>(&self, inside: [f32; 2]) -> [f32; WIDTH] {
        let step = narrow(self.normal.x);
        if 2 * WIDTH == LANES {
            // Both sides in one vector.
            let both: [f32; LANES] = std::array::from_fn(|lane| {
                let gone = step * LANE[lane % WIDTH];
                self.edge.share(inside[lane / WIDTH] + gone)
            });
            std::array::from_fn(|lane| both[lane] - both[lane + WIDTH])
        } else {
            std::array::from_fn(|lane| {
                let gone = step * LANE[lane];
                self.edge.share(inside[0] + gone) - self.edge.share(inside[1] + gone)
            })
        }
    }

    /// Adds the coverages of pixels of a row that see no end.
    #[inline(always)]
    pub fn add(&self, row: i32, left: i32, sums: &mut [f32]) {
        let mut column = left;
        for sums in sums.chunks_mut(LANES) {
            let centre = DVec2::new(f64::from(column), f64::from(row)) + 0.5 - self.origin;
            let distance = self.normal.dot(centre);
            let inside = [distance + self.half, distance - self.half].map(narrow);
            let shares: [f32; LANES] = self.shares_from(inside);
            for (sum, share) in sums.iter_mut().zip(shares) {
                *sum += share;
            }
            column += 8;
        }
    }
}

/// Pixels at once.
const LANES: usize = 8;

/// Rows at once.
const BLOCK: usize = 16;

/// As many as a row of a line of width 1 has whose columns are seven times its rows.
const MANY: usize = 16;

/// 0, 1, 2 and so on.
const LANE: [f32; MANY] = {
    let mut lanes = [0.0; MANY];
    let mut lane = 1;
    while lane < MANY {
        lanes[lane] = lanes[lane - 1] + 1.0;
        lane += 1;
    }
    lanes
};

/// Covers pixels of a row from column `first` on, as far as they are in the columns.
#[inline(always)]
fn cover_within<const N: usize>(
    target: &mut impl CoverageTarget,
    row: i32,
    first: f64,
    shares: &[f32],
    columns: &Range<i32>,
) {
    let [start, end] = [f64::from(columns.start), f64::from(columns.end)];
    if first >= start && first + N as f64 <= end {
        target.cover(row, clamped(first, columns), shares);
    } else if first < end && first + N as f64 > start {
        let seen = clamped(first, columns)..clamped(first + N as f64, columns);
        let skipped = (0..N).find(|&n| first + n as f64 >= start).unwrap_or(0);
        target.cover(row, seen.start, &shares[skipped..skipped + seen.len()]);
    }
}

#[inline(always)]
fn narrow_interval(interval: &mut [f64; 2], other: [f64; 2]) {
    *interval = [interval[0].max(other[0]), interval[1].min(other[1])];
}

/// The whole numbers of an interval within a range.
#[inline(always)]
fn within([low, high]: [f64; 2], range: &Range<i32>) -> Range<i32> {
    let start = clamped(low.ceil(), range);
    start..clamped(high.floor() + 1.0, range).max(start)
}
