//! `hemicube form-factors`: view-factor matrices for thermal models.

use super::note;
use crate::args::{FormFactorsVerb, GlobalArgs};
use crate::backend::chosen;
use crate::failure::{Failure, one_line};
use crate::input::Input;
use crate::interrupt;
use crate::output::{Target, print, print_json};
use crate::progress::Bar;
use crate::report::{SHARE_OF_MEMORY, Warnings, free_memory, grouped, peak_memory};
use crate::solving::percent;
use hemicube::radiosity::export::view_factors::{self, View3dFacts};
use hemicube::radiosity::form_factor::matrix::{Change, SEAM};
use hemicube::radiosity::form_factor::{
    FormFactorKind, MatrixOptions, Overlap, Storage, Surfaces, SurfacesBy, ViewFactorMatrix,
};
use hemicube::radiosity::{PatchMesh, RadiosityError};
use hemicube::scene::ImportReport;
use serde_json::{Value, json};
use std::fmt::Write as _;
use std::sync::Arc;
use std::time::Instant;

/// Endings of the files that are written.
const ENDINGS: &[&str] = &["csv", "npy", "mtx", "out"];
/// Surfaces up to which the matrix is printed if it is not written.
const PRINTED: usize = 12;
/// As [`PRINTED`], in JSON.
const PRINTED_AS_JSON: usize = 100;
/// Characters of a name in the printed matrix.
const NAME: usize = 16;
/// Matrices that there are at once while one is corrected.
const CORRECTING: u64 = 4;

/// Computes the matrix, writes it and reports on it.
pub fn run(args: &FormFactorsVerb, global: GlobalArgs, start: Instant) -> Result<(), Failure> {
    if let Some(what) = args.factors.misplaced() {
        return Err(Failure::Usage(what));
    }
    let target = args
        .output
        .as_deref()
        .map(|path| Target::check(path, ENDINGS))
        .transpose()?;
    interrupt::listen();
    let scene = Arc::new(Input::open(&args.scene)?.into_scene(&args.scene_options)?);
    let mesh = PatchMesh::build_until(scene, args.factors.mesh(), &interrupt::asked);
    let mesh = Arc::new(mesh.map_err(|error| match error {
        RadiosityError::Stopped(_) => Failure::Interrupted,
        error => error.into(),
    })?);
    let computed = Computed::new(args, target.as_ref(), mesh, global, start)?;
    computed.advise(global);
    if let Some(target) = &target {
        computed.write(target)?;
    }
    let files: Vec<String> = target
        .iter()
        .map(|target| target.path.display().to_string())
        .collect();
    if global.json {
        return print_json(&computed.to_json(&files));
    }
    let mut text = computed.text();
    match &*files {
        [] if computed.matrix.size() <= PRINTED => text.push_str(&computed.table()),
        [] if global.quiet => {}
        [] => {
            text.push_str("no file   the factors are written with -o F.csv, .npy, .mtx or .out\n");
        }
        files => {
            let _ = writeln!(text, "wrote     {}", files.join(", "));
        }
    }
    print(&text)
}

/// A matrix and how it came about.
struct Computed {
    mesh: Arc<PatchMesh>,
    matrix: ViewFactorMatrix,
    surfaces: Surfaces,
    by: SurfacesBy,
    /// Name of the way to the factors.
    method: String,
    /// Which of the CPU's ways it is, or is the twin of.
    kind: FormFactorKind,
    rays_per_hemisphere: u32,
    seed: u64,
    error: f64,
    rays: u64,
    sampled_pairs: u64,
    /// What the correction changed, if there was one.
    change: Option<Change>,
    overlaps: Vec<Overlap>,
    seconds: f64,
}

impl Computed {
    fn new(
        args: &FormFactorsVerb,
        target: Option<&Target>,
        mesh: Arc<PatchMesh>,
        global: GlobalArgs,
        start: Instant,
    ) -> Result<Self, Failure> {
        let factors = &args.factors;
        let asked = mesh.scene().view_factors.clone();
        let of_file = match &asked {
            Some(_) => SurfacesBy::Object,
            None => SurfacesBy::Face,
        };
        let by = factors.by.unwrap_or(of_file);
        let surfaces = Surfaces::new(&mesh, by);
        if surfaces.is_empty() {
            return Err(Failure::Failed(format!(
                "scene '{}': every face looks into a solid, so none sees another; turn them around with --flip '*'",
                mesh.scene().name
            )));
        }
        let error = asked.as_ref().and_then(|asked| asked.error);
        let kind = factors.kind();
        let bar = Bar::new("factors", global.quiet);
        let stop = || {
            bar.count(mesh.patches().len());
            interrupt::asked()
        };
        let corrected = factors.enclosure || asked.is_some_and(|asked| asked.enclosure);
        let mut storage = memory(corrected);
        if let Some(target) = target {
            refuse_large_file(target, surfaces.len(), by, storage.memory_limit)?;
            if target.ends_in("npy") {
                // The file holds every entry.
                storage.storage = Storage::Dense;
            }
        }
        let backend = chosen(&factors.gpu, factors.uses_gpu(), "--method", global.quiet)?;
        let options = factors.options(error);
        let way = if factors.uses_gpu() {
            backend.form_factors(mesh.clone(), &factors.solve_options(&options))?
        } else {
            kind.build(mesh.clone(), &options)?
        };
        let matrix = ViewFactorMatrix::build_by(&*way, &surfaces, storage, &stop)?;
        bar.finish();
        backend.verdict()?;
        if interrupt::asked() {
            return Err(Failure::Interrupted);
        }
        let (matrix, change) = if corrected {
            let after = matrix.enclosure_corrected();
            let change = after.change_from(&matrix);
            (after, Some(change))
        } else {
            (matrix, None)
        };
        Ok(Self {
            matrix,
            change,
            overlaps: surfaces.overlaps(&mesh),
            rays: way.rays(),
            sampled_pairs: way.sampled_pairs(),
            mesh,
            surfaces,
            by,
            method: if factors.uses_gpu() {
                backend.name(&factors.solve_options(&options))
            } else {
                kind.name().to_owned()
            },
            kind,
            rays_per_hemisphere: options.raycast.rays,
            seed: options.raycast.seed,
            error: options.analytic.error,
            seconds: start.elapsed().as_secs_f64(),
        })
    }

    /// Says what looks like a mistake.
    fn advise(&self, global: GlobalArgs) {
        if let [first, rest @ ..] = self.surfaces.buried() {
            let others = if rest.is_empty() {
                String::new()
            } else {
                format!(" and {} more", grouped(rest.len() as u64))
            };
            note(
                global,
                &format!(
                    "'{first}'{others} look into solids and have no rows; --flip turns faces around"
                ),
            );
        }
        if self.mesh.visibility().is_tinted() {
            note(
                global,
                "panes tint the light, so factors differ between bands: these are the means of three",
            );
        }
        if self.sampled_pairs > 0 {
            note(
                global,
                &format!(
                    "{} pairs lie behind panes or very many surfaces; their visibility is sampled with rays, to some 2 to 9 % of their factors",
                    grouped(self.sampled_pairs)
                ),
            );
        }
        let (lost, most) = self.lost();
        if self.change.is_some() && lost > SEAM {
            note(
                global,
                &format!(
                    "the enclosure is open: {} of what leaves '{}' meets no surface or a back, and stays lost",
                    percent(lost),
                    self.name(most)
                ),
            );
        }
    }

    /// The largest share of a row that meets nothing or a back, and the row.
    fn lost(&self) -> (f64, usize) {
        let lost = |i: usize| self.matrix.sky()[i] + self.matrix.absorbed()[i];
        largest((0..self.matrix.size()).map(|i| (lost(i), i)))
    }

    fn name(&self, i: usize) -> &str {
        &self.matrix.names()[i]
    }

    fn write(&self, target: &Target) -> Result<(), Failure> {
        let emissivities = self.surfaces.emissivities(&self.mesh);
        let facts = View3dFacts {
            emissivities: &emissivities,
            enclosure: self.change.is_some(),
        };
        target.write_with(|out| match () {
            () if target.ends_in("npy") => view_factors::npy(&self.matrix, out),
            () if target.ends_in("mtx") => view_factors::matrix_market(&self.matrix, out),
            () if target.ends_in("out") => view_factors::view3d(&self.matrix, facts, out),
            () => view_factors::csv(&self.matrix, out),
        })
    }

    /// How it was computed, in words.
    fn way(&self) -> String {
        match self.kind {
            FormFactorKind::RayCast => format!(
                "{} with {} rays, seed {}: {} rays",
                self.method,
                self.rays_per_hemisphere,
                self.seed,
                grouped(self.rays)
            ),
            FormFactorKind::Analytic => format!("analytic, error {:.0e}", self.error),
            _ => self.method.clone(),
        }
    }

    /// As a few lines for people.
    fn text(&self) -> String {
        let facts = Facts::new(&self.matrix);
        let name = |i: usize| one_line(self.name(i));
        let n = grouped(self.matrix.size() as u64);
        let mut text = format!(
            "scene     {} ({})
factors   {n} x {n} by {}, {}, {:.1} s
closure   rows sum to 1 within {}{}
pairs     A_i F_ij = A_j F_ji {}
largest   {:.5} from '{}' to '{}'
sky       {} of all, at most {} of '{}'
",
            one_line(&self.mesh.scene().name),
            self.mesh.scene().units.name(),
            self.by.name(),
            self.way(),
            self.seconds,
            error(facts.closure_error),
            if self.change.is_some() {
                ", corrected"
            } else {
                ""
            },
            self.reciprocity(&facts),
            facts.largest_factor,
            name(facts.largest_pair[0]),
            name(facts.largest_pair[1]),
            percent(facts.sky.mean),
            percent(facts.sky.most),
            name(facts.sky.row),
        );
        if let Some(change) = &self.change {
            let _ = writeln!(
                text,
                "changed   by at most {} ('{}' to '{}'), RMS {}, the sky by at most {}",
                error(change.largest),
                name(change.row),
                name(change.column),
                error(change.rms),
                error(change.sky)
            );
        }
        for (label, share) in [("backs", &facts.absorbed), ("panes", &facts.transmitted)] {
            if share.most > 0.0 {
                let _ = writeln!(
                    text,
                    "{label:<9} {} of all, at most {} of '{}'",
                    percent(share.mean),
                    percent(share.most),
                    name(share.row)
                );
            }
        }
        text + &self.warnings().text()
    }

    /// How well reciprocity holds, and where it holds worst; no pair is worst where it is exact.
    fn reciprocity(&self, facts: &Facts) -> String {
        if facts.reciprocity_error == 0.0 {
            return String::from("exactly");
        }
        let [a, b] = facts.worst_pair.map(|i| one_line(self.name(i)));
        let error = error(facts.reciprocity_error);
        format!("within {error} of the smaller area: '{a}', '{b}'")
    }

    fn warnings(&self) -> Warnings {
        let mut warnings = Warnings::of_scene(self.mesh.scene());
        warnings.extend(self.mesh.report());
        warnings.extend(&self.overlap_report());
        warnings
    }

    /// Surfaces that lie in one place: rows that see them sum to more than 1 there.
    fn overlap_report(&self) -> ImportReport {
        let mut report = ImportReport::default();
        for overlap in &self.overlaps {
            let [a, b] = overlap.surfaces.map(|i| self.name(i));
            let place = if a == b {
                format!("'{a}' upon itself")
            } else {
                format!("'{a}' and '{b}'")
            };
            let area = area(overlap.area);
            report.warn(
                place,
                format!(
                    "face the same way in one place over an area of {}, where both are seen, so rows sum to more than 1; \
                     move one away, leave it out, or in .vs3 make one the base of the other",
                    area.trim()
                ),
            );
        }
        report
    }

    /// The matrix for people: columns by the numbers of the rows.
    fn table(&self) -> String {
        let n = self.matrix.size();
        let shown = |i: usize| {
            one_line(self.name(i))
                .chars()
                .take(NAME)
                .collect::<String>()
        };
        let width = (0..n).map(|i| shown(i).chars().count()).max().unwrap_or(0);
        let mut text = format!("\n    {:width$}      area", "");
        (0..n).for_each(|j| _ = write!(text, " {:>7}", j + 1));
        text.push_str("     sky   backs\n");
        for i in 0..n {
            let _ = write!(
                text,
                "{:>3} {:width$} {:>9}",
                i + 1,
                shown(i),
                area(self.matrix.areas()[i])
            );
            (0..n).for_each(|j| _ = write!(text, " {:.5}", self.matrix.get(i, j)));
            let _ = writeln!(
                text,
                " {:.5} {:.5}",
                self.matrix.sky()[i],
                self.matrix.absorbed()[i]
            );
        }
        text
    }

    fn to_json(&self, files: &[String]) -> Value {
        let matrix = &self.matrix;
        let emissivities = self.surfaces.emissivities(&self.mesh);
        let surface = |i: usize| {
            json!({
                "name": self.name(i), "area": matrix.areas()[i], "emissivity": emissivities[i],
                "sky": matrix.sky()[i], "absorbed": matrix.absorbed()[i], "transmitted": matrix.transmitted()[i],
            })
        };
        let facts = Facts::new(matrix);
        let mut report = json!({
            "program": concat!("hemicube ", env!("CARGO_PKG_VERSION")),
            "scene": self.mesh.scene().name,
            "by": self.by.name(),
            "method": self.method,
            "rays_per_hemisphere": (self.kind == FormFactorKind::RayCast).then_some(self.rays_per_hemisphere),
            "error": (self.kind == FormFactorKind::Analytic).then_some(self.error),
            "seed": self.seed,
            "rays": self.rays,
            "sampled_pairs": self.sampled_pairs,
            "elements": self.mesh.elements().len(),
            "corrected": self.change.is_some(),
            "correction": self.change.map(|change| json!({
                "largest": change.largest, "from": self.name(change.row), "to": self.name(change.column),
                "rms": change.rms, "sky": change.sky,
            })),
            "overlaps": self.overlaps.iter().map(|overlap| json!({
                "between": overlap.surfaces.map(|i| self.name(i)), "area": overlap.area,
            })).collect::<Vec<_>>(),
            "closure_error": facts.closure_error,
            "reciprocity_error": { "error": facts.reciprocity_error, "between": facts.worst_pair.map(|i| self.name(i)) },
            "largest": { "factor": facts.largest_factor, "from": self.name(facts.largest_pair[0]), "to": self.name(facts.largest_pair[1]) },
            "sky": facts.sky.to_json(self), "absorbed": facts.absorbed.to_json(self), "transmitted": facts.transmitted.to_json(self),
            "surfaces": (0..matrix.size()).map(surface).collect::<Vec<_>>(),
            "buried": self.surfaces.buried(),
            "sparse": matrix.entries().is_sparse(),
            "seconds": self.seconds,
            "peak_memory_bytes": peak_memory(),
            "warnings": self.warnings(),
            "files": files,
        });
        if files.is_empty() && matrix.size() <= PRINTED_AS_JSON {
            let row = |i: usize| {
                (0..matrix.size())
                    .map(|j| matrix.get(i, j))
                    .collect::<Vec<_>>()
            };
            report["factors"] = (0..matrix.size()).map(row).collect();
        }
        report
    }
}

/// What a matrix tells about itself.
struct Facts {
    closure_error: f64,
    reciprocity_error: f64,
    worst_pair: [usize; 2],
    largest_factor: f32,
    largest_pair: [usize; 2],
    sky: Share,
    absorbed: Share,
    transmitted: Share,
}

/// A share that rows lose.
struct Share {
    /// Of what leaves all surfaces evenly.
    mean: f64,
    most: f64,
    row: usize,
}

impl Facts {
    fn new(matrix: &ViewFactorMatrix) -> Self {
        let reciprocity = matrix.reciprocity_error();
        let rows = 0..matrix.size();
        let entries = rows.flat_map(|i| matrix.entries().row(i).map(move |(j, f)| (f, [i, j])));
        let (largest_factor, largest_pair) =
            entries.fold(
                (0.0, [0, 0]),
                |best, one| if one.0 > best.0 { one } else { best },
            );
        Self {
            closure_error: matrix.closure_error(),
            reciprocity_error: reciprocity.error,
            worst_pair: [reciprocity.row, reciprocity.column],
            largest_factor,
            largest_pair,
            sky: Share::new(matrix, matrix.sky()),
            absorbed: Share::new(matrix, matrix.absorbed()),
            transmitted: Share::new(matrix, matrix.transmitted()),
        }
    }
}

impl Share {
    fn new(matrix: &ViewFactorMatrix, shares: &[f64]) -> Self {
        let areas = matrix.areas();
        let flux: f64 = shares
            .iter()
            .zip(areas)
            .map(|(share, area)| share * area)
            .sum();
        let (most, row) = largest(shares.iter().copied().zip(0..));
        Self {
            mean: flux / areas.iter().sum::<f64>(),
            most,
            row,
        }
    }

    fn to_json(&self, computed: &Computed) -> Value {
        json!({ "mean": self.mean, "most": self.most, "of": computed.name(self.row) })
    }
}

/// An area in nine characters at most.
fn area(x: f64) -> String {
    if (0.01..10_000.0).contains(&x) {
        format!("{x:.4}")
    } else {
        format!("{x:.3e}")
    }
}

/// An error with two significant digits.
fn error(x: f64) -> String {
    if x == 0.0 {
        String::from("0")
    } else {
        format!("{x:.1e}")
    }
}

/// The first of the largest values and where it is.
fn largest(values: impl Iterator<Item = (f64, usize)>) -> (f64, usize) {
    values.fold(
        (0.0, 0),
        |best, one| if one.0 > best.0 { one } else { best },
    )
}

/// Refuses files that would hold every factor of more than fit into memory: who reads them has no more.
fn refuse_large_file(
    target: &Target,
    n: usize,
    by: SurfacesBy,
    limit: usize,
) -> Result<(), Failure> {
    let needed = n.saturating_mul(n).saturating_mul(4);
    if target.ends_in("mtx") || needed <= limit {
        return Ok(());
    }
    let n = grouped(n as u64);
    let mend = match by {
        SurfacesBy::Face => "sum them with --by object, or write .mtx, which leaves zeros out",
        SurfacesBy::Object => "write .mtx, which leaves zeros out",
    };
    Err(Failure::Failed(format!(
        "{}: the file holds every factor, and {n} x {n} take {} MiB where {} MiB are free for them; {mend}",
        target.path.display(),
        grouped((needed as u64 >> 20) + 1),
        grouped(limit as u64 >> 20),
    )))
}

/// A share of the memory that is free, or what the library takes for granted.
fn memory(corrected: bool) -> MatrixOptions {
    let mut options = MatrixOptions::default();
    if let Some(free) = free_memory() {
        let matrices = if corrected { CORRECTING } else { 1 };
        let bytes = free / 10 * SHARE_OF_MEMORY / matrices;
        options.memory_limit = usize::try_from(bytes).unwrap_or(usize::MAX);
    }
    options
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    #[test]
    fn files_of_every_factor_are_refused_if_memory_has_no_room() {
        let folder = tempfile::tempdir().expect("a folder for a test");
        for ending in ENDINGS {
            let path = folder.path().join(format!("F.{ending}"));
            let target = Target::check(Path::new(&path), ENDINGS).expect("it can be written");
            let refused = |n, by| refuse_large_file(&target, n, by, 1 << 20);
            assert!(refused(512, SurfacesBy::Face).is_ok(), "1 MiB fits");
            let error = refused(280_000, SurfacesBy::Face);
            if *ending == "mtx" {
                assert!(error.is_ok(), "zeros are left out");
                continue;
            }
            let message = error.expect_err("300 GB do not fit");
            let message = message.message().expect("words");
            for part in [
                "280,000 x 280,000",
                "299,073 MiB",
                "1 MiB are free",
                "--by object",
            ] {
                assert!(message.contains(part), "'{part}' is not in {message}");
            }
            let objects = refused(280_000, SurfacesBy::Object).expect_err("nor then");
            assert!(
                !objects.message().expect("words").contains("--by"),
                "{objects:?}"
            );
        }
    }
}
