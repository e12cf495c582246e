//! Storage: texels as floats or as bytes, level by level.

use super::wrap::Wrap;
use crate::color::{linear_from_srgb, linear_from_srgb8_table};
use glam::{DVec2, Vec4};
use std::sync::OnceLock;

/// How a texel is stored.
pub(super) trait Texel: Copy {
    /// What decoding needs.
    type Codec: Copy;
    /// Linear red, green, blue, alpha.
    fn decode(self, codec: Self::Codec) -> Vec4;
    /// The nearest storable texel.
    fn encode(color: Vec4, codec: Self::Codec) -> Self;
}

impl Texel for Vec4 {
    type Codec = ();

    #[inline(always)]
    fn decode(self, (): ()) -> Vec4 {
        self
    }

    #[inline(always)]
    fn encode(color: Vec4, (): ()) -> Self {
        color
    }
}

/// The transfer functions of a texture in bytes.
#[derive(Debug, Clone, Copy)]
pub(super) struct ByteCodec {
    color: &'static ByteTable,
    alpha: &'static ByteTable,
}

impl ByteCodec {
    pub(super) fn new(is_srgb: bool) -> Self {
        let alpha = ByteTable::linear();
        Self {
            color: if is_srgb { ByteTable::srgb() } else { alpha },
            alpha,
        }
    }
}

impl Texel for [u8; 4] {
    type Codec = ByteCodec;

    #[inline(always)]
    fn decode(self, codec: ByteCodec) -> Vec4 {
        let color = &codec.color.linear;
        Vec4::new(
            color[usize::from(self[0])],
            color[usize::from(self[1])],
            color[usize::from(self[2])],
            codec.alpha.linear[usize::from(self[3])],
        )
    }

    fn encode(color: Vec4, codec: ByteCodec) -> Self {
        let [r, g, b] = [color.x, color.y, color.z].map(|c| codec.color.code(c));
        [r, g, b, codec.alpha.code(color.w)]
    }
}

/// A transfer function of 8-bit codes and its inverse.
#[derive(Debug)]
struct ByteTable {
    /// Linear value of each code.
    linear: [f32; 256],
    /// The linear value from which on the code is the next one; the last is infinite.
    next_from: [f32; 256],
    /// Code at the lower end of each of equal steps from 0 to 1: at most a few below the code sought.
    start: [u8; Self::STEPS + 1],
}

impl ByteTable {
    const STEPS: usize = 4096;

    fn srgb() -> &'static Self {
        static TABLE: OnceLock<ByteTable> = OnceLock::new();
        TABLE.get_or_init(|| Self::new(*linear_from_srgb8_table(), linear_from_srgb))
    }

    fn linear() -> &'static Self {
        static TABLE: OnceLock<ByteTable> = OnceLock::new();
        TABLE.get_or_init(|| Self::new(std::array::from_fn(|c| c as f32 / 255.0), |x| x))
    }

    fn new(linear: [f32; 256], decode: impl Fn(f32) -> f32) -> Self {
        let boundary = |code: usize| decode((code as f32 + 0.5) / 255.0);
        let mut next_from: [f32; 256] = std::array::from_fn(boundary);
        next_from[255] = f32::INFINITY;
        let mut code = 0;
        let start = std::array::from_fn(|step| {
            while step as f32 / Self::STEPS as f32 >= next_from[usize::from(code)] {
                code += 1;
            }
            code
        });
        Self {
            linear,
            next_from,
            start,
        }
    }

    /// The code whose encoded value is nearest; below 0 and NaN give 0, above 1 gives 255.
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "clamped to the table; NaN casts to 0"
    )]
    fn code(&self, linear: f32) -> u8 {
        let linear = linear.clamp(0.0, 1.0);
        let step = (linear * Self::STEPS as f32) as usize;
        let mut code = self.start[step];
        while linear >= self.next_from[usize::from(code)] {
            code += 1;
        }
        code
    }
}

/// One level of a mip chain, row by row.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Level<T> {
    pub(super) width: usize,
    pub(super) height: usize,
    pub(super) texels: Vec<T>,
}

impl<T: Texel> Level<T> {
    pub(super) fn row(&self, y: usize) -> &[T] {
        &self.texels[y * self.width..][..self.width]
    }

    /// The same level with another kind of texel.
    pub(super) fn mapped<U>(&self, texel: impl Fn(&T) -> U) -> Level<U> {
        Level {
            width: self.width,
            height: self.height,
            texels: self.texels.iter().map(texel).collect(),
        }
    }
}

/// A level with all that reading it needs.
#[derive(Debug, Clone, Copy)]
pub(super) struct Reader<'a, T: Texel> {
    pub(super) level: &'a Level<T>,
    pub(super) codec: T::Codec,
    pub(super) wrap: [Wrap; 2],
    pub(super) border: Vec4,
}

impl<T: Texel> Reader<'_, T> {
    /// The texel of any column and row.
    #[inline]
    pub(super) fn texel(&self, x: i64, y: i64) -> Vec4 {
        let column = self.wrap[0].index(x, self.level.width);
        let row = self.wrap[1].index(y, self.level.height);
        match (column, row) {
            (Some(column), Some(row)) => self.inside(column, row),
            _ => self.border,
        }
    }

    /// A texel that exists.
    #[inline(always)]
    pub(super) fn inside(&self, x: usize, y: usize) -> Vec4 {
        self.level.texels[y * self.level.width + x].decode(self.codec)
    }

    /// Coordinates in texels: 0 is the left or upper edge of the first one.
    #[inline]
    pub(super) fn position(&self, uv: DVec2) -> DVec2 {
        let [wrap_u, wrap_v] = self.wrap;
        DVec2::new(
            wrap_u.reduce(uv.x) * self.level.width as f64,
            wrap_v.reduce(uv.y) * self.level.height as f64,
        )
    }

    /// The texel that holds a point.
    #[inline]
    pub(super) fn nearest(&self, uv: DVec2) -> Vec4 {
        let at = self.position(uv);
        self.texel(split(at.x).0, split(at.y).0)
    }

    /// The mean of the four texels around a point, weighted by nearness.
    ///
    /// As nested `a + t (b - a)`: equal texels give exactly their value.
    #[inline]
    pub(super) fn bilinear(&self, uv: DVec2) -> Vec4 {
        let at = self.position(uv) - 0.5;
        let ((x, fx), (y, fy)) = (split(at.x), split(at.y));
        let [a, b, c, d] = self.quad(x, y);
        let (upper, lower) = (a + (b - a) * fx, c + (d - c) * fx);
        upper + (lower - upper) * fy
    }

    /// Texels `(x, y)`, `(x + 1, y)`, `(x, y + 1)`, `(x + 1, y + 1)`.
    #[inline]
    fn quad(&self, x: i64, y: i64) -> [Vec4; 4] {
        let (width, height) = (self.level.width, self.level.height);
        if let (Ok(column), Ok(row)) = (usize::try_from(x), usize::try_from(y))
            && column + 1 < width
            && row + 1 < height
        {
            let first = row * width + column;
            let (upper, lower) = (
                &self.level.texels[first..first + 2],
                &self.level.texels[first + width..first + width + 2],
            );
            return [upper[0], upper[1], lower[0], lower[1]].map(|t| t.decode(self.codec));
        }
        [(x, y), (x + 1, y), (x, y + 1), (x + 1, y + 1)].map(|(x, y)| self.texel(x, y))
    }
}

/// The whole part and the fraction of a position in texels.
#[inline]
#[expect(
    clippy::cast_possible_truncation,
    reason = "reduced positions fit; the fraction is rounded to f32"
)]
pub(super) fn split(position: f64) -> (i64, f32) {
    let whole = position.floor();
    (whole as i64, (position - whole) as f32)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::color::srgb_from_linear;

    #[test]
    fn bytes_encode_to_the_nearest_code() {
        for i in 0..=200_000_u32 {
            let linear = i as f32 / 200_000.0;
            let code = f32::from(ByteTable::srgb().code(linear));
            let encoded = 255.0 * srgb_from_linear(linear);
            // Rounding of the power function at boundaries.
            assert!((encoded - code).abs() < 0.5001, "{linear}: {code}");
        }
        for code in 0..=255_u8 {
            for table in [ByteTable::srgb(), ByteTable::linear()] {
                assert_eq!(table.code(table.linear[usize::from(code)]), code, "{code}");
            }
        }
        for (linear, code) in [(f32::NAN, 0), (-1.0, 0), (7.0, 255), (f32::INFINITY, 255)] {
            assert_eq!(ByteTable::srgb().code(linear), code, "{linear}");
        }
    }
}
