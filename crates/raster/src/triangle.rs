//! Triangles with a z-buffer: pictures with perspective-correct attributes, and item buffers (depth and id).
//!
//! The rules are those of Direct3D 11.3, sections 3.4.1 and 3.4.2, and of wgpu on top of it, so that a picture drawn
//! here and one drawn by a GPU cover the same pixels:
//! 1. clip ([`crate::clip`]), divide by w, map to pixels (y down, pixel `(0, 0)` in the upper left corner);
//! 2. snap x and y to 24.8 fixed point, that is to 1/256 of a pixel, and only then look at the facing;
//! 3. draw the pixels whose centre lies inside; a centre on an edge belongs to the triangle whose top or left edge it
//!    is. Triangles that share an edge so draw every pixel along it exactly once.
//!
//! With corners in 24.8 the edge function from corner i to j,
//! `e(p) = (x_j - x_i) (p_y - y_i) - (y_j - y_i) (p_x - x_i)`, is an exact integer, positive inside of a triangle that
//! is clockwise on the screen. The pixels of a row between the edges follow by solving `e >= 0` for the column.
//!
//! Depth `z/w` and `1/w` and `attribute/w` are linear on the screen. Their slopes are computed once per triangle, their
//! values at the start of each row's span, and along the span the slope is added; `attribute = (attribute/w) / (1/w)`.
//! Depths start anew at every eighth column of the picture, so that eight of them are computed at once.
//!
//! Every row is computed by itself from the triangle. Drawing a picture in bands of rows, one thread each, gives the
//! same bits as drawing it at once.

mod items;

use crate::clip::{ClippedVertex, Clipping, cut_corners};
use core::ops::Range;
use glam::DVec2;

pub use self::items::{draw_ids, draw_quad_ids};
pub use crate::clip::ClipVertex;

/// The size of a picture in pixels; each side at most [`Viewport::MAX_SIDE`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Viewport {
    /// Pixels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
}

impl Viewport {
    /// The longest side that can be drawn to: 65 536 pixels.
    pub const MAX_SIDE: usize = 1 << 16;

    /// Half the side of the guard band in pixels. Corners then lie within 2^18 + 2^15 pixels, less than 2^27 sub-pixels,
    /// and an edge function stays below 2^57.
    const GUARD_PIXELS: f64 = (1 << 18) as f64;

    /// A picture of `width` by `height` pixels.
    pub const fn new(width: usize, height: usize) -> Self {
        Self { width, height }
    }

    /// Half width and half height as f64.
    fn half(self) -> DVec2 {
        DVec2::new(self.width as f64, self.height as f64) * 0.5
    }

    /// Half of the longer side, at least half a pixel as for the guard band.
    fn longer_half(self) -> f32 {
        narrow(self.half().max_element().max(0.5))
    }

    /// The guard band in units of the half picture.
    fn guard(self) -> DVec2 {
        Self::GUARD_PIXELS / self.half().max(DVec2::splat(0.5))
    }
}

/// Which triangles are left out because of their side.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Cull {
    /// Both sides are drawn.
    #[default]
    None,
    /// Only front sides are drawn: counter-clockwise with y up, as glTF and wgpu have it.
    Back,
}

/// The nearest depth so far of each pixel, row by row.
#[derive(Debug, Clone, PartialEq)]
pub struct DepthBuffer {
    viewport: Viewport,
    values: Vec<f32>,
}

impl DepthBuffer {
    /// Depth of a pixel to which nothing was drawn. Infinite, not 1: what lies on the far plane is seen.
    pub const EMPTY: f32 = f32::INFINITY;

    /// A buffer to which nothing was drawn.
    pub fn new(viewport: Viewport) -> Self {
        Self {
            viewport,
            values: vec![Self::EMPTY; viewport.width * viewport.height],
        }
    }

    /// Forgets everything drawn.
    pub fn clear(&mut self) {
        self.values.fill(Self::EMPTY);
    }

    /// Size of the picture.
    pub fn viewport(&self) -> Viewport {
        self.viewport
    }

    /// All depths, row by row: z/w in [0, 1], or [`Self::EMPTY`].
    pub fn values(&self) -> &[f32] {
        &self.values
    }

    /// All depths, row by row.
    pub fn values_mut(&mut self) -> &mut [f32] {
        &mut self.values
    }

    /// The buffer cut into bands of `height` rows (the last may have fewer, 0 counts as 1), with the rows of each.
    pub fn bands_mut(&mut self, height: usize) -> impl Iterator<Item = (Range<usize>, &mut [f32])> {
        let width = self.viewport.width.max(1);
        self.values
            .chunks_mut(width * height.max(1))
            .scan(0, move |start, band| {
                let rows = *start..*start + band.len() / width;
                *start = rows.end;
                Some((rows, band))
            })
    }
}

/// Draws the rows `rows` of a triangle; `depth` holds those rows and nothing else.
///
/// `fragment(x, y, depth, attributes)` is called for each pixel of the triangle that is nearer than what is there
/// (`<`: of equal depths the first drawn stays). `x` and `y` are columns and rows of the whole picture. If it returns
/// true the depth is written; false discards the pixel, as a hole of an alpha mask.
///
/// Depth and attributes never leave the range of the three corners' (of the clipped triangle's, where it is clipped).
/// A triangle with a position or attribute that is not finite is not drawn, nor is one without area after snapping.
///
/// # Panics
/// If `rows` is not within the picture, `depth` does not have its size, or a side is above [`Viewport::MAX_SIDE`].
///
/// ```
/// use glam::Vec4;
/// use hemicube_raster::triangle::{ClipVertex, Cull, DepthBuffer, Viewport, draw_triangle};
///
/// let viewport = Viewport::new(4, 4);
/// let mut depth = DepthBuffer::new(viewport);
/// let corner = |x, y, shade| ClipVertex::new(Vec4::new(x, y, 0.5, 1.0), [shade]);
/// let triangle = [corner(-1.0, -1.0, 0.0), corner(3.0, -1.0, 1.0), corner(-1.0, 3.0, 0.0)];
/// let mut row = Vec::new();
/// draw_triangle(0..4, viewport, Cull::Back, &triangle, depth.values_mut(), |_, y, _, &[shade]| {
///     if y == 0 {
///         row.push(shade);
///     }
///     true
/// });
/// assert_eq!(row, [0.0625, 0.1875, 0.3125, 0.4375]);
/// ```
pub fn draw_triangle<const N: usize>(
    rows: Range<usize>,
    viewport: Viewport,
    cull: Cull,
    vertices: &[ClipVertex<N>; 3],
    depth: &mut [f32],
    mut fragment: impl FnMut(usize, usize, f32, &[f32; N]) -> bool,
) {
    check_band(&rows, viewport, depth.len());
    for_each_facet(&rows, viewport, cull, vertices, |facet| {
        let inverse_w = facet.slopes(|c| c.inverse_w);
        let over_w: [Slopes; N] = std::array::from_fn(|k| facet.slopes(|c| c.attributes_over_w[k]));
        let (low, high) = facet.attribute_ranges();
        let depths = Depths::new(facet);
        facet.for_each_span(|y, columns| {
            let start = facet.offset(columns.start, y);
            let mut q = inverse_w.at(start);
            let mut a = over_w.map(|slopes| slopes.at(start));
            let first = (y - rows.start) * viewport.width;
            let row = &mut depth[first + columns.start..first + columns.end];
            for (x, nearest) in columns.zip(row) {
                let z = depths.at(x, y);
                if z < *nearest {
                    let w = 1.0 / inverse_w.clamp(q);
                    let attributes =
                        std::array::from_fn(|k| narrow(a[k] * w).max(low[k]).min(high[k]));
                    if fragment(x, y, z, &attributes) {
                        *nearest = z;
                    }
                }
                q += inverse_w.dx;
                for (a, slopes) in a.iter_mut().zip(&over_w) {
                    *a += slopes.dx;
                }
            }
        });
    });
}

#[inline(always)]
fn check_band(rows: &Range<usize>, viewport: Viewport, len: usize) {
    let fits = viewport.width.max(viewport.height) <= Viewport::MAX_SIDE
        && rows.start <= rows.end
        && rows.end <= viewport.height
        && len == (rows.end - rows.start) * viewport.width;
    if !fits {
        refuse_band(rows, viewport, len);
    }
}

/// Says what is wrong with a band. Apart, so that checking is a few instructions: most triangles are tiny.
#[cold]
fn refuse_band(rows: &Range<usize>, viewport: Viewport, len: usize) -> ! {
    assert!(
        viewport.width.max(viewport.height) <= Viewport::MAX_SIDE,
        "a picture of {} x {} pixels, at most {} per side can be drawn",
        viewport.width,
        viewport.height,
        Viewport::MAX_SIDE
    );
    assert!(
        rows.start <= rows.end && rows.end <= viewport.height,
        "rows {rows:?} of a picture of {} rows",
        viewport.height
    );
    panic!(
        "a band of {len} pixels for {} rows of {} pixels",
        rows.len(),
        viewport.width
    );
}

/// Sub-pixels in a pixel's side.
const SUBPIXELS: i64 = 256;

/// Centre of pixel 0.
const CENTRE: i64 = SUBPIXELS / 2;

/// A corner on the screen.
#[derive(Debug, Clone, Copy)]
struct Corner<const N: usize> {
    /// In 1/256 of a pixel from the left border.
    x: i64,
    /// In 1/256 of a pixel from the upper border.
    y: i64,
    z: f64,
    inverse_w: f64,
    attributes_over_w: [f64; N],
    attributes: [f64; N],
}

impl<const N: usize> Corner<N> {
    fn new(half: DVec2, vertex: &ClippedVertex<N>) -> Self {
        let p = vertex.position;
        let inverse_w = 1.0 / p.w;
        Self {
            x: snap((p.x * inverse_w + 1.0) * half.x),
            y: snap((1.0 - p.y * inverse_w) * half.y),
            z: (p.z * inverse_w).min(1.0),
            inverse_w,
            attributes_over_w: vertex.attributes.map(|a| a * inverse_w),
            attributes: vertex.attributes,
        }
    }
}

/// Pixels to the nearest 24.8 number, halves up.
#[expect(
    clippy::cast_possible_truncation,
    reason = "the guard band keeps it below 2^27"
)]
fn snap(pixels: f64) -> i64 {
    (pixels * SUBPIXELS as f64 + 0.5).floor() as i64
}

#[expect(
    clippy::cast_possible_truncation,
    reason = "rounds to the nearest f32; too large becomes infinite"
)]
fn narrow(value: f64) -> f32 {
    value as f32
}

/// Twice the signed area in square sub-pixels; positive if clockwise on the screen.
fn doubled_area<const N: usize>([a, b, c]: [&Corner<N>; 3]) -> i64 {
    (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x)
}

/// Clips, projects, culls, and hands on the triangles that are left; none without a pixel in `rows`.
fn for_each_facet<const N: usize>(
    rows: &Range<usize>,
    viewport: Viewport,
    cull: Cull,
    vertices: &[ClipVertex<N>; 3],
    draw: impl FnMut(&Facet<N>),
) {
    let clipping = Clipping::of(vertices, viewport.guard());
    for_each_facet_of(rows, viewport, cull, &clipping, draw);
}

/// Projects and culls what clipping has left.
fn for_each_facet_of<const N: usize>(
    rows: &Range<usize>,
    viewport: Viewport,
    cull: Cull,
    clipping: &Clipping<N>,
    mut draw: impl FnMut(&Facet<N>),
) {
    let half = viewport.half();
    match clipping {
        Clipping::Outside => {}
        Clipping::Inside(corners) => {
            let corners = corners.each_ref().map(|corner| Corner::new(half, corner));
            let [a, b, c] = corners.each_ref();
            let area = doubled_area([a, b, c]);
            if area > 0 && cull == Cull::None || area < 0 {
                Facet::new(rows, viewport, [a, b, c], area)
                    .iter()
                    .for_each(&mut draw);
            }
        }
        Clipping::Crossing(corners) => {
            let polygon = cut_corners(corners, viewport.guard());
            let corner = |vertex| Corner::new(half, vertex);
            let Some((first, others)) = polygon.corners().split_first() else {
                return;
            };
            let first = corner(first);
            // The polygon as a whole has one facing. Snapping may turn a needle of its fan over; it is left out.
            let fan = || {
                others.windows(2).map(|pair| {
                    let (b, c) = (corner(&pair[0]), corner(&pair[1]));
                    (b, c, doubled_area([&first, &b, &c]))
                })
            };
            let facing = fan().map(|(_, _, area)| area).sum::<i64>().signum();
            if facing == 0 || facing > 0 && cull == Cull::Back {
                return;
            }
            for (b, c, area) in fan().filter(|(_, _, area)| area.signum() == facing) {
                Facet::new(rows, viewport, [&first, &b, &c], area)
                    .iter()
                    .for_each(&mut draw);
            }
        }
    }
}

/// One side of a triangle on its way down the rows: the outermost column that its half-plane leaves.
///
/// The half-plane is `constant(row) + per_column * column >= 0`, so with `q = floor(constant / |per_column|)` a right
/// side leaves columns up to `q` and a left one columns from `-q`. From row to row the constant grows by a fixed amount,
/// so quotient and remainder follow by additions and a carry, exactly.
#[derive(Debug, Clone, Copy)]
struct Side {
    is_left: bool,
    quotient: i64,
    remainder: i64,
    quotient_step: i64,
    remainder_step: i64,
    divisor: i64,
}

impl Side {
    /// Leaves every column: the rows already say what lies above and below.
    const HORIZONTAL: Self = Self {
        is_left: false,
        quotient: i64::MAX,
        remainder: 0,
        quotient_step: 0,
        remainder_step: 0,
        divisor: 1,
    };

    /// The side from a to b of a triangle that is clockwise on the screen, at row `row`.
    fn new<const N: usize>(a: &Corner<N>, b: &Corner<N>, row: i64) -> Self {
        let (dx, dy) = (b.x - a.x, b.y - a.y);
        if dy == 0 {
            return Self::HORIZONTAL;
        }
        // It goes up on the left; a centre on it is inside there, and outside on the right.
        let is_left = dy < 0;
        let to_centre = row * SUBPIXELS + CENTRE - a.y;
        let constant = dx * to_centre - dy * (CENTRE - a.x) - i64::from(!is_left);
        let divisor = dy.abs() * SUBPIXELS;
        let inverse = 1.0 / divisor as f64;
        let (quotient, remainder) = divide(constant, divisor, inverse);
        let (quotient_step, remainder_step) = divide(dx * SUBPIXELS, divisor, inverse);
        Self {
            is_left,
            quotient,
            remainder,
            quotient_step,
            remainder_step,
            divisor,
        }
    }

    /// Narrows the columns `first..=last` to those on the inner side.
    fn narrow_span(&self, [first, last]: [i64; 2]) -> [i64; 2] {
        if self.is_left {
            [first.max(-self.quotient), last]
        } else {
            [first, last.min(self.quotient)]
        }
    }

    fn step_down(&mut self) {
        let remainder = self.remainder + self.remainder_step;
        let carry = remainder >= self.divisor;
        self.quotient += self.quotient_step + i64::from(carry);
        self.remainder = remainder - if carry { self.divisor } else { 0 };
    }
}

/// Quotient, rounded down, and remainder of a division by a positive number whose inverse is known.
///
/// Four times faster than dividing integers, and exact: quotients stay below 2^49 here, so the estimate in f64 misses
/// by 1 at most.
#[expect(clippy::cast_possible_truncation, reason = "an integer below 2^50")]
fn divide(dividend: i64, divisor: i64, inverse: f64) -> (i64, i64) {
    let estimate = (dividend as f64 * inverse).floor() as i64;
    let remainder = dividend - estimate * divisor;
    if remainder < 0 {
        (estimate - 1, remainder + divisor)
    } else if remainder >= divisor {
        (estimate + 1, remainder - divisor)
    } else {
        (estimate, remainder)
    }
}

/// A quantity that is linear on the screen.
#[derive(Debug, Clone, Copy)]
struct Slopes {
    /// At the facet's first corner.
    origin: f64,
    /// Change per pixel to the right.
    dx: f64,
    /// Change per pixel down.
    dy: f64,
    /// The smallest of the corners' values.
    low: f64,
    /// The largest of the corners' values.
    high: f64,
}

impl Slopes {
    fn at(&self, offset: DVec2) -> f64 {
        self.origin + self.dx * offset.x + self.dy * offset.y
    }

    /// A needle's slopes are huge and rounding may carry them beyond the corners.
    fn clamp(&self, value: f64) -> f64 {
        value.max(self.low).min(self.high)
    }
}

/// Depths of a facet: in f64 at every eighth column of the picture, and from there in f32, so that eight fit a SIMD
/// register and do not wait for each other.
#[derive(Debug, Clone, Copy)]
struct Depths {
    slopes: Slopes,
    slope: f32,
    low: f32,
    high: f32,
    /// From the facet's first corner to the centre of pixel (0, 0), in pixels.
    offset: DVec2,
}

impl Depths {
    #[inline(always)]
    fn new<const N: usize>(facet: &Facet<N>) -> Self {
        let slopes = facet.slopes(|corner| corner.z);
        Self {
            slope: narrow(slopes.dx),
            low: narrow(slopes.low),
            high: narrow(slopes.high),
            slopes,
            offset: facet.offset(0, 0),
        }
    }

    /// Before clamping, at the column `group` that starts a group.
    #[inline(always)]
    fn of_group(&self, row: i64, group: usize) -> f32 {
        let Slopes { origin, dx, dy, .. } = self.slopes;
        let of_row = origin + dx * self.offset.x + dy * (row as f64 + self.offset.y);
        narrow(of_row + dx * group as f64)
    }

    /// At a pixel.
    fn at(&self, column: usize, row: usize) -> f32 {
        let step = column % items::GROUP;
        let z = self.of_group(row as i64, column - step) + self.slope * step as f32;
        let z = if z > self.low { z } else { self.low };
        if z < self.high { z } else { self.high }
    }
}

/// A triangle on the screen with at least one row and column of pixel centres in its bounding box.
#[derive(Debug, Clone, Copy)]
struct Facet<'a, const N: usize> {
    corners: [&'a Corner<N>; 3],
    /// Sub-pixels in a pixel's side over twice the area in square sub-pixels.
    per_pixel: f64,
    columns: [i64; 2],
    rows: [i64; 2],
}

impl<'a, const N: usize> Facet<'a, N> {
    /// `area` is the corners' doubled area, not 0. `None` if no centre of a pixel of the rows is in the bounding box.
    fn new(
        rows: &Range<usize>,
        viewport: Viewport,
        [a, b, c]: [&'a Corner<N>; 3],
        area: i64,
    ) -> Option<Self> {
        let columns = centres(0..viewport.width, [a.x, b.x, c.x]);
        let rows = centres(rows.clone(), [a.y, b.y, c.y]);
        if columns[0] > columns[1] || rows[0] > rows[1] {
            return None;
        }
        let [b, c] = if area > 0 { [b, c] } else { [c, b] };
        Some(Self {
            corners: [a, b, c],
            per_pixel: SUBPIXELS as f64 / area.abs() as f64,
            columns,
            rows,
        })
    }

    /// Slopes of a quantity given at the corners: the plane through three points, by Cramer's rule.
    fn slopes(&self, quantity: impl Fn(&Corner<N>) -> f64) -> Slopes {
        let [a, b, c] = self.corners;
        let [origin, at_b, at_c] = self.corners.map(quantity);
        let subpixels = |from: i64, to: i64| (to - from) as f64;
        let (to_b, to_c) = (at_b - origin, at_c - origin);
        Slopes {
            origin,
            dx: (to_b * subpixels(a.y, c.y) - to_c * subpixels(a.y, b.y)) * self.per_pixel,
            dy: (to_c * subpixels(a.x, b.x) - to_b * subpixels(a.x, c.x)) * self.per_pixel,
            low: origin.min(at_b).min(at_c),
            high: origin.max(at_b).max(at_c),
        }
    }

    /// The smallest and the largest value of each attribute at the corners.
    fn attribute_ranges(&self) -> ([f32; N], [f32; N]) {
        let [a, b, c] = self.corners.map(|corner| corner.attributes.map(narrow));
        (
            std::array::from_fn(|k| a[k].min(b[k]).min(c[k])),
            std::array::from_fn(|k| a[k].max(b[k]).max(c[k])),
        )
    }

    /// From the first corner to the centre of a pixel, in pixels.
    fn offset(&self, column: usize, row: usize) -> DVec2 {
        let [a, ..] = self.corners;
        let pixel = DVec2::new(column as f64, row as f64) + 0.5;
        pixel - DVec2::new(a.x as f64, a.y as f64) / SUBPIXELS as f64
    }

    /// Calls `draw` with each row and its columns, where there are any.
    fn for_each_span(&self, mut draw: impl FnMut(usize, Range<usize>)) {
        let [a, b, c] = self.corners;
        let [top, bottom] = self.rows;
        let mut sides = [
            Side::new(a, b, top),
            Side::new(b, c, top),
            Side::new(c, a, top),
        ];
        for row in top..=bottom {
            let columns = self.columns;
            let [first, last] = sides
                .iter()
                .fold(columns, |span, side| side.narrow_span(span));
            if first <= last {
                draw(pixel_index(row), pixel_index(first)..pixel_index(last + 1));
            }
            sides.iter_mut().for_each(Side::step_down);
        }
    }
}

/// The first and the last pixel of a range whose centres lie within the corners' extent along one axis: on its lower end
/// (a top or left side) they count, on its upper end they do not.
fn centres<const C: usize>(pixels: Range<usize>, corners: [i64; C]) -> [i64; 2] {
    let low = corners.iter().fold(i64::MAX, |low, &c| low.min(c));
    let high = corners.iter().fold(i64::MIN, |high, &c| high.max(c));
    let first_from = |bound: i64| (bound - CENTRE + SUBPIXELS - 1).div_euclid(SUBPIXELS);
    [
        first_from(low).max(pixels.start as i64),
        (first_from(high) - 1).min(pixels.end as i64 - 1),
    ]
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a pixel of the picture: not negative, at most 2^16"
)]
fn pixel_index(pixel: i64) -> usize {
    pixel as usize
}
