//! A whole solution in one call: scene in, light out.

use crate::error::RadiosityError;
use crate::form_factor::{Cached, FormFactors, RayCast, RayCastOptions};
use crate::patch::{PatchMesh, PatchOptions};
use crate::primary::primary_irradiance;
use crate::solution::{Grouping, Provenance, Solution};
use crate::solve::{Order, Progress, Shooting, run};
use hemicube_scene::Scene;
use std::sync::Arc;
use std::time::Instant;

/// Memory that rows of form factors may take, so that a patch that shoots again needs no new rays.
const ROW_BUDGET: usize = 256 << 20;

/// Everything a solution is made with.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SolveOptions {
    /// How fine the mesh is. Default value: about 4000 elements and 400 patches.
    pub mesh: PatchOptions,
    /// Rays over each hemisphere. Default value: 256.
    pub rays: u32,
    /// Seed of all sampling. Default value: 0.
    pub seed: u64,
    /// Unshot share of the emitted flux at which the solution is finished. Default value: 5e-4.
    pub tolerance: f64,
    /// Most shots. Default value: none.
    pub max_steps: Option<u64>,
    /// Way to the equilibrium. Default value: sorted shooting with the ambient term for display.
    pub solver: SolverKind,
    /// Which emitters share a channel. Default value: all.
    pub grouping: Grouping,
}

/// Ways to the equilibrium, by their names on the command line.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum SolverKind {
    /// Patches shoot in the order of the mesh.
    Shooting,
    /// The patch with most unshot flux shoots.
    SortedShooting,
    /// As sorted shooting; pictures of unfinished solutions add the ambient estimate.
    #[default]
    AmbientShooting,
}

impl SolverKind {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Shooting, Self::SortedShooting, Self::AmbientShooting];

    /// Name on the command line and in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Shooting => "shooting",
            Self::SortedShooting => "sorted-shooting",
            Self::AmbientShooting => "ambient-shooting",
        }
    }

    fn order(self) -> Order {
        if self == Self::Shooting {
            Order::Cyclic
        } else {
            Order::Sorted
        }
    }
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
        let (elements, patches, rays, tolerance) = match quality {
            Quality::Draft => (1000, 150, 128, 5e-3),
            Quality::Normal => (4000, 400, 256, 5e-4),
            Quality::Final => (30_000, 1600, 512, 2e-4),
        };
        Self {
            mesh: PatchOptions::default()
                .with_elements(elements)
                .with_patches(patches),
            rays,
            seed: 0,
            tolerance,
            max_steps: None,
            solver: SolverKind::default(),
            grouping: Grouping::Together,
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
        if self.rays == 0 || self.rays > 1 << 20 {
            return fail(format!(
                "rays {} is not between 1 and {}",
                self.rays,
                1 << 20
            ));
        }
        Ok(())
    }
}

/// Solves a scene. `go_on` is asked before every step and may end the work early; the light so far is returned.
///
/// # Errors
/// A scene that cannot be used or gives no light, an option out of its range, a scene whose light would never die.
pub fn solve(
    scene: Arc<Scene>,
    options: &SolveOptions,
    go_on: impl FnMut(&Progress, &Solution) -> bool,
) -> Result<Solution, RadiosityError> {
    let start = Instant::now();
    options.check()?;
    scene.check()?;
    if !scene.has_light() {
        return Err(RadiosityError::NoLight(scene.name.clone()));
    }
    let mesh = Arc::new(PatchMesh::build(scene, options.mesh)?);
    refuse_endless_light(&mesh)?;
    let primary = primary_irradiance(&mesh, options.rays, options.seed);
    refuse_too_many_channels(&mesh, options.grouping)?;
    let mut solution = Solution::new(mesh, &primary, options.grouping);
    solution.provenance.seconds = start.elapsed().as_secs_f64();
    resume(solution, options, go_on)
}

/// Goes on with a solution. The mesh is the solution's; of the options those of the work apply.
///
/// # Errors
/// An option out of its range.
pub fn resume(
    mut solution: Solution,
    options: &SolveOptions,
    mut go_on: impl FnMut(&Progress, &Solution) -> bool,
) -> Result<Solution, RadiosityError> {
    let start = Instant::now();
    options.check()?;
    let before = solution.provenance.clone();
    solution.provenance.solver = options.solver.name().into();
    let ray_options = RayCastOptions {
        rays: options.rays,
        seed: options.seed,
        ..RayCastOptions::default()
    };
    let factors = Cached::new(
        RayCast::new(solution.mesh().clone(), ray_options),
        ROW_BUDGET,
    );
    let mut solver = Shooting::new(&factors, solution, options.solver.order());
    let most = options
        .max_steps
        .map(|steps| before.steps.saturating_add(steps));
    run(&mut solver, options.tolerance, |progress, solution| {
        most.is_none_or(|most| progress.iteration < most) && go_on(progress, solution)
    });
    let mut solution = crate::solve::Solver::into_solution(solver);
    solution.provenance = Provenance {
        form_factors: String::from("raycast"),
        rays_per_hemisphere: options.rays,
        seed: options.seed,
        rays: before.rays + factors.rays(),
        seconds: before.seconds + start.elapsed().as_secs_f64(),
        ..solution.provenance
    };
    Ok(solution)
}

/// Refuses more values than memory holds: each group takes nine numbers an element.
fn refuse_too_many_channels(mesh: &PatchMesh, grouping: Grouping) -> Result<(), RadiosityError> {
    const MOST: usize = 200_000_000;
    let emitting = mesh.scene().materials.iter().filter(|m| m.emits()).count();
    let groups = if grouping == Grouping::ByMaterial {
        emitting + 1
    } else {
        1
    };
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
