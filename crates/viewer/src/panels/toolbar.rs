//! The line at the top: files, solving, walking, what is open.

use crate::desk::{Desk, Pick};
use crate::panels::files;
use crate::session::{Command, FactorsBy, Phase};
use crate::walk::EyeMode;
use egui::{Button, ComboBox, Ui};
use hemicube_radiosity::SolverKind;

pub fn show(ui: &mut Ui, desk: &mut Desk) {
    ui.add_space(4.0);
    ui.horizontal_wrapped(|ui| {
        files::open_menu(ui, desk);
        save_menu(ui, desk);
        ui.separator();
        run_buttons(ui, desk);
        ui.separator();
        method(ui, desk);
        ui.separator();
        walking(ui, desk);
        ui.separator();
        windows(ui, desk);
    });
    ui.add_space(3.0);
}

fn save_menu(ui: &mut Ui, desk: &mut Desk) {
    ui.menu_button("Save", |ui| {
        let entries = [
            ("Lit scene (.glb)…", Pick::SaveLit),
            ("Session (.json)…", Pick::SaveSession),
            ("Picture (.png)…", Pick::SavePicture),
            ("Grid (.csv)…", Pick::SaveGrid),
        ];
        for (name, pick) in entries {
            let is_there = match pick {
                Pick::SaveGrid => desk.grid.is_some(),
                _ => desk.snapshot.is_some(),
            };
            if ui.add_enabled(is_there, Button::new(name)).clicked() {
                desk.ask(pick);
                ui.close();
            }
        }
    });
}

fn run_buttons(ui: &mut Ui, desk: &mut Desk) {
    let is_solving = desk.status.phase == Phase::Solving;
    let (name, command) = if is_solving {
        ("Pause", Command::Pause)
    } else {
        ("Run", Command::Run)
    };
    let is_there = desk.snapshot.is_some();
    let run = ui.add_enabled(is_there, Button::new(name).min_size([72.0, 0.0].into()));
    if run.on_hover_text("Solve, or pause (Space)").clicked() {
        desk.session.send(command);
    }
    if ui
        .add_enabled(is_there, Button::new("Step"))
        .on_hover_text("One step, then a pause (N)")
        .clicked()
    {
        desk.session.send(Command::Step);
    }
    if ui
        .add_enabled(is_there, Button::new("Restart"))
        .on_hover_text("Back to the light of the lamps alone (R)")
        .clicked()
    {
        desk.session.send(Command::Restart);
    }
}

fn method(ui: &mut Ui, desk: &mut Desk) {
    let mut settings = desk.prefs.settings;
    let mut solver = settings.solver();
    ui.add_enabled_ui(!settings.side_by_side, |ui| {
        ComboBox::from_id_salt("solver")
            .selected_text(solver.map_or(AUTOMATIC, solver_label))
            .width(168.0)
            .show_ui(ui, |ui| {
                ui.selectable_value(&mut solver, None, AUTOMATIC);
                for kind in SolverKind::ALL {
                    ui.selectable_value(&mut solver, Some(kind), solver_label(kind));
                }
            })
            .response
            .on_hover_text(
                "Way to the equilibrium of light; the light that is there stays. Automatic: sorted shooting with the \
                 ambient estimate, or rays alone for more than 40,000 elements",
            );
    });
    ComboBox::from_id_salt("form factors")
        .selected_text(settings.factors.label())
        .width(158.0)
        .show_ui(ui, |ui| {
            for by in FactorsBy::ALL {
                ui.selectable_value(&mut settings.factors, by, by.label());
            }
        })
        .response
        .on_hover_text("What computes form factors, and where");
    desk.configure(settings.with_solver(solver));
}

/// The solver that fits the size of the scene.
const AUTOMATIC: &str = "Automatic";

/// A solver as people call it.
pub fn solver_label(kind: SolverKind) -> &'static str {
    match kind {
        SolverKind::Gauss => "Gauss",
        SolverKind::Jacobi => "Jacobi",
        SolverKind::GaussSeidel => "Gauss-Seidel",
        SolverKind::Southwell => "Southwell",
        SolverKind::Gathering => "Gathering",
        SolverKind::Shooting => "Shooting",
        SolverKind::SortedShooting => "Sorted shooting",
        SolverKind::AmbientShooting => "Sorted + ambient",
        SolverKind::Overshooting => "Overshooting",
        SolverKind::ConjugateGradient => "Conjugate gradients",
        SolverKind::Stochastic => "By rays alone",
        SolverKind::Hierarchical => "By links",
    }
}

fn walking(ui: &mut Ui, desk: &mut Desk) {
    for (mode, name, hint) in [
        (
            EyeMode::Walk,
            "Walk",
            "Turn on the spot, move with W A S D (O)",
        ),
        (EyeMode::Orbit, "Orbit", "Turn around what you look at (O)"),
    ] {
        if ui
            .selectable_label(desk.eye.mode == mode, name)
            .on_hover_text(hint)
            .clicked()
            && desk.eye.mode != mode
        {
            desk.toggle_mode();
        }
    }
    let cameras = desk.stops().to_vec();
    ui.add_enabled_ui(!cameras.is_empty(), |ui| {
        ui.menu_button("Cameras", |ui| {
            for (i, camera) in cameras.iter().enumerate() {
                let name = match i {
                    0..9 => format!("{}  {}", i + 1, camera.name),
                    _ => camera.name.clone(),
                };
                if ui.button(name).clicked() {
                    desk.look_through(camera);
                    ui.close();
                }
            }
        });
    });
}

fn windows(ui: &mut Ui, desk: &mut Desk) {
    ui.toggle_value(&mut desk.prefs.left_open, "Solver")
        .on_hover_text("Panel at the left: solving and lighting (F2)");
    ui.toggle_value(&mut desk.prefs.right_open, "Surfaces")
        .on_hover_text("Panel at the right: surfaces, display, measuring (F3)");
    ui.menu_button("Theme", |ui| {
        let mut theme = ui.ctx().options(|options| options.theme_preference);
        for (choice, name) in [
            (egui::ThemePreference::Dark, "Dark"),
            (egui::ThemePreference::Light, "Light"),
            (egui::ThemePreference::System, "As the system"),
        ] {
            if ui.selectable_value(&mut theme, choice, name).clicked() {
                ui.ctx().set_theme(choice);
                ui.close();
            }
        }
    });
    ui.toggle_value(&mut desk.shows_help, "Help")
        .on_hover_text("Keys and mouse (F1)");
}
