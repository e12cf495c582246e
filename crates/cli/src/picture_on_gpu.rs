//! Pictures drawn by a GPU.

use hemicube::gpu::pass::{
    DrawOptions, Interpolation, Lookup, MeshLines, Smoothing, TextureFiltering, Walkthrough,
};
use hemicube::gpu::{Context, GpuError};
use hemicube::radiosity::Solution;
use hemicube::raster::environment::EnvironmentMap;
use hemicube::raster::texture::{Magnify, Minify};
use hemicube::raster::tonemap::{Exposure, ToneMap};
use hemicube::raster::{Image, Rgb};
use hemicube::render::{Reflections, RenderOptions, Shading, TextureFilter};
use hemicube::scene::Camera;
use std::sync::Arc;

/// What a picture shows and how.
#[derive(Debug)]
pub struct Wanted<'a> {
    pub camera: &'a Camera,
    pub options: &'a RenderOptions,
    pub surroundings: Option<&'a EnvironmentMap>,
    pub reflections: &'a Reflections,
    pub exposure: Exposure,
    pub tone_map: ToneMap,
    /// Radiance instead of what a display shows.
    pub is_linear: bool,
}

/// Draws a picture on the adapter of a name, and gives the number of maps that were taken for mirrors.
///
/// # Errors
/// There is no such adapter, or it cannot draw this.
pub fn draw(
    solution: &Solution,
    adapter: Option<&str>,
    wanted: &Wanted<'_>,
) -> Result<(Image<Rgb>, usize), GpuError> {
    let options = draw_options(wanted.options)?;
    let size = [wanted.options.width, wanted.options.height];
    let size = size.map(|side| u32::try_from(side).unwrap_or(u32::MAX));
    let context = Arc::new(Context::headless(adapter)?);
    let mut gpu = Walkthrough::new(context.clone(), solution)?;
    gpu.set_surroundings(wanted.surroundings.cloned())?;
    if options.bumps {
        gpu.gather_reliefs(solution);
    }
    let mirrors = gpu.set_reflections(solution, wanted.reflections, Lookup::Reflection)?;
    // Mirrors count for the exposure, and the exposure for what their maps keep.
    capture(&mut gpu, &context, 1.0)?;
    // Light is kept in 16 bits: also linear pictures are exposed on the way.
    let exposure = if wanted.is_linear {
        Exposure::Auto
    } else {
        wanted.exposure
    };
    let factor = gpu.exposure_factor(wanted.camera, size, exposure)?;
    capture(&mut gpu, &context, factor)?;
    let options = options.with_exposure(factor).with_tone_map(wanted.tone_map);
    let image = if wanted.is_linear {
        gpu.linear(wanted.camera, size, &options)?
    } else {
        gpu.display(wanted.camera, size, &options)?
    };
    Ok((image, mirrors))
}

fn capture(gpu: &mut Walkthrough, context: &Context, exposure: f32) -> Result<(), GpuError> {
    let mut encoder = context.device.create_command_encoder(&Default::default());
    gpu.capture(&mut encoder, exposure)?;
    context.queue.submit([encoder.finish()]);
    context.wait()
}

fn draw_options(options: &RenderOptions) -> Result<DrawOptions, GpuError> {
    let interpolation = match options.shading {
        Shading::Flat => Interpolation::Flat,
        Shading::Gouraud => Interpolation::Gouraud,
        Shading::Gather => {
            return Err(GpuError::Option(String::from(
                "--draw-on gpu draws flat or gouraud; light is gathered by the CPU",
            )));
        }
    };
    let (minify, magnify) = match options.texture_filter {
        TextureFilter::Point => (Minify::Point, Magnify::Point),
        TextureFilter::Bilinear => (Minify::Bilinear, Magnify::Bilinear),
        TextureFilter::Trilinear => (Minify::Trilinear, Magnify::Bilinear),
        TextureFilter::Ewa => (Minify::Ewa, Magnify::Bilinear),
    };
    let filtering = TextureFiltering::default()
        .with_minify(minify)
        .with_magnify(magnify);
    let drawn = DrawOptions::default()
        .with_interpolation(interpolation)
        .with_filtering(filtering)
        .with_smoothing(Smoothing::Supersample(options.antialias));
    Ok(match options.mesh {
        Some(_) => drawn.with_lines(MeshLines::default()),
        None => drawn,
    })
}
