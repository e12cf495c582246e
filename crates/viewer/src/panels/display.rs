//! What the picture shows, and how.

use crate::desk::Desk;
use crate::display::{MOST_STOPS, Quantity};
use crate::panels::{row, section};
use egui::{ComboBox, DragValue, Slider, Ui};
use hemicube_raster::tonemap::ToneMap;

pub fn show(ui: &mut Ui, desk: &mut Desk) {
    section(ui, "Display", true, |ui| {
        let display = &mut desk.prefs.display;
        row(ui, "Show", |ui| {
            ComboBox::from_id_salt("quantity")
                .selected_text(display.quantity.label())
                .show_ui(ui, |ui| {
                    for quantity in Quantity::ALL {
                        ui.selectable_value(&mut display.quantity, quantity, quantity.label());
                    }
                })
                .response
                .on_hover_text("What surfaces show");
        });
        match display.quantity {
            Quantity::Light => tones(ui, desk),
            Quantity::Illuminance => scale(ui, desk),
            Quantity::FormFactors | Quantity::Wireframe => {}
        }
        switches(ui, desk);
    });
}

fn tones(ui: &mut Ui, desk: &mut Desk) {
    let display = &mut desk.prefs.display;
    row(ui, "Exposure", |ui| {
        ui.checkbox(&mut display.auto_exposure, "auto");
        let slider = Slider::new(&mut display.stops, -MOST_STOPS..=MOST_STOPS)
            .suffix(" EV")
            .max_decimals(1);
        ui.spacing_mut().slider_width = 70.0;
        ui.add(slider).on_hover_text("Stops; + and - keys");
    });
    row(ui, "Tones", |ui| {
        let mut tone_map = display.tone_map();
        ComboBox::from_id_salt("tones")
            .selected_text(tone_map.name())
            .show_ui(ui, |ui| {
                for other in ToneMap::ALL {
                    ui.selectable_value(&mut tone_map, other, other.name());
                }
            })
            .response
            .on_hover_text("Tone curve");
        display.set_tone_map(tone_map);
    });
}

fn scale(ui: &mut Ui, desk: &mut Desk) {
    let display = &mut desk.prefs.display;
    row(ui, "Scale to", |ui| {
        let mut is_auto = display.scale_top <= 0.0;
        if ui.checkbox(&mut is_auto, "auto").changed() {
            display.scale_top = if is_auto { 0.0 } else { 500.0 };
        }
        if !is_auto {
            ui.add(
                DragValue::new(&mut display.scale_top)
                    .range(0.01..=1e6)
                    .speed(2.0)
                    .suffix(" lx"),
            );
        }
    });
    ui.checkbox(&mut display.isolines, "Lines of equal illuminance");
}

fn switches(ui: &mut Ui, desk: &mut Desk) {
    let display = &mut desk.prefs.display;
    let all = [
        (&mut display.textures, "Textures", "T"),
        (&mut display.bumps, "Bumps", "B"),
        (&mut display.reflections, "Reflections", "V"),
        (&mut display.mesh, "Element mesh", "M"),
        (&mut display.flat, "Flat elements", "L"),
        (&mut display.ambient, "Ambient estimate", "I"),
        (&mut display.smooth_edges, "Smooth edges", ""),
        (&mut display.coarse_motion, "Coarse if late", ""),
    ];
    egui::Grid::new("switches")
        .num_columns(2)
        .spacing([12.0, 4.0])
        .show(ui, |ui| {
            for (i, (value, name, key)) in all.into_iter().enumerate() {
                let response = ui.checkbox(value, name);
                if !key.is_empty() {
                    response.on_hover_text(format!("key {key}"));
                }
                if i % 2 == 1 {
                    ui.end_row();
                }
            }
        });
}
