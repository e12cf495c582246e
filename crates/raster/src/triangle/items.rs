//! Item buffers, eight pixels at once.
//!
//! Pixels and depths are those of [`draw_triangle`](super::draw_triangle), bit for bit; where the way to them differs:
//! 1. Most triangles need no clipping, which a few comparisons of all corners at once tell. The corners of a quad are
//!    projected together.
//! 2. A small triangle finds its pixels by the signs of its three edge functions, eight columns at once, without the
//!    divisions that the ends of spans cost. So do the two triangles of a quad, in one walk over its box: where the
//!    diagonal's edge function is negative the pixel belongs to the second.
//! 3. Spans are drawn in groups of eight with a mask at both ends. Left to itself, a compiler unrolls such loops for
//!    spans far longer than those of elements.

use super::{
    CENTRE, Clipping, Corner, Cull, Facet, SUBPIXELS, Viewport, centres, check_band, doubled_area,
    for_each_facet_of, narrow, pixel_index,
};
use crate::clip::ClipVertex;
use core::ops::Range;
use glam::{Mat4, Vec4};
use wide::{f32x8, f64x4, i32x8};

/// Pixels of a group: every eighth column of the picture starts one.
pub(super) const GROUP: usize = 8;

/// The widest boxes that are walked in full, in groups. Beyond, spans find the pixels with less work.
const FEW_GROUPS: usize = 4;

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
            Projected::Inside(corners) if triangles.len() == 2 => self.quad(&corners),
            Projected::Inside(corners) => {
                let [a, b, c, _] = corners.each_ref();
                self.triangle([a, b, c], doubled_area([a, b, c]));
            }
            Projected::Unclear => self.draw_clipped(positions, triangles),
        }
    }

    /// A triangle of known doubled area.
    #[inline(always)]
    fn triangle(&mut self, corners: [&Corner<0>; 3], area: i64) {
        if area > 0 && self.cull == Cull::None || area < 0 {
            let facet = Facet::new(&self.rows, self.viewport, corners, area);
            facet.iter().for_each(|facet| self.facet(facet));
        }
    }

    #[inline(always)]
    fn quad(&mut self, corners: &[Corner<0>; 4]) {
        let [a, b, c, d] = corners.each_ref();
        let areas = [doubled_area([a, b, c]), doubled_area([a, c, d])];
        let is_culled = self.cull == Cull::Back && areas[0] >= 0 && areas[1] >= 0;
        if is_culled {
            return;
        }
        // Of opposite signs, the triangles overlap.
        if areas[0].signum() * areas[1].signum() > 0
            && let Some(extent) = Extent::new(&self.rows, self.viewport, corners)
            && extent.is_small(corners)
        {
            self.small_quad(corners, areas, &extent);
        } else {
            self.triangle([a, b, c], areas[0]);
            self.triangle([a, c, d], areas[1]);
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
        let extent = Extent {
            columns: facet.columns,
            rows: facet.rows,
            width: self.viewport.width,
        };
        let [a, b, c] = facet.corners;
        if extent.is_small(&[*a, *b, *c]) {
            self.small_triangle(facet, &depths, &extent);
        } else {
            self.spans(facet, &depths);
        }
    }

    #[inline(always)]
    fn small_triangle(&mut self, facet: &Facet<0>, depths: &GroupDepths, extent: &Extent) {
        let [a, b, c] = facet.corners;
        let sides = [Edge::new(a, b), Edge::new(b, c), Edge::new(c, a)];
        for group in extent.groups() {
            let mut edges = sides.map(|side| side.at(group, extent.rows[0]));
            let mut start = self.start(group, extent);
            for row in extent.rows[0]..=extent.rows[1] {
                let outside = edges[0].value | edges[1].value | edges[2].value;
                self.blend(start, depths.group(row, group), outside);
                edges.iter_mut().for_each(EdgeOfGroup::step_down);
                start += self.viewport.width;
            }
        }
    }

    #[inline(always)]
    fn small_quad(&mut self, corners: &[Corner<0>; 4], areas: [i64; 2], extent: &Extent) {
        let [a, b, c, d] = corners.each_ref();
        let first = extent.facet([a, b, c], areas[0]);
        let second = extent.facet([a, c, d], areas[1]);
        let [a, b, c, d] = if areas[0] > 0 {
            [a, b, c, d]
        } else {
            [a, d, c, b]
        };
        // Turned around, the second triangle comes first.
        let facets = if areas[0] > 0 {
            [&first, &second]
        } else {
            [&second, &first]
        };
        let depths = facets.map(GroupDepths::new);
        let sides = [
            Edge::new(a, b),
            Edge::new(b, c),
            Edge::new(c, d),
            Edge::new(d, a),
            Edge::new(c, a),
        ];
        for group in extent.groups() {
            let mut edges = sides.map(|side| side.at(group, extent.rows[0]));
            let mut start = self.start(group, extent);
            for row in extent.rows[0]..=extent.rows[1] {
                let [ab, bc, cd, da, ca] = edges.map(|edge| edge.value);
                let in_second: i32x8 = ca >> 31_i32;
                let outside = ((ab | bc) & !in_second) | ((cd | da) & in_second);
                let is_second: f32x8 = bytemuck::cast(in_second);
                let z =
                    is_second.bitselect(depths[1].group(row, group), depths[0].group(row, group));
                self.blend(start, z, outside);
                edges.iter_mut().for_each(EdgeOfGroup::step_down);
                start += self.viewport.width;
            }
        }
    }

    /// Index of the first pixel of a group in the uppermost row.
    #[inline(always)]
    fn start(&self, group: usize, extent: &Extent) -> usize {
        (pixel_index(extent.rows[0]) - self.rows.start) * self.viewport.width + group
    }

    /// A facet of any size.
    #[inline(always)]
    fn spans(&mut self, facet: &Facet<0>, depths: &GroupDepths) {
        let width = self.viewport.width;
        let top = self.rows.start;
        facet.for_each_span(|y, columns| {
            let row = (y - top) * width;
            let first_group = columns.start / GROUP * GROUP;
            for group in (first_group..columns.end).step_by(GROUP) {
                let z = depths.group(y as i64, group);
                if group + GROUP <= width {
                    let lanes = lanes() + i32x8::splat(small(group));
                    let outside = (lanes - i32x8::splat(small(columns.start)))
                        | (i32x8::splat(small(columns.end) - 1) - lanes);
                    self.blend(row + group, z, outside);
                } else {
                    let z = z.to_array();
                    for column in columns.start.max(group)..columns.end {
                        let pixel = row + column;
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
        let outside: f32x8 = bytemuck::cast(outside >> 31_i32);
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

/// The pixels of a box around some corners, at least one.
#[derive(Clone, Copy)]
struct Extent {
    columns: [i64; 2],
    rows: [i64; 2],
    /// Of the picture.
    width: usize,
}

impl Extent {
    /// `None` if no centre of a pixel of the rows is in the box.
    #[inline(always)]
    fn new(rows: &Range<usize>, viewport: Viewport, corners: &[Corner<0>; 4]) -> Option<Self> {
        let columns = centres(0..viewport.width, corners.each_ref().map(|c| c.x));
        let rows = centres(rows.clone(), corners.each_ref().map(|c| c.y));
        (columns[0] <= columns[1] && rows[0] <= rows[1]).then_some(Self {
            columns,
            rows,
            width: viewport.width,
        })
    }

    /// First columns of the groups.
    #[inline(always)]
    fn groups(&self) -> impl Iterator<Item = usize> + use<> {
        let [first, last] = self.columns.map(pixel_index);
        (first / GROUP * GROUP..=last).step_by(GROUP)
    }

    /// Whether the box is narrow, does not end in part of a group, and edge functions at its pixels fit into 32 bits.
    #[inline(always)]
    fn is_small<const C: usize>(&self, corners: &[Corner<0>; C]) -> bool {
        let [first, last] = self.columns.map(|column| pixel_index(column) / GROUP);
        let range = |of: fn(&Corner<0>) -> i64| {
            let (low, high) = corners
                .iter()
                .map(of)
                .fold((i64::MAX, i64::MIN), |(low, high), c| {
                    (low.min(c), high.max(c))
                });
            high - low
        };
        last - first < FEW_GROUPS
            && (last + 1) * GROUP <= self.width
            && range(|c| c.x).max(range(|c| c.y)) <= SMALL
    }

    /// A triangle within.
    #[inline(always)]
    fn facet<'a>(&self, [a, b, c]: [&'a Corner<0>; 3], area: i64) -> Facet<'a, 0> {
        let [b, c] = if area > 0 { [b, c] } else { [c, b] };
        Facet {
            corners: [a, b, c],
            per_pixel: SUBPIXELS as f64 / area.abs() as f64,
            columns: self.columns,
            rows: self.rows,
        }
    }
}

/// The edge function of a side of a small facet, negative outside.
#[derive(Clone, Copy)]
struct Edge {
    /// At the centre of pixel (0, 0).
    origin: i64,
    per_column: i64,
    per_row: i64,
}

impl Edge {
    /// From a to b, clockwise around the facet.
    #[inline(always)]
    fn new(a: &Corner<0>, b: &Corner<0>) -> Self {
        let (dx, dy) = (b.x - a.x, b.y - a.y);
        // A centre on a top or left edge is inside.
        let is_inside_on = dy < 0 || dy == 0 && dx > 0;
        Self {
            origin: dx * (CENTRE - a.y) - dy * (CENTRE - a.x) - i64::from(!is_inside_on),
            per_column: -dy * SUBPIXELS,
            per_row: dx * SUBPIXELS,
        }
    }

    /// At eight pixels from a column in a row.
    #[expect(
        clippy::cast_possible_truncation,
        reason = "facets that are small keep it within 32 bits"
    )]
    #[inline(always)]
    fn at(self, column: usize, row: i64) -> EdgeOfGroup {
        let start = self.origin + self.per_column * column as i64 + self.per_row * row;
        EdgeOfGroup {
            value: i32x8::splat(start as i32) + lanes() * i32x8::splat(self.per_column as i32),
            per_row: i32x8::splat(self.per_row as i32),
        }
    }
}

/// An edge function at eight neighbouring pixels.
#[derive(Clone, Copy)]
struct EdgeOfGroup {
    value: i32x8,
    per_row: i32x8,
}

impl EdgeOfGroup {
    #[inline(always)]
    fn step_down(&mut self) {
        self.value += self.per_row;
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
