//! Options of view-factor matrices.

use super::gpu::{FactorWay, GpuArgs};
use super::method::MethodGiven;
use super::{SceneArgs, parse};
use clap::Args;
use hemicube::radiosity::form_factor::{FormFactorKind, FormFactorOptions, SurfacesBy};
use hemicube::radiosity::patch::clean::CleanOptions;
use hemicube::radiosity::{PatchOptions, SolveOptions};
use std::path::PathBuf;

const HELP: &str = "\
Examples:
  hemicube form-factors enclosure.vs3 -o F.csv
  hemicube form-factors house.stl --unit mm --by object -o F.npy --json
  hemicube form-factors room.obj --elements 5000 --enclosure -o F.out

Row i, column j is F_ij: the share of what leaves surface i that arrives at surface j; what is missing to 1 goes to the \
sky or to the backs of one-sided faces. Rows are called like the nodes of the scene, with a number for each face of an \
object of several. Without -o, up to 12 surfaces are printed.

  .csv   name, area, factors, sky, absorbed, transmitted: pandas.read_csv(\"F.csv\", index_col=\"name\")
  .npy   the factors alone, f32: numpy.load(\"F.npy\")
  .mtx   Matrix Market, sparse, names in comments: scipy.io.mmread(\"F.mtx\")
  .out   the text file of View3D 4.0: areas, factors, emissivities

Of .vs3 files (View3D) T, F 3 and 3a, V, S, M, N, O, C and E are read; encl=1 does what --enclosure does.";

/// Rays over each hemisphere: factors are the result here, not a step on the way to it.
const RAYS: u32 = 4096;
/// Elements for methods that sample.
const ELEMENTS: usize = 500;

/// Computes the view factors between the faces or objects of a scene
#[derive(Debug, Args)]
#[command(after_help = HELP)]
pub struct FormFactorsVerb {
    /// Scene file (.glb, .gltf, .obj, .stl, .vs3) or name of a built-in scene
    #[arg(value_name = "SCENE")]
    pub scene: PathBuf,
    /// Matrix to write; the ending says how
    #[arg(short, long, value_name = "FILE.csv|.npy|.mtx|.out")]
    pub output: Option<PathBuf>,
    #[command(flatten)]
    pub factors: FactorArgs,
    #[command(flatten)]
    pub scene_options: SceneArgs,
}

/// Options of view-factor matrices.
#[derive(Debug, Clone, Default, Args)]
#[command(next_help_heading = "Form factors")]
pub struct FactorArgs {
    /// What a row stands for [default: face; object for .vs3]
    #[arg(long, value_name = "WHAT", value_parser = parse::choice(&SurfacesBy::ALL, SurfacesBy::name))]
    pub by: Option<SurfacesBy>,
    /// Way to the form factors; only analytic has no noise, but for pairs behind panes or very many surfaces, which
    /// rays tell; gpu draws hemicubes and gpu-raycast casts rays on a GPU [default: analytic]
    #[arg(long, value_name = "METHOD", value_parser = parse::choice(&FactorWay::ALL, FactorWay::name))]
    pub method: Option<FactorWay>,
    #[command(flatten)]
    pub gpu: GpuArgs,
    /// Wanted error of each factor, for analytic; smaller takes longer only where others are in the way [default: 1e-5]
    #[arg(long, value_name = "E", allow_negative_numbers = true, value_parser = parse::error)]
    pub error: Option<f64>,
    /// Rays over each hemisphere, for raycast, gpu-raycast and nusselt [default: 4096]
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = parse::whole::<u32>(1..=1 << 20))]
    pub rays: Option<u32>,
    /// Cells along an edge of a hemicube, even, from 16 to 4096, for hemicube, its variants and gpu [default: 256]
    #[arg(long, value_name = "R", allow_negative_numbers = true, value_parser = parse::resolution)]
    pub hemicube_resolution: Option<u32>,
    /// Cut faces until no edge is longer, in scene units, and sum the parts
    #[arg(long, value_name = "M", allow_negative_numbers = true, value_parser = parse::length)]
    pub element_size: Option<f32>,
    /// Cut faces into about so many parts instead [default: none for analytic, else 500]
    #[arg(long, value_name = "N", allow_negative_numbers = true, conflicts_with = "element_size", value_parser = parse::whole::<u32>(1..=u64::from(u32::MAX)))]
    pub elements: Option<u32>,
    /// Change the factors as little as closure (rows sum to 1) and reciprocity (A_i F_ij = A_j F_ji) allow; the report
    /// says how much that was. A row that loses up to 0.1 % to the sky, through its seams, loses nothing any more; more
    /// than that is an opening and stays in the sky's column
    #[arg(long)]
    pub enclosure: bool,
    /// Seed of all sampling [default: 0]
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    pub seed: Option<u64>,
}

impl FactorArgs {
    /// The way to the factors.
    fn way(&self) -> FactorWay {
        let analytic = FactorWay::Cpu(FormFactorKind::Analytic);
        self.method.unwrap_or(analytic)
    }

    /// Which of the CPU's ways it is, or is the twin of.
    pub fn kind(&self) -> FormFactorKind {
        self.way().kind()
    }

    /// Whether the factors come from a GPU.
    pub fn uses_gpu(&self) -> bool {
        self.way().uses_gpu()
    }

    /// What the ways to form factors need to know; `asked` is the error that the file asks for, which counts if it is
    /// below the default.
    pub fn options(&self, asked: Option<f64>) -> FormFactorOptions {
        let mut options = FormFactorOptions::default();
        let default = options.analytic.error;
        let of_file = asked.map_or(default, |asked| asked.clamp(1e-9, default));
        options.analytic.error = self.error.unwrap_or(of_file);
        options.analytic.seed = self.seed.unwrap_or(options.analytic.seed);
        options.raycast.rays = self.rays.unwrap_or(RAYS);
        options.nusselt.rays = self.rays.unwrap_or(RAYS);
        options.raycast.seed = self.seed.unwrap_or(options.raycast.seed);
        if let Some(resolution) = self.hemicube_resolution {
            options.hemicube.resolution = resolution;
        }
        options
    }

    /// The same for a backend.
    pub fn solve_options(&self, factors: &FormFactorOptions) -> SolveOptions {
        SolveOptions {
            form_factors: self.kind(),
            hemicube: factors.hemicube,
            rays: factors.raycast.rays,
            seed: factors.raycast.seed,
            ..SolveOptions::default()
        }
    }

    /// How faces are cut: patches are as fine as elements, since all are summed in the end. Faces are taken as they are:
    /// their factors are wanted, not those of mended ones.
    pub fn mesh(&self) -> PatchOptions {
        let cut = match (self.element_size, self.elements) {
            (Some(size), _) => PatchOptions::default()
                .with_element_size(size)
                .with_patch_size(size),
            (None, Some(count)) => PatchOptions::default()
                .with_elements(count as usize)
                .with_patches(count as usize),
            (None, None) if self.kind() == FormFactorKind::Analytic => PatchOptions::whole_faces(),
            // Sampling a factor as a whole leaves errors of a percent; of parts, of a hundredth of that.
            (None, None) => PatchOptions::default()
                .with_elements(ELEMENTS)
                .with_patches(ELEMENTS),
        };
        cut.with_clean(CleanOptions::none()).with_joints(false)
    }

    /// The option that was given for another method than the one in use.
    pub fn misplaced(&self) -> Option<String> {
        let given = MethodGiven {
            kind: self.kind(),
            name: self.way().name(),
            error: self.error.is_some(),
            rays: self.rays.is_some(),
            shot_rays: false,
            resolution: self.hemicube_resolution.is_some(),
        };
        given.misplaced("--method")
    }
}
