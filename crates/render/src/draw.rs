//! From a shader to a picture, band by band.

use crate::grid::Grid;
use crate::options::RenderOptions;
use crate::shade::{BlockCache, Shader};
use crate::sight::{SightFinder, Sights};
use core::sync::atomic::{AtomicUsize, Ordering};
use hemicube_raster::{Image, Rgb};
use hemicube_scene::Camera;
use rayon::prelude::*;

/// Samples of a band, about: what a thread holds in memory at a time.
const BAND_SAMPLES: usize = 1 << 17;

/// Most rows of pixels in a band, so that there are enough bands for all threads; gathered ones take long.
const BAND_ROWS: usize = 16;
const GATHERED_BAND_ROWS: usize = 2;

/// Draws band by band, in parallel. The bands follow from the size alone, so the number of threads changes nothing. An
/// instance that is named is left out; `resolve` is applied to each sample before they are filtered.
pub(crate) fn draw(
    shader: &Shader<'_>,
    camera: &Camera,
    options: &RenderOptions,
    without: Option<usize>,
    resolve: impl Fn(Rgb) -> Rgb + Sync,
    report: impl Fn(f64) + Sync,
) -> Image<Rgb> {
    let most_rows = if shader.gathers() {
        GATHERED_BAND_ROWS
    } else {
        BAND_ROWS
    };
    let grid = Grid::new(options, most_rows, BAND_SAMPLES);
    let sight = SightFinder::new(shader.stage, camera, &grid, without);
    let order = from_the_centre(grid.factor());
    let mut pixels = vec![Rgb::BLACK; options.width * options.height];
    let done = AtomicUsize::new(0);
    let bands = pixels.par_chunks_mut(grid.band_pixels()).enumerate();
    bands.for_each(|(band, pixels)| {
        let sights = sight.band(band);
        let samples = shade_band(shader, &grid, band, &sights, &order, &resolve);
        grid.sampler
            .resolve(grid.pixel_rows(band), &samples, pixels);
        let count = done.fetch_add(1, Ordering::Relaxed) + 1;
        report(count as f64 / grid.bands() as f64);
    });
    Image::from_pixels(options.width, options.height, pixels).expect("one colour for each pixel")
}

/// Shades the samples of a band block by block, and hands them on row by row without those that only fill up blocks.
fn shade_band(
    shader: &Shader<'_>,
    grid: &Grid,
    band: usize,
    sights: &Sights,
    order: &[(usize, usize)],
    resolve: &(impl Fn(Rgb) -> Rgb + Sync),
) -> Vec<Rgb> {
    let (rows, columns, k) = (grid.rows(band), grid.columns(), grid.factor());
    let mut shaded = vec![Rgb::BLACK; rows.len() * columns];
    shaded
        .par_chunks_mut(columns * k)
        .enumerate()
        .for_each(|(block_row, out)| {
            for block in (0..columns).step_by(k) {
                let mut cache = BlockCache::default();
                for &(column, row) in order {
                    let (column, local) = (block + column, block_row * k + row);
                    let at = grid.position(column, rows.start + local);
                    let sample = local * columns + column;
                    let color = resolve(shader.radiance(sights, sample, at, &mut cache));
                    out[row * columns + column] = shader.with_lines_over(color, sights, sample, at);
                }
            }
        });
    grid.without_filling(band, shaded)
}

/// Columns and rows of a block's samples, the central ones first: points that are gathered for others stand for the
/// block's middle.
fn from_the_centre(n: usize) -> Vec<(usize, usize)> {
    let mut order: Vec<(usize, usize)> = (0..n * n).map(|i| (i % n, i / n)).collect();
    let off = |k: usize| (2 * k + 1).abs_diff(n).pow(2);
    order.sort_by_key(|&(column, row)| off(column) + off(row));
    order
}
