//! What a map is and how much light it holds.

use super::{NEGATIVE, NON_FINITE, files, flaw_json, in_words, shape};
use crate::args::{GlobalArgs, InfoTask};
use crate::failure::Failure;
use crate::output::{print, print_json};
use glam::Vec3;
use hemicube::raster::environment::SphericalHarmonics;
use serde_json::json;
use std::fmt::Write as _;

/// Directions of the irradiances that are told.
const NORMALS: [(&str, Vec3); 6] = [
    ("right", Vec3::X),
    ("left", Vec3::NEG_X),
    ("up", Vec3::Y),
    ("down", Vec3::NEG_Y),
    ("ahead", Vec3::NEG_Z),
    ("behind", Vec3::Z),
];

/// Prints everything that is known.
pub fn run(task: &InfoTask, global: GlobalArgs) -> Result<(), Failure> {
    let loaded = files::read(&task.input, task.from)?;
    let map = &loaded.map;
    let faces = map.projection().faces() as f64;
    let sum = faces * map.solid_angles().iter().sum::<f64>();
    let error = sum / map.projection().covered() - 1.0;
    let (flux, mean) = (map.flux(), map.mean());
    let brightest = map
        .texels()
        .iter()
        .map(|c| c.luminance())
        .fold(0.0, f32::max);
    let harmonics = SphericalHarmonics::of_map(map, 2);
    let irradiances = NORMALS.map(|(name, n)| (name, harmonics.irradiance(n).to_array()));
    if global.json {
        let irradiance: serde_json::Map<String, serde_json::Value> = irradiances
            .iter()
            .map(|(name, value)| ((*name).to_owned(), json!(value)))
            .collect();
        return print_json(&json!({
            "map": shape(map), "eight_bit": loaded.is_8_bit, "solid_angle": sum, "solid_angle_error": error,
            "non_finite": flaw_json(&loaded.non_finite), "negative": flaw_json(&loaded.negative),
            "flux": flux, "mean_radiance": mean, "brightest_luminance": brightest,
            "harmonics": harmonics.coefficients(), "irradiance": irradiance,
        }));
    }
    let mut text = String::new();
    let _ = writeln!(text, "map       {}", in_words(map));
    let _ = writeln!(text, "solid     {sum:.9} sr, error {error:.1e}");
    let _ = writeln!(text, "flux      {}", three(flux));
    let _ = writeln!(
        text,
        "radiance  {} on average, brightest luminance {brightest:.5}",
        three(mean)
    );
    for (name, flaw) in [
        (NON_FINITE, &loaded.non_finite),
        (NEGATIVE, &loaded.negative),
    ] {
        if let Some(flaw) = flaw {
            let _ = writeln!(text, "pixels    {name}: {flaw}");
        }
    }
    let _ = writeln!(text, "irradiance by spherical harmonics of degree 2:");
    for (name, value) in irradiances {
        let _ = writeln!(text, "  {name:8}{}", three(value.map(f64::from)));
    }
    let _ = writeln!(text, "harmonics (degree, order: red green blue):");
    for (i, &coefficient) in harmonics.coefficients().iter().enumerate() {
        let l = i.isqrt();
        let m = i.cast_signed() - (l * l + l).cast_signed();
        let _ = writeln!(text, "  {l} {m:2}    {}", three(coefficient));
    }
    print(&text)
}

fn three([r, g, b]: [f64; 3]) -> String {
    format!("{r:.5} {g:.5} {b:.5}")
}
