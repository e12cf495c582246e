//! Pictures in rows and columns, each with lines of text below it.

use crate::{GalleryError, Request};
use core::ops::RangeInclusive;
use hemicube_chart::{Canvas, label};
use hemicube_raster::{Image, Rgb};

/// A picture and what is written below it.
#[derive(Debug, Clone)]
pub(crate) struct Cell {
    pub image: Image<Rgb>,
    pub lines: Vec<String>,
}

impl Cell {
    /// A picture with some lines.
    pub fn new(image: Image<Rgb>, lines: &[&str]) -> Self {
        let lines = lines.iter().map(|&line| line.to_owned()).collect();
        Self { image, lines }
    }
}

/// Space around pictures.
pub(crate) const MARGIN: usize = 12;

/// Height of the first, larger line and of the others.
const LINES: [usize; 2] = [24, 20];

/// Height of so many lines and of the gap above them.
fn text_height(lines: usize) -> usize {
    match lines {
        0 => 0,
        n => 4 + LINES[0] + (n - 1) * LINES[1],
    }
}

/// Cells of the size of the largest, row by row.
pub(crate) fn sheet(cells: &[Cell], columns: usize) -> Canvas {
    sheet_above(cells, columns, 0).0
}

/// The same with so many rows of pixels left below, and where they begin.
pub(crate) fn sheet_above(cells: &[Cell], columns: usize, below: usize) -> (Canvas, usize) {
    let most = |of: fn(&Cell) -> usize| cells.iter().map(of).max().unwrap_or(0);
    let (width, height) = (most(|c| c.image.width()), most(|c| c.image.height()));
    let text = text_height(most(|c| c.lines.len()));
    let step = (width + MARGIN, height + text + MARGIN);
    let rows = cells.len().div_ceil(columns);
    let bottom = MARGIN + rows * step.1;
    let mut canvas = Canvas::new(MARGIN + columns * step.0, bottom + below);
    for (i, cell) in cells.iter().enumerate() {
        let left = MARGIN + i % columns * step.0;
        let top = MARGIN + i / columns * step.1;
        canvas.paste(&cell.image, left, top);
        let below = top + cell.image.height() + 4;
        canvas.draw(&label(&cell.lines, width, text), left, below);
    }
    (canvas, bottom)
}

/// The size of each of `columns x rows` pictures with so many lines of text, so that their sheet has the size that is
/// asked for, or `default`.
pub(crate) fn cell_size(
    request: &Request,
    default: (usize, usize),
    (columns, rows): (usize, usize),
    lines: usize,
) -> Result<(usize, usize), GalleryError> {
    let (width, height) = request.size.unwrap_or(default);
    let refused = |why| GalleryError::Size { width, height, why };
    if width.max(height) > 4096 {
        let why = String::from("each side of this sheet is at most 4096; ask for less");
        return Err(refused(why));
    }
    let texts = rows * (text_height(lines) + MARGIN) + MARGIN;
    let cell = (
        width.saturating_sub(MARGIN * (columns + 1)) / columns,
        height.saturating_sub(texts) / rows,
    );
    if cell.0.min(cell.1) < 8 {
        let why = String::from("its pictures would be below 8 pixels; ask for a larger one");
        return Err(refused(why));
    }
    Ok(cell)
}

/// The size that is asked for, or the usual one, if both sides are in a range.
pub(crate) fn picture_size(
    request: &Request,
    usual: (usize, usize),
    sides: RangeInclusive<usize>,
) -> Result<(usize, usize), GalleryError> {
    let (width, height) = request.size.unwrap_or(usual);
    if sides.contains(&width) && sides.contains(&height) {
        return Ok((width, height));
    }
    let (low, high) = sides.into_inner();
    let why = format!("ask for {low} to {high} in each direction");
    Err(GalleryError::Size { width, height, why })
}

/// A picture from a function of the pixel.
pub(crate) fn picture(
    width: usize,
    height: usize,
    color: impl Fn(usize, usize) -> Rgb,
) -> Image<Rgb> {
    let pixels = (0..width * height).map(|i| color(i % width, i / width));
    Image::from_pixels(width, height, pixels.collect()).expect("one colour for each pixel")
}

/// Every pixel as a block of so many pixels.
pub(crate) fn magnified(image: &Image<Rgb>, times: usize) -> Image<Rgb> {
    let (width, height) = (image.width() * times, image.height() * times);
    picture(width, height, |x, y| *image.pixel(x / times, y / times))
}

/// A part of an image: a column, a row, a width and a height within it.
pub(crate) fn cropped(image: &Image<Rgb>, [left, top, width, height]: [usize; 4]) -> Image<Rgb> {
    picture(width, height, |x, y| *image.pixel(left + x, top + y))
}

#[cfg(test)]
mod tests {
    use super::*;
    use hemicube_raster::image::{ReadOptions, read_picture};

    #[test]
    fn magnified_pixels_are_blocks_and_cropped_ones_themselves() {
        let image = picture(3, 2, |x, y| Rgb::splat((3 * y + x) as f32));
        let large = magnified(&image, 3);
        assert_eq!((large.width(), large.height()), (9, 6), "size");
        assert_eq!(*large.pixel(8, 5), Rgb::splat(5.0), "last block");
        assert_eq!(*large.pixel(2, 3), Rgb::splat(3.0), "second row");
        assert_eq!(
            cropped(&image, [1, 1, 2, 1]).pixels(),
            &[4.0, 5.0].map(Rgb::splat),
            "part"
        );
    }

    #[test]
    fn sheets_have_the_size_that_is_asked_for() {
        let request = Request {
            size: Some((300, 200)),
            ..Request::default()
        };
        let (width, height) = cell_size(&request, (1, 1), (3, 2), 2).expect("it fits");
        let cell = Cell::new(Image::filled(width, height, Rgb::BLACK), &["a", "b"]);
        let png = sheet(&vec![cell; 6], 3).png().expect("a picture");
        let options = ReadOptions::default();
        let image = read_picture(&png, &options).expect("a PNG").image;
        let (w, h) = (image.width(), image.height());
        assert!(w <= 300 && 300 - w < 3, "{w}");
        assert!(h <= 200 && 200 - h < 2, "{h}");
        let small = cell_size(&request, (1, 1), (30, 2), 2).expect_err("too many");
        assert!(small.to_string().contains("ask for"), "{small}");
    }

    #[test]
    fn sizes_out_of_range_are_refused_with_the_range() {
        let asked = |size| Request {
            size: Some(size),
            ..Request::default()
        };
        let error = picture_size(&asked((0, 64)), (1, 1), 16..=512).expect_err("no width");
        assert!(error.to_string().contains("16 to 512"), "{error}");
        let size = picture_size(&Request::default(), (64, 32), 16..=512);
        assert_eq!(size.expect("the usual one"), (64, 32));
    }
}
