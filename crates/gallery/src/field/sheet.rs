//! Pictures of fields with their legend.

use hemicube_chart::{Anchor, Canvas, Drawing, label};
use hemicube_raster::antialias::Antialiasing;
use hemicube_raster::colormap::FieldPaint;
use hemicube_raster::{Image, Rgb};

/// Around everything.
const MARGIN: usize = 16;

/// Height of the bar of colours, and of what stands below it.
const BAR: usize = 20;
const BELOW_BAR: usize = 28;

/// Pixels in a direction that can be asked for.
pub const SIDES: core::ops::RangeInclusive<usize> = 16..=2048;

/// How all fields are sampled.
pub fn antialiasing() -> Antialiasing {
    "3x3:bartlett".parse().unwrap_or_default()
}

/// Pictures side by side, each below its title, with one legend and some lines of text.
pub fn sheet(
    pictures: &[(&str, &Image<Rgb>)],
    paint: &FieldPaint,
    quantity: &str,
    notes: &[String],
) -> Canvas {
    let width = |(_, image): &(&str, &Image<Rgb>)| image.width() + MARGIN;
    let total = (MARGIN + pictures.iter().map(width).sum::<usize>()).max(320);
    let height = pictures
        .iter()
        .map(|(_, image)| image.height())
        .max()
        .unwrap_or(0);
    let title = 28;
    let legend = MARGIN + title + height + MARGIN;
    let text = legend + 24 + BAR + BELOW_BAR;
    let mut canvas = Canvas::new(total, text + 24 * notes.len() + MARGIN);
    let mut left = MARGIN;
    for (name, image) in pictures {
        canvas.draw(
            &label(&[(*name).to_owned()], image.width(), title),
            left,
            MARGIN,
        );
        canvas.paste(image, left, MARGIN + title);
        left += image.width() + MARGIN;
    }
    let across = (total - 2 * MARGIN).min(560);
    canvas.draw(&label(&[quantity.to_owned()], across, 24), MARGIN, legend);
    canvas.paste(&bar(paint, across), MARGIN, legend + 24);
    canvas.draw(&ticks(paint, across), 0, legend + 24 + BAR);
    for (i, note) in notes.iter().enumerate() {
        let mut line = Drawing::new(total, 24);
        line.text([MARGIN as f64, 0.0], note, Anchor::Start, 16, [40; 3]);
        canvas.draw(&line, 0, text + 24 * i);
    }
    canvas
}

/// The values from low to high as they are painted, isolines among them.
fn bar(paint: &FieldPaint, width: usize) -> Image<Rgb> {
    let [low, high] = paint.range;
    let change = (high - low) / width as f32;
    let pixel = |i: usize| {
        let value = low + change * ((i % width) as f32 + 0.5);
        paint.color(value, change)
    };
    let pixels = (0..width * BAR).map(pixel).collect();
    Image::from_pixels(width, BAR, pixels).expect("one colour for each pixel")
}

/// Numbers at both ends and in the middle.
fn ticks(paint: &FieldPaint, width: usize) -> Drawing {
    let [low, high] = paint.range;
    let mut drawing = Drawing::new(width + 2 * MARGIN, BELOW_BAR);
    for (share, anchor) in [
        (0.0, Anchor::Start),
        (0.5, Anchor::Middle),
        (1.0, Anchor::End),
    ] {
        let at = [MARGIN as f64 + share * width as f64, 4.0];
        let value = f64::from(low) + share * (f64::from(high) - f64::from(low));
        drawing.text(at, &short(value), anchor, 16, [40; 3]);
    }
    drawing
}

/// A number in a few characters.
pub fn short(value: f64) -> String {
    let size = value.abs();
    if size != 0.0 && !(1e-3..1e5).contains(&size) {
        return format!("{value:.2e}");
    }
    let text = format!("{value:.3}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    String::from(if text == "-0" { "0" } else { text })
}

/// The largest of 1, 2 or 5 times a power of ten that is at most this; 1 if it is not positive.
pub fn round_down(value: f32) -> f32 {
    let value = f64::from(value);
    if !(value > 0.0 && value.is_finite()) {
        return 1.0;
    }
    let unit = 10_f64.powf(value.log10().floor());
    let factor = [5.0, 2.0, 1.0]
        .into_iter()
        .find(|f| f * unit <= value * 1.000_001);
    #[expect(clippy::cast_possible_truncation, reason = "about as large as an f32")]
    let rounded = (unit * factor.unwrap_or(1.0)) as f32;
    rounded
}

#[cfg(test)]
mod tests {
    use super::*;
    use hemicube_raster::colormap::Colormap;

    #[test]
    fn numbers_are_short() {
        for (value, text) in [
            (0.0, "0"),
            (-0.0, "0"),
            (1.5, "1.5"),
            (-120.0, "-120"),
            (3e-7, "3.00e-7"),
            (1e6, "1.00e6"),
        ] {
            assert_eq!(short(value), text, "{value}");
        }
        for (value, round) in [
            (0.7, 0.5),
            (5.0, 5.0),
            (19.0, 10.0),
            (0.02, 0.02),
            (0.0, 1.0),
            (f32::NAN, 1.0),
        ] {
            assert!((round_down(value) / round - 1.0).abs() < 1e-6, "{value}");
        }
    }

    #[test]
    fn sheets_bear_any_range() {
        let image = Image::filled(20, 10, Rgb::BLACK);
        for range in [[0.0, 1.0], [2.0, 2.0], [-3e38, 3e38]] {
            let paint = FieldPaint::new(Colormap::grey(), range);
            assert!(
                sheet(&[("one", &image)], &paint, "load / N", &[])
                    .png()
                    .is_ok(),
                "{range:?}"
            );
        }
    }
}
