//! The elliptical weighted average (Heckbert 1989): a Gaussian around the pixel, carried onto the texture.

use super::texel::{Reader, Texel, split};
use glam::{DVec2, Vec2, Vec4};
use std::sync::OnceLock;

/// Entries of the table of weights.
const STEPS: usize = 1024;

/// `exp(-2 r^2) - exp(-2)` by steps of r^2 from 0 to 1, in the middle of each; then 0.
fn weights() -> &'static [f32; STEPS + 1] {
    static TABLE: OnceLock<[f32; STEPS + 1]> = OnceLock::new();
    TABLE.get_or_init(|| {
        let weight = |step: usize| {
            let square = (step as f64 + 0.5) / STEPS as f64;
            narrow(((-2.0 * square).exp() - (-2.0_f64).exp()).max(0.0))
        };
        std::array::from_fn(weight)
    })
}

#[expect(clippy::cast_possible_truncation, reason = "rounds to the nearest f32")]
fn narrow(x: f64) -> f32 {
    x as f32
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
    fn row(&self, dy: f32) -> (f32, f32) {
        let middle = -0.5 * self.b * dy;
        let half = (self.f * (self.a - dy * dy)).max(0.0).sqrt();
        ((middle - half) / self.a, (middle + half) / self.a)
    }
}

impl<T: Texel> Reader<'_, T> {
    /// The mean of all texels in an ellipse of two axes in texels of this level, weighted by a Gaussian.
    ///
    /// The weight is 1 - e^-2 in the centre (before normalisation) and 0 on the ellipse, which is one texel larger than
    /// the axes say.
    pub(super) fn ewa(&self, uv: DVec2, d0: Vec2, d1: Vec2) -> Vec4 {
        let at = self.position(uv) - 0.5;
        let ((x, fx), (y, fy)) = (split(at.x), split(at.y));
        let ellipse = Ellipse::new(d0, d1);
        let (table, scale) = (weights(), STEPS as f32 / ellipse.f);
        let (mut sum, mut total) = (Vec4::ZERO, 0.0);
        let height = ellipse.height();
        for row in whole((fy - height).ceil())..=whole((fy + height).floor()) {
            let dy = offset(row) - fy;
            let (left, right) = ellipse.row(dy);
            for column in whole((fx + left).ceil())..=whole((fx + right).floor()) {
                let dx = offset(column) - fx;
                let square = ellipse.a * dx * dx + ellipse.b * dx * dy + ellipse.c * dy * dy;
                let weight = table[step(square * scale)];
                sum += self.texel(x + column, y + row) * weight;
                total += weight;
            }
        }
        sum / total
    }
}

#[expect(
    clippy::cast_possible_truncation,
    reason = "the ellipse has a limited size"
)]
fn whole(x: f32) -> i64 {
    x as i64
}

#[expect(clippy::cast_precision_loss, reason = "the ellipse has a limited size")]
fn offset(i: i64) -> f32 {
    i as f32
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "casts saturate at 0"
)]
fn step(x: f32) -> usize {
    (x as usize).min(STEPS)
}
