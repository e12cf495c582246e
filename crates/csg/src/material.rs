//! What surfaces do to light.

use crate::error::{CsgError, check_number, check_share};
use crate::noise::noise_gradient;
use crate::pattern::{Pattern, check_color};
use glam::DVec3;
use hemicube_raster::Rgb;
use hemicube_raster::reflection::BlinnPhong;

/// A surface: a diffuse ground with a pattern, highlights of the lamps, and a coat that mirrors.
///
/// The three share the light, so no surface returns more than it receives. The coat mirrors the fraction `F(θ) = m +
/// (1 - m) (1 - cos θ)⁵` (Schlick, *An inexpensive BRDF model for physically-based rendering*, 1994), without a coat F
/// is 0. Of the rest, the share s goes into highlights and `1 - s` reaches the pattern.
#[derive(Debug, Clone, PartialEq)]
pub struct Material {
    pattern: Pattern,
    highlight: f32,
    exponent: f32,
    coat: Option<Rgb>,
    bump: Option<Bump>,
}

/// Noise that bends the normal.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Bump {
    /// Height of the noise.
    height: f64,
    /// Distance of its hills.
    size: f64,
}

impl Material {
    /// A matte surface.
    pub fn matte(pattern: Pattern) -> Self {
        Self {
            pattern,
            highlight: 0.0,
            exponent: 1.0,
            coat: None,
            bump: None,
        }
    }

    /// With highlights of the lamps: their share of the light and how sharp they are, an exponent from 1 to 1e5.
    pub fn with_highlight(mut self, share: f32, exponent: f32) -> Result<Self, CsgError> {
        check_share("highlight: share", share)?;
        check_number("highlight: exponent", exponent.into(), 1.0, 1e5)?;
        self.highlight = share;
        self.exponent = exponent;
        Ok(self)
    }

    /// With a coat that mirrors this fraction of the light that falls at right angles, and more towards grazing: 0.04
    /// is varnish or glaze, 0.9 polished metal.
    pub fn with_coat(mut self, reflectance: Rgb) -> Result<Self, CsgError> {
        check_color(reflectance)?;
        self.coat = Some(reflectance);
        Ok(self)
    }

    /// With hills of noise of a height, about `size` apart; they bend the normal and leave the shape as it is.
    pub fn with_bumps(mut self, height: f64, size: f64) -> Result<Self, CsgError> {
        check_number("bumps: height", height, 0.0, crate::LARGEST)?;
        check_number("bumps: size", size, crate::SMALLEST, crate::LARGEST)?;
        self.bump = Some(Bump { height, size });
        Ok(self)
    }

    /// Diffuse colour at a point.
    pub(crate) fn color(&self, p: DVec3) -> Rgb {
        self.pattern.color(p)
    }

    /// The gradient of the height of the bumps.
    pub(crate) fn bump_gradient(&self, p: DVec3) -> Option<DVec3> {
        let Bump { height, size } = self.bump?;
        Some(noise_gradient(p / size) * (height / size))
    }

    /// The fraction that the coat mirrors at an angle from the normal.
    pub(crate) fn mirrored(&self, cosine: f64) -> Rgb {
        let Some(straight) = self.coat else {
            return Rgb::BLACK;
        };
        let grazing = narrow((1.0 - cosine.clamp(0.0, 1.0)).powi(5));
        straight.lerp(Rgb::WHITE, grazing)
    }

    /// What of the light of a lamp below the coat goes to the eye, diffuse and in highlights: the BRDF, 1/sr.
    ///
    /// Highlights are those of [`BlinnPhong`], normalised; the power is taken in f64, for exponents of many thousands.
    pub(crate) fn brdf(&self, diffuse: Rgb, half_cosine: f64) -> Rgb {
        let ground = diffuse * ((1.0 - self.highlight) / core::f32::consts::PI);
        if self.highlight == 0.0 {
            return ground;
        }
        let model = BlinnPhong::new(self.exponent);
        let lobe = narrow(half_cosine.max(0.0).powf(self.exponent.into()));
        ground + Rgb::splat(self.highlight * model.normalization() * lobe)
    }

    /// What of even light from everywhere goes to the eye below the coat.
    pub(crate) fn albedo(&self, diffuse: Rgb) -> Rgb {
        diffuse * (1.0 - self.highlight) + Rgb::splat(self.highlight)
    }
}

#[expect(clippy::cast_possible_truncation, reason = "rounds to the nearest f32")]
fn narrow(value: f64) -> f32 {
    value as f32
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::f64::consts::{FRAC_PI_2, TAU};

    fn shiny(exponent: f32) -> Material {
        let white = Pattern::plain(Rgb::WHITE).expect("white is a colour");
        Material::matte(white)
            .with_highlight(0.7, exponent)
            .expect("a share and an exponent")
    }

    /// Directional albedo at an angle from the normal, by the midpoint rule.
    fn reflected(material: &Material, tilt: f64) -> f64 {
        let (rows, columns) = (1200, 240);
        let eye = DVec3::new(tilt.sin(), tilt.cos(), 0.0);
        let mut sum = 0.0;
        for i in 0..rows {
            let theta = (f64::from(i) + 0.5) / f64::from(rows) * FRAC_PI_2;
            for j in 0..columns {
                let phi = (f64::from(j) + 0.5) / f64::from(columns) * TAU;
                let (s, c) = theta.sin_cos();
                let light = DVec3::new(s * phi.cos(), c, s * phi.sin());
                let half = (light + eye).normalize();
                sum += f64::from(material.brdf(Rgb::WHITE, half.y).r) * c * s;
            }
        }
        sum * FRAC_PI_2 / f64::from(rows) * TAU / f64::from(columns)
    }

    #[test]
    fn highlights_return_what_they_receive_and_never_more() {
        for exponent in [1.0, 10.0, 200.0] {
            let material = shiny(exponent);
            let straight = reflected(&material, 0.0);
            assert!(
                (straight - 1.0).abs() < 1e-3,
                "exponent {exponent}: {straight} at right angles"
            );
            for tilt in [0.3, 0.8, 1.2, 1.5] {
                let share = reflected(&material, tilt);
                assert!(share < 1.001, "exponent {exponent}, {tilt} rad: {share}");
            }
        }
    }

    #[test]
    fn coats_mirror_everything_at_grazing_angles() {
        let glazed = shiny(10.0).with_coat(Rgb::splat(0.04)).expect("a share");
        assert!(
            (glazed.mirrored(1.0).g - 0.04).abs() < 1e-7,
            "at right angles"
        );
        assert!((glazed.mirrored(0.0).g - 1.0).abs() < 1e-7, "grazing");
        assert_eq!(shiny(10.0).mirrored(0.2), Rgb::BLACK, "no coat");
    }

    #[test]
    fn what_cannot_be_is_refused_in_one_line() {
        let matte = || shiny(10.0);
        let errors = [
            matte()
                .with_highlight(1.1, 10.0)
                .expect_err("too much light"),
            matte()
                .with_highlight(0.5, f32::NAN)
                .expect_err("no number"),
            matte()
                .with_coat(Rgb::new(0.1, -0.1, 0.0))
                .expect_err("a negative share"),
            matte().with_bumps(0.1, 0.0).expect_err("no size"),
        ];
        for error in errors {
            let line = error.to_string();
            assert!(!line.contains('\n') && line.contains("give"), "{line}");
        }
    }
}
