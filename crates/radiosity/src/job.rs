//! A whole solution in one call: scene in, light out.

use crate::adaptive::{AdaptiveOptions, converge_and_refine};
use crate::backend::{Backend, Cpu, Shooter};
use crate::error::RadiosityError;
use crate::form_factor::hemicube::HemicubeOptions;
use crate::form_factor::matrix::MatrixPlan;
use crate::form_factor::{
    AnalyticOptions, Cached, FormFactorKind, FormFactorOptions, FormFactors, MatrixOptions,
    NusseltOptions, RayCastOptions,
};
use crate::memory;
use crate::patch::{PatchMesh, PatchOptions};
use crate::primary::primary_irradiance_until;
use crate::solution::{BANDS, Grouping, Provenance, Solution};
use crate::solve::{
    Hierarchical, HierarchicalOptions, MatrixSolverKind, NotStarted, OnMatrix, Order, Progress,
    Shooting, Solver, Stochastic, StochasticOptions, run,
};
use crate::stop::{NEVER, Stop};
use hemicube_scene::Scene;
use std::sync::Arc;
use std::time::Instant;

/// Memory that rows of form factors may take, so that a patch that shoots again needs no new rays.
pub(crate) const ROW_BUDGET: usize = 256 << 20;

/// Everything a solution is made with.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SolveOptions {
    /// How fine the mesh is. Default value: about 4000 elements and 400 patches.
    pub mesh: PatchOptions,
    /// Way to the form factors. Default value: rays.
    pub form_factors: FormFactorKind,
    /// Hemicubes, where they are the way.
    pub hemicube: HemicubeOptions,
    /// Wanted error of [`FormFactorKind::Analytic`]. Default value: 1e-4.
    pub analytic: AnalyticOptions,
    /// Rays over each hemisphere. Default value: 256.
    pub rays: u32,
    /// Rays of every shot ([`RayCastOptions::shot_rays`]). Default value: none, by [`Self::rays`].
    pub shot_rays: Option<u32>,
    /// Seed of all sampling. Default value: 0.
    pub seed: u64,
    /// Unshot share of the emitted flux at which the solution is finished. Default value: 5e-4.
    pub tolerance: f64,
    /// Relative error of the irradiance at which [`SolverKind::Stochastic`] and [`SolverKind::Hierarchical`] are finished,
    /// by their estimates. Default value: 0.03.
    pub noise: f64,
    /// Most steps: shots, or steps of a matrix method ([`OnMatrix`]). Default value: none.
    pub max_steps: Option<u64>,
    /// Way to the equilibrium. Default value: sorted shooting with the ambient term for display.
    pub solver: SolverKind,
    /// Which emitters share a channel. Default value: all.
    pub grouping: Grouping,
    /// Most bytes that solvers on a matrix may take for it and what they make of it, or links may take. Default value: 2 GiB.
    pub memory_limit: usize,
    /// Most bytes that all of the work may take, by an [estimate](crate::memory); finer meshes are refused before they are
    /// built. Default value: none.
    pub total_memory: Option<usize>,
    /// Elements are cut where light varies over them. Default value: none, the mesh stays as it is.
    pub adaptive: Option<AdaptiveOptions>,
}

/// Ways to the equilibrium, by their names on the command line.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum SolverKind {
    /// Elimination on the matrix of all form factors.
    Gauss,
    /// All patches gather at once, on the matrix.
    Jacobi,
    /// All patches gather one after the other, on the matrix.
    GaussSeidel,
    /// The patch with the largest residual flux is relaxed, on the matrix.
    Southwell,
    /// One patch gathers, on the matrix.
    Gathering,
    /// Patches shoot in the order of the mesh.
    Shooting,
    /// The patch with most unshot flux shoots.
    SortedShooting,
    /// As sorted shooting; pictures of unfinished solutions add the ambient estimate.
    #[default]
    AmbientShooting,
    /// As sorted shooting, but what a patch is expected to get back is counted in and shot ahead.
    Overshooting,
    /// Conjugate gradients on the matrix.
    ConjugateGradient,
    /// Light is carried by rays; the cost does not grow with the square of the scene.
    Stochastic,
    /// Links between clusters, faces and parts of faces, refined where they carry error.
    Hierarchical,
}

impl SolverKind {
    /// All of them.
    pub const ALL: [Self; 12] = [
        Self::Gauss,
        Self::Jacobi,
        Self::GaussSeidel,
        Self::Southwell,
        Self::Gathering,
        Self::Shooting,
        Self::SortedShooting,
        Self::AmbientShooting,
        Self::Overshooting,
        Self::ConjugateGradient,
        Self::Stochastic,
        Self::Hierarchical,
    ];

    /// Name on the command line and in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Gauss => "gauss",
            Self::Jacobi => "jacobi",
            Self::GaussSeidel => "gauss-seidel",
            Self::Southwell => "southwell",
            Self::Gathering => "gathering",
            Self::Shooting => "shooting",
            Self::SortedShooting => "sorted-shooting",
            Self::AmbientShooting => "ambient-shooting",
            Self::Overshooting => "overshooting",
            Self::ConjugateGradient => "conjugate-gradient",
            Self::Stochastic => "stochastic",
            Self::Hierarchical => "hierarchical",
        }
    }

    /// The best for a scene of so many faces, to be cut into about so many elements ([`PatchOptions`]): sorted shooting as
    /// long as its shots are few, rays beyond.
    pub fn for_size(faces: usize, elements: usize) -> Self {
        /// Up to here shooting takes no more than half a minute on two cores (office 24 s, cornell 9 s), and its light is
        /// smooth. Rays to 3 % take a third of that here, and are faster in smaller scenes, too.
        const MANY: usize = 40_000;
        let least = faces.saturating_add(elements.min(faces / 3));
        if least.max(elements) > MANY {
            Self::Stochastic
        } else {
            Self::AmbientShooting
        }
    }

    /// What does the work.
    pub fn way(self) -> Way {
        match self {
            Self::Gauss => Way::OnMatrix(MatrixSolverKind::Gauss),
            Self::Jacobi => Way::OnMatrix(MatrixSolverKind::Jacobi),
            Self::GaussSeidel => Way::OnMatrix(MatrixSolverKind::GaussSeidel),
            Self::Southwell => Way::OnMatrix(MatrixSolverKind::Southwell),
            Self::Gathering => Way::OnMatrix(MatrixSolverKind::Gathering),
            Self::ConjugateGradient => Way::OnMatrix(MatrixSolverKind::ConjugateGradient),
            Self::Shooting => Way::Shooting(Order::Cyclic),
            Self::SortedShooting | Self::AmbientShooting => Way::Shooting(Order::Sorted),
            Self::Overshooting => Way::Shooting(Order::Overshooting),
            Self::Stochastic => Way::Stochastic,
            Self::Hierarchical => Way::Hierarchical,
        }
    }
}

/// What a way to the equilibrium needs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Way {
    /// Rows on demand.
    Shooting(Order),
    /// All form factors between patches: `4 n²` bytes or more.
    OnMatrix(MatrixSolverKind),
    /// Rays alone.
    Stochastic,
    /// Links, some tens for each element.
    Hierarchical,
}

/// Presets for people who want no other knob.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Quality {
    /// A first look: about 1000 elements.
    Draft,
    /// About 4000 elements.
    #[default]
    Normal,
    /// About 30,000 elements.
    Final,
}

impl Quality {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Draft, Self::Normal, Self::Final];

    /// Name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Draft => "draft",
            Self::Normal => "normal",
            Self::Final => "final",
        }
    }
}

impl From<Quality> for SolveOptions {
    fn from(quality: Quality) -> Self {
        let (elements, patches, rays, tolerance, noise) = match quality {
            Quality::Draft => (1000, 150, 128, 5e-3, 0.1),
            Quality::Normal => (4000, 400, 256, 5e-4, 0.03),
            Quality::Final => (30_000, 1600, 512, 2e-4, 0.01),
        };
        Self {
            mesh: PatchOptions::default()
                .with_elements(elements)
                .with_patches(patches),
            form_factors: FormFactorKind::default(),
            hemicube: HemicubeOptions::default(),
            analytic: AnalyticOptions::default().with_error(1e-4),
            rays,
            shot_rays: None,
            seed: 0,
            tolerance,
            noise,
            max_steps: None,
            solver: SolverKind::default(),
            grouping: Grouping::Together,
            memory_limit: MatrixOptions::default().memory_limit,
            total_memory: None,
            adaptive: None,
        }
    }
}

impl Default for SolveOptions {
    fn default() -> Self {
        Quality::Normal.into()
    }
}

impl SolveOptions {
    fn check(&self) -> Result<(), RadiosityError> {
        let fail = |message: String| Err(RadiosityError::Option(message));
        if !(self.tolerance >= 0.0 && self.tolerance < 1.0) {
            return fail(format!("tolerance {} is not in [0, 1)", self.tolerance));
        }
        if !(self.noise > 0.0 && self.noise < 10.0) {
            return fail(format!("noise {} is not in (0, 10)", self.noise));
        }
        if self.rays == 0 || self.rays > 1 << 20 {
            return fail(format!(
                "rays {} is not between 1 and {}",
                self.rays,
                1 << 20
            ));
        }
        if self
            .shot_rays
            .is_some_and(|rays| rays == 0 || rays > 1 << 20)
        {
            let rays = self.shot_rays.unwrap_or(0);
            return fail(format!(
                "rays of a shot {rays} are not between 1 and {}",
                1 << 20
            ));
        }
        self.adaptive.map_or(Ok(()), |adaptive| adaptive.check())
    }

    /// Refuses a solver whose matrix would not fit: known before any light falls.
    ///
    /// # Errors
    /// What it would take, what is allowed, how many patches fit.
    pub fn refuse_large_matrix(&self, mesh: &Arc<PatchMesh>) -> Result<(), RadiosityError> {
        let Way::OnMatrix(kind) = self.solver.way() else {
            return Ok(());
        };
        let n = mesh.patches().len();
        let channels = groups_of(mesh, self.grouping) * BANDS;
        let dense = n.saturating_mul(n).saturating_mul(4 * BANDS);
        if kind
            .refuse_memory(n, dense, channels, self.memory_limit)
            .is_ok()
        {
            // Even if all entries are kept, for each band.
            return Ok(());
        }
        let factors = self
            .form_factors
            .build(mesh.clone(), &self.form_factor_options())?;
        let plan = MatrixPlan::new(&*factors, self.matrix_options())
            .map_err(|error| kind.refusal(error, n, channels, self.memory_limit))?;
        kind.refuse_memory(n, plan.bytes(), channels, self.memory_limit)
    }

    fn matrix_options(&self) -> MatrixOptions {
        MatrixOptions {
            memory_limit: self.memory_limit,
            ..MatrixOptions::default()
        }
    }

    /// What [`SolverKind::Stochastic`] is told.
    pub fn stochastic_options(&self) -> StochasticOptions {
        StochasticOptions {
            rays: self.rays,
            noise: self.noise,
            tolerance: self.tolerance,
            seed: self.seed,
            ..StochasticOptions::default()
        }
    }

    /// What [`SolverKind::Hierarchical`] is told.
    pub fn hierarchical_options(&self) -> HierarchicalOptions {
        HierarchicalOptions {
            error: self.noise,
            tolerance: self.tolerance,
            seed: self.seed,
            memory_limit: self.memory_limit,
            ..HierarchicalOptions::default()
        }
    }

    /// What the ways to form factors are told.
    pub fn form_factor_options(&self) -> FormFactorOptions {
        FormFactorOptions {
            raycast: RayCastOptions {
                rays: self.rays,
                shot_rays: self.shot_rays,
                seed: self.seed,
                ..RayCastOptions::default()
            },
            analytic: AnalyticOptions {
                seed: self.seed,
                ..self.analytic
            },
            hemicube: self.hemicube,
            nusselt: NusseltOptions::default().with_rays(self.rays),
            ..FormFactorOptions::default()
        }
    }
}

/// Solves a scene. `go_on` is asked before every step and may end the work early; the light so far is returned. It is
/// also told the last state.
///
/// # Errors
/// A scene that cannot be used or gives no light, an option out of its range, a scene whose light would never die.
pub fn solve(
    scene: Arc<Scene>,
    options: &SolveOptions,
    go_on: impl FnMut(&Progress, &Solution) -> bool,
) -> Result<Solution, RadiosityError> {
    solve_until(scene, options, NEVER, go_on)
}

/// As [`solve`]; `stop` is also asked while the mesh is built, first light falls and matrices are computed.
///
/// # Errors
/// As [`solve`], or [`RadiosityError::Stopped`] before there is a solution.
pub fn solve_until(
    scene: Arc<Scene>,
    options: &SolveOptions,
    stop: Stop<'_>,
    go_on: impl FnMut(&Progress, &Solution) -> bool,
) -> Result<Solution, RadiosityError> {
    solve_on(scene, options, &Cpu, stop, go_on)
}

/// As [`solve_until`], with form factors and perhaps the solver from elsewhere.
///
/// # Errors
/// As [`solve_until`], and what the backend cannot do.
pub fn solve_on(
    scene: Arc<Scene>,
    options: &SolveOptions,
    backend: &dyn Backend,
    stop: Stop<'_>,
    go_on: impl FnMut(&Progress, &Solution) -> bool,
) -> Result<Solution, RadiosityError> {
    let solution = unlit(scene, options, stop)?;
    resume_on(solution, options, backend, stop, go_on)
}

/// Light before the first step: the mesh, its emitters, and what lights and sky bring directly.
///
/// # Errors
/// As [`solve_until`].
pub fn unlit(
    scene: Arc<Scene>,
    options: &SolveOptions,
    stop: Stop<'_>,
) -> Result<Solution, RadiosityError> {
    let start = Instant::now();
    options.check()?;
    scene.check()?;
    if !scene.has_light() {
        return Err(RadiosityError::NoLight(scene.name.clone()));
    }
    let most = memory::most_elements(&scene, options);
    let mesh = PatchMesh::build_within(scene.clone(), options.mesh, most, stop)
        .map_err(|error| memory::explained(error, &scene, options))?;
    let mesh = Arc::new(mesh);
    refuse_endless_light(&mesh)?;
    refuse_too_many_channels(&mesh, options.grouping)?;
    options.refuse_large_matrix(&mesh)?;
    let primary = primary_irradiance_until(&mesh, options.rays, options.seed, stop)?;
    let mut solution = Solution::new(mesh, &primary, options.grouping);
    solution.provenance.seconds = start.elapsed().as_secs_f64();
    Ok(solution)
}

/// Goes on with a solution, whatever made it. The mesh is the solution's; of the options those of the work apply.
///
/// # Errors
/// An option out of its range, a matrix that takes more memory than allowed.
pub fn resume(
    solution: Solution,
    options: &SolveOptions,
    go_on: impl FnMut(&Progress, &Solution) -> bool,
) -> Result<Solution, RadiosityError> {
    resume_until(solution, options, NEVER, go_on)
}

/// As [`resume`]; `stop` is also asked while matrices are computed. What has been reached is returned.
///
/// # Errors
/// As [`resume`].
pub fn resume_until(
    solution: Solution,
    options: &SolveOptions,
    stop: Stop<'_>,
    go_on: impl FnMut(&Progress, &Solution) -> bool,
) -> Result<Solution, RadiosityError> {
    resume_on(solution, options, &Cpu, stop, go_on)
}

/// As [`resume_until`], with form factors and perhaps the solver from elsewhere.
///
/// # Errors
/// As [`resume`], and what the backend cannot do.
pub fn resume_on(
    solution: Solution,
    options: &SolveOptions,
    backend: &dyn Backend,
    stop: Stop<'_>,
    mut go_on: impl FnMut(&Progress, &Solution) -> bool,
) -> Result<Solution, RadiosityError> {
    options.check()?;
    match &options.adaptive {
        None => converge(solution, options, backend, stop, go_on),
        Some(adaptive) => {
            converge_and_refine(solution, options, adaptive, backend, stop, &mut go_on)
        }
    }
}

/// Goes on with a solution to its end, on its mesh.
pub(crate) fn converge(
    mut solution: Solution,
    options: &SolveOptions,
    backend: &dyn Backend,
    stop: Stop<'_>,
    mut go_on: impl FnMut(&Progress, &Solution) -> bool,
) -> Result<Solution, RadiosityError> {
    let start = Instant::now();
    let before = solution.provenance.clone();
    solution.provenance.solver = options.solver.name().into();
    let most = options
        .max_steps
        .map(|steps| before.steps.saturating_add(steps));
    let mut name = backend.name(options);
    let mut noise = None;
    let mut stages = before.stages;
    let mut go_on = |progress: &Progress, solution: &Solution| {
        // It is told every state, also one at which a limit ends the work.
        go_on(progress, solution)
            && most.is_none_or(|most| progress.iteration < most)
            && !stop()
            && backend.verdict().is_ok()
    };
    let (mut solution, rays) = match options.solver.way() {
        Way::Shooting(order) => match backend.shooting(solution, options, order)? {
            Shooter::Own(mut solver) => {
                run(&mut *solver, options.tolerance, &mut go_on);
                solver.settle();
                let solution = solver.solution().clone();
                let is_finished =
                    !solver.is_exhausted() || solver.progress().unshot <= options.tolerance;
                if is_finished {
                    (solution, 0)
                } else {
                    // The device is gone; the light that it brought here is not.
                    backend.verdict()?;
                    name += ", then hemicube";
                    let hemicubes = FormFactorKind::Hemicube;
                    let factors =
                        hemicubes.build(solution.mesh().clone(), &options.form_factor_options())?;
                    let solver = Shooting::new(&factors, solution, order);
                    (finished(solver, options.tolerance, &mut go_on), 0)
                }
            }
            Shooter::None(solution) => {
                let factors = backend.form_factors(solution.mesh().clone(), options)?;
                let factors = Cached::new(factors, ROW_BUDGET);
                let solver = Shooting::new(&factors, *solution, order);
                (finished(solver, options.tolerance, go_on), factors.rays())
            }
        },
        Way::Stochastic => {
            name = String::from("rays");
            let mut solver = Stochastic::new(solution, options.stochastic_options())?;
            run(&mut solver, options.tolerance, go_on);
            let rays = solver.rays();
            noise = solver.known_noise();
            stages = Some(stages.unwrap_or_default() + solver.stages());
            (solver.into_solution(), rays)
        }
        Way::Hierarchical => {
            name = String::from("links");
            let mut solver = Hierarchical::new(solution, options.hierarchical_options())?;
            run(&mut solver, options.tolerance, go_on);
            backend.finished(&solver);
            let rays = solver.rays();
            noise = solver.known_error();
            (solver.into_solution(), rays)
        }
        Way::OnMatrix(kind) => {
            let factors = backend.form_factors(solution.mesh().clone(), options)?;
            // Rows are asked for again at the end of each sweep.
            let factors = Cached::new(factors, ROW_BUDGET.max(options.memory_limit / 4));
            let matrix = MatrixOptions {
                memory_limit: options.memory_limit,
                ..MatrixOptions::default()
            };
            let solution = match OnMatrix::new_until(&factors, solution, kind, matrix, stop) {
                Ok(solver) => finished(solver, options.tolerance, go_on),
                Err(NotStarted::Stopped(solution)) => *solution,
                Err(NotStarted::Failed(error)) => return Err(error),
            };
            (solution, factors.rays())
        }
    };
    backend.verdict()?;
    solution.provenance = Provenance {
        form_factors: name,
        rays_per_hemisphere: options.rays,
        shot_rays: options.shot_rays,
        hemicube_resolution: options.hemicube.resolution,
        seed: options.seed,
        rays: before.rays + rays,
        seconds: before.seconds + start.elapsed().as_secs_f64(),
        noise,
        stages,
        ..solution.provenance
    };
    Ok(solution)
}

/// Steps to the end and takes the light out.
fn finished(
    mut solver: impl Solver,
    tolerance: f64,
    go_on: impl FnMut(&Progress, &Solution) -> bool,
) -> Solution {
    run(&mut solver, tolerance, go_on);
    solver.into_solution()
}

/// Refuses more values than memory holds: each group takes nine numbers an element.
fn refuse_too_many_channels(mesh: &PatchMesh, grouping: Grouping) -> Result<(), RadiosityError> {
    const MOST: usize = 200_000_000;
    let groups = groups_of(mesh, grouping);
    let values = groups.saturating_mul(mesh.elements().len());
    if values > MOST {
        let elements = mesh.elements().len();
        let message = format!(
            "{groups} light groups on {elements} elements are {values} values, at most {MOST} are kept; use fewer elements"
        );
        return Err(RadiosityError::Option(message));
    }
    Ok(())
}

/// Light groups that a solution has, or more.
fn groups_of(mesh: &PatchMesh, grouping: Grouping) -> usize {
    groups_in(mesh.scene(), grouping)
}

/// As [`groups_of`], before there is a mesh.
pub(crate) fn groups_in(scene: &Scene, grouping: Grouping) -> usize {
    match grouping {
        Grouping::Together => 1,
        Grouping::ByMaterial => {
            let emitting = scene.materials.iter().filter(|m| m.emits());
            emitting.count() + 1
        }
    }
}

/// Refuses scenes in which nothing absorbs and nothing escapes.
fn refuse_endless_light(mesh: &PatchMesh) -> Result<(), RadiosityError> {
    let (mut area, mut kept) = (0.0, 0.0);
    for (e, reflectance) in mesh.reflectance().iter().enumerate() {
        let a = f64::from(mesh.exposed_area(e));
        area += a;
        kept += a * f64::from(reflectance.max_band());
    }
    let mean = if area > 0.0 { kept / area } else { 0.0 };
    if mean > 0.9999 && mesh.is_closed() {
        let message = format!(
            "scene '{}': a closed scene whose surfaces reflect {mean:.4} of all light never settles; lower --max-reflectance",
            mesh.scene().name
        );
        return Err(RadiosityError::Divergent(message));
    }
    Ok(())
}
