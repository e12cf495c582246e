//! Polygons under both fill rules, thick and dashed strokes.

use super::figure::{Sheet, TRUE, rgb};
use crate::{Exhibit, GalleryError, Piece, Request};
use glam::{DVec2, IVec2};
use hemicube_raster::line::{Dashes, draw_dashed_line};
use hemicube_raster::polygon::{FillRule, fill_polygon};
use hemicube_raster::stroke::{Cap, Join, Path, Stroke, draw_stroke};
use hemicube_raster::target::Window;
use hemicube_raster::{Image, Rgb};
use std::f64::consts::TAU;

pub const FILL_RULES: Exhibit = Exhibit {
    name: "fill-rules",
    about: "a pentagram and nested squares filled by the even-odd and by the non-zero rule",
    needs: &[],
    draw: draw_fill_rules,
};

pub const THICK_AND_DASHED: Exhibit = Exhibit {
    name: "thick-and-dashed",
    about: "thick strokes with three kinds of joins and caps, and dashes that keep their phase when clipped",
    needs: &[],
    draw: draw_thick_and_dashed,
};

const FILL: [u8; 3] = [120, 160, 205];
const PALE: [u8; 3] = [215, 225, 238];

/// A star whose contour goes to every second of its five tips.
fn pentagram(center: DVec2, radius: f64) -> Vec<DVec2> {
    (0..5)
        .map(|k| DVec2::from_angle((f64::from(2 * k) / 5.0 - 0.25) * TAU) * radius + center)
        .collect()
}

fn square(center: DVec2, half: f64, is_reversed: bool) -> Vec<DVec2> {
    let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
    let mut square = corners.map(|c| center + DVec2::from(c) * half).to_vec();
    if is_reversed {
        square.reverse();
    }
    square
}

/// A star, two squares of the same direction, and two of opposite directions.
fn contours() -> Vec<Vec<DVec2>> {
    let [left, right] = [DVec2::new(10.5, 30.5), DVec2::new(29.5, 30.5)];
    vec![
        pentagram(DVec2::new(20.0, 11.6), 11.0),
        square(left, 7.5, false),
        square(left, 3.5, false),
        square(right, 7.5, false),
        square(right, 3.5, true),
    ]
}

fn draw_fill_rules(request: &Request) -> Result<Vec<Piece>, GalleryError> {
    let mut sheet = Sheet::new(request, (1100, 620), 2, [40, 40])?;
    let rules = [
        (FillRule::EvenOdd, "Even-odd", "overlaps are holes"),
        (
            FillRule::NonZero,
            "Non-zero",
            "only opposite directions make holes",
        ),
    ];
    for (panel, (rule, title, about)) in rules.into_iter().enumerate() {
        let mut image = Image::filled(40, 40, Rgb::WHITE);
        fill_polygon(&mut image.pen(rgb(FILL)), contours(), rule);
        sheet.pixels(panel, &image);
        for mut contour in contours() {
            contour.push(contour[0]);
            sheet.curve(panel, &contour, TRUE, 2.0);
        }
        let count = image.pixels().iter().filter(|&&p| p != Rgb::WHITE).count();
        let captions = [format!("{count} pixels"), about.to_owned()];
        sheet.label(panel, title, &captions);
    }
    Ok(vec![Piece::sheet("", &sheet.finish())?])
}

fn draw_thick_and_dashed(request: &Request) -> Result<Vec<Piece>, GalleryError> {
    let mut sheet = Sheet::new(request, (1500, 590), 3, [64, 64])?;
    draw_joins(&mut sheet);
    draw_dashes(&mut sheet);
    draw_clipped(&mut sheet);
    Ok(vec![Piece::sheet("", &sheet.finish())?])
}

fn draw_joins(sheet: &mut Sheet) {
    let mut image = Image::filled(64, 64, Rgb::WHITE);
    let kinds = [
        (Join::Miter, Cap::Butt),
        (Join::Round, Cap::Round),
        (Join::Bevel, Cap::Square),
    ];
    let path = |row: usize| {
        let y = 18.0 + 20.0 * row as f64;
        [[8.0, y], [24.0, y - 12.0], [34.0, y], [54.0, y - 4.0]].map(DVec2::from)
    };
    for (row, (join, cap)) in kinds.into_iter().enumerate() {
        let stroke = Stroke::new(7.0).with_join(join).with_cap(cap);
        draw_stroke(&mut image.pen(rgb(FILL)), &Path::open(path(row)), &stroke);
    }
    sheet.pixels(0, &image);
    for row in 0..kinds.len() {
        sheet.curve(0, &path(row), TRUE, 2.0);
    }
    let captions = ["mitre and butt, round and round,", "bevel and square"].map(str::to_owned);
    sheet.label(0, "Joins and caps, width 7", &captions);
}

fn draw_dashes(sheet: &mut Sheet) {
    let mut image = Image::filled(64, 64, Rgb::WHITE);
    let star = pentagram(DVec2::new(32.0, 33.0), 29.0);
    let dashes = Dashes::new(&[8.0, 4.0], 0.0).expect("a pattern of 12 pixels");
    let stroke = Stroke::new(3.0).with_dashes(dashes);
    draw_stroke(&mut image.pen(rgb(FILL)), &Path::closed(star), &stroke);
    sheet.pixels(1, &image);
    let captions = ["dashes go round the corners,", "pattern 8 + 4, width 3"].map(str::to_owned);
    sheet.label(1, "A dashed star", &captions);
}

/// Rays that are drawn whole in a pale colour, and in a window in a dark one: dashes lie on dashes.
fn draw_clipped(sheet: &mut Sheet) {
    let mut image = Image::filled(64, 64, Rgb::WHITE);
    let window = Window::new(16..48, 16..48);
    let whole = image.clone();
    let mut clipped = 0;
    for k in 0..12 {
        let ray = DVec2::from_angle((f64::from(k) + 0.3) / 12.0 * TAU) * 31.0;
        let (from, to) = (
            IVec2::splat(32),
            (DVec2::splat(32.0) + ray).round().as_ivec2(),
        );
        let dashes = Dashes::new(&[5.0, 3.0], 0.0).expect("a pattern of 8 pixels");
        draw_dashed_line(&mut image.pen(rgb(PALE)), to, from, &dashes);
        draw_dashed_line(
            &mut image.pen(rgb([30, 70, 140])).within(window),
            to,
            from,
            &dashes,
        );
    }
    for (pixel, white) in image.pixels().iter().zip(whole.pixels()) {
        clipped += usize::from(pixel != white && *pixel != rgb(PALE));
    }
    sheet.pixels(2, &image);
    let border = square(DVec2::splat(32.0), 16.0, false);
    sheet.curve(2, &[border.clone(), vec![border[0]]].concat(), TRUE, 2.0);
    let captions = [
        format!("dark: {clipped} pixels, drawn in the window"),
        String::from("pale: the whole lines"),
    ];
    sheet.label(2, "Clipping keeps the phase", &captions);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn count(rule: FillRule) -> usize {
        let mut image = Image::filled(40, 40, 0_u8);
        fill_polygon(&mut image.pen(1), contours(), rule);
        image.pixels().iter().filter(|&&p| p == 1).count()
    }

    #[test]
    fn rules_differ_by_the_pentagon_and_one_square() {
        // The squares are 15 and 7 pixels wide.
        let pentagon = count(FillRule::NonZero) - count(FillRule::EvenOdd) - 49;
        // Its circumradius is that of the star over the golden ratio squared.
        let radius = 11.0 / 1.618_034_f64.powi(2);
        let area = 2.5 * radius * radius * (TAU / 5.0).sin();
        assert!(
            (pentagon as f64 - area).abs() < 6.0,
            "{pentagon} for {area}"
        );
    }
}
