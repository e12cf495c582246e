//! Contours cut into chains that run down, inside the picture.

use super::Outline;
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

/// The chains of an outline from top to bottom, in memory that is used again.
///
/// What lies to the left of the picture runs along its left edge instead, and what lies to the right along its right
/// edge: neither changes an area inside. What lies above or below is left out.
#[derive(Debug, Clone, Default)]
pub(super) struct Chains {
    pub segments: Vec<Segment>,
    pub chains: Vec<Chain>,
    width: f64,
    height: f64,
}

impl Chains {
    /// Cuts an outline at the edges of a picture and where it turns up or down.
    pub fn set(&mut self, outline: &Outline, width: usize, height: usize) {
        self.segments.clear();
        self.chains.clear();
        (self.width, self.height) = (width as f64, height as f64);
        if outline.is_finite() {
            for contour in outline.contours() {
                self.add(contour);
            }
        }
        self.chains.sort_unstable_by(|a, b| a.top.total_cmp(&b.top));
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
        if lower.y <= 0.0 || upper.y >= self.height {
            return;
        }
        let slope = (lower.x - upper.x) / (lower.y - upper.y);
        let top = upper.y.max(0.0);
        let bottom = lower.y.min(self.height);
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
