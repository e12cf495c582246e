//! The picture, or several: looking around, clicking, legends.

use crate::desk::Desk;
use crate::display::Quantity;
use crate::draw::{DECADES, PanePaint};
use crate::format::{number, share as percent};
use crate::panels::hemicube::display_color;
use crate::panels::toolbar::solver_label;
use crate::panes::Tiling;
use crate::theme::LINES;
use crate::walk::EyeMode;
use egui::{Align2, Color32, FontId, PointerButton, Pos2, Rect, Response, Sense, Stroke, Ui, Vec2};
use egui_wgpu::Callback;
use hemicube_raster::colormap::Colormap;

/// Radians that the eye turns by while the pointer crosses the height of the picture.
const TURN: f32 = 1.6;
/// Gap between pictures.
const GAP: f32 = 2.0;

/// Where a pane is drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tile {
    /// In points.
    pub rect: Rect,
    /// In pixels.
    pub size: [u32; 2],
}

impl Tile {
    /// Width over height.
    pub fn aspect(&self) -> f32 {
        self.rect.width() / self.rect.height().max(1.0)
    }
}

/// Where panes are drawn in a rectangle.
pub fn tiles(rect: Rect, panes: usize, pixels_per_point: f32) -> Vec<Tile> {
    let tiling = Tiling::new(panes, rect.width() / rect.height().max(1.0));
    let gap = if panes > 1 { GAP } else { 0.0 };
    let tile = |i: usize| {
        let [x, y, width, height] = tiling.tile(i);
        let min = rect.min + Vec2::new(x * rect.width(), y * rect.height());
        let rect =
            Rect::from_min_size(min, Vec2::new(width * rect.width(), height * rect.height()))
                .shrink(0.5 * gap);
        Tile {
            rect,
            size: [rect.width(), rect.height()].map(|side| pixels(side * pixels_per_point)),
        }
    };
    (0..panes).map(tile).collect()
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "from 1 to 16,384"
)]
fn pixels(side: f32) -> u32 {
    side.round().clamp(1.0, 16_384.0) as u32
}

/// Lets the pointer look around and click, and draws the pictures with what belongs over them.
pub fn view(
    ui: &mut Ui,
    desk: &mut Desk,
    rect: Rect,
    tiles: &[Tile],
    pictures: &[Option<PanePaint>],
) {
    let response = ui.interact(rect, ui.scope_id().with("picture"), Sense::click_and_drag());
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, "picture"));
    point(desk, &response, tiles);
    if response.clicked() {
        ui.memory_mut(|memory| {
            if let Some(id) = memory.focused() {
                memory.surrender_focus(id);
            }
        });
        desk.select();
    }
    look(ui, desk, &response);
    let painter = ui.painter_at(rect);
    // What pictures cover is not filled before: where the processor draws, that is felt.
    if tiles.len() != 1 || pictures.iter().any(Option::is_none) {
        painter.rect_filled(rect, 0.0, ui.visuals().extreme_bg_color);
    }
    for (tile, picture) in tiles.iter().zip(pictures) {
        if let Some(picture) = picture {
            let shown = Callback::new_paint_callback(tile.rect, picture.clone());
            painter.add(shown);
        }
    }
    if desk.waits_for_device {
        let text = "The scene is being put on the device";
        plate(
            &painter,
            rect.left_top() + Vec2::splat(12.0),
            text,
            Color32::WHITE,
        );
    }
    titles(&painter, desk, tiles);
    marks(&painter, desk, tiles);
    if !desk.panes.is_empty() {
        legend(&painter, desk, rect);
    }
}

/// Reads the surface under the pointer.
fn point(desk: &mut Desk, response: &Response, tiles: &[Tile]) {
    let at = response.hover_pos();
    let under = at.and_then(|at| {
        tiles
            .iter()
            .position(|tile| tile.rect.contains(at))
            .map(|i| (at, i))
    });
    match under {
        Some((at, i)) => {
            let rect = tiles[i].rect;
            let offset = (at - rect.center()) / (0.5 * rect.size());
            desk.point_at(i, offset.x, offset.y, tiles[i].aspect());
        }
        None => desk.hover = None,
    }
}

/// Dragging turns or slides, the wheel zooms.
fn look(ui: &Ui, desk: &mut Desk, response: &Response) {
    let drag = response.drag_delta() / response.rect.height().max(1.0);
    if drag != Vec2::ZERO {
        desk.playing = None;
        if response.dragged_by(PointerButton::Middle) {
            desk.eye.pan(-drag.x, drag.y);
        } else {
            // Orbiting, the scene follows the hand; walking, the head does.
            let sense = if desk.eye.mode == EyeMode::Orbit {
                -1.0
            } else {
                1.0
            };
            desk.eye.turn(sense * TURN * drag.x, -sense * TURN * drag.y);
        }
    }
    if response.hovered() {
        let scroll = ui.input(|input| input.smooth_scroll_delta().y);
        let pinch = ui.input(|input| input.zoom_delta());
        if scroll != 0.0 || pinch != 1.0 {
            desk.eye.zoom((-scroll * 0.002).exp() / pinch);
        }
    }
}

fn titles(painter: &egui::Painter, desk: &Desk, tiles: &[Tile]) {
    let Some(snapshot) = desk.snapshot.as_ref().filter(|_| desk.panes.len() > 1) else {
        return;
    };
    for (i, (tile, pane)) in tiles.iter().zip(&desk.panes).enumerate() {
        let lane = &snapshot.lanes[pane.lane];
        let (text, color) = if snapshot.lanes.len() > 1 {
            (solver_label(lane.kind).to_owned(), LINES[i % LINES.len()])
        } else {
            (pane.title.clone(), Color32::WHITE)
        };
        plate(
            painter,
            tile.rect.left_top() + Vec2::splat(8.0),
            &text,
            color,
        );
    }
}

/// A line of text on a dark plate.
fn plate(painter: &egui::Painter, at: Pos2, text: &str, color: Color32) -> Rect {
    let galley = painter.layout_no_wrap(text.to_owned(), FontId::proportional(13.0), color);
    let rect = Rect::from_min_size(at, galley.size() + Vec2::new(14.0, 6.0));
    painter.rect_filled(rect, 4.0, Color32::from_black_alpha(205));
    painter.galley(at + Vec2::new(7.0, 3.0), galley, color);
    rect
}

/// A ring around the selected point, with its illuminance.
fn marks(painter: &egui::Painter, desk: &Desk, tiles: &[Tile]) {
    let (Some(reading), Some(snapshot)) = (&desk.selection, &desk.snapshot) else {
        return;
    };
    let units = snapshot.mesh().scene().units;
    for (tile, pane) in tiles.iter().zip(&desk.panes) {
        let lane = &snapshot.lanes[pane.lane];
        let irradiance = reading.element.and_then(|e| pane.irradiance(lane, e));
        let illuminance = irradiance.map_or(reading.illuminance, |h| units.illuminance(h));
        let camera = desk.eye.camera("view");
        let to = reading.point - camera.eye;
        let depth = to.dot(camera.forward);
        if depth <= 0.0 {
            continue;
        }
        let height = depth * (0.5 * desk.eye.vertical_fov).tan();
        let x = to.dot(camera.right()) / (height * tile.aspect());
        let y = to.dot(camera.up) / height;
        let at = tile.rect.center() + Vec2::new(x, -y) * 0.5 * tile.rect.size();
        if tile.rect.contains(at) {
            painter.circle_stroke(at, 6.0, Stroke::new(3.0, Color32::from_black_alpha(160)));
            painter.circle_stroke(at, 6.0, Stroke::new(1.5, Color32::WHITE));
            let text = format!("{} lx", number(f64::from(illuminance)));
            plate(painter, at + Vec2::new(12.0, -11.0), &text, Color32::WHITE);
        }
    }
}

/// The scale of false colours, if such colours are shown.
fn legend(painter: &egui::Painter, desk: &Desk, rect: Rect) {
    let (title, ticks) = match desk.prefs.display.quantity {
        Quantity::Illuminance => ("lx", linear_ticks(desk.scale_top)),
        Quantity::FormFactors => ("of the largest per area", decade_ticks()),
        Quantity::Light | Quantity::Wireframe => return,
    };
    let font = |size| FontId::proportional(size);
    let title = painter.layout_no_wrap(title.to_owned(), font(12.0), Color32::WHITE);
    let size = Vec2::new(14.0, (0.5 * rect.height()).clamp(80.0, 260.0));
    let bar = Rect::from_min_size(rect.left_bottom() + Vec2::new(16.0, -16.0 - size.y), size);
    let right = bar.right() + (title.size().x - size.x + 10.0).max(62.0);
    let plate = bar.expand2(Vec2::new(10.0, 26.0)).with_max_x(right);
    painter.rect_filled(plate, 5.0, Color32::from_black_alpha(205));
    let colors = Colormap::sequential();
    let steps = 64;
    for i in 0..steps {
        let share = (i as f32 + 0.5) / steps as f32;
        let y = bar.bottom() - bar.height() * i as f32 / steps as f32;
        let slice = Rect::from_x_y_ranges(bar.x_range(), y - bar.height() / steps as f32..=y + 0.5);
        painter.rect_filled(slice, 0.0, display_color(colors.color(share)));
    }
    for (share, text) in ticks {
        let at = Pos2::new(bar.right() + 6.0, bar.bottom() - share * bar.height());
        painter.text(at, Align2::LEFT_CENTER, text, font(11.0), Color32::WHITE);
    }
    let above = bar.left_top() - Vec2::new(0.0, 8.0 + title.size().y);
    painter.galley(above, title, Color32::WHITE);
}

/// Places along a scale from 0 to `top`, and what is written there.
fn linear_ticks(top: f32) -> Vec<(f32, String)> {
    let tick = |i: u8| {
        let share = f32::from(i) / 5.0;
        (share, number(f64::from(share * top)))
    };
    (0..=5).map(tick).collect()
}

/// The same for shares on a logarithmic scale up to 1.
fn decade_ticks() -> Vec<(f32, String)> {
    let tick = |below: u8| {
        let share = 1.0 - f32::from(below) / f32::from(DECADES);
        (share, percent(10_f64.powi(-i32::from(below))))
    };
    (0..=DECADES).map(tick).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tiles_cover_the_picture_in_real_pixels() {
        let rect = Rect::from_min_size(Pos2::new(10.0, 20.0), Vec2::new(800.0, 500.0));
        let [one] = &tiles(rect, 1, 1.5)[..] else {
            panic!("one tile for one pane")
        };
        assert_eq!(
            (one.rect, one.size),
            (rect, [1200, 750]),
            "all of it, at high density"
        );
        let four = tiles(rect, 4, 1.0);
        assert_eq!(four.len(), 4, "one each");
        assert!(
            four.iter()
                .all(|tile| rect.contains_rect(tile.rect) && tile.size == [398, 248]),
            "{four:?}"
        );
        assert!(tiles(rect, 0, 1.0).is_empty(), "nothing to show");
        let tiny = Rect::from_min_size(Pos2::ZERO, Vec2::ZERO);
        assert_eq!(
            tiles(tiny, 1, 1.0)[0].size,
            [1, 1],
            "a window that is folded up"
        );
    }
}
