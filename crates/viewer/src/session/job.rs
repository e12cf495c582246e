//! A scene and its light while no solver works on it.

use crate::session::lane::LaneState;
use crate::session::{FactorsBy, History, Refinement, Settings};
use hemicube_radiosity::backend::Backend;
use hemicube_radiosity::form_factor::{Cached, FormFactors};
use hemicube_radiosity::{
    Grouping, MaterialEdit, RadiosityError, Solution, SolveOptions, SolverKind,
};
use std::sync::Arc;

/// Memory for rows of form factors.
const ROW_BUDGET: usize = 256 << 20;

/// A scene and its light while no solver works on it.
pub(super) struct Job {
    /// Before the first step; on a refined mesh the light that it began with.
    pub start: Solution,
    pub lanes: Vec<LaneState>,
    factors: Option<(FactorsBy, Arc<dyn FormFactors>)>,
    pub source_of_material: Arc<Vec<Option<usize>>>,
    /// The light that all ways come to, once one has.
    pub truth: Option<Arc<Solution>>,
    /// Start and truth on the mesh before it was refined.
    unrefined: Option<Box<(Solution, Option<Arc<Solution>>)>>,
    /// What the mesh was last refined by, or was to be.
    pub refined: Option<Refinement>,
}

impl Job {
    pub fn new(solution: Solution, settings: &Settings) -> Self {
        Self {
            lanes: lanes_at(&solution, settings),
            source_of_material: Arc::new(source_of_material(&solution)),
            factors: None,
            truth: None,
            unrefined: None,
            refined: None,
            start: solution,
        }
    }

    pub fn elements(&self) -> usize {
        self.start.mesh().elements().len()
    }

    /// Form factors of the mesh; what an edit changes leaves them as they are.
    pub fn factors(
        &mut self,
        by: FactorsBy,
        backend: &dyn Backend,
        options: &SolveOptions,
    ) -> Result<Arc<dyn FormFactors>, RadiosityError> {
        if let Some((known, factors)) = &self.factors
            && *known == by
        {
            return Ok(factors.clone());
        }
        let made = backend.form_factors(self.start.mesh().clone(), options)?;
        let factors: Arc<dyn FormFactors> = Arc::new(Cached::new(made, ROW_BUDGET));
        self.factors = Some((by, factors.clone()));
        Ok(factors)
    }

    /// The light as it was before the first step; whether that is on another mesh.
    pub fn restart(&mut self, settings: &Settings) -> bool {
        let unrefined = self.unrefined.take();
        let is_other = unrefined.is_some();
        if let Some(unrefined) = unrefined {
            (self.start, self.truth) = *unrefined;
            self.factors = None;
        }
        self.refined = None;
        self.lanes = lanes_at(&self.start, settings);
        is_other
    }

    /// The light of the only lane is on a finer mesh now.
    pub fn refine(&mut self, refined: Solution) {
        for lane in &mut self.lanes {
            lane.solution = refined.clone();
        }
        let start = core::mem::replace(&mut self.start, refined);
        let truth = self.truth.take();
        self.unrefined
            .get_or_insert_with(|| Box::new((start, truth)));
        self.factors = None;
    }

    /// Changes a material in the light of all lanes. What starts to emit gets a light group of its own.
    pub fn edit(&mut self, edit: &MaterialEdit, by_source: bool) -> Result<(), RadiosityError> {
        let mesh = Arc::new(self.start.mesh().edited(edit)?);
        let material = &mesh.scene().materials[edit.material];
        let mut sources = (*self.source_of_material).clone();
        let is_new = sources[edit.material].is_none() && material.emits();
        let is_alone = by_source && self.start.groups().len() > 1;
        let dark_group = (is_new && is_alone).then(|| material.name.clone());
        if dark_group.is_some() {
            sources[edit.material] = Some(self.start.groups().len() - 1);
        }
        let groups = self.start.groups().len() + usize::from(dark_group.is_some());
        let group = sources[edit.material].unwrap_or(groups - 1);
        let edited = |solution: &Solution, mesh| {
            let solution = solution.clone();
            let wider = match &dark_group {
                Some(name) => solution.with_dark_group(name.clone()).0,
                None => solution,
            };
            wider.relit(mesh, |_| group)
        };
        if let Some(unrefined) = &mut self.unrefined {
            let mesh = Arc::new(unrefined.0.mesh().edited(edit)?);
            **unrefined = (edited(&unrefined.0, mesh), None);
        }
        let lanes = self.lanes.iter_mut().map(|lane| &mut lane.solution);
        for solution in core::iter::once(&mut self.start).chain(lanes) {
            *solution = edited(solution, mesh.clone());
        }
        self.source_of_material = Arc::new(sources);
        (self.truth, self.refined) = (None, None);
        Ok(())
    }
}

fn lanes_at(start: &Solution, settings: &Settings) -> Vec<LaneState> {
    let lane = |kind: SolverKind| LaneState {
        kind,
        solution: start.clone(),
        history: History::default(),
        seconds: 0.0,
    };
    let elements = start.mesh().elements().len();
    settings.solvers(elements).into_iter().map(lane).collect()
}

/// The light group of each material, where materials have groups of their own.
fn source_of_material(solution: &Solution) -> Vec<Option<usize>> {
    let mesh = solution.mesh();
    let (names, _) = Grouping::ByMaterial.groups(mesh);
    let known = solution.groups().iter().map(|group| &group.name);
    let is_by_material = names.len() > 1 && known.eq(&names);
    let mut next = 0;
    let mut of = |material: &hemicube_scene::Material| {
        if !material.emits() {
            return None;
        }
        next += 1;
        Some(if is_by_material { next - 1 } else { 0 })
    };
    mesh.scene().materials.iter().map(&mut of).collect()
}
