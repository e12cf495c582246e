//! Figures of pixels: magnified cells with a grid, and what a textbook draws on top of them.

use crate::{GalleryError, Request};
use glam::{DVec2, IVec2};
use hemicube_chart::{Anchor, Canvas, Drawing};
use hemicube_raster::{Image, Rgb, color};

/// Dark enough to read.
pub const INK: [u8; 3] = [40, 40, 40];
/// The true curve.
pub const TRUE: [u8; 3] = [213, 94, 0];

/// Linear light of an 8-bit sRGB colour.
pub fn rgb(color: [u8; 3]) -> Rgb {
    Rgb::from(color.map(|code| color::linear_from_srgb8_table()[usize::from(code)]))
}

/// Panels of magnified pixels side by side on a sheet, each with a title above and a line of text below.
pub struct Sheet {
    canvas: Canvas,
    drawing: Drawing,
    /// Size of a cell in a panel of `columns` by `rows` pixels.
    cell: usize,
    columns: usize,
    rows: usize,
    /// Size of a cell in each panel; larger in one that shows fewer pixels.
    cells: Vec<usize>,
}

const MARGIN: usize = 16;
const TITLE: usize = 30;
const CAPTION: usize = 52;

impl Sheet {
    /// A sheet for so many panels of `columns` by `rows` magnified pixels that fits the size asked for.
    pub fn new(
        request: &Request,
        default: (usize, usize),
        panels: usize,
        [columns, rows]: [usize; 2],
    ) -> Result<Self, GalleryError> {
        let (width, height) = request.size.unwrap_or(default);
        let room = width.saturating_sub(MARGIN) / panels;
        let cell = (room.saturating_sub(MARGIN) / columns)
            .min(height.saturating_sub(TITLE + CAPTION) / rows)
            .min(64);
        if cell == 0 {
            let why = "too small for its panels; ask for at least 640 x 360";
            return Err(GalleryError::Size {
                width,
                height,
                why: why.to_owned(),
            });
        }
        let (width, height) = (
            panels * (columns * cell + MARGIN) + MARGIN,
            rows * cell + TITLE + CAPTION,
        );
        Ok(Self {
            canvas: Canvas::new(width, height),
            drawing: Drawing::new(width, height),
            cell,
            columns,
            rows,
            cells: vec![cell; panels],
        })
    }

    fn left(&self, panel: usize) -> usize {
        MARGIN + panel * (self.columns * self.cell + MARGIN)
    }

    /// Shows pixels in a panel as large as they fit, with a grid where there is room for one. Before anything is drawn
    /// on top of them.
    pub fn pixels(&mut self, panel: usize, pixels: &Image<Rgb>) {
        let room = [self.columns * self.cell, self.rows * self.cell];
        let cell = (room[0] / pixels.width()).min(room[1] / pixels.height());
        self.cells[panel] = cell;
        let left = self.left(panel);
        self.canvas.paste(&magnified(pixels, cell), left, TITLE);
    }

    /// The place on the sheet of a point whose unit is a pixel; pixel centres are at halves.
    fn place(&self, panel: usize, point: DVec2) -> [f64; 2] {
        let origin = DVec2::new(self.left(panel) as f64, TITLE as f64);
        (origin + point * self.cells[panel] as f64).to_array()
    }

    /// Draws a straight line between two points.
    pub fn line(&mut self, panel: usize, ends: [DVec2; 2], color: [u8; 3], width: f64) {
        let [from, to] = ends.map(|point| self.place(panel, point));
        self.drawing.line(from, to, color, width);
    }

    /// Draws a curve through points.
    pub fn curve(&mut self, panel: usize, points: &[DVec2], color: [u8; 3], width: f64) {
        let places = points.iter().map(|&point| self.place(panel, point));
        self.drawing.path(places.collect(), color, width);
    }

    /// Marks a point by a cross.
    pub fn cross(&mut self, panel: usize, point: DVec2, color: [u8; 3]) {
        if self.cells[panel] >= 8 {
            let [x, y] = self.place(panel, point);
            self.drawing
                .text([x, y - 9.0], "×", Anchor::Middle, 16, color);
        }
    }

    /// Writes a word in the middle of a cell, if it has room for one.
    pub fn word(&mut self, panel: usize, pixel: IVec2, text: &str, color: [u8; 3]) {
        if self.cells[panel] >= 12 {
            let [x, y] = self.place(panel, pixel.as_dvec2() + 0.5);
            self.drawing
                .text([x, y - 8.0], text, Anchor::Middle, 16, color);
        }
    }

    /// What a panel shows, and a line or two about it.
    pub fn label(&mut self, panel: usize, title: &str, captions: &[String]) {
        let left = self.left(panel) as f64;
        self.text([left, 6.0], title);
        let below = (TITLE + self.rows * self.cell) as f64 + 6.0;
        for (caption, line) in captions.iter().zip([0.0, 20.0]) {
            self.text([left, below + line], caption);
        }
    }

    fn text(&mut self, at: [f64; 2], text: &str) {
        // A letter is about nine pixels wide; what does not fit the panel is left out.
        let letters = (self.columns * self.cell + MARGIN / 2) / 9;
        let text: String = text.chars().take(letters).collect();
        self.drawing.text(at, &text, Anchor::Start, 16, INK);
    }

    /// All of it.
    pub fn finish(mut self) -> Canvas {
        self.canvas.draw(&self.drawing, 0, 0);
        self.canvas
    }
}

/// Every pixel as a square of `cell` pixels.
fn magnified(pixels: &Image<Rgb>, cell: usize) -> Image<Rgb> {
    let grid = rgb([205, 205, 205]);
    let (width, height) = (pixels.width() * cell, pixels.height() * cell);
    let mut image = Image::filled(width + 1, height + 1, grid);
    let has_grid = cell >= 5;
    for y in 0..height {
        for x in 0..width {
            let is_line = has_grid && (x % cell == 0 || y % cell == 0);
            if !is_line {
                *image.pixel_mut(x, y) = *pixels.pixel(x / cell, y / cell);
            }
        }
    }
    image
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_show_their_pixels() {
        let mut pixels = Image::filled(2, 1, Rgb::WHITE);
        *pixels.pixel_mut(1, 0) = Rgb::BLACK;
        let image = magnified(&pixels, 8);
        assert_eq!((image.width(), image.height()), (17, 9));
        assert_eq!(*image.pixel(4, 4), Rgb::WHITE);
        assert_eq!(*image.pixel(12, 4), Rgb::BLACK);
        assert_ne!(*image.pixel(8, 4), Rgb::BLACK, "the grid");
    }

    #[test]
    fn a_sheet_without_room_is_refused() {
        let request = Request {
            size: Some((30, 30)),
            ..Request::default()
        };
        let error = Sheet::new(&request, (800, 600), 4, [20, 20]).map(|_| ());
        let message = error.expect_err("too small").to_string();
        assert!(message.contains("30 x 30"), "{message}");
    }
}
