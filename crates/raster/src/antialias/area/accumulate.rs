//! Coverage of a row from the pieces of edges in it.
//!
//! Coverage is the sum of the pieces' [`SignedArea`]s. Only blocks of pixels that a piece runs through are summed up;
//! between them coverage is that of all pieces to the left.

use super::Spans;
use crate::signed_area::{LANES, SignedArea};
use wide::f32x8;

/// A straight piece of an edge within one row.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Piece {
    /// y of its upper and of its lower end.
    pub top: f64,
    pub bottom: f64,
    /// x of its upper and of its lower end.
    pub x_top: f64,
    pub x_bottom: f64,
}

impl Piece {
    /// x at a y between top and bottom.
    pub fn x_at(&self, y: f64) -> f64 {
        let t = (y - self.top) / (self.bottom - self.top);
        self.x_top + (self.x_bottom - self.x_top) * t
    }
}

/// Puts pieces in the order of their left ends, in which most come already.
pub(super) fn sort(pieces: &mut [SignedArea]) {
    if !pieces.is_sorted_by(|a, b| a.left <= b.left) {
        pieces.sort_unstable_by(|a, b| a.left.total_cmp(&b.left));
    }
}

/// Hands out the coverage of a row of which the pieces come in order: blocks of pixels where there are pieces, one value
/// for all pixels between. `fold` makes coverage of the sum.
#[inline(always)]
pub(super) fn emit(
    pieces: &[SignedArea],
    [y, width]: [usize; 2],
    fold: impl Fn(f32) -> f32,
    spans: &mut impl Spans,
) {
    // What pieces that lie to the left cover.
    let mut sum = 0.0;
    let mut at = 0;
    let mut next = 0;
    while next < pieces.len() {
        let start = column(pieces[next].left);
        emit_run([at, start.min(width)], y, settled(fold(sum)), spans);
        let mut block = start as f64;
        at = start;
        let (mut first, mut end) = (next, f64::NEG_INFINITY);
        // Block after block until none of the pieces in them goes on.
        loop {
            while next < pieces.len() && pieces[next].left < block + 8.0 {
                let right = pieces[next].right;
                end = if right > end { right } else { end };
                next += 1;
            }
            let mut covered = f32x8::splat(sum);
            for piece in &pieces[first..next] {
                covered += piece.shares(block);
            }
            let covered = covered.to_array().map(&fold);
            if at + LANES <= width {
                spans.block(y, at, &covered);
            } else if at < width {
                spans.cells(y, at, &covered[..width - at]);
            }
            at += LANES;
            block += 8.0;
            while first < next && pieces[first].right <= block {
                sum += pieces[first].height;
                first += 1;
            }
            if end <= block {
                break;
            }
        }
        // Those behind a longer one.
        sum += pieces[first..next].iter().map(|s| s.height).sum::<f32>();
    }
    emit_run([at, width], y, settled(fold(sum)), spans);
}

#[inline(always)]
fn emit_run([start, end]: [usize; 2], y: usize, coverage: f32, spans: &mut impl Spans) {
    if start < end && coverage > 0.0 {
        spans.run(y, start, end, coverage);
    }
}

/// Full and empty runs are exactly so: what rounding left of a sum is less than this.
#[inline(always)]
fn settled(coverage: f32) -> f32 {
    const ROUNDING: f32 = 4e-6;
    match coverage {
        c if c < ROUNDING => 0.0,
        c if c > 1.0 - ROUNDING => 1.0,
        c => c,
    }
}

/// Coverage of a pixel. What rounding leaves of a sum beside the area is nothing.
#[inline(always)]
pub(super) fn settled_pixel(sum: f32) -> f32 {
    const ROUNDING: f32 = 2.4e-7;
    if sum < ROUNDING { 0.0 } else { sum.min(1.0) }
}

/// The column in which an x lies.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "x lies in the picture, but for rounding; the cast saturates"
)]
#[inline(always)]
fn column(x: f64) -> usize {
    x as u32 as usize
}
