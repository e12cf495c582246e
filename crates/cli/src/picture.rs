//! Pictures of a solution.

use crate::args::{GlobalArgs, PictureArgs};
use crate::failure::Failure;
use crate::output::Target;
use crate::progress::Bar;
use glam::Vec3;
use hemicube::radiosity::Solution;
use hemicube::raster::tonemap::Exposure;
use hemicube::raster::triangle::Viewport;
use hemicube::raster::{Image, Rgb};
use hemicube::render::{RenderOptions, Renderer, choose_camera};
use hemicube::scene::{Camera, Projection, Scene};
use std::io::Cursor;

/// Endings of pictures that can be written.
pub const ENDINGS: &[&str] = &["png", "exr"];

/// Pictures fit into this unless a size is asked for: 3:2, or 720 x 720 for a square camera.
const BOX: (f32, f32) = (960.0, 720.0);
const PLAIN: (u32, u32) = (960, 640);

/// Angle of view in degrees of a camera that is made from `--eye`.
const FOV: f32 = 60.0;

/// What is wrong with the options, as far as the scene tells before it is solved.
pub fn check(scene: &Scene, args: &PictureArgs) -> Result<(), Failure> {
    if let Some(name) = &args.camera {
        scene.camera(name)?;
    }
    let (width, height) = args.size.unwrap_or(PLAIN);
    if width as usize * height as usize > RenderOptions::MAX_PIXELS {
        let most = RenderOptions::MAX_PIXELS;
        return Err(Failure::Usage(format!(
            "--size {width}x{height}: at most {most} pixels fit, 7680x4320 for example; make a side smaller"
        )));
    }
    let antialias = args.antialias.unwrap_or(RenderOptions::default().antialias);
    if width.max(height) as usize * antialias as usize > Viewport::MAX_SIDE {
        let most = Viewport::MAX_SIDE;
        return Err(Failure::Usage(format!(
            "--size {width}x{height} with --antialias {antialias}: a side may have {most} samples; make one of them smaller"
        )));
    }
    Ok(())
}

/// A camera, options, and what to do with tones.
#[derive(Debug)]
pub struct View<'a> {
    camera: Camera,
    options: RenderOptions,
    args: &'a PictureArgs,
}

impl<'a> View<'a> {
    /// The view that the options ask for.
    pub fn new(solution: &Solution, args: &'a PictureArgs) -> Result<Self, Failure> {
        check(solution.mesh().scene(), args)?;
        let camera = camera(solution, args)?;
        let (width, height) = args.size.unwrap_or_else(|| default_size(&camera));
        let defaults = RenderOptions::default();
        let options = RenderOptions {
            width: width as usize,
            height: height as usize,
            shading: args.shading.unwrap_or(defaults.shading),
            antialias: args.antialias.unwrap_or(defaults.antialias),
            gather_rays: args.gather_rays.unwrap_or(defaults.gather_rays),
            ..defaults
        };
        Ok(Self {
            camera,
            options,
            args,
        })
    }

    /// Draws and writes the picture: radiance for .exr, what a display shows for .png.
    pub fn draw(
        &self,
        solution: &Solution,
        target: &Target,
        global: GlobalArgs,
    ) -> Result<(), Failure> {
        let bar = Bar::new("drawing", global.quiet);
        let progress = |share| bar.show(share, String::new);
        let renderer =
            Renderer::new(solution, &self.camera, &self.options)?.with_progress(&progress);
        let mut file = Cursor::new(Vec::new());
        if target.ends_in("exr") {
            renderer.linear().write_exr(&mut file)?;
        } else {
            let exposure = self.args.exposure.unwrap_or_default();
            renderer
                .display(exposure, self.args.tonemap.unwrap_or_default())
                .write_png(&mut file)?;
        }
        target.write(&file.into_inner())
    }

    /// What a display shows of a solution under a given exposure.
    pub fn display(&self, solution: &Solution, exposure: Exposure) -> Result<Image<Rgb>, Failure> {
        let renderer = Renderer::new(solution, &self.camera, &self.options)?;
        Ok(renderer.display(exposure, self.args.tonemap.unwrap_or_default()))
    }

    /// The exposure that was asked for; an automatic one as it is for this solution, in stops.
    pub fn exposure(&self, solution: &Solution) -> Result<Exposure, Failure> {
        let wanted = self.args.exposure.unwrap_or_default();
        let renderer = Renderer::new(solution, &self.camera, &self.options)?;
        let factor = renderer.exposure_factor(wanted);
        Ok(Exposure::Ev(factor.log2()))
    }

    /// The same view in other pixels, no more than fit in a square, unless a size was asked for.
    pub fn within(mut self, side: u32) -> Self {
        if self.args.size.is_none() {
            let longer = self.options.width.max(self.options.height);
            let scaled = |length: usize| (length * side as usize / longer).max(16);
            let (width, height) = (scaled(self.options.width), scaled(self.options.height));
            self.options = self.options.with_size(width, height);
        }
        self
    }

    /// Pixels.
    pub fn size(&self) -> (usize, usize) {
        (self.options.width, self.options.height)
    }

    /// Name of the camera.
    pub fn camera_name(&self) -> &str {
        &self.camera.name
    }

    /// Name of the shading.
    pub fn shading_name(&self) -> &'static str {
        self.options.shading.name()
    }
}

fn camera(solution: &Solution, args: &PictureArgs) -> Result<Camera, Failure> {
    let scene = solution.mesh().scene();
    let mut camera = if let Some(name) = &args.camera {
        scene.camera(name)?.clone()
    } else if let Some(eye) = args.eye {
        let middle = || {
            scene
                .bounds()
                .map_or(Vec3::ZERO, |(low, high)| low.midpoint(high))
        };
        let target = args.look_at.unwrap_or_else(middle);
        if target == eye {
            return Err(Failure::Usage(String::from(
                "--look-at is where --eye is; name a point in front of the eye",
            )));
        }
        Camera::looking_at("eye", eye, target, Vec3::Y, FOV.to_radians())
    } else {
        scene
            .cameras
            .first()
            .cloned()
            .unwrap_or_else(|| choose_camera(solution.mesh()))
    };
    match (&mut camera.projection, args.fov) {
        (Projection::Perspective { vertical_fov, .. }, Some(degrees)) => {
            *vertical_fov = degrees.to_radians();
        }
        (Projection::Orthographic { .. }, Some(_)) => {
            return Err(Failure::Usage(format!(
                "--fov: camera '{}' is orthographic and has no angle of view",
                camera.name
            )));
        }
        (_, None) => {}
    }
    Ok(camera)
}

/// A size in the camera's proportions.
fn default_size(camera: &Camera) -> (u32, u32) {
    let aspect = match camera.projection {
        Projection::Perspective { aspect, .. } => aspect,
        Projection::Orthographic {
            half_width,
            half_height,
        } => Some(half_width / half_height),
    };
    let Some(aspect) = aspect.filter(|a| a.is_finite() && *a > 0.0) else {
        return PLAIN;
    };
    let width = BOX.0.min(BOX.1 * aspect);
    (pixels(width), pixels(width / aspect))
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "clamped to a small range"
)]
fn pixels(length: f32) -> u32 {
    length.round().clamp(16.0, 960.0) as u32
}
