//! Light that a solver keeps on the device of the window.

mod sessions;
mod shared;

use egui::Key;
use egui_kittest::kittest::Queryable;
use hemicube_gpu::Context;
use hemicube_radiosity::export::lit_glb;
use hemicube_radiosity::{MaterialEdit, Quality, SolverKind};
use hemicube_viewer::Viewer;
use hemicube_viewer::session::{Command, FactorsBy, LaneView, Phase, Settings, Watch};
use sessions::{opened, wait as wait_for};
use shared::{Window, finish, has_adapter, wait};
use std::sync::Arc;

/// In software a hemicube takes long, so a rough light is enough.
fn settings() -> Settings {
    Settings::default()
        .with_quality(Quality::Draft)
        .with_factors(FactorsBy::Gpu)
        .with_tolerance(0.3)
}

fn context() -> Option<Arc<Context>> {
    let context = has_adapter().then(|| Context::headless(None));
    context.map(|context| Arc::new(context.expect("there is an adapter")))
}

/// Whether it is on its way on a device, and has not come from there.
fn is_away(lane: &LaneView) -> bool {
    !lane.has_light()
        && lane
            .on_device
            .as_ref()
            .is_some_and(|device| device.steps > 2)
}

#[test]
fn nothing_but_progress_comes_back_until_light_is_asked_for() {
    let Some(context) = context() else { return };
    let session = opened(settings(), "cornell", Some(context.clone()));
    let away = wait_for(&session, "it solves", |snapshot, _| {
        is_away(&snapshot.lanes[0])
    });
    let lane = &away.lanes[0];
    let device = lane.on_device.as_ref().expect("it was waited for");
    assert!(device.light.is_on(&context), "of the window");
    assert_eq!(device.light_bytes, 0, "no light has come");
    let groups = lane.solution.groups().len() as u64;
    // State, seven words a channel, two readings of a clock; when the solver was made one more without a clock.
    let features = context.device.features();
    let has_clock = features.contains(wgpu::Features::TIMESTAMP_QUERY);
    let [of_step, clock] = [32 + 4 * 3 * groups * 7, 16 * u64::from(has_clock)];
    let wanted = (device.steps + 1) * of_step + device.steps * clock;
    assert_eq!(device.step_bytes, wanted, "progress");
    assert!(device.hemicubes >= device.steps, "at least one in a step");
    assert!(lane.received(0) > 0.0, "light falls on surfaces");
    let is_dark = lane.solution.irradiance(0, 0).iter().all(|&h| h == 0.0);
    assert!(is_dark, "and none of it is known here");
    let mesh = lane.solution.mesh();
    assert!(lane.watched(0, &[]).is_none(), "nobody watches");

    session.send(Command::Watch(Watch {
        elements: [Some(3), None],
        ..Watch::default()
    }));
    let seen = wait_for(&session, "it is watched", |snapshot, _| {
        snapshot.lanes[0].watched(3, &[]).is_some()
    });
    assert!(!seen.lanes[0].has_light(), "without all the others");

    session.send(Command::Bring(7));
    let brought = wait_for(&session, "light is brought", |snapshot, _| {
        snapshot.brought == 7
    });
    let lit = brought.lanes[0].solution.irradiance(0, 0);
    assert!(lit.iter().any(|&h| h > 0.0), "it is here");

    let last = wait_for(&session, "it finishes", |snapshot, status| {
        status.phase == Phase::Finished && snapshot.lanes[0].is_finished
    });
    let lane = &last.lanes[0];
    assert!(lane.has_light(), "it comes when the solver rests");
    let solution = &lane.solution;
    for band in 0..3 {
        let balance = solution.total_balance(band);
        let error = balance.relative_error(solution.unshot_flux(band));
        assert!(error < 1e-4, "none was lost on the way: {error}");
    }
    let watched = lane.watched(3, &[]).expect("still");
    let known = solution.element_irradiance(3);
    let off = (watched - known).map(f32::abs).max_band();
    assert!(off <= 0.02 * known.max_band(), "{watched:?} {known:?}");
    assert_eq!(
        mesh.elements().len(),
        solution.mesh().elements().len(),
        "one mesh"
    );
    assert_eq!(session.status().note, None, "nothing fell back to the CPU");
}

#[test]
fn the_estimate_of_light_to_come_is_that_of_the_solution() {
    let Some(context) = context() else { return };
    let session = opened(
        settings().with_solver(SolverKind::AmbientShooting),
        "cornell",
        Some(context),
    );
    let last = wait_for(&session, "it finishes", |snapshot, status| {
        status.phase == Phase::Finished && snapshot.lanes[0].is_finished
    });
    let lane = &last.lanes[0];
    assert!(lane.on_device.is_some(), "it was solved there");
    let known = hemicube_radiosity::solve::ambient_irradiance(&lane.solution);
    let off = (lane.ambient - known).map(f32::abs).max_band();
    assert!(
        off < 2e-3 * known.max_band(),
        "{:?} {known:?}",
        lane.ambient
    );
}

#[test]
fn the_cpu_takes_over_when_the_device_is_lost() {
    let Some(context) = context() else { return };
    let session = opened(settings(), "cornell", Some(context.clone()));
    wait_for(&session, "it solves", |snapshot, _| {
        is_away(&snapshot.lanes[0])
    });
    context.device.destroy();
    let last = wait_for(&session, "the CPU finishes", |snapshot, status| {
        status.phase == Phase::Finished && snapshot.lanes[0].is_finished
    });
    let lane = &last.lanes[0];
    assert!(lane.on_device.is_none(), "on the CPU");
    assert!(
        lane.progress.unshot <= 0.3,
        "to the end: {:?}",
        lane.progress
    );
    let note = session.status().note.expect("one line says so");
    assert!(
        note.contains("the CPU's hemicubes") && !note.contains('\n'),
        "{note}"
    );
    for band in 0..3 {
        let balance = lane.solution.total_balance(band);
        let error = balance.relative_error(lane.solution.unshot_flux(band));
        assert!(error < 1e-4, "what the device had is not counted: {error}");
    }
}

fn of(window: &Window) -> &Viewer {
    window.state().as_ref().expect("a frame was shown")
}

fn lane(viewer: &Viewer) -> Option<&LaneView> {
    viewer.desk.snapshot.as_ref().map(|s| &s.lanes[0])
}

/// Bytes of the picture in the middle of the window; written as a file where a folder for such is named.
fn picture(window: &mut Window, name: &str) -> Vec<u8> {
    wait(window, "it is at rest", |viewer| {
        viewer.desk.is_still() && viewer.is_up_to_date()
    });
    window.run_steps(3);
    let picture = window.render().expect("it can be drawn");
    if let Ok(folder) = std::env::var("HEMICUBE_PICTURES") {
        let path = std::path::Path::new(&folder).join(format!("{name}.png"));
        picture.save(path).expect("a picture");
    }
    let middle = (340..640).flat_map(|x| (100..540).map(move |y| (x, y)));
    middle
        .flat_map(|(x, y)| picture.get_pixel(x, y).0)
        .collect()
}

/// The window shows the light that came from the device in place of that which lies there.
fn show_what_was_brought(window: &mut Window) {
    let desk = &mut window.state_mut().as_mut().expect("a frame was shown").desk;
    let mut snapshot = (**desk.snapshot.as_ref().expect("there is light")).clone();
    snapshot.lanes[0].on_device = None;
    desk.snapshot = Some(Arc::new(snapshot));
    desk.light_serial += 1;
    wait(window, "it is drawn", Viewer::is_up_to_date);
}

#[test]
fn pictures_of_light_on_the_device_are_those_of_light_that_was_brought() {
    let tried = settings().with_solver(SolverKind::AmbientShooting);
    let Some((mut window, _)) = shared::window("cornell", tried) else {
        return;
    };
    wait(&mut window, "it is seen while it is solved", |viewer| {
        lane(viewer).is_some_and(is_away) && viewer.desk.is_metered() && viewer.is_up_to_date()
    });
    window.key_press(Key::Space);
    wait(&mut window, "it pauses", |viewer| {
        viewer.desk.status.phase == Phase::Paused
            && lane(viewer).is_some_and(LaneView::has_light)
            && viewer.is_up_to_date()
    });
    let unshot = lane(of(&window)).map(|lane| lane.progress.unshot);
    assert!(
        unshot.is_some_and(|unshot| unshot > 0.3),
        "half way: {unshot:?}"
    );
    let dims: Vec<_> = of(&window).desk.mixer.dims();
    for level in [1.0, 0.25] {
        let desk = &mut window.state_mut().as_mut().expect("a frame was shown").desk;
        desk.mixer.sources[0].level = level;
        wait(&mut window, "it is dimmed", |viewer| {
            viewer.is_up_to_date() && (level == 1.0 || viewer.desk.panes[0].dims != dims)
        });
        // The status bar says where the light is.
        window.get_by_label("light on the device");
        let there = picture(&mut window, &format!("there-{level}"));
        show_what_was_brought(&mut window);
        let here = picture(&mut window, &format!("here-{level}"));
        let differ = there.iter().zip(&here).filter(|(a, b)| a != b).count();
        assert_eq!(differ, 0, "level {level}: bytes of {}", there.len());
        let mut values = there;
        values.sort_unstable();
        values.dedup();
        assert!(values.len() > 64, "there is something to see");
        window.key_press(Key::Num0);
        let desk = &mut window.state_mut().as_mut().expect("a frame was shown").desk;
        desk.snapshot = None;
        wait(&mut window, "the newest light comes again", |viewer| {
            lane(viewer).is_some_and(|lane| lane.on_device.is_some()) && viewer.is_up_to_date()
        });
    }
}

#[test]
fn files_wait_for_light_that_a_device_keeps() {
    let Some((mut window, _)) = shared::window("cornell", settings()) else {
        return;
    };
    wait(&mut window, "it solves", |viewer| {
        lane(viewer).is_some_and(is_away)
    });
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("lit.glb");
    let desk = &mut window.state_mut().as_mut().expect("a frame was shown").desk;
    desk.picked(hemicube_viewer::desk::Pick::SaveLit, path.clone());
    wait(&mut window, "it is written", |_| path.is_file());
    let bytes = std::fs::read(&path).expect("it is there");
    let lit = lit_glb::read(&bytes).expect("it is whole");
    let light = lit.irradiance(0, 0).iter().any(|&h| h > 0.0);
    assert!(light, "with the light that was on the device");
    finish(&mut window);
}

#[test]
fn an_edit_goes_on_from_the_light_on_the_device() {
    let Some(context) = context() else { return };
    let session = opened(settings(), "cornell", Some(context));
    let before = wait_for(&session, "it solves", |snapshot, _| {
        is_away(&snapshot.lanes[0])
    });
    let materials = &before.mesh().scene().materials;
    let lamp = materials.iter().position(|m| m.emits()).expect("a lamp");
    let emission = materials[lamp].emission * 0.5;
    session.send(Command::Edit(
        MaterialEdit::new(lamp).with_emission(emission),
    ));
    let last = wait_for(&session, "it finishes", |snapshot, status| {
        status.phase == Phase::Finished
            && snapshot.lanes[0].is_finished
            && snapshot.mesh().scene().materials[lamp].emission == emission
    });
    let lane = &last.lanes[0];
    assert!(lane.on_device.is_some(), "on the device again");
    assert_eq!(last.geometry, before.geometry, "of the same mesh");
    let steps = lane.progress.iteration;
    assert!(steps > before.lanes[0].progress.iteration, "it goes on");
    for band in 0..3 {
        let balance = lane.solution.total_balance(band);
        let error = balance.relative_error(lane.solution.unshot_flux(band));
        assert!(error < 1e-4, "{error}");
    }
}
