//! Bicubic magnification.

use super::texel::{Reader, Texel, split};
use glam::{DVec2, Vec4};

/// A kernel of the family of Mitchell and Netravali 1988; four texels along each axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Cubic {
    /// B = 0, C = 1/2: goes through the texels, sharp, overshoots at edges by up to 1/8 of their height... each way.
    #[default]
    CatmullRom,
    /// B = 1, C = 0: smooth to the second derivative and without overshoot, but blurs. For heights of bump maps.
    BSpline,
    /// B = C = 1/3: between the two.
    Mitchell,
}

impl Cubic {
    /// Weights of four texels for a point at `t` in [0, 1] of the way from the second to the third; their sum is 1.
    ///
    /// `[1 t t^2 t^3] M` with the matrices of `VK_EXT_filter_cubic`.
    #[inline]
    pub fn weights(self, t: f32) -> [f32; 4] {
        let (scale, matrix) = match self {
            Self::CatmullRom => (
                1.0 / 2.0,
                [
                    [0.0, 2.0, 0.0, 0.0],
                    [-1.0, 0.0, 1.0, 0.0],
                    [2.0, -5.0, 4.0, -1.0],
                    [-1.0, 3.0, -3.0, 1.0],
                ],
            ),
            Self::BSpline => (
                1.0 / 6.0,
                [
                    [1.0, 4.0, 1.0, 0.0],
                    [-3.0, 0.0, 3.0, 0.0],
                    [3.0, -6.0, 3.0, 0.0],
                    [-1.0, 3.0, -3.0, 1.0],
                ],
            ),
            Self::Mitchell => (
                1.0 / 18.0,
                [
                    [1.0, 16.0, 1.0, 0.0],
                    [-9.0, 0.0, 9.0, 0.0],
                    [15.0, -36.0, 27.0, -6.0],
                    [-7.0, 21.0, -21.0, 7.0],
                ],
            ),
        };
        let [a, b, c, d] = matrix.map(Vec4::from_array);
        ((((d * t + c) * t + b) * t + a) * scale).to_array()
    }
}

impl<T: Texel> Reader<'_, T> {
    /// The sum of 4 x 4 texels around a point under a cubic kernel.
    #[inline]
    pub(super) fn bicubic(&self, uv: DVec2, cubic: Cubic) -> Vec4 {
        let at = self.position(uv) - 0.5;
        let ((x, fx), (y, fy)) = (split(at.x), split(at.y));
        let (across, down) = (cubic.weights(fx), cubic.weights(fy));
        let mut sum = Vec4::ZERO;
        for (row, weight) in (y - 1..).zip(down) {
            let texels = self.four(x - 1, row);
            let mut mixed = Vec4::ZERO;
            for (texel, weight) in texels.into_iter().zip(across) {
                mixed += texel * weight;
            }
            sum += mixed * weight;
        }
        sum
    }

    /// Four texels of a row.
    #[inline]
    fn four(&self, x: i64, y: i64) -> [Vec4; 4] {
        let (width, height) = (self.level.width, self.level.height);
        if let (Ok(column), Ok(row)) = (usize::try_from(x), usize::try_from(y))
            && column + 3 < width
            && row < height
        {
            let texels = &self.level.row(row)[column..column + 4];
            return [texels[0], texels[1], texels[2], texels[3]].map(|t| t.decode(self.codec));
        }
        [0, 1, 2, 3].map(|k| self.texel(x + k, y))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The piecewise kernel of Mitchell and Netravali 1988, equation 8.
    fn kernel(x: f64, b: f64, c: f64) -> f64 {
        let x = x.abs();
        let (x2, x3) = (x * x, x * x * x);
        let six = if x < 1.0 {
            (12.0 - 9.0 * b - 6.0 * c) * x3 + (-18.0 + 12.0 * b + 6.0 * c) * x2 + (6.0 - 2.0 * b)
        } else if x < 2.0 {
            (-b - 6.0 * c) * x3
                + (6.0 * b + 30.0 * c) * x2
                + (-12.0 * b - 48.0 * c) * x
                + (8.0 * b + 24.0 * c)
        } else {
            0.0
        };
        six / 6.0
    }

    #[test]
    fn weights_are_the_kernel_of_mitchell_and_netravali() {
        let third = 1.0 / 3.0;
        for (cubic, b, c) in [
            (Cubic::CatmullRom, 0.0, 0.5),
            (Cubic::BSpline, 1.0, 0.0),
            (Cubic::Mitchell, third, third),
        ] {
            for step in 0..=64_u8 {
                let t = f32::from(step) / 64.0;
                let weights = cubic.weights(t);
                for (tap, weight) in (-1_i8..).zip(weights) {
                    let expected = kernel(f64::from(tap) - f64::from(t), b, c);
                    let error = (f64::from(weight) - expected).abs();
                    // Rounding of f32.
                    assert!(
                        error < 3e-7,
                        "{cubic:?} at {t}, tap {tap}: {weight}, not {expected}"
                    );
                }
                let sum: f32 = weights.iter().sum();
                assert!((sum - 1.0).abs() < 3e-7, "{cubic:?} at {t}: sum {sum}");
            }
        }
    }
}
