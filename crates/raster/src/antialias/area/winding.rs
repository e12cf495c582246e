//! Rows in which edges cross, begin or end: which edges bound the area, in which part of the row.

use super::FillRule;
use super::accumulate::Piece;

/// A piece and the change of the winding number from its left to its right.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Edge {
    pub piece: Piece,
    pub sign: i32,
}

/// Memory for the work on a row.
#[derive(Debug, Clone, Default)]
pub(super) struct Resolver {
    cuts: Vec<f64>,
    slab: Vec<Edge>,
    crossings: Vec<f64>,
}

/// Visits of an edge by a slab that a row may cost: some milliseconds.
const MOST_VISITS: usize = 1 << 18;

impl Resolver {
    /// Hands out the parts of edges that bound the area, with 1 where it begins and -1 where it ends, from left to right.
    ///
    /// The row is cut into slabs at all ends of edges, each slab at all crossings in it. Between cuts edges are in
    /// order, and the winding number is counted from left to right. Returns false, and hands out nothing, if there is
    /// too much to do.
    pub fn resolve(
        &mut self,
        edges: &[Edge],
        rule: FillRule,
        emit: &mut impl FnMut(&Piece, f32),
    ) -> bool {
        self.cuts.clear();
        let ends = |edge: &Edge| [edge.piece.top, edge.piece.bottom];
        self.cuts.extend(edges.iter().flat_map(ends));
        self.cuts.sort_unstable_by(f64::total_cmp);
        self.cuts.dedup();
        let visits = self.cuts.len().saturating_mul(edges.len());
        if visits > MOST_VISITS || !self.find_crossings(edges, MOST_VISITS - visits) {
            return false;
        }
        self.cuts.extend_from_slice(&self.crossings);
        self.cuts.sort_unstable_by(f64::total_cmp);
        self.cuts.dedup();
        for slab in 1..self.cuts.len() {
            let (top, bottom) = (self.cuts[slab - 1], self.cuts[slab]);
            cut_out(edges, top, bottom, &mut self.slab);
            self.slab.sort_by(|a, b| middle(a).total_cmp(&middle(b)));
            emit_boundary(&self.slab, rule, emit);
        }
        true
    }

    /// Finds where edges cross; false if there are more crossings than can be cut at within so many visits.
    fn find_crossings(&mut self, edges: &[Edge], visits: usize) -> bool {
        self.crossings.clear();
        let most = visits / edges.len().max(1);
        for slab in 1..self.cuts.len() {
            let (top, bottom) = (self.cuts[slab - 1], self.cuts[slab]);
            cut_out(edges, top, bottom, &mut self.slab);
            self.slab.sort_by(|a, b| {
                let (a, b) = (a.piece, b.piece);
                let by_top = a.x_top.total_cmp(&b.x_top);
                by_top.then(a.x_bottom.total_cmp(&b.x_bottom))
            });
            let bottoms = self.slab.iter().map(|edge| edge.piece.x_bottom);
            if !bottoms.is_sorted() && !self.cross_slab(most) {
                return false;
            }
        }
        true
    }

    /// Adds the crossings of a slab, whose edges are sorted at its top: an insertion sort by the order at its bottom
    /// swaps just those pairs that cross.
    fn cross_slab(&mut self, most: usize) -> bool {
        for i in 1..self.slab.len() {
            for j in (1..=i).rev() {
                let (left, right) = (self.slab[j - 1].piece, self.slab[j].piece);
                if left.x_bottom <= right.x_bottom {
                    break;
                }
                if self.crossings.len() == most {
                    return false;
                }
                let before = right.x_top - left.x_top;
                let t = before / (before + left.x_bottom - right.x_bottom);
                self.crossings.push(left.top + (left.bottom - left.top) * t);
                self.slab.swap(j - 1, j);
            }
        }
        true
    }
}

/// Twice the x in the middle of an edge.
fn middle(edge: &Edge) -> f64 {
    edge.piece.x_top + edge.piece.x_bottom
}

/// The parts of all edges that run through a slab from its top to its bottom.
fn cut_out(edges: &[Edge], top: f64, bottom: f64, slab: &mut Vec<Edge>) {
    slab.clear();
    let through = edges
        .iter()
        .filter(|e| e.piece.top <= top && e.piece.bottom >= bottom);
    slab.extend(through.map(|edge| Edge {
        piece: Piece {
            top,
            bottom,
            x_top: edge.piece.x_at(top),
            x_bottom: edge.piece.x_at(bottom),
        },
        sign: edge.sign,
    }));
}

/// Hands out those edges of a slab that have the inside on one side only.
fn emit_boundary(slab: &[Edge], rule: FillRule, emit: &mut impl FnMut(&Piece, f32)) {
    let mut winding = 0;
    for edge in slab {
        let change = step(rule, &mut winding, edge.sign);
        if change != 0.0 {
            emit(&edge.piece, change);
        }
    }
}

/// Crosses an edge from left to right: 1 into the inside, -1 out of it, 0 if both sides are alike.
#[inline]
pub(super) fn step(rule: FillRule, winding: &mut i32, sign: i32) -> f32 {
    let before = rule.is_inside(*winding);
    *winding += sign;
    f32::from(i8::from(rule.is_inside(*winding)) - i8::from(before))
}
