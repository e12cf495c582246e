//! Solution in, picture out.

use crate::error::RenderError;
use crate::grid::Grid;
use crate::lens::Lens;
use crate::options::{RenderOptions, Shading};
use crate::projection::check_camera;
use crate::shade::{BlockCache, Light, Shader};
use crate::sight::{SightFinder, Sights};
use crate::stage::Stage;
use core::sync::atomic::{AtomicUsize, Ordering};
use hemicube_radiosity::{GatherOptions, Gatherer, Solution};
use hemicube_raster::antialias::Antialiasing;
use hemicube_raster::tonemap::{Exposure, ToneMap};
use hemicube_raster::{Image, Rgb};
use hemicube_scene::Camera;
use rayon::prelude::*;

/// Samples of a band, about: what a thread holds in memory at a time.
const BAND_SAMPLES: usize = 1 << 17;

/// Most rows of pixels in a band, so that there are enough bands for all threads; gathered ones take long.
const BAND_ROWS: usize = 16;
const GATHERED_BAND_ROWS: usize = 2;

/// Longest side of the small picture from which the automatic exposure is taken.
const METERED_SIDE: usize = 512;

/// Linear radiance of each pixel, in the scene's units: cd/m² or W/(m² sr).
///
/// Samples are averaged as they are, which is what an OpenEXR file should hold. Where a lamp is much brighter than the
/// display's white, such an average is white almost up to the lamp's outer edge: tone-mapped afterwards, its edge is
/// jagged. For a display use [`render_display`].
///
/// # Errors
/// Sizes, samples or a camera out of range; one line.
pub fn render(
    solution: &Solution,
    camera: &Camera,
    options: &RenderOptions,
) -> Result<Image<Rgb>, RenderError> {
    Ok(Renderer::new(solution, camera, options)?.linear())
}

/// What a display shows of each pixel, linear in [0, 1], ready for [`Image::write_png`]: every sample goes through
/// exposure and tone curve, then samples are averaged.
///
/// # Errors
/// Sizes, samples or a camera out of range; one line.
pub fn render_display(
    solution: &Solution,
    camera: &Camera,
    options: &RenderOptions,
    exposure: Exposure,
    tone_map: ToneMap,
) -> Result<Image<Rgb>, RenderError> {
    Ok(Renderer::new(solution, camera, options)?.display(exposure, tone_map))
}

/// What a display shows of a linear picture, linear in [0, 1], ready for [`Image::write_png`].
pub fn tone_mapped(image: &Image<Rgb>, exposure: Exposure, tone_map: ToneMap) -> Image<Rgb> {
    let factor = exposure.factor(image.pixels().iter().map(|c| c.luminance()));
    image.map(|&color| tone_map.apply(color, factor))
}

/// Called with the finished share of a picture, in [0, 1], from any thread.
type Progress<'a> = &'a (dyn Fn(f64) + Sync);

/// A solution, a camera and options, checked and ready for pictures.
pub struct Renderer<'a> {
    stage: Stage<'a>,
    camera: &'a Camera,
    options: RenderOptions,
    progress: Option<Progress<'a>>,
}

impl core::fmt::Debug for Renderer<'_> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("Renderer")
            .field("camera", &self.camera)
            .field("options", &self.options)
            .finish_non_exhaustive()
    }
}

impl<'a> Renderer<'a> {
    /// Checks what it is given and prepares the drawn mesh.
    ///
    /// # Errors
    /// Sizes, samples or a camera out of range; one line.
    pub fn new(
        solution: &'a Solution,
        camera: &'a Camera,
        options: &RenderOptions,
    ) -> Result<Self, RenderError> {
        options.check()?;
        check_camera(camera)?;
        Ok(Self {
            stage: Stage::new(solution, options),
            camera,
            options: *options,
            progress: None,
        })
    }

    /// Reports the finished share of each picture; gathered ones take long.
    pub fn with_progress(self, progress: Progress<'a>) -> Self {
        let progress = Some(progress);
        Self { progress, ..self }
    }

    /// Linear radiance, see [`render`].
    pub fn linear(&self) -> Image<Rgb> {
        self.picture(|radiance| radiance)
    }

    /// What a display shows, see [`render_display`].
    pub fn display(&self, exposure: Exposure, tone_map: ToneMap) -> Image<Rgb> {
        let factor = self.exposure_factor(exposure);
        self.picture(|radiance| tone_map.apply(radiance, factor))
    }

    /// The factor of an exposure for this view. The automatic one is taken from a small picture with one sample a pixel
    /// and interpolated light, so it does not depend on size, samples or shading of the picture that it is for. What is
    /// behind everything, sky or background, does not count: a chair under a bright sky would come out black.
    pub fn exposure_factor(&self, exposure: Exposure) -> f32 {
        if exposure != Exposure::Auto {
            return exposure.factor([]);
        }
        let (width, height) = metered_size(self.options.width, self.options.height);
        let small = self
            .options
            .with_size(width, height)
            .with_antialias(Antialiasing::NONE);
        let shader = self.shader(&small, Light::Gouraud).with_behind(Rgb::BLACK);
        let image = draw(&shader, self.camera, &small, |radiance| radiance, |_| {});
        exposure.factor(image.pixels().iter().map(|c| c.luminance()))
    }

    /// The picture with `resolve` applied to each sample before averaging.
    fn picture(&self, resolve: impl Fn(Rgb) -> Rgb + Sync) -> Image<Rgb> {
        let report = |share| {
            if let Some(progress) = self.progress {
                progress(share);
            }
        };
        let shader = self.shader(&self.options, self.light());
        draw(&shader, self.camera, &self.options, resolve, report)
    }

    fn shader<'b>(&'b self, options: &RenderOptions, light: Light<'b>) -> Shader<'b> {
        let lens = Lens::new(self.camera, options.width, options.height);
        let spacing = 1.0 / options.antialias.factor.get() as f64;
        Shader::new(&self.stage, light, lens, spacing)
    }

    fn light(&self) -> Light<'_> {
        let options = &self.options;
        match options.shading {
            Shading::Flat => Light::Flat,
            Shading::Gouraud => Light::Gouraud,
            Shading::Gather => {
                // Shadows of lights without an area have hard edges, which every sample must look for. Everything else is
                // smooth within a pixel.
                let shared = self.stage.scene().lights.is_empty();
                let samples = options.antialias.factor.get().pow(2);
                let rays = if shared {
                    options.gather_rays
                } else {
                    let samples = u32::try_from(samples).expect("1024 at most");
                    options.gather_rays.div_ceil(samples)
                };
                let gather = GatherOptions {
                    rays,
                    ..GatherOptions::default()
                };
                let gatherer = Gatherer::new(self.stage.solution, gather);
                Light::Gather { gatherer, shared }
            }
        }
    }
}

/// The same picture with its longer side at most [`METERED_SIDE`].
fn metered_size(width: usize, height: usize) -> (usize, usize) {
    let longer = width.max(height).max(METERED_SIDE);
    let scaled = |side: usize| (side * METERED_SIDE / longer).max(1);
    (scaled(width), scaled(height))
}

/// Draws band by band, in parallel. The bands follow from the size alone, so the number of threads changes nothing.
fn draw(
    shader: &Shader<'_>,
    camera: &Camera,
    options: &RenderOptions,
    resolve: impl Fn(Rgb) -> Rgb + Sync,
    report: impl Fn(f64) + Sync,
) -> Image<Rgb> {
    let most_rows = if shader.gathers() {
        GATHERED_BAND_ROWS
    } else {
        BAND_ROWS
    };
    let grid = Grid::new(options, most_rows, BAND_SAMPLES);
    let sight = SightFinder::new(shader.stage, camera, &grid, None);
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
                    out[row * columns + column] =
                        resolve(shader.radiance(sights, sample, at, &mut cache));
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
