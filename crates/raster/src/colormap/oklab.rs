//! A space of colours in which distances are what is seen.

use crate::Rgb;

/// A colour in Oklab (Ottosson, *A perceptual color space for image processing*, 2020): equal distances look equally
/// different.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Oklab {
    /// Lightness, 0 for black and 1 for white.
    pub lightness: f32,
    /// From green to red.
    pub a: f32,
    /// From blue to yellow.
    pub b: f32,
}

impl Oklab {
    /// From lightness, chroma and hue in degrees: 29 is red, 142 green, 264 blue.
    pub fn from_hue(lightness: f32, chroma: f32, degrees: f32) -> Self {
        let (sine, cosine) = degrees.to_radians().sin_cos();
        Self {
            lightness,
            a: chroma * cosine,
            b: chroma * sine,
        }
    }

    /// The distance to another colour; 0.02 is about what can just be told apart.
    pub fn distance(self, other: Self) -> f32 {
        let square = |a: f32, b: f32| (a - b) * (a - b);
        let sum = square(self.lightness, other.lightness)
            + square(self.a, other.a)
            + square(self.b, other.b);
        sum.sqrt()
    }
}

/// Of linear Rec. 709 light; colours beyond its gamut have negative bands.
impl From<Oklab> for Rgb {
    fn from(c: Oklab) -> Self {
        let cube = |x: f32| x * x * x;
        let l = cube(c.lightness + 0.396_337_78 * c.a + 0.215_803_76 * c.b);
        let m = cube(c.lightness - 0.105_561_346 * c.a - 0.063_854_17 * c.b);
        let s = cube(c.lightness - 0.089_484_18 * c.a - 1.291_485_5 * c.b);
        Self::new(
            4.076_741_7 * l - 3.307_711_6 * m + 0.230_969_94 * s,
            -1.268_438 * l + 2.609_757_4 * m - 0.341_319_38 * s,
            -0.004_196_086_3 * l - 0.703_418_6 * m + 1.707_614_7 * s,
        )
    }
}

/// Of linear Rec. 709 light.
impl From<Rgb> for Oklab {
    fn from(c: Rgb) -> Self {
        let l = (0.412_221_46 * c.r + 0.536_332_55 * c.g + 0.051_445_995 * c.b).cbrt();
        let m = (0.211_903_5 * c.r + 0.680_699_5 * c.g + 0.107_396_96 * c.b).cbrt();
        let s = (0.088_302_46 * c.r + 0.281_718_85 * c.g + 0.629_978_7 * c.b).cbrt();
        Self {
            lightness: 0.210_454_26 * l + 0.793_617_8 * m - 0.004_072_047 * s,
            a: 1.977_998_5 * l - 2.428_592_2 * m + 0.450_593_7 * s,
            b: 0.025_904_037 * l + 0.782_771_77 * m - 0.808_675_77 * s,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_come_back() {
        for i in 0..125 {
            let band = |k: i32| (i / k % 5) as f32 / 4.0;
            let color = Rgb::new(band(1), band(5), band(25));
            let back = Rgb::from(Oklab::from(color));
            assert!(
                (back - color).map(f32::abs).max_band() < 2e-5,
                "{color:?}: {back:?}"
            );
        }
    }

    #[test]
    fn white_is_1_and_primaries_are_where_they_are_published() {
        let white = Oklab::from(Rgb::WHITE);
        assert!(
            white.distance(Oklab::from_hue(1.0, 0.0, 0.0)) < 1e-4,
            "{white:?}"
        );
        let red = Oklab::from(Rgb::new(1.0, 0.0, 0.0));
        let published = Oklab {
            lightness: 0.62796,
            a: 0.22486,
            b: 0.12585,
        };
        assert!(red.distance(published) < 1e-4, "{red:?}");
    }
}
