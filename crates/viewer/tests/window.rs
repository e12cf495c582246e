//! The window's panels, buttons and keys, and its picture on whatever adapter there is.

use egui::accesskit::Role;
use egui::{Event, Key, Modifiers, Pos2, Ui, Vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use hemicube_radiosity::{Quality, SolverKind};
use hemicube_viewer::desk::{Answer, Desk, Pick};
use hemicube_viewer::display::Quantity;
use hemicube_viewer::session::{FactorsBy, Phase, Refinement, Settings, VARIANTS};
use hemicube_viewer::walk::EyeMode;
use hemicube_viewer::{ViewOptions, Viewer};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

type Window = Harness<'static, Option<Viewer>>;

fn options(scene: &str) -> ViewOptions {
    ViewOptions {
        scene: scene.to_owned(),
        settings: Some(
            Settings::default()
                .with_quality(Quality::Draft)
                .with_tolerance(3e-3),
        ),
        forgets: true,
        ..ViewOptions::default()
    }
}

/// A window that nobody sees: panels without pictures.
fn window(scene: &'static str) -> Window {
    let builder = Harness::builder().with_size(Vec2::new(1280.0, 800.0));
    let show = move |ui: &mut Ui, state: &mut Option<Viewer>| {
        let viewer =
            state.get_or_insert_with(|| Viewer::new(ui.ctx(), None, None, &options(scene)));
        viewer.frame(ui);
    };
    builder.build_ui_state(show, None)
}

fn of(window: &Window) -> &Desk {
    &window.state().as_ref().expect("a frame was shown").desk
}

fn change(window: &mut Window) -> &mut Desk {
    &mut window.state_mut().as_mut().expect("a frame was shown").desk
}

/// Runs frames until something is as wanted.
fn wait(window: &mut Window, what: &str, wanted: impl Fn(&Desk) -> bool) {
    let begin = Instant::now();
    loop {
        window.step();
        if wanted(of(window)) {
            return;
        }
        let status = &of(window).status;
        assert!(
            begin.elapsed() < Duration::from_secs(90),
            "{what}: {status:?}"
        );
        std::thread::sleep(Duration::from_millis(3));
    }
}

/// A window in which the light is found.
fn finished(scene: &'static str) -> Window {
    let mut window = window(scene);
    wait(&mut window, "it finishes", |desk| {
        desk.status.phase == Phase::Finished
    });
    window
}

fn press(window: &mut Window, key: Key) {
    window.key_press(key);
    window.run_steps(2);
}

#[test]
fn light_is_solved_at_once_and_pauses() {
    let mut window = window("cornell");
    wait(&mut window, "it solves", |desk| {
        desk.panes.len() == 1 && desk.light_serial > 1
    });
    window.get_by_label_contains("Pause").click();
    wait(&mut window, "it pauses", |desk| {
        desk.status.phase == Phase::Paused
    });
    let steps = |window: &Window| {
        let snapshot = of(window).snapshot.clone().expect("there is light");
        snapshot.lanes[0].progress.iteration
    };
    window.run_steps(5);
    let before = steps(&window);
    window.get_by_label("Step").click();
    wait(&mut window, "it steps", |desk| {
        desk.snapshot
            .as_ref()
            .is_some_and(|s| s.lanes[0].progress.iteration == before + 1)
    });
    press(&mut window, Key::Space);
    wait(&mut window, "it goes on", |desk| {
        desk.status.phase != Phase::Paused
    });
}

#[test]
fn keys_walk_and_stop_at_walls() {
    let mut window = finished("furnace");
    let before = of(&window).eye;
    window.key_down(Key::W);
    window.run_steps(40);
    let after = of(&window).eye;
    let way = after.position - before.position;
    assert!(
        way.dot(before.forward()) > 0.05 * way.length() && way.length() > 0.0,
        "forward: {way}"
    );
    window.run_steps(2000);
    window.key_up(Key::W);
    window.run_steps(2);
    let (low, high) = {
        let snapshot = of(&window).snapshot.clone().expect("there is light");
        snapshot.mesh().scene().bounds().expect("it has faces")
    };
    let eye = of(&window).eye.position;
    assert!(
        eye.cmpgt(low).all() && eye.cmplt(high).all(),
        "the wall stops: {eye}"
    );
    press(&mut window, Key::O);
    assert_eq!(of(&window).eye.mode, EyeMode::Orbit, "key O");
}

#[test]
fn keys_change_what_is_shown() {
    let mut window = finished("cornell");
    let display = |window: &Window| of(window).prefs.display;
    press(&mut window, Key::F);
    assert_eq!(
        display(&window).quantity,
        Quantity::Illuminance,
        "false colours"
    );
    press(&mut window, Key::F);
    assert_eq!(display(&window).quantity, Quantity::Light, "and back");
    for (key, is_on) in [
        (Key::M, true),
        (Key::T, false),
        (Key::L, true),
        (Key::B, false),
    ] {
        press(&mut window, key);
        let shown = display(&window);
        let value = match key {
            Key::M => shown.mesh,
            Key::T => shown.textures,
            Key::L => shown.flat,
            _ => shown.bumps,
        };
        assert_eq!(value, is_on, "{key:?}");
    }
    press(&mut window, Key::Minus);
    assert_eq!(display(&window).stops, -0.5, "half a stop darker");
    press(&mut window, Key::Num0);
    assert_eq!(display(&window).stops, 0.0, "automatic");
    press(&mut window, Key::F1);
    assert!(of(&window).shows_help, "help");
    window.get_by_label_contains("run or pause");
    press(&mut window, Key::F2);
    assert!(!of(&window).prefs.left_open, "the left panel");
}

#[test]
fn a_clicked_surface_is_inspected_and_edited() {
    let mut window = finished("cornell");
    let middle = Pos2::new(640.0, 640.0);
    window.hover_at(middle);
    window.run_steps(2);
    assert!(
        of(&window).hover.is_some(),
        "the floor is under the pointer"
    );
    window.drag_at(middle);
    window.run_steps(1);
    window.drop_at(middle);
    window.run_steps(3);
    let selection = of(&window).selection.expect("it was clicked");
    assert!(selection.illuminance > 1.0, "it is lit: {selection:?}");
    window.get_by_label_contains("Illuminance");
    // The lamp gets dimmer, and so does the floor.
    let desk = change(&mut window);
    let snapshot = desk.snapshot.clone().expect("there is light");
    let materials = &snapshot.mesh().scene().materials;
    let lamp = materials.iter().position(|m| m.emits()).expect("a lamp");
    let emission = materials[lamp].emission * 0.5;
    desk.edit(hemicube_radiosity::MaterialEdit::new(lamp).with_emission(emission));
    wait(&mut window, "it gets darker", |desk| {
        let now = desk.selection.expect("it stays selected").illuminance;
        (now / selection.illuminance - 0.5).abs() < 0.01
    });
    assert_eq!(
        of(&window).colors(lamp).map(|c| c[1]),
        Some(emission),
        "what the slider shows"
    );
    change(&mut window).undo_edit(lamp);
    wait(&mut window, "it comes back", |desk| {
        let now = desk.selection.expect("it stays selected").illuminance;
        (now / selection.illuminance - 1.0).abs() < 0.01
    });
}

#[test]
fn dimming_solves_nothing_again() {
    let mut window = window("cornell");
    wait(&mut window, "there is light", |desk| {
        desk.snapshot
            .as_ref()
            .is_some_and(|s| s.lanes[0].progress.unshot < 0.2)
    });
    window.get_by_label_contains("Pause").click();
    wait(&mut window, "it pauses", |desk| {
        desk.status.phase == Phase::Paused
    });
    let total = |desk: &Desk| -> f32 {
        desk.panes[0]
            .light
            .irradiance
            .iter()
            .map(|h| h.luminance())
            .sum()
    };
    let (all, serial) = {
        let desk = of(&window);
        (
            total(desk),
            desk.snapshot.as_ref().expect("there is light").serial,
        )
    };
    window.get_by_label("Day").click();
    window.run_steps(2);
    let day = total(of(&window));
    window.get_by_label("Evening").click();
    window.run_steps(2);
    let evening = total(of(&window));
    let desk = of(&window);
    assert_eq!(
        desk.snapshot.as_ref().expect("there is light").serial,
        serial,
        "the solver sleeps"
    );
    assert!(
        (day + evening / 0.6 - all).abs() < 1e-3 * all,
        "light is linear: {day} + {evening} / 0.6 = {all}"
    );
    window.get_by_label("Lightings side by side").click();
    window.run_steps(2);
    let titles: Vec<String> = of(&window)
        .panes
        .iter()
        .map(|pane| pane.title.clone())
        .collect();
    assert_eq!(titles, ["Day", "Evening", "Cleaning"], "one picture each");
}

#[test]
fn a_narrow_window_keeps_room_for_the_picture() {
    let mut window = finished("cornell");
    window.get_by_label_contains("Calculation grid");
    window.set_size(Vec2::new(640.0, 400.0));
    window.run_steps(3);
    let picture = window.get_by_label("picture").rect();
    assert!(picture.width() > 250.0, "{picture}");
    press(&mut window, Key::F2);
    window.run_steps(20);
    window.get_by_label_contains("Calculation grid");
    let picture = window.get_by_label("picture").rect();
    assert!(picture.width() > 250.0, "the other panel: {picture}");
}

#[test]
fn variants_run_side_by_side() {
    let mut window = window("cornell");
    wait(&mut window, "there is light", |desk| desk.panes.len() == 1);
    window.get_by_label("Four variants side by side").click();
    wait(&mut window, "four pictures", |desk| desk.panes.len() == 4);
    let snapshot = of(&window).snapshot.clone().expect("there is light");
    let kinds: Vec<SolverKind> = snapshot.lanes.iter().map(|lane| lane.kind).collect();
    assert_eq!(kinds, VARIANTS, "the figure's four");
}

#[test]
fn the_mesh_is_refined_when_the_panel_says_so() {
    let mut window = finished("cornell");
    let elements = |desk: &Desk| {
        let snapshot = desk.snapshot.as_ref();
        snapshot.map_or(0, |snapshot| snapshot.mesh().elements().len())
    };
    let (coarse, eye) = (elements(of(&window)), of(&window).eye);
    let desk = change(&mut window);
    let rough = Refinement {
        contrast: 0.4,
        most_elements: 2000,
        ..Refinement::default()
    };
    desk.configure(desk.prefs.settings.with_refinement(rough));
    wait(&mut window, "it is refined", |desk| elements(desk) > coarse);
    assert_eq!(of(&window).eye, eye, "nobody moved");
    window.get_by_label("Contrast");
    window.get_by_label("Refine where light varies").click();
    window.run_steps(3);
    let settings = of(&window).prefs.settings;
    assert_eq!(settings.refinement, None, "no more");
    assert!(
        window.query_by_label("Contrast").is_none(),
        "nothing to set"
    );
    window.get_by_label("Refine where light varies").click();
    window.run_steps(3);
    let settings = of(&window).prefs.settings;
    let usual = Some(Refinement::default());
    assert_eq!(settings.refinement, usual, "as usual");
}

#[test]
fn the_way_to_the_light_is_chosen_in_the_toolbar() {
    let mut window = finished("cornell");
    let desk = change(&mut window);
    desk.configure(
        desk.prefs
            .settings
            .with_solver(SolverKind::Overshooting)
            .with_factors(FactorsBy::Hemicubes),
    );
    wait(&mut window, "it changes", |desk| {
        desk.snapshot
            .as_ref()
            .is_some_and(|s| s.lanes[0].kind == SolverKind::Overshooting)
    });
    window.run_steps(2);
    let named = window.query_all_by_value("Overshooting").count();
    assert!(named > 0, "in the toolbar");
}

#[test]
fn errors_are_shown_and_dismissed() {
    let mut window = finished("cornell");
    change(&mut window).open("no-such-file.glb");
    wait(&mut window, "it fails", |desk| desk.status.error.is_some());
    window.run_steps(3);
    let said = window
        .query_all_by_label_contains("no-such-file.glb")
        .count();
    assert!(said > 0, "the window says so");
    window.get_by_label("Dismiss").click();
    wait(&mut window, "it is dismissed", |desk| {
        desk.status.error.is_none()
    });
    assert_eq!(of(&window).status.scene, "cornell", "the light stays");
}

#[test]
fn a_path_is_typed_into_the_menu() {
    let mut window = finished("cornell");
    window.get_by_label("Open").click();
    window.run_steps(3);
    let field = |window: &Window| {
        let field = window.get_by_role_and_label(Role::TextInput, "or type a path");
        field.rect().center()
    };
    let at = field(&window);
    window.drag_at(at);
    window.run_steps(1);
    window.drop_at(at);
    window.run_steps(2);
    assert_eq!(field(&window), at, "a click into the field leaves it open");
    window.event(Event::Text(String::from("furnace")));
    window.run_steps(2);
    press(&mut window, Key::Enter);
    wait(&mut window, "it opens", |desk| {
        desk.status.source.as_deref() == Some("furnace")
    });
}

#[test]
fn without_dialogs_a_path_is_typed() {
    let folder = tempfile::tempdir().expect("there is room");
    let mut window = finished("cornell");
    let path = folder.path().join("a.hemicube.json");
    let name = path.to_string_lossy().into_owned();
    let none = Answer::NoDialog(Pick::SaveSession, name);
    change(&mut window).dialogs.put(none);
    window.run_steps(3);
    window.get_by_label_contains("no file dialogs");
    window.get_by_label("Go on").click();
    window.run_steps(3);
    assert!(path.is_file(), "it is written");
    assert!(of(&window).typed_file.is_none(), "the field is gone");
}

/// A file as a window system hands it over.
#[derive(Debug)]
struct Dropped(PathBuf);

impl egui::DroppedFile for Dropped {
    fn path(&self) -> &Path {
        &self.0
    }

    fn bytes(&self) -> Result<Vec<u8>, String> {
        std::fs::read(&self.0).map_err(|error| error.to_string())
    }
}

#[test]
fn a_dropped_file_is_opened_or_refused_in_the_window() {
    let mut window = finished("cornell");
    let folder = tempfile::tempdir().expect("there is room");
    let path = folder.path().join("broken.glb");
    std::fs::write(&path, b"glTF, but not really").expect("there is room");
    window
        .input_mut()
        .dropped_files
        .push(Arc::new(Dropped(path)));
    wait(&mut window, "it is refused", |desk| {
        desk.status.error.is_some()
    });
    window.run_steps(2);
    let said = window.query_all_by_label_contains("broken.glb").count();
    assert!(said > 0, "the window says so");
    assert_eq!(of(&window).status.scene, "cornell", "the light stays");
}

#[test]
fn files_are_saved_and_go_on() {
    let folder = tempfile::tempdir().expect("there is room");
    let mut window = finished("cornell");
    let lit = folder.path().join("lit.glb");
    let session = folder.path().join("a.hemicube.json");
    let desk = change(&mut window);
    desk.eye.position.x += 12.0;
    desk.mixer.groups[1].level = 0.5;
    desk.add_stop();
    desk.picked(Pick::SaveLit, lit.clone());
    desk.picked(Pick::SaveSession, session.clone());
    let saved_eye = desk.eye;
    let lit_bytes = std::fs::read(&lit).expect("it is written");
    assert!(
        hemicube_radiosity::export::lit_glb::is_lit(&lit_bytes),
        "with its light"
    );
    desk.open(&lit.to_string_lossy());
    wait(&mut window, "the lit scene opens", |desk| {
        desk.status.source == Some(lit.to_string_lossy().into_owned())
    });
    wait(&mut window, "its light is there", |desk| {
        desk.snapshot
            .as_ref()
            .is_some_and(|s| s.lanes[0].progress.unshot < 5e-3)
    });
    change(&mut window).open(&session.to_string_lossy());
    wait(&mut window, "the session opens", |desk| {
        desk.status.source.as_deref() == Some("cornell") && desk.path.stops.len() == 1
    });
    let desk = of(&window);
    assert_eq!(desk.eye, saved_eye, "where one stood");
    assert_eq!(desk.mixer.groups[1].level, 0.5, "how it was dimmed");
}

#[test]
fn a_grid_is_measured_and_exported() {
    let folder = tempfile::tempdir().expect("there is room");
    let mut window = finished("furnace");
    let desk = change(&mut window);
    desk.point_at(0, 0.0, 0.5, 1.0);
    desk.select();
    desk.grid_options.points = 5;
    desk.grid_options.rays = 64;
    desk.measure_grid();
    wait(&mut window, "it is measured", |desk| desk.grid.is_some());
    let path = folder.path().join("grid.csv");
    change(&mut window).picked(Pick::SaveGrid, path.clone());
    let csv = std::fs::read_to_string(path).expect("it is written");
    assert_eq!(csv.lines().count(), 26, "a line for each point and a head");
    window.get_by_label_contains("Calculation grid").click();
    window.run_steps(4);
    window.get_by_label_contains("25 points");
}

#[test]
fn keys_that_are_typed_into_fields_do_nothing_else() {
    let mut window = finished("cornell");
    let field = window.get_by_label("Keep as");
    let _ = field.accesskit_node();
    change(&mut window).typed_lighting = String::from("x");
    window.key_press_modifiers(Modifiers::CTRL, Key::T);
    window.run_steps(2);
    assert!(of(&window).prefs.display.textures, "Ctrl T is not T");
}
