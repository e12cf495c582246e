//! The command line.

mod environment;
mod form_factors;
mod gpu;
mod method;
mod parse;
mod picture;
mod scene;
mod solve;

pub use environment::{
    CaptureTask, ConvertTask, EnvironmentTask, EnvironmentVerb, InfoTask, TonesArgs,
};
pub use form_factors::FormFactorsVerb;
pub use gpu::GpuArgs;
pub use picture::{PictureArgs, ProjectionKind};
pub use scene::SceneArgs;
pub use solve::{LiveArgs, MeshArgs, SolveArgs};

use clap::{Args, Parser, Subcommand};
use hemicube::radiosity::SolverKind;
use std::path::PathBuf;
use std::time::Duration;

const LONG_ABOUT: &str = "\
Computes how light spreads through a scene (radiosity), in physical units.

`solve` turns a scene into a lit .glb: it looks lit in any glTF viewer and holds the whole solution, from which `render` \
draws pictures and `measure` reads irradiance and lux, at once and as often as you like. A scene is a .glb, .gltf, \
.obj, .stl or .vs3 file or a built-in one. If a picture stays black, `info` says why.";

const EXAMPLES: &str = "\
Examples:
  hemicube solve cornell -o lit.glb --image cornell.png
  hemicube render lit.glb -o view.png --eye 2,1.6,3 --look-at 0,1,0
  hemicube measure lit.glb --points desk.csv -o lux.csv
  hemicube form-factors enclosure.vs3 -o F.csv

Exit codes: 0 done; 1 could not be done (one line says why); 2 wrong usage; 130 ended by Ctrl-C, nothing written.
`hemicube VERB --help` explains each verb.";

/// Radiosity: a scene goes in, light you can trust comes out
#[derive(Debug, Parser)]
#[command(name = "hemicube", version, about = LONG_ABOUT, after_help = EXAMPLES, arg_required_else_help = true)]
#[command(disable_help_subcommand = true, max_term_width = 110)]
pub struct Cli {
    #[command(flatten)]
    pub global: GlobalArgs,
    #[command(subcommand)]
    pub verb: Verb,
}

/// Options of all verbs.
#[derive(Debug, Clone, Copy, Args)]
#[command(next_help_heading = "General")]
pub struct GlobalArgs {
    /// Print one JSON object on standard output and nothing else
    #[arg(long, global = true, display_order = 900)]
    pub json: bool,
    /// No progress bar, no notes; errors are still printed
    #[arg(long, short, global = true, display_order = 901)]
    pub quiet: bool,
    /// Threads to compute with; the result does not depend on it [default: all]
    #[arg(long, global = true, value_name = "N", allow_negative_numbers = true, value_parser = parse::whole::<u16>(1..=1024), display_order = 902)]
    pub threads: Option<u16>,
}

#[derive(Debug, Subcommand)]
pub enum Verb {
    /// Compute the light in a scene; write a lit .glb, a picture, or both
    Solve(SolveVerb),
    /// Read irradiance and illuminance at points
    Measure(MeasureVerb),
    /// Draw a picture of a scene or of a lit .glb
    Render(RenderVerb),
    /// Compute the view factors between the faces or objects of a scene
    FormFactors(FormFactorsVerb),
    /// Compare solvers after the same number of steps: pictures and error curves
    Compare(CompareVerb),
    /// Convert, capture or describe environment maps: light from all directions around a point
    Environment(EnvironmentVerb),
    /// Walk through a scene in a window while its light is solved
    View(ViewVerb),
    /// List the exhibits that show each technique at work, or draw them
    Gallery(GalleryVerb),
    /// List the GPUs of this machine and what they can do
    #[command(after_help = "Example:\n  hemicube adapters")]
    Adapters,
    /// List the built-in scenes
    #[command(after_help = "Example:\n  hemicube scenes")]
    Scenes,
    /// Say what is in a scene, and why it would stay black or leak light
    Info(InfoVerb),
    /// Print a script that completes this program's options in a shell
    Completions(CompletionsVerb),
}

const SOLVE_HELP: &str = "\
Examples:
  hemicube solve cornell -o lit.glb --image cornell.png
  hemicube solve room.glb -o lit.glb --emit 'lamp*=3000' --quality final --time 10m
  hemicube solve --resume lit.glb -o better.glb --tolerance 1e-4 --solver conjugate-gradient
  hemicube solve cornell --solver overshooting --convergence history.png
  hemicube solve conference-room --solver hierarchical --image room.png --links links.png
  hemicube solve office --adaptive 0.2 -o lit.glb --image mesh.png --mesh

Without -o and --image only the report is printed. Ctrl-C stops and writes what has been reached (exit code 0, or 130 if there is no file to write); a second Ctrl-C ends \
at once.";

/// Computes the light in a scene; writes a lit .glb, a picture, or both
#[derive(Debug, Args)]
#[command(after_help = SOLVE_HELP)]
pub struct SolveVerb {
    /// Scene file (.glb, .gltf, .obj, .stl, .vs3) or name of a built-in scene; may be left out with --resume
    #[arg(value_name = "SCENE", required_unless_present = "resume")]
    pub scene: Option<PathBuf>,
    /// Lit .glb to write: looks lit in any viewer and holds the whole solution
    #[arg(short, long, value_name = "FILE.glb")]
    pub output: Option<PathBuf>,
    /// Picture to write: .png for the eye, .exr for radiance in physical units
    #[arg(long, value_name = "FILE.png|.exr")]
    pub image: Option<PathBuf>,
    /// History of the solver to write: step, seconds, unshot share, residual, error; a table, or curves
    #[arg(long, value_name = "FILE.csv|.png|.svg")]
    pub convergence: Option<PathBuf>,
    /// The 400 strongest links of --solver hierarchical to write, lines over the picture or alone; warm colours are of
    /// clusters, cold ones of small parts
    #[arg(long, value_name = "FILE.png|.svg")]
    pub links: Option<PathBuf>,
    /// Go on with the solution in a lit .glb instead of starting afresh; mesh and scene are those of the file
    #[arg(long, value_name = "LIT.glb")]
    pub resume: Option<PathBuf>,
    #[command(flatten)]
    pub solve: SolveArgs,
    #[command(flatten)]
    pub scene_options: SceneArgs,
    #[command(flatten)]
    pub picture: PictureArgs,
}

const MEASURE_HELP: &str = "\
Example:
  hemicube measure lit.glb --points desk.csv -o lux.csv

The points are a CSV file: columns x,y,z,nx,ny,nz in any order (or six numbers a line without a header), separated by \
comma or semicolon, in metres of the solved scene, +Y up; the normal points to the side that is measured. Further \
columns are passed through. Added are irradiance_r,irradiance_g,irradiance_b (lx or W/m²) and illuminance (lx).";

/// Reads irradiance and illuminance at points
#[derive(Debug, Args)]
#[command(after_help = MEASURE_HELP)]
pub struct MeasureVerb {
    /// Lit .glb, or a scene that is solved first: a file or the name of a built-in one
    #[arg(value_name = "SCENE|LIT.glb")]
    pub scene: PathBuf,
    /// CSV file of points and normals; - reads standard input
    #[arg(long, value_name = "IN.csv")]
    pub points: PathBuf,
    /// CSV file to write [default: standard output]
    #[arg(short, long, value_name = "OUT.csv")]
    pub output: Option<PathBuf>,
    /// Rays over the hemisphere of each point [default: 2048]
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = parse::whole::<u32>(1..=1 << 20))]
    pub gather_rays: Option<u32>,
    #[command(flatten)]
    pub solve: SolveArgs,
    #[command(flatten)]
    pub scene_options: SceneArgs,
}

const RENDER_HELP: &str = "\
Examples:
  hemicube render lit.glb -o view.png
  hemicube render office -o desk.png --camera desk --shading gather --size 480x320
  hemicube render lit.glb -o view.exr --eye 2,1.6,3 --look-at 0,1,0 --fov 70
  hemicube render lit.glb -o mesh.png --mesh=patches
  hemicube render lit.glb -o all.png --projection panorama --size 2048x1024 --antialias 4x4:bartlett
  hemicube render lit.glb -o view.png --draw-on gpu --antialias 2x2:bartlett
  hemicube render model.glb -o model.png --sky 1,1,1 --environment '*chrome*' --environment-file sky.hdr

Metals reflect diffusely in the solution. In pictures smooth ones mirror what is around them (--environment), rough ones \
stay matt; nothing mirrors a mirror.";

/// Draws a picture of a scene or of a lit .glb
#[derive(Debug, Args)]
#[command(after_help = RENDER_HELP)]
pub struct RenderVerb {
    /// Lit .glb, or a scene that is solved first: a file or the name of a built-in one
    #[arg(value_name = "SCENE|LIT.glb")]
    pub scene: PathBuf,
    /// Picture to write: .png for the eye, .exr for radiance in physical units
    #[arg(short, long, value_name = "FILE.png|.exr")]
    pub output: PathBuf,
    #[command(flatten)]
    pub picture: PictureArgs,
    #[command(flatten)]
    pub solve: SolveArgs,
    #[command(flatten)]
    pub scene_options: SceneArgs,
}

const GALLERY_HELP: &str = "\
Examples:
  hemicube gallery
  hemicube gallery -o pictures
  hemicube gallery -o pictures NAME --size 512x512

Without -o the exhibits are listed. With -o and no NAME all of them are drawn that need no file.";

/// Lists the exhibits that show each technique at work, or draws them
#[derive(Debug, Args)]
#[command(after_help = GALLERY_HELP)]
pub struct GalleryVerb {
    /// Exhibits to draw [default: all that need no file]
    #[arg(value_name = "NAME")]
    pub names: Vec<String>,
    /// Folder for the pictures, charts and tables
    #[arg(short, long, value_name = "DIR")]
    pub output: Option<PathBuf>,
    /// Pixels of the main pictures [default: each exhibit's own]
    #[arg(long, value_name = "WxH", value_parser = parse::size)]
    pub size: Option<(u32, u32)>,
    /// A file that an exhibit needs; once for each, in the order of the list
    #[arg(long = "file", value_name = "FILE")]
    pub files: Vec<PathBuf>,
    /// Seed of what is random in them [default: 0]
    #[arg(long, value_name = "N")]
    pub seed: Option<u64>,
}

const COMPARE_HELP: &str = "\
Examples:
  hemicube compare cornell -o variants.png
  hemicube compare room.glb --steps 50 --variants sorted-shooting,overshooting,southwell -o variants.png --csv curves.csv

All variants start from the same light and use the same form factors. A step is what one row of them brings: one patch \
shoots, or one gathers; a sweep of jacobi, gauss-seidel or gauss is paid with as many steps as there are patches, an \
iteration of conjugate-gradient with twice as many. The error is the root of the mean squared error of radiosity over \
area, against the converged solution and relative to its reflected light: 100 % where only lamps shine. Nothing is written \
before all variants are done; Ctrl-C ends it at once (exit code 130).";

/// Compares solvers after the same number of steps from the same start: pictures, and the curves of their errors
#[derive(Debug, Args)]
#[command(after_help = COMPARE_HELP)]
pub struct CompareVerb {
    /// Scene file (.glb, .gltf, .obj, .stl, .vs3) or name of a built-in scene
    #[arg(value_name = "SCENE")]
    pub scene: PathBuf,
    /// Picture to write: one of the scene for each variant, below them the curves
    #[arg(short, long, value_name = "FILE.png")]
    pub output: Option<PathBuf>,
    /// Table of the curves to write
    #[arg(long, value_name = "FILE.csv")]
    pub csv: Option<PathBuf>,
    /// Steps of each variant
    #[arg(long, value_name = "N", default_value_t = 100, value_parser = parse::whole::<u64>(1..=1_000_000))]
    pub steps: u64,
    /// Solvers to compare [default: gathering,shooting,sorted-shooting,ambient-shooting]
    #[arg(long, value_name = "A,B,...", value_delimiter = ',', value_parser = parse::choice(&SolverKind::ALL, SolverKind::name))]
    pub variants: Vec<SolverKind>,
    /// Give up after this time since the program's start: 30s, 2m, 1h [default: no limit]
    #[arg(long, value_name = "TIME", value_parser = parse::duration)]
    pub time: Option<Duration>,
    #[command(flatten)]
    pub mesh: MeshArgs,
    #[command(flatten)]
    pub picture: PictureArgs,
    #[command(flatten)]
    pub scene_options: SceneArgs,
}

const VIEW_HELP: &str = "\
Examples:
  hemicube view
  hemicube view room.glb
  hemicube view house.obj --unit cm --up z --emit 'lamp*=3000' --camera kitchen --elements 20000
  hemicube view office --fresh --size 1280x720 --measure 20s

Light is solved in the background; walk, click surfaces, change lamps and paints, dim groups, measure. F1 lists keys and \
mouse. Window and settings are remembered; --fresh starts without and remembers nothing. Without a window system, draw \
with `hemicube render`.

--measure tries the window out and closes it: it waits for the first lit picture, stands still while light is solved (40 % \
of the time), turns around on the spot (40 %), and dims a lamp again and again (20 %). It prints when the first picture was \
there; frames a second with median, 95 %, 99 % and longest; how many of them had a new picture, and how wide its pixels \
were (a software driver that is late draws fewer while one walks); processor time a frame by threads (on Linux; those of a software driver are the drawing, `background` is the solver, the program's own name the \
window); how long input waited until a frame took it up; how long it took until half of the lamp's change was in the \
picture; and memory over time.";

/// Opens a window on a scene: walks through it while its light is solved
#[derive(Debug, Args)]
#[command(after_help = VIEW_HELP)]
pub struct ViewVerb {
    /// Scene file, lit .glb, session (.json) or name of a built-in scene
    #[arg(value_name = "SCENE", default_value = "office")]
    pub scene: PathBuf,
    /// Try the window out for this time, close it and print what was measured
    #[arg(long, value_name = "TIME", value_parser = parse::duration)]
    pub measure: Option<Duration>,
    /// Size of the window [default: as it was last, at first 1280x800]
    #[arg(long, value_name = "WxH", value_parser = parse::size)]
    pub size: Option<(u32, u32)>,
    /// Start without what was set last time, and remember nothing
    #[arg(long)]
    pub fresh: bool,
    /// Camera of the scene to begin with [default: its first one, else one that sees most of the scene]
    #[arg(long, value_name = "NAME")]
    pub camera: Option<String>,
    #[command(flatten)]
    pub solve: LiveArgs,
    #[command(flatten)]
    pub scene_options: SceneArgs,
}

/// Says what is in a scene, and why it would stay black or leak light
#[derive(Debug, Args)]
#[command(
    after_help = "Examples:\n  hemicube info office\n  hemicube info house.obj --unit cm --up z"
)]
pub struct InfoVerb {
    /// Scene file, lit .glb (tells how its light was obtained) or name of a built-in scene
    #[arg(value_name = "SCENE")]
    pub scene: PathBuf,
    #[command(flatten)]
    pub scene_options: SceneArgs,
}

/// Prints a script that completes this program's options in a shell
#[derive(Debug, Args)]
#[command(
    after_help = "Example:\n  hemicube completions bash > ~/.local/share/bash-completion/completions/hemicube"
)]
pub struct CompletionsVerb {
    /// Which shell
    pub shell: clap_complete::Shell,
}
