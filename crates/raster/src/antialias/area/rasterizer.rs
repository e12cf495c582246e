//! Rows of a picture, from chains to spans of coverage.

use super::accumulate::{Differences, Piece};
use super::chain::{Chain, Chains, Cut};
use super::winding::{Edge, Resolver, step};
use super::{Blend, FillRule, Outline, Pixel};
use crate::Image;
use core::ops::Range;

/// What becomes of coverage: rows come from top to bottom, and spans of a row from left to right. Pixels that are not
/// named have none.
pub trait Spans {
    /// Coverage in (0, 1] of each pixel of row `y` from column `x` on; single values may be 0.
    fn cells(&mut self, y: usize, x: usize, coverage: &[f32]);

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
    differences: Differences,
    resolver: Resolver,
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
            differences: Differences::new(width),
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

    /// A row of a convex contour: all edges count, and the winding number inside is known.
    fn convex_row(&mut self, chains: &Chains, y: usize, winding: i32, spans: &mut impl Spans) {
        let differences = &mut self.differences;
        self.active.retain_mut(|chain| {
            let sign = f64::from(chain.sign * winding);
            let strand = walk(chains, chain, y, |piece| differences.add(piece, sign));
            differences.touch(strand.left, strand.right);
            chain.segment < chain.end
        });
        differences.emit(y, |sum| sum.clamp(0.0, 1.0), spans);
    }

    /// A row of any outline.
    fn row(&mut self, chains: &Chains, y: usize, rule: FillRule, spans: &mut impl Spans) {
        self.row.collect(chains, &mut self.active, y);
        self.row.sort();
        if self.row.is_ordered() {
            self.add_ordered(rule);
        } else if !self.resolve(rule) {
            self.add_unordered();
            return self.differences.emit(y, |mean| rule.fold(mean), spans);
        }
        self.differences.emit(y, |sum| sum.clamp(0.0, 1.0), spans);
    }

    /// Strands side by side: the winding number is counted from left to right.
    fn add_ordered(&mut self, rule: FillRule) {
        let mut winding = 0;
        for strand in &self.row.strands {
            let change = step(rule, &mut winding, strand.sign);
            if change != 0.0 {
                for edge in &self.row.edges[strand.first..strand.end] {
                    self.differences.add(&edge.piece, change);
                }
                self.differences
                    .touch(strand.walked.left, strand.walked.right);
            }
        }
    }

    /// Strands that begin, end or cross; false if there is too much of that.
    fn resolve(&mut self, rule: FillRule) -> bool {
        let differences = &mut self.differences;
        self.resolver
            .resolve(&self.row.edges, rule, &mut |piece, change| {
                differences.add(piece, change);
                let (a, b) = (piece.x_top, piece.x_bottom);
                differences.touch(a.min(b), a.max(b));
            })
    }

    /// All strands with their signs: the running sum is the mean winding number.
    fn add_unordered(&mut self) {
        for strand in &self.row.strands {
            for edge in &self.row.edges[strand.first..strand.end] {
                self.differences.add(&edge.piece, f64::from(edge.sign));
            }
            self.differences
                .touch(strand.walked.left, strand.walked.right);
        }
    }
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
