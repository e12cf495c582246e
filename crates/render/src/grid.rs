//! The grid of a picture's samples, cut into blocks and bands.

use crate::options::RenderOptions;
use core::ops::Range;
use glam::DVec2;
use hemicube_raster::antialias::{Pattern, Supersampler};
use hemicube_raster::triangle::Viewport;

/// The samples of a picture. Blocks of `factor × factor` samples share gathered light; bands of rows of pixels are
/// drawn by one thread each. Wide filters reach beyond a band, and bands overlap by what they reach.
#[derive(Debug)]
pub(crate) struct Grid {
    pub sampler: Supersampler,
    /// Whether samples lie on rows and columns, as a rasteriser wants it.
    pub is_regular: bool,
    /// Pixels.
    pub width: usize,
    pub height: usize,
    /// Rows of pixels in a band; the last may have fewer.
    band_rows: usize,
}

impl Grid {
    /// A grid whose bands have at most so many rows of pixels and about so many samples.
    pub fn new(options: &RenderOptions, most_rows: usize, samples: usize) -> Self {
        let (width, height) = (options.width, options.height);
        let sampler = Supersampler::new(width, height, options.antialias);
        let a_row = sampler.columns() * sampler.factor();
        Self {
            is_regular: matches!(options.antialias.pattern, Pattern::Regular),
            band_rows: (samples / a_row).clamp(1, most_rows),
            sampler,
            width,
            height,
        }
    }

    pub fn factor(&self) -> usize {
        self.sampler.factor()
    }

    /// Number of bands.
    pub fn bands(&self) -> usize {
        self.height.div_ceil(self.band_rows)
    }

    /// Pixels in a band, so that a picture can be cut into them.
    pub fn band_pixels(&self) -> usize {
        self.band_rows * self.width
    }

    /// Rows of pixels of a band.
    pub fn pixel_rows(&self, band: usize) -> Range<usize> {
        let start = band * self.band_rows;
        start..(start + self.band_rows).min(self.height)
    }

    /// Columns of samples, whole blocks.
    pub fn columns(&self) -> usize {
        self.sampler.columns().next_multiple_of(self.factor())
    }

    /// Rows of samples of a band, whole blocks.
    pub fn rows(&self, band: usize) -> Range<usize> {
        let rows = self.sampler.rows(self.pixel_rows(band));
        rows.start..rows.end.next_multiple_of(self.factor())
    }

    /// The bands that hold one of these rows of samples.
    pub fn bands_of(&self, rows: Range<usize>) -> Range<usize> {
        if rows.is_empty() {
            return 0..0;
        }
        let step = self.band_rows * self.factor();
        let overlap = self.rows(0).len().saturating_sub(step);
        let first = rows.start.saturating_sub(overlap) / step;
        first..((rows.end - 1) / step + 1).min(self.bands())
    }

    /// The samples of a band that its pixels want, of whole blocks.
    pub fn without_filling<V: Copy>(&self, band: usize, samples: Vec<V>) -> Vec<V> {
        let rows = self.sampler.rows(self.pixel_rows(band)).len();
        let (columns, wanted) = (self.columns(), self.sampler.columns());
        if columns == wanted && samples.len() == rows * columns {
            return samples;
        }
        let rows = samples.chunks_exact(columns).take(rows);
        rows.flat_map(|row| &row[..wanted]).copied().collect()
    }

    /// All samples, as a rasteriser sees them.
    pub fn viewport(&self) -> Viewport {
        let rows = self.sampler.rows(0..self.height).end;
        Viewport::new(self.columns(), rows.next_multiple_of(self.factor()))
    }

    /// Where a sample lies, in pixels.
    pub fn position(&self, column: usize, row: usize) -> DVec2 {
        DVec2::from(self.sampler.position(column, row))
    }

    /// Factor and offset that turn x and y of the picture's clip space into those of the viewport's: the grid is a
    /// little larger than the picture, so that its outermost samples have their place.
    pub fn clip_scale_and_offset(&self) -> (DVec2, DVec2) {
        let viewport = self.viewport();
        let size = DVec2::new(viewport.width as f64, viewport.height as f64);
        let pixels = DVec2::new(self.width as f64, self.height as f64);
        let (k, origin) = (self.factor() as f64, self.sampler.origin());
        let scale = pixels * k / size;
        // Column c lies at x = origin + c / k and, as a viewport's pixel, at c + 1/2.
        let offset = (pixels * k - 2.0 * origin * k + 1.0) / size - 1.0;
        (scale, DVec2::new(offset.x, -offset.y))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use hemicube_raster::antialias::Antialiasing;

    fn grid(antialias: &str) -> Grid {
        let antialias: Antialiasing = antialias.parse().expect(antialias);
        let options = RenderOptions::default()
            .with_size(23, 50)
            .with_antialias(antialias);
        Grid::new(&options, 4, 1 << 16)
    }

    #[test]
    fn bands_cover_all_rows_of_samples_that_their_pixels_need() {
        for name in [
            "1",
            "3",
            "4x4:bartlett",
            "2x2:bartlett-3x3",
            "3:blackman-harris",
        ] {
            let grid = grid(name);
            for band in 0..grid.bands() {
                let (rows, needed) = (grid.rows(band), grid.sampler.rows(grid.pixel_rows(band)));
                assert!(
                    rows.start == needed.start && rows.end >= needed.end,
                    "{name}"
                );
                assert!(rows.end <= grid.viewport().height, "{name}");
                for row in [rows.start, rows.end - 1] {
                    assert!(grid.bands_of(row..row + 1).contains(&band), "{name} {row}");
                }
            }
            for row in 0..grid.viewport().height {
                for band in grid.bands_of(row..row + 1) {
                    assert!(band < grid.bands(), "{name}: a band that there is");
                }
            }
        }
    }

    #[test]
    fn clip_space_puts_samples_in_the_middle_of_the_viewports_pixels() {
        for name in ["1", "3", "4x4:bartlett", "2x2:mitchell"] {
            let grid = grid(name);
            let (scale, offset) = grid.clip_scale_and_offset();
            let viewport = grid.viewport();
            for (column, row) in [(0, 0), (5, 17), (20, 40)] {
                let at = grid.position(column, row);
                let clip = DVec2::new(
                    at.x / grid.width as f64 * 2.0 - 1.0,
                    1.0 - at.y / grid.height as f64 * 2.0,
                );
                let seen = clip * scale + offset;
                let x = (seen.x + 1.0) * 0.5 * viewport.width as f64;
                let y = (1.0 - seen.y) * 0.5 * viewport.height as f64;
                assert!((x - column as f64 - 0.5).abs() < 1e-9, "{name}: x {x}");
                assert!((y - row as f64 - 0.5).abs() < 1e-9, "{name}: y {y}");
            }
        }
    }
}
