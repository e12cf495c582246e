//! `hemicube info`: what is in a scene, and why it would stay black or leak light.

mod device;
mod facts;
mod hints;
mod probe;

use crate::args::{GlobalArgs, InfoVerb};
use crate::failure::Failure;
use crate::input::Input;
use crate::output::{print, print_json};
use facts::Facts;
use hemicube::radiosity::{PatchMesh, RadiosityError, SolveOptions};
use hemicube::scene::Scene;
use probe::Probe;
use std::sync::Arc;

/// Prints everything that is known.
pub fn run(args: &InfoVerb, global: GlobalArgs) -> Result<(), Failure> {
    let facts = match Input::open(&args.scene)? {
        Input::Lit(solution) if args.scene_options.given().is_empty() => {
            let mut facts = of_mesh(solution.mesh());
            facts.add_solution(&solution);
            facts
        }
        input => of_scene(input.into_scene(&args.scene_options)?)?,
    };
    if global.json {
        print_json(&facts.to_json())
    } else {
        print(&facts.text())
    }
}

fn of_scene(scene: Scene) -> Result<Facts, Failure> {
    let scene = Arc::new(scene);
    match PatchMesh::build(scene.clone(), SolveOptions::default().mesh) {
        Ok(mesh) => Ok(of_mesh(&Arc::new(mesh))),
        Err(error @ RadiosityError::NoSurfaces(_)) => {
            let mut facts = Facts::of_scene(&scene);
            facts.hints = vec![error.to_string()];
            Ok(facts)
        }
        Err(error) => Err(error.into()),
    }
}

fn of_mesh(mesh: &Arc<PatchMesh>) -> Facts {
    let probe = Probe::new(mesh);
    let mut facts = Facts::of_scene(mesh.scene());
    facts.add_mesh(mesh, &probe);
    facts.hints = hints::of(mesh, &probe);
    facts
}
