//! A lit scene on the device, drawn from any camera.

use crate::context::Context;
use crate::error::GpuError;
use crate::pass::antialias::Grid;
use crate::pass::falsecolour::Field;
use crate::pass::lit::Pixels;
use crate::pass::options::{DrawOptions, Interpolation, Smoothing, Style};
use crate::pass::passes::Passes;
use crate::pass::pick::ELEMENTS;
use crate::pass::surfaces::Surfaces;
use crate::pass::target::{Frame, Target, check_size, read_texels, texture};
use crate::pass::tonemap::Tones;
use crate::pass::view::{Window, view};
use crate::shooting::GpuShooting;
use core::fmt;
use glam::Vec4;
use hemicube_radiosity::solve::ambient::ambient_irradiance;
use hemicube_radiosity::{Solution, Solver, SolverKind};
use hemicube_raster::tonemap::Exposure;
use hemicube_raster::{Image, Rgb};
use hemicube_scene::{Camera, Scene};
use hemicube_shaders::surface as twins;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use wgpu::{CommandEncoder, TextureFormat, TextureUsages, TextureViewDescriptor};

/// Light that pictures are made of.
const LIGHT: TextureFormat = TextureFormat::Rgba16Float;
/// Frames that are kept for the sizes that were drawn last.
const MOST_FRAMES: usize = 6;
/// Longest side of the picture from which exposure is taken.
const METERED_SIDE: u32 = 256;

/// A lit scene on the device, drawn from any camera as often as one likes.
///
/// Geometry and materials stay; light can be replaced before every picture, by that of a [`Solution`] or by that which
/// [`GpuShooting`] keeps on the device.
pub struct Walkthrough {
    context: Arc<Context>,
    passes: Arc<Mutex<Passes>>,
    surfaces: Surfaces,
    /// Radiance of the sky as dimmed.
    sky: Rgb,
    frames: Vec<Frame>,
}

impl fmt::Debug for Walkthrough {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Walkthrough")
            .field("context", &self.context)
            .field("triangles", &(self.surfaces.index_count() / 3))
            .finish_non_exhaustive()
    }
}

impl Walkthrough {
    /// Puts a solution on the device.
    ///
    /// # Errors
    /// A mesh that does not fit the adapter's limits.
    pub fn new(context: Arc<Context>, solution: &Solution) -> Result<Self, GpuError> {
        let passes = Arc::new(Mutex::new(Passes::new(&context)));
        Self::with_passes(context, passes, solution)
    }

    /// Another scene on the same device, with the same pipelines.
    ///
    /// # Errors
    /// A mesh that does not fit the adapter's limits.
    pub fn another(&self, solution: &Solution) -> Result<Self, GpuError> {
        Self::with_passes(self.context.clone(), self.passes.clone(), solution)
    }

    fn with_passes(
        context: Arc<Context>,
        passes: Arc<Mutex<Passes>>,
        solution: &Solution,
    ) -> Result<Self, GpuError> {
        let surfaces = Surfaces::new(&context, &locked(&passes), solution)?;
        let mut walkthrough = Self {
            sky: Rgb::BLACK,
            frames: Vec::new(),
            context,
            passes,
            surfaces,
        };
        walkthrough.set_light(solution)?;
        Ok(walkthrough)
    }

    /// The device that it lives on.
    pub fn context(&self) -> &Arc<Context> {
        &self.context
    }

    /// Shows the light of a solution from now on, with its dims; solutions of ambient shooting with their estimate of light
    /// still to come.
    ///
    /// # Errors
    /// The solution has other elements or groups than the one that this was made of.
    pub fn set_light(&mut self, solution: &Solution) -> Result<(), GpuError> {
        let light = &mut self.surfaces.light;
        light.upload(&self.context, &locked(&self.passes).light, solution)?;
        let is_ambient = solution.provenance.solver == SolverKind::AmbientShooting.name();
        self.set_ambient(if is_ambient {
            ambient_irradiance(solution)
        } else {
            Rgb::BLACK
        });
        self.sky = sky(solution);
        Ok(())
    }

    /// Irradiance that is added everywhere: an estimate of light still to come.
    pub fn set_ambient(&mut self, irradiance: Rgb) {
        self.surfaces.light.set_extra(&self.context, irradiance);
    }

    /// Shows the light that a solver keeps on this device, without a way over the CPU. To be called again after each of its
    /// steps.
    ///
    /// # Errors
    /// The solver works on another mesh.
    pub fn set_light_of(&mut self, solver: &GpuShooting) -> Result<(), GpuError> {
        let light = &mut self.surfaces.light;
        light.upload_dims(&self.context, solver.solution())?;
        let passes = locked(&self.passes);
        light.read_from(&self.context, &passes.light, solver.light());
        Ok(())
    }

    /// Takes over the materials of a scene that has the same ones, with other colours or other light.
    ///
    /// # Errors
    /// The scene has another number of materials.
    pub fn set_materials(&mut self, scene: &Scene) -> Result<(), GpuError> {
        self.surfaces.set_materials(&self.context, scene)
    }

    /// Draws a picture.
    ///
    /// # Errors
    /// A camera that cannot see or bends lines, a size beyond the adapter's limits.
    pub fn draw(
        &mut self,
        encoder: &mut CommandEncoder,
        target: Target<'_>,
        camera: &Camera,
        options: &DrawOptions,
    ) -> Result<(), GpuError> {
        self.draw_toned(encoder, target, camera, options, tones(options))
    }

    fn draw_toned(
        &mut self,
        encoder: &mut CommandEncoder,
        target: Target<'_>,
        camera: &Camera,
        options: &DrawOptions,
        tones: Tones,
    ) -> Result<(), GpuError> {
        let samples = Samples::new(target.size, options.smoothing)?;
        let pixels = Pixels {
            format: LIGHT,
            samples: samples.of_pixel(),
        };
        let view = self.view(camera, target.size, &samples, options)?;
        let at = self.frame(samples.size(target.size), pixels)?;
        let passes = self.passes.clone();
        let mut passes = locked(&passes);
        self.surfaces.light.update(encoder, &passes.light);
        let scale = samples.scale();
        self.draw_frame(encoder, &mut passes, (at, view, scale), camera, options, tones);
        let frame = &self.frames[at];
        let (context, to) = (&self.context, (target.view, target.format));
        match &samples {
            Samples::Grid(grid) => {
                let from = (&frame.color, grid);
                passes.filter.draw(context, encoder, from, to, tones);
            }
            Samples::OfPixel(count) => {
                let from = (&frame.color, *count);
                passes.tones.draw(context, encoder, from, to, tones);
            }
        }
        Ok(())
    }

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
        let scale = 1.0 / exposure(options);
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
        self.picture(camera, size, options, tones(options))
    }

    /// The factor of an exposure for this view; see [`Exposure::factor`]. The automatic one is taken from a small picture,
    /// which has to come to the CPU.
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
        let image = self.linear(camera, size.map(scaled), &options);
        self.sky = sky;
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
        let view = view(camera, aspect(size), target, &self.surfaces.bounds, window)?;
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
            pass.set_bind_group(0, &bindings, &[]);
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

    /// Everything that shaders need to know of a picture.
    fn view(
        &self,
        camera: &Camera,
        size: [u32; 2],
        samples: &Samples,
        options: &DrawOptions,
    ) -> Result<twins::View, GpuError> {
        let (bounds, window) = (&self.surfaces.bounds, samples.window());
        let mut view = view(camera, aspect(size), samples.size(size), bounds, window)?;
        view.exposure = exposure(options);
        self.surfaces.tell(&mut view);
        options.filtering.tell(&mut view);
        if options.interpolation == Interpolation::Flat {
            view.flags |= twins::VIEW_FLAT;
        }
        Ok(view)
    }

    /// Number of the frame of a size; those that were used last are kept.
    fn frame(&mut self, size: [u32; 2], pixels: Pixels) -> Result<usize, GpuError> {
        let fits = |frame: &Frame| frame.size == size && frame.pixels == pixels;
        if let Some(at) = self.frames.iter().position(fits) {
            let frame = self.frames.remove(at);
            self.frames.push(frame);
        } else {
            self.frames.push(Frame::new(&self.context, size, pixels)?);
            if self.frames.len() > MOST_FRAMES {
                self.frames.remove(0);
            }
        }
        Ok(self.frames.len() - 1)
    }

    /// Draws surfaces and lines into a frame.
    fn draw_frame(
        &mut self,
        encoder: &mut CommandEncoder,
        passes: &mut Passes,
        (at, view, scale): (usize, twins::View, f32),
        camera: &Camera,
        options: &DrawOptions,
        tones: Tones,
    ) {
        let (context, frame) = (&self.context, &self.frames[at]);
        let bindings = self.surfaces.bind(context, passes, view);
        let behind = self.behind(options) * exposure(options);
        let mut pass = begin(encoder, frame, Vec4::new(behind.r, behind.g, behind.b, 1.0));
        pass.set_bind_group(0, &bindings, &[]);
        let field = match &options.style {
            Style::Lit => None,
            Style::FalseColour(paint) => {
                Some(Field::Illuminance(paint, self.surfaces.units(), scale))
            }
            Style::Plain(color) => Some(Field::Plain(*color)),
        };
        if let Some(field) = field {
            let bound = passes.falsecolour.bindings(context, field);
            pass.set_pipeline(&passes.falsecolour.pipeline(context, field, frame.pixels));
            pass.set_bind_group(1, &bound, &[]);
            self.surfaces.draw_solid(&mut pass);
        } else {
            let how = (frame.pixels, options.filtering);
            self.surfaces.draw(context, passes, &mut pass, how, camera);
        }
        if let Some(lines) = options.lines {
            let line = passes.overlay.bindings(context, lines, tones, scale);
            pass.set_pipeline(&passes.overlay.pipeline(context, frame.pixels));
            pass.set_bind_group(1, &line, &[]);
            self.surfaces.geometry.draw_edges(&mut pass);
        }
    }

    /// Radiance where nothing is drawn.
    fn behind(&self, options: &DrawOptions) -> Rgb {
        if self.sky.is_black() {
            options.background
        } else {
            self.sky
        }
    }
}

/// Where the samples of a picture lie.
#[derive(Debug)]
enum Samples {
    /// So many in each pixel, which light and textures share.
    OfPixel(u32),
    /// On a grid of their own.
    Grid(Grid),
}

impl Samples {
    fn new(size: [u32; 2], smoothing: Smoothing) -> Result<Self, GpuError> {
        Ok(match smoothing {
            Smoothing::None => Self::OfPixel(1),
            Smoothing::Multisample => Self::OfPixel(4),
            Smoothing::Supersample(antialiasing) => Self::Grid(Grid::new(size, antialiasing)?),
        })
    }

    fn of_pixel(&self) -> u32 {
        match self {
            Self::OfPixel(count) => *count,
            Self::Grid(_) => 1,
        }
    }

    /// Width and height of what is drawn.
    fn size(&self, pixels: [u32; 2]) -> [u32; 2] {
        match self {
            Self::OfPixel(_) => pixels,
            Self::Grid(grid) => grid.samples(),
        }
    }

    fn window(&self) -> Window {
        match self {
            Self::OfPixel(_) => Window::WHOLE,
            Self::Grid(grid) => grid.window(),
        }
    }

    /// Width of a pixel in what is drawn.
    fn scale(&self) -> f32 {
        match self {
            Self::OfPixel(_) => 1.0,
            #[expect(clippy::cast_precision_loss, reason = "32 at most")]
            Self::Grid(grid) => grid.factor() as f32,
        }
    }
}

/// Clears a frame and begins to draw into it.
fn begin<'e>(encoder: &'e mut CommandEncoder, frame: &Frame, behind: Vec4) -> wgpu::RenderPass<'e> {
    let [r, g, b, a] = behind.to_array().map(f64::from);
    encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some("surfaces"),
        color_attachments: &[Some(wgpu::RenderPassColorAttachment {
            view: &frame.color,
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations {
                load: wgpu::LoadOp::Clear(wgpu::Color { r, g, b, a }),
                store: wgpu::StoreOp::Store,
            },
        })],
        depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
            view: &frame.depth,
            depth_ops: Some(wgpu::Operations {
                load: wgpu::LoadOp::Clear(0.0),
                store: wgpu::StoreOp::Discard,
            }),
            stencil_ops: None,
        }),
        ..Default::default()
    })
}

fn aspect([width, height]: [u32; 2]) -> f64 {
    f64::from(width.max(1)) / f64::from(height.max(1))
}

/// What becomes of what a style draws.
fn tones(options: &DrawOptions) -> Tones {
    match options.style {
        Style::Lit => Tones::Display(options.tone_map),
        Style::FalseColour(_) | Style::Plain(_) => Tones::Color,
    }
}

/// The options' exposure as a factor that light can be multiplied by.
fn exposure(options: &DrawOptions) -> f32 {
    if options.exposure.is_finite() {
        options.exposure.clamp(1e-30, 1e30)
    } else {
        1.0
    }
}

/// The sky, dimmed with its group.
fn sky(solution: &Solution) -> Rgb {
    let dim = solution.groups().last().map_or(Rgb::WHITE, |group| group.dim);
    solution.mesh().scene().sky * dim
}

fn locked(passes: &Mutex<Passes>) -> MutexGuard<'_, Passes> {
    // Pipelines are whole or not there at all.
    passes.lock().unwrap_or_else(PoisonError::into_inner)
}
