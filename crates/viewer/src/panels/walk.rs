//! Walking: floors and walls, the recorded way, films.

use crate::desk::{Desk, Pick};
use crate::panels::{row, section};
use crate::walk::FilmFormat;
use egui::{Button, ComboBox, RichText, Ui};

pub fn show(ui: &mut Ui, desk: &mut Desk) {
    section(ui, "Walk and film", false, |ui| {
        ui.horizontal(|ui| {
            ui.checkbox(&mut desk.prefs.gravity, "Gravity")
                .on_hover_text("Stand on floors (G)");
            ui.checkbox(&mut desk.prefs.collisions, "Walls stop")
                .on_hover_text("Slide along walls instead of going through (K)");
        });
        path(ui, desk);
        film(ui, desk);
    });
}

fn path(ui: &mut Ui, desk: &mut Desk) {
    let count = desk.path.stops.len();
    let seconds = desk.path.duration(desk.body.speed);
    ui.label(match count {
        0 => RichText::new("No path yet: go to a place and add it.").weak(),
        _ => RichText::new(format!("Path of {count} stops, {seconds:.1} s")),
    });
    ui.horizontal(|ui| {
        if ui
            .button("Add stop")
            .on_hover_text("Where you stand now (C)")
            .clicked()
        {
            desk.add_stop();
        }
        let name = if desk.playing.is_some() {
            "Stop"
        } else {
            "Play"
        };
        if ui
            .add_enabled(count > 1, Button::new(name))
            .on_hover_text("(P)")
            .clicked()
        {
            desk.toggle_play();
        }
        if ui
            .add_enabled(count > 0, Button::new("Remove last"))
            .clicked()
        {
            desk.path.stops.pop();
        }
        if ui.add_enabled(count > 0, Button::new("Clear")).clicked() {
            desk.path.stops.clear();
            desk.playing = None;
        }
    });
}

fn film(ui: &mut Ui, desk: &mut Desk) {
    row(ui, "Film as", |ui| {
        let format = &mut desk.prefs.film_format;
        ComboBox::from_id_salt("film")
            .selected_text(format.label())
            .show_ui(ui, |ui| {
                for other in FilmFormat::ALL {
                    ui.selectable_value(format, other, other.label());
                }
            })
            .response
            .on_hover_text("How frames are kept");
    });
    row(ui, "Height", |ui| {
        for height in [360, 720, 1080] {
            ui.selectable_value(&mut desk.prefs.film_height, height, height.to_string());
        }
    });
    let Some((done, frames)) = desk.film.as_ref().map(|film| film.progress()) else {
        let is_ready = desk.path.stops.len() > 1;
        if ui
            .add_enabled(is_ready, Button::new("Write film…"))
            .clicked()
        {
            desk.ask(Pick::SaveFilm);
        }
        return;
    };
    ui.horizontal(|ui| {
        ui.add(
            egui::ProgressBar::new(done as f32 / frames.max(1) as f32)
                .desired_width(150.0)
                .text(format!("{done} of {frames}")),
        );
        if ui.button("Cancel").clicked() {
            desk.film = None;
        }
    });
    ui.ctx().request_repaint_after_secs(0.2);
}
