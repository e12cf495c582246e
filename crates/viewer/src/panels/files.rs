//! Opening files, what is on its way, and what went wrong.

use crate::desk::{Desk, Pick};
use crate::session::Command;
use crate::theme::ACCENT;
use core::f32::consts::TAU;
use egui::containers::menu::{MenuButton, MenuConfig};
use egui::{
    Align2, Button, Color32, Frame, Key, PopupCloseBehavior, RichText, ScrollArea, Sense, Stroke,
    TextEdit, Ui, Vec2,
};
use hemicube_scene::builtin;
use std::path::Path;

/// The menu of what can be opened.
pub fn open_menu(ui: &mut Ui, desk: &mut Desk) {
    // One clicks into the field as well.
    let stays = MenuConfig::new().close_behavior(PopupCloseBehavior::CloseOnClickOutside);
    MenuButton::new("Open").config(stays).ui(ui, |ui| {
        ui.set_min_width(240.0);
        if ui
            .button("File…")
            .on_hover_text("glTF, OBJ, STL, View3D, a lit .glb or a session (Ctrl O)")
            .clicked()
        {
            desk.ask(Pick::Open);
            ui.close();
        }
        let label = ui.label(RichText::new("or type a path").weak());
        let field = ui
            .text_edit_singleline(&mut desk.typed_path)
            .labelled_by(label.id);
        if field.lost_focus()
            && ui.input(|i| i.key_pressed(Key::Enter))
            && !desk.typed_path.is_empty()
        {
            let path = core::mem::take(&mut desk.typed_path);
            desk.open(path.trim());
            ui.close();
        }
        ui.separator();
        let height = (ui.ctx().content_rect().height() - 180.0).max(80.0);
        ScrollArea::vertical()
            .max_height(height)
            .show(ui, |ui| known_scenes(ui, desk));
    });
}

/// What is built in, and what was opened lately.
fn known_scenes(ui: &mut Ui, desk: &mut Desk) {
    ui.label(RichText::new("Built in").weak());
    for scene in builtin::list() {
        let button = ui.button(scene.name).on_hover_text(scene.description);
        if button.clicked() {
            desk.open(scene.name);
            ui.close();
        }
    }
    if !desk.prefs.recent.is_empty() {
        ui.separator();
        ui.label(RichText::new("Recent").weak());
    }
    for path in desk.prefs.recent.clone() {
        let name = Path::new(&path)
            .file_name()
            .map_or(path.clone(), |name| name.to_string_lossy().into_owned());
        if ui.button(name).on_hover_text(&path).clicked() {
            desk.open(&path);
            ui.close();
        }
    }
}

/// A scene or a mesh that is on its way, with a way to stop it.
pub fn opening(ui: &mut Ui, desk: &mut Desk) {
    let Some(opening) = desk.status.opening.clone() else {
        return;
    };
    let seconds = opening.since.elapsed().as_secs_f32();
    if seconds < 0.25 {
        // What is quick needs no window that flashes.
        ui.ctx().request_repaint_after_secs(0.26 - seconds);
        return;
    }
    egui::Window::new("Opening")
        .title_bar(false)
        .resizable(false)
        .anchor(Align2::CENTER_TOP, [0.0, 64.0])
        .show(ui.ctx(), |ui| {
            ui.horizontal(|ui| {
                clock(ui, seconds);
                ui.vertical(|ui| {
                    ui.label(RichText::new(format!("{} {}", opening.what, opening.name)).strong());
                    ui.label(format!("{}, {seconds:.0} s", opening.stage));
                });
                if ui.button("Cancel").clicked() {
                    desk.session.send(Command::Cancel);
                }
            });
        });
    ui.ctx().request_repaint_after_secs(0.2);
}

/// Something that turns with the seconds. A spinner would ask for frames without end, for which the processor may have to
/// draw while it is wanted for the scene.
fn clock(ui: &mut Ui, seconds: f32) {
    let (rect, _) = ui.allocate_exact_size(Vec2::splat(20.0), Sense::hover());
    let stroke = Stroke::new(2.0, ui.visuals().weak_text_color());
    ui.painter().circle_stroke(rect.center(), 8.0, stroke);
    let hand = Vec2::angled(TAU * (0.25 * seconds - 0.25)) * 6.0;
    let stroke = Stroke::new(2.0, ACCENT);
    ui.painter()
        .line_segment([rect.center(), rect.center() + hand], stroke);
}

/// A field for a path, where the system has no dialogs.
pub fn typed(ui: &mut Ui, desk: &mut Desk) {
    let Some((pick, mut text)) = desk.typed_file.take() else {
        return;
    };
    let shown = egui::Window::new(pick.title())
        .collapsible(false)
        .resizable(false)
        .anchor(Align2::CENTER_CENTER, [0.0, 0.0])
        .show(ui.ctx(), |ui| {
            let label = ui.label("This system shows no file dialogs. Path:");
            let field = TextEdit::singleline(&mut text).desired_width(360.0);
            let field = ui.add(field).labelled_by(label.id);
            let enters = field.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter));
            ui.horizontal(|ui| {
                let goes_on = ui.button("Go on").clicked() || enters;
                (goes_on, ui.button("Cancel").clicked())
            })
            .inner
        });
    let (goes_on, ends) = shown.and_then(|shown| shown.inner).unwrap_or_default();
    let path = text.trim();
    if goes_on && !path.is_empty() {
        desk.picked(pick, path.into());
    } else if !ends {
        desk.typed_file = Some((pick, text));
    }
}

/// Errors until they were read, notices for a while.
pub fn messages(ui: &mut Ui, desk: &mut Desk) {
    if let Some(error) = desk.status.error.clone()
        && message(ui, "error", &error, Color32::from_rgb(214, 74, 60))
    {
        desk.session.dismiss_error();
    }
    if let Some(notice) = desk.notice.clone() {
        let color = if notice.is_error {
            Color32::from_rgb(214, 74, 60)
        } else {
            Color32::from_rgb(70, 140, 84)
        };
        if message(ui, "notice", &notice.text, color) {
            desk.notice = None;
        }
        ui.ctx().request_repaint_after_secs(1.0);
    }
}

/// A line over the picture; whether it was dismissed.
fn message(ui: &Ui, id: &str, text: &str, color: Color32) -> bool {
    let height = if id == "error" { -72.0 } else { -36.0 };
    let frame = Frame::window(&ui.ctx().global_style()).stroke(Stroke::new(1.5, color));
    egui::Window::new(id)
        .title_bar(false)
        .resizable(false)
        .frame(frame)
        .anchor(Align2::CENTER_BOTTOM, [0.0, height])
        .show(ui.ctx(), |ui| {
            ui.horizontal(|ui| {
                ui.set_max_width(640.0);
                ui.colored_label(color, if id == "error" { "!" } else { "•" });
                ui.add(egui::Label::new(text).wrap().selectable(true));
                ui.add(Button::new("Dismiss").small()).clicked()
            })
            .inner
        })
        .and_then(|shown| shown.inner)
        .unwrap_or(false)
}

/// Opens what is dropped on the window, and says so while it hovers.
pub fn dropped(ui: &mut Ui, desk: &mut Desk) {
    let (hovers, dropped) = ui.input(|input| {
        let dropped = input
            .raw
            .dropped_files
            .first()
            .map(|file| file.path().to_path_buf());
        (!input.raw.hovered_files.is_empty(), dropped)
    });
    if let Some(path) = dropped {
        desk.open(&path.to_string_lossy());
    }
    if hovers {
        let screen = ui.ctx().content_rect();
        let layer = egui::LayerId::new(egui::Order::Foreground, egui::Id::unique("drop"));
        let painter = ui.ctx().layer_painter(layer);
        painter.rect_filled(screen, 0.0, Color32::from_black_alpha(160));
        let text = "Drop a scene, a lit .glb or a session";
        painter.text(
            screen.center(),
            Align2::CENTER_CENTER,
            text,
            egui::FontId::proportional(24.0),
            Color32::WHITE,
        );
    }
}
