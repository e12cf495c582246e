//! Solution in, picture out.

use crate::behind::Behind;
use crate::capture::capture;
use crate::draw::draw;
use crate::error::RenderError;
use crate::lens::Lens;
use crate::options::{MeshOverlay, RenderOptions, Shading};
use crate::projection::check_camera;
use crate::reflections::{Mirrors, Reflections};
use crate::shade::{Light, Shader};
use crate::stage::Stage;
use hemicube_radiosity::{GatherOptions, Gatherer, Solution};
use hemicube_raster::antialias::Antialiasing;
use hemicube_raster::environment::{EnvironmentMap, EnvironmentPyramid};
use hemicube_raster::tonemap::{Exposure, ToneMap};
use hemicube_raster::{Image, Rgb};
use hemicube_scene::Camera;

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
    surroundings: Option<EnvironmentPyramid>,
    mirrors: Option<Mirrors>,
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
            surroundings: None,
            mirrors: None,
            progress: None,
        })
    }

    /// Shows a picture of the surroundings behind everything, in place of a uniform sky or background. It lights nothing.
    /// Mirrors that are to show it must be asked for afterwards.
    pub fn with_surroundings(self, map: EnvironmentMap) -> Self {
        let surroundings = Some(EnvironmentPyramid::new(map));
        Self {
            surroundings,
            ..self
        }
    }

    /// Lets smooth metals and what is named mirror what is around them: takes the maps that this needs.
    ///
    /// # Errors
    /// A name that nothing has, maps of an impossible size; one line.
    pub fn with_reflections(self, reflections: &Reflections) -> Result<Self, RenderError> {
        reflections.check(self.stage.scene())?;
        let mirrors = capture(&self.stage, self.behind(), reflections);
        let mirrors = Some(mirrors).filter(|mirrors| !mirrors.mirrors.is_empty());
        Ok(Self { mirrors, ..self })
    }

    /// Number of maps that were taken for mirroring objects.
    pub fn mirror_count(&self) -> usize {
        self.mirrors.as_ref().map_or(0, |m| m.mirrors.len())
    }

    fn behind(&self) -> Behind<'_> {
        match &self.surroundings {
            Some(map) => Behind::Map(map),
            None => Behind::Uniform(self.stage.behind),
        }
    }

    /// Reports the finished share of each picture; gathered ones take long.
    pub fn with_progress(self, progress: Progress<'a>) -> Self {
        let progress = Some(progress);
        Self { progress, ..self }
    }

    /// Linear radiance, see [`render`].
    pub fn linear(&self) -> Image<Rgb> {
        self.picture(None, |radiance| radiance)
    }

    /// What a display shows, see [`render_display`].
    pub fn display(&self, exposure: Exposure, tone_map: ToneMap) -> Image<Rgb> {
        let factor = self.exposure_factor(exposure);
        let mesh = self.options.mesh;
        self.picture(mesh, |radiance| tone_map.apply(radiance, factor))
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
        let shader = self
            .shader(&small, Light::Gouraud)
            .with_behind(Behind::Uniform(Rgb::BLACK));
        let same = |radiance| radiance;
        let image = draw(&shader, self.camera, &small, None, same, |_| {});
        exposure.factor(image.pixels().iter().map(|c| c.luminance()))
    }

    /// The picture with `resolve` applied to each sample, and then lines over it, before averaging.
    fn picture(
        &self,
        mesh: Option<MeshOverlay>,
        resolve: impl Fn(Rgb) -> Rgb + Sync,
    ) -> Image<Rgb> {
        let report = |share| {
            if let Some(progress) = self.progress {
                progress(share);
            }
        };
        let shader = self
            .shader(&self.options, self.light())
            .with_lines(mesh, self.options.height);
        draw(&shader, self.camera, &self.options, None, resolve, report)
    }

    fn shader<'b>(&'b self, options: &RenderOptions, light: Light<'b>) -> Shader<'b> {
        let lens = Lens::new(self.camera, options.width, options.height);
        let spacing = 1.0 / options.antialias.factor.get() as f64;
        Shader::new(&self.stage, light, lens, spacing)
            .with_behind(self.behind())
            .with_mirrors(self.mirrors.as_ref())
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
