//! `hemicube solve`: from a scene to its light.

use super::{note, options_of, refuse_misplaced, refuse_shot_rays};
use crate::args::{GlobalArgs, SolveVerb};
use crate::failure::Failure;
use crate::history;
use crate::input::Input;
use crate::interrupt;
use crate::links;
use crate::output::{Target, print, print_json};
use crate::picture;
use crate::report::{Report, grouped, peak_memory};
use crate::solving::{Solved, Stop, Watch, percent};
use hemicube::radiosity::export::lit_glb::{LitGlb, LitGlbOptions};
use hemicube::radiosity::solve::ambient_irradiance;
use hemicube::radiosity::{Solution, SolverKind};
use hemicube::raster::Rgb;
use std::path::Path;
use std::time::Instant;

/// Solves and writes what was asked for.
pub fn run(args: &SolveVerb, global: GlobalArgs, start: Instant) -> Result<(), Failure> {
    let targets = Targets::check(args)?;
    interrupt::listen();
    let solved = solve(args, global, start)?;
    let report = Report::new(&solved);
    targets.write(args, &solved, &report, global)?;
    let files = targets.names();
    if global.json {
        let mut json = report.to_json();
        json["peak_memory_bytes"] = peak_memory().into();
        json["files"] = files.clone().into();
        print_json(&json)?;
    } else {
        let wrote = if files.is_empty() {
            String::new()
        } else {
            format!("wrote     {}\n", files.join(", "))
        };
        print(&(report.text() + &wrote))?;
    }
    tell_of_faces(args, &solved, global);
    tell_how_it_ended(args, &solved, global);
    if solved.stop == Stop::Interrupt && files.is_empty() {
        return Err(Failure::Interrupted);
    }
    Ok(())
}

fn solve(args: &SolveVerb, global: GlobalArgs, start: Instant) -> Result<Solved, Failure> {
    let of_solver = args.solve.without_gpu_of_picture(args.picture.uses_gpu());
    let watch = Watch::new(&of_solver, global.quiet, start)
        .with_history(args.convergence.is_some())
        .with_links(args.links.is_some());
    let Some(lit) = &args.resume else {
        let path = args
            .scene
            .as_deref()
            .expect("clap wants a scene unless there is --resume");
        let input = Input::open(path)?;
        if matches!(input, Input::Lit(_)) {
            note(
                global,
                &format!(
                    "{0} is solved afresh; --resume {0} goes on with its light",
                    path.display()
                ),
            );
        }
        let scene = input.into_scene(&args.scene_options)?;
        picture::check(&scene, &args.picture)?;
        let options = options_of(&args.solve, &scene, global)?;
        refuse_misplaced(&args.solve.mesh, &options, &scene)?;
        refuse_links(args, options.solver)?;
        return watch.solve(scene, options);
    };
    refuse_changes(args, lit)?;
    let solution = Input::open_lit(lit)?;
    picture::check(solution.mesh().scene(), &args.picture)?;
    let options = args.solve.options_to_resume(&solution.provenance);
    refuse_shot_rays(&args.solve.mesh, options.solver)?;
    if let Some(what) = args.solve.mesh.misplaced_in_steps(options.form_factors) {
        return Err(Failure::Usage(what));
    }
    refuse_links(args, options.solver)?;
    let unshot = solution.unshot_fraction();
    if unshot <= options.tolerance && options.adaptive.is_none() {
        let (unshot, tolerance) = (percent(unshot), options.tolerance);
        note(
            global,
            &format!(
                "nothing to do: only {unshot} of the light is unshot; go further with --tolerance below {tolerance}"
            ),
        );
    }
    watch.resume(solution, options)
}

/// Links are of one solver.
fn refuse_links(args: &SolveVerb, solver: SolverKind) -> Result<(), Failure> {
    if args.links.is_some() && solver != SolverKind::Hierarchical {
        return Err(Failure::Usage(format!(
            "--links is of --solver hierarchical; {} has none",
            solver.name()
        )));
    }
    Ok(())
}

/// With `--resume` scene and mesh are those of the file.
fn refuse_changes(args: &SolveVerb, lit: &Path) -> Result<(), Failure> {
    let refused = |what: String| {
        let file = lit.display();
        Err(Failure::Usage(format!(
            "{what} --resume: scene and mesh are those of {file}; solve the scene afresh to change them"
        )))
    };
    if let Some(scene) = args
        .scene
        .as_deref()
        .filter(|scene| !is_same_file(scene, lit))
    {
        return refused(format!("another scene ({}) with", scene.display()));
    }
    let given: Vec<&str> = args
        .scene_options
        .given()
        .into_iter()
        .chain(args.solve.mesh.mesh_given())
        .collect();
    if given.is_empty() {
        Ok(())
    } else {
        refused(format!("{} with", given.join(", ")))
    }
}

fn is_same_file(a: &Path, b: &Path) -> bool {
    a == b || matches!((a.canonicalize(), b.canonicalize()), (Ok(a), Ok(b)) if a == b)
}

/// Says why there are more elements than were asked for.
fn tell_of_faces(args: &SolveVerb, solved: &Solved, global: GlobalArgs) {
    let mesh = solved.solution.mesh();
    let (made, sides) = (mesh.unrefined_elements(), mesh.lit_sides());
    let Some(asked) = args.solve.mesh.elements.map(|asked| asked as usize) else {
        return;
    };
    if made > asked + asked / 20 && 3 * asked < 4 * sides {
        let [asked, made, sides] = [asked, made, sides].map(|n| grouped(n as u64));
        note(
            global,
            &format!(
                "{made} elements in place of {asked}: faces have {sides} lit sides, each at least one element"
            ),
        );
    }
}

fn tell_how_it_ended(args: &SolveVerb, solved: &Solved, global: GlobalArgs) {
    let why = match solved.stop {
        Stop::Finished | Stop::Iterations => return,
        Stop::Time => "time is up: ",
        Stop::Interrupt => "",
    };
    let written = match (&args.output, &args.image) {
        (Some(lit), _) => format!("written as it is; go on with --resume {}", lit.display()),
        (None, Some(_)) => String::from("drawn as it is; with -o it could be resumed"),
        (None, None) => String::from("nothing is written; with -o it could be resumed"),
    };
    let (steps, unshot) = (
        solved.solution.provenance.steps,
        percent(solved.solution.unshot_fraction()),
    );
    note(
        global,
        &format!("{why}stopped at {steps} steps, {unshot} unshot: {written}"),
    );
}

/// The files that were asked for, checked before the work begins.
struct Targets {
    lit: Option<Target>,
    image: Option<Target>,
    convergence: Option<Target>,
    links: Option<Target>,
}

impl Targets {
    fn check(args: &SolveVerb) -> Result<Self, Failure> {
        let lit = args
            .output
            .as_deref()
            .map(|path| Target::check(path, &["glb"]))
            .transpose()?;
        let image = args
            .image
            .as_deref()
            .map(|path| Target::check(path, picture::ENDINGS))
            .transpose()?;
        if let Some(target) = &image {
            picture::refuse_mesh_in(target, &args.picture)?;
        }
        let convergence = args
            .convergence
            .as_deref()
            .map(|path| Target::check(path, history::ENDINGS))
            .transpose()?;
        let links = args
            .links
            .as_deref()
            .map(|path| Target::check(path, links::ENDINGS))
            .transpose()?;
        let view = args.picture.view_given();
        if image.is_none() && links.is_none() && !view.is_empty() {
            return Err(Failure::Usage(format!(
                "{} without a picture; name one with --image FILE.png",
                view.join(", ")
            )));
        }
        let tones = args.picture.tones_given();
        if image.is_none() && lit.is_none() && !tones.is_empty() {
            return Err(Failure::Usage(format!(
                "{} without a file to write; name one with -o or --image",
                tones.join(", ")
            )));
        }
        Ok(Self {
            lit,
            image,
            convergence,
            links,
        })
    }

    fn write(
        &self,
        args: &SolveVerb,
        solved: &Solved,
        report: &Report,
        global: GlobalArgs,
    ) -> Result<(), Failure> {
        let solution = &solved.solution;
        if let Some(target) = &self.lit {
            let options = LitGlbOptions {
                exposure: args.picture.exposure.unwrap_or_default(),
                tone_map: args.picture.tonemap.unwrap_or_default(),
                ambient: ambient_for_display(solution),
                report: report.to_json(),
            };
            let file = LitGlb::new(solution, &options)?;
            target.write_with(|out| file.write_to(out))?;
        }
        if let Some(target) = &self.image {
            let gpu = &args.solve.mesh.gpu;
            picture::View::new(solution, &args.picture)?.draw(solution, target, gpu, global)?;
        }
        if let Some(target) = &self.links {
            let view = picture::View::new(solution, &args.picture)?;
            links::write(&solved.links, solution, &view, target)?;
        }
        if let (Some(target), Some(history)) = (&self.convergence, &solved.history) {
            history.write(solution, target)?;
        }
        Ok(())
    }

    fn names(&self) -> Vec<String> {
        [&self.lit, &self.image, &self.convergence, &self.links]
            .into_iter()
            .flatten()
            .map(|t| t.path.display().to_string())
            .collect()
    }
}

/// The estimate of the light to come, where the solver is the one that shows it.
fn ambient_for_display(solution: &Solution) -> Rgb {
    if solution.provenance.solver == SolverKind::AmbientShooting.name() {
        ambient_irradiance(solution)
    } else {
        Rgb::BLACK
    }
}
