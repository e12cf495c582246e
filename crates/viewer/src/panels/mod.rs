//! The window's parts. Each reads and writes the [`Desk`] and nothing else.

mod display;
mod files;
mod grid;
mod help;
mod hemicube;
mod inspector;
mod keys;
mod lighting;
mod plot;
mod solver;
mod status;
mod toolbar;
mod view;
mod walk;

pub use hemicube::HemicubeTexture;
pub use keys::obey_keys;
pub use view::{Tile, tiles, view};

use crate::desk::Desk;
use egui::{Color32, RichText, ScrollArea, Ui};

/// Width of a side panel, and least width of the picture: in a window that is narrower than two panels with the picture
/// between them the panel at the right waits until the other one is closed.
const PANEL: f32 = 272.0;
const PICTURE: f32 = 300.0;

/// Everything around the picture. The window is cleared in the colour of panels, which therefore fill nothing: where the
/// processor draws, each layer of pixels is felt.
pub fn around(ui: &mut Ui, desk: &mut Desk, textures: &mut HemicubeTexture) {
    let style = ui.ctx().global_style();
    let bar = egui::Frame::side_top_panel(&style).fill(Color32::TRANSPARENT);
    egui::Panel::top("toolbar")
        .frame(bar)
        .show(ui, |ui| toolbar::show(ui, desk));
    egui::Panel::bottom("status")
        .frame(bar)
        .show(ui, |ui| status::show(ui, desk));
    let has_room_for_both = ui.available_width() >= 2.0 * PANEL + PICTURE;
    if desk.prefs.left_open {
        egui::Panel::left("left")
            .frame(bar)
            .default_size(PANEL)
            .size_range(240.0..=420.0)
            .show(ui, |ui| {
                ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
                    solver::show(ui, desk);
                    hemicube::show(ui, desk, textures);
                    lighting::show(ui, desk);
                    ui.add_space(8.0);
                });
            });
    }
    if desk.prefs.right_open && (has_room_for_both || !desk.prefs.left_open) {
        egui::Panel::right("right")
            .frame(bar)
            .default_size(PANEL)
            .size_range(240.0..=420.0)
            .show(ui, |ui| {
                ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
                    inspector::show(ui, desk);
                    display::show(ui, desk);
                    grid::show(ui, desk);
                    walk::show(ui, desk);
                    ui.add_space(8.0);
                });
            });
    }
}

/// Windows over the picture.
pub fn over(ui: &mut Ui, desk: &mut Desk) {
    help::show(ui, desk);
    files::opening(ui, desk);
    files::typed(ui, desk);
    files::messages(ui, desk);
    files::dropped(ui, desk);
}

/// A part of a side panel that can be folded away.
fn section<R>(ui: &mut Ui, title: &str, is_open: bool, contents: impl FnOnce(&mut Ui) -> R) {
    section_to_unfold(ui, title, is_open, false, contents);
}

/// The same; it is unfolded now if that is asked for.
fn section_to_unfold<R>(
    ui: &mut Ui,
    title: &str,
    is_open: bool,
    unfolds: bool,
    contents: impl FnOnce(&mut Ui) -> R,
) {
    ui.add_space(4.0);
    egui::CollapsingHeader::new(RichText::new(title).strong())
        .default_open(is_open)
        .open(unfolds.then_some(true))
        .show(ui, |ui| {
            ui.add_space(2.0);
            contents(ui)
        });
}

/// Width of names at the left.
const NAMES: f32 = 82.0;

/// A line with a name at its left.
fn row<R>(ui: &mut Ui, name: &str, contents: impl FnOnce(&mut Ui) -> R) -> R {
    ui.horizontal(|ui| {
        let layout = egui::Layout::left_to_right(egui::Align::Center);
        ui.allocate_ui_with_layout(egui::Vec2::new(NAMES, 18.0), layout, |ui| {
            ui.set_min_width(NAMES);
            ui.add(egui::Label::new(RichText::new(name).weak()).truncate());
        });
        contents(ui)
    })
    .inner
}

/// A name and a number.
fn fact(ui: &mut Ui, name: &str, text: impl Into<String>) {
    row(ui, name, |ui| {
        ui.label(RichText::new(text.into()).monospace())
    });
}
