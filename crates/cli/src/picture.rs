//! Pictures of a solution.

use crate::args::{GlobalArgs, GpuArgs, PictureArgs, ProjectionKind};
use crate::failure::Failure;
use crate::output::Target;
use crate::progress::Bar;
use glam::{DVec4, Vec3};
use hemicube::radiosity::Solution;
use hemicube::raster::environment::{EnvironmentMap, OpenMapError, map_files, open_map};
use hemicube::raster::tonemap::Exposure;
use hemicube::raster::triangle::Viewport;
use hemicube::raster::{Image, Rgb};
use hemicube::render::{
    MeshOverlay, Reflections, RenderOptions, Renderer, choose_camera, clip_from_world,
};
use hemicube::scene::{Camera, FisheyeMapping, Projection, Scene};
use std::io::Cursor;
use std::path::{Path, PathBuf};

/// Endings of pictures that can be written.
pub const ENDINGS: &[&str] = &["png", "exr"];

/// Pictures fit into this unless a size is asked for: 3:2, or 720 x 720 for a square camera.
const BOX: (f32, f32) = (960.0, 720.0);
const PLAIN: (u32, u32) = (960, 640);

/// Angle of view in degrees of a camera that is made from `--eye`.
const FOV: f32 = 60.0;

/// Largest vertical angle of view in degrees of a picture on a plane.
const MAX_FLAT_FOV: f32 = 170.0;

/// What is wrong with the options, as far as the scene tells before it is solved.
pub fn check(scene: &Scene, args: &PictureArgs) -> Result<(), Failure> {
    if let Some(name) = &args.camera {
        scene.camera(name)?;
    }
    reflections(args)?.check(scene)?;
    #[cfg(not(feature = "gpu"))]
    if args.uses_gpu() {
        let not_built = crate::backend::NOT_BUILT;
        return Err(Failure::Usage(format!("--draw-on gpu: {not_built}")));
    }
    if args.uses_gpu() && args.mesh == Some(MeshOverlay::Patches) {
        return Err(Failure::Usage(String::from(
            "--draw-on gpu draws the edges of elements only; leave one of --mesh=patches and --draw-on out",
        )));
    }
    if let Some(path) = &args.environment_file
        && let Some(missing) = surroundings_files(path)?
            .iter()
            .find(|file| !file.is_file())
    {
        return Err(Failure::Failed(format!(
            "{}: there is no such file; name a picture of the surroundings",
            missing.display()
        )));
    }
    let (width, height) = args.size.unwrap_or(PLAIN);
    if width as usize * height as usize > RenderOptions::MAX_PIXELS {
        let most = RenderOptions::MAX_PIXELS;
        return Err(Failure::Usage(format!(
            "--size {width}x{height}: at most {most} pixels fit, 7680x4320 for example; make a side smaller"
        )));
    }
    let defaults = RenderOptions::default();
    let antialias = args.antialias.unwrap_or(defaults.antialias);
    let side = width.max(height) as usize;
    if defaults.with_antialias(antialias).samples_of_side(side) > Viewport::MAX_SIDE {
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
    surroundings: Option<EnvironmentMap>,
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
            texture_filter: args.texture_filter.unwrap_or(defaults.texture_filter),
            gather_rays: args.gather_rays.unwrap_or(defaults.gather_rays),
            mesh: args.mesh,
            ..defaults
        };
        let surroundings = args.environment_file.as_deref().map(surroundings);
        Ok(Self {
            camera,
            options,
            surroundings: surroundings.transpose()?,
            args,
        })
    }

    /// Draws and writes the picture: radiance for .exr, what a display shows for .png. Gives the number of maps that were
    /// taken for mirroring objects.
    pub fn draw(
        &self,
        solution: &Solution,
        target: &Target,
        gpu: &GpuArgs,
        global: GlobalArgs,
    ) -> Result<usize, Failure> {
        if let Some((image, mirrors)) = self.on_gpu(solution, target, gpu, global)? {
            let mut file = Cursor::new(Vec::new());
            if target.ends_in("exr") {
                image.write_exr(&mut file)?;
            } else {
                image.write_png(&mut file)?;
            }
            target.write(&file.into_inner())?;
            return Ok(mirrors);
        }
        let bar = Bar::new("drawing", global.quiet);
        let progress = |share| bar.show(share, String::new);
        let renderer = self.renderer(solution)?.with_progress(&progress);
        let mut file = Cursor::new(Vec::new());
        if target.ends_in("exr") {
            renderer.linear().write_exr(&mut file)?;
        } else {
            let exposure = self.args.exposure.unwrap_or_default();
            renderer
                .display(exposure, self.args.tonemap.unwrap_or_default())
                .write_png(&mut file)?;
        }
        target.write(&file.into_inner())?;
        Ok(renderer.mirror_count())
    }

    /// The picture and its number of mirrors from a GPU, if one is asked for and can do it.
    #[cfg(feature = "gpu")]
    fn on_gpu(
        &self,
        solution: &Solution,
        target: &Target,
        gpu: &GpuArgs,
        global: GlobalArgs,
    ) -> Result<Option<(Image<Rgb>, usize)>, Failure> {
        use crate::picture_on_gpu::{Wanted, draw};
        if !self.args.uses_gpu() {
            return Ok(None);
        }
        let wanted = Wanted {
            camera: &self.camera,
            options: &self.options,
            surroundings: self.surroundings.as_ref(),
            reflections: &reflections(self.args)?,
            exposure: self.args.exposure.unwrap_or_default(),
            tone_map: self.args.tonemap.unwrap_or_default(),
            is_linear: target.ends_in("exr"),
        };
        match draw(solution, gpu.adapter.as_deref(), &wanted) {
            Ok(drawn) => Ok(Some(drawn)),
            Err(error) if gpu.require_gpu => Err(Failure::Failed(error.to_string())),
            Err(error) => {
                if !global.quiet {
                    let why = crate::failure::one_line(&error.to_string());
                    eprintln!("hemicube: note: {why}; drawing with the CPU");
                }
                Ok(None)
            }
        }
    }

    /// None: the program was built without.
    #[cfg(not(feature = "gpu"))]
    fn on_gpu(
        &self,
        _: &Solution,
        _: &Target,
        _: &GpuArgs,
        _: GlobalArgs,
    ) -> Result<Option<(Image<Rgb>, usize)>, Failure> {
        Ok(None)
    }

    /// Everything that the options ask of a renderer.
    fn renderer<'s>(&'s self, solution: &'s Solution) -> Result<Renderer<'s>, Failure> {
        let mut renderer = Renderer::new(solution, &self.camera, &self.options)?;
        if let Some(map) = &self.surroundings {
            renderer = renderer.with_surroundings(map.clone());
        }
        Ok(renderer.with_reflections(&reflections(self.args)?)?)
    }

    /// What a display shows of a solution under a given exposure.
    pub fn display(&self, solution: &Solution, exposure: Exposure) -> Result<Image<Rgb>, Failure> {
        let renderer = self.renderer(solution)?;
        Ok(renderer.display(exposure, self.args.tonemap.unwrap_or_default()))
    }

    /// The exposure that was asked for; an automatic one as it is for this solution, in stops.
    pub fn exposure(&self, solution: &Solution) -> Result<Exposure, Failure> {
        let wanted = self.args.exposure.unwrap_or_default();
        let renderer = self.renderer(solution)?;
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

    /// The ends in pixels of a segment, as far as it is in front of the eye; `None` if all of it is behind.
    pub fn segment(&self, from: Vec3, to: Vec3) -> Result<Option<[[f64; 2]; 2]>, Failure> {
        let projection = self.camera.projection;
        if matches!(
            projection,
            Projection::Panorama | Projection::Fisheye { .. }
        ) {
            return Err(Failure::Usage(String::from(
                "lines over a panorama or a fisheye's picture would be bent; choose --projection perspective",
            )));
        }
        let (width, height) = (self.options.width as f64, self.options.height as f64);
        let clip = clip_from_world(&self.camera, width / height, 1.0, 2.0);
        let [a, b] = [from, to].map(|point| clip * point.as_dvec3().extend(1.0));
        // Nothing nearer to the eye than a share of the segment.
        let least = 1e-3 * a.w.abs().max(b.w.abs());
        if a.w < least && b.w < least {
            return Ok(None);
        }
        let cut = |near: DVec4, far: DVec4| near.lerp(far, (least - near.w) / (far.w - near.w));
        let a = if a.w < least { cut(a, b) } else { a };
        let b = if b.w < least { cut(b, a) } else { b };
        let pixel = |p: DVec4| {
            [
                0.5 * width * (1.0 + p.x / p.w),
                0.5 * height * (1.0 - p.y / p.w),
            ]
        };
        Ok(Some([pixel(a), pixel(b)]))
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

/// What is to mirror.
fn reflections(args: &PictureArgs) -> Result<Reflections, Failure> {
    let names = &args.environment;
    if let [_, _, ..] = names.as_slice()
        && names.iter().any(|name| name == "none")
    {
        return Err(Failure::Usage(String::from(
            "--environment none with other names: nothing mirrors, or what is named",
        )));
    }
    let metals = names.is_empty() || names.iter().any(|name| name == "metals");
    let defaults = Reflections::default();
    let below = args.mirror_roughness.unwrap_or(defaults.metals_below);
    let is_name = |name: &&String| !["metals", "none"].contains(&name.as_str());
    Ok(defaults
        .with_metals_below(if metals { below } else { 0.0 })
        .with_names(names.iter().filter(is_name).cloned().collect()))
}

/// The map of the surroundings.
fn surroundings(path: &Path) -> Result<EnvironmentMap, Failure> {
    let opened = open_map(path, None).map_err(|error| match error {
        OpenMapError::Unclear { .. } => {
            Failure::Failed(format!("{error}; `hemicube environment convert` makes one"))
        }
        error => Failure::Failed(error.to_string()),
    });
    Ok(opened?.map)
}

fn surroundings_files(path: &Path) -> Result<Vec<PathBuf>, Failure> {
    map_files(path, None).map_err(|error| Failure::Failed(error.to_string()))
}

/// Refuses to draw lines into radiance.
pub fn refuse_mesh_in(target: &Target, args: &PictureArgs) -> Result<(), Failure> {
    if args.mesh.is_some() && target.ends_in("exr") {
        return Err(Failure::Usage(format!(
            "--mesh draws over what a display shows, and {} is to hold radiance; name a .png",
            target.path.display()
        )));
    }
    Ok(())
}

/// Refuses to draw over a picture of the surroundings.
pub fn refuse_surroundings(target: &Target, args: &PictureArgs) -> Result<(), Failure> {
    let Some(path) = &args.environment_file else {
        return Ok(());
    };
    if surroundings_files(path)?.iter().any(|file| target.is(file)) {
        return Err(Failure::Usage(format!(
            "{}: is read by --environment-file, and would be lost; choose another name",
            target.path.display()
        )));
    }
    Ok(())
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
    project(&mut camera, args)?;
    Ok(camera)
}

/// Gives the camera the projection and the angle of view that the options ask for.
fn project(camera: &mut Camera, args: &PictureArgs) -> Result<(), Failure> {
    let degrees = |default: f32| args.fov.unwrap_or(default).to_radians();
    let fisheye = |mapping| Projection::Fisheye {
        angle: degrees(180.0),
        mapping,
    };
    match args.projection {
        Some(ProjectionKind::Panorama) => {
            camera.projection = Projection::Panorama;
            level(camera);
        }
        Some(ProjectionKind::Fisheye) => camera.projection = fisheye(FisheyeMapping::Equidistant),
        Some(ProjectionKind::FisheyeEquisolid) => {
            camera.projection = fisheye(FisheyeMapping::Equisolid);
        }
        Some(ProjectionKind::Perspective)
            if !matches!(camera.projection, Projection::Perspective { .. }) =>
        {
            let vertical_fov = degrees(FOV);
            camera.projection = Projection::Perspective {
                vertical_fov,
                aspect: None,
            };
        }
        Some(ProjectionKind::Perspective) | None => {}
    }
    let refused = |what: String| Err(Failure::Usage(format!("--fov: {what}")));
    match (&mut camera.projection, args.fov) {
        (Projection::Perspective { .. }, Some(given)) if given > MAX_FLAT_FOV => refused(format!(
            "{given} degrees do not fit a flat picture; use at most {MAX_FLAT_FOV}, or --projection fisheye"
        )),
        (Projection::Perspective { vertical_fov, .. }, Some(given)) => {
            *vertical_fov = given.to_radians();
            Ok(())
        }
        (Projection::Orthographic { .. }, Some(_)) => refused(format!(
            "camera '{}' is orthographic and has no angle of view",
            camera.name
        )),
        (Projection::Panorama, Some(_)) => refused(String::from("a panorama shows all directions")),
        (Projection::Fisheye { .. }, Some(_)) | (_, None) => Ok(()),
    }
}

/// Turns a camera until it looks along the ground, so that a panorama's horizon is straight.
fn level(camera: &mut Camera) {
    let ahead = camera.forward.reject_from_normalized(Vec3::Y);
    let ahead = ahead.try_normalize().or_else(|| {
        // One that looks straight up or down has its heading at the top of its picture.
        camera.up.reject_from_normalized(Vec3::Y).try_normalize()
    });
    camera.forward = ahead.unwrap_or(Vec3::NEG_Z);
    camera.up = Vec3::Y;
}

/// A size in the camera's proportions.
fn default_size(camera: &Camera) -> (u32, u32) {
    let aspect = match camera.projection {
        Projection::Perspective { aspect, .. } => aspect,
        Projection::Orthographic {
            half_width,
            half_height,
        } => Some(half_width / half_height),
        Projection::Panorama => Some(2.0),
        Projection::Fisheye { .. } => Some(1.0),
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
