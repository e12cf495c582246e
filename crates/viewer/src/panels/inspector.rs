//! The surface that was clicked: its numbers, its material, its light to be changed.

use crate::desk::Desk;
use crate::format::number;
use crate::panels::{fact, row, section};
use egui::{DragValue, RichText, Slider, Ui};
use hemicube_radiosity::MaterialEdit;
use hemicube_raster::Rgb;
use hemicube_scene::Units;

/// Width of sliders that have a colour before and a number behind them.
const SLIDER: f32 = 72.0;

pub fn show(ui: &mut Ui, desk: &mut Desk) {
    section(ui, "Surface", true, |ui| {
        let Some(reading) = desk.selection else {
            ui.label(RichText::new("Click a surface in the picture.").weak());
            return;
        };
        numbers(ui, desk);
        ui.separator();
        material(ui, desk, reading.material);
    });
}

fn numbers(ui: &mut Ui, desk: &Desk) {
    let (Some(reading), Some(snapshot)) = (&desk.selection, &desk.snapshot) else {
        return;
    };
    let mesh = snapshot.mesh();
    let scene = mesh.scene();
    let unit = match scene.units {
        Units::Photometric => "lx",
        Units::Radiometric => "W/m²",
    };
    let node = scene
        .instances
        .get(reading.instance)
        .map_or("", |instance| instance.node.as_str());
    fact(ui, "Node", node);
    let at = reading.point;
    fact(ui, "Point", format!("{:.3} {:.3} {:.3}", at.x, at.y, at.z));
    fact(
        ui,
        "Illuminance",
        format!("{} lx", number(f64::from(reading.illuminance))),
    );
    fact(ui, "Irradiance", triple(reading.irradiance, unit));
    fact(ui, "Radiosity", triple(reading.radiosity, unit));
    if let Some(element) = reading.element {
        let area = f64::from(mesh.exposed_area(element));
        fact(ui, "Element", format!("{element} of {} u²", number(area)));
        fact(ui, "Patch", mesh.patch_of_element(element).to_string());
        fact(ui, "Reflectance", triple(mesh.reflectance()[element], ""));
    } else {
        ui.label(RichText::new("This side only absorbs.").weak());
    }
}

fn triple(color: Rgb, unit: &str) -> String {
    let [r, g, b] = color.to_array().map(|x| number(f64::from(x)));
    if r == g && g == b {
        return format!("{r} {unit}");
    }
    format!("{r} {g} {b} {unit}")
}

fn material(ui: &mut Ui, desk: &mut Desk, index: usize) {
    let Some(material) = desk.material(index).cloned() else {
        return;
    };
    let Some([base_color, emission]) = desk.colors(index) else {
        return;
    };
    fact(ui, "Material", &material.name);
    if material.may_transmit() {
        ui.label(
            RichText::new(
                "It lets light through; its colour cannot be changed while light is solved.",
            )
            .small()
            .weak(),
        );
    } else {
        row(ui, "Colour", |ui| {
            let mut color = base_color.to_array();
            if ui
                .color_edit_button_rgb(&mut color)
                .on_hover_text("Reflectance; a texture multiplies it")
                .changed()
            {
                desk.edit(MaterialEdit::new(index).with_base_color(Rgb::from(color)));
            }
            let mut mean = base_color.luminance();
            ui.spacing_mut().slider_width = SLIDER;
            let slider = Slider::new(&mut mean, 0.0..=0.98)
                .show_value(true)
                .max_decimals(2);
            if ui.add(slider).on_hover_text("Mean reflectance").changed() {
                desk.edit(
                    MaterialEdit::new(index)
                        .with_base_color(with_luminance(base_color, mean).min(0.98)),
                );
            }
        });
    }
    emission_rows(ui, desk, index, emission);
    if desk.edited.contains_key(&material.name) && ui.button("As in the file").clicked() {
        desk.undo_edit(index);
    }
}

fn emission_rows(ui: &mut Ui, desk: &mut Desk, index: usize, emission: Rgb) {
    let unit = match desk
        .snapshot
        .as_ref()
        .map(|snapshot| snapshot.mesh().scene().units)
    {
        Some(Units::Radiometric) => " W/(m² sr)",
        _ => " cd/m²",
    };
    let most = desk.emission_scale();
    row(ui, "Emission", |ui| {
        let peak = emission.max_band();
        let mut hue = if peak > 0.0 {
            (emission / peak).to_array()
        } else {
            [1.0; 3]
        };
        if ui
            .color_edit_button_rgb(&mut hue)
            .on_hover_text("Colour of its light")
            .changed()
            && peak > 0.0
        {
            let hue = Rgb::from(hue);
            desk.edit(
                MaterialEdit::new(index).with_emission(hue * (peak / hue.max_band().max(1e-3))),
            );
        }
        let mut level = emission.luminance();
        ui.spacing_mut().slider_width = SLIDER;
        let before = level;
        let slider = Slider::new(&mut level, 0.0..=most)
            .logarithmic(true)
            .smallest_positive(f64::from(most) * 1e-4)
            .show_value(false);
        let by_slider = ui.add(slider).on_hover_text("Radiance").changed();
        let by_number = ui
            .add(
                DragValue::new(&mut level)
                    .range(0.0..=1e9)
                    .speed(f64::from(most) * 0.002)
                    .suffix(unit)
                    .max_decimals(1),
            )
            .changed();
        if (by_slider || by_number) && level != before {
            desk.edit(MaterialEdit::new(index).with_emission(with_luminance(emission, level)));
        }
    });
}

/// The same hue with another luminance; black becomes grey.
fn with_luminance(color: Rgb, luminance: f32) -> Rgb {
    let before = color.luminance();
    if before > 0.0 {
        color * (luminance / before)
    } else {
        Rgb::splat(luminance)
    }
}

trait AtMost {
    fn min(self, most: f32) -> Self;
}

impl AtMost for Rgb {
    fn min(self, most: f32) -> Self {
        self.map(|band| band.min(most))
    }
}
