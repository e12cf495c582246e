//! Options of environment maps.

use super::{SceneArgs, SolveArgs, parse};
use clap::{Args, Subcommand};
use glam::Vec3;
use hemicube::raster::antialias::Antialiasing;
use hemicube::raster::environment::{Layout, Projection};
use hemicube::raster::tonemap::{Exposure, ToneMap};
use hemicube::render::Shading;
use std::path::PathBuf;

const HELP: &str = "\
Examples:
  hemicube environment convert sky.hdr -o sky.exr --to cube
  hemicube environment convert sky.hdr -o sky-{face}.png --to cube --size 512
  hemicube environment convert faces/ -o panorama.hdr --to latlong
  hemicube environment capture office -o desk.exr --at 2,1.2,1.5
  hemicube environment info sky.hdr

`hemicube environment TASK --help` explains each task.";

/// Converts, captures or describes environment maps: light from all directions around a point
#[derive(Debug, Args)]
#[command(after_help = HELP, arg_required_else_help = true)]
pub struct EnvironmentVerb {
    #[command(subcommand)]
    pub task: EnvironmentTask,
}

#[derive(Debug, Subcommand)]
pub enum EnvironmentTask {
    /// Bring a map into another projection, keeping its light
    Convert(ConvertTask),
    /// Render a map of what is seen from a point of a scene
    Capture(Box<CaptureTask>),
    /// Say what a map is and how much light it holds
    Info(InfoTask),
}

const MAPS: &str = "\
A map is one picture, or one for each face: a folder with them, or a name with {face} in it. Faces are called px, nx, py, \
ny, pz, nz (posx, negx, ... or right, left, top, bottom, front, back are read too), the halves of a paraboloid front, back. \
The world is right-handed with +y up. Face pz lies ahead, at -z; px at the right, at +x.

  cube           six faces with the orientation of graphics interfaces; in one picture cross, row or column
  latlong        2:1 panorama: ahead in the middle, zenith above
  sphere         mirror ball from afar (matcap, GL_SPHERE_MAP): behind, +z, in the middle
  paraboloid     two halves, ahead and behind
  octahedral     square: zenith in the middle, nadir in the corners
  angular        light probe: 180 degrees at the rim
  fisheye        equidistant, 180 degrees across; hemispherical: orthographic. What lies behind is black

Pixels outside the disc of a sphere, angular, fisheye or hemispherical map are black in files that are written, and not \
looked at in those that are read; the halves of a paraboloid go on over their rim, for filters. Pixels that are not finite \
are read as 0 if they are no number, else as 65504; `info` tells where they are.";

const CONVERT_HELP: &str = "\
Examples:
  hemicube environment convert sky.hdr -o sky.exr --to cube
  hemicube environment convert sky.hdr -o sky-{face}.png --to cube --size 512
  hemicube environment convert ball.png -o probe.hdr --from sphere --to angular

Uniform light stays uniform, and the flux of the map stays what it is, exactly; a sun in one pixel keeps its energy. What \
the conversion did is printed, with a check of the solid angles. Corners of discs (sphere, angular, fisheye, hemispherical) \
become black.";

/// Brings an environment map into another projection, keeping its light
#[derive(Debug, Args)]
#[command(after_help = CONVERT_HELP, after_long_help = format!("{CONVERT_HELP}\n\n{MAPS}"))]
pub struct ConvertTask {
    /// Map to read: .hdr, .exr, .png, .jpg or .webp, a folder of faces, or a name with {face} in it
    #[arg(value_name = "IN")]
    pub input: PathBuf,
    /// Map to write; with {face} in its name one file for each face
    #[arg(short, long, value_name = "OUT.hdr|.exr|.png")]
    pub output: PathBuf,
    /// Projection to make
    #[arg(long, value_name = "PROJECTION", value_parser = parse::choice(&Projection::ALL, Projection::name))]
    pub to: Projection,
    /// Projection of the input [default: told by its sides: 2:1 latlong; 4:3, 3:4, 6:1, 1:6 cube]
    #[arg(long, value_name = "PROJECTION", value_parser = parse::choice(&Projection::ALL, Projection::name))]
    pub from: Option<Projection>,
    /// Rows of a face [default: as many as keep all detail]
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = parse::whole::<u32>(1..=8192))]
    pub size: Option<u32>,
    /// How several faces lie in one picture [default: cross for a cube, row for a paraboloid]
    #[arg(long, value_name = "LAYOUT", value_parser = parse::choice(&Layout::ALL, Layout::name))]
    pub layout: Option<Layout>,
    #[command(flatten)]
    pub tones: TonesArgs,
}

/// How light becomes colour in a .png.
#[derive(Debug, Clone, Copy, Default, Args)]
#[command(next_help_heading = "Tones of .png")]
pub struct TonesArgs {
    /// Stops brighter or darker (0: radiance 1 is display white), or auto [default: 0 if the input has 8 bits, else auto]
    #[arg(long, value_name = "EV|auto", allow_hyphen_values = true)]
    pub exposure: Option<Exposure>,
    /// Tone curve [default: none if the input has 8 bits, else reinhard]
    #[arg(long, value_parser = parse::choice(&ToneMap::ALL, ToneMap::name))]
    pub tonemap: Option<ToneMap>,
}

const CAPTURE_HELP: &str = "\
Examples:
  hemicube environment capture office -o desk.exr --at 2,1.2,1.5
  hemicube environment capture lit.glb -o desk-{face}.png --at 2,1.2,1.5 --size 512 --shading gather

Six pictures of 90 degrees are rendered from the point: radiance in the scene's units in .exr and .hdr, what a display shows \
in .png. With --to sphere, angular, fisheye or hemispherical the corners outside the disc are black.";

/// Renders an environment map of what is seen from a point of a scene
#[derive(Debug, Args)]
#[command(after_help = CAPTURE_HELP, after_long_help = format!("{CAPTURE_HELP}\n\n{MAPS}"))]
pub struct CaptureTask {
    /// Lit .glb, or a scene that is solved first: a file or the name of a built-in one
    #[arg(value_name = "SCENE|LIT.glb")]
    pub scene: PathBuf,
    /// Map to write; with {face} in its name one file for each face
    #[arg(short, long, value_name = "OUT.hdr|.exr|.png")]
    pub output: PathBuf,
    /// Where the eye is, in scene units (metres)
    #[arg(long, value_name = "X,Y,Z", value_parser = parse::point, allow_hyphen_values = true)]
    pub at: Vec3,
    /// Projection to make [default: cube]
    #[arg(long, value_name = "PROJECTION", value_parser = parse::choice(&Projection::ALL, Projection::name))]
    pub to: Option<Projection>,
    /// Rows of each of the six pictures
    #[arg(long, value_name = "N", allow_negative_numbers = true, default_value_t = 256, value_parser = parse::whole::<u32>(1..=2048))]
    pub size: u32,
    /// How several faces lie in one picture [default: cross for a cube, row for a paraboloid]
    #[arg(long, value_name = "LAYOUT", value_parser = parse::choice(&Layout::ALL, Layout::name))]
    pub layout: Option<Layout>,
    /// One colour an element, smooth, or light gathered at each pixel (slow, sharp shadows) [default: gouraud]
    #[arg(long, value_parser = parse::choice(&Shading::ALL, Shading::name))]
    pub shading: Option<Shading>,
    /// Samples of each pixel, their pattern and filter, as in 4x4:bartlett or 4-jittered:mitchell [default: 3x3]
    #[arg(
        long,
        value_name = "NxN[-jittered][:FILTER]",
        allow_hyphen_values = true
    )]
    pub antialias: Option<Antialiasing>,
    #[command(flatten)]
    pub tones: TonesArgs,
    #[command(flatten)]
    pub solve: SolveArgs,
    #[command(flatten)]
    pub scene_options: SceneArgs,
}

/// Says what an environment map is and how much light it holds
#[derive(Debug, Args)]
#[command(
    after_help = "Examples:\n  hemicube environment info sky.hdr\n  hemicube environment info ball.png --from sphere --json",
    after_long_help = format!("Examples:\n  hemicube environment info sky.hdr\n  hemicube environment info ball.png --from sphere --json\n\n{MAPS}")
)]
pub struct InfoTask {
    /// Map to read: a picture, a folder of faces, or a name with {face} in it
    #[arg(value_name = "IN")]
    pub input: PathBuf,
    /// Projection of the input [default: told by its sides: 2:1 latlong; 4:3, 3:4, 6:1, 1:6 cube]
    #[arg(long, value_name = "PROJECTION", value_parser = parse::choice(&Projection::ALL, Projection::name))]
    pub from: Option<Projection>,
}
