//! The elliptical weighted average (Heckbert 1989): a Gaussian around the pixel, carried onto the texture.

use super::texel::{Reader, Texel, split};
use super::wrap::Wrap;
use core::ops::Range;
use glam::{DVec2, Vec2, Vec4};
use wide::f32x8;

/// `exp(-2 s) - exp(-2)` of squares of distances `s`, 0 from 1 on.
///
/// As `(1 - s)` times a polynomial, so that the weight vanishes on the ellipse; its error is below 5e-6. Eight at once
/// it is faster than a table.
#[inline]
fn gaussian(squares: f32x8) -> f32x8 {
    const Q: [f32; 6] = [
        0.864_660_3,
        -1.135_007_7,
        0.860_711,
        -0.450_913_9,
        0.160_704_24,
        -0.029_487_216,
    ];
    let s = squares.min(f32x8::ONE);
    let q = Q[..5].iter().rev().fold(f32x8::splat(Q[5]), |sum, &c| {
        sum.mul_add(s, f32x8::splat(c))
    });
    (f32x8::ONE - s) * q
}

/// `A x^2 + B x y + C y^2 < F`, around a pixel in texels of one level.
#[derive(Debug, Clone, Copy)]
struct Ellipse {
    a: f32,
    b: f32,
    c: f32,
    f: f32,
}

impl Ellipse {
    /// The image of the unit circle under the two axes, widened by a texel so that it never falls between texels.
    fn new(d0: Vec2, d1: Vec2) -> Self {
        let a = d0.y * d0.y + d1.y * d1.y + 1.0;
        let b = -2.0 * (d0.x * d0.y + d1.x * d1.y);
        let c = d0.x * d0.x + d1.x * d1.x + 1.0;
        // A C - B^2 / 4, multiplied out: all terms are positive.
        let area = d0.perp_dot(d1);
        let f = area * area + d0.length_squared() + d1.length_squared() + 1.0;
        Self { a, b, c, f }
    }

    /// How far it reaches up and down.
    fn height(&self) -> f32 {
        self.a.sqrt()
    }

    /// Where it begins and ends in the row at `dy` from its centre.
    #[inline]
    fn row(&self, dy: f32) -> (f32, f32) {
        let middle = -0.5 * self.b * dy;
        let half = (self.f * (self.a - dy * dy)).max(0.0).sqrt();
        let inverse = 1.0 / self.a;
        ((middle - half) * inverse, (middle + half) * inverse)
    }

    /// `(A x^2 + B x y + C y^2) / F` of eight texels of a row, as a function of how many lie before them; the first of
    /// the row is at `dx` from the centre.
    #[inline]
    fn along(&self, dy: f32, dx: f32) -> impl Fn(f32) -> f32x8 {
        let scale = 1.0 / self.f;
        let [a, b, c] = [self.a, self.b * dy, self.c * dy * dy].map(|k| f32x8::splat(k * scale));
        move |before| {
            let x =
                f32x8::splat(dx + before) + f32x8::new([0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0]);
            a.mul_add(x, b).mul_add(x, c)
        }
    }
}

impl<T: Texel> Reader<'_, T> {
    /// The mean of all texels in an ellipse of two axes in texels of this level, weighted by a Gaussian.
    ///
    /// The weight is 1 - e^-2 in the centre (before normalisation) and 0 on the ellipse, which is one texel larger than
    /// the axes say.
    pub(super) fn ewa(&self, uv: DVec2, d0: Vec2, d1: Vec2) -> Vec4 {
        if self.level.texels.len() == 1 && !self.wrap.contains(&Wrap::Border) {
            return self.inside(0, 0);
        }
        let at = self.position(uv) - 0.5;
        let ((x, fx), (y, fy)) = (split(at.x), split(at.y));
        let ellipse = Ellipse::new(d0, d1);
        let mut mean = WeightedSum::default();
        let height = ellipse.height();
        for row in whole((fy - height).ceil())..=whole((fy + height).floor()) {
            let dy = offset(row) - fy;
            let (left, right) = ellipse.row(dy);
            let (first, last) = (whole((fx + left).ceil()), whole((fx + right).floor()));
            let columns = x + i64::from(first)..x + i64::from(last) + 1;
            let squares = ellipse.along(dy, offset(first) - fx);
            self.add_row(&mut mean, columns, y + i64::from(row), squares);
        }
        mean.sum / mean.weight
    }

    /// Adds the texels of a row, eight weights at a time.
    #[inline]
    fn add_row(
        &self,
        mean: &mut WeightedSum,
        columns: Range<i64>,
        y: i64,
        squares: impl Fn(f32) -> f32x8,
    ) {
        let row = self.wrap[1].index(y, self.level.height);
        let inside = row.and_then(|row| {
            let start = usize::try_from(columns.start).ok()?;
            let end = usize::try_from(columns.end).ok()?;
            self.level.row(row).get(start..end)
        });
        let mut done = 0.0;
        if let Some(texels) = inside {
            for texels in texels.chunks(8) {
                let weights = gaussian(squares(done)).to_array();
                for (texel, weight) in texels.iter().zip(weights) {
                    mean.add(texel.decode(self.codec), weight);
                }
                done += 8.0;
            }
            return;
        }
        for start in columns.clone().step_by(8) {
            let weights = gaussian(squares(done)).to_array();
            for (x, weight) in (start..columns.end).zip(weights) {
                mean.add(self.texel(x, y), weight);
            }
            done += 8.0;
        }
    }
}

/// Texels times their weights.
#[derive(Debug, Clone, Copy, Default)]
struct WeightedSum {
    sum: Vec4,
    weight: f32,
}

impl WeightedSum {
    #[inline(always)]
    fn add(&mut self, texel: Vec4, weight: f32) {
        self.sum += texel * weight;
        self.weight += weight;
    }
}

#[inline]
#[expect(
    clippy::cast_possible_truncation,
    reason = "the ellipse has a limited size"
)]
fn whole(x: f32) -> i32 {
    x as i32
}

#[inline]
#[expect(clippy::cast_precision_loss, reason = "the ellipse has a limited size")]
fn offset(i: i32) -> f32 {
    i as f32
}
