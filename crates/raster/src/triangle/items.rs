//! Item buffers, eight pixels at once.
//!
//! Pixels and depths are those of [`draw_triangle`](super::draw_triangle), bit for bit; where the way to them differs:
//! 1. Most triangles need no clipping, which a few comparisons of all corners at once tell. The corners of a quad are
//!    projected together.
//! 2. A triangle of up to eight columns finds its pixels by the signs of its three edge functions, eight columns at
//!    once, without the divisions that the ends of spans cost.
//! 3. Spans are drawn in groups of eight with a mask at both ends. Left to itself, a compiler unrolls such loops for
//!    spans far longer than those of elements.

use super::{
    CENTRE, Clipping, Corner, Cull, Facet, SUBPIXELS, Viewport, check_band, doubled_area,
    for_each_facet_of, narrow, pixel_index,
};
use crate::clip::ClipVertex;
use core::ops::Range;
use glam::{Mat4, Vec4};
use wide::{f32x8, f64x4, i32x8};

/// Pixels of a group: a facet's columns are counted from its first by eights.
pub(super) const GROUP: usize = 8;

/// The longest extent in sub-pixels with which edge functions fit into 32 bits: each of their two products then stays
/// below 2^14 × (2^14 + 2^12).
const SMALL: i64 = 1 << 14;

/// Draws the rows `rows` of a triangle into an item buffer: where it is nearer than `depth` (`<`), it leaves its depth
/// and its `id`. `depth` and `ids` hold those rows and nothing else.
///
/// Covers the same pixels with the same depths, bit for bit, as [`draw_triangle`](super::draw_triangle).
///
/// # Panics
/// If `rows` is not within the picture, `depth` or `ids` do not have its size, or a side is above
/// [`Viewport::MAX_SIDE`].
pub fn draw_ids(
    rows: Range<usize>,
    viewport: Viewport,
    cull: Cull,
    positions: &[Vec4; 3],
    id: u32,
    depth: &mut [f32],
    ids: &mut [u32],
) {
    let [a, b, c] = *positions;
    let mut target = Target::new(rows, viewport, cull, id, depth, ids);
    target.draw(&[a, b, c, c], &[[0, 1, 2]]);
}

/// [`draw_ids`] of the two triangles of a quad, corners 0, 1, 2 and 0, 2, 3.
///
/// # Panics
/// As [`draw_ids`].
pub fn draw_quad_ids(
    rows: Range<usize>,
    viewport: Viewport,
    cull: Cull,
    positions: &[Vec4; 4],
    id: u32,
    depth: &mut [f32],
    ids: &mut [u32],
) {
    let mut target = Target::new(rows, viewport, cull, id, depth, ids);
    target.draw(positions, &[[0, 1, 2], [0, 2, 3]]);
}

/// Where a triangle is drawn to.
struct Target<'a> {
    rows: Range<usize>,
    viewport: Viewport,
    cull: Cull,
    id: u32,
    depth: &'a mut [f32],
    ids: &'a mut [u32],
}

impl<'a> Target<'a> {
    #[inline(always)]
    fn new(
        rows: Range<usize>,
        viewport: Viewport,
        cull: Cull,
        id: u32,
        depth: &'a mut [f32],
        ids: &'a mut [u32],
    ) -> Self {
        check_band(&rows, viewport, depth.len());
        check_band(&rows, viewport, ids.len());
        Self {
            rows,
            viewport,
            cull,
            id,
            depth,
            ids,
        }
    }

    #[inline(always)]
    fn draw(&mut self, positions: &[Vec4; 4], triangles: &[[usize; 3]]) {
        match project(positions, self.viewport) {
            Projected::Unseen => {}
            Projected::Inside(corners) => {
                for &triangle in triangles {
                    let [a, b, c] = triangle.map(|k| &corners[k]);
                    let area = doubled_area([a, b, c]);
                    if area > 0 && self.cull == Cull::None || area < 0 {
                        let facet = Facet::new(&self.rows, self.viewport, [a, b, c], area);
                        facet.iter().for_each(|facet| self.facet(facet));
                    }
                }
            }
            Projected::Unclear => self.draw_clipped(positions, triangles),
        }
    }

    #[cold]
    fn draw_clipped(&mut self, positions: &[Vec4; 4], triangles: &[[usize; 3]]) {
        for &triangle in triangles {
            let vertices = triangle.map(|k| ClipVertex::new(positions[k], []));
            let clipping = Clipping::of(&vertices, self.viewport.guard());
            let (rows, viewport, cull) = (self.rows.clone(), self.viewport, self.cull);
            for_each_facet_of(&rows, viewport, cull, &clipping, |facet| self.facet(facet));
        }
    }

    #[inline(always)]
    fn facet(&mut self, facet: &Facet<0>) {
        let depths = GroupDepths::new(facet);
        let [first, last] = facet.columns;
        let has_one_group = last - first < GROUP as i64;
        let fits = pixel_index(first) + GROUP <= self.viewport.width;
        if has_one_group && fits && facet.is_small() {
            self.one_group(facet, &depths);
        } else {
            self.spans(facet, &depths);
        }
    }

    /// A facet of at most eight columns.
    #[inline(always)]
    fn one_group(&mut self, facet: &Facet<0>, depths: &GroupDepths) {
        let [a, b, c] = facet.corners;
        let [first, _] = facet.columns;
        let [top, bottom] = facet.rows;
        let mut edges = [
            Edge::new(a, b, first, top),
            Edge::new(b, c, first, top),
            Edge::new(c, a, first, top),
        ];
        let mut start =
            (pixel_index(top) - self.rows.start) * self.viewport.width + pixel_index(first);
        for row in top..=bottom {
            let outside = edges[0].value | edges[1].value | edges[2].value;
            let z = depths.group(row, 0);
            self.blend(start, z, outside);
            edges.iter_mut().for_each(Edge::step_down);
            start += self.viewport.width;
        }
    }

    /// A facet of any size.
    #[inline(always)]
    fn spans(&mut self, facet: &Facet<0>, depths: &GroupDepths) {
        let width = self.viewport.width;
        let base = pixel_index(facet.columns[0]);
        let top = self.rows.start;
        facet.for_each_span(|y, columns| {
            let row = (y - top) * width;
            let [start, end] = [columns.start - base, columns.end - base];
            let first_group = start / GROUP * GROUP;
            for group in (first_group..end).step_by(GROUP) {
                let z = depths.group(y as i64, group);
                if base + group + GROUP <= width {
                    let lanes = lanes() + i32x8::splat(small(group));
                    let outside =
                        lanes - i32x8::splat(small(start)) | i32x8::splat(small(end) - 1) - lanes;
                    self.blend(row + base + group, z, outside);
                } else {
                    let z = z.to_array();
                    for column in start.max(group)..end {
                        let pixel = row + base + column;
                        if z[column - group] < self.depth[pixel] {
                            self.depth[pixel] = z[column - group];
                            self.ids[pixel] = self.id;
                        }
                    }
                }
            }
        });
    }

    /// Leaves depth and id in those of eight pixels where `outside` is not negative and the depth is nearer.
    #[inline(always)]
    fn blend(&mut self, start: usize, z: f32x8, outside: i32x8) {
        let depth: &mut [f32; GROUP] = (&mut self.depth[start..start + GROUP])
            .try_into()
            .expect("a group has eight pixels");
        let ids: &mut [u32; GROUP] = (&mut self.ids[start..start + GROUP])
            .try_into()
            .expect("a group has eight pixels");
        let nearest = f32x8::from(*depth);
        let outside: f32x8 = bytemuck::cast(outside >> 31);
        let wins = !outside & z.simd_lt(nearest);
        let items: f32x8 = bytemuck::cast(*ids);
        let id: f32x8 = bytemuck::cast([self.id; GROUP]);
        *depth = wins.bitselect(z, nearest).to_array();
        *ids = bytemuck::cast(wins.bitselect(id, items));
    }
}

/// 0, 1, .. 7
#[inline(always)]
fn lanes() -> i32x8 {
    i32x8::from([0, 1, 2, 3, 4, 5, 6, 7])
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_possible_wrap,
    reason = "a column of the picture: at most 2^16"
)]
fn small(column: usize) -> i32 {
    column as i32
}

/// What the first look at some corners tells.
enum Projected {
    /// All are beyond one side of the picture.
    Unseen,
    /// No plane cuts what is between them.
    Inside([Corner<0>; 4]),
    /// To be clipped, or to be looked at more closely.
    Unclear,
}

/// The four corners on the screen, as [`Corner::new`] has them, if they are certainly in front of the eye, between the
/// near and the far plane and within the guard band.
#[inline(always)]
fn project(positions: &[Vec4; 4], viewport: Viewport) -> Projected {
    let [a, b, c, d] = *positions;
    let Mat4 {
        x_axis: x,
        y_axis: y,
        z_axis: z,
        w_axis: w,
    } = Mat4::from_cols(a, b, c, d).transpose();
    // Half of the guard band, so that it does not matter how one rounds; without a division.
    let reach = w * narrow(0.5 * Viewport::GUARD_PIXELS);
    let half_side = viewport.longer_half();
    let is_certain = w.cmpge(Vec4::splat(1e-30))
        & w.cmple(Vec4::splat(1e30))
        & z.cmpge(Vec4::ZERO)
        & z.cmple(w)
        & (x.abs() * half_side).cmple(reach)
        & (y.abs() * half_side).cmple(reach);
    if !is_certain.all() {
        return Projected::Unclear;
    }
    let is_beyond = x.cmpgt(w).all() | x.cmplt(-w).all() | y.cmpgt(w).all() | y.cmplt(-w).all();
    if is_beyond {
        return Projected::Unseen;
    }
    let wide = |v: Vec4| f64x4::from(v.as_dvec4().to_array());
    let half = viewport.half();
    let one = f64x4::splat(1.0);
    let inverse_w = one / wide(w);
    let right = snap((wide(x) * inverse_w + one) * f64x4::splat(half.x));
    let down = snap((one - wide(y) * inverse_w) * f64x4::splat(half.y));
    let z = (wide(z) * inverse_w).fast_min(one).to_array();
    let inverse_w = inverse_w.to_array();
    Projected::Inside([0, 1, 2, 3].map(|k| Corner {
        x: right[k],
        y: down[k],
        z: z[k],
        inverse_w: inverse_w[k],
        attributes_over_w: [],
        attributes: [],
    }))
}

/// [`super::snap`] of four numbers.
#[inline(always)]
fn snap(pixels: f64x4) -> [i64; 4] {
    // Adding 1.5 × 2^52 moves an integer into the low bits.
    const SHIFT: f64 = 6_755_399_441_055_744.0;
    let rounded = (pixels * f64x4::splat(SUBPIXELS as f64) + f64x4::splat(0.5)).floor();
    let shifted = (rounded + f64x4::splat(SHIFT)).to_array();
    #[expect(clippy::cast_possible_wrap, reason = "both are below 2^63")]
    shifted.map(|s| s.to_bits() as i64 - SHIFT.to_bits() as i64)
}

/// An edge function at eight neighbouring pixels: negative outside.
#[derive(Clone, Copy)]
struct Edge {
    value: i32x8,
    per_row: i32x8,
}

impl Edge {
    /// From a to b, at eight pixels from `column` in `row`.
    #[expect(
        clippy::cast_possible_truncation,
        reason = "facets that are small keep it within 32 bits"
    )]
    #[inline(always)]
    fn new(a: &Corner<0>, b: &Corner<0>, column: i64, row: i64) -> Self {
        let (dx, dy) = (b.x - a.x, b.y - a.y);
        // A centre on a top or left edge is inside.
        let is_inside_on = dy < 0 || dy == 0 && dx > 0;
        let to_row = row * SUBPIXELS + CENTRE - a.y;
        let to_column = column * SUBPIXELS + CENTRE - a.x;
        let start = dx * to_row - dy * to_column - i64::from(!is_inside_on);
        Self {
            value: i32x8::splat(start as i32) - lanes() * i32x8::splat((dy * SUBPIXELS) as i32),
            per_row: i32x8::splat((dx * SUBPIXELS) as i32),
        }
    }

    #[inline(always)]
    fn step_down(&mut self) {
        self.value += self.per_row;
    }
}

impl Facet<'_, 0> {
    /// Whether edge functions at its pixels fit into 32 bits.
    #[inline(always)]
    fn is_small(&self) -> bool {
        let [a, b, c] = self.corners;
        let width = a.x.max(b.x).max(c.x) - a.x.min(b.x).min(c.x);
        let height = a.y.max(b.y).max(c.y) - a.y.min(b.y).min(c.y);
        width.max(height) <= SMALL
    }
}

/// Depths of a facet by groups of eight pixels, see [`super::Depths`].
#[derive(Clone, Copy)]
struct GroupDepths {
    depths: super::Depths,
    along: f32x8,
    low: f32x8,
    high: f32x8,
}

impl GroupDepths {
    #[inline(always)]
    fn new(facet: &Facet<0>) -> Self {
        let depths = super::Depths::new(facet);
        let lanes = f32x8::from([0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0]);
        Self {
            along: lanes * f32x8::splat(depths.slope),
            low: f32x8::splat(depths.low),
            high: f32x8::splat(depths.high),
            depths,
        }
    }

    #[inline(always)]
    fn group(&self, row: i64, group: usize) -> f32x8 {
        let z = f32x8::splat(self.depths.of_group(row, group)) + self.along;
        z.fast_max(self.low).fast_min(self.high)
    }
}
