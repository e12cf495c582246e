//! The exact area of a polygon in each pixel of a row.

use super::narrow;
use core::ops::Range;
use glam::DVec2;

/// The edges of a polygon, cut to a row of pixels.
///
/// An edge covers, in a pixel from `x` to `x + 1`, all that is right of it: the integral of `clamp(x + 1 - edge, 0, 1)`
/// over its rows. Edges that go up (on the left, clockwise) count positive, those that go down negative; they sum up to
/// the area of the polygon, by Green's theorem.
#[derive(Debug, Default)]
pub(super) struct RowEdges {
    edges: Vec<RowEdge>,
}

#[derive(Debug, Clone, Copy)]
struct RowEdge {
    /// Both ends, relative to the right border of the present pixel; positive to the left of it.
    ends: [f64; 2],
    /// Rows that it spans, positive if it goes up.
    height: f64,
}

impl RowEdges {
    /// Adds the areas of a polygon in some pixels of a row to `sums`; clockwise polygons have positive areas.
    pub fn add(&mut self, corners: &[DVec2], row: i32, left: i32, sums: &mut [f32]) {
        self.cut(corners, f64::from(row), f64::from(left) + 1.0);
        for sum in sums {
            *sum += narrow(self.edges.iter().map(RowEdge::area).sum());
            for edge in &mut self.edges {
                edge.ends = edge.ends.map(|end| end + 1.0);
            }
        }
    }

    /// Those of some columns that a polygon touches in a row.
    pub fn bounds(corners: &[DVec2], row: i32, columns: Range<i32>) -> Range<i32> {
        let mut bounds = [f64::INFINITY, f64::NEG_INFINITY];
        for_each_cut(corners, f64::from(row), |x, _| {
            bounds[0] = bounds[0].min(x[0].min(x[1]));
            bounds[1] = bounds[1].max(x[0].max(x[1]));
        });
        let start = super::clamped(bounds[0].floor(), &columns);
        start..super::clamped(bounds[1].ceil(), &columns).max(start)
    }

    fn cut(&mut self, corners: &[DVec2], row: f64, right: f64) {
        self.edges.clear();
        for_each_cut(corners, row, |x, height| {
            let ends = x.map(|x| right - x);
            self.edges.push(RowEdge { ends, height });
        });
    }
}

/// Calls `edge` with the x of both ends and the signed height of each edge's part within a row.
fn for_each_cut(corners: &[DVec2], row: f64, mut edge: impl FnMut([f64; 2], f64)) {
    let Some(&last) = corners.last() else {
        return;
    };
    let mut from = last;
    for &to in corners {
        let [y0, y1] = [from.y, to.y].map(|y| (y - row).clamp(0.0, 1.0));
        if y0 != y1 {
            let x_at = |y: f64| {
                let share = (row + y - from.y) / (to.y - from.y);
                from.x + (to.x - from.x) * share.clamp(0.0, 1.0)
            };
            edge([x_at(y0), x_at(y1)], y0 - y1);
        }
        from = to;
    }
}

impl RowEdge {
    /// The area right of it in the present pixel, with its sign.
    #[inline(always)]
    fn area(&self) -> f64 {
        let [start, end] = self.ends;
        let length = end - start;
        let width = if length.abs() < 1e-6 {
            (0.5 * (start + end)).clamp(0.0, 1.0)
        } else {
            (integral(end) - integral(start)) / length
        };
        width * self.height
    }
}

/// The integral of `clamp(u, 0, 1)` from 0 on.
#[inline(always)]
fn integral(u: f64) -> f64 {
    let within = u.clamp(0.0, 1.0);
    0.5 * within * within + (u - 1.0).max(0.0)
}
