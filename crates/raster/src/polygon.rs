//! Polygons, filled row by row with an active edge table.
//!
//! A polygon is any number of closed contours; they may cut themselves and each other, and a [`FillRule`] says what is
//! inside. For every row the edges that cross its centre line are *active*; sorted by where they do, they are the ends
//! of the row's spans (Wylie, Romney, Evans and Erdahl, *Half-tone perspective drawings by computer*, AFIPS 1967; the
//! tables as in Foley and van Dam, section 3.6). The crossings of an edge are computed from the edge alone and anew in
//! each row: nothing drifts, and a part of the picture gets the bits of the whole.
//!
//! Pixel `(x, y)` is the unit square between `(x, y)` and `(x + 1, y + 1)`; it is drawn if its centre is inside. On
//! edges the rule is that of triangles (top-left): a centre exactly on an edge belongs to what is below it, or on a
//! vertical or slanted edge to what is right of it. Polygons that share an edge, with the same two ends, so draw every
//! pixel along it exactly once.
//!
//! # Current state
//! Coordinates are f64 and are not snapped, as those of [`triangle`](crate::triangle) are to 1/256 of a pixel. A crossing
//! is rounded, with an error of some 2^-52 of the largest coordinate of its edge; multiples of 1/256 up to 2^18 are
//! filled as exact arithmetic has it. A polygon with a coordinate that is not finite is not drawn. Nothing here panics.

use crate::target::Target;
use glam::DVec2;

/// What is inside of contours that overlap.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum FillRule {
    /// What a ray from outside reaches through an odd number of edges: overlaps are holes.
    EvenOdd,
    /// What the contours wind around, in total, in one direction more often than in the other.
    #[default]
    NonZero,
}

impl FillRule {
    fn is_inside(self, winding: i32) -> bool {
        match self {
            Self::EvenOdd => winding & 1 != 0,
            Self::NonZero => winding != 0,
        }
    }
}

/// Fills contours, given by their corners; the last one is joined to the first. Spans come row by row from the top, from
/// left to right, and no pixel twice.
///
/// Only rows of the window are looked at. A contour of less than three corners has no inside.
///
/// ```
/// use glam::Vec2;
/// use hemicube_raster::Image;
/// use hemicube_raster::polygon::{FillRule, fill_polygon};
///
/// let mut image = Image::filled(4, 3, '.');
/// let triangle = [(0.0, 0.0), (4.0, 0.0), (0.0, 4.0)].map(Vec2::from);
/// fill_polygon(&mut image.pen('#'), [triangle], FillRule::EvenOdd);
/// let rows: Vec<String> = image.pixels().chunks(4).map(|row| row.iter().collect()).collect();
/// assert_eq!(rows, ["###.", "##..", "#..."]);
/// ```
pub fn fill_polygon<C>(
    target: &mut impl Target,
    contours: impl IntoIterator<Item = C>,
    rule: FillRule,
) where
    C: IntoIterator<Item: Into<DVec2>>,
{
    let window = target.window();
    if window.is_empty() {
        return;
    }
    let rows = Rows {
        top: window.top,
        bottom: window.bottom,
    };
    let Some(mut edges) = edge_table(contours, rows) else {
        return;
    };
    edges.sort_by_key(|edge| edge.first_row);
    let mut waiting = edges.into_iter().peekable();
    let mut active: Vec<Edge> = Vec::new();
    let mut row = match waiting.peek() {
        Some(edge) => edge.first_row,
        None => return,
    };
    loop {
        while let Some(edge) = waiting.next_if(|edge| edge.first_row <= row) {
            active.push(edge);
        }
        active.iter_mut().for_each(|edge| edge.cross(row));
        // From one row to the next few edges change places, which this sort is quick at.
        active.sort_by(|a, b| a.x.total_cmp(&b.x));
        draw_row(target, &active, rule, row);
        row += 1;
        active.retain(|edge| edge.end_row > row);
        if active.is_empty() {
            // On to the next edge, whatever lies between.
            match waiting.peek() {
                Some(edge) => row = row.max(edge.first_row),
                None => return,
            }
        }
    }
}

/// The rows of a window.
#[derive(Debug, Clone, Copy)]
struct Rows {
    top: i32,
    bottom: i32,
}

impl Rows {
    /// The first row whose centre line is at `y` or below it, within the window and the row behind it.
    fn first_from(self, y: f64) -> i32 {
        clamped((y - 0.5).ceil(), self.top, self.bottom)
    }
}

/// A whole number moved between two others.
#[expect(
    clippy::cast_possible_truncation,
    reason = "between two 32-bit numbers"
)]
fn clamped(number: f64, low: i32, high: i32) -> i32 {
    number.max(f64::from(low)).min(f64::from(high)) as i32
}

/// An edge that crosses the centre line of a row of the window.
#[derive(Debug, Clone, Copy)]
struct Edge {
    upper: DVec2,
    /// Half of what its lower end is off the upper one.
    half: DVec2,
    /// The smaller and the larger x of its ends.
    x_range: [f64; 2],
    first_row: i32,
    /// Row behind the last one.
    end_row: i32,
    /// 1 if its contour goes down here, -1 if up.
    winding: i32,
    /// Where it crosses the present row's centre line.
    x: f64,
}

impl Edge {
    /// `None` if it crosses the centre line of no row. Computed from its upper end whichever way its contour goes.
    fn new(from: DVec2, to: DVec2, rows: Rows) -> Option<Self> {
        let (upper, lower, winding) = if from.y <= to.y {
            (from, to, 1)
        } else {
            (to, from, -1)
        };
        let [first_row, end_row] = [upper.y, lower.y].map(|y| rows.first_from(y));
        (first_row < end_row).then(|| {
            // Halves, because the difference of two finite numbers may not be finite.
            let half = lower * 0.5 - upper * 0.5;
            Self {
                upper,
                half,
                x_range: [upper.x.min(lower.x), upper.x.max(lower.x)],
                first_row,
                end_row,
                winding,
                x: upper.x,
            }
        })
    }

    fn cross(&mut self, row: i32) {
        let centre = f64::from(row) + 0.5;
        // Divided last: where coordinates have few digits, nothing but the quotient is rounded, and a crossing exactly
        // at a pixel's centre is found there.
        let x = self.upper.x + (centre - self.upper.y) * self.half.x / self.half.y;
        // Rounding must not carry it beyond its ends, nor a product that overflows.
        self.x = x.max(self.x_range[0]).min(self.x_range[1]);
    }
}

/// All edges that cross rows; `None` if a coordinate is not finite.
fn edge_table<C>(contours: impl IntoIterator<Item = C>, rows: Rows) -> Option<Vec<Edge>>
where
    C: IntoIterator<Item: Into<DVec2>>,
{
    let mut edges = Vec::new();
    for contour in contours {
        let mut corners = contour.into_iter().map(Into::into);
        let Some(first) = corners.next() else {
            continue;
        };
        let mut from: DVec2 = first;
        for to in corners.chain([first]) {
            if !from.is_finite() {
                return None;
            }
            edges.extend(Edge::new(from, to, rows));
            from = to;
        }
    }
    Some(edges)
}

/// Draws the spans between edges sorted by their crossings.
fn draw_row(target: &mut impl Target, active: &[Edge], rule: FillRule, row: i32) {
    let window = target.window();
    // The first pixel whose centre is at x or right of it.
    let column = |x: f64| clamped((x - 0.5).ceil(), window.left, window.right);
    let mut winding = 0;
    let mut start = window.left;
    for edge in active {
        let was_inside = rule.is_inside(winding);
        winding += edge.winding;
        let is_inside = rule.is_inside(winding);
        if is_inside && !was_inside {
            start = column(edge.x);
        } else if was_inside && !is_inside {
            let end = column(edge.x);
            if start < end {
                target.span(row, start..end);
            }
        }
    }
}
