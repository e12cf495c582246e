//! Pictures that come to the CPU, and what a pixel shows.

use crate::error::GpuError;
use crate::pass::draw::{Samples, aspect_of, begin, exposure_of, tones_of};
use crate::pass::lit::Pixels;
use crate::pass::options::{DrawOptions, Smoothing};
use crate::pass::pick::ELEMENTS;
use crate::pass::target::{Frame, Target, read_texels, texture};
use crate::pass::tile::Tile;
use crate::pass::tonemap::Tones;
use crate::pass::view::view;
use crate::pass::walkthrough::{Walkthrough, locked};
use glam::Vec4;
use hemicube_raster::tonemap::Exposure;
use hemicube_raster::{Image, Rgb};
use hemicube_scene::Camera;
use wgpu::{CommandEncoder, TextureFormat, TextureUsages, TextureViewDescriptor};

/// Pixels of a picture that comes to the CPU at most: 1.6 GB of floats.
const MOST_PIXELS: u64 = 1 << 27;
/// Longest side of the picture from which exposure is taken.
const METERED_SIDE: u32 = 256;

impl Walkthrough {
    /// Radiance of each pixel in the scene's units, from the device to the CPU. A picture that is larger than the adapter
    /// draws at once is drawn in tiles. It is kept in 16 bits on the way, relative
    /// to the options' exposure.
    ///
    /// # Errors
    /// As [`Self::draw`]; the device was lost.
    pub fn linear(
        &mut self,
        camera: &Camera,
        size: [u32; 2],
        options: &DrawOptions,
    ) -> Result<Image<Rgb>, GpuError> {
        let image = self.picture(camera, size, options, Tones::Linear)?;
        let scale = 1.0 / exposure_of(options);
        Ok(image.map(|&c| c * scale))
    }

    /// What a display shows of each pixel, linear in [0, 1], from the device to the CPU.
    ///
    /// # Errors
    /// As [`Self::draw`]; the device was lost.
    pub fn display(
        &mut self,
        camera: &Camera,
        size: [u32; 2],
        options: &DrawOptions,
    ) -> Result<Image<Rgb>, GpuError> {
        self.picture(camera, size, options, tones_of(options))
    }

    /// The factor of an exposure for this view; see [`Exposure::factor`]. The automatic one is taken from a small picture,
    /// which has to come to the CPU; what is behind everything does not count.
    ///
    /// # Errors
    /// As [`Self::draw`]; the device was lost.
    pub fn exposure_factor(
        &mut self,
        camera: &Camera,
        size: [u32; 2],
        exposure: Exposure,
    ) -> Result<f32, GpuError> {
        if exposure != Exposure::Auto {
            return Ok(exposure.factor([]));
        }
        let longer = size[0].max(size[1]).max(1);
        let scaled = |side: u32| {
            let share = u64::from(side) * u64::from(METERED_SIDE) / u64::from(longer);
            u32::try_from(share).unwrap_or(METERED_SIDE).max(1)
        };
        let options = DrawOptions::default().with_smoothing(Smoothing::None);
        let sky = core::mem::replace(&mut self.sky, Rgb::BLACK);
        let surroundings = self.surroundings.take();
        let image = self.linear(camera, size.map(scaled), &options);
        (self.sky, self.surroundings) = (sky, surroundings);
        Ok(exposure.factor(image?.pixels().iter().map(|c| c.luminance())))
    }

    fn picture(
        &mut self,
        camera: &Camera,
        size: [u32; 2],
        options: &DrawOptions,
        tones: Tones,
    ) -> Result<Image<Rgb>, GpuError> {
        check_pixels(size)?;
        let along_side = Samples::new(Tile::all(size), options.smoothing)?.along_side();
        let mut image = filled(size, Rgb::BLACK);
        for tile in Tile::cover(size, self.largest_side(), along_side) {
            let words = self.read_tile(tile, camera, options, tones)?;
            let band = |word: u32| f32::from_bits(word);
            let colors = words.chunks_exact(4);
            let colors = colors.map(|t| Rgb::new(band(t[0]), band(t[1]), band(t[2])));
            put(&mut image, tile, colors);
        }
        Ok(image)
    }

    /// The texels of a part of a picture, four floats each.
    fn read_tile(
        &mut self,
        tile: Tile,
        camera: &Camera,
        options: &DrawOptions,
        tones: Tones,
    ) -> Result<Vec<u32>, GpuError> {
        let pixels = Pixels {
            format: TextureFormat::Rgba32Float,
            samples: 1,
        };
        let usage = TextureUsages::RENDER_ATTACHMENT | TextureUsages::COPY_SRC;
        let picture = texture(&self.context, "picture to read", tile.size, pixels, usage);
        let target = Target {
            view: &picture.create_view(&TextureViewDescriptor::default()),
            format: pixels.format,
            size: tile.size,
        };
        let mut encoder = self.encoder("picture");
        self.draw_tile(&mut encoder, target, tile, camera, options, tones)?;
        self.context.queue.submit([encoder.finish()]);
        read_texels(&self.context, &picture)
    }

    fn largest_side(&self) -> u32 {
        self.context.limits.max_texture_dimension_2d
    }

    /// The element that a pixel of a picture of so many shows, if it shows one.
    ///
    /// # Errors
    /// As [`Self::draw`]; the device was lost.
    pub fn pick(
        &mut self,
        camera: &Camera,
        size: [u32; 2],
        pixel: [u32; 2],
    ) -> Result<Option<usize>, GpuError> {
        check_pixels(size)?;
        let all = self.elements_in(camera, Tile::pixel(size, pixel))?;
        Ok(all[0].checked_sub(1).map(|e| e as usize))
    }

    /// For each pixel the number of the element that it shows plus one; 0 where none is.
    ///
    /// # Errors
    /// As [`Self::draw`]; the device was lost.
    pub fn elements(&mut self, camera: &Camera, size: [u32; 2]) -> Result<Image<u32>, GpuError> {
        check_pixels(size)?;
        let mut image = filled(size, 0);
        for tile in Tile::cover(size, self.largest_side(), [1, 1]) {
            let elements = self.elements_in(camera, tile)?;
            put(&mut image, tile, elements.into_iter());
        }
        Ok(image)
    }

    fn elements_in(&self, camera: &Camera, tile: Tile) -> Result<Vec<u32>, GpuError> {
        let view = view(
            camera,
            aspect_of(tile.whole),
            tile.size,
            &self.surfaces.bounds,
            tile.window(),
        )?;
        let pixels = Pixels {
            format: ELEMENTS,
            samples: 1,
        };
        let frame = Frame::new(&self.context, tile.size, pixels)?;
        let mut encoder = self.encoder("pick");
        {
            let mut passes = locked(&self.passes);
            let mut pass = begin(&mut encoder, &frame, Vec4::ZERO);
            pass.set_pipeline(&passes.pick.pipeline(&self.context));
            let bindings = self.surfaces.bind(&self.context, &passes, view);
            pass.set_bind_group(0, &bindings, &[0]);
            self.surfaces.set_buffers(&mut pass);
            pass.draw_indexed(0..self.surfaces.index_count(), 0, 0..1);
        }
        self.context.queue.submit([encoder.finish()]);
        read_texels(&self.context, &frame.texture)
    }

    fn encoder(&self, label: &str) -> CommandEncoder {
        let descriptor = wgpu::CommandEncoderDescriptor { label: Some(label) };
        self.context.device.create_command_encoder(&descriptor)
    }
}

/// Refuses pictures of no pixel, and of more than memory should hold.
fn check_pixels([width, height]: [u32; 2]) -> Result<(), GpuError> {
    let pixels = u64::from(width) * u64::from(height);
    if (1..=MOST_PIXELS).contains(&pixels) {
        return Ok(());
    }
    Err(GpuError::Option(format!(
        "picture of {width} x {height} pixels: it must have at least 1 and at most {MOST_PIXELS}"
    )))
}

fn filled<P: Clone>([width, height]: [u32; 2], pixel: P) -> Image<P> {
    Image::filled(width as usize, height as usize, pixel)
}

/// Puts the pixels of a tile where they belong.
fn put<P>(image: &mut Image<P>, tile: Tile, pixels: impl Iterator<Item = P>) {
    let [left, top] = tile.at.map(|side| side as usize);
    let width = tile.size[0] as usize;
    for (i, pixel) in pixels.enumerate() {
        *image.pixel_mut(left + i % width, top + i / width) = pixel;
    }
}
