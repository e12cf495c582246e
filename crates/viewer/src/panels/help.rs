//! Keys and mouse.

use crate::desk::Desk;
use egui::{Align2, RichText, Ui};

const KEYS: [(&str, &[(&str, &str)]); 4] = [
    (
        "Move",
        &[
            ("W A S D, arrows", "go"),
            ("Q  E", "down, up"),
            ("Shift", "run"),
            ("drag", "look around, or orbit"),
            ("drag with the middle button", "slide"),
            ("wheel", "angle of view, or distance"),
            ("O", "walk or orbit"),
            ("G  K", "gravity, walls"),
            ("1 … 9", "cameras of the scene"),
        ],
    ),
    (
        "Solve",
        &[
            ("Space", "run or pause"),
            ("N", "one step"),
            ("R", "restart"),
            ("H", "hemicube of the patch that shoots"),
        ],
    ),
    (
        "Show",
        &[
            ("F", "false colours of illuminance"),
            ("X", "wireframe"),
            ("M", "element mesh"),
            ("L", "flat elements"),
            ("T  B  V", "textures, bumps, reflections"),
            ("I", "ambient estimate"),
            ("+  -  0", "exposure up, down, automatic"),
        ],
    ),
    (
        "Keep",
        &[
            ("click", "select a surface"),
            ("C  P", "add a stop, play the path"),
            ("Ctrl O", "open"),
            ("Ctrl S", "save the lit scene"),
            ("F12", "save the picture"),
            ("F2  F3  F11", "panels, full screen"),
            ("F1", "this help"),
        ],
    ),
];

pub fn show(ui: &mut Ui, desk: &mut Desk) {
    let mut is_open = desk.shows_help;
    egui::Window::new("Keys and mouse")
        .open(&mut is_open)
        .collapsible(false)
        .resizable(false)
        .anchor(Align2::CENTER_CENTER, [0.0, 0.0])
        .show(ui.ctx(), |ui| {
            ui.columns(2, |columns| {
                for (i, (title, keys)) in KEYS.iter().enumerate() {
                    let ui = &mut columns[i % 2];
                    ui.label(RichText::new(*title).strong());
                    egui::Grid::new(*title).num_columns(2).spacing([16.0, 3.0]).show(ui, |ui| {
                        for (key, what) in *keys {
                            ui.label(RichText::new(*key).monospace());
                            ui.label(*what);
                            ui.end_row();
                        }
                    });
                    ui.add_space(10.0);
                }
            });
            let about = "Light is solved in the background all the time: walk, click, drag sliders; nothing waits.";
            ui.label(RichText::new(about).weak());
        });
    desk.shows_help = is_open;
}
