//! Pictures that come to the CPU, and what a pixel shows.

use crate::error::GpuError;
use crate::pass::draw::{aspect_of, begin, exposure_of, tones_of};
use crate::pass::lit::Pixels;
use crate::pass::options::{DrawOptions, Smoothing};
use crate::pass::pick::ELEMENTS;
use crate::pass::target::{Frame, Target, check_size, read_texels, texture};
use crate::pass::tonemap::Tones;
use crate::pass::view::{Window, view};
use crate::pass::walkthrough::{Walkthrough, locked};
use glam::Vec4;
use hemicube_raster::tonemap::Exposure;
use hemicube_raster::{Image, Rgb};
use hemicube_scene::Camera;
use wgpu::{CommandEncoder, TextureFormat, TextureUsages, TextureViewDescriptor};

/// Longest side of the picture from which exposure is taken.
const METERED_SIDE: u32 = 256;

impl Walkthrough {
    /// Radiance of each pixel in the scene's units, from the device to the CPU. It is kept in 16 bits on the way, relative
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
        let scaled = |side: u32| (side * METERED_SIDE / longer).clamp(1, METERED_SIDE);
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
        check_size(&self.context, size)?;
        let pixels = Pixels {
            format: TextureFormat::Rgba32Float,
            samples: 1,
        };
        let usage = TextureUsages::RENDER_ATTACHMENT | TextureUsages::COPY_SRC;
        let picture = texture(&self.context, "picture to read", size, pixels, usage);
        let target = Target {
            view: &picture.create_view(&TextureViewDescriptor::default()),
            format: pixels.format,
            size,
        };
        let mut encoder = self.encoder("picture");
        self.draw_toned(&mut encoder, target, camera, options, tones)?;
        self.context.queue.submit([encoder.finish()]);
        let words = read_texels(&self.context, &picture)?;
        let band = |word: u32| f32::from_bits(word);
        let texels = words.chunks_exact(4);
        let colors = texels.map(|t| Rgb::new(band(t[0]), band(t[1]), band(t[2])));
        let [width, height] = size.map(|side| side as usize);
        Ok(Image::from_pixels(width, height, colors.collect()).expect("a colour for each pixel"))
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
        let window = Window::of_pixel(size, pixel);
        let all = self.elements_in(camera, size, [1, 1], window)?;
        Ok(all[0].checked_sub(1).map(|e| e as usize))
    }

    /// For each pixel the number of the element that it shows plus one; 0 where none is.
    ///
    /// # Errors
    /// As [`Self::draw`]; the device was lost.
    pub fn elements(&mut self, camera: &Camera, size: [u32; 2]) -> Result<Image<u32>, GpuError> {
        let elements = self.elements_in(camera, size, size, Window::WHOLE)?;
        let [width, height] = size.map(|side| side as usize);
        Ok(Image::from_pixels(width, height, elements).expect("a number for each pixel"))
    }

    fn elements_in(
        &self,
        camera: &Camera,
        size: [u32; 2],
        target: [u32; 2],
        window: Window,
    ) -> Result<Vec<u32>, GpuError> {
        check_size(&self.context, size)?;
        let view = view(
            camera,
            aspect_of(size),
            target,
            &self.surfaces.bounds,
            window,
        )?;
        let pixels = Pixels {
            format: ELEMENTS,
            samples: 1,
        };
        let frame = Frame::new(&self.context, target, pixels)?;
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
