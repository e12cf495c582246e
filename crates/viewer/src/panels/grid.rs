//! The calculation grid: how fine, what it says, as a picture and as a table.

use crate::desk::{Desk, Pick};
use crate::format::number;
use crate::measure::{Grid, GridPoint};
use crate::panels::hemicube::display_color;
use crate::panels::{fact, row, section};
use egui::{Rect, RichText, Sense, Slider, Ui, Vec2};
use hemicube_raster::colormap::Colormap;

pub fn show(ui: &mut Ui, desk: &mut Desk) {
    section(ui, "Calculation grid", false, |ui| {
        let options = &mut desk.grid_options;
        row(ui, "Points", |ui| {
            ui.add(Slider::new(&mut options.points, 3..=60).integer())
        })
        .on_hover_text("Along the longer side");
        row(ui, "Margin", |ui| {
            ui.add(Slider::new(&mut options.margin, 0.0..=0.4).max_decimals(2))
        })
        .on_hover_text("Share of the shorter side that is left out along the borders");
        let is_ready = desk.selection.is_some() && desk.grid_job.is_none();
        ui.horizontal(|ui| {
            if ui
                .add_enabled(is_ready, egui::Button::new("Measure the selected surface"))
                .clicked()
            {
                desk.measure_grid();
            }
            if ui
                .add_enabled(desk.grid.is_some(), egui::Button::new("CSV…"))
                .clicked()
            {
                desk.ask(Pick::SaveGrid);
            }
        });
        if let Some(job) = &desk.grid_job {
            ui.add(egui::ProgressBar::new(job.progress()).show_percentage());
            ui.ctx().request_repaint_after_secs(0.1);
        }
        if let Some(grid) = &desk.grid {
            result(ui, grid);
        }
    });
}

fn result(ui: &mut Ui, grid: &Grid) {
    let Some(statistics) = grid.statistics() else {
        ui.label("No point lies on the surface.");
        return;
    };
    let lux = |x: f32| format!("{} lx", number(f64::from(x)));
    fact(
        ui,
        "Surface",
        format!("{}, {} points", grid.surface, grid.points.len()),
    );
    fact(ui, "Minimum", lux(statistics.minimum));
    fact(ui, "Average", lux(statistics.average));
    fact(ui, "Maximum", lux(statistics.maximum));
    fact(ui, "U0 min/avg", format!("{:.2}", statistics.uniformity()));
    fact(ui, "Ud min/max", format!("{:.2}", statistics.diversity()));
    picture(ui, grid, statistics.maximum);
}

/// Cells in false colours, with their values under the pointer.
fn picture(ui: &mut Ui, grid: &Grid, top: f32) {
    let [columns, rows] = grid.size.map(|n| n as f32);
    let width = ui.available_width().min(260.0);
    let cell = (width / columns).min(180.0 / rows);
    let (response, painter) =
        ui.allocate_painter(Vec2::new(cell * columns, cell * rows), Sense::hover());
    let colors = Colormap::sequential();
    let rect_of = |point: &GridPoint| {
        let at = Vec2::new(point.cell[0] as f32, point.cell[1] as f32) * cell;
        Rect::from_min_size(response.rect.min + at, Vec2::splat(cell))
    };
    for point in &grid.points {
        let color = colors.color(point.illuminance / top.max(f32::MIN_POSITIVE));
        painter.rect_filled(rect_of(point).shrink(0.5), 1.0, display_color(color));
    }
    let under = response
        .hover_pos()
        .and_then(|at| grid.points.iter().find(|p| rect_of(p).contains(at)));
    let text = match under {
        Some(point) => format!(
            "column {}, row {}: {} lx",
            point.cell[0],
            point.cell[1],
            number(f64::from(point.illuminance))
        ),
        None => String::from("point at a cell"),
    };
    ui.label(RichText::new(text).small().weak());
}
