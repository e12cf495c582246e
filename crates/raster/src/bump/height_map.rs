//! Pictures of heights, with the slopes of a smooth surface through them.

use super::SlopeMoments;
use crate::Image;
use glam::{Vec2, Vec3};

/// The longest side of a height map.
pub const MAX_SIDE: usize = 1 << 14;

/// A picture that is no height map.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum HeightMapError {
    /// It has no texels or too many.
    #[error("a height map of {width} x {height} texels; each side has 1 to {MAX_SIDE}")]
    Size {
        /// Texels in a row.
        width: usize,
        /// Rows.
        height: usize,
    },
    /// A height is not a number.
    #[error("height {value} in column {x}, row {y}; heights are finite numbers")]
    Height {
        /// Its value.
        value: f32,
        /// Its column.
        x: usize,
        /// Its row.
        y: usize,
    },
}

/// Heights over the texture square, repeating beyond it.
///
/// Between texels the height is a uniform cubic B-spline with the texels as its coefficients. It is twice continuously
/// differentiable, so that the shading of a magnified bump has no kinks (a bilinear height has facets, a Catmull-Rom one
/// has kinks in its slope's slope); it smooths a little: a single texel of height 1 becomes a hump of height 4/9.
#[derive(Debug, Clone, PartialEq)]
pub struct HeightMap {
    heights: Image<f32>,
}

/// Height and slopes of a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HeightSample {
    /// Height, as in the picture.
    pub height: f32,
    /// Its derivatives by u and v.
    pub slopes: Vec2,
}

impl HeightMap {
    /// From heights in any unit, in which slopes per u and v will be.
    pub fn new(heights: Image<f32>) -> Result<Self, HeightMapError> {
        let (width, height) = (heights.width(), heights.height());
        let sides = 1..=MAX_SIDE;
        if !sides.contains(&width) || !sides.contains(&height) {
            return Err(HeightMapError::Size { width, height });
        }
        if let Some(i) = heights.pixels().iter().position(|h| !h.is_finite()) {
            let (x, y) = (i % width, i / width);
            let value = heights.pixels()[i];
            return Err(HeightMapError::Height { value, x, y });
        }
        Ok(Self { heights })
    }

    /// From a function over the texture square, taken at the texels' centres.
    pub fn from_fn(
        width: usize,
        height: usize,
        f: impl Fn(Vec2) -> f32,
    ) -> Result<Self, HeightMapError> {
        let (w, h) = (width.min(MAX_SIDE + 1), height.min(MAX_SIDE + 1));
        let refused = || HeightMapError::Size { width, height };
        if w != width || h != height {
            return Err(refused());
        }
        let size = Vec2::new(w as f32, h as f32);
        let texels =
            (0..w * h).map(|i| f(Vec2::new((i % w) as f32 + 0.5, (i / w) as f32 + 0.5) / size));
        let heights = Image::from_pixels(w, h, texels.collect()).ok_or_else(refused)?;
        Self::new(heights)
    }

    /// The texels.
    pub fn heights(&self) -> &Image<f32> {
        &self.heights
    }

    fn size(&self) -> Vec2 {
        Vec2::new(self.heights.width() as f32, self.heights.height() as f32)
    }

    /// Height and exact slopes of the B-spline at a texture coordinate; 0 where that is not finite.
    pub fn sample(&self, texcoord: Vec2) -> HeightSample {
        let (width, height) = (self.heights.width(), self.heights.height());
        let at = (texcoord - texcoord.floor()) * self.size() - 0.5;
        if !at.is_finite() {
            return HeightSample {
                height: 0.0,
                slopes: Vec2::ZERO,
            };
        }
        let first = at.floor();
        let (wx, dx) = b_spline(at.x - first.x);
        let (wy, dy) = b_spline(at.y - first.y);
        let columns = taps(first.x, width);
        let rows = taps(first.y, height);
        let (mut value, mut slopes) = (0.0, Vec2::ZERO);
        for (j, row) in rows.into_iter().enumerate() {
            let texels = columns.map(|x| self.heights.pixels()[row * width + x]);
            let along = |w: [f32; 4]| (0..4).map(|i| w[i] * texels[i]).sum::<f32>();
            let sum = along(wx);
            value += wy[j] * sum;
            slopes += Vec2::new(wy[j] * along(dx), dy[j] * sum);
        }
        HeightSample {
            height: value,
            slopes: slopes * self.size(),
        }
    }

    /// Slopes of the bilinear height: with facets at every texel under magnification, but half the work.
    pub fn bilinear_slopes(&self, texcoord: Vec2) -> Vec2 {
        let (width, height) = (self.heights.width(), self.heights.height());
        let at = (texcoord - texcoord.floor()) * self.size() - 0.5;
        if !at.is_finite() {
            return Vec2::ZERO;
        }
        let first = at.floor();
        let [_, x0, x1, _] = taps(first.x, width);
        let [_, y0, y1, _] = taps(first.y, height);
        let texel = |x: usize, y: usize| self.heights.pixels()[y * width + x];
        let (a, b, c, d) = (texel(x0, y0), texel(x1, y0), texel(x0, y1), texel(x1, y1));
        let t = at - first;
        let along_u = (b - a) * (1.0 - t.y) + (d - c) * t.y;
        let along_v = (c - a) * (1.0 - t.x) + (d - b) * t.x;
        Vec2::new(along_u, along_v) * self.size()
    }

    /// The tangent-space normal (x right, y up, z out) at a texture coordinate, for a texture that measures `extent` along
    /// u and v in the unit of heights.
    pub fn normal(&self, texcoord: Vec2, extent: Vec2) -> Vec3 {
        let slopes = self.sample(texcoord).slopes / extent;
        // v points down and y up.
        Vec3::new(-slopes.x, slopes.y, 1.0).normalize_or(Vec3::Z)
    }

    /// For each texel the moments of the slopes on its area, per u and v: what a pyramid for distance starts from.
    ///
    /// Knots of the spline lie at the texels' centres, so each quarter of a texel has a polynomial of its own; there
    /// Gauss's rule of two by two points is exact for the slopes, and leaves out of their squares the terms of fourth
    /// order: on noise as fine as the texels 0.4 % of the mean square.
    pub fn slope_moments(&self) -> Image<SlopeMoments> {
        /// Points within a side of a texel, all of the same weight.
        const POINTS: [f32; 4] = [
            0.25 - 0.144_337_57,
            0.25 + 0.144_337_57,
            0.75 - 0.144_337_57,
            0.75 + 0.144_337_57,
        ];
        let (width, height) = (self.heights.width(), self.heights.height());
        let moments = |i: usize| {
            let corner = Vec2::new((i % width) as f32, (i / width) as f32);
            let points = POINTS.iter().flat_map(|&y| POINTS.map(|x| Vec2::new(x, y)));
            let slopes = points.map(|point| self.sample((corner + point) / self.size()).slopes);
            let sum = slopes.fold(SlopeMoments::default(), |sum, b| sum + SlopeMoments::of(b));
            sum * (1.0 / 16.0)
        };
        let texels = (0..width * height).map(moments).collect();
        Image::from_pixels(width, height, texels).expect("one for each texel")
    }
}

/// The uniform cubic B-spline's weights at `t` in [0, 1] between the second and third tap, and their derivatives.
fn b_spline(t: f32) -> ([f32; 4], [f32; 4]) {
    let s = 1.0 - t;
    let weights = [
        s * s * s,
        3.0 * t * t * t - 6.0 * t * t + 4.0,
        3.0 * s * s * s - 6.0 * s * s + 4.0,
        t * t * t,
    ];
    let slopes = [
        -0.5 * s * s,
        1.5 * t * t - 2.0 * t,
        -1.5 * s * s + 2.0 * s,
        0.5 * t * t,
    ];
    (weights.map(|w| w / 6.0), slopes)
}

/// The texels `first - 1` to `first + 2`, repeating.
#[expect(
    clippy::cast_possible_truncation,
    reason = "`first` is -1 to 2^14; rem_euclid is not negative"
)]
fn taps(first: f32, size: usize) -> [usize; 4] {
    let (first, size) = (first as i64, size as i64);
    [-1, 0, 1, 2].map(|k| (first + k).rem_euclid(size) as usize)
}
