//! `hemicube environment`: maps of light from all directions around a point.

mod capture;
mod files;
mod info;

use super::note;
use crate::args::{ConvertTask, EnvironmentTask, EnvironmentVerb, GlobalArgs};
use crate::failure::Failure;
use crate::output::{print, print_json};
use files::{Outputs, Tones};
use hemicube::raster::environment::{
    Conversion, ConvertOptions, EnvironmentMap, Flaw, MapFile, convert,
};
use serde_json::{Value, json};
use std::fmt::Write as _;
use std::time::Instant;

/// Does the task.
pub fn run(args: &EnvironmentVerb, global: GlobalArgs, start: Instant) -> Result<(), Failure> {
    match &args.task {
        EnvironmentTask::Convert(task) => run_convert(task, global),
        EnvironmentTask::Capture(task) => capture::run(task, global, start),
        EnvironmentTask::Info(task) => info::run(task, global),
    }
}

fn run_convert(task: &ConvertTask, global: GlobalArgs) -> Result<(), Failure> {
    let outputs = Outputs::check(&task.output, task.to, task.layout)?;
    outputs.refuse_inputs(&files::pictures(&task.input, task.from)?)?;
    refuse_size(task)?;
    let input = files::read(&task.input, task.from)?;
    note_flaws(&input, global);
    if !input.map.projection().covers_sphere() && task.to.covers_sphere() {
        note(
            global,
            &format!(
                "{} shows only what lies ahead; the rest is black",
                input.map.projection()
            ),
        );
    }
    let options = ConvertOptions::default().with_rows(task.size.unwrap_or(0) as usize);
    let (map, conversion) = convert(&input.map, task.to, &options);
    let tones = Tones::new(task.tones, input.is_8_bit);
    let written = outputs.write(&map, tones)?;
    report(&input, &map, &conversion, &written, global)
}

/// Says what was mended in the input, and what was not.
fn note_flaws(input: &MapFile, global: GlobalArgs) {
    if let Some(flaw) = &input.non_finite {
        note(global, &format!("{NON_FINITE}: {flaw}"));
    }
    if let Some(flaw) = &input.negative {
        note(global, &format!("{NEGATIVE}: {flaw}"));
    }
}

/// What becomes of pixels that no light has.
const NON_FINITE: &str = "not finite, read as 0 if no number, else as 65504";
const NEGATIVE: &str = "negative, kept (only .exr holds them; in .hdr and .png they are 0)";

/// Refuses a target that would take too much memory: some 36 bytes a texel.
fn refuse_size(task: &ConvertTask) -> Result<(), Failure> {
    const MOST: u64 = 1 << 26;
    let rows = u64::from(task.size.unwrap_or(0));
    let texels = task.to.faces() as u64 * rows * rows;
    if texels <= MOST {
        return Ok(());
    }
    Err(Failure::Usage(format!(
        "--size {rows}: {texels} texels of a {} are more than {MOST}; ask for fewer rows",
        task.to
    )))
}

/// What was made of what, and what became of the light.
fn report(
    input: &MapFile,
    after: &EnvironmentMap,
    conversion: &Conversion,
    written: &[String],
    global: GlobalArgs,
) -> Result<(), Failure> {
    let before = &input.map;
    if global.json {
        return print_json(&json!({
            "non_finite": flaw_json(&input.non_finite), "negative": flaw_json(&input.negative),
            "from": shape(before), "to": shape(after), "files": written,
            "solid_angle_error": conversion.solid_angle_error,
            "flux_before": conversion.flux_before, "flux_after": conversion.flux_after,
            "flux_error": conversion.flux_error(), "flux_spread": conversion.spread(),
        }));
    }
    let mut text = String::new();
    let _ = writeln!(text, "from      {}", in_words(before));
    let _ = writeln!(text, "to        {}", in_words(after));
    let _ = writeln!(
        text,
        "check     solid angles sum to {} sr, error {:.1e}",
        if after.projection().covers_sphere() {
            "4 pi"
        } else {
            "2 pi"
        },
        conversion.solid_angle_error
    );
    let [r, g, b] = conversion.flux_after;
    let _ = write!(text, "flux      {r:.5} {g:.5} {b:.5}");
    let is_whole = before.projection().covers_sphere() && after.projection().covers_sphere();
    let _ = if is_whole {
        writeln!(
            text,
            ", changed by {:.1e} ({:.1e} before the rest was spread evenly)",
            conversion.flux_error(),
            conversion.spread()
        )
    } else {
        let [r, g, b] = conversion.flux_before;
        writeln!(text, ", before {r:.5} {g:.5} {b:.5}")
    };
    for file in written {
        let _ = writeln!(text, "wrote     {file}");
    }
    print(&text)
}

/// Pixels that no light has, for programs.
fn flaw_json(flaw: &Option<Flaw>) -> Value {
    let Some(flaw) = flaw else {
        return json!({ "pixels": 0 });
    };
    json!({ "pixels": flaw.pixels, "first": { "file": flaw.file, "column": flaw.x, "row": flaw.y } })
}

/// Projection and size, for programs.
fn shape(map: &EnvironmentMap) -> Value {
    json!({
        "projection": map.projection().name(), "faces": map.projection().faces(),
        "width": map.width(), "height": map.height(),
    })
}

/// Projection and size, for people.
fn in_words(map: &EnvironmentMap) -> String {
    let (projection, width, height) = (map.projection(), map.width(), map.height());
    match projection.faces() {
        1 => format!("{projection}, {width} x {height}"),
        faces => format!("{projection}, {faces} faces of {width} x {height}"),
    }
}
