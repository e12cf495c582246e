//! A test card: numbered fields of colour with a letter in each, so that one sees which part of a texture is where, and
//! whether it is turned, mirrored or stretched.

use glam::{UVec2, Vec2};
use hemicube_raster::texture::{Texture, TextureOptions};
use hemicube_raster::{Image, Rgb};

/// Rows of the letter F, which is like no turned or mirrored one.
const LETTER: [&[u8]; 7] = [
    b"#####", b"#    ", b"#    ", b"#### ", b"#    ", b"#    ", b"#    ",
];

/// Texels in a side of the card.
const SIDE: usize = 512;

/// A card of so many fields. From left to right hues go once around; from top to bottom they become darker.
pub(super) fn card(fields: UVec2) -> Texture {
    let texel = |i: usize| {
        let at = Vec2::new((i % SIDE) as f32 + 0.5, (i / SIDE) as f32 + 0.5) / SIDE as f32;
        card_color(at, fields.as_vec2())
    };
    let image = Image::from_pixels(SIDE, SIDE, (0..SIDE * SIDE).map(texel).collect());
    let image = image.expect("a texel for each place");
    Texture::from_rgb(&image, &TextureOptions::default()).expect("a texture of this size")
}

fn card_color(at: Vec2, fields: Vec2) -> Rgb {
    let place = at * fields;
    let field = place.floor();
    let within = place - field;
    let is_light = (field.x + field.y).rem_euclid(2.0) == 0.0;
    let lightness = (1.0 - 0.65 * at.y) * if is_light { 1.0 } else { 0.55 };
    let to_edge = within.min(1.0 - within).min_element();
    if to_edge < 0.03 {
        return Rgb::splat(0.02);
    }
    if letter_covers(within) {
        return Rgb::splat(0.015);
    }
    hue(at.x) * lightness
}

/// Whether the letter, upright in the middle of a field, has ink there.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "checked to be within the letter"
)]
fn letter_covers(within: Vec2) -> bool {
    let cell = (within - Vec2::new(0.275, 0.185)) / 0.09;
    let is_within = cell.x >= 0.0 && cell.y >= 0.0 && cell.x < 5.0 && cell.y < 7.0;
    is_within && LETTER[cell.y as usize][cell.x as usize] == b'#'
}

/// A pure colour; 0 and 1 are red.
fn hue(turn: f32) -> Rgb {
    let band = |shift: f32| {
        let t = (turn + shift).rem_euclid(1.0) * 6.0;
        ((t - 3.0).abs() - 1.0).clamp(0.0, 1.0)
    };
    let pure = Rgb::new(band(0.0), band(2.0 / 3.0), band(1.0 / 3.0));
    pure * 0.8 + Rgb::splat(0.12)
}
