//! Pictures side by side with a line of text below each.

use hemicube_chart::{Canvas, label};
use hemicube_raster::{Image, Rgb};

/// A picture with what is written below it.
pub(super) struct Panel {
    pub image: Image<Rgb>,
    pub lines: Vec<String>,
}

impl Panel {
    pub fn new(image: Image<Rgb>, lines: &[&str]) -> Self {
        Self {
            image,
            lines: lines.iter().map(|&line| line.to_owned()).collect(),
        }
    }
}

const MARGIN: usize = 16;

/// Panels in rows of `columns`; all of the size of the largest.
pub(super) fn sheet(panels: &[Panel], columns: usize) -> Canvas {
    let most = |size: &dyn Fn(&Panel) -> usize| panels.iter().map(size).max().unwrap_or(0);
    let width = most(&|panel| panel.image.width());
    let height = most(&|panel| panel.image.height());
    let text = 24 * most(&|panel| panel.lines.len());
    let step = [width + MARGIN, height + text + MARGIN];
    let rows = panels.len().div_ceil(columns);
    let mut canvas = Canvas::new(columns * step[0] + MARGIN, rows * step[1] + MARGIN);
    for (i, panel) in panels.iter().enumerate() {
        let (left, top) = (
            MARGIN + i % columns * step[0],
            MARGIN + i / columns * step[1],
        );
        canvas.paste(&panel.image, left, top);
        let text = label(&panel.lines, width, text);
        canvas.draw(&text, left, top + panel.image.height() + 4);
    }
    canvas
}

/// Every pixel as a block of so many pixels.
pub(super) fn magnified(image: &Image<Rgb>, times: usize) -> Image<Rgb> {
    let (width, height) = (image.width() * times, image.height() * times);
    let pixel = |i: usize| *image.pixel(i % width / times, i / width / times);
    let pixels = (0..width * height).map(pixel).collect();
    Image::from_pixels(width, height, pixels).expect("as many pixels as there are")
}

/// A part of an image: a column, a row, a width and a height within it.
pub(super) fn cropped(image: &Image<Rgb>, [x, y, width, height]: [usize; 4]) -> Image<Rgb> {
    let pixel = |i: usize| *image.pixel(x + i % width, y + i / width);
    let pixels = (0..width * height).map(pixel).collect();
    Image::from_pixels(width, height, pixels).expect("as many pixels as there are")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn magnified_pixels_are_blocks_and_cropped_ones_themselves() {
        let pixels = (0..6).map(|i| Rgb::splat(i as f32)).collect();
        let image = Image::from_pixels(3, 2, pixels).expect("6 pixels");
        let large = magnified(&image, 3);
        assert_eq!((large.width(), large.height()), (9, 6), "size");
        assert_eq!(*large.pixel(8, 5), Rgb::splat(5.0), "last block");
        assert_eq!(
            *large.pixel(2, 3),
            Rgb::splat(3.0),
            "block in the second row"
        );
        assert_eq!(
            cropped(&image, [1, 1, 2, 1]).pixels(),
            &[4.0, 5.0].map(Rgb::splat),
            "part"
        );
    }
}
