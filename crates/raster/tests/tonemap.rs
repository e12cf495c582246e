//! Tone curves and exposure.

use hemicube_raster::Rgb;
use hemicube_raster::tonemap::{Exposure, ToneMap, automatic_exposure};
use proptest::prelude::*;

fn hue_of(c: Rgb) -> [f32; 3] {
    // Distances from grey, scaled to 1: what mixing with grey leaves.
    let grey = c.luminance();
    let d = c.map(|band| band - grey);
    let scale = d.r.abs().max(d.g.abs()).max(d.b.abs());
    (d / scale).to_array()
}

proptest! {
    #[test]
    fn every_input_lands_in_range(
        bands in prop::array::uniform3(prop::num::f32::ANY), exposure in prop::num::f32::ANY,
    ) {
        for tone_map in ToneMap::ALL {
            let shown = tone_map.apply(Rgb::from(bands), exposure);
            let in_range = shown.to_array().iter().all(|band| (0.0..=1.0).contains(band));
            prop_assert!(in_range, "{tone_map}: {bands:?} at {exposure} gives {shown:?}");
        }
    }

    #[test]
    fn more_light_is_not_darker(bands in prop::array::uniform3(0.0_f32..1.0), stops in -20.0_f32..20.0, more in 1.0_f32..4.0) {
        let factor = stops.exp2();
        for tone_map in ToneMap::ALL {
            let dim = tone_map.apply(Rgb::from(bands), factor).luminance();
            let bright = tone_map.apply(Rgb::from(bands), factor * more).luminance();
            prop_assert!(bright >= dim - 1e-6, "{tone_map}: {dim} then {bright}");
        }
    }

    #[test]
    fn bright_colours_keep_their_hue(bands in prop::array::uniform3(0.01_f32..1.0), stops in -4.0_f32..3.0) {
        let color = Rgb::from(bands);
        let spread = color.max_band() - bands.iter().fold(1.0_f32, |least, &band| least.min(band));
        prop_assume!(spread > 0.1);
        for tone_map in ToneMap::ALL {
            let shown = tone_map.apply(color, stops.exp2());
            let left = shown.max_band() - shown.r.min(shown.g).min(shown.b);
            // Near white and black nothing of the hue is left to compare.
            if left > 0.01 {
                let (expected, actual) = (hue_of(color), hue_of(shown));
                for (e, a) in expected.iter().zip(actual) {
                    prop_assert!((e - a).abs() < 1e-2, "{tone_map}: {color:?} became {shown:?}");
                }
            }
        }
    }

    #[test]
    fn automatic_exposure_is_positive_and_finite(luminances in prop::collection::vec(prop::num::f32::ANY, 0..50)) {
        let factor = automatic_exposure(luminances);
        prop_assert!(factor > 0.0 && factor.is_finite(), "factor {factor}");
    }

    #[test]
    fn automatic_exposure_undoes_the_unit(luminances in prop::collection::vec(0.01_f32..1.0, 1..100), stops in -30_i32..30) {
        let unit = 2_f32.powi(stops);
        let one = automatic_exposure(luminances.iter().copied());
        let other = automatic_exposure(luminances.iter().map(|l| l * unit));
        prop_assert!((other * unit / one - 1.0).abs() < 1e-5, "{one} and {other} for a unit of {unit}");
        let backwards = automatic_exposure(luminances.iter().rev().copied());
        prop_assert_eq!(one, backwards, "the order matters");
    }
}

#[test]
fn nan_and_black_are_black_and_infinite_is_white() {
    for tone_map in ToneMap::ALL {
        assert_eq!(
            tone_map.apply(Rgb::splat(f32::NAN), 1.0),
            Rgb::BLACK,
            "{tone_map}: NaN"
        );
        assert_eq!(
            tone_map.apply(Rgb::WHITE, f32::NAN),
            Rgb::BLACK,
            "{tone_map}: NaN exposure"
        );
        assert_eq!(
            tone_map.apply(Rgb::BLACK, 1.0),
            Rgb::BLACK,
            "{tone_map}: black"
        );
        assert_eq!(
            tone_map.apply(Rgb::new(f32::INFINITY, 0.0, 0.0), 1.0),
            Rgb::WHITE,
            "{tone_map}: infinite red"
        );
    }
}

#[test]
fn none_leaves_what_the_display_can_show() {
    let color = Rgb::new(0.1, 0.5, 1.0);
    assert_eq!(ToneMap::None.apply(color, 1.0), color, "colour in range");
}

#[test]
fn a_bright_orange_lamp_goes_to_white_through_orange() {
    let lamp = Rgb::new(1.0, 0.5, 0.1);
    for tone_map in ToneMap::ALL {
        let shown = tone_map.apply(lamp, 1.2);
        assert!(
            shown.r > shown.g && shown.g > shown.b,
            "{tone_map}: {shown:?} is not orange"
        );
        let glaring = tone_map.apply(lamp, 1e4);
        assert_eq!(glaring, Rgb::WHITE, "{tone_map}: glaring");
    }
}

#[test]
fn reinhard_is_white_at_its_white_point() {
    let shown = ToneMap::Reinhard.apply(Rgb::splat(4.0), 1.0);
    assert!((shown.g - 1.0).abs() < 1e-6, "{shown:?} at the white point");
}

#[test]
fn a_grey_room_is_shown_as_middle_grey() {
    // Walls around 300 cd/m², a lamp of 3 % of the pixels, a black background.
    let room = (0..1000).map(|k| match k {
        0..30 => 1e5,
        30..100 => 0.0,
        _ => 200.0 + (k % 200) as f32,
    });
    let factor = automatic_exposure(room);
    for tone_map in [ToneMap::Reinhard, ToneMap::Aces] {
        let shown = tone_map.apply(Rgb::splat(292.0), factor).luminance();
        assert!(
            (shown - 0.18).abs() < 0.01,
            "{tone_map}: the wall is shown at {shown}"
        );
    }
}

#[test]
fn a_lit_table_in_a_dark_room_is_not_burnt_out() {
    let room = (0..1000).map(|k| if k < 150 { 100.0 } else { 0.01 });
    let factor = automatic_exposure(room);
    assert!(
        factor * 100.0 <= 4.001,
        "the table is exposed to {}",
        factor * 100.0
    );
}

#[test]
fn black_pictures_are_left_alone() {
    assert_eq!(automatic_exposure([0.0; 9]), 1.0, "black");
    assert_eq!(automatic_exposure([]), 1.0, "empty");
    assert_eq!(
        automatic_exposure([f32::NAN, f32::INFINITY, -1.0]),
        1.0,
        "no usable luminance"
    );
}

#[test]
fn names_round_trip_and_errors_say_what_is_possible() {
    for tone_map in ToneMap::ALL {
        assert_eq!(
            tone_map.to_string().parse(),
            Ok(tone_map),
            "{tone_map} read back"
        );
    }
    for exposure in [Exposure::Auto, Exposure::Ev(-1.5), Exposure::Ev(0.0)] {
        assert_eq!(
            exposure.to_string().parse(),
            Ok(exposure),
            "{exposure} read back"
        );
    }
    assert_eq!(Exposure::Ev(3.0).factor([]), 8.0, "three stops");
    let error = "filmic".parse::<ToneMap>().map_err(|e| e.to_string());
    assert_eq!(
        error,
        Err("tone map 'filmic' is not known; use reinhard, aces or none".to_owned()),
        "message"
    );
    for text in ["NaN", "inf", "100", "bright", ""] {
        assert!(
            text.parse::<Exposure>().is_err(),
            "exposure '{text}' is taken"
        );
    }
}
