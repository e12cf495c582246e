//! Sheets of pictures, each with its name and figures below.

use crate::{GalleryError, Request};
use hemicube_chart::{Canvas, label};
use hemicube_raster::{Image, Rgb};

const GAP: usize = 12;
const LINE: usize = 22;

/// A picture with lines of text below it.
pub(super) struct Tile {
    pub(super) image: Image<Rgb>,
    pub(super) lines: Vec<String>,
}

/// Tiles of equal size, row by row.
pub(super) fn sheet(tiles: &[Tile], columns: usize) -> Canvas {
    let most = |f: fn(&Tile) -> usize| tiles.iter().map(f).max().unwrap_or(0);
    let (width, height) = (most(|t| t.image.width()), most(|t| t.image.height()));
    let text = LINE * most(|t| t.lines.len());
    let rows = tiles.len().div_ceil(columns);
    let mut canvas = Canvas::new(
        GAP + columns * (width + GAP),
        GAP + rows * (height + text + GAP),
    );
    for (i, tile) in tiles.iter().enumerate() {
        let left = GAP + i % columns * (width + GAP);
        let top = GAP + i / columns * (height + text + GAP);
        canvas.paste(&tile.image, left, top);
        let below = top + tile.image.height() + 4;
        canvas.draw(&label(&tile.lines, width, text), left, below);
    }
    canvas
}

/// The size asked for, or the usual one.
pub(super) fn size(
    request: &Request,
    usual: (usize, usize),
) -> Result<(usize, usize), GalleryError> {
    let (width, height) = request.size.unwrap_or(usual);
    let range = 16..=2048;
    if range.contains(&width) && range.contains(&height) {
        return Ok((width, height));
    }
    let why = "each side of a picture here has from 16 to 2048 pixels";
    Err(GalleryError::Size { width, height, why })
}

/// A picture from a function of the pixel.
pub(super) fn picture(
    width: usize,
    height: usize,
    color: impl Fn(usize, usize) -> Rgb,
) -> Image<Rgb> {
    let pixels = (0..width * height)
        .map(|i| color(i % width, i / width))
        .collect();
    Image::from_pixels(width, height, pixels).expect("one colour per pixel")
}
