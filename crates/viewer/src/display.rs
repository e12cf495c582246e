//! What the picture shows, and how.

use hemicube_raster::tonemap::{Exposure, ToneMap, automatic_exposure};
use serde::{Deserialize, Serialize};

/// What surfaces show.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum Quantity {
    /// The picture: light as a camera sees it.
    #[default]
    Light,
    /// Illuminance in false colours.
    Illuminance,
    /// Form factors from the selected patch, in false colours on a logarithmic scale.
    FormFactors,
    /// Lines only.
    Wireframe,
}

impl Quantity {
    /// All of them.
    pub const ALL: [Self; 4] = [
        Self::Light,
        Self::Illuminance,
        Self::FormFactors,
        Self::Wireframe,
    ];

    /// As the panel shows it.
    pub fn label(self) -> &'static str {
        match self {
            Self::Light => "Light",
            Self::Illuminance => "Illuminance",
            Self::FormFactors => "Form factors",
            Self::Wireframe => "Wireframe",
        }
    }
}

/// What the picture shows, and how.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Display {
    /// What surfaces show. Default value: light.
    pub quantity: Quantity,
    /// Whether elements are flat instead of smooth. Default value: no.
    pub flat: bool,
    /// Whether textures are shown. Default value: yes.
    pub textures: bool,
    /// Whether reliefs are shown. Default value: yes.
    pub bumps: bool,
    /// Whether metals reflect their surroundings. Default value: no.
    pub reflections: bool,
    /// Whether the edges of elements are drawn over the picture. Default value: no.
    pub mesh: bool,
    /// Whether the estimate of the light to come is added where the solver has one. Default value: yes.
    pub ambient: bool,
    /// Whether edges are smooth. Default value: yes.
    pub smooth_edges: bool,
    /// Whether there are fewer pixels while the eye moves, where the processor draws and is late. Default value: yes.
    pub coarse_motion: bool,
    /// Whether exposure follows the light. Default value: yes.
    pub auto_exposure: bool,
    /// Exposure in stops; with automatic exposure a correction of it. Default value: 0.
    pub stops: f32,
    /// Position of the tone curve in [`ToneMap::ALL`].
    tone_map: usize,
    /// Whether lines of equal illuminance are drawn. Default value: yes.
    pub isolines: bool,
    /// Top of the scale of false colours in lx; 0 takes it from the light. Default value: 0.
    pub scale_top: f32,
}

impl Default for Display {
    fn default() -> Self {
        Self {
            quantity: Quantity::Light,
            flat: false,
            textures: true,
            bumps: true,
            reflections: false,
            mesh: false,
            ambient: true,
            smooth_edges: true,
            coarse_motion: true,
            auto_exposure: true,
            stops: 0.0,
            tone_map: 0,
            isolines: true,
            scale_top: 0.0,
        }
    }
}

/// Most stops that the slider goes up or down.
pub const MOST_STOPS: f32 = 16.0;

impl Display {
    /// The tone curve. Default value: Reinhard.
    pub fn tone_map(&self) -> ToneMap {
        ToneMap::ALL.get(self.tone_map).copied().unwrap_or_default()
    }

    /// Another tone curve.
    pub fn set_tone_map(&mut self, tone_map: ToneMap) {
        let place = ToneMap::ALL.iter().position(|&other| other == tone_map);
        self.tone_map = place.unwrap_or(0);
    }

    /// The factor for light of which these are luminances.
    pub fn exposure(&self, luminances: impl IntoIterator<Item = f32>) -> f32 {
        let stops = Exposure::Ev(self.stops).factor([]);
        if self.auto_exposure {
            stops * automatic_exposure(luminances)
        } else {
            stops
        }
    }

    /// Top of the scale of false colours: as asked, or the next round number above nearly all of the values.
    pub fn scale_top(&self, values: impl Iterator<Item = f32>) -> f32 {
        if self.scale_top > 0.0 {
            return self.scale_top;
        }
        let mut sorted: Vec<f32> = values.filter(|x| x.is_finite() && *x > 0.0).collect();
        sorted.sort_unstable_by(f32::total_cmp);
        let nearly_all = sorted.len().saturating_sub(1 + sorted.len() / 50);
        round_up(sorted.get(nearly_all).copied().unwrap_or(1.0))
    }
}

/// The next number of 1, 2, 5, 10, 20 and so on.
pub fn round_up(x: f32) -> f32 {
    let power = 10_f32.powf(x.max(1e-30).log10().floor());
    let steps = [1.0, 2.0, 5.0, 10.0];
    let fits = steps.into_iter().find(|step| step * power >= x * 0.9999);
    fits.unwrap_or(10.0) * power
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scales_end_on_round_numbers() {
        for (x, top) in [
            (3.0, 5.0),
            (100.0, 100.0),
            (101.0, 200.0),
            (740.0, 1000.0),
            (0.03, 0.05),
        ] {
            assert!(
                (round_up(x) / top - 1.0).abs() < 1e-4,
                "{x}: {}",
                round_up(x)
            );
        }
        let display = Display::default();
        let values = (0..1000_u16).map(f32::from).chain([1e9]);
        assert_eq!(
            display.scale_top(values),
            1000.0,
            "one lamp does not stretch it"
        );
        assert_eq!(display.scale_top(core::iter::empty()), 1.0, "of nothing");
    }

    #[test]
    fn stops_correct_the_automatic_exposure() {
        let mut display = Display::default();
        let auto = display.exposure([0.5, 1.0, 2.0]);
        display.stops = 1.0;
        assert_eq!(
            display.exposure([0.5, 1.0, 2.0]),
            2.0 * auto,
            "twice as bright"
        );
        display.auto_exposure = false;
        assert_eq!(display.exposure([0.5]), 2.0, "whatever the light is");
    }

    #[test]
    fn damaged_values_mean_the_usual_ones() {
        let display: Display =
            serde_json::from_str(r#"{"tone_map": 12}"#).expect("fields may be missing");
        assert_eq!(display.tone_map(), ToneMap::default(), "out of range");
        assert!(display.textures, "missing");
    }
}
