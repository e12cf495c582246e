//! Options of pictures.

use super::parse;
use clap::Args;
use glam::Vec3;
use hemicube::raster::antialias::Antialiasing;
use hemicube::raster::tonemap::{Exposure, ToneMap};
use hemicube::render::{MeshOverlay, Shading, TextureFilter};
use std::path::PathBuf;

/// How a picture is projected.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ProjectionKind {
    /// Central.
    Perspective,
    /// Equirectangular, all around.
    Panorama,
    /// Equidistant.
    Fisheye,
    /// Equal solid angles.
    FisheyeEquisolid,
}

impl ProjectionKind {
    /// All of them.
    pub const ALL: [Self; 4] = [
        Self::Perspective,
        Self::Panorama,
        Self::Fisheye,
        Self::FisheyeEquisolid,
    ];

    /// Name of the option's value.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Perspective => "perspective",
            Self::Panorama => "panorama",
            Self::Fisheye => "fisheye",
            Self::FisheyeEquisolid => "fisheye-equisolid",
        }
    }
}

/// What draws a picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum DrawOn {
    /// The CPU.
    #[default]
    Cpu,
    /// A GPU.
    Gpu,
}

impl DrawOn {
    /// All of them.
    pub const ALL: [Self; 2] = [Self::Cpu, Self::Gpu];

    /// Name of the option's value.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Cpu => "cpu",
            Self::Gpu => "gpu",
        }
    }
}

/// Options of pictures.
#[derive(Debug, Clone, Default, Args)]
#[command(next_help_heading = "Picture")]
pub struct PictureArgs {
    /// Camera of the scene [default: its first one, else one that sees most of the scene]
    #[arg(long, value_name = "NAME", conflicts_with = "eye")]
    pub camera: Option<String>,
    /// Where the eye is, in scene units (metres)
    #[arg(long, value_name = "X,Y,Z", value_parser = parse::point, allow_hyphen_values = true)]
    pub eye: Option<Vec3>,
    /// Point in the middle of the picture [default: the middle of the scene]
    #[arg(long, value_name = "X,Y,Z", value_parser = parse::point, allow_hyphen_values = true, requires = "eye")]
    pub look_at: Option<Vec3>,
    /// How the camera projects: perspective, panorama (all directions on 2:1, level), fisheye (a disc), or fisheye-equisolid
    /// (a disc of equal solid angles) [default: the camera's]
    #[arg(long, value_name = "NAME", value_parser = parse::choice(&ProjectionKind::ALL, ProjectionKind::name))]
    pub projection: Option<ProjectionKind>,
    /// Angle of view in degrees: the vertical one, across the disc of a fisheye [default: the camera's, 60 with --eye, 180
    /// for fisheyes]
    #[arg(long, value_name = "DEG", allow_negative_numbers = true, value_parser = parse::angle)]
    pub fov: Option<f32>,
    /// Pixels [default: 960x640, or the camera's proportions within 960x720]
    #[arg(long, value_name = "WxH", value_parser = parse::size)]
    pub size: Option<(u32, u32)>,
    /// Stops brighter or darker of a .png or lit .glb (0: radiance 1 is display white), or auto [default: auto]
    #[arg(long, value_name = "EV|auto", allow_hyphen_values = true)]
    pub exposure: Option<Exposure>,
    /// Tone curve [default: reinhard]
    #[arg(long, value_parser = parse::choice(&ToneMap::ALL, ToneMap::name))]
    pub tonemap: Option<ToneMap>,
    /// One colour an element, smooth, or light gathered at each pixel (slow, sharp shadows) [default: gouraud]
    #[arg(long, value_parser = parse::choice(&Shading::ALL, Shading::name))]
    pub shading: Option<Shading>,
    /// Samples of each pixel, their pattern and filter: none, or N or NxN up to 32, then -jittered (or -jittered@BOUND, in
    /// pixels, else 1/6), then :box, :bartlett (or :bartlett-5x5), :gaussian, :mitchell, :blackman-harris or :lanczos, as in
    /// 4x4:bartlett or 4-jittered:mitchell [default: 3x3]
    #[arg(
        long,
        value_name = "NxN[-jittered][:FILTER]",
        allow_hyphen_values = true
    )]
    pub antialias: Option<Antialiasing>,
    /// Edges of the mesh over a .png, hidden where surfaces are, of elements (those that receive light) or patches (those
    /// that shoot it); --mesh alone means elements
    #[arg(long, value_name = "WHICH", num_args = 0..=1, require_equals = true, default_missing_value = "elements", value_parser = parse::choice(&MeshOverlay::ALL, MeshOverlay::name))]
    pub mesh: Option<MeshOverlay>,
    /// What draws the picture: cpu, or a gpu that --adapter chooses; it knows no panoramas, fisheyes, jitter and gathering
    /// [default: cpu]
    #[arg(long, value_name = "DEVICE", value_parser = parse::choice(&DrawOn::ALL, DrawOn::name))]
    pub draw_on: Option<DrawOn>,
    /// How textures are read from afar, from quick to good [default: ewa]
    #[arg(long, value_parser = parse::choice(&TextureFilter::ALL, TextureFilter::name))]
    pub texture_filter: Option<TextureFilter>,
    /// Materials or nodes that mirror what is around them (names may be globs), `metals` (those of a roughness below
    /// --mirror-roughness) or `none`; repeatable [default: metals]
    #[arg(long, value_name = "NAME|metals|none")]
    pub environment: Vec<String>,
    /// Metals mirror if their roughness is below this, others are drawn matt, as the solution has them [default: 0.3]
    #[arg(long, value_name = "X", allow_negative_numbers = true, value_parser = parse::share)]
    pub mirror_roughness: Option<f32>,
    /// Map of the surroundings behind everything and in mirrors; it lights nothing. A panorama (2:1) or a cube in a
    /// picture (.hdr, .exr, .png, .jpg or .webp), a folder of faces, or a name with {face} in it, see `environment`
    #[arg(long, value_name = "FILE")]
    pub environment_file: Option<PathBuf>,
    /// Rays over the hemisphere of each pixel of --shading gather [default: 256]
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = parse::whole::<u32>(1..=1 << 20))]
    pub gather_rays: Option<u32>,
}

impl PictureArgs {
    /// Whether a GPU draws the picture.
    pub fn uses_gpu(&self) -> bool {
        self.draw_on == Some(DrawOn::Gpu)
    }

    /// Names of the options that were given and concern the view, not how light becomes colour.
    pub fn view_given(&self) -> Vec<&'static str> {
        let all = [
            (self.camera.is_some(), "--camera"),
            (self.eye.is_some(), "--eye"),
            (self.projection.is_some(), "--projection"),
            (self.fov.is_some(), "--fov"),
            (self.size.is_some(), "--size"),
            (self.shading.is_some(), "--shading"),
            (self.antialias.is_some(), "--antialias"),
            (self.mesh.is_some(), "--mesh"),
            (self.draw_on.is_some(), "--draw-on"),
            (self.texture_filter.is_some(), "--texture-filter"),
            (!self.environment.is_empty(), "--environment"),
            (self.mirror_roughness.is_some(), "--mirror-roughness"),
            (self.environment_file.is_some(), "--environment-file"),
            (self.gather_rays.is_some(), "--gather-rays"),
        ];
        all.into_iter()
            .filter_map(|(given, name)| given.then_some(name))
            .collect()
    }

    /// Names of the options that were given and concern how light becomes colour.
    pub fn tones_given(&self) -> Vec<&'static str> {
        let all = [
            (self.exposure.is_some(), "--exposure"),
            (self.tonemap.is_some(), "--tonemap"),
        ];
        all.into_iter()
            .filter_map(|(given, name)| given.then_some(name))
            .collect()
    }
}
