//! `hemicube measure`: irradiance and illuminance at points.

use super::solution_of;
use crate::args::{GlobalArgs, MeasureVerb};
use crate::csv::{Measured, Points};
use crate::failure::Failure;
use crate::input::read;
use crate::output::{Target, print, print_json};
use crate::progress::Bar;
use crate::report::{counted, irradiance_unit};
use hemicube::radiosity::{GatherOptions, Gatherer, Solution};
use rayon::prelude::*;
use serde_json::{Value, json};
use std::time::Instant;

/// Measures and writes the table.
pub fn run(args: &MeasureVerb, global: GlobalArgs, start: Instant) -> Result<(), Failure> {
    let target = args
        .output
        .as_deref()
        .map(|path| Target::check(path, &[]))
        .transpose()?;
    let file = args.points.display();
    let points =
        Points::parse(&read(&args.points)?).map_err(|e| Failure::Failed(format!("{file}: {e}")))?;
    let solution = solution_of(
        &args.scene,
        &args.solve,
        &args.scene_options,
        global,
        start,
        |_| Ok(()),
    )?;
    let values = measure(&solution, &points, args, global);
    if let Some(target) = &target {
        target.write(points.with_values(&values).as_bytes())?;
    }
    match (target, global.json) {
        (None, false) => print(&points.with_values(&values)),
        (Some(target), false) => print(&summary(&values, &target)),
        (target, true) => print_json(&report(&solution, &points, &values, target.as_ref())),
    }
}

fn measure(
    solution: &Solution,
    points: &Points,
    args: &MeasureVerb,
    global: GlobalArgs,
) -> Vec<Measured> {
    let defaults = GatherOptions::default();
    let options = GatherOptions {
        rays: args.gather_rays.unwrap_or(defaults.rays),
        seed: args.solve.mesh.seed.unwrap_or(solution.provenance.seed),
    };
    let gatherer = Gatherer::new(solution, options);
    let units = solution.mesh().scene().units;
    let bar = Bar::new("measuring", global.quiet);
    let at = |row: &crate::csv::Row| {
        let irradiance = gatherer.irradiance(row.point, row.normal);
        bar.count(points.rows.len());
        Measured {
            irradiance,
            illuminance: units.illuminance(irradiance),
        }
    };
    points.rows.par_iter().map(at).collect()
}

/// Smallest, mean and largest illuminance.
fn range(values: &[Measured]) -> (f32, f64, f32) {
    let all = || values.iter().map(|v| v.illuminance);
    let sum: f64 = all().map(f64::from).sum();
    (
        all().fold(f32::INFINITY, f32::min),
        sum / values.len() as f64,
        all().fold(f32::NEG_INFINITY, f32::max),
    )
}

fn summary(values: &[Measured], target: &Target) -> String {
    let (least, mean, most) = range(values);
    let uniformity = if mean > 0.0 {
        f64::from(least) / mean
    } else {
        0.0
    };
    let dark = values.iter().filter(|v| v.illuminance == 0.0).count();
    let remark = match dark {
        0 => String::new(),
        _ => format!(
            "dark      {} without any light: inside an object, or normals that point the wrong way\n",
            counted(dark as u64, "point")
        ),
    };
    format!(
        "measured  {}\nlux       mean {mean:.1}, from {least:.1} to {most:.1}, uniformity (least / mean) {uniformity:.2}\n{remark}wrote     {}\n",
        counted(values.len() as u64, "point"),
        target.path.display()
    )
}

fn report(
    solution: &Solution,
    points: &Points,
    values: &[Measured],
    target: Option<&Target>,
) -> Value {
    let (least, mean, most) = range(values);
    let mut report = json!({
        "scene": solution.mesh().scene().name,
        "irradiance_unit": irradiance_unit(solution.mesh().scene().units),
        "count": values.len(),
        "illuminance": { "least": least, "mean": mean, "most": most },
        "files": target.map(|t| t.path.display().to_string()).into_iter().collect::<Vec<_>>(),
    });
    if target.is_none() {
        let of_point = |(row, value): (&crate::csv::Row, &Measured)| {
            json!({
                "point": row.point.to_array(), "normal": row.normal.to_array(),
                "irradiance": value.irradiance.to_array(), "illuminance": value.illuminance,
            })
        };
        report["points"] = points.rows.iter().zip(values).map(of_point).collect();
    }
    report
}
