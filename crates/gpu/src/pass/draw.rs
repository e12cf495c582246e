//! From a scene on the device to a picture in a target.

use crate::error::GpuError;
use crate::pass::antialias::Grid;
use crate::pass::falsecolour::Field;
use crate::pass::lit::Pixels;
use crate::pass::options::{DrawOptions, Interpolation, Smoothing, Style};
use crate::pass::passes::Passes;
use crate::pass::surfaces::How;
use crate::pass::target::{Frame, Target};
use crate::pass::textured::TextureFiltering;
use crate::pass::tile::Tile;
use crate::pass::tonemap::Tones;
use crate::pass::view::{Window, view};
use crate::pass::walkthrough::{Walkthrough, locked};
use glam::Vec4;
use hemicube_raster::Rgb;
use hemicube_scene::Camera;
use hemicube_shaders::surface as twins;
use wgpu::{CommandEncoder, TextureFormat};

/// Light that pictures are made of.
const LIGHT: TextureFormat = TextureFormat::Rgba16Float;
/// Frames that are kept for the sizes that were drawn last.
const MOST_FRAMES: usize = 6;

impl Walkthrough {
    /// Draws a picture.
    ///
    /// # Errors
    /// A camera that cannot see or bends lines, a size beyond the adapter's limits or its memory, a lost device.
    pub fn draw(
        &mut self,
        encoder: &mut CommandEncoder,
        target: Target<'_>,
        camera: &Camera,
        options: &DrawOptions,
    ) -> Result<(), GpuError> {
        let tile = Tile::all(target.size);
        self.draw_tile(encoder, target, tile, camera, options, tones_of(options))
    }

    /// Draws a part of a picture over all of a target.
    pub(super) fn draw_tile(
        &mut self,
        encoder: &mut CommandEncoder,
        target: Target<'_>,
        tile: Tile,
        camera: &Camera,
        options: &DrawOptions,
        tones: Tones,
    ) -> Result<(), GpuError> {
        self.context.check()?;
        let samples = Samples::new(tile, options.smoothing)?;
        let view = self.view(camera, &samples, options)?;
        let at = self.frame(samples.size(), samples.pixels())?;
        let passes = self.passes.clone();
        let mut passes = locked(&passes);
        self.surfaces.light.update(encoder, &passes.light);
        let picture = Picture {
            view,
            camera,
            aspect: aspect_of(tile.whole),
            samples: &samples,
            options,
            tones,
            without: None,
        };
        self.draw_frame(encoder, &mut passes, at, &picture);
        let frame = &self.frames[at];
        let (context, to) = (&self.context, (target.view, target.format));
        match &samples.kind {
            Kind::Grid(grid) => {
                let from = (&frame.color, grid);
                passes.filter.draw(context, encoder, from, to, tones);
            }
            Kind::OfPixel(count) => {
                let from = (&frame.color, *count);
                passes.tones.draw(context, encoder, from, to, tones);
            }
        }
        Ok(())
    }

    /// Everything that shaders need to know of a picture.
    pub(super) fn view(
        &self,
        camera: &Camera,
        samples: &Samples,
        options: &DrawOptions,
    ) -> Result<twins::View, GpuError> {
        let (bounds, window) = (&self.surfaces.bounds, samples.window());
        let aspect = aspect_of(samples.tile.whole);
        let mut view = view(camera, aspect, samples.size(), bounds, window)?;
        view.exposure = exposure_of(options);
        self.surfaces.tell(&mut view);
        TextureFiltering::tell(&mut view);
        Ok(view)
    }

    /// Number of the frame of a size; those that were used last are kept.
    pub(super) fn frame(&mut self, size: [u32; 2], pixels: Pixels) -> Result<usize, GpuError> {
        let fits = |frame: &Frame| frame.size == size && frame.pixels == pixels;
        if let Some(at) = self.frames.iter().position(fits) {
            let frame = self.frames.remove(at);
            self.frames.push(frame);
        } else {
            let context = &self.context;
            let frame = context.guard(|| Frame::new(context, size, pixels))?;
            self.frames.push(frame);
            if self.frames.len() > MOST_FRAMES {
                self.frames.remove(0);
            }
        }
        Ok(self.frames.len() - 1)
    }

    /// Draws surroundings, surfaces and lines into a frame.
    pub(super) fn draw_frame(
        &mut self,
        encoder: &mut CommandEncoder,
        passes: &mut Passes,
        at: usize,
        picture: &Picture<'_>,
    ) {
        let (context, frame, options) = (&self.context, &self.frames[at], picture.options);
        let bindings = self.surfaces.bind(context, passes, picture.view);
        let behind = self.behind(options) * exposure_of(options);
        let mut pass = begin(encoder, frame, Vec4::new(behind.r, behind.g, behind.b, 1.0));
        pass.set_bind_group(0, &bindings, &[0]);
        let scale = picture.samples.scale();
        let field = match &options.style {
            Style::Lit => None,
            Style::FalseColour(paint) => {
                Some(Field::Illuminance(paint, self.surfaces.units(), scale))
            }
            Style::Plain(color) => Some(Field::Plain(*color)),
        };
        let is_flat = options.interpolation == Interpolation::Flat;
        if let Some(field) = field {
            let bound = passes.falsecolour.bindings(context, field);
            pass.set_pipeline(
                &passes
                    .falsecolour
                    .pipeline(context, field, is_flat, frame.pixels),
            );
            pass.set_bind_group(1, &bound, &[]);
            self.surfaces.draw_solid(&mut pass);
        } else {
            let how = How {
                pixels: frame.pixels,
                filtering: options.filtering,
                bumps: options.bumps,
                reflections: options.reflections,
                flat: is_flat,
                without: picture.without,
            };
            self.surfaces
                .draw_solid_lit(context, passes, &mut pass, &bindings, how);
            if let Some(map) = &self.surroundings {
                let around = &mut passes.surroundings;
                let seen = (picture.aspect, picture.samples.window(), &picture.view);
                let bound = around.bindings(context, map, picture.camera, seen);
                pass.set_pipeline(&around.pipeline(context, frame.pixels));
                pass.set_bind_group(0, &bound, &[]);
                pass.draw(0..3, 0..1);
            }
            let camera = picture.camera;
            self.surfaces
                .draw_layers(context, passes, &mut pass, &bindings, how, camera);
        }
        if let Some(lines) = options.lines {
            let line = passes
                .overlay
                .bindings(context, lines, picture.tones, scale);
            pass.set_pipeline(&passes.overlay.pipeline(context, frame.pixels));
            pass.set_bind_group(0, &bindings, &[0]);
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

/// A picture that is being made.
pub(super) struct Picture<'a> {
    pub(super) view: twins::View,
    pub(super) camera: &'a Camera,
    /// Width by height.
    pub(super) aspect: f64,
    pub(super) samples: &'a Samples,
    pub(super) options: &'a DrawOptions,
    pub(super) tones: Tones,
    /// An instance that is left out.
    pub(super) without: Option<usize>,
}

/// Where the samples of a picture lie, or of a part of one.
#[derive(Debug)]
pub(super) struct Samples {
    tile: Tile,
    kind: Kind,
}

#[derive(Debug)]
enum Kind {
    /// So many in each pixel, which light and textures share.
    OfPixel(u32),
    /// On a grid of their own.
    Grid(Grid),
}

impl Samples {
    pub(super) fn new(tile: Tile, smoothing: Smoothing) -> Result<Self, GpuError> {
        let kind = match smoothing {
            Smoothing::None => Kind::OfPixel(1),
            Smoothing::Multisample => Kind::OfPixel(4),
            Smoothing::Supersample(antialiasing) => Kind::Grid(Grid::new(tile.size, antialiasing)?),
        };
        Ok(Self { tile, kind })
    }

    /// Samples of a pixel along a side, and those that its weights reach.
    pub(super) fn along_side(&self) -> [u32; 2] {
        match &self.kind {
            Kind::OfPixel(_) => [1, 1],
            Kind::Grid(grid) => [grid.factor(), grid.taps()],
        }
    }

    /// What a frame for them stores.
    pub(super) fn pixels(&self) -> Pixels {
        Pixels {
            format: LIGHT,
            samples: match self.kind {
                Kind::OfPixel(count) => count,
                Kind::Grid(_) => 1,
            },
        }
    }

    /// Width and height of what is drawn.
    pub(super) fn size(&self) -> [u32; 2] {
        match &self.kind {
            Kind::OfPixel(_) => self.tile.size,
            Kind::Grid(grid) => grid.samples(),
        }
    }

    /// What of the picture's plane is drawn.
    fn window(&self) -> Window {
        match &self.kind {
            Kind::OfPixel(_) => self.tile.window(),
            Kind::Grid(grid) => grid.window().within(self.tile.window()),
        }
    }

    /// Width of a pixel in what is drawn.
    fn scale(&self) -> f32 {
        match &self.kind {
            Kind::OfPixel(_) => 1.0,
            #[expect(clippy::cast_precision_loss, reason = "32 at most")]
            Kind::Grid(grid) => grid.factor() as f32,
        }
    }
}

/// Clears a frame and begins to draw into it.
pub(super) fn begin<'e>(
    encoder: &'e mut CommandEncoder,
    frame: &Frame,
    behind: Vec4,
) -> wgpu::RenderPass<'e> {
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

pub(super) fn aspect_of([width, height]: [u32; 2]) -> f64 {
    f64::from(width.max(1)) / f64::from(height.max(1))
}

/// What becomes of what a style draws.
pub(super) fn tones_of(options: &DrawOptions) -> Tones {
    match options.style {
        Style::Lit => Tones::Display(options.tone_map),
        Style::FalseColour(_) | Style::Plain(_) => Tones::Color,
    }
}

/// The options' exposure as a factor that light can be multiplied by.
pub(super) fn exposure_of(options: &DrawOptions) -> f32 {
    if options.exposure.is_finite() {
        options.exposure.clamp(1e-30, 1e30)
    } else {
        1.0
    }
}
