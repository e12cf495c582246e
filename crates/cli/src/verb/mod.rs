//! What the program does, one file for each verb.

pub mod adapters;
pub mod compare;
pub mod completions;
pub mod environment;
pub mod form_factors;
pub mod gallery;
pub mod info;
pub mod measure;
pub mod render;
pub mod scenes;
pub mod solve;
pub mod view;

use crate::args::{GlobalArgs, MeshArgs, SceneArgs, SolveArgs};
use crate::failure::Failure;
use crate::input::Input;
use crate::solving::{Stop, Watch, percent};
use hemicube::radiosity::{Solution, SolveOptions, SolverKind, Way};
use hemicube::scene::Scene;
use std::path::Path;
use std::time::Instant;

/// Unshot share from which values are noticeably low.
const UNFINISHED: f64 = 0.01;

/// A remark on standard error.
fn note(global: GlobalArgs, text: &str) {
    if !global.quiet {
        eprintln!("hemicube: note: {}", crate::failure::one_line(text));
    }
}

/// Refuses options of other ways to form factors than the one in use.
fn refuse_misplaced(mesh: &MeshArgs, options: &SolveOptions, scene: &Scene) -> Result<(), Failure> {
    refuse_shot_rays(mesh, options.solver)?;
    match mesh.misplaced(options.form_factors, scene) {
        Some(what) => Err(Failure::Usage(what)),
        None => Ok(()),
    }
}

/// Rays of a shot are of solvers that ask for rows of form factors.
fn refuse_shot_rays(mesh: &MeshArgs, solver: SolverKind) -> Result<(), Failure> {
    let has_shots = !matches!(solver.way(), Way::Stochastic | Way::Hierarchical);
    if mesh.shot_rays.is_some() && !has_shots {
        return Err(Failure::Usage(format!(
            "--shot-rays is of solvers that shoot, as --solver sorted-shooting; {} has no shots",
            solver.name()
        )));
    }
    Ok(())
}

/// Options for a scene that is solved afresh; says what they chose by its size.
fn options_of(
    solve: &SolveArgs,
    scene: &Scene,
    global: GlobalArgs,
) -> Result<SolveOptions, Failure> {
    let options = solve.options(scene);
    let is_stochastic = options.solver == SolverKind::Stochastic;
    if solve.noise.is_some() && !is_stochastic && options.solver != SolverKind::Hierarchical {
        return Err(Failure::Usage(format!(
            "--noise is of --solver stochastic and hierarchical; {} has none",
            options.solver.name()
        )));
    }
    if is_stochastic && solve.is_auto() {
        note(
            global,
            "a large scene: solved by --solver stochastic, which ends at a --noise",
        );
    }
    Ok(options)
}

/// The solution that a lit `.glb` holds, or that of a scene, solved now; `check` sees the scene before the work begins.
fn solution_of(
    path: &Path,
    solve: &SolveArgs,
    scene: &SceneArgs,
    global: GlobalArgs,
    start: Instant,
    check: impl FnOnce(&Scene) -> Result<(), Failure>,
) -> Result<Solution, Failure> {
    let solution = match Input::open(path)? {
        Input::Lit(solution) => {
            let given: Vec<&str> = solve.given().into_iter().chain(scene.given()).collect();
            if !given.is_empty() {
                return Err(Failure::Usage(format!(
                    "{} of {}: its light is solved already; give {} to `hemicube solve`, or leave them out",
                    given.join(", "),
                    path.display(),
                    if given.len() == 1 { "it" } else { "them" }
                )));
            }
            *solution
        }
        input => {
            let scene = input.into_scene(scene)?;
            check(&scene)?;
            let options = options_of(solve, &scene, global)?;
            refuse_misplaced(&solve.mesh, &options, &scene)?;
            let solved = Watch::new(solve, global.quiet, start).solve(scene, options)?;
            if solved.stop == Stop::Time {
                note(global, "time is up before the light is finished");
            }
            solved.solution
        }
    };
    let unshot = solution.unshot_fraction();
    if unshot > UNFINISHED {
        note(
            global,
            &format!(
                "{} of the light has not been shot yet, so values are low",
                percent(unshot)
            ),
        );
    }
    Ok(solution)
}
