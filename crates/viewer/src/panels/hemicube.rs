//! The hemicube of the patch that shoots next: the five faces of its item buffer, unfolded.

use crate::desk::Desk;
use crate::panels::section_to_unfold;
use crate::session::HemicubePicture;
use egui::{Color32, ColorImage, RichText, TextureHandle, TextureOptions, Ui, Vec2};
use hemicube_radiosity::form_factor::hemicube::ItemBuffers;
use hemicube_raster::Rgb;
use hemicube_raster::color::srgb8_from_linear;
use std::sync::Arc;

/// The picture on the device, and what it was made of.
#[derive(Default)]
pub struct HemicubeTexture {
    texture: Option<TextureHandle>,
    made_of: Option<(Arc<HemicubePicture>, bool, u64)>,
}

pub fn show(ui: &mut Ui, desk: &mut Desk, texture: &mut HemicubeTexture) {
    let unfolds = core::mem::take(&mut desk.unfolds_hemicube);
    section_to_unfold(ui, "Hemicube", false, unfolds, |ui| {
        ui.checkbox(&mut desk.shows_hemicube, "Of the patch that shoots next");
        if !desk.shows_hemicube {
            return;
        }
        ui.horizontal(|ui| {
            ui.selectable_value(&mut desk.hemicube_lit, false, "Elements");
            ui.selectable_value(&mut desk.hemicube_lit, true, "Light");
        });
        let picture = desk
            .snapshot
            .as_ref()
            .and_then(|snapshot| snapshot.hemicube.clone());
        let Some(picture) = picture else {
            let why = "Shown for gathering and shooting on the CPU; this way has no single patch at a time.";
            ui.label(RichText::new(why).small().weak());
            return;
        };
        texture.refresh(ui, desk, &picture);
        if let Some(texture) = &texture.texture {
            let side = ui.available_width().min(260.0);
            let image = egui::Image::new(texture).fit_to_exact_size(Vec2::splat(side));
            ui.add(image.alt_text("the five faces of the hemicube"));
        }
        ui.label(
            RichText::new(format!(
                "patch {}: top in the middle, half sides around it",
                picture.patch
            ))
            .small()
            .weak(),
        );
    });
}

impl HemicubeTexture {
    fn refresh(&mut self, ui: &Ui, desk: &Desk, picture: &Arc<HemicubePicture>) {
        let serial = if desk.hemicube_lit {
            desk.light_serial
        } else {
            0
        };
        let is_same = self.made_of.as_ref().is_some_and(|(old, lit, made)| {
            Arc::ptr_eq(old, picture) && (*lit, *made) == (desk.hemicube_lit, serial)
        });
        if is_same {
            return;
        }
        let image = unfolded(&picture.buffers, |item| color(desk, item));
        let options = TextureOptions::NEAREST;
        match &mut self.texture {
            Some(texture) => texture.set(image, options),
            None => self.texture = Some(ui.ctx().load_texture("hemicube", image, options)),
        }
        self.made_of = Some((picture.clone(), desk.hemicube_lit, serial));
    }
}

/// Colour of an element: as it is lit, or one of its own.
fn color(desk: &Desk, item: u32) -> Color32 {
    let (Some(snapshot), Some(pane)) = (&desk.snapshot, desk.panes.first()) else {
        return Color32::BLACK;
    };
    let element = item as usize;
    if element >= snapshot.mesh().elements().len() {
        return if item == ItemBuffers::ABSORBED {
            Color32::from_gray(40)
        } else {
            Color32::BLACK
        };
    }
    if !desk.hemicube_lit {
        return own_color(element);
    }
    let light = pane.light.radiosity(snapshot.mesh(), element) / core::f32::consts::PI;
    let shown = desk.prefs.display.tone_map().apply(light, desk.exposure);
    let [r, g, b] = shown.to_array().map(srgb8_from_linear);
    Color32::from_rgb(r, g, b)
}

/// Hues a golden angle apart, so that neighbours differ.
fn own_color(element: usize) -> Color32 {
    let hue = (element as f32 * 0.618_034).fract();
    let value = 0.55 + 0.4 * (element as f32 * 0.754_877_7).fract();
    egui::ecolor::Hsva::new(hue, 0.55, value, 1.0).into()
}

/// The five faces as a cross: the top in the middle, each side folded down where its upper edge meets the top.
fn unfolded(buffers: &ItemBuffers, color: impl Fn(u32) -> Color32) -> ColorImage {
    let n = buffers.resolution;
    let half = n / 2;
    let side = n + 2 * half;
    let mut image = ColorImage::filled([side, side], Color32::TRANSPARENT);
    for (face, items) in buffers.faces.iter().enumerate() {
        for (i, &item) in items.iter().enumerate() {
            let (x, y) = (i % n, i / n);
            let at = match face {
                0 => [half + x, half + y],
                // Row 0 of a side is its upper edge, next to the top.
                1 => [half + n + y, half + n - 1 - x],
                2 => [half + x, half - 1 - y.min(half - 1)],
                3 => [half - 1 - y.min(half - 1), half + x],
                _ => [half + n - 1 - x, half + n + y],
            };
            if at[0] < side && at[1] < side {
                image[(at[0], at[1])] = color(item);
            }
        }
    }
    image
}

/// A colour that a display shows, for labels beside it.
pub fn display_color(color: Rgb) -> Color32 {
    let [r, g, b] = color.to_array().map(srgb8_from_linear);
    Color32::from_rgb(r, g, b)
}
