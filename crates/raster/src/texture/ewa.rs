//! The elliptical weighted average (Heckbert 1989): a Gaussian around the pixel, carried onto the texture.

use super::texel::{Reader, Texel, inside_index, split};
use super::wrap::Wrap;
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

/// `A x^2 + B x y + C y^2 < 1`, around a pixel in texels of one level.
#[derive(Debug, Clone, Copy)]
struct Ellipse {
    a: f32,
    b: f32,
    c: f32,
    /// How far it reaches to the right and down.
    reach: Vec2,
}

impl Ellipse {
    /// The image of the unit circle under the two axes, widened by a texel so that it never falls between texels.
    fn new(d0: Vec2, d1: Vec2) -> Self {
        let a = d0.y * d0.y + d1.y * d1.y + 1.0;
        let b = -2.0 * (d0.x * d0.y + d1.x * d1.y);
        let c = d0.x * d0.x + d1.x * d1.x + 1.0;
        // A C - B^2 / 4, multiplied out: all terms are positive.
        let area = d0.perp_dot(d1);
        let scale = 1.0 / (area * area + d0.length_squared() + d1.length_squared() + 1.0);
        Self {
            a: a * scale,
            b: b * scale,
            c: c * scale,
            reach: Vec2::new(c.sqrt(), a.sqrt()),
        }
    }

    /// The part of it in a row of texels; `centre` lies in texel 0 of row 0.
    #[inline(always)]
    fn row(&self, row: i32, centre: Vec2) -> Row {
        let dy = offset(row) - centre.y;
        let share = dy / self.reach.y;
        let middle = centre.x - 0.5 * self.b / self.a * dy;
        let half = ((1.0 - share * share).max(0.0) / self.a).sqrt();
        let first = whole((middle - half).ceil());
        Row {
            first,
            last: whole((middle + half).floor()),
            dx: offset(first) - centre.x,
            a: self.a,
            b: self.b * dy,
            c: self.c * dy * dy,
        }
    }
}

/// The texels of a row that an ellipse holds, and their places in it.
#[derive(Debug, Clone, Copy)]
struct Row {
    first: i32,
    last: i32,
    dx: f32,
    a: f32,
    b: f32,
    c: f32,
}

impl Row {
    /// Weights of eight texels, `done` texels after the first; 0 beyond the last.
    #[inline(always)]
    fn weights(&self, done: f32) -> f32x8 {
        const STEPS: f32x8 = f32x8::new([0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0]);
        let x = f32x8::splat(self.dx + done) + STEPS;
        let [a, b, c] = [self.a, self.b, self.c].map(f32x8::splat);
        gaussian(a.mul_add(x, b).mul_add(x, c))
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
        let (centre, ellipse) = (Vec2::new(fx, fy), Ellipse::new(d0, d1));
        let mut mean = WeightedSum::default();
        let is_inside = self.holds(at, ellipse.reach);
        let (top, bottom) = (fy - ellipse.reach.y, fy + ellipse.reach.y);
        for row in whole(top.ceil())..=whole(bottom.floor()) {
            let span = ellipse.row(row, centre);
            let y = y + i64::from(row);
            if is_inside {
                self.add_inside(&mut mean, &span, x, y);
            } else {
                self.add_addressed(&mut mean, &span, x, y);
            }
        }
        mean.sum / mean.weight.reduce_add()
    }

    /// Whether all texels around a place are texels of the picture, with one to spare for rounding.
    #[inline]
    fn holds(&self, at: DVec2, reach: Vec2) -> bool {
        let size = DVec2::new(self.level.width as f64, self.level.height as f64);
        let reach = reach.as_dvec2() + 1.0;
        (at - reach).min_element() >= 0.0 && (size - 1.0 - at - reach).min_element() >= 0.0
    }

    /// Adds a row that lies in the picture; its texel 0 is in column `x`.
    #[inline(always)]
    fn add_inside(&self, mean: &mut WeightedSum, span: &Row, x: i64, y: i64) {
        let columns =
            inside_index(x + i64::from(span.first))..inside_index(x + i64::from(span.last) + 1);
        let mut done = 0.0;
        let texels = self.level.row(inside_index(y)).get(columns).unwrap_or(&[]);
        for texels in texels.chunks(8) {
            let weights = span.weights(done);
            for (texel, weight) in texels.iter().zip(weights.to_array()) {
                mean.sum += texel.decode(self.codec) * weight;
            }
            mean.weight += weights;
            done += 8.0;
        }
    }

    /// Adds a row through addressing.
    fn add_addressed(&self, mean: &mut WeightedSum, span: &Row, x: i64, y: i64) {
        let mut done = 0.0;
        for start in (span.first..=span.last).step_by(8) {
            let weights = span.weights(done);
            for (column, weight) in (start..=span.last).zip(weights.to_array()) {
                mean.sum += self.texel(x + i64::from(column), y) * weight;
            }
            mean.weight += weights;
            done += 8.0;
        }
    }
}

/// Texels times their weights, and the weights in eight parts.
#[derive(Debug, Clone, Copy, Default)]
struct WeightedSum {
    sum: Vec4,
    weight: f32x8,
}

#[inline(always)]
#[expect(
    clippy::cast_possible_truncation,
    reason = "the ellipse has a limited size"
)]
fn whole(x: f32) -> i32 {
    x as i32
}

#[inline(always)]
#[expect(clippy::cast_precision_loss, reason = "the ellipse has a limited size")]
fn offset(i: i32) -> f32 {
    i as f32
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::texture::texel::Level;
    use proptest::prelude::*;

    #[test]
    fn weights_are_the_gaussian() {
        for i in 0..=1000_u16 {
            let square = f32::from(i) / 800.0;
            let expected = ((-2.0 * square).exp() - (-2.0_f32).exp()).max(0.0);
            let found = gaussian(f32x8::splat(square)).to_array()[3];
            assert!(
                (found - expected).abs() < 5e-6,
                "{square}: {found}, not {expected}"
            );
        }
        assert_eq!(gaussian(f32x8::splat(1.5)).to_array(), [0.0; 8], "outside");
    }

    /// All texels of the level and its repetitions, one by one.
    fn naive(level: &Level<Vec4>, at: DVec2, d0: Vec2, d1: Vec2) -> Vec4 {
        let (d0, d1) = (d0.as_dvec2(), d1.as_dvec2());
        let (a, b, c) = (
            d0.y * d0.y + d1.y * d1.y + 1.0,
            -2.0 * (d0.x * d0.y + d1.x * d1.y),
            d0.x * d0.x + d1.x * d1.x + 1.0,
        );
        let f = a * c - b * b / 4.0;
        let (mut sum, mut total) = (glam::DVec4::ZERO, 0.0);
        for y in -40..110_i32 {
            for x in -40..110_i32 {
                let (dx, dy) = (f64::from(x) + 0.5 - at.x, f64::from(y) + 0.5 - at.y);
                let square = (a * dx * dx + b * dx * dy + c * dy * dy) / f;
                if square < 1.0 {
                    let weight = (-2.0 * square).exp() - (-2.0_f64).exp();
                    let wrapped =
                        |i: i32, size| Wrap::Repeat.index(i64::from(i), size).expect("no border");
                    let texel = level.row(wrapped(y, level.height))[wrapped(x, level.width)];
                    sum += texel.as_dvec4() * weight;
                    total += weight;
                }
            }
        }
        (sum / total).as_vec4()
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]
        #[test]
        fn mean_is_that_of_all_texels(
            u in 0.0_f64..1.0, v in 0.0_f64..1.0, turn in 0.0_f32..6.3,
            major in 0.0_f32..25.0, minor in 0.0_f32..6.0, is_large in any::<bool>(),
        ) {
            let (width, height) = if is_large { (70, 67) } else { (5, 3) };
            let texel = |i: u16| Vec4::new(f32::from(i % 97 * 31 % 97), f32::from(i % 89 * 17 % 89), f32::from(i % 7), 1.0);
            let count = u16::try_from(width * height).expect("small");
            let level = Level { width, height, texels: (0..count).map(texel).collect() };
            let reader = Reader { level: &level, codec: (), wrap: [Wrap::Repeat; 2], border: Vec4::ZERO };
            let axis = Vec2::from_angle(turn);
            let (d0, d1) = (axis * major, axis.perp() * minor);
            let found = reader.ewa(DVec2::new(u, v), d0, d1);
            let expected = naive(&level, reader.position(DVec2::new(u, v)), d0, d1);
            // The polynomial, and texels at the very edge.
            prop_assert!((found - expected).abs().max_element() < 5e-3, "{found}, not {expected}");
        }
    }
}
