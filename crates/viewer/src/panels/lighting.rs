//! The lighting desk: levels and tints of groups, and lightings to come back to.

use crate::desk::Desk;
use crate::panels::section;
use egui::{Button, ComboBox, RichText, Slider, Ui};
use hemicube_raster::Rgb;

pub fn show(ui: &mut Ui, desk: &mut Desk) {
    section(ui, "Lighting", true, |ui| {
        if desk.mixer.sources.len() < 2 {
            ui.label(RichText::new("All light is solved together.").weak());
            return;
        }
        lightings(ui, desk);
        ui.separator();
        groups(ui, desk);
        ui.separator();
        sources(ui, desk);
        if ui.button("Everything as solved").clicked() {
            desk.mixer.reset();
        }
    });
}

fn lightings(ui: &mut Ui, desk: &mut Desk) {
    ui.horizontal_wrapped(|ui| {
        for i in 0..desk.mixer.scenes.len() {
            let name = desk.mixer.scenes[i].name.clone();
            if ui
                .button(&name)
                .on_hover_text("Go back to this lighting")
                .clicked()
            {
                desk.mixer.recall(i);
            }
        }
    });
    ui.horizontal(|ui| {
        let hint = ui.label(RichText::new("Keep as").weak());
        ui.add(
            egui::TextEdit::singleline(&mut desk.typed_lighting)
                .desired_width(90.0)
                .hint_text("name"),
        )
        .labelled_by(hint.id);
        let name = desk.typed_lighting.trim().to_owned();
        if ui
            .add_enabled(!name.is_empty(), Button::new("Keep"))
            .clicked()
        {
            desk.mixer.keep(&name);
            desk.typed_lighting.clear();
        }
    });
    ui.checkbox(&mut desk.compares_lightings, "Lightings side by side")
        .on_hover_text("The first four that are kept");
}

fn groups(ui: &mut Ui, desk: &mut Desk) {
    let mut removed = None;
    for i in 0..desk.mixer.groups.len() {
        ui.push_id(i, |ui| {
            ui.horizontal(|ui| {
                let group = &mut desk.mixer.groups[i];
                let mut tint = group.tint.to_array();
                if ui
                    .color_edit_button_rgb(&mut tint)
                    .on_hover_text("Tint")
                    .changed()
                {
                    group.tint = Rgb::from(tint);
                }
                let label = ui
                    .add(egui::TextEdit::singleline(&mut group.name).desired_width(64.0))
                    .on_hover_text("Name of the group");
                ui.spacing_mut().slider_width = 70.0;
                let slider = Slider::new(&mut group.level, 0.0..=2.0)
                    .custom_formatter(|x, _| format!("{:.0} %", 100.0 * x));
                ui.add(slider).labelled_by(label.id);
                if i > 0
                    && ui
                        .small_button("×")
                        .on_hover_text("Remove the group")
                        .clicked()
                {
                    removed = Some(i);
                }
            });
        });
    }
    if let Some(group) = removed {
        desk.mixer.remove_group(group);
    }
    if ui.small_button("+ Group").clicked() {
        let count = desk.mixer.groups.len() + 1;
        desk.mixer.add_group(&format!("Group {count}"));
    }
}

fn sources(ui: &mut Ui, desk: &mut Desk) {
    let names: Vec<String> = desk
        .mixer
        .groups
        .iter()
        .map(|group| group.name.clone())
        .collect();
    egui::Grid::new("sources")
        .num_columns(3)
        .spacing([6.0, 4.0])
        .show(ui, |ui| {
            for (i, source) in desk.mixer.sources.iter_mut().enumerate() {
                let label = ui.add_sized(
                    [76.0, 18.0],
                    egui::Label::new(&source.name)
                        .halign(egui::Align::LEFT)
                        .truncate(),
                );
                ui.spacing_mut().slider_width = 48.0;
                let slider = Slider::new(&mut source.level, 0.0..=2.0)
                    .custom_formatter(|x, _| format!("{:.0} %", 100.0 * x));
                ui.add(slider).labelled_by(label.id);
                let selected = names.get(source.group).map_or("", String::as_str);
                ComboBox::from_id_salt(("group of", i))
                    .selected_text(selected)
                    .width(64.0)
                    .show_ui(ui, |ui| {
                        for (group, name) in names.iter().enumerate() {
                            ui.selectable_value(&mut source.group, group, name);
                        }
                    })
                    .response
                    .on_hover_text("Group that it is dimmed with");
                ui.end_row();
            }
        });
}
