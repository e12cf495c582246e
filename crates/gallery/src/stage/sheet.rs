//! Pictures in rows and columns, each with lines of text below it.

use crate::{GalleryError, Request};
use hemicube_chart::{Canvas, label};
use hemicube_raster::{Image, Rgb};

/// A picture and what is written below it.
#[derive(Debug, Clone)]
pub(crate) struct Cell {
    pub image: Image<Rgb>,
    pub lines: Vec<String>,
}

/// A sheet divided into cells of one size.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Grid {
    columns: usize,
    /// Width and height of each picture.
    pub cell: (usize, usize),
    lines: usize,
}

const MARGIN: usize = 12;

/// Height of the first, larger line and of the others.
const LINES: [usize; 2] = [24, 20];

impl Grid {
    /// Pictures of one size.
    pub fn of_cells(columns: usize, cell: (usize, usize), lines: usize) -> Self {
        Self {
            columns,
            cell,
            lines,
        }
    }

    /// As large pictures as fit on a sheet of the size that is asked for, or of `default`.
    pub fn of_request(
        request: &Request,
        default: (usize, usize),
        (columns, rows): (usize, usize),
        lines: usize,
    ) -> Result<Self, GalleryError> {
        let (width, height) = request.size.unwrap_or(default);
        let refused = |why| GalleryError::Size { width, height, why };
        if width.max(height) > 4096 {
            return Err(refused("each side is at most 4096"));
        }
        let probe = Self::of_cells(columns, (0, 0), lines);
        let texts = rows * (probe.text_height() + MARGIN) + MARGIN;
        let cell = (
            width.saturating_sub(MARGIN * (columns + 1)) / columns,
            height.saturating_sub(texts) / rows,
        );
        if cell.0.min(cell.1) < 8 {
            return Err(refused(
                "its pictures would be below 8 pixels; ask for a larger one",
            ));
        }
        Ok(Self { cell, ..probe })
    }

    fn text_height(&self) -> usize {
        match self.lines {
            0 => 0,
            n => 4 + LINES[0] + (n - 1) * LINES[1],
        }
    }

    /// The pictures row by row.
    pub fn lay_out(&self, cells: &[Cell]) -> Canvas {
        let step = (
            self.cell.0 + MARGIN,
            self.cell.1 + self.text_height() + MARGIN,
        );
        let rows = cells.len().div_ceil(self.columns);
        let mut canvas = Canvas::new(MARGIN + self.columns * step.0, MARGIN + rows * step.1);
        for (i, cell) in cells.iter().enumerate() {
            let left = MARGIN + i % self.columns * step.0;
            let top = MARGIN + i / self.columns * step.1;
            canvas.paste(&cell.image, left, top);
            let text = label(&cell.lines, self.cell.0, self.text_height());
            canvas.draw(&text, left, top + self.cell.1 + 4);
        }
        canvas
    }
}
