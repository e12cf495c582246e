//! Linear colour and the sRGB transfer function.

use core::ops::{Add, AddAssign, Div, Index, IndexMut, Mul, MulAssign, Neg, Sub, SubAssign};
use serde::{Deserialize, Serialize};

/// Three bands of a linear quantity: Rec. 709 primaries, no transfer function, unit as the context says.
#[derive(
    Debug,
    Clone,
    Copy,
    PartialEq,
    Default,
    Serialize,
    Deserialize,
    bytemuck::Pod,
    bytemuck::Zeroable,
)]
#[repr(C)]
pub struct Rgb {
    /// Red band.
    pub r: f32,
    /// Green band.
    pub g: f32,
    /// Blue band.
    pub b: f32,
}

impl Rgb {
    /// All bands 0.
    pub const BLACK: Self = Self::splat(0.0);
    /// All bands 1.
    pub const WHITE: Self = Self::splat(1.0);

    /// A colour of its three bands.
    pub const fn new(r: f32, g: f32, b: f32) -> Self {
        Self { r, g, b }
    }

    /// The same value in all bands.
    pub const fn splat(value: f32) -> Self {
        Self::new(value, value, value)
    }

    /// The bands in the order red, green, blue.
    pub const fn to_array(self) -> [f32; 3] {
        [self.r, self.g, self.b]
    }

    /// Relative luminance `Y = 0.2126 R + 0.7152 G + 0.0722 B` (ITU-R BT.709).
    #[inline]
    pub fn luminance(self) -> f32 {
        0.2126 * self.r + 0.7152 * self.g + 0.0722 * self.b
    }

    /// The largest of the three bands.
    #[inline]
    pub fn max_band(self) -> f32 {
        self.r.max(self.g).max(self.b)
    }

    /// Applies `f` to each band.
    #[inline]
    pub fn map(self, f: impl Fn(f32) -> f32) -> Self {
        Self::new(f(self.r), f(self.g), f(self.b))
    }

    /// Whether no band is NaN or infinite.
    pub fn is_finite(self) -> bool {
        self.r.is_finite() && self.g.is_finite() && self.b.is_finite()
    }

    /// Whether all bands are exactly 0.
    #[inline]
    pub fn is_black(self) -> bool {
        self == Self::BLACK
    }

    /// `self + t (other - self)` in each band.
    pub fn lerp(self, other: Self, t: f32) -> Self {
        self + (other - self) * t
    }
}

impl From<[f32; 3]> for Rgb {
    fn from([r, g, b]: [f32; 3]) -> Self {
        Self::new(r, g, b)
    }
}

impl From<Rgb> for [f32; 3] {
    fn from(c: Rgb) -> Self {
        c.to_array()
    }
}

impl Index<usize> for Rgb {
    type Output = f32;
    #[inline]
    fn index(&self, band: usize) -> &f32 {
        match band {
            0 => &self.r,
            1 => &self.g,
            2 => &self.b,
            _ => panic!("band {band} of a colour of three bands"),
        }
    }
}

impl IndexMut<usize> for Rgb {
    #[inline]
    fn index_mut(&mut self, band: usize) -> &mut f32 {
        match band {
            0 => &mut self.r,
            1 => &mut self.g,
            2 => &mut self.b,
            _ => panic!("band {band} of a colour of three bands"),
        }
    }
}

macro_rules! band_wise {
    ($($trait:ident $method:ident $assign_trait:ident $assign:ident $op:tt),*) => {$(
        impl $trait for Rgb {
            type Output = Self;
            #[inline]
            fn $method(self, o: Self) -> Self {
                Self::new(self.r $op o.r, self.g $op o.g, self.b $op o.b)
            }
        }
        impl $assign_trait for Rgb {
            #[inline]
            fn $assign(&mut self, o: Self) {
                *self = *self $op o;
            }
        }
    )*};
}
band_wise!(Add add AddAssign add_assign +, Sub sub SubAssign sub_assign -, Mul mul MulAssign mul_assign *);

impl Mul<f32> for Rgb {
    type Output = Self;
    #[inline]
    fn mul(self, k: f32) -> Self {
        self.map(|c| c * k)
    }
}

impl Mul<Rgb> for f32 {
    type Output = Rgb;
    fn mul(self, c: Rgb) -> Rgb {
        c * self
    }
}

impl Div<f32> for Rgb {
    type Output = Self;
    fn div(self, k: f32) -> Self {
        self.map(|c| c / k)
    }
}

impl Neg for Rgb {
    type Output = Self;
    fn neg(self) -> Self {
        self.map(|c| -c)
    }
}

impl core::iter::Sum for Rgb {
    fn sum<I: Iterator<Item = Self>>(colors: I) -> Self {
        colors.fold(Self::BLACK, Add::add)
    }
}

/// Linear value of an sRGB-encoded one in [0, 1] (IEC 61966-2-1).
pub fn linear_from_srgb(encoded: f32) -> f32 {
    if encoded <= 0.04045 {
        encoded / 12.92
    } else {
        ((encoded + 0.055) / 1.055).powf(2.4)
    }
}

/// sRGB encoding of a linear value (IEC 61966-2-1); values outside [0, 1] are clamped, NaN becomes 0.
pub fn srgb_from_linear(linear: f32) -> f32 {
    let linear = if linear.is_nan() {
        0.0
    } else {
        linear.clamp(0.0, 1.0)
    };
    if linear <= 0.003_130_8 {
        linear * 12.92
    } else {
        1.055 * linear.powf(1.0 / 2.4) - 0.055
    }
}

/// The 256 linear values of the 8-bit sRGB codes.
pub fn linear_from_srgb8_table() -> &'static [f32; 256] {
    static TABLE: std::sync::OnceLock<[f32; 256]> = std::sync::OnceLock::new();
    TABLE.get_or_init(|| std::array::from_fn(|code| linear_from_srgb(code as f32 / 255.0)))
}

/// A linear value as an 8-bit sRGB code, rounded to the nearest.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "the value lies in [0.5, 255.5]"
)]
pub fn srgb8_from_linear(linear: f32) -> u8 {
    (srgb_from_linear(linear) * 255.0 + 0.5) as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn srgb_round_trips_every_code() {
        for code in 0..=255_u8 {
            let linear = linear_from_srgb8_table()[code as usize];
            assert_eq!(srgb8_from_linear(linear), code, "code {code}");
        }
    }

    #[test]
    fn half_covered_white_on_black_is_188() {
        assert_eq!(srgb8_from_linear(0.5), 188, "linear 0.5 in sRGB");
    }

    #[test]
    fn nan_and_infinities_encode_to_the_ends() {
        assert_eq!(srgb8_from_linear(f32::NAN), 0, "NaN");
        assert_eq!(srgb8_from_linear(f32::INFINITY), 255, "infinity");
        assert_eq!(srgb8_from_linear(-1.0), 0, "negative");
    }
}
