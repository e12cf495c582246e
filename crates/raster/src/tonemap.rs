//! From scene light to what a display can show: exposure and tone curve.
//!
//! Both work on linear Rec. 709 light; the sRGB encoding comes after them, when a file is written.

use crate::color::Rgb;
use core::fmt;
use core::str::FromStr;

/// Exposed luminance that [`ToneMap::Reinhard`] and [`ToneMap::Aces`] show as middle grey, 0.18 of the display's white:
/// `0.18 / (1 - 0.18)`, rounded.
const MIDDLE_GREY: f32 = 0.22;

/// Exposed luminance that [`ToneMap::Reinhard`] shows as white: 4.2 stops above middle grey.
const WHITE_POINT: f32 = 4.0;

/// A tone curve.
///
/// Each curve is applied to the luminance L, and the colour is scaled along: `C' = C L' / L`, so hue and saturation
/// stay. A band that then is above 1 would be clipped and turn the hue (an orange lamp yellow); instead the colour is
/// mixed with the grey of its own luminance, just as much as needed. Very bright lights so go to white along
/// a line of constant hue and luminance.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum ToneMap {
    /// `L' = L (1 + L / Lw²) / (1 + L)` with white point Lw = 4. From Reinhard et al., *Photographic tone reproduction
    /// for digital images* (SIGGRAPH 2002), equation 4.
    #[default]
    Reinhard,
    /// `L' = x (2.51 x + 0.03) / (x (2.43 x + 0.59) + 0.14)` with `x = 0.6 L`: the fit of Narkowicz, *ACES filmic tone
    /// mapping curve* (2015), with the factor 0.6 he names for the exposure of the ACES original. More contrast.
    Aces,
    /// `L' = L` up to 1: colours that the display can show stay as they are, brighter ones are cut at its luminance.
    None,
}

impl ToneMap {
    /// All tone curves, in the order of the documentation.
    pub const ALL: [Self; 3] = [Self::Reinhard, Self::Aces, Self::None];

    /// Name in options and reports.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Reinhard => "reinhard",
            Self::Aces => "aces",
            Self::None => "none",
        }
    }

    /// What the display shows of `exposure * color`, linear, each band in [0, 1].
    ///
    /// Bands that are NaN or negative count as 0, so does everything with an exposure of NaN; infinite ones are white.
    pub fn apply(self, color: Rgb, exposure: f32) -> Rgb {
        // Up to 1e18 the square of a luminance stays finite, and all curves are white long before.
        let exposed = (color * exposure).map(|band| if band > 0.0 { band.min(1e18) } else { 0.0 });
        let luminance = exposed.luminance();
        if luminance <= 0.0 {
            return Rgb::BLACK;
        }
        let shown = self.curve(luminance);
        fit_into_display(exposed * (shown / luminance), shown)
    }

    /// The displayed luminance of an exposed one, in [0, 1].
    fn curve(self, luminance: f32) -> f32 {
        let shown = match self {
            Self::Reinhard => {
                luminance * (1.0 + luminance / (WHITE_POINT * WHITE_POINT)) / (1.0 + luminance)
            }
            Self::Aces => {
                let x = 0.6 * luminance;
                x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14)
            }
            Self::None => luminance,
        };
        shown.min(1.0)
    }
}

/// Mixes a colour of luminance `luminance` in [0, 1] with grey until its largest band is at most 1.
fn fit_into_display(color: Rgb, luminance: f32) -> Rgb {
    let largest = color.max_band();
    let fitting = if largest > 1.0 {
        let saturation = (1.0 - luminance) / (largest - luminance);
        Rgb::splat(luminance).lerp(color, saturation)
    } else {
        color
    };
    fitting.map(|band| band.clamp(0.0, 1.0))
}

impl fmt::Display for ToneMap {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

impl FromStr for ToneMap {
    type Err = ParseToneError;

    fn from_str(name: &str) -> Result<Self, ParseToneError> {
        Self::ALL
            .into_iter()
            .find(|tone_map| tone_map.name() == name)
            .ok_or_else(|| ParseToneError::ToneMap(name.to_owned()))
    }
}

/// How much light reaches the picture.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Exposure {
    /// From the picture itself, see [`automatic_exposure`].
    #[default]
    Auto,
    /// A number of stops: light is multiplied by `2^EV`, so 0 leaves it and 1 doubles it.
    Ev(f32),
}

impl Exposure {
    /// The most stops up or down that [`FromStr`] takes and [`Self::factor`] applies.
    pub const MAX_STOPS: f32 = 64.0;

    /// The factor for light; `luminances` are the picture's and only looked at by [`Exposure::Auto`].
    /// NaN stops count as 0.
    pub fn factor(self, luminances: impl IntoIterator<Item = f32>) -> f32 {
        match self {
            Self::Auto => automatic_exposure(luminances),
            Self::Ev(stops) if stops.is_nan() => 1.0,
            Self::Ev(stops) => stops.clamp(-Self::MAX_STOPS, Self::MAX_STOPS).exp2(),
        }
    }
}

impl fmt::Display for Exposure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Auto => f.pad("auto"),
            Self::Ev(stops) => stops.fmt(f),
        }
    }
}

impl FromStr for Exposure {
    type Err = ParseToneError;

    fn from_str(text: &str) -> Result<Self, ParseToneError> {
        if text == "auto" {
            return Ok(Self::Auto);
        }
        text.parse()
            .ok()
            .filter(|stops: &f32| stops.abs() <= Self::MAX_STOPS)
            .map(Self::Ev)
            .ok_or_else(|| ParseToneError::Exposure(text.to_owned()))
    }
}

/// A tone curve or an exposure could not be understood.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ParseToneError {
    /// Not the name of a tone curve.
    #[error("tone map '{0}' is not known; use reinhard, aces or none")]
    ToneMap(String),
    /// Neither "auto" nor a number of stops.
    #[error("exposure '{0}' is neither 'auto' nor a number of stops from -64 to 64")]
    Exposure(String),
}

/// The exposure factor that shows a picture of these luminances well.
///
/// Without the brightest and the darkest 5 % of the positive finite luminances (lamps; seams and leaks), their
/// geometric mean, the *log-average* of Reinhard et al. 2002, comes out as middle grey: 0.18 of the display's white with
/// [`ToneMap::Reinhard`] and [`ToneMap::Aces`]. A picture that is mostly dark is not raised so far that the rest of
/// it, up to the brightest 5 %, would be white: those stay at or below the white point.
///
/// Black pixels do not count (background). Returns 1 if nothing is left. The order of the luminances does not matter
/// and the result is always positive and finite.
pub fn automatic_exposure(luminances: impl IntoIterator<Item = f32>) -> f32 {
    let mut sorted: Vec<f32> = luminances
        .into_iter()
        .filter(|l| l.is_finite() && *l > 0.0)
        .collect();
    sorted.sort_unstable_by(f32::total_cmp);
    let left_out = sorted.len() / 20;
    let kept = &sorted[left_out..sorted.len() - left_out];
    let Some(&brightest) = kept.last() else {
        return 1.0;
    };
    // Ten stops below the brightest is black to the eye, how black is of no interest to the mean.
    let floor = f64::from(brightest) / 1024.0;
    let sum: f64 = kept.iter().map(|&l| f64::from(l).max(floor).ln()).sum();
    let log_average = (sum / kept.len() as f64).exp();
    let factor = f64::min(
        f64::from(MIDDLE_GREY) / log_average,
        f64::from(WHITE_POINT) / f64::from(brightest),
    );
    narrow(factor.clamp(1e-30, 1e30))
}

#[expect(
    clippy::cast_possible_truncation,
    reason = "between 1e-30 and 1e30, rounded to the nearest f32"
)]
fn narrow(factor: f64) -> f32 {
    factor as f32
}
