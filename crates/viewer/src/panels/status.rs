//! The line at the bottom: what goes on, what is under the pointer, how long frames take.

use crate::desk::Desk;
use crate::format::{number, share, thousands};
use crate::session::{LaneView, Phase};
use crate::theme::ACCENT;
use egui::{Align, Layout, RichText, Ui};
use hemicube_scene::Units;

pub fn show(ui: &mut Ui, desk: &Desk) {
    ui.add_space(2.0);
    ui.horizontal(|ui| {
        let status = &desk.status;
        let is_busy = matches!(status.phase, Phase::Solving | Phase::Preparing);
        let phase = RichText::new(status.phase.label()).strong();
        ui.label(if is_busy { phase.color(ACCENT) } else { phase });
        if !status.scene.is_empty() {
            ui.label(&status.scene);
        }
        if let Some(lane) = desk.snapshot.as_ref().map(|snapshot| &snapshot.lanes[0]) {
            let (steps, unshot) = (lane.progress.iteration as f64, lane.progress.unshot);
            ui.label(format!(
                "{} steps, {} unshot",
                thousands(steps),
                share(unshot)
            ));
            place_of_light(ui, lane);
            if is_busy {
                ui.label(
                    RichText::new(format!("{} steps/s", number(status.steps_per_second))).weak(),
                );
            }
        }
        if !status.warnings.is_empty() {
            let few: Vec<&str> = status
                .warnings
                .iter()
                .take(20)
                .map(String::as_str)
                .collect();
            ui.label(RichText::new(format!("{} warnings", status.warnings.len())).weak())
                .on_hover_text(few.join("\n"));
        }
        if let Some(note) = &status.note {
            ui.label(RichText::new("note").color(ACCENT))
                .on_hover_text(note);
        }
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            frame_time(ui, desk);
            readout(ui, desk);
        });
    });
    ui.add_space(2.0);
}

/// Tells where the light is, if it is on the device.
fn place_of_light(ui: &mut Ui, lane: &LaneView) {
    let Some(device) = &lane.on_device else {
        return;
    };
    let of_step = device.step_bytes.checked_div(device.steps).unwrap_or(0);
    let what = format!(
        "Solver and window share the device: pictures are made of the solver's own light. {} bytes come back after a step, all light when it is at rest or asked for.",
        thousands(of_step as f64)
    );
    ui.label(RichText::new("light on the device").color(ACCENT))
        .on_hover_text(what);
}

fn frame_time(ui: &mut Ui, desk: &Desk) {
    // Of a few frames nothing can be said.
    let report = desk.frames.report().filter(|report| report.frames >= 10);
    let text = match &report {
        Some(report) => format!("{:.1} ms", 1e3 * report.median.as_secs_f64()),
        None => String::from("– ms"),
    };
    let label = ui.label(RichText::new(text).monospace().weak());
    if let Some(report) = report {
        label.on_hover_text(report.to_string());
    }
    ui.separator();
}

/// Irradiance and illuminance under the pointer.
fn readout(ui: &mut Ui, desk: &Desk) {
    let (Some(reading), Some(snapshot)) = (&desk.hover, &desk.snapshot) else {
        ui.label(RichText::new("point at a surface to measure it").weak());
        return;
    };
    ui.label(
        RichText::new(format!("{} lx", number(f64::from(reading.illuminance))))
            .monospace()
            .strong(),
    );
    if snapshot.mesh().scene().units == Units::Radiometric {
        let [r, g, b] = reading.irradiance.to_array().map(|x| number(f64::from(x)));
        ui.label(RichText::new(format!("{r} {g} {b} W/m²")).monospace());
    }
    if let Some(material) = desk.material(reading.material) {
        ui.label(RichText::new(&material.name).weak());
    }
}
