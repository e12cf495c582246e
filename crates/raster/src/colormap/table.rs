//! Tables of colours, computed in Oklab.

use super::Oklab;
use crate::{Image, Rgb};

/// Colours from 0 to 1, a texture of one dimension with linear interpolation.
///
/// The tables are curves through a few colours in Oklab, walked at constant speed: equal steps of the value look
/// equally large wherever they are (within 3 % of their mean), so no edge is seen that the data do not have.
#[derive(Debug, Clone, PartialEq)]
pub struct Colormap {
    entries: Vec<Rgb>,
}

/// Steps of a table; even, so that the middle is a colour of its own.
const STEPS: usize = 256;

impl Colormap {
    /// From dark blue over green to light yellow; lightness rises all along, so it reads in grey too.
    pub fn sequential() -> Self {
        Self::through(&[
            Oklab::from_hue(0.18, 0.085, 300.0),
            Oklab::from_hue(0.33, 0.115, 262.0),
            Oklab::from_hue(0.49, 0.080, 220.0),
            Oklab::from_hue(0.64, 0.100, 178.0),
            Oklab::from_hue(0.79, 0.155, 142.0),
            Oklab::from_hue(0.95, 0.150, 106.0),
        ])
    }

    /// The same colours the other way round.
    #[must_use]
    pub fn reversed(mut self) -> Self {
        self.entries.reverse();
        self
    }

    /// From blue over a light grey in the middle to red; both halves are equally dark at equal distances from the
    /// middle.
    pub fn diverging() -> Self {
        let half = |hue: f32| {
            Self::through(&[
                Oklab::from_hue(0.36, 0.115, hue),
                Oklab::from_hue(0.56, 0.170, hue),
                Oklab::from_hue(0.78, 0.095, hue),
                Oklab::from_hue(0.95, 0.0, hue),
            ])
        };
        let (cold, mut warm) = (half(258.0).entries, half(27.0).entries);
        warm.reverse();
        // Every second of each, and the middle once.
        let entries = cold.iter().step_by(2).chain(warm.iter().step_by(2).skip(1));
        Self {
            entries: entries.copied().collect(),
        }
    }

    /// From black to white in equal steps of lightness.
    pub fn grey() -> Self {
        Self::through(&[
            Oklab::from_hue(0.0, 0.0, 0.0),
            Oklab::from_hue(1.0, 0.0, 0.0),
        ])
    }

    /// A smooth curve through colours, at least two, walked at constant speed. What lies beyond the display's gamut is
    /// cut off band by band.
    pub fn through(colors: &[Oklab]) -> Self {
        let fine = 16 * STEPS;
        let points: Vec<Oklab> = (0..=fine)
            .map(|i| spline(colors, i as f32 / fine as f32))
            .collect();
        let mut gone = vec![0.0];
        for pair in points.windows(2) {
            gone.push(gone[gone.len() - 1] + pair[0].distance(pair[1]));
        }
        let length = gone[fine];
        let entry = |step: usize| {
            let target = length * (step as f32 / STEPS as f32);
            let next = gone.partition_point(|&g| g < target).clamp(1, fine);
            let part = gone[next] - gone[next - 1];
            let t = if part > 0.0 {
                (target - gone[next - 1]) / part
            } else {
                0.0
            };
            Rgb::from(mix(points[next - 1], points[next], t)).map(|band| band.clamp(0.0, 1.0))
        };
        Self {
            entries: (0..=STEPS).map(entry).collect(),
        }
    }

    /// The colour at a share from 0 to 1; that of an end beyond it and at NaN the first.
    pub fn color(&self, share: f32) -> Rgb {
        let place = share.clamp(0.0, 1.0).max(0.0) * STEPS as f32;
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "between 0 and the number of steps"
        )]
        let before = (place as usize).min(STEPS - 1);
        self.entries[before].lerp(self.entries[before + 1], place - before as f32)
    }

    /// The table as a picture whose columns go from the first colour to the last one, for a legend or as a texture.
    pub fn image(&self, width: usize, height: usize) -> Image<Rgb> {
        let columns: Vec<Rgb> = (0..width)
            .map(|x| self.color((x as f32 + 0.5) / width as f32))
            .collect();
        let pixels = (0..height).flat_map(|_| columns.iter().copied()).collect();
        Image::from_pixels(width, height, pixels).expect("one colour for each pixel")
    }
}

/// A curve through all points at equal distances of t, smooth, straight at both ends (Catmull and Rom 1974).
fn spline(points: &[Oklab], t: f32) -> Oklab {
    let Some(last) = points.len().checked_sub(1).filter(|&last| last > 0) else {
        return points
            .first()
            .copied()
            .unwrap_or(Oklab::from_hue(0.0, 0.0, 0.0));
    };
    let place = t.clamp(0.0, 1.0) * last as f32;
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "between 0 and the number of points"
    )]
    let i = (place as usize).min(last - 1);
    let (b, c) = (points[i], points[i + 1]);
    let a = if i > 0 {
        points[i - 1]
    } else {
        mix(b, c, -1.0)
    };
    let d = points.get(i + 2).copied().unwrap_or_else(|| mix(b, c, 2.0));
    let u = place - i as f32;
    // Twice the weights of the four.
    let weights = [
        ((2.0 - u) * u - 1.0) * u,
        (3.0 * u - 5.0) * u * u + 2.0,
        ((4.0 - 3.0 * u) * u + 1.0) * u,
        (u - 1.0) * u * u,
    ];
    let sum = |band: fn(Oklab) -> f32| {
        let pairs = [a, b, c, d].into_iter().map(band).zip(weights);
        0.5 * pairs.map(|(x, w)| x * w).sum::<f32>()
    };
    Oklab {
        lightness: sum(|c| c.lightness),
        a: sum(|c| c.a),
        b: sum(|c| c.b),
    }
}

fn mix(a: Oklab, b: Oklab, t: f32) -> Oklab {
    let mix = |a: f32, b: f32| a + (b - a) * t;
    Oklab {
        lightness: mix(a.lightness, b.lightness),
        a: mix(a.a, b.a),
        b: mix(a.b, b.b),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn oklab(map: &Colormap) -> Vec<Oklab> {
        map.entries.iter().map(|&color| color.into()).collect()
    }

    #[test]
    fn equal_steps_look_equally_large() {
        for (name, map) in [
            ("sequential", Colormap::sequential()),
            ("diverging", Colormap::diverging()),
            ("grey", Colormap::grey()),
        ] {
            let steps: Vec<f32> = oklab(&map)
                .windows(2)
                .map(|p| p[0].distance(p[1]))
                .collect();
            let mean = steps.iter().sum::<f32>() / steps.len() as f32;
            for (i, step) in steps.iter().enumerate() {
                assert!(
                    (step / mean - 1.0).abs() < 0.03,
                    "{name}, step {i}: {step}, mean {mean}"
                );
            }
        }
    }

    #[test]
    fn lightness_rises_all_along() {
        for map in [Colormap::sequential(), Colormap::grey()] {
            let colors = oklab(&map);
            assert!(
                colors.windows(2).all(|p| p[0].lightness < p[1].lightness),
                "it rises"
            );
        }
    }

    #[test]
    fn both_halves_of_the_diverging_map_are_equally_dark() {
        let colors = oklab(&Colormap::diverging());
        for i in 0..=STEPS / 2 {
            let (cold, warm) = (colors[i], colors[STEPS - i]);
            assert!(
                (cold.lightness - warm.lightness).abs() < 0.01,
                "step {i}: {cold:?}, {warm:?}"
            );
        }
        let middle = colors[STEPS / 2];
        assert!(
            middle.a.hypot(middle.b) < 1e-3 && middle.lightness > 0.94,
            "{middle:?}"
        );
    }

    #[test]
    fn no_colour_had_to_be_cut() {
        for map in [Colormap::sequential(), Colormap::diverging()] {
            let cut = |c: &Rgb| c.to_array().iter().any(|&band| band <= 0.0 || band >= 1.0);
            let count = map.entries.iter().filter(|c| cut(c)).count();
            assert_eq!(count, 0, "colours on the border of the gamut");
        }
    }

    #[test]
    fn few_colours_and_odd_places_make_a_table_too() {
        let none = Colormap::through(&[]);
        assert_eq!(none.color(0.3), Rgb::BLACK, "none");
        let one = Colormap::through(&[Oklab::from_hue(1.0, 0.0, 0.0)]);
        assert!((one.color(0.7).g - 1.0).abs() < 1e-4, "one");
        for share in [f32::NAN, f32::NEG_INFINITY, -1.0] {
            assert_eq!(Colormap::grey().color(share), Rgb::BLACK, "{share}");
        }
        assert_eq!(
            Colormap::grey().image(0, 3).pixels().len(),
            0,
            "an empty picture"
        );
    }
}
