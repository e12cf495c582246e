//! Options of the mesh and the solver.

use super::gpu::{FactorWay, GpuArgs};
use super::method::MethodGiven;
use super::parse;
use crate::report::{SHARE_OF_MEMORY, free_memory};
use clap::Args;
use hemicube::radiosity::form_factor::FormFactorKind;
use hemicube::radiosity::solution::Provenance;
use hemicube::radiosity::{AdaptiveOptions, Quality, SolveOptions, SolverKind};
use hemicube::scene::Scene;
use std::time::Duration;

const SOLVER_HELP: &str = "\
Way to the equilibrium [default: auto]

  auto                ambient-shooting, or stochastic for more than 40,000 elements; says which
Rays alone; time grows with the scene, not with its square:
  stochastic          direct light by shadow rays from every element, the rest shot and gathered by rays until --noise is reached
Links between clusters, faces and their parts; time and memory grow with the scene, not with its square:
  hierarchical        links are refined where they carry error, until its estimate is at --noise
Shooting needs no matrix, and what it has reached can be drawn at any time:
  shooting            patches shoot in the order of the mesh
  sorted-shooting     the patch with most unshot light shoots
  ambient-shooting    the same; pictures of unfinished solutions add an estimate of the light to come
  overshooting        a patch shoots also what it is expected to get back
On the matrix of all form factors (4 bytes times patches squared, and as much again for southwell; gauss takes 8 for each \
channel):
  gauss               elimination; nothing to be seen before its end
  jacobi, gauss-seidel, gathering    patches gather: all at once, one after the other, one a step
  southwell           the patch with the largest residual first
  conjugate-gradient  descent; fewest steps in bright rooms";

/// A solver, by its name on the command line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SolverChoice {
    /// By the size of the scene.
    Auto,
    /// This one.
    Kind(SolverKind),
}

impl SolverChoice {
    const ALL: [Self; SolverKind::ALL.len() + 1] = {
        let mut all = [Self::Auto; SolverKind::ALL.len() + 1];
        let mut i = 0;
        while i < SolverKind::ALL.len() {
            all[i + 1] = Self::Kind(SolverKind::ALL[i]);
            i += 1;
        }
        all
    };

    fn name(self) -> &'static str {
        match self {
            Self::Auto => "auto",
            Self::Kind(kind) => kind.name(),
        }
    }
}

/// Options of the mesh and the form factors; each given one overrides the preset of `--quality`.
#[derive(Debug, Clone, Default, Args)]
#[command(next_help_heading = "Mesh and form factors")]
pub struct MeshArgs {
    /// Preset of mesh, rays and tolerance: about 1000, 4000 or 30,000 elements [default: normal]
    #[arg(long, value_parser = parse::choice(&Quality::ALL, Quality::name))]
    pub quality: Option<Quality>,
    /// Longest edge of the elements that receive light, in scene units (metres)
    #[arg(long, value_name = "M", allow_negative_numbers = true, value_parser = parse::length)]
    pub element_size: Option<f32>,
    /// Elements instead of a size, met within 5 % where faces are fewer [default: 4000]
    #[arg(long, value_name = "N", allow_negative_numbers = true, conflicts_with = "element_size", value_parser = parse::whole::<u32>(1..=u64::from(u32::MAX)))]
    pub elements: Option<u32>,
    /// Longest edge of the patches that shoot light, in scene units (metres)
    #[arg(long, value_name = "M", allow_negative_numbers = true, value_parser = parse::length)]
    pub patch_size: Option<f32>,
    /// Patches to aim at instead of a size [default: 400]
    #[arg(long, value_name = "N", allow_negative_numbers = true, conflicts_with = "patch_size", value_parser = parse::whole::<u32>(1..=u64::from(u32::MAX)))]
    pub patches: Option<u32>,
    /// Distance in scene units up to which vertices become one [default: two millionths of the scene's diagonal, for
    /// rounding]
    #[arg(long, value_name = "M", allow_negative_numbers = true, value_parser = parse::length)]
    pub weld: Option<f32>,
    /// Also turns around one-sided shells of which lamps, sky and cameras see backs only; faces that disagree with their
    /// neighbours are turned anyway
    #[arg(long, conflicts_with = "no_clean")]
    pub turn_to_light: bool,
    /// Takes the model as it is: no vertices are welded, no faces turned around, none lifted off others in their plane
    #[arg(long, conflicts_with = "weld")]
    pub no_clean: bool,
    /// Cut elements along the borders of shadows and penumbrae of lamps, points and sun, so that few elements draw them sharp
    #[arg(long)]
    pub discontinuities: bool,
    /// Do not cut elements where other faces cross or stand on them, nor in vertices of other faces on their edges
    #[arg(long)]
    pub no_joints: bool,
    /// Way to the form factors; gpu draws hemicubes and gpu-raycast casts rays on a GPU [default: raycast]
    #[arg(long, value_name = "METHOD", value_parser = parse::choice(&FactorWay::ALL, FactorWay::name))]
    pub form_factors: Option<FactorWay>,
    #[command(flatten)]
    pub gpu: GpuArgs,
    /// Cells along an edge of a hemicube, even, 16 to 4096, for --form-factors hemicube, its variants and gpu [default: 256]
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = parse::resolution)]
    pub hemicube_resolution: Option<u32>,
    /// Rays over each hemisphere, for raycast, gpu-raycast and nusselt, for a round of stochastic, and for the light of sky and sun [default: 256]
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = parse::whole::<u32>(1..=1 << 20))]
    pub rays: Option<u32>,
    /// Rays of every shot of raycast and gpu-raycast, so that a step has a fixed price, in place of a share of --rays by the
    /// patch's area and brightness; elements beyond the reach of few rays get noise [default: by --rays]
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = parse::whole::<u32>(1..=1 << 20))]
    pub shot_rays: Option<u32>,
    /// Seed of all sampling [default: 0]
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    pub seed: Option<u64>,
}

/// Options of the mesh and the solver; each given one overrides the preset of `--quality`.
#[derive(Debug, Clone, Default, Args)]
#[command(next_help_heading = "Solving")]
pub struct SolveArgs {
    #[command(flatten)]
    pub mesh: MeshArgs,
    /// Way to the equilibrium [default: auto]
    #[arg(long, long_help = SOLVER_HELP, value_name = "SOLVER", value_parser = parse::choice(&SolverChoice::ALL, SolverChoice::name))]
    pub solver: Option<SolverChoice>,
    /// Finished when this share of the emitted light has not been shot yet [default: 5e-4]
    #[arg(long, value_name = "T", allow_negative_numbers = true, value_parser = parse::tolerance)]
    pub tolerance: Option<f64>,
    /// For --solver stochastic and hierarchical: finished at this relative error of the irradiance by their own estimate,
    /// root mean square over the elements; of stochastic, those that get more than a hundredth of the mean [default: 0.03]
    #[arg(long, value_name = "X", allow_negative_numbers = true, value_parser = parse::noise)]
    pub noise: Option<f64>,
    /// At most so many steps (shots; sweeps, patches or blocks of columns on a matrix; refinements of links) [default: no
    /// limit]
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    pub iterations: Option<u64>,
    /// Stop after this time since the program's start: 30s, 2m, 1h [default: no limit]
    #[arg(long, value_name = "TIME", value_parser = parse::duration)]
    pub time: Option<Duration>,
    /// Cut elements further where light varies over them by more than this, as a share of the brightest place on them
    /// (0.1: ten percent), solve, and so on until none has more contrast or all that have are as small as allowed. Patches
    /// stay; the limits of --time and --iterations hold for all rounds together, and --resume goes on from the file's mesh.
    /// Light that is known up to noise is cut from three times its error on
    #[arg(long, value_name = "CONTRAST", allow_negative_numbers = true, value_parser = parse::contrast)]
    pub adaptive: Option<f32>,
    /// Edges of at most this length are not cut by --adaptive, in scene units (metres) [default: a sixteenth of the longest
    /// edge of the first elements]
    #[arg(long, value_name = "M", allow_negative_numbers = true, requires = "adaptive", value_parser = parse::length)]
    pub smallest: Option<f32>,
    /// Most elements that --adaptive may come to; of those with more contrast the ones that are shown with the largest error
    /// are cut [default: 4000000]
    #[arg(long, value_name = "N", allow_negative_numbers = true, requires = "adaptive", value_parser = parse::whole::<u32>(1..=parse::MAX_ELEMENTS))]
    pub most_elements: Option<u32>,
    /// Most memory in MiB for the matrix of solvers that work on one, or for links [default: 2048, or what is free if that
    /// is less]
    #[arg(long, value_name = "MIB", allow_negative_numbers = true, value_parser = parse::whole::<u32>(1..=1 << 24))]
    pub matrix_memory: Option<u32>,
}

/// Options of light that is solved while one looks at it; all of them can be changed in the window. What is not given
/// is as it was last.
#[derive(Debug, Clone, Default, Args)]
#[command(next_help_heading = "Solving (can be changed in the window) [default: as it was last]")]
pub struct LiveArgs {
    /// Preset of the mesh: about 1000, 4000 or 30,000 elements
    #[arg(long, value_parser = parse::choice(&Quality::ALL, Quality::name))]
    pub quality: Option<Quality>,
    /// Longest edge of the elements that receive light, in scene units (metres)
    #[arg(long, value_name = "M", allow_negative_numbers = true, value_parser = parse::length)]
    pub element_size: Option<f32>,
    /// Elements instead of a size, met within 5 % where faces are fewer
    #[arg(long, value_name = "N", allow_negative_numbers = true, conflicts_with = "element_size", value_parser = parse::whole::<u32>(1..=u64::from(u32::MAX)))]
    pub elements: Option<u32>,
    /// Longest edge of the patches that shoot light, in scene units (metres)
    #[arg(long, value_name = "M", allow_negative_numbers = true, value_parser = parse::length)]
    pub patch_size: Option<f32>,
    /// Patches to aim at instead of a size
    #[arg(long, value_name = "N", allow_negative_numbers = true, conflicts_with = "patch_size", value_parser = parse::whole::<u32>(1..=u64::from(u32::MAX)))]
    pub patches: Option<u32>,
    /// Way to the equilibrium, as for `hemicube solve`
    #[arg(long, value_name = "SOLVER", value_parser = parse::choice(&SolverKind::ALL, SolverKind::name))]
    pub solver: Option<SolverKind>,
    /// What computes form factors
    #[arg(long, value_name = "METHOD", value_parser = ["raycast", "hemicube", "gpu"])]
    pub form_factors: Option<String>,
    /// The light counts as found when this share of what is emitted has not been shot yet
    #[arg(long, value_name = "T", allow_negative_numbers = true, value_parser = parse::tolerance)]
    pub tolerance: Option<f64>,
}

impl LiveArgs {
    /// Patches and elements in place of a preset's, if any were asked for.
    #[cfg(feature = "viewer")]
    pub fn mesh(&self) -> Option<hemicube::radiosity::PatchOptions> {
        let mesh = MeshArgs {
            quality: self.quality,
            element_size: self.element_size,
            elements: self.elements,
            patch_size: self.patch_size,
            patches: self.patches,
            ..MeshArgs::default()
        };
        let is_asked = !mesh.mesh_given().is_empty();
        is_asked.then(|| mesh.options().mesh)
    }
}

impl MeshArgs {
    /// Options for a scene that is solved afresh.
    pub fn options(&self) -> SolveOptions {
        let mut options = SolveOptions::from(self.quality.unwrap_or_default());
        let mesh = &mut options.mesh;
        let preset = mesh.elements.take().unwrap_or(0);
        if self.patch_size.is_some() {
            mesh.patches = None;
        } else if let Some(count) = self.patches {
            mesh.patches = Some(count as usize);
        }
        mesh.patch_size = self.patch_size;
        mesh.element_size = self.element_size;
        mesh.clean.enabled = !self.no_clean;
        mesh.clean.weld = self.weld;
        mesh.clean.turn_to_light = self.turn_to_light;
        // Elements are at least as fine as patches: finer patches than the preset's bring their own elements, a third
        // of their size.
        let keeps_preset = match (self.patch_size, self.patches) {
            (Some(_), _) => false,
            (None, Some(count)) => count as usize * 9 <= preset,
            (None, None) => true,
        };
        mesh.elements = match self.elements {
            Some(count) => Some(count as usize),
            None => (self.element_size.is_none() && keeps_preset).then_some(preset),
        };
        mesh.joints = !self.no_joints;
        mesh.discontinuities = self.discontinuities;
        self.override_factors(&mut options);
        options
    }

    fn override_factors(&self, options: &mut SolveOptions) {
        options.form_factors = self
            .form_factors
            .map_or(options.form_factors, FactorWay::kind);
        if let Some(resolution) = self.hemicube_resolution {
            options.hemicube.resolution = resolution;
        }
        options.rays = self.rays.unwrap_or(options.rays);
        options.shot_rays = self.shot_rays.or(options.shot_rays);
        options.seed = self.seed.unwrap_or(options.seed);
    }

    /// Whether the form factors come from a GPU; `before` is the way of the solution that is gone on with.
    pub fn uses_gpu(&self, before: Option<&Provenance>) -> bool {
        let before = before.and_then(|before| FactorWay::of_solution(&before.form_factors));
        self.form_factors
            .or(before)
            .is_some_and(FactorWay::uses_gpu)
    }

    /// The option that was given for another way to form factors than the one in use. Light of sky and sun takes rays
    /// whatever the way, so `--rays` has a use where there is such light.
    pub fn misplaced(&self, kind: FormFactorKind, scene: &Scene) -> Option<String> {
        let has_first_light = scene.sky.max_band() > 0.0 || !scene.lights.is_empty();
        self.misplaced_among(kind, self.rays.is_some() && !has_first_light)
    }

    /// As [`Self::misplaced`] where first light has fallen already.
    pub fn misplaced_in_steps(&self, kind: FormFactorKind) -> Option<String> {
        self.misplaced_among(kind, self.rays.is_some())
    }

    fn misplaced_among(&self, kind: FormFactorKind, rays: bool) -> Option<String> {
        let given = MethodGiven {
            kind,
            name: self.form_factors.map_or(kind.name(), FactorWay::name),
            error: false,
            rays,
            shot_rays: self.shot_rays.is_some(),
            resolution: self.hemicube_resolution.is_some(),
        };
        given.misplaced("--form-factors")
    }

    /// Whether neither patches nor their size were given.
    fn has_preset_patches(&self) -> bool {
        self.patch_size.is_none() && self.patches.is_none()
    }

    /// Names of the mesh's options that were given.
    pub fn mesh_given(&self) -> Vec<&'static str> {
        names([
            (self.element_size.is_some(), "--element-size"),
            (self.elements.is_some(), "--elements"),
            (self.patch_size.is_some(), "--patch-size"),
            (self.patches.is_some(), "--patches"),
            (self.weld.is_some(), "--weld"),
            (self.turn_to_light, "--turn-to-light"),
            (self.no_clean, "--no-clean"),
            (self.discontinuities, "--discontinuities"),
            (self.no_joints, "--no-joints"),
        ])
    }

    /// Names of the options that were given, but for the seed, which is also used for gathering.
    fn given(&self) -> Vec<&'static str> {
        let mut all = self.mesh_given();
        all.extend(names([
            (self.quality.is_some(), "--quality"),
            (self.form_factors.is_some(), "--form-factors"),
            (self.gpu.adapter.is_some(), "--adapter"),
            (self.gpu.require_gpu, "--require-gpu"),
            (self.hemicube_resolution.is_some(), "--hemicube-resolution"),
            (self.rays.is_some(), "--rays"),
            (self.shot_rays.is_some(), "--shot-rays"),
        ]));
        all
    }
}

impl SolveArgs {
    /// The same without the options of GPUs, if only a picture is to follow them.
    pub fn without_gpu_of_picture(&self, uses_gpu: bool) -> Self {
        let mut solve = self.clone();
        if uses_gpu && !solve.mesh.form_factors.is_some_and(FactorWay::uses_gpu) {
            solve.mesh.gpu = GpuArgs::default();
        }
        solve
    }

    /// Options for a scene that is solved afresh.
    pub fn options(&self, scene: &Scene) -> SolveOptions {
        let mut options = self.mesh.options();
        let elements = options.mesh.elements.unwrap_or(0);
        options.solver = SolverKind::for_size(scene.face_count(), elements);
        self.override_work(&mut options);
        if options.solver == SolverKind::Stochastic && self.mesh.has_preset_patches() {
            options.mesh.patches = options.mesh.patches.max(Some(patches_for_rays(elements)));
        }
        options
    }

    /// Whether the solver is left to the program.
    pub fn is_auto(&self) -> bool {
        matches!(self.solver, None | Some(SolverChoice::Auto))
    }

    /// Options for going on with a solution: what is not given is as before.
    pub fn options_to_resume(&self, before: &Provenance) -> SolveOptions {
        let mut options = SolveOptions::from(self.mesh.quality.unwrap_or_default());
        if self.mesh.quality.is_none() && before.rays_per_hemisphere > 0 {
            options.rays = before.rays_per_hemisphere;
        }
        options.shot_rays = before.shot_rays;
        options.seed = before.seed;
        if before.hemicube_resolution > 0 {
            options.hemicube.resolution = before.hemicube_resolution;
        }
        let known = FactorWay::of_solution(&before.form_factors);
        options.form_factors = known.map_or(FormFactorKind::default(), FactorWay::kind);
        let mut solvers = SolverKind::ALL.into_iter();
        let known = solvers.find(|kind| kind.name() == before.solver);
        options.solver = known.unwrap_or_default();
        self.mesh.override_factors(&mut options);
        self.override_work(&mut options);
        options
    }

    fn override_work(&self, options: &mut SolveOptions) {
        options.tolerance = self.tolerance.unwrap_or(options.tolerance);
        if let Some(SolverChoice::Kind(solver)) = self.solver {
            options.solver = solver;
        }
        options.noise = self.noise.unwrap_or(options.noise);
        options.max_steps = self.iterations;
        options.adaptive = self.adaptive_options();
        options.total_memory = free_memory().map(share);
        if let Some(mib) = self.matrix_memory {
            options.memory_limit = mib as usize * (1 << 20);
        } else if let Some(free) = free_memory() {
            options.memory_limit = options.memory_limit.min(share(free));
        }
    }

    /// When elements are cut, if they are.
    fn adaptive_options(&self) -> Option<AdaptiveOptions> {
        let defaults = AdaptiveOptions::default();
        self.adaptive.map(|contrast| AdaptiveOptions {
            contrast,
            smallest: self.smallest,
            most_elements: self
                .most_elements
                .map_or(defaults.most_elements, |most| most as usize),
        })
    }

    /// Names of the options that were given and that a finished solution does not follow any more; the seed goes on
    /// to be used for gathering.
    pub fn given(&self) -> Vec<&'static str> {
        let mut all = self.mesh.given();
        all.extend(names([
            (self.matrix_memory.is_some(), "--matrix-memory"),
            (self.solver.is_some(), "--solver"),
            (self.tolerance.is_some(), "--tolerance"),
            (self.noise.is_some(), "--noise"),
            (self.iterations.is_some(), "--iterations"),
            (self.time.is_some(), "--time"),
            (self.adaptive.is_some(), "--adaptive"),
        ]));
        all
    }
}

/// Patches that count interreflected light where rays carry it: some twenty elements each, as many as a billion rays
/// bring within a few percent.
fn patches_for_rays(elements: usize) -> usize {
    const MOST: usize = 50_000;
    (elements / 20).min(MOST)
}

/// What of the free memory may be taken.
fn share(free: u64) -> usize {
    usize::try_from(free / 10 * SHARE_OF_MEMORY).unwrap_or(usize::MAX)
}

fn names<const N: usize>(all: [(bool, &'static str); N]) -> Vec<&'static str> {
    all.into_iter()
        .filter_map(|(given, name)| given.then_some(name))
        .collect()
}
