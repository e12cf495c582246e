//! Contours cut into chains that run down, inside the picture.

use super::Outline;
use core::ops::Range;
use glam::DVec2;

/// A straight piece of a chain; no part of it is horizontal or outside of the picture.
#[derive(Debug, Clone, Copy)]
pub(super) struct Segment {
    pub top: f64,
    pub bottom: f64,
    /// x at the top.
    x: f64,
    /// Change of x per unit of y.
    slope: f64,
}

impl Segment {
    /// Change of x from a row to the next one.
    pub fn slope(&self) -> f64 {
        self.slope
    }

    /// x at a y between top and bottom.
    #[inline]
    pub fn x_at(&self, y: f64) -> f64 {
        self.x + (y - self.top) * self.slope
    }
}

/// Segments one below the other, that a contour runs through in one direction.
#[derive(Debug, Clone, Copy)]
pub(super) struct Chain {
    /// Its first segment and the one behind its last.
    pub first: usize,
    pub end: usize,
    /// y of its upper end.
    pub top: f64,
    /// 1 if the contour runs down, -1 if it runs up: the change of the winding number from left to right.
    pub sign: i32,
}

/// The chains of outlines, in memory that is used again.
///
/// What lies to the left of the picture runs along its left edge instead, and what lies to the right along its right
/// edge: neither changes an area inside. What lies above or below is left out.
#[derive(Debug, Clone, Default)]
pub(super) struct Chains {
    pub segments: Vec<Segment>,
    pub chains: Vec<Chain>,
    width: f64,
    top: f64,
    bottom: f64,
}

/// An outline among the chains.
#[derive(Debug, Clone)]
pub(super) struct Cut {
    /// Its chains, from top to bottom.
    pub chains: Range<usize>,
    /// The winding number inside, if the outline is one convex contour.
    pub convex: Option<i32>,
}

impl Chains {
    /// Forgets all of them.
    pub fn clear(&mut self) {
        self.segments.clear();
        self.chains.clear();
    }

    /// Adds an outline, cut at the edges of some rows of a picture and where it turns up or down.
    pub fn cut(&mut self, outline: &Outline, width: usize, rows: &Range<usize>) -> Cut {
        self.width = width as f64;
        (self.top, self.bottom) = (rows.start as f64, rows.end as f64);
        let first = self.chains.len();
        let mut contours = 0;
        let mut convex = None;
        let drawn = outline.contours().filter(|_| outline.is_finite());
        for contour in drawn {
            self.add(contour);
            contours += 1;
            convex = if contours == 1 {
                convex_winding(contour)
            } else {
                None
            };
        }
        self.chains[first..].sort_unstable_by(|a, b| a.top.total_cmp(&b.top));
        Cut {
            chains: first..self.chains.len(),
            convex,
        }
    }

    fn add(&mut self, contour: &[DVec2]) {
        let mut from = contour[contour.len() - 1];
        let mut first = self.segments.len();
        let mut sign = 0;
        for &to in contour {
            let direction = i32::from(to.y > from.y) - i32::from(to.y < from.y);
            if direction != 0 {
                if direction != sign {
                    self.end_chain(first, sign);
                    (first, sign) = (self.segments.len(), direction);
                }
                self.add_edge(from, to, direction);
            }
            from = to;
        }
        self.end_chain(first, sign);
    }

    /// Makes a chain of the segments from `first` on.
    fn end_chain(&mut self, first: usize, sign: i32) {
        let end = self.segments.len();
        if first == end {
            return;
        }
        if sign < 0 {
            self.segments[first..].reverse();
        }
        let top = self.segments[first].top;
        self.chains.push(Chain {
            first,
            end,
            top,
            sign,
        });
    }

    /// Adds the part of an edge within the picture's rows, in the order in which the contour runs through it.
    fn add_edge(&mut self, from: DVec2, to: DVec2, direction: i32) {
        let (upper, lower) = if direction > 0 {
            (from, to)
        } else {
            (to, from)
        };
        if lower.y <= self.top || upper.y >= self.bottom {
            return;
        }
        let slope = (lower.x - upper.x) / (lower.y - upper.y);
        let top = upper.y.max(self.top);
        let bottom = lower.y.min(self.bottom);
        // From the nearer end, so that little is lost where an edge is far longer than the picture.
        let near = |y: f64| match y - upper.y < lower.y - y {
            true => upper.x + (y - upper.y) * slope,
            false => lower.x + (y - lower.y) * slope,
        };
        let (x_top, x_bottom) = (near(top), near(bottom));
        if x_top.min(x_bottom) >= 0.0 && x_top.max(x_bottom) <= self.width {
            self.segments.push(Segment {
                top,
                bottom,
                x: x_top,
                slope,
            });
        } else {
            self.add_clipped([top, bottom], [x_top, x_bottom], direction);
        }
    }

    /// Adds an edge that leaves the picture's columns, in up to three segments.
    fn add_clipped(
        &mut self,
        [top, bottom]: [f64; 2],
        [x_top, x_bottom]: [f64; 2],
        direction: i32,
    ) {
        let first = self.segments.len();
        let mut cuts = [top, top, top, bottom];
        if x_top != x_bottom {
            let y_at = |x: f64| top + (bottom - top) * ((x - x_top) / (x_bottom - x_top));
            let (a, b) = (y_at(0.0), y_at(self.width));
            cuts[1] = a.min(b).clamp(top, bottom);
            cuts[2] = a.max(b).clamp(top, bottom);
        }
        let x_at = |y: f64| x_top + (x_bottom - x_top) * ((y - top) / (bottom - top));
        for pair in cuts.windows(2).filter(|pair| pair[0] < pair[1]) {
            let [start, end] = [pair[0], pair[1]].map(|y| x_at(y).clamp(0.0, self.width));
            self.segments.push(Segment {
                top: pair[0],
                bottom: pair[1],
                x: start,
                slope: (end - start) / (pair[1] - pair[0]),
            });
        }
        if direction < 0 {
            self.segments[first..].reverse();
        }
    }
}

/// The winding number inside of a convex contour; none if it is not convex: it turns to one side only, and its y turns
/// back twice, so it goes around once.
fn convex_winding(contour: &[DVec2]) -> Option<i32> {
    let count = contour.len();
    let mut before = contour[count - 1] - contour[count.checked_sub(2)?];
    let mut from = contour[count - 1];
    let (mut turns_left, mut turns_right) = (false, false);
    let (mut first_down, mut down, mut changes) = (None, None, 0);
    for &to in contour {
        let edge = to - from;
        let turn = before.perp_dot(edge);
        turns_left |= turn < 0.0;
        turns_right |= turn > 0.0;
        if turns_left && turns_right {
            return None;
        }
        if edge.y != 0.0 {
            changes += i32::from(down.is_some_and(|down| down != (edge.y > 0.0)));
            down = Some(edge.y > 0.0);
            first_down = first_down.or(down);
        }
        (before, from) = (edge, to);
    }
    changes += i32::from(down != first_down);
    (changes == 2).then_some(if turns_right { -1 } else { 1 })
}
