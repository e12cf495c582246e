//! What the program tells about a solution.

use crate::solving::{Solved, Stop, percent};
use hemicube::radiosity::form_factor::FormFactorKind;
use hemicube::radiosity::patch::constraints::CutCounts;
use hemicube::radiosity::solution::BANDS;
use hemicube::radiosity::solve::{self, Stages};
use hemicube::radiosity::{AdaptiveOptions, Solution};
use hemicube::scene::{ImportReport, Scene, Units};
use serde::Serialize;
use std::fmt::Write as _;
use std::fs;

/// Warnings that people get to read; `--json` has all of them.
const SHOWN_WARNINGS: usize = 10;

/// Everything about a solution that is not light on surfaces.
#[derive(Debug, Clone, Serialize)]
pub struct Report {
    program: &'static str,
    scene: String,
    units: &'static str,
    flux_unit: &'static str,
    warnings: Warnings,
    elements: usize,
    unrefined_elements: usize,
    patches: usize,
    contrast: Option<Contrast>,
    cuts: CutCounts,
    solver: String,
    form_factors: String,
    rays_per_hemisphere: u32,
    shot_rays: Option<u32>,
    hemicube_resolution: u32,
    seed: u64,
    tolerance: f64,
    stopped: Stop,
    steps: u64,
    rays: u64,
    seconds: f64,
    unshot_fraction: f64,
    noise: Option<f64>,
    /// Of solving by rays alone.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    stages: Vec<Stage>,
    balance: Vec<Balance>,
}

/// What one stage of solving by rays alone cost.
#[derive(Debug, Clone, Serialize)]
struct Stage {
    stage: &'static str,
    rays: u64,
    seconds: f64,
    rays_per_second: f64,
}

impl Stage {
    fn all(stages: Stages) -> Vec<Self> {
        let of = |(stage, cost): (&'static str, solve::Stage)| Self {
            stage,
            rays: cost.rays,
            seconds: cost.time.as_secs_f64(),
            rays_per_second: cost.rate(),
        };
        stages.named().into_iter().map(of).collect()
    }

    /// `direct 1.2 M in 0.6 s (2.0 M/s)`
    fn text(&self) -> String {
        let millions = |number: f64| format!("{:.1} M", number / 1e6);
        format!(
            "{} {} in {:.1} s ({}/s)",
            self.stage,
            millions(self.rays as f64),
            self.seconds,
            millions(self.rays_per_second)
        )
    }
}

/// What `--adaptive` has left.
#[derive(Debug, Clone, Copy, Serialize)]
struct Contrast {
    wanted: f32,
    /// From what on elements were cut: noise may raise it.
    least: f32,
    elements_above: usize,
    smallest_above: usize,
}

impl Contrast {
    fn new(adaptive: AdaptiveOptions, solution: &Solution) -> Self {
        let left = adaptive.left(solution);
        Self {
            wanted: adaptive.contrast,
            least: adaptive.least_contrast(solution),
            elements_above: left.elements,
            smallest_above: left.smallest,
        }
    }

    fn text(&self) -> String {
        let least = percent(f64::from(self.least));
        let noise = if self.least > self.wanted {
            ", three times the error of the light"
        } else {
            ""
        };
        if self.elements_above == 0 {
            return format!("contrast  at most {least} over every element{noise}");
        }
        format!(
            "contrast  above {least} over {}, {} of them as small as allowed{noise}",
            counted(self.elements_above as u64, "element"),
            grouped(self.smallest_above as u64)
        )
    }
}

/// Energy of one band, in lm or W (of scene units).
#[derive(Debug, Clone, Serialize)]
struct Balance {
    band: &'static str,
    emitted: f64,
    absorbed: f64,
    unshot: f64,
    escaped: f64,
    relative_error: f64,
}

/// Warnings of the import and of the mesh.
#[derive(Debug, Clone, Serialize)]
#[serde(transparent)]
pub struct Warnings {
    lines: Vec<String>,
    /// Warnings that nobody kept.
    #[serde(skip)]
    unlisted: usize,
}

impl Warnings {
    /// Those of a scene.
    pub fn of_scene(scene: &Scene) -> Self {
        Self {
            lines: scene
                .report
                .warnings
                .iter()
                .map(ToString::to_string)
                .collect(),
            unlisted: scene.report.unlisted,
        }
    }

    /// Those of a solution's scene and mesh.
    pub fn of_solution(solution: &Solution) -> Self {
        let mut warnings = Self::of_scene(solution.mesh().scene());
        warnings.extend(solution.mesh().report());
        warnings
    }

    /// With those of another report.
    pub fn extend(&mut self, report: &ImportReport) {
        self.lines
            .extend(report.warnings.iter().map(ToString::to_string));
        self.unlisted += report.unlisted;
    }

    /// The first of them, one a line, and how many there are beyond.
    pub fn text(&self) -> String {
        let mut text = String::new();
        for line in self.lines.iter().take(SHOWN_WARNINGS) {
            let _ = writeln!(text, "warning: {}", crate::failure::one_line(line));
        }
        let more = self.lines.len().saturating_sub(SHOWN_WARNINGS) + self.unlisted;
        if more > 0 {
            let _ = writeln!(text, "warning: and {more} more; --json lists them");
        }
        text
    }
}

impl Report {
    /// The report on a solution.
    pub fn new(solved: &Solved) -> Self {
        let solution = &solved.solution;
        let (mesh, provenance) = (solution.mesh(), &solution.provenance);
        let balance = |band: usize| {
            let (total, unshot) = (solution.total_balance(band), solution.unshot_flux(band));
            Balance {
                band: ["red", "green", "blue"][band],
                emitted: total.emitted,
                absorbed: total.absorbed,
                unshot,
                escaped: total.escaped,
                relative_error: total.relative_error(unshot),
            }
        };
        Self {
            program: concat!("hemicube ", env!("CARGO_PKG_VERSION")),
            scene: mesh.scene().name.clone(),
            units: mesh.scene().units.name(),
            flux_unit: flux_unit(mesh.scene().units),
            warnings: Warnings::of_solution(solution),
            elements: mesh.elements().len(),
            unrefined_elements: mesh.unrefined_elements(),
            patches: mesh.patches().len(),
            contrast: solved
                .options
                .adaptive
                .map(|adaptive| Contrast::new(adaptive, solution)),
            cuts: mesh.cuts(),
            solver: provenance.solver.clone(),
            form_factors: provenance.form_factors.clone(),
            rays_per_hemisphere: provenance.rays_per_hemisphere,
            shot_rays: provenance.shot_rays,
            hemicube_resolution: provenance.hemicube_resolution,
            seed: provenance.seed,
            tolerance: solved.options.tolerance,
            stopped: solved.stop,
            steps: provenance.steps,
            rays: provenance.rays,
            seconds: provenance.seconds,
            unshot_fraction: solution.unshot_fraction(),
            noise: provenance.noise,
            stages: provenance.stages.map_or_else(Vec::new, Stage::all),
            balance: (0..BANDS).map(balance).collect(),
        }
    }

    /// As JSON: what a lit .glb keeps.
    pub fn to_json(&self) -> serde_json::Value {
        serde_json::to_value(self).expect("a report is plain numbers and text")
    }

    /// How many elements there were before some were cut.
    fn before_refinement(&self) -> String {
        if self.elements == self.unrefined_elements {
            return String::new();
        }
        let before = grouped(self.unrefined_elements as u64);
        format!(" ({before} before refinement)")
    }

    /// How far the light is from its end.
    fn what_is_left(&self) -> String {
        let unshot = percent(self.unshot_fraction);
        match self.noise {
            Some(noise) => format!(
                "noise     {} of the irradiance (estimated error, root mean square over the elements)",
                percent(noise)
            ),
            None => format!("unshot    {unshot} of the emitted light"),
        }
    }

    /// As a few lines for people.
    pub fn text(&self) -> String {
        let mut text = String::new();
        let end = match self.stopped {
            Stop::Finished => "finished",
            Stop::Iterations => "stopped by --iterations",
            Stop::Time => "stopped by --time",
            Stop::Interrupt => "stopped by Ctrl-C",
        };
        let _ = write!(
            text,
            "scene     {} ({})
mesh      {}{}, {}{}
solved    {}, {}, seed {}: {}, {}, {:.1} s; {end}
{}
energy    {:>14} {:>13} {:>13} {:>13} {:>9}
",
            crate::failure::one_line(&self.scene),
            self.units,
            counted(self.elements as u64, "element"),
            self.before_refinement(),
            counted_patches(self.patches),
            cut_along(self.cuts),
            self.solver,
            factors(
                &self.form_factors,
                self.rays_per_hemisphere,
                self.shot_rays,
                self.hemicube_resolution
            ),
            self.seed,
            counted(self.steps, "step"),
            counted(self.rays, "ray"),
            self.seconds,
            self.what_is_left(),
            format!("emitted {}", self.flux_unit),
            "absorbed",
            "unshot",
            "escaped",
            "error"
        );
        for band in &self.balance {
            let _ = writeln!(
                text,
                "  {:<7} {:>14} {:>13} {:>13} {:>13} {:>9.1e}",
                band.band,
                flux(band.emitted),
                flux(band.absorbed),
                flux(band.unshot),
                flux(band.escaped),
                band.relative_error
            );
        }
        if !self.stages.is_empty() {
            let stages: Vec<String> = self.stages.iter().map(Stage::text).collect();
            let _ = writeln!(text, "rays      {}", stages.join(", "));
        }
        if let Some(contrast) = self.contrast {
            let _ = writeln!(text, "{}", contrast.text());
        }
        if let Some(bytes) = peak_memory() {
            let _ = writeln!(text, "memory    {} MB at most", bytes.div_ceil(1 << 20));
        }
        text + &self.warnings.text()
    }
}

/// What elements were cut along, after a semicolon; nothing if none was.
pub fn cut_along(cuts: CutCounts) -> String {
    let parts = [(cuts.joints, "joint"), (cuts.shadow_lines, "shadow line")];
    let told: Vec<String> = parts
        .into_iter()
        .filter(|(count, _)| *count > 0)
        .map(|(count, noun)| counted(count as u64, noun))
        .collect();
    if told.is_empty() {
        return String::new();
    }
    format!("; cut along {}", told.join(" and "))
}

/// The way to the form factors and how fine it was.
pub fn factors(name: &str, rays: u32, shot_rays: Option<u32>, resolution: u32) -> String {
    use FormFactorKind as Kind;
    let rays = shot_rays.map_or_else(
        || counted(u64::from(rays), "ray"),
        |rays| format!("{} a shot", counted(u64::from(rays), "ray")),
    );
    let name = crate::failure::one_line(name);
    if name.starts_with("gpu-raycast") {
        return format!("{name} with {rays}");
    }
    if name.starts_with("gpu") {
        return format!("{name} with {resolution} cells an edge");
    }
    match Kind::ALL.into_iter().find(|kind| kind.name() == name) {
        Some(Kind::Hemicube | Kind::CubicTetrahedron | Kind::SinglePlane) => {
            format!("{name} with {resolution} cells an edge")
        }
        // Neither takes a number that the user gave.
        Some(Kind::Analytic | Kind::Hemisphere) => name,
        Some(Kind::RayCast | Kind::Nusselt) | None => format!("{name} with {rays}"),
    }
}

/// lm or W.
pub fn flux_unit(units: Units) -> &'static str {
    match units {
        Units::Photometric => "lm",
        Units::Radiometric => "W",
    }
}

/// lx or W/m².
pub fn irradiance_unit(units: Units) -> &'static str {
    match units {
        Units::Photometric => "lx",
        Units::Radiometric => "W/m²",
    }
}

/// A flux with five significant digits.
fn flux(x: f64) -> String {
    match x.abs() {
        0.0 => String::from("0"),
        a if (1e-3..1e7).contains(&a) => {
            let decimals = [1e4, 1e3, 1e2, 1e1, 1.0, 0.1, 0.01]
                .iter()
                .take_while(|&&limit| a < limit)
                .count();
            format!("{x:.decimals$}")
        }
        _ => format!("{x:.4e}"),
    }
}

/// A number with a comma before every third digit.
pub fn grouped(number: u64) -> String {
    let digits = number.to_string();
    let mut text = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

/// A number with its noun: `1 point`, `2,000 points`.
pub fn counted(number: u64, noun: &str) -> String {
    let ending = if number == 1 { "" } else { "s" };
    format!("{} {noun}{ending}", grouped(number))
}

/// A number of patches.
pub fn counted_patches(number: usize) -> String {
    match number {
        1 => String::from("1 patch"),
        _ => format!("{} patches", grouped(number as u64)),
    }
}

/// Most memory that the program had at once, in bytes, where the system tells.
pub fn peak_memory() -> Option<u64> {
    let status = fs::read_to_string("/proc/self/status").ok()?;
    let line = status
        .lines()
        .find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kilobytes: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kilobytes * 1024)
}

/// Tenths of the free memory that matrices may take.
pub const SHARE_OF_MEMORY: u64 = 8;

/// Memory that programs may still take without others being written out, in bytes, where the system tells.
pub fn free_memory() -> Option<u64> {
    let facts = fs::read_to_string("/proc/meminfo").ok()?;
    let line = facts
        .lines()
        .find_map(|line| line.strip_prefix("MemAvailable:"))?;
    let kilobytes: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kilobytes * 1024)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_readable() {
        assert_eq!(grouped(1_234_567), "1,234,567", "groups of three");
        assert_eq!(grouped(999), "999", "one group");
        assert_eq!(flux(1234.56), "1234.6", "five digits");
        assert_eq!(flux(0.0), "0", "nothing");
        assert_eq!(
            percent(0.000_5),
            "0.050 %",
            "small shares keep their digits"
        );
    }
}
