//! Procedural textures: colours that are functions of the place in the solid. What is carved shows its grain.

use crate::error::{CsgError, check_number, check_share};
use crate::noise::turbulence;
use glam::DVec3;
use hemicube_raster::Rgb;

/// The diffuse colour of a solid at each of its points, in the place where the material was given to it.
#[derive(Debug, Clone, PartialEq)]
pub struct Pattern(Kind);

#[derive(Debug, Clone, PartialEq)]
enum Kind {
    Plain(Rgb),
    Checker {
        cell: f64,
        parts: Box<[Pattern; 2]>,
    },
    Stripes {
        /// A full period in the direction across, as `1 / period`.
        across: DVec3,
        parts: Box<[Pattern; 2]>,
    },
    Wood {
        colors: [Rgb; 2],
        ring: f64,
    },
    Marble {
        colors: [Rgb; 2],
        vein: f64,
    },
    Speckles {
        colors: [Rgb; 2],
        size: f64,
        share: f64,
    },
    Gradient {
        colors: [Rgb; 2],
        from: DVec3,
        along: DVec3,
    },
}

const SIZES: [f64; 2] = [crate::SMALLEST, crate::LARGEST];

impl Pattern {
    /// The same colour everywhere.
    pub fn plain(color: Rgb) -> Result<Self, CsgError> {
        check_color(color)?;
        Ok(Self(Kind::Plain(color)))
    }

    /// Cubes with sides of length `cell`, in turns of one pattern and the other in all three directions. The origin
    /// lies in the middle of an edge along y, so that a floor at y = 0 goes through the middle of cubes and not along
    /// their faces.
    pub fn checker(cell: f64, even: Self, odd: Self) -> Result<Self, CsgError> {
        check_size("checker: cell", cell)?;
        let parts = Box::new([even, odd]);
        Ok(Self(Kind::Checker { cell, parts }))
    }

    /// Layers at right angles to `across`, whose length is that of a period: half of it one pattern, half the other.
    pub fn stripes(across: DVec3, even: Self, odd: Self) -> Result<Self, CsgError> {
        check_size("stripes: period", across.length())?;
        let across = across / across.length_squared();
        let parts = Box::new([even, odd]);
        Ok(Self(Kind::Stripes { across, parts }))
    }

    /// Rings of early and late wood around the x axis, `ring` apart, bent by noise and with fibres along the axis.
    pub fn wood(early: Rgb, late: Rgb, ring: f64) -> Result<Self, CsgError> {
        check_size("wood: ring", ring)?;
        let colors = checked_colors([early, late])?;
        Ok(Self(Kind::Wood { colors, ring }))
    }

    /// Veins through a ground, about `vein` apart.
    pub fn marble(ground: Rgb, veins: Rgb, vein: f64) -> Result<Self, CsgError> {
        check_size("marble: vein", vein)?;
        let colors = checked_colors([ground, veins])?;
        Ok(Self(Kind::Marble { colors, vein }))
    }

    /// Soft spots of about `size` on a ground, on a share of it.
    pub fn speckles(ground: Rgb, spots: Rgb, size: f64, share: f64) -> Result<Self, CsgError> {
        check_size("speckles: size", size)?;
        check_number("speckles: share", share, 0.0, 1.0)?;
        let colors = checked_colors([ground, spots])?;
        Ok(Self(Kind::Speckles {
            colors,
            size,
            share,
        }))
    }

    /// From one colour at a point to another at the next, smoothly; beyond both it stays.
    pub fn gradient(from: DVec3, first: Rgb, to: DVec3, second: Rgb) -> Result<Self, CsgError> {
        let along = to - from;
        check_size("gradient: length", along.length())?;
        let colors = checked_colors([first, second])?;
        let along = along / along.length_squared();
        Ok(Self(Kind::Gradient {
            colors,
            from,
            along,
        }))
    }

    /// The colour at a point.
    pub fn color(&self, p: DVec3) -> Rgb {
        match &self.0 {
            Kind::Plain(color) => *color,
            Kind::Checker { cell, parts } => {
                let cells = (p / *cell + DVec3::new(0.0, 0.5, 0.0)).floor();
                parts[parity(cells.element_sum())].color(p)
            }
            Kind::Stripes { across, parts } => {
                parts[parity((2.0 * p.dot(*across)).floor())].color(p)
            }
            Kind::Wood { colors, ring } => wood(*colors, p / *ring),
            Kind::Marble { colors, vein } => marble(*colors, p / *vein),
            Kind::Speckles {
                colors,
                size,
                share,
            } => {
                // Noise is above 0.7 (1 - 2 share) on about that share of space.
                let above = turbulence(p / *size, 3) - 0.7 * (1.0 - 2.0 * share);
                mix(*colors, smooth(0.5 + 4.0 * above))
            }
            Kind::Gradient {
                colors,
                from,
                along,
            } => mix(*colors, smooth((p - *from).dot(*along))),
        }
    }
}

/// 0 for even whole numbers, 1 for odd ones.
fn parity(whole: f64) -> usize {
    usize::from(whole.rem_euclid(2.0) >= 1.0)
}

/// From 0 to 1 with slope 0 at both ends.
fn smooth(t: f64) -> f64 {
    let t = t.clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

fn mix([a, b]: [Rgb; 2], t: f64) -> Rgb {
    #[expect(clippy::cast_possible_truncation, reason = "a share")]
    let t = t.clamp(0.0, 1.0) as f32;
    a.lerp(b, t)
}

/// Late wood darkens slowly over the year and ends at once.
fn wood(colors: [Rgb; 2], p: DVec3) -> Rgb {
    let bend = 0.45 * turbulence(p * DVec3::new(0.06, 0.3, 0.3), 2);
    let year = (p.y.hypot(p.z) + bend).rem_euclid(1.0);
    let late = smooth(year / 0.85) * (1.0 - smooth((year - 0.85) / 0.15));
    let fibres = 0.2 * turbulence(p * DVec3::new(0.25, 9.0, 9.0), 2);
    mix(colors, 0.15 + 0.65 * late + fibres)
}

fn marble(colors: [Rgb; 2], p: DVec3) -> Rgb {
    let wave = (core::f64::consts::TAU * (p.x + 0.5 * p.y + 1.4 * turbulence(p * 0.6, 5))).sin();
    mix(colors, (1.0 - wave.abs()).powi(3))
}

pub(crate) fn check_color(color: Rgb) -> Result<(), CsgError> {
    ["red", "green", "blue"]
        .into_iter()
        .zip(color.to_array())
        .try_for_each(|(what, value)| check_share(what, value))
}

fn checked_colors(colors: [Rgb; 2]) -> Result<[Rgb; 2], CsgError> {
    colors.into_iter().try_for_each(check_color)?;
    Ok(colors)
}

fn check_size(what: &'static str, value: f64) -> Result<(), CsgError> {
    check_number(what, value, SIZES[0], SIZES[1])
}
