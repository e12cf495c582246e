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
    let side = n + 2 * (n / 2);
    let mut image = ColorImage::filled([side, side], Color32::TRANSPARENT);
    for (face, items) in buffers.faces.iter().enumerate() {
        for (i, &item) in items.iter().enumerate() {
            let [x, y] = place(face, [i % n, i / n], n);
            image[(x, y)] = color(item);
        }
    }
    image
}

/// Where a cell of a face lies in the cross. The top shows -x at its right and +y above, as one sees them who looks up
/// from the patch; the sides look to +x, +y, -x and -y, and row 0 of each meets the top.
fn place(face: usize, [column, row]: [usize; 2], n: usize) -> [usize; 2] {
    let half = n / 2;
    let (inner, outer) = (half - 1 - row.min(half - 1), half + n + row.min(half - 1));
    match face {
        0 => [half + column, half + row],
        1 => [inner, half + column],
        2 => [half + n - 1 - column, inner],
        3 => [outer, half + n - 1 - column],
        _ => [half + column, outer],
    }
}

/// A colour that a display shows, for labels beside it.
pub fn display_color(color: Rgb) -> Color32 {
    let [r, g, b] = color.to_array().map(srgb8_from_linear);
    Color32::from_rgb(r, g, b)
}

#[cfg(test)]
mod tests {
    use super::*;
    use hemicube_radiosity::form_factor::hemicube::{Hemicube, HemicubeOptions};
    use hemicube_radiosity::{PatchMesh, PatchOptions};
    use hemicube_scene::builtin;

    #[test]
    fn what_meets_in_the_room_meets_at_the_folds() {
        let scene = Arc::new(builtin::scene("cornell").expect("it is built in"));
        let options = PatchOptions::default().with_elements(300).with_patches(60);
        let mesh = Arc::new(PatchMesh::build(scene, options).expect("it has faces"));
        let n = 64;
        let hemicubes = HemicubeOptions::default()
            .with_resolution(n)
            .with_max_points(1);
        let hemicube = Hemicube::new(mesh.clone(), hemicubes).expect("it fits");
        let n = n as usize;
        let (mut same, mut all) = ([0; 4], [0; 4]);
        for &patch in mesh.patches() {
            let buffers = hemicube.item_buffers(patch);
            let mut cross = vec![ItemBuffers::NOTHING; 4 * n * n];
            for (face, items) in buffers.faces.iter().enumerate() {
                for (i, &item) in items.iter().enumerate() {
                    let [x, y] = place(face, [i % n, i / n], n);
                    cross[2 * n * y + x] = item;
                }
            }
            let (low, high) = (n / 2, n / 2 + n);
            for i in low..high {
                let folds = [
                    ([low, i], [low - 1, i]),
                    ([i, low], [i, low - 1]),
                    ([high - 1, i], [high, i]),
                    ([i, high - 1], [i, high]),
                ];
                for (fold, (a, b)) in folds.into_iter().enumerate() {
                    let at = |[x, y]: [usize; 2]| cross[2 * n * y + x];
                    same[fold] += usize::from(at(a) == at(b));
                    all[fold] += 1;
                }
            }
        }
        for fold in 0..4 {
            // Neighbouring cells see neighbouring points; edges of elements run between some of them.
            assert!(
                same[fold] * 10 > all[fold] * 8,
                "fold {fold}: {} of {}",
                same[fold],
                all[fold]
            );
        }
    }
}
