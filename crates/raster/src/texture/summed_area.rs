//! Summed-area tables: the sum over any rectangle from its corners (Crow 1984).

use super::chain::Texture;
use super::sampler::{Sampler, finite};
use super::wrap::Wrap;
use glam::{DVec2, DVec4, Vec2, Vec4};

/// Sums of all texels above and to the left of each corner between texels.
///
/// The box around a footprint is averaged exactly, however long, with every rule of addressing; footprints that lie across
/// u and v are blurred, because their box is larger than they are. Sums are f64: of a picture of 65 536 x 65 536 texels
/// 21 bits are left for the mean of one texel, f32 would have none beyond 4096 x 4096. Takes 32 bytes per texel.
#[derive(Debug, Clone)]
pub struct SummedAreaTable {
    width: usize,
    height: usize,
    /// `(width + 1) x (height + 1)`, the first row and column 0.
    sums: Vec<DVec4>,
}

/// A part of the way from minus infinity to a coordinate: `weight` times the sum up to `corner`.
#[derive(Debug, Clone, Copy, Default)]
struct Term {
    corner: usize,
    weight: f64,
}

/// The terms of an interval along one axis, and how much of it lies inside of the border.
#[derive(Debug, Clone, Copy, Default)]
struct Interval {
    terms: [Term; 6],
    inside: f64,
}

impl SummedAreaTable {
    /// From the largest level of a texture.
    pub fn new(texture: &Texture) -> Self {
        let base = texture.base();
        let (width, height) = (base.width, base.height);
        let mut sums = vec![DVec4::ZERO; (width + 1) * (height + 1)];
        for y in 0..height {
            let mut row_sum = DVec4::ZERO;
            for (x, texel) in base.row(y).iter().enumerate() {
                row_sum += texel.as_dvec4();
                let at = (y + 1) * (width + 1) + x + 1;
                sums[at] = sums[at - width - 1] + row_sum;
            }
        }
        Self {
            width,
            height,
            sums,
        }
    }

    /// The mean over a rectangle in texture coordinates, texels being squares of one colour.
    pub fn mean(&self, sampler: &Sampler, low: Vec2, high: Vec2) -> Vec4 {
        self.box_mean(sampler, finite(low), finite(high))
    }

    /// The texture as a pixel sees it: the mean over the box of its footprint, which is at least one texel wide and high.
    ///
    /// Along u the box spans `|du/dx| + |du/dy|`, the extent of the parallelogram, along v likewise.
    pub fn sample_grad(&self, sampler: &Sampler, uv: Vec2, ddx: Vec2, ddy: Vec2) -> Vec4 {
        let texel = DVec2::new(1.0 / self.width as f64, 1.0 / self.height as f64);
        let extent = (ddx.abs() + ddy.abs()).as_dvec2();
        // Beyond this many copies the mean of a box is that of the whole.
        let most = |x: f64| if x.is_finite() { x.min(1e6) } else { 1e6 };
        let half = 0.5 * DVec2::new(most(extent.x), most(extent.y)).max(texel);
        let uv = finite(uv);
        self.box_mean(sampler, uv - half, uv + half)
    }

    fn box_mean(&self, sampler: &Sampler, low: DVec2, high: DVec2) -> Vec4 {
        let size = DVec2::new(self.width as f64, self.height as f64);
        let extent = ((high - low) * size).max(DVec2::splat(1e-9));
        // Both ends move by the same number of periods, so that far coordinates lose no digit.
        let origin =
            DVec2::new(sampler.wrap[0].reduce(low.x), sampler.wrap[1].reduce(low.y)) * size;
        let columns = Interval::new(sampler.wrap[0], origin.x, origin.x + extent.x, self.width);
        let rows = Interval::new(sampler.wrap[1], origin.y, origin.y + extent.y, self.height);
        let mut sum = DVec4::ZERO;
        for row in rows.terms.iter().filter(|t| t.weight != 0.0) {
            let sums = &self.sums[row.corner * (self.width + 1)..];
            for column in columns.terms.iter().filter(|t| t.weight != 0.0) {
                sum += sums[column.corner] * (row.weight * column.weight);
            }
        }
        let area = extent.x * extent.y;
        let outside = 1.0 - columns.inside * rows.inside / area;
        (sum / area + sampler.border.as_dvec4() * outside.max(0.0)).as_vec4()
    }
}

impl Interval {
    /// From `low` to `high` in texels, either of which may lie outside of the picture.
    fn new(wrap: Wrap, low: f64, high: f64, size: usize) -> Self {
        let ([a, b, c], [d, e, f]) = (prefix(wrap, high, size), prefix(wrap, low, size));
        let inside = match wrap {
            Wrap::Border => high.clamp(0.0, size as f64) - low.clamp(0.0, size as f64),
            _ => high - low,
        };
        Self {
            terms: [a, b, c, negative(d), negative(e), negative(f)],
            inside,
        }
    }
}

/// The integral from 0 to `x` texels as terms of the table.
fn prefix(wrap: Wrap, x: f64, size: usize) -> [Term; 3] {
    let n = size as f64;
    let whole = |weight| Term {
        corner: size,
        weight,
    };
    match wrap {
        Wrap::Repeat => {
            let copies = (x / n).floor();
            let [a, b] = within(x - copies * n, size);
            [a, b, whole(copies)]
        }
        Wrap::MirroredRepeat => {
            let pairs = (x / (2.0 * n)).floor();
            let rest = x - pairs * 2.0 * n;
            if rest <= n {
                let [a, b] = within(rest, size);
                [a, b, whole(2.0 * pairs)]
            } else {
                let [a, b] = within(2.0 * n - rest, size).map(negative);
                [a, b, whole(2.0 * pairs + 2.0)]
            }
        }
        Wrap::ClampToEdge if x < 0.0 => [
            Term {
                corner: 1,
                weight: x,
            },
            Term::default(),
            Term::default(),
        ],
        Wrap::MirrorOnce if x < 0.0 => prefix(Wrap::ClampToEdge, -x, size).map(negative),
        Wrap::ClampToEdge | Wrap::MirrorOnce if x > n => {
            let beyond = x - n;
            let before_last = Term {
                corner: size - 1,
                weight: -beyond,
            };
            [whole(1.0 + beyond), before_last, Term::default()]
        }
        Wrap::ClampToEdge | Wrap::MirrorOnce | Wrap::Border => {
            let [a, b] = within(x.clamp(0.0, n), size);
            [a, b, Term::default()]
        }
    }
}

/// The integral from 0 to `x`, which lies in the picture: linear within each texel.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "casts saturate at 0, and the last texel is the limit"
)]
fn within(x: f64, size: usize) -> [Term; 2] {
    let texel = (x as usize).min(size - 1);
    let part = x - texel as f64;
    [
        Term {
            corner: texel,
            weight: 1.0 - part,
        },
        Term {
            corner: texel + 1,
            weight: part,
        },
    ]
}

fn negative(term: Term) -> Term {
    Term {
        weight: -term.weight,
        ..term
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Image;
    use crate::texture::TextureOptions;
    use proptest::prelude::*;

    /// Five by three texels of exact numbers.
    fn texture() -> Texture {
        let texel = |i: u8| [f32::from(i * i % 17), f32::from(i), f32::from(40 - i), 1.0];
        let image = Image::from_pixels(5, 3, (0..15).map(texel).collect()).expect("15 texels");
        Texture::new(&image, &TextureOptions::default()).expect("it has texels")
    }

    proptest! {
        /// Ends on eighths of a texel: sums over the eighths are exact.
        #[test]
        fn mean_of_a_box_is_the_mean_of_its_texels(
            left in -120_i16..120, top in -120_i16..120, width in 1_i16..90, height in 1_i16..60,
            rules in [0_usize..5, 0_usize..5],
        ) {
            let texture = texture();
            let table = SummedAreaTable::new(&texture);
            let sampler = Sampler::default()
                .with_wrap(rules.map(|rule| Wrap::ALL[rule]))
                .with_border(Vec4::new(50.0, 60.0, 70.0, 80.0));
            let base = texture.base();
            let mut sum = DVec4::ZERO;
            for y in top..top + height {
                for x in left..left + width {
                    let column = sampler.wrap[0].index(i64::from(x.div_euclid(8)), 5);
                    let row = sampler.wrap[1].index(i64::from(y.div_euclid(8)), 3);
                    sum += match (column, row) {
                        (Some(column), Some(row)) => base.row(row)[column],
                        _ => sampler.border,
                    }.as_dvec4();
                }
            }
            let expected = sum / (f64::from(width) * f64::from(height));
            let uv = |x: i16, y: i16| DVec2::new(f64::from(x) / 40.0, f64::from(y) / 24.0);
            let found = table.box_mean(&sampler, uv(left, top), uv(left + width, top + height));
            prop_assert!((found.as_dvec4() - expected).length() < 1e-4, "{found}, not {expected}");
        }
    }

    #[test]
    fn box_of_one_texel_is_bilinear() {
        let texture = texture();
        let table = SummedAreaTable::new(&texture);
        let sampler = Sampler::default();
        for i in 0..50_u8 {
            let uv = Vec2::new(f32::from(i) * 0.071 - 1.0, f32::from(i) * 0.037);
            let found = table.sample_grad(&sampler, uv, Vec2::ZERO, Vec2::ZERO);
            let expected = sampler.sample(&texture, uv);
            assert!(
                (found - expected).length() < 1e-4,
                "{found}, not {expected}"
            );
        }
    }

    #[test]
    fn endless_footprints_see_the_mean() {
        let table = SummedAreaTable::new(&texture());
        let far = table.sample_grad(
            &Sampler::default(),
            Vec2::ONE,
            Vec2::splat(f32::INFINITY),
            Vec2::splat(f32::NAN),
        );
        assert!((far.y - 7.0).abs() < 1e-4, "{far}");
    }
}
