//! Values of options.

use clap::builder::{PossibleValuesParser, TypedValueParser};
use glam::Vec3;
use hemicube::raster::Rgb;
use hemicube::scene::options::{parse_named_rgb, parse_rgb};
use hemicube::scene::scene::MAX_LIGHT;
use std::ops::RangeInclusive;
use std::time::Duration;

/// Elements that a mesh may have.
pub const MAX_ELEMENTS: u64 = hemicube::radiosity::patch::MAX_ELEMENTS as u64;

/// One of a few values, by name; help lists the names and errors propose one.
pub fn choice<T: Copy + Send + Sync + 'static>(
    all: &'static [T],
    name: fn(T) -> &'static str,
) -> impl TypedValueParser<Value = T> {
    PossibleValuesParser::new(all.iter().map(move |&value| name(value))).map(move |chosen| {
        let found = all.iter().find(|&&value| name(value) == chosen);
        *found.expect("clap lets only the listed names pass")
    })
}

/// A whole number of a range
pub fn whole<T: TryFrom<u64>>(
    range: RangeInclusive<u64>,
) -> impl Fn(&str) -> Result<T, String> + Clone {
    move |text| {
        let number = text.trim().parse().ok().filter(|n| range.contains(n));
        number.and_then(|n| T::try_from(n).ok()).ok_or_else(|| {
            let (low, high) = range.clone().into_inner();
            format!("'{text}' is not a whole number from {low} to {high}")
        })
    }
}

/// `X,Y,Z`
pub fn point(text: &str) -> Result<Vec3, String> {
    let wanted = || format!("'{text}' is not X,Y,Z, three finite numbers");
    let numbers: Vec<f32> = text
        .split(',')
        .filter_map(|n| n.trim().parse().ok())
        .filter(|n: &f32| n.is_finite())
        .collect();
    match (numbers.as_slice(), text.split(',').count()) {
        (&[x, y, z], 3) => Ok(Vec3::new(x, y, z)),
        _ => Err(wanted()),
    }
}

/// `WxH` in pixels
pub fn size(text: &str) -> Result<(u32, u32), String> {
    let side = |text: &str| {
        text.trim()
            .parse::<u32>()
            .ok()
            .filter(|n| (1..=16_384).contains(n))
    };
    text.split_once(['x', 'X', '×'])
        .and_then(|(width, height)| Some((side(width)?, side(height)?)))
        .ok_or_else(|| {
            format!("'{text}' is not WxH in pixels, each from 1 to 16384, as in 960x640")
        })
}

/// `30s`, `2m`, `1.5h` or seconds without a unit
pub fn duration(text: &str) -> Result<Duration, String> {
    let wanted = || format!("'{text}' is not a time; use 30s, 2m or 1.5h");
    let digits = text.trim_end_matches(|c: char| c.is_ascii_alphabetic());
    let unit = match &text[digits.len()..] {
        "" | "s" => 1.0,
        "ms" => 1e-3,
        "m" | "min" => 60.0,
        "h" => 3600.0,
        _ => return Err(wanted()),
    };
    let number: f64 = digits.trim().parse().map_err(|_| wanted())?;
    Duration::try_from_secs_f64(number * unit)
        .ok()
        .filter(|time| *time > Duration::ZERO)
        .ok_or_else(wanted)
}

/// A length above 0
pub fn length(text: &str) -> Result<f32, String> {
    text.parse()
        .ok()
        .filter(|x: &f32| x.is_finite() && *x > 0.0)
        .ok_or_else(|| format!("'{text}' is not a length above 0"))
}

/// An angle of view in degrees
pub fn angle(text: &str) -> Result<f32, String> {
    let inside = |x: &f32| *x >= 1.0 && *x <= 360.0;
    text.parse()
        .ok()
        .filter(inside)
        .ok_or_else(|| format!("'{text}' is not an angle of view from 1 to 360 degrees"))
}

/// A share of the emitted light
pub fn tolerance(text: &str) -> Result<f64, String> {
    let inside = |x: &f64| *x >= 0.0 && *x < 1.0;
    text.parse()
        .ok()
        .filter(inside)
        .ok_or_else(|| format!("'{text}' is not a number from 0 to below 1"))
}

/// A contrast of light
pub fn contrast(text: &str) -> Result<f32, String> {
    let inside = |x: &f32| *x > 0.0 && *x < 1.0;
    text.parse()
        .ok()
        .filter(inside)
        .ok_or_else(|| format!("'{text}' is not a contrast between 0 and 1, as 0.1"))
}

/// A relative standard error.
pub fn noise(text: &str) -> Result<f64, String> {
    let inside = |x: &f64| *x >= 1e-4 && *x <= 1.0;
    text.parse()
        .ok()
        .filter(inside)
        .ok_or_else(|| format!("'{text}' is not a number from 1e-4 to 1"))
}

/// An error of form factors
pub fn error(text: &str) -> Result<f64, String> {
    let inside = |x: &f64| *x >= 1e-9 && *x <= 0.1;
    text.parse()
        .ok()
        .filter(inside)
        .ok_or_else(|| format!("'{text}' is not a number from 1e-9 to 0.1"))
}

/// Cells along an edge of a hemicube
pub fn resolution(text: &str) -> Result<u32, String> {
    let inside = |n: &u32| (16..=4096).contains(n) && n.is_multiple_of(2);
    text.parse()
        .ok()
        .filter(inside)
        .ok_or_else(|| format!("'{text}' is not an even number from 16 to 4096"))
}

/// Radiance in three bands
pub fn radiance(text: &str) -> Result<Rgb, String> {
    within(parse_rgb(text)?, text, MAX_LIGHT)
}

/// Radiance of materials
pub fn emission(text: &str) -> Result<(String, Rgb), String> {
    let (name, radiance) = parse_named_rgb(text)?;
    Ok((name, within(radiance, text, MAX_LIGHT)?))
}

/// Reflectance of materials
pub fn reflectance(text: &str) -> Result<(String, Rgb), String> {
    let (name, reflectance) = parse_named_rgb(text)?;
    Ok((name, within(reflectance, text, 1.0)?))
}

/// The colour if all its bands are from 0 to a bound.
fn within(color: Rgb, text: &str, most: f32) -> Result<Rgb, String> {
    let is_within = |band: &f32| (0.0..=most).contains(band);
    if color.to_array().iter().all(is_within) {
        Ok(color)
    } else {
        Err(format!(
            "'{text}' has a number that is not from 0 to {most}"
        ))
    }
}

/// A bound of the reflectance
pub fn bound(text: &str) -> Result<f32, String> {
    let inside = |x: &f32| *x > 0.0 && *x <= 1.0;
    text.parse()
        .ok()
        .filter(inside)
        .ok_or_else(|| format!("'{text}' is not a number above 0 and at most 1"))
}

/// A number from 0 to 1
pub fn share(text: &str) -> Result<f32, String> {
    let inside = |x: &f32| *x >= 0.0 && *x <= 1.0;
    text.parse()
        .ok()
        .filter(inside)
        .ok_or_else(|| format!("'{text}' is not a number from 0 to 1"))
}
