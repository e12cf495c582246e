//! Rows of a picture, from chains to spans of coverage.

use super::accumulate::{Differences, Piece};
use super::chain::{Chain, Chains};
use super::winding::{Edge, Resolver, step};
use super::{Blend, FillRule, Outline, Pixel};
use crate::Image;

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
    height: usize,
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
    left: f64,
    right: f64,
    /// Its first edge and the one behind its last.
    first: usize,
    end: usize,
    sign: i32,
    /// Whether it runs from the row's top to its bottom.
    is_full: bool,
}

impl Rasterizer {
    /// For pictures of so many pixels across and down.
    pub fn new(width: usize, height: usize) -> Self {
        Self {
            width,
            height,
            chains: Chains::default(),
            active: Vec::new(),
            row: Row::default(),
            differences: Differences::new(width),
            resolver: Resolver::default(),
        }
    }

    /// Hands out the coverage of an outline.
    pub fn rasterize(&mut self, outline: &Outline, rule: FillRule, spans: &mut impl Spans) {
        self.chains.set(outline, self.width, self.height);
        self.active.clear();
        let mut next = 0;
        let mut y = 0;
        while y < self.height {
            if self.active.is_empty() {
                let Some(chain) = self.chains.chains.get(next) else {
                    break;
                };
                y = row_of(chain.top);
            }
            let bottom = (y + 1) as f64;
            let waiting = &self.chains.chains[next..];
            let begun = waiting.iter().take_while(|chain| chain.top < bottom);
            let before = self.active.len();
            self.active.extend(begun.map(Active::new));
            next += self.active.len() - before;
            self.row.collect(&self.chains, &mut self.active, y);
            self.fill_row(y, rule, spans);
            y += 1;
        }
    }

    /// Blends an outline into a picture: `pixel + coverage opacity (value - pixel)`, in linear light.
    ///
    /// Panics if the picture does not have this rasteriser's size.
    pub fn fill<P: Pixel>(
        &mut self,
        outline: &Outline,
        rule: FillRule,
        image: &mut Image<P>,
        value: P,
        opacity: f32,
    ) {
        let size = (image.width(), image.height());
        assert_eq!(size, (self.width, self.height), "size of the picture");
        self.rasterize(outline, rule, &mut Blend::new(image, value, opacity));
    }

    /// Turns the strands of a row into spans.
    fn fill_row(&mut self, y: usize, rule: FillRule, spans: &mut impl Spans) {
        self.row.sort();
        let is_ordered = self.row.is_ordered();
        let is_resolved = is_ordered || self.resolve(rule);
        if is_ordered {
            self.add_ordered(rule);
        } else if !is_resolved {
            self.add_unordered();
        }
        let fold = move |sum: f32| match is_resolved {
            true => sum.clamp(0.0, 1.0),
            false => rule.fold(sum),
        };
        let shared = core::cell::RefCell::new(spans);
        self.differences.take(
            self.width,
            fold,
            |x, coverage| shared.borrow_mut().cells(y, x, coverage),
            |start, end, coverage| {
                if coverage > 0.0 {
                    shared.borrow_mut().run(y, start, end, coverage);
                }
            },
        );
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
                self.differences.touch(strand.left, strand.right);
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
            self.differences.touch(strand.left, strand.right);
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
        active.retain_mut(|chain| self.collect_strand(chains, chain, y));
    }

    /// Collects the part of a chain in a row; returns whether the chain goes on below.
    #[inline]
    fn collect_strand(&mut self, chains: &Chains, chain: &mut Active, y: usize) -> bool {
        let (row_top, row_bottom) = (y as f64, (y + 1) as f64);
        let first = self.edges.len();
        let start = chains.segments[chain.segment].top;
        let (mut left, mut right) = (f64::INFINITY, f64::NEG_INFINITY);
        let end = loop {
            let segment = &chains.segments[chain.segment];
            let top = segment.top.max(row_top);
            let bottom = segment.bottom.min(row_bottom);
            let (x_top, x_bottom) = (segment.x_at(top), segment.x_at(bottom));
            left = left.min(x_top).min(x_bottom);
            right = right.max(x_top).max(x_bottom);
            let piece = Piece {
                top,
                bottom,
                x_top,
                x_bottom,
            };
            let sign = chain.sign;
            self.edges.push(Edge { piece, sign });
            if segment.bottom > row_bottom {
                break row_bottom;
            }
            chain.segment += 1;
            if chain.segment == chain.end || segment.bottom == row_bottom {
                break segment.bottom;
            }
        };
        self.strands.push(Strand {
            left,
            right,
            first,
            end: self.edges.len(),
            sign: chain.sign,
            is_full: start <= row_top && end >= row_bottom,
        });
        chain.segment < chain.end
    }

    /// Sorts the strands from left to right.
    fn sort(&mut self) {
        if !self.strands.is_sorted_by(|a, b| a.left <= b.left) {
            self.strands.sort_by(|a, b| a.left.total_cmp(&b.left));
        }
    }

    /// Whether no strand begins or ends or may cross another one.
    fn is_ordered(&self) -> bool {
        let is_apart = |pair: &[Strand]| pair[0].right <= pair[1].left;
        self.strands.iter().all(|strand| strand.is_full) && self.strands.windows(2).all(is_apart)
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
