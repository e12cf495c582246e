//! Level of detail: how large a pixel is on a texture, and which mip level fits it.

use glam::{DVec2, Vec2};

/// How logarithms of scale are taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Log2 {
    /// As they are.
    #[default]
    Exact,
    /// `log2(2^e (1 + m)) ~ e + m`, as the software rasteriser of Mesa has it: too low by 0.029 levels on average and by
    /// up to 0.043. With it pictures can be compared with those of a GPU that is simulated.
    Fast,
}

impl Log2 {
    /// `log2 |rho|` of a scale from its square; minus infinity for 0, NaN and what is too small for normal numbers.
    #[inline]
    #[expect(clippy::cast_precision_loss, reason = "an exponent")]
    pub fn half_log2(self, square: f32) -> f32 {
        if square.is_nan() || square < f32::MIN_POSITIVE {
            return f32::NEG_INFINITY;
        }
        match self {
            Self::Exact => 0.5 * square.log2(),
            Self::Fast => {
                let bits = square.to_bits();
                let exponent = (bits >> 23).cast_signed() - 127;
                let mantissa = f32::from_bits((bits & 0x007f_ffff) | 0x3f80_0000) - 1.0;
                0.5 * (exponent as f32 + mantissa)
            }
        }
    }
}

/// The parallelogram on a texture, in texels of its largest level, that one pixel covers: derivatives of the position
/// along the columns and rows of the screen.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Footprint {
    /// Change from a pixel to its right neighbour.
    pub dx: Vec2,
    /// Change from a pixel to the one below.
    pub dy: Vec2,
}

/// What anisotropic filtering reads (Vulkan specification, "Scale Factor Operation, LOD Operation and Image Level(s)
/// Selection").
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AnisotropicLod {
    /// How much longer than wide the footprint counts as, from 1 to the sampler's limit.
    pub ratio: f32,
    /// Number of samples along it: the ratio rounded up.
    pub samples: u16,
    /// Level of detail of each sample, before bias and limits.
    pub lod: f32,
    /// The longer side of the footprint.
    pub along: Vec2,
}

impl Footprint {
    /// The footprint of derivatives of texture coordinates on a texture of `size` texels.
    #[inline]
    #[expect(clippy::cast_precision_loss, reason = "a side has at most 17 bits")]
    pub fn new(ddx: Vec2, ddy: Vec2, (width, height): (usize, usize)) -> Self {
        let size = Vec2::new(width as f32, height as f32);
        Self {
            dx: ddx * size,
            dy: ddy * size,
        }
    }

    /// Whether all numbers are finite, also when squared.
    #[inline]
    pub fn is_finite(&self) -> bool {
        (self.dx.length_squared() + self.dy.length_squared()).is_finite()
    }

    /// `log2 max(rho_x, rho_y)`, where rho are the lengths of the two derivatives: 0 for pixels as large as texels,
    /// minus infinity for none at all.
    #[inline]
    pub fn lod(&self, log2: Log2) -> f32 {
        log2.half_log2(self.dx.length_squared().max(self.dy.length_squared()))
    }

    /// Samples along the longer derivative, after Vulkan: `eta = min(rho_max / rho_min, max_anisotropy)`, `N = ceil(eta)`,
    /// `lambda = log2(rho_max / eta)`. Without extent the ratio is 1, with extent in one direction only it is the limit.
    pub fn anisotropic_lod(&self, max_anisotropy: f32, log2: Log2) -> AnisotropicLod {
        let (square_x, square_y) = (self.dx.length_squared(), self.dy.length_squared());
        let (along, largest, smallest) = if square_x > square_y {
            (self.dx, square_x, square_y)
        } else {
            (self.dy, square_y, square_x)
        };
        let ratio = if largest == 0.0 {
            1.0
        } else {
            (largest / smallest).sqrt().min(max_anisotropy)
        };
        AnisotropicLod {
            ratio,
            samples: samples(ratio),
            lod: log2.half_log2(largest / (ratio * ratio)),
            along,
        }
    }

    /// Samples along the longer derivative, after Direct3D 11.3 (7.18.11): the ratio is that of the longer side's square
    /// to the *area*, which is right for sheared footprints too; footprints narrower than a texel take fewer samples.
    pub fn d3d_anisotropic_lod(&self, max_anisotropy: f32, log2: Log2) -> AnisotropicLod {
        let area = self.dx.perp_dot(self.dy).abs();
        let (x, y) = (self.dx.length(), self.dy.length());
        let (along, major) = if x > y { (self.dx, x) } else { (self.dy, y) };
        let mut ratio = if major == 0.0 {
            1.0
        } else {
            major * major / area
        };
        let minor = if ratio > max_anisotropy {
            ratio = max_anisotropy;
            major / ratio
        } else if major == 0.0 {
            0.0
        } else {
            area / major
        };
        if minor < 1.0 {
            ratio = (ratio * minor).max(1.0);
        }
        AnisotropicLod {
            ratio,
            samples: samples(ratio),
            lod: log2.half_log2(minor * minor),
            along,
        }
    }

    /// The axes of the ellipse that the parallelogram's circle becomes (Heckbert 1989, as in Direct3D 11.3, 7.18.10):
    /// perpendicular derivatives of the same footprint, the longer one first.
    ///
    /// They are the singular vectors of the derivatives' matrix times its singular values; the longer of two derivatives
    /// as such is too short by up to a factor of the square root of 2. A footprint that is not finite stays as it is.
    pub fn axes(&self) -> Self {
        if !self.is_finite() {
            return *self;
        }
        let (dx, dy) = (self.dx.as_dvec2(), self.dy.as_dvec2());
        // J J^T = [a b; b c] has the squares of the axes as eigenvalues, mean +- radius.
        let (a, b, c) = (
            dx.x * dx.x + dy.x * dy.x,
            dx.x * dx.y + dy.x * dy.y,
            dx.y * dx.y + dy.y * dy.y,
        );
        let (mean, radius) = (0.5 * (a + c), (0.5 * (a - c)).hypot(b));
        let direction = if radius == 0.0 {
            DVec2::X
        } else if a >= c {
            DVec2::new(0.5 * (a - c) + radius, b).normalize()
        } else {
            DVec2::new(b, 0.5 * (c - a) + radius).normalize()
        };
        let major = (mean + radius).sqrt();
        // The product of the axes is the area; their difference would cancel.
        let minor = if major > 0.0 {
            dx.perp_dot(dy).abs() / major
        } else {
            0.0
        };
        Self {
            dx: (direction * major).as_vec2(),
            dy: (direction.perp() * minor).as_vec2(),
        }
    }
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "casts saturate"
)]
fn samples(ratio: f32) -> u16 {
    ratio.ceil().max(1.0) as u16
}

/// The level nearest to a level of detail that lies between 0 and the last level: `ceil(d + 1/2) - 1`, so halves are
/// rounded down (the rule that Vulkan prefers).
#[inline]
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "at most some levels; NaN casts to 0"
)]
pub fn nearest_level(lod: f32) -> usize {
    ((lod + 0.5).ceil() - 1.0) as usize
}

/// The two levels around a level of detail that lies between 0 and `last`, and the weight of the second.
#[inline]
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "at most some levels; NaN casts to 0"
)]
pub(super) fn linear_levels(lod: f32, last: usize) -> (usize, usize, f32) {
    let upper = (lod.floor() as usize).min(last);
    (upper, (upper + 1).min(last), lod - lod.floor())
}
