//! `hemicube compare`: solvers side by side after the same number of steps.

use super::{note, refuse_misplaced};
use crate::args::{CompareVerb, GlobalArgs};
use crate::backend::{FORM_FACTORS, chosen};
use crate::failure::Failure;
use crate::input::Input;
use crate::interrupt;
use crate::output::{Target, print, print_json};
use crate::picture::{self, View};
use crate::progress::Bar;
use crate::report::{counted, counted_patches};
use crate::solving::percent;
use hemicube::radiosity::compare::{Variant, converged, variant};
use hemicube::radiosity::form_factor::{Cached, MatrixOptions};
use hemicube::radiosity::{RadiosityError, Solution, SolveOptions, SolverKind, unlit};
use hemicube::scene::Scene;
use hemicube_chart::{Canvas, Chart, Curve, Drawing, Scale, label};
use serde_json::json;
use std::fmt::Write as _;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// The classic four.
const CLASSIC: [SolverKind; 4] = [
    SolverKind::Gathering,
    SolverKind::Shooting,
    SolverKind::SortedShooting,
    SolverKind::AmbientShooting,
];

/// Unshot share of the solution that counts as the truth: far below what curves show.
const CONVERGED: f64 = 1e-5;

/// Memory for the rows of form factors, which all variants share.
const ROW_BUDGET: usize = 1 << 30;

/// Compares and writes what was asked for.
pub fn run(args: &CompareVerb, global: GlobalArgs, start: Instant) -> Result<(), Failure> {
    interrupt::listen();
    let picture_target = target(args.output.as_deref(), &["png"])?;
    let table_target = target(args.csv.as_deref(), &["csv"])?;
    if picture_target.is_none() && (!args.picture.view_given().is_empty()) {
        return Err(Failure::Usage(format!(
            "{} without a picture; name one with -o FILE.png",
            args.picture.view_given().join(", ")
        )));
    }
    if args.picture.uses_gpu() {
        return Err(Failure::Usage(String::from(
            "--draw-on gpu: variants are drawn by the CPU; leave it out",
        )));
    }
    let scene = Input::open(&args.scene)?.into_scene(&args.scene_options)?;
    picture::check(&scene, &args.picture)?;
    refuse_misplaced(&args.mesh, &args.mesh.options(), &scene)?;
    let watch = Watch {
        start,
        limit: args.time,
    };
    let comparison = Comparison::make(args, scene, &watch, global)?;
    let mut files = Vec::new();
    if let Some(target) = &picture_target {
        target.write(&comparison.sheet(args)?.png()?)?;
        files.push(target.path.display().to_string());
    }
    if let Some(target) = &table_target {
        target.write(comparison.csv().as_bytes())?;
        files.push(target.path.display().to_string());
    }
    comparison.tell(&files, global)
}

fn target(path: Option<&std::path::Path>, endings: &[&str]) -> Result<Option<Target>, Failure> {
    path.map(|path| Target::check(path, endings)).transpose()
}

/// When to give up.
struct Watch {
    start: Instant,
    limit: Option<Duration>,
}

impl Watch {
    fn is_over(&self) -> bool {
        interrupt::asked()
            || self
                .limit
                .is_some_and(|limit| self.start.elapsed() >= limit)
    }

    /// What to tell when it is over.
    fn failure(&self) -> Failure {
        if interrupt::asked() {
            return Failure::Interrupted;
        }
        Failure::Failed(String::from(
            "--time: time was up before all variants were done; allow more time, or ask for fewer --steps or --elements",
        ))
    }
}

/// All variants and the truth.
struct Comparison {
    steps: u64,
    truth: Solution,
    variants: Vec<Variant>,
    form_factors: String,
}

impl Comparison {
    fn make(
        args: &CompareVerb,
        scene: Scene,
        watch: &Watch,
        global: GlobalArgs,
    ) -> Result<Self, Failure> {
        let options: SolveOptions = args.mesh.options();
        let stop = || watch.is_over();
        let start = unlit(Arc::new(scene), &options, &stop);
        let start = start.map_err(|error| match error {
            RadiosityError::Stopped(_) => watch.failure(),
            error => error.into(),
        })?;
        let mesh = start.mesh().clone();
        let backend = chosen(
            &args.mesh.gpu,
            args.mesh.uses_gpu(None),
            FORM_FACTORS,
            global.quiet,
        )?;
        let factors = backend.form_factors(mesh, &options)?;
        let factors = Cached::new(factors, ROW_BUDGET);
        let bar = Bar::new("comparing", global.quiet);
        let truth = converged(&factors, &start, CONVERGED, |progress, _| {
            let share = progress.unshot.max(CONVERGED).ln() / CONVERGED.ln();
            bar.show(0.5 * share, || String::from("the converged solution"));
            !stop()
        });
        if stop() {
            return Err(watch.failure());
        }
        let kinds: &[SolverKind] = if args.variants.is_empty() {
            &CLASSIC
        } else {
            &args.variants
        };
        let mut variants = Vec::new();
        for (i, &kind) in kinds.iter().enumerate() {
            bar.show(0.5 + 0.5 * i as f64 / kinds.len() as f64, || {
                kind.name().into()
            });
            let matrix = MatrixOptions::default();
            let made = variant(&factors, &start, kind, args.steps, &truth, matrix, &stop)?;
            variants.push(made.ok_or_else(|| watch.failure())?);
        }
        bar.finish();
        let comparison = Self {
            steps: args.steps,
            truth,
            variants,
            form_factors: backend.name(&options),
        };
        if comparison.variants.iter().all(|v| v.errors[0] == 0.0) {
            note(
                global,
                "nothing reflects light, so there is nothing to compare",
            );
        }
        Ok(comparison)
    }

    fn errors(&self) -> impl Iterator<Item = f64> + '_ {
        self.variants
            .iter()
            .filter_map(|v| v.errors.last())
            .copied()
    }

    /// The pictures, with their names above and the curves below.
    fn sheet(&self, args: &CompareVerb) -> Result<Canvas, Failure> {
        let view = View::new(&self.truth, &args.picture)?.within(Sheet::SIDE);
        let exposure = view.exposure(&self.truth)?;
        let sheet = Sheet::new(view.size(), self.variants.len());
        let mut canvas = Canvas::new(sheet.width, sheet.height());
        for (i, variant) in self.variants.iter().enumerate() {
            let (left, top) = sheet.place(i);
            canvas.paste(
                &view.display(&variant.shown, exposure)?,
                left,
                top + Sheet::LABEL,
            );
            let error = variant.errors.last().copied().unwrap_or(f64::NAN);
            let lines = [
                String::from(variant.kind.name()),
                format!("error {}", percent(error)),
            ];
            canvas.draw(&label(&lines, sheet.cell.0, Sheet::LABEL), left, top);
        }
        canvas.draw(&self.curves(sheet.width), 0, sheet.chart_top());
        Ok(canvas)
    }

    fn curves(&self, width: usize) -> Drawing {
        let curve = |variant: &Variant| {
            let points = variant.errors.iter().enumerate();
            let points = points.map(|(step, &error)| (step as f64, error)).collect();
            Curve::new(variant.kind.name(), points)
        };
        let mesh = self.truth.mesh();
        let chart = Chart {
            title: format!(
                "{} after {}: {}, {}, {}",
                mesh.scene().name,
                counted(self.steps, "step"),
                counted_patches(mesh.patches().len()),
                counted(mesh.elements().len() as u64, "element"),
                self.form_factors
            ),
            x_label: String::from("steps"),
            y_label: String::from("RMS error of radiosity, of reflected light"),
            x_scale: Scale::Linear,
            y_scale: Scale::Logarithmic,
            curves: self.variants.iter().map(curve).collect(),
        };
        chart.draw(width, Sheet::CHART)
    }

    fn csv(&self) -> String {
        let names: Vec<&str> = self.variants.iter().map(|v| v.kind.name()).collect();
        let mut text = format!("step,{}\n", names.join(","));
        for step in 0..=self.steps {
            let of_step = |v: &Variant| {
                let index = usize::try_from(step).unwrap_or(usize::MAX);
                v.errors.get(index).map(f64::to_string).unwrap_or_default()
            };
            let errors: Vec<String> = self.variants.iter().map(of_step).collect();
            let _ = writeln!(text, "{step},{}", errors.join(","));
        }
        text
    }

    fn tell(&self, files: &[String], global: GlobalArgs) -> Result<(), Failure> {
        let mesh = self.truth.mesh();
        if global.json {
            let variants: Vec<serde_json::Value> = self
                .variants
                .iter()
                .map(|v| json!({ "solver": v.kind.name(), "error": v.errors.last() }))
                .collect();
            return print_json(&json!({
                "scene": mesh.scene().name, "steps": self.steps, "elements": mesh.elements().len(),
                "patches": mesh.patches().len(), "form_factors": self.form_factors,
                "variants": variants, "files": files,
            }));
        }
        let mut text = format!(
            "{} after {}, {}\n",
            crate::failure::one_line(&mesh.scene().name),
            counted(self.steps, "step"),
            counted_patches(mesh.patches().len())
        );
        for (variant, error) in self.variants.iter().zip(self.errors()) {
            let _ = writeln!(
                text,
                "  {:<20} error {}",
                variant.kind.name(),
                percent(error)
            );
        }
        if !files.is_empty() {
            let _ = writeln!(text, "wrote     {}", files.join(", "));
        }
        print(&text)
    }
}

/// Where things are on the sheet, in pixels.
struct Sheet {
    /// One picture.
    cell: (usize, usize),
    columns: usize,
    rows: usize,
    width: usize,
}

impl Sheet {
    /// Longest side of a picture, unless a size was asked for.
    const SIDE: u32 = 320;
    /// Pictures side by side.
    const COLUMNS: usize = 4;
    /// Between pictures.
    const GAP: usize = 16;
    /// Above each picture.
    const LABEL: usize = 48;
    /// Height of the curves, and the least width at which they can be read.
    const CHART: usize = 460;
    const CHART_WIDTH: usize = 800;

    fn new(cell: (usize, usize), count: usize) -> Self {
        // Rows as full as they can be: six are three and three.
        let rows = count.div_ceil(Self::COLUMNS).max(1);
        let columns = count.div_ceil(rows).max(1);
        let width = columns * (cell.0 + Self::GAP) + Self::GAP;
        Self {
            cell,
            columns,
            rows,
            width: width.max(Self::CHART_WIDTH),
        }
    }

    /// Upper left corner of a picture's label.
    fn place(&self, i: usize) -> (usize, usize) {
        let (column, row) = (i % self.columns, i / self.columns);
        let left = Self::GAP + column * (self.cell.0 + Self::GAP);
        (left, Self::GAP + row * self.row_height())
    }

    fn row_height(&self) -> usize {
        self.cell.1 + Self::LABEL + Self::GAP
    }

    fn chart_top(&self) -> usize {
        Self::GAP + self.rows * self.row_height()
    }

    fn height(&self) -> usize {
        self.chart_top() + Self::CHART
    }
}
