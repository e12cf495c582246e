//! The solver's thread: opening, stepping, editing, changing its ways, without a window.

mod sessions;

use hemicube_radiosity::{MaterialEdit, PatchMesh, Quality, SolverKind, solve};
use hemicube_raster::Rgb;
use hemicube_scene::builtin;
use hemicube_viewer::session::{
    Command, FactorsBy, Phase, Refinement, Session, Settings, Snapshot, Source, VARIANTS, Watch,
};
use sessions::{opened, wait};
use std::sync::Arc;
use std::time::Duration;

fn draft() -> Settings {
    Settings::default()
        .with_quality(Quality::Draft)
        .with_tolerance(1e-3)
}

fn finished(session: &Session) -> Arc<Snapshot> {
    wait(session, "it finishes", |snapshot, status| {
        status.phase == Phase::Finished && snapshot.lanes.iter().all(|lane| lane.is_finished)
    })
}

fn material(mesh: &PatchMesh, name: &str) -> usize {
    let found = mesh.scene().materials.iter().position(|m| m.name == name);
    found.unwrap_or_else(|| panic!("no material '{name}'"))
}

#[test]
fn light_arrives_until_it_is_found() {
    let session = opened(draft(), "cornell", None);
    let first = wait(&session, "it opens", |_, _| true);
    let last = finished(&session);
    assert!(last.serial > first.serial, "more than one picture");
    assert_eq!(last.geometry, first.geometry, "of the same mesh");
    let lane = &last.lanes[0];
    assert!(
        lane.progress.unshot <= 1e-3 && lane.progress.iteration > 50,
        "{:?}",
        lane.progress
    );
    let unshot: Vec<f64> = lane.history.moments().iter().map(|m| m.unshot).collect();
    assert!(
        unshot.len() > 2 && unshot.is_sorted_by(|a, b| a >= b),
        "it falls: {unshot:?}"
    );
    assert_eq!(session.status().scene, "cornell", "its name");
    assert_eq!(session.status().error, None, "nothing went wrong");
}

#[test]
fn a_step_is_one_step() {
    let session = opened(draft(), "cornell", None);
    session.send(Command::Pause);
    wait(&session, "it opens", |_, _| true);
    session.send(Command::Pause);
    let before = wait(&session, "it pauses", |_, status| {
        status.phase == Phase::Paused
    });
    let before = session.snapshot().unwrap_or(before).lanes[0]
        .progress
        .iteration;
    session.send(Command::Step);
    let after = wait(&session, "it steps", |s, status| {
        s.lanes[0].progress.iteration > before && status.phase == Phase::Paused
    });
    assert_eq!(after.lanes[0].progress.iteration, before + 1, "one shot");
    assert!(
        after.lanes[0].shooter.is_some(),
        "it knows whose turn is next"
    );
    std::thread::sleep(Duration::from_millis(100));
    let later = session.snapshot().expect("there is light");
    assert_eq!(later.lanes[0].progress.iteration, before + 1, "and no more");
    session.send(Command::Restart);
    finished(&session);
}

#[test]
fn an_edit_ends_where_solving_the_edited_scene_does() {
    let settings = draft();
    let session = opened(settings, "cornell", None);
    let before = finished(&session);
    let lamp = material(before.mesh(), "light");
    let red = material(before.mesh(), "red");
    let emission = before.mesh().scene().materials[lamp].emission * 0.25;
    let paint = Rgb::new(0.1, 0.2, 0.7);
    session.send(Command::Edit(
        MaterialEdit::new(lamp).with_emission(emission),
    ));
    session.send(Command::Edit(MaterialEdit::new(red).with_base_color(paint)));
    let after = wait(&session, "it is edited", |snapshot, status| {
        snapshot.mesh().scene().materials[red].base_color == paint
            && snapshot.mesh().scene().materials[lamp].emission == emission
            && status.phase == Phase::Finished
            && snapshot.lanes[0].is_finished
    });
    assert_eq!(after.geometry, before.geometry, "the mesh is the same");
    let mut scene = builtin::scene("cornell").expect("it is built in");
    scene.materials[lamp].emission = emission;
    scene.materials[red].base_color = paint;
    let scratch =
        solve(Arc::new(scene), &settings.solve_options(), |_, _| true).expect("it can be solved");
    let apart = (0..scratch.mesh().elements().len()).map(|e| {
        let (a, b) = (
            after.lanes[0].solution.element_irradiance(e),
            scratch.element_irradiance(e),
        );
        (a - b).map(f32::abs).max_band()
    });
    let most =
        (0..scratch.mesh().elements().len()).map(|e| scratch.element_irradiance(e).max_band());
    let (apart, most) = (apart.fold(0.0, f32::max), most.fold(0.0, f32::max));
    // Both leave 1e-3 of the flux unshot, in other places.
    assert!(apart < 1e-2 * most, "{apart} of {most}");
}

#[test]
fn what_starts_to_emit_has_a_source_of_its_own() {
    let session = opened(draft(), "cornell", None);
    let before = finished(&session);
    let green = material(before.mesh(), "green");
    assert_eq!(before.source_of_material[green], None, "it is dark");
    session.send(Command::Edit(
        MaterialEdit::new(green).with_emission(Rgb::splat(2.0)),
    ));
    let after = wait(&session, "it glows", |snapshot, _| {
        snapshot.source_of_material[green].is_some()
    });
    let group = after.source_of_material[green].expect("it was waited for");
    let groups = after.lanes[0].solution.groups();
    assert_eq!(groups[group].name, "green", "{groups:?}");
    assert_eq!(
        groups.len(),
        before.lanes[0].solution.groups().len() + 1,
        "one more"
    );
}

#[test]
fn another_way_goes_on_from_the_light_that_there_is() {
    let session = opened(draft(), "cornell", None);
    let shot = wait(&session, "half of it is shot", |snapshot, _| {
        snapshot.lanes[0].progress.unshot < 0.3
    });
    let settings = draft().with_solver(SolverKind::GaussSeidel);
    session.send(Command::Configure(settings));
    let swept = wait(&session, "it is swept", |snapshot, _| {
        snapshot.lanes[0].kind == SolverKind::GaussSeidel
    });
    assert!(
        swept.lanes[0].progress.unshot <= shot.lanes[0].progress.unshot + 1e-6,
        "nothing is lost"
    );
    finished(&session);
    for by in [FactorsBy::Hemicubes, FactorsBy::Rays] {
        session.send(Command::Configure(
            draft()
                .with_factors(by)
                .with_solver(SolverKind::Overshooting),
        ));
        let other = wait(&session, "it goes on", |snapshot, status| {
            snapshot.lanes[0].kind == SolverKind::Overshooting && status.phase == Phase::Finished
        });
        assert!(other.lanes[0].progress.unshot <= 1e-3, "{by:?}");
    }
    assert_eq!(session.status().error, None, "nothing went wrong");
}

#[test]
fn a_gpu_goes_on_where_the_cpu_was() {
    let adapters = hemicube_gpu::adapters();
    if adapters.iter().all(|adapter| adapter.usable.is_err()) {
        assert!(std::env::var_os("CI").is_none(), "CI has an adapter");
        println!("skipped: no adapter on this machine");
        return;
    }
    // In software a hemicube takes long, so a rough light is enough.
    let rough = draft().with_tolerance(0.4);
    let session = opened(rough.with_tolerance(0.6), "cornell", None);
    let shot = finished(&session);
    session.send(Command::Configure(rough.with_factors(FactorsBy::Gpu)));
    let on_gpu = wait(&session, "the GPU finishes", |snapshot, status| {
        snapshot.lanes[0].shooter.is_none() && status.phase == Phase::Finished
    });
    let steps = |snapshot: &Snapshot| snapshot.lanes[0].progress.iteration;
    assert!(steps(&on_gpu) > steps(&shot), "it goes on, not anew");
    assert!(
        on_gpu.lanes[0].progress.unshot <= 0.4,
        "until little is left"
    );
    let solution = &on_gpu.lanes[0].solution;
    for band in 0..3 {
        let balance = solution.total_balance(band);
        let error = balance.relative_error(solution.unshot_flux(band));
        assert!(error < 1e-3, "light is kept on the way: {error}");
    }
    assert_eq!(session.status().note, None, "nothing fell back to the CPU");
}

#[test]
fn four_variants_take_the_same_steps() {
    // None of them is to be at its end when it is looked at.
    let settings = draft().with_side_by_side(true).with_tolerance(1e-9);
    let session = opened(settings, "cornell", None);
    let snapshot = wait(&session, "they run", |snapshot, _| {
        snapshot.lanes.len() == 4 && snapshot.lanes[0].progress.iteration >= 40
    });
    let kinds: Vec<SolverKind> = snapshot.lanes.iter().map(|lane| lane.kind).collect();
    assert_eq!(kinds, VARIANTS, "in the order of the figure");
    let steps: Vec<u64> = snapshot
        .lanes
        .iter()
        .map(|lane| lane.progress.iteration)
        .collect();
    assert!(steps.iter().all(|&s| s == steps[0]), "{steps:?}");
    let ambient: Vec<bool> = snapshot
        .lanes
        .iter()
        .map(|lane| !lane.ambient.is_black())
        .collect();
    assert_eq!(
        ambient,
        [false, false, false, true],
        "only the last one estimates"
    );
    let mean = |i: usize| {
        let solution = &snapshot.lanes[i].solution;
        let elements = 0..solution.mesh().elements().len();
        elements
            .map(|e| f64::from(solution.element_irradiance(e).luminance()))
            .sum::<f64>()
    };
    assert!(
        mean(2) >= mean(1),
        "the brightest first brings light faster"
    );
    session.send(Command::Configure(draft()));
    let one = wait(&session, "one is left", |snapshot, _| {
        snapshot.lanes.len() == 1
    });
    assert_eq!(one.geometry, snapshot.geometry, "on the same mesh");
}

#[test]
fn the_error_is_known_once_the_light_is() {
    let session = opened(draft(), "cornell", None);
    finished(&session);
    session.send(Command::Restart);
    session.send(Command::Configure(
        draft().with_solver(SolverKind::Shooting),
    ));
    let snapshot = wait(&session, "it runs again", |snapshot, _| {
        snapshot.lanes[0].kind == SolverKind::Shooting && snapshot.lanes[0].progress.unshot < 0.01
    });
    let errors: Vec<f64> = snapshot.lanes[0]
        .history
        .moments()
        .iter()
        .filter_map(|m| m.error)
        .collect();
    let (first, last) = (
        errors.first().expect("errors"),
        errors.last().expect("errors"),
    );
    assert!(*first > 0.3 && *last < 0.05, "{errors:?}");
}

#[test]
fn figures_come_when_they_are_asked_for() {
    let session = opened(draft(), "cornell", None);
    session.send(Command::Watch(Watch {
        hemicube: true,
        row_of: Some(3),
        ..Watch::default()
    }));
    let snapshot = wait(&session, "they come", |snapshot, _| {
        snapshot.hemicube.is_some() && snapshot.row.is_some()
    });
    let row = snapshot.row.as_ref().expect("it was waited for");
    let sum: f32 = row.fractions.iter().sum();
    assert!(
        row.patch == 3 && (0.5..1.001).contains(&sum),
        "what leaves a patch of a box with an open front: {sum}"
    );
    let hemicube = snapshot.hemicube.as_ref().expect("it was waited for");
    assert_eq!(hemicube.buffers.faces.len(), 5, "a top and four sides");
    session.send(Command::Watch(Watch::default()));
    wait(&session, "they go", |snapshot, _| {
        snapshot.hemicube.is_none() && snapshot.row.is_none()
    });
}

#[test]
fn what_cannot_be_opened_leaves_the_light_that_there_is() {
    let session = opened(draft(), "cornell", None);
    finished(&session);
    for (name, says) in [
        ("no-such-scene.glb", "no-such-scene.glb"),
        ("parallel-platez", "parallel-platez"),
        ("/", "/"),
    ] {
        session.send(Command::Open(Source::Named(name.to_owned())));
        wait(&session, name, |_, status| {
            status
                .error
                .as_ref()
                .is_some_and(|error| error.contains(says))
        });
        let status = session.status();
        let error = status.error.expect("it was waited for");
        assert_eq!(error.lines().count(), 1, "one line: {error}");
        assert_eq!(status.scene, "cornell", "the old one stays");
        session.dismiss_error();
    }
    session.send(Command::Open(Source::Named(String::from("furnace"))));
    wait(&session, "another opens", |_, status| {
        status.scene == "furnace"
    });
}

#[test]
fn a_cancelled_scene_does_not_come() {
    let session = opened(draft(), "cornell", None);
    let before = finished(&session);
    session.send(Command::Open(Source::Named(String::from("office"))));
    session.send(Command::Cancel);
    std::thread::sleep(Duration::from_millis(400));
    let after = session.snapshot().expect("the light stays");
    assert_eq!(after.geometry, before.geometry, "the old one");
    assert!(session.status().opening.is_none(), "nothing is on its way");
}

#[test]
fn a_finer_mesh_starts_anew_and_keeps_edits() {
    let session = opened(draft(), "cornell", None);
    let before = finished(&session);
    let lamp = material(before.mesh(), "light");
    session.send(Command::Edit(
        MaterialEdit::new(lamp).with_emission(Rgb::splat(3.0)),
    ));
    wait(&session, "it is edited", |s, _| {
        s.mesh().scene().materials[lamp].emission == Rgb::splat(3.0)
    });
    session.send(Command::Configure(
        Settings::default().with_quality(Quality::Normal),
    ));
    let after = wait(&session, "it is finer", |snapshot, _| {
        snapshot.geometry != before.geometry
    });
    assert!(
        after.mesh().elements().len() > 2 * before.mesh().elements().len(),
        "more elements"
    );
    assert_eq!(
        after.mesh().scene().materials[lamp].emission,
        Rgb::splat(3.0),
        "the lamp as edited"
    );
}

#[test]
fn an_edit_that_cannot_be_is_refused_in_words() {
    let session = opened(draft(), "cornell", None);
    finished(&session);
    let before = session.snapshot().expect("there is light");
    let edit = MaterialEdit::new(999).with_emission(Rgb::WHITE);
    session.send(Command::Edit(edit));
    wait(&session, "it is refused", |_, status| {
        status
            .error
            .as_ref()
            .is_some_and(|e| e.contains("material 999 of"))
    });
    let after = session.snapshot().expect("there is light");
    assert_eq!(after.geometry, before.geometry, "the light stays");
}

/// Refined until neighbours differ by less than usual, which takes one round on so coarse a mesh.
fn refining() -> Refinement {
    Refinement {
        contrast: 0.3,
        most_elements: 3000,
        ..Refinement::default()
    }
}

#[test]
fn the_mesh_is_refined_once_the_light_is_found() {
    let session = opened(draft(), "cornell", None);
    let before = finished(&session);
    session.send(Command::Refine(Some(refining())));
    let after = wait(&session, "it is refined", |snapshot, status| {
        snapshot.geometry != before.geometry
            && snapshot.lanes[0].is_finished
            && status.phase == Phase::Finished
    });
    let lane = &after.lanes[0];
    let elements = |snapshot: &Snapshot| snapshot.mesh().elements().len();
    let (coarse, fine) = (elements(&before), elements(&after));
    assert!(fine > coarse && fine <= 3000, "{coarse} {fine}");
    let patches = |snapshot: &Snapshot| snapshot.mesh().patches().len();
    assert_eq!(patches(&after), patches(&before), "they stay");
    assert!(lane.progress.unshot <= 1e-3, "{:?}", lane.progress);
    assert!(session.status().opening.is_none(), "it is here");
    for band in 0..3 {
        // What new elements receive is estimated by rays of their own.
        let [old, new] = [&before, &after].map(|snapshot| {
            let solution = &snapshot.lanes[0].solution;
            let mesh = solution.mesh();
            let light = solution.irradiance(0, band).iter().enumerate();
            let flux = light.map(|(e, &h)| f64::from(h) * f64::from(mesh.exposed_area(e)));
            flux.sum::<f64>()
        });
        assert!((new / old - 1.0).abs() < 0.02, "{old} {new}");
    }
    let moments = |snapshot: &Snapshot| snapshot.lanes[0].history.moments().len();
    assert!(moments(&after) >= moments(&before), "its history goes on");

    // An edit goes on on the finer mesh; a restart goes back to the first.
    let lamp = material(after.mesh(), "light");
    let emission = after.mesh().scene().materials[lamp].emission * 0.5;
    session.send(Command::Refine(None));
    session.send(Command::Edit(
        MaterialEdit::new(lamp).with_emission(emission),
    ));
    let edited = wait(&session, "it is edited", |snapshot, status| {
        snapshot.mesh().scene().materials[lamp].emission == emission
            && snapshot.lanes[0].is_finished
            && status.phase == Phase::Finished
    });
    assert_eq!(edited.geometry, after.geometry, "of the finer mesh");
    session.send(Command::Restart);
    let again = wait(&session, "it starts again", |snapshot, _| {
        snapshot.geometry != after.geometry
    });
    assert_eq!(elements(&again), coarse, "on the first mesh");
    let materials = &again.mesh().scene().materials;
    assert_eq!(materials[lamp].emission, emission, "as edited");
    finished(&session);
    assert_eq!(session.status().error, None, "nothing went wrong");
}

#[test]
fn a_cancelled_refinement_does_not_come_and_an_edit_makes_it_void() {
    let session = opened(draft(), "cornell", None);
    let before = finished(&session);
    let fine = Refinement {
        contrast: 0.02,
        ..refining()
    };
    session.send(Command::Refine(Some(fine)));
    wait(&session, "it is on its way", |_, status| {
        status.opening.is_some()
    });
    session.send(Command::Cancel);
    wait(&session, "it is not", |_, status| status.opening.is_none());
    std::thread::sleep(Duration::from_millis(300));
    let after = session.snapshot().expect("the light stays");
    assert_eq!(after.geometry, before.geometry, "of the first mesh");
    assert!(session.status().opening.is_none(), "and is not tried again");
    let lamp = material(before.mesh(), "light");
    let emission = before.mesh().scene().materials[lamp].emission * 2.0;
    session.send(Command::Edit(
        MaterialEdit::new(lamp).with_emission(emission),
    ));
    let refined = wait(&session, "the edited light is refined", |snapshot, _| {
        snapshot.geometry != before.geometry
    });
    let lit = &refined.mesh().scene().materials[lamp];
    assert_eq!(lit.emission, emission, "as edited");
}
