//! Adaptive subdivision a posteriori: where light varies, elements are cut (Cohen, Greenberg, Immel, Brock 1986).
//!
//! A scene is solved, elements over which light [varies too much](contrasts) are cut into four, their neighbours until
//! levels differ by at most one, and light is computed on the new elements; and so on until no element has so much
//! contrast, or all that have are as small as allowed or add too little to the error of pictures ([`ERROR_SHARE`]). Patches stay as they are, so shooting costs no more than before.
//!
//! | solver | light on the new elements |
//! |---|---|
//! | shooting, matrices, by rays | new elements receive from the patches that matter to them what those have shot, others keep their light; after the last round sorted shooting spreads what that changes |
//! | shooting, matrices, else | each patch shoots once what it has shot before, by its row to all elements; sorted shooting spreads what that changes |
//! | rays, links | the scene is solved again on the new mesh: their light is not of patches |

mod contrast;
mod order;
mod receive;
mod transfer;

use crate::cast::to_f32;
pub use contrast::{FLOOR, contrasts};
pub use order::ERROR_SHARE;

use self::order::{allowed_error, error_estimates, to_cut, worth_a_cut};
use self::transfer::{received_by_new, transferred};
use crate::backend::Backend;
use crate::error::RadiosityError;
use crate::form_factor::raycast::Strategy;
use crate::form_factor::{Cached, FormFactorKind, FormFactors, RayCast, RayCastOptions};
use crate::job::{ROW_BUDGET, SolveOptions, Way, converge};
use crate::patch::{MAX_ELEMENTS, PatchMesh, RefinementPlan};
use crate::primary::primary_irradiance_until;
use crate::solution::Solution;
use crate::solve::{Order, Progress, Shooting, Solver, run};
use crate::stop::Stop;
use hemicube_raster::Rgb;
use std::sync::Arc;
use std::time::Instant;

/// Share of the longest edge of the mesh's first elements that edges of refined ones do not go below.
const SMALLEST: f32 = 1.0 / 16.0;

/// Rounds beyond those that a single element takes to its smallest parts: light on new elements shows new contrasts.
const MORE_ROUNDS: u32 = 1;

/// Standard errors of noisy light within which differences are not told from noise.
const ERRORS: f64 = 3.0;

/// When elements are cut.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AdaptiveOptions {
    /// Largest contrast of light over an element ([`contrasts`]), between 0 and 1. Of light that is known up to noise, at
    /// least three standard errors count. Elements of which the error of pictures is small all together ([`ERROR_SHARE`]) stay
    /// whole whatever their contrast. Default value: 0.1.
    pub contrast: f32,
    /// Edges of at most this length are not cut. Default value: a sixteenth of the longest edge of the mesh's first
    /// elements.
    pub smallest: Option<f32>,
    /// Most elements of a refined mesh; where it would have more, those among them are cut that are shown with the largest
    /// error, by second differences of their light. Default value: [`MAX_ELEMENTS`].
    pub most_elements: usize,
}

impl Default for AdaptiveOptions {
    fn default() -> Self {
        Self {
            contrast: 0.1,
            smallest: None,
            most_elements: MAX_ELEMENTS,
        }
    }
}

/// Elements that are left with more contrast than wanted, and that make the error of pictures.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Contrasted {
    /// All of them.
    pub elements: usize,
    /// Those of them that are not cut because they are as small as allowed.
    pub smallest: usize,
}

impl AdaptiveOptions {
    /// With another contrast.
    pub fn with_contrast(self, contrast: f32) -> Self {
        Self { contrast, ..self }
    }

    /// With another smallest edge.
    pub fn with_smallest(self, smallest: f32) -> Self {
        Self {
            smallest: Some(smallest),
            ..self
        }
    }

    /// With another number of elements.
    pub fn with_most_elements(self, most_elements: usize) -> Self {
        Self {
            most_elements,
            ..self
        }
    }

    /// Refuses what is out of range.
    ///
    /// # Errors
    /// What it is, in words.
    pub fn check(&self) -> Result<(), RadiosityError> {
        let fail = |message: String| Err(RadiosityError::Option(message));
        if !(self.contrast > 0.0 && self.contrast < 1.0) {
            return fail(format!("contrast {} is not between 0 and 1", self.contrast));
        }
        if let Some(smallest) = self.smallest.filter(|s| !s.is_finite() || *s <= 0.0) {
            return fail(format!("smallest edge {smallest} is not a positive length"));
        }
        if self.most_elements == 0 || self.most_elements > MAX_ELEMENTS {
            let most = self.most_elements;
            return fail(format!(
                "most elements {most} is not between 1 and {MAX_ELEMENTS}"
            ));
        }
        Ok(())
    }

    /// Edges of at most this length are not cut.
    pub fn smallest_edge(&self, mesh: &PatchMesh) -> f32 {
        self.smallest
            .unwrap_or_else(|| SMALLEST * mesh.longest_unrefined_edge())
    }

    /// The contrast from which on elements are cut.
    pub fn least_contrast(&self, solution: &Solution) -> f32 {
        let noise = solution.provenance.noise.unwrap_or(0.0);
        self.contrast.max(to_f32(ERRORS * noise))
    }

    /// Elements of a solution that have more contrast than wanted and make the error of pictures.
    pub fn left(&self, solution: &Solution) -> Contrasted {
        let mesh = solution.mesh();
        let is_cut = mesh.are_longer(self.smallest_edge(mesh));
        let over = Over::of(self, solution).elements;
        let smallest = over.iter().filter(|&&e| !is_cut[e]).count();
        Contrasted {
            elements: over.len(),
            smallest,
        }
    }

    /// How the mesh of a solution is refined next; `None` if it is fine enough, or can have no more elements.
    pub fn plan(&self, solution: &Solution) -> Option<RefinementPlan> {
        let mesh = solution.mesh();
        let (least, smallest) = (self.least_contrast(solution), self.smallest_edge(mesh));
        let Over {
            elements: over,
            contrasts,
            errors,
        } = Over::of(self, solution);
        let plan = |count: usize| {
            let mut marks = vec![false; mesh.elements().len()];
            over[..count].iter().for_each(|&e| marks[e] = true);
            mesh.plan_refinement(&marks, smallest)
        };
        let fits = |plan: &RefinementPlan| plan.elements <= self.most_elements;
        let room = self.most_elements.saturating_sub(mesh.elements().len());
        let over_by = contrasts.iter().copied();
        let wanted = if self.wanted(mesh, least, over_by) > room as f64 {
            to_cut(&errors, room)
        } else {
            over.len()
        };
        let whole = plan(wanted)?;
        if fits(&whole) {
            return Some(whole);
        }
        // As many of the largest error as fit.
        let (mut fitting, mut low, mut high) = (None, 0, wanted);
        while high - low > 1 {
            let middle = low.midpoint(high);
            match plan(middle) {
                Some(plan) if !fits(&plan) => high = middle,
                plan => (fitting, low) = (plan.or(fitting), middle),
            }
        }
        fitting
    }

    /// About how many elements more there would be in the end if only contrast and size ended it; a cut halves contrast.
    fn wanted(&self, mesh: &PatchMesh, least: f32, over: impl Iterator<Item = f32>) -> f64 {
        let most = self.halvings(mesh);
        let more = |contrast: f32| {
            let halvings = (contrast / least).log2().ceil().clamp(0.0, most);
            f64::from(halvings).exp2().powi(2) - 1.0
        };
        over.map(more).sum()
    }

    /// How often the longest edge is halved until it is as small as allowed.
    fn halvings(&self, mesh: &PatchMesh) -> f32 {
        let halvings = (mesh.longest_unrefined_edge() / self.smallest_edge(mesh)).log2();
        halvings.clamp(0.0, 24.0).ceil()
    }

    /// Rounds of refinement at most.
    fn most_rounds(&self, mesh: &PatchMesh) -> u32 {
        whole(self.halvings(mesh)) + MORE_ROUNDS
    }
}

/// Elements that are to be cut, those of the largest error first.
struct Over {
    elements: Vec<usize>,
    /// Of each of them.
    contrasts: Vec<f32>,
    errors: Vec<f32>,
}

impl Over {
    fn of(options: &AdaptiveOptions, solution: &Solution) -> Self {
        let least = options.least_contrast(solution);
        let (contrasts, errors) = (contrasts(solution), error_estimates(solution));
        let mut elements: Vec<usize> = (0..contrasts.len())
            .filter(|&e| contrasts[e] > least)
            .collect();
        elements.sort_by(|&a, &b| errors[b].total_cmp(&errors[a]).then(a.cmp(&b)));
        let mut errors: Vec<f32> = elements.iter().map(|&e| errors[e]).collect();
        let worth = worth_a_cut(&errors, allowed_error(solution, least));
        elements.truncate(worth);
        errors.truncate(worth);
        Self {
            contrasts: elements.iter().map(|&e| contrasts[e]).collect(),
            elements,
            errors,
        }
    }
}

/// Solves to the end, then refines and solves until the mesh is fine enough.
pub(crate) fn converge_and_refine(
    solution: Solution,
    options: &SolveOptions,
    adaptive: &AdaptiveOptions,
    backend: &dyn Backend,
    stop: Stop<'_>,
    go_on: &mut dyn FnMut(&Progress, &Solution) -> bool,
) -> Result<Solution, RadiosityError> {
    let mut work = Work {
        options: *options,
        backend,
        stop,
        first_step: solution.provenance.steps,
        primary: Vec::new(),
        go_on,
        is_over: false,
    };
    let mut solution = work.converge(solution)?;
    for _ in 0..adaptive.most_rounds(solution.mesh()) {
        if work.is_over(&solution) {
            break;
        }
        let Some(plan) = adaptive.plan(&solution) else {
            break;
        };
        let mesh = match solution.mesh().with_refinement(&plan.refinement, stop) {
            Err(RadiosityError::Stopped(_)) => break,
            mesh => Arc::new(mesh?),
        };
        match work.relight(&solution, mesh)? {
            Some(finer) => solution = finer,
            None => break,
        }
    }
    Ok(work.settled(solution))
}

/// What solves, round after round, and when it ends.
struct Work<'a> {
    options: SolveOptions,
    backend: &'a dyn Backend,
    stop: Stop<'a>,
    first_step: u64,
    /// What lights and sky bring to the elements of the mesh as it is; empty before the first round in which new elements
    /// receive.
    primary: Vec<Rgb>,
    go_on: &'a mut dyn FnMut(&Progress, &Solution) -> bool,
    is_over: bool,
}

impl Work<'_> {
    fn is_over(&self, solution: &Solution) -> bool {
        self.is_over || (self.stop)() || self.steps_left(solution.provenance.steps) == Some(0)
    }

    /// Of the limit of steps, which is one of all rounds together.
    fn steps_left(&self, steps: u64) -> Option<u64> {
        let most = self.options.max_steps?;
        Some((self.first_step + most).saturating_sub(steps))
    }

    fn converge(&mut self, solution: Solution) -> Result<Solution, RadiosityError> {
        let options = SolveOptions {
            max_steps: self.steps_left(solution.provenance.steps),
            ..self.options
        };
        let is_over = &mut self.is_over;
        let go_on = &mut *self.go_on;
        converge(
            solution,
            &options,
            self.backend,
            self.stop,
            |progress, solution| {
                *is_over |= !go_on(progress, solution);
                !*is_over
            },
        )
    }

    /// The light on a refined mesh; none if it was stopped before it was as good as the one before.
    fn relight(
        &mut self,
        old: &Solution,
        mesh: Arc<PatchMesh>,
    ) -> Result<Option<Solution>, RadiosityError> {
        let Some(primary) = self.primary_of(&mesh)? else {
            return Ok(None);
        };
        match self.options.solver.way() {
            Way::Shooting(_) | Way::OnMatrix(_) => {
                if self.options.form_factors == FormFactorKind::RayCast {
                    return self.receive_again(old, primary, mesh);
                }
                let factors = self.backend.form_factors(mesh, &self.options)?;
                Ok(self.shoot_again(old, &primary, &Cached::new(factors, ROW_BUDGET)))
            }
            Way::Stochastic | Way::Hierarchical => {
                self.solve_again(old.unlit_on(mesh, &primary), old)
            }
        }
    }

    /// What lights and sky bring to the elements of a mesh; none if it was stopped.
    fn primary_of(&self, mesh: &PatchMesh) -> Result<Option<Vec<Rgb>>, RadiosityError> {
        match primary_irradiance_until(mesh, self.options.rays, self.options.seed, self.stop) {
            Err(RadiosityError::Stopped(_)) => Ok(None),
            primary => primary.map(Some),
        }
    }

    /// New elements receive what patches have shot.
    fn receive_again(
        &mut self,
        old: &Solution,
        primary: Vec<Rgb>,
        mesh: Arc<PatchMesh>,
    ) -> Result<Option<Solution>, RadiosityError> {
        if self.primary.len() != old.mesh().elements().len() {
            let Some(before) = self.primary_of(old.mesh())? else {
                return Ok(None);
            };
            self.primary = before;
        }
        let start = Instant::now();
        let rays = self.shots(mesh);
        let both = [&self.primary[..], &primary[..]];
        let received = received_by_new(old, both, &rays, &self.options, self.stop);
        self.primary = primary;
        Ok(received.map(|mut solution| {
            solution.provenance.rays += rays.rays();
            solution.provenance.seconds += start.elapsed().as_secs_f64();
            self.tell(&solution);
            solution
        }))
    }

    /// Tells the state after a round without steps.
    fn tell(&mut self, solution: &Solution) {
        let unshot = solution.unshot_fraction();
        let progress = Progress {
            iteration: solution.provenance.steps,
            unshot,
            residual: unshot,
            noise: None,
        };
        self.is_over |= !(self.go_on)(&progress, solution);
    }

    /// Spreads what rounds without shots have changed in the light of patches. It is little and smooth: it goes by shots,
    /// whose cost does not grow with the elements.
    fn settled(&mut self, solution: Solution) -> Solution {
        if self.primary.is_empty() || self.is_over(&solution) {
            return solution;
        }
        let rays = self.shots(solution.mesh().clone());
        self.shoot_rest(solution, &rays, Instant::now())
    }

    fn shots(&self, mesh: Arc<PatchMesh>) -> RayCast {
        let options = RayCastOptions {
            strategy: Strategy::Shots,
            ..self.options.form_factor_options().raycast
        };
        RayCast::new(mesh, options)
    }

    /// Patches shoot what they have shot, and what that changes.
    fn shoot_again(
        &mut self,
        old: &Solution,
        primary: &[Rgb],
        factors: &dyn FormFactors,
    ) -> Option<Solution> {
        let start = Instant::now();
        let solution = transferred(old, primary, factors, self.stop)?;
        Some(self.shoot_rest(solution, factors, start))
    }

    /// Sorted shooting to the end, after a work that began at `start`.
    fn shoot_rest(
        &mut self,
        solution: Solution,
        factors: &dyn FormFactors,
        start: Instant,
    ) -> Solution {
        let mut solver = Shooting::new(factors, solution, Order::Sorted);
        let most = self
            .options
            .max_steps
            .map(|most| self.first_step.saturating_add(most));
        run(&mut solver, self.options.tolerance, |progress, solution| {
            self.is_over |= !(self.go_on)(progress, solution) || (self.stop)();
            !self.is_over && most.is_none_or(|most| progress.iteration < most)
        });
        let mut solution = solver.into_solution();
        solution.provenance.rays += factors.rays();
        solution.provenance.seconds += start.elapsed().as_secs_f64();
        solution
    }

    /// The scene is solved from nothing. Where that does not come to its end, the light that was there is better.
    fn solve_again(
        &mut self,
        unlit: Solution,
        old: &Solution,
    ) -> Result<Option<Solution>, RadiosityError> {
        let before = old.provenance.steps;
        let options = SolveOptions {
            max_steps: self.steps_left(before),
            ..self.options
        };
        let (is_over, go_on) = (&mut self.is_over, &mut *self.go_on);
        let tell = |progress: &Progress, solution: &Solution| {
            let iteration = progress.iteration + before;
            *is_over |= !go_on(
                &Progress {
                    iteration,
                    ..*progress
                },
                solution,
            );
            !*is_over
        };
        let mut solution = converge(unlit, &options, self.backend, self.stop, tell)?;
        let steps = solution.provenance.steps;
        solution.provenance.steps += before;
        let is_cut_off =
            self.is_over || (self.stop)() || options.max_steps.is_some_and(|most| steps >= most);
        let is_finished = solution.unshot_fraction() <= self.options.tolerance;
        Ok((is_finished || !is_cut_off).then_some(solution))
    }
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "between 0 and 24"
)]
fn whole(x: f32) -> u32 {
    x.ceil() as u32
}
