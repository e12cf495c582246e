//! Lamps without an extent, and the sky.

use crate::error::{CsgError, check_number};
use crate::shapes::{check_point, checked_direction};
use glam::DVec3;
use hemicube_raster::Rgb;

/// A lamp; its shadows are sharp.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Light(Kind);

#[derive(Debug, Clone, Copy, PartialEq)]
enum Kind {
    Point { place: DVec3, intensity: Rgb },
    Distant { towards: DVec3, irradiance: Rgb },
}

/// What a lamp sends to a point.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Arriving {
    /// Unit vector towards the lamp.
    pub towards: DVec3,
    /// How far it is.
    pub distance: f64,
    /// On a surface that faces it.
    pub irradiance: Rgb,
}

/// The brightest lamp that is taken.
const BRIGHTEST: f64 = 1e12;

impl Light {
    /// A small bulb: intensity in light per steradian, so irradiance falls with the square of the distance.
    pub fn point(place: DVec3, intensity: Rgb) -> Result<Self, CsgError> {
        check_point("point light", "place", place)?;
        check_light("point light: intensity", intensity)?;
        Ok(Self(Kind::Point { place, intensity }))
    }

    /// A sun: parallel light from a direction, with its irradiance on a surface that faces it.
    pub fn distant(towards: DVec3, irradiance: Rgb) -> Result<Self, CsgError> {
        let towards = checked_direction("distant light", "direction", towards)?;
        check_light("distant light: irradiance", irradiance)?;
        Ok(Self(Kind::Distant {
            towards,
            irradiance,
        }))
    }

    /// What arrives at a point, if nothing is between.
    pub(crate) fn at(&self, point: DVec3) -> Arriving {
        match self.0 {
            Kind::Point { place, intensity } => {
                let way = place - point;
                let distance = way.length();
                let falloff = 1.0 / (distance * distance).max(1e-12);
                Arriving {
                    towards: way.normalize_or_zero(),
                    distance,
                    irradiance: intensity * narrow(falloff),
                }
            }
            Kind::Distant {
                towards,
                irradiance,
            } => Arriving {
                towards,
                distance: f64::INFINITY,
                irradiance,
            },
        }
    }
}

/// Radiance of what is behind everything, by height; it is also the even light that reaches everywhere without
/// shadows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sky {
    zenith: Rgb,
    horizon: Rgb,
    ground: Rgb,
}

impl Sky {
    /// From the zenith over the horizon to the ground.
    pub fn new(zenith: Rgb, horizon: Rgb, ground: Rgb) -> Result<Self, CsgError> {
        for color in [zenith, horizon, ground] {
            check_light("sky: radiance", color)?;
        }
        Ok(Self {
            zenith,
            horizon,
            ground,
        })
    }

    /// The same in all directions.
    pub fn even(radiance: Rgb) -> Result<Self, CsgError> {
        Self::new(radiance, radiance, radiance)
    }

    /// Radiance from a direction, a unit vector.
    pub(crate) fn radiance(&self, direction: DVec3) -> Rgb {
        let height = narrow(direction.y);
        let end = if height > 0.0 {
            self.zenith
        } else {
            self.ground
        };
        self.horizon.lerp(end, height.abs().min(1.0).sqrt())
    }
}

fn check_light(what: &'static str, light: Rgb) -> Result<(), CsgError> {
    light
        .to_array()
        .into_iter()
        .try_for_each(|band| check_number(what, band.into(), 0.0, BRIGHTEST))
}

#[expect(clippy::cast_possible_truncation, reason = "rounds to the nearest f32")]
fn narrow(value: f64) -> f32 {
    value as f32
}
