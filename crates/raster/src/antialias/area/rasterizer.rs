//! Rows of a picture, from chains to spans of coverage.

use super::accumulate::{self, Piece, settled_pixel};
use super::chain::{Chain, Chains, Cut, Segment};
use super::winding::{Edge, Resolver, step};
use super::{Blend, FillRule, Outline, Pixel};
use crate::Image;
use crate::signed_area::SignedArea;
use core::ops::Range;

/// What becomes of coverage: rows come from top to bottom, and spans of a row from left to right. Pixels that are not
/// named have none.
pub trait Spans {
    /// Coverage in (0, 1] of each pixel of row `y` from column `x` on; single values may be 0.
    fn cells(&mut self, y: usize, x: usize, coverage: &[f32]);

    /// Coverage of eight pixels: as [`cells`](Self::cells) unless a receiver is faster at it.
    #[inline(always)]
    fn block(&mut self, y: usize, x: usize, coverage: &[f32; 8]) {
        self.cells(y, x, coverage);
    }

    /// One coverage in (0, 1] of all pixels of row `y` from column `start` to before `end`; mostly 1, the inside.
    fn run(&mut self, y: usize, start: usize, end: usize, coverage: f32);
}

/// Finds the coverage of outlines in a picture's pixels; keeps its memory from one to the next.
#[derive(Debug, Clone)]
pub struct Rasterizer {
    width: usize,
    rows: Range<usize>,
    chains: Chains,
    active: Vec<Active>,
    row: Row,
    areas: Vec<SignedArea>,
    sides: Vec<Side>,
    resolver: Resolver,
}

/// A segment through some rows as a whole, with the change of coverage from its left to its right.
#[derive(Debug, Clone, Copy)]
struct Side {
    segment: Segment,
    /// x at the top of the current row.
    x: f64,
    sign: i32,
    change: f32,
    /// See [`SignedArea::per_2w`].
    per_2w: f32,
}

impl Side {
    /// What it covers of the next row.
    #[inline(always)]
    fn next(&mut self, bottom: f64) -> SignedArea {
        let (a, b) = (self.x, self.segment.x_at(bottom));
        self.x = b;
        let (left, right) = if a < b { (a, b) } else { (b, a) };
        SignedArea {
            left,
            right,
            per_2w: self.per_2w,
            height: self.change,
        }
    }
}

/// A chain with the segment in which the current row begins.
#[derive(Debug, Clone, Copy)]
struct Active {
    segment: usize,
    end: usize,
    sign: i32,
}

/// What runs through the current row.
#[derive(Debug, Clone, Default)]
struct Row {
    edges: Vec<Edge>,
    strands: Vec<Strand>,
}

/// The part of a chain in a row.
#[derive(Debug, Clone, Copy)]
struct Strand {
    /// Its first edge and the one behind its last.
    first: usize,
    end: usize,
    sign: i32,
    walked: Walked,
}

/// What is known of a strand as a whole.
#[derive(Debug, Clone, Copy)]
struct Walked {
    left: f64,
    right: f64,
    /// Whether it runs from the row's top to its bottom.
    is_full: bool,
}

impl Rasterizer {
    /// For pictures of so many pixels across and down.
    pub fn new(width: usize, height: usize) -> Self {
        Self::for_rows(width, 0..height)
    }

    /// For some rows of a picture of so many pixels across; coordinates are those of the whole picture.
    pub fn for_rows(width: usize, rows: Range<usize>) -> Self {
        Self {
            width,
            rows,
            chains: Chains::default(),
            active: Vec::new(),
            row: Row::default(),
            areas: Vec::new(),
            sides: Vec::new(),
            resolver: Resolver::default(),
        }
    }

    /// Hands out the coverage of an outline.
    pub fn rasterize(&mut self, outline: &Outline, rule: FillRule, spans: &mut impl Spans) {
        let mut chains = core::mem::take(&mut self.chains);
        chains.clear();
        let cut = chains.cut(outline, self.width, &self.rows);
        self.rasterize_cut(&chains, &cut, rule, spans);
        self.chains = chains;
    }

    /// Hands out the coverage of an outline that was cut for this rasteriser's rows.
    pub(super) fn rasterize_cut(
        &mut self,
        chains: &Chains,
        cut: &Cut,
        rule: FillRule,
        spans: &mut impl Spans,
    ) {
        self.active.clear();
        let mut waiting = chains.chains[cut.chains.clone()].iter().peekable();
        let mut y = self.rows.start;
        while y < self.rows.end {
            if self.active.is_empty() {
                let Some(chain) = waiting.peek() else {
                    break;
                };
                y = row_of(chain.top);
            }
            let bottom = (y + 1) as f64;
            while let Some(chain) = waiting.next_if(|chain| chain.top < bottom) {
                self.active.push(Active::new(chain));
            }
            let next = waiting
                .peek()
                .map_or(self.rows.end, |chain| row_of(chain.top));
            let end = self.straight_rows(chains, y, next);
            if y < end && self.take_sides(chains, y, end, (rule, cut.convex)) {
                self.straight(y..end, spans);
                self.leave(chains, end);
                y = end;
                continue;
            }
            match cut.convex {
                Some(winding) => self.convex_row(chains, y, winding, spans),
                None => self.row(chains, y, rule, spans),
            }
            y += 1;
        }
    }

    /// Blends an outline into a picture: `pixel + coverage opacity (value - pixel)`, in linear light.
    ///
    /// Panics if the picture does not have this rasteriser's rows.
    pub fn fill<P: Pixel>(
        &mut self,
        outline: &Outline,
        rule: FillRule,
        image: &mut Image<P>,
        value: P,
        opacity: f32,
    ) {
        let size = (image.width(), 0..image.height());
        assert_eq!(size, (self.width, self.rows.clone()), "the picture");
        let mut blend = Blend::new(image.pixels_mut(), self.width, 0, value, opacity);
        self.rasterize(outline, rule, &mut blend);
    }

    /// The first row from `y` on in which a segment begins or ends, or a chain of which the first row is `next`.
    #[inline]
    fn straight_rows(&self, chains: &Chains, y: usize, next: usize) -> usize {
        let mut end = next.min(self.rows.end);
        for chain in &self.active {
            let segment = &chains.segments[chain.segment];
            if segment.top > y as f64 {
                return y;
            }
            end = end.min(row_of(segment.bottom));
        }
        end
    }

    /// Notes the segments through some rows, in which none begins or ends, from left to right; false if some may cross.
    #[inline]
    fn take_sides(
        &mut self,
        chains: &Chains,
        y: usize,
        end: usize,
        (rule, convex): (FillRule, Option<i32>),
    ) -> bool {
        self.sides.clear();
        self.sides.extend(self.active.iter().map(|chain| {
            let segment = chains.segments[chain.segment];
            Side {
                segment,
                x: segment.x_at(y as f64),
                sign: chain.sign,
                change: 0.0,
                per_2w: SignedArea::per_twice(segment.slope().abs()),
            }
        }));
        let bottom = end as f64;
        let before = |a: &Side, b: &Side| {
            let below = |side: &Side| side.segment.x_at(bottom);
            a.x < b.x || (a.x == b.x && below(a) <= below(b))
        };
        if !self.sides.is_sorted_by(before) {
            self.sides.sort_by(|a, b| {
                let below = |side: &Side| side.segment.x_at(bottom);
                let by_top = a.x.total_cmp(&b.x);
                by_top.then_with(|| below(a).total_cmp(&below(b)))
            });
        }
        if !self
            .sides
            .is_sorted_by_key(|side| side.segment.x_at(bottom))
        {
            return false;
        }
        match convex {
            Some(winding) => {
                for side in &mut self.sides {
                    side.change = whole(side.sign * winding);
                }
            }
            None => {
                let mut winding = 0;
                for side in &mut self.sides {
                    side.change = step(rule, &mut winding, side.sign);
                }
                self.sides.retain(|side| side.change != 0.0);
            }
        }
        true
    }

    /// Rows through which the noted segments run.
    fn straight(&mut self, rows: Range<usize>, spans: &mut impl Spans) {
        for y in rows {
            let bottom = (y + 1) as f64;
            self.areas.clear();
            let sides = self.sides.iter_mut();
            self.areas.extend(sides.map(|side| side.next(bottom)));
            accumulate::emit(&self.areas, [y, self.width], settled_pixel, spans);
        }
    }

    /// Goes on with the next segments where one ends at the top of a row.
    #[inline]
    fn leave(&mut self, chains: &Chains, row: usize) {
        self.active.retain_mut(|chain| {
            if chains.segments[chain.segment].bottom <= row as f64 {
                chain.segment += 1;
            }
            chain.segment < chain.end
        });
    }

    /// A row of a convex contour: all edges count, and the winding number inside is known.
    fn convex_row(&mut self, chains: &Chains, y: usize, winding: i32, spans: &mut impl Spans) {
        let areas = &mut self.areas;
        areas.clear();
        self.active.retain_mut(|chain| {
            let sign = whole(chain.sign * winding);
            walk(chains, chain, y, |piece| {
                areas.push(signed_area(piece, sign));
            });
            chain.segment < chain.end
        });
        self.emit(y, settled_pixel, spans);
    }

    /// A row of any outline.
    fn row(&mut self, chains: &Chains, y: usize, rule: FillRule, spans: &mut impl Spans) {
        self.row.collect(chains, &mut self.active, y);
        self.row.sort();
        self.areas.clear();
        if self.row.is_ordered() {
            self.add_ordered(rule);
        } else if !self.resolve(rule) {
            self.add_unordered();
            return self.emit(y, |mean| settled_pixel(rule.fold(mean)), spans);
        }
        self.emit(y, settled_pixel, spans);
    }

    fn emit(&mut self, y: usize, fold: impl Fn(f32) -> f32, spans: &mut impl Spans) {
        accumulate::sort(&mut self.areas);
        accumulate::emit(&self.areas, [y, self.width], fold, spans);
    }

    /// Strands side by side: the winding number is counted from left to right.
    fn add_ordered(&mut self, rule: FillRule) {
        let mut winding = 0;
        for strand in &self.row.strands {
            let change = step(rule, &mut winding, strand.sign);
            if change != 0.0 {
                let edges = &self.row.edges[strand.first..strand.end];
                let areas = edges.iter().map(|edge| signed_area(&edge.piece, change));
                self.areas.extend(areas);
            }
        }
    }

    /// Strands that begin, end or cross; false if there is too much of that.
    fn resolve(&mut self, rule: FillRule) -> bool {
        let areas = &mut self.areas;
        self.resolver
            .resolve(&self.row.edges, rule, &mut |piece, change| {
                areas.push(signed_area(piece, change));
            })
    }

    /// All strands with their signs: the running sum is the mean winding number.
    fn add_unordered(&mut self) {
        let edges = self.row.edges.iter();
        self.areas
            .extend(edges.map(|edge| signed_area(&edge.piece, whole(edge.sign))));
    }
}

/// What a piece of an edge covers where the area begins or ends.
#[inline(always)]
fn signed_area(piece: &Piece, change: f32) -> SignedArea {
    #[expect(clippy::cast_possible_truncation, reason = "at most 1")]
    let height = (piece.bottom - piece.top) as f32;
    SignedArea::new([piece.x_top, piece.x_bottom], height * change)
}

/// A small whole number.
#[inline(always)]
fn whole(number: i32) -> f32 {
    number as f32
}

impl Active {
    fn new(chain: &Chain) -> Self {
        Self {
            segment: chain.first,
            end: chain.end,
            sign: chain.sign,
        }
    }
}

impl Row {
    /// Collects what runs through a row; chains that end in it are active no longer.
    #[inline]
    fn collect(&mut self, chains: &Chains, active: &mut Vec<Active>, y: usize) {
        self.edges.clear();
        self.strands.clear();
        active.retain_mut(|chain| {
            let first = self.edges.len();
            let sign = chain.sign;
            let edge = |piece: &Piece| Edge {
                piece: *piece,
                sign,
            };
            let walked = walk(chains, chain, y, |piece| self.edges.push(edge(piece)));
            self.strands.push(Strand {
                first,
                end: self.edges.len(),
                sign,
                walked,
            });
            chain.segment < chain.end
        });
    }

    /// Sorts the strands from left to right.
    fn sort(&mut self) {
        if !self
            .strands
            .is_sorted_by(|a, b| a.walked.left <= b.walked.left)
        {
            self.strands
                .sort_by(|a, b| a.walked.left.total_cmp(&b.walked.left));
        }
    }

    /// Whether no strand begins or ends or may cross another one.
    fn is_ordered(&self) -> bool {
        let is_apart = |pair: &[Strand]| pair[0].walked.right <= pair[1].walked.left;
        self.strands.iter().all(|strand| strand.walked.is_full)
            && self.strands.windows(2).all(is_apart)
    }
}

/// Hands out the pieces of a chain in a row, and goes on to the segment with which the next row begins.
#[inline]
fn walk(chains: &Chains, chain: &mut Active, y: usize, mut each: impl FnMut(&Piece)) -> Walked {
    let (row_top, row_bottom) = (y as f64, (y + 1) as f64);
    let starts_above = chains.segments[chain.segment].top <= row_top;
    let (mut left, mut right) = (f64::INFINITY, f64::NEG_INFINITY);
    loop {
        let segment = &chains.segments[chain.segment];
        let (top, bottom) = (segment.top.max(row_top), segment.bottom.min(row_bottom));
        let (x_top, x_bottom) = (segment.x_at(top), segment.x_at(bottom));
        left = left.min(x_top).min(x_bottom);
        right = right.max(x_top).max(x_bottom);
        each(&Piece {
            top,
            bottom,
            x_top,
            x_bottom,
        });
        if segment.bottom <= row_bottom {
            chain.segment += 1;
            if chain.segment < chain.end && segment.bottom < row_bottom {
                continue;
            }
        }
        let is_full = starts_above && bottom == row_bottom;
        return Walked {
            left,
            right,
            is_full,
        };
    }
}

/// The row in which a y lies.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "chains begin within the picture"
)]
fn row_of(y: f64) -> usize {
    y as usize
}
