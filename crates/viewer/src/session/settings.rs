//! How the light is found.

use hemicube_radiosity::form_factor::FormFactorKind;
use hemicube_radiosity::form_factor::hemicube::HemicubeOptions;
use hemicube_radiosity::patch::MAX_ELEMENTS;
use hemicube_radiosity::{
    AdaptiveOptions, Grouping, PatchOptions, Quality, SolveOptions, SolverKind,
};
use serde::{Deserialize, Serialize};

/// The four ways of the textbook, in the order of its figure.
pub const VARIANTS: [SolverKind; 4] = [
    SolverKind::Gathering,
    SolverKind::Shooting,
    SolverKind::SortedShooting,
    SolverKind::AmbientShooting,
];

/// What computes form factors, and on which device.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum FactorsBy {
    /// Rays on the CPU's threads.
    #[default]
    Rays,
    /// Item buffers on the CPU's threads.
    Hemicubes,
    /// Item buffers on the GPU; sorted shooting stays there altogether.
    Gpu,
}

impl FactorsBy {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Rays, Self::Hemicubes, Self::Gpu];

    /// As the panel shows it.
    pub fn label(self) -> &'static str {
        match self {
            Self::Rays => "Rays on the CPU",
            Self::Hemicubes => "Hemicubes on the CPU",
            Self::Gpu => "Hemicubes on the GPU",
        }
    }

    fn kind(self) -> FormFactorKind {
        match self {
            Self::Rays => FormFactorKind::RayCast,
            Self::Hemicubes | Self::Gpu => FormFactorKind::Hemicube,
        }
    }
}

/// Sizes or numbers of patches and elements, and what cuts these, as [`PatchOptions`] has them.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct MeshSizes {
    /// Longest edge of a patch. Default value: none.
    pub patch_size: Option<f32>,
    /// Longest edge of an element. Default value: none.
    pub element_size: Option<f32>,
    /// Patches to aim at. Default value: none.
    pub patches: Option<usize>,
    /// Elements to aim at. Default value: none.
    pub elements: Option<usize>,
    /// Whether elements stay whole where faces meet. Default value: no, they are cut.
    pub no_joints: bool,
    /// Whether elements are cut along the borders of shadows. Default value: no.
    pub discontinuities: bool,
}

impl From<PatchOptions> for MeshSizes {
    fn from(options: PatchOptions) -> Self {
        Self {
            patch_size: options.patch_size,
            element_size: options.element_size,
            patches: options.patches,
            elements: options.elements,
            no_joints: !options.joints,
            discontinuities: options.discontinuities,
        }
    }
}

impl From<MeshSizes> for PatchOptions {
    fn from(sizes: MeshSizes) -> Self {
        Self {
            patch_size: sizes.patch_size,
            element_size: sizes.element_size,
            patches: sizes.patches,
            elements: sizes.elements,
            joints: !sizes.no_joints,
            discontinuities: sizes.discontinuities,
            ..Self::default()
        }
    }
}

/// Where elements are cut once the light on them is found, as [`AdaptiveOptions`] has it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Refinement {
    /// Largest contrast of light over an element. Default value: 0.2.
    pub contrast: f32,
    /// Edges of at most this length are not cut. Default value: none, a sixteenth of the longest edge.
    pub smallest: Option<f32>,
    /// Most elements of a refined mesh. Default value: 100,000.
    pub most_elements: usize,
}

impl Default for Refinement {
    fn default() -> Self {
        Self {
            contrast: 0.2,
            smallest: None,
            most_elements: 100_000,
        }
    }
}

/// What is out of range, as in a file that was damaged, means the usual.
impl From<Refinement> for AdaptiveOptions {
    fn from(refinement: Refinement) -> Self {
        let usual = Refinement::default();
        let is_contrast = refinement.contrast > 0.0 && refinement.contrast < 1.0;
        Self {
            contrast: if is_contrast {
                refinement.contrast
            } else {
                usual.contrast
            },
            smallest: refinement
                .smallest
                .filter(|smallest| smallest.is_finite() && *smallest > 0.0),
            most_elements: refinement.most_elements.clamp(1, MAX_ELEMENTS),
        }
    }
}

/// How the light is found.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Settings {
    /// Position of the way to the equilibrium in [`SolverKind::ALL`]; none, or one that there is not, means the best for
    /// the size of the scene.
    solver: Option<usize>,
    /// Whether the four [`VARIANTS`] run side by side instead. Default value: no.
    pub side_by_side: bool,
    /// What computes form factors. Default value: rays.
    pub factors: FactorsBy,
    /// Position of the preset in [`Quality::ALL`].
    quality: usize,
    /// Another mesh than the preset's. Default value: none.
    pub mesh: Option<MeshSizes>,
    /// Where the mesh is refined once the light is found; not while variants run side by side. Default value: nowhere.
    pub refinement: Option<Refinement>,
    /// Unshot share of the emitted flux at which the light counts as found. Default value: 1e-4.
    pub tolerance: f64,
    /// Whether emitters are solved each on their own, so that they can be dimmed. Default value: yes.
    pub by_source: bool,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            solver: None,
            side_by_side: false,
            factors: FactorsBy::default(),
            quality: 1,
            mesh: None,
            refinement: None,
            tolerance: 1e-4,
            by_source: true,
        }
    }
}

impl Settings {
    /// Another way to the equilibrium; none means the best for the size of the scene. Default value: none.
    pub fn with_solver(self, solver: impl Into<Option<SolverKind>>) -> Self {
        let solver = solver.into();
        let place = |solver| SolverKind::ALL.iter().position(|&kind| kind == solver);
        Self {
            solver: solver.and_then(place),
            ..self
        }
    }

    /// Another preset for the mesh, in place of sizes. Default value: normal.
    pub fn with_quality(self, quality: Quality) -> Self {
        let place = Quality::ALL.iter().position(|&other| other == quality);
        Self {
            quality: place.unwrap_or(0),
            mesh: None,
            ..self
        }
    }

    /// Another mesh than the preset's.
    pub fn with_mesh(self, mesh: MeshSizes) -> Self {
        Self {
            mesh: Some(mesh),
            ..self
        }
    }

    /// Where the mesh is refined once the light is found.
    pub fn with_refinement(self, refinement: impl Into<Option<Refinement>>) -> Self {
        Self {
            refinement: refinement.into(),
            ..self
        }
    }

    /// Other form factors.
    pub fn with_factors(self, factors: FactorsBy) -> Self {
        Self { factors, ..self }
    }

    /// All four variants side by side, or one.
    pub fn with_side_by_side(self, side_by_side: bool) -> Self {
        Self {
            side_by_side,
            ..self
        }
    }

    /// Another unshot share at which the light counts as found.
    pub fn with_tolerance(self, tolerance: f64) -> Self {
        Self { tolerance, ..self }
    }

    /// The way to the equilibrium that was chosen, if one was.
    pub fn solver(&self) -> Option<SolverKind> {
        SolverKind::ALL.get(self.solver?).copied()
    }

    /// The way to the equilibrium for so many elements.
    pub fn solver_for(&self, elements: usize) -> SolverKind {
        let best = || SolverKind::for_size(0, elements);
        self.solver().unwrap_or_else(best)
    }

    /// The preset for the mesh.
    pub fn quality(&self) -> Quality {
        Quality::ALL.get(self.quality).copied().unwrap_or_default()
    }

    /// What runs on so many elements: one way, or the four variants.
    pub fn solvers(&self, elements: usize) -> Vec<SolverKind> {
        if self.side_by_side {
            VARIANTS.to_vec()
        } else {
            vec![self.solver_for(elements)]
        }
    }

    /// Whether other settings ask for another mesh or other groups.
    pub fn wants_other_mesh(&self, other: &Self) -> bool {
        let mesh = |s: &Self| (s.quality(), s.mesh, s.by_source);
        mesh(self) != mesh(other)
    }

    /// As the solver's options.
    pub fn solve_options(&self) -> SolveOptions {
        let preset = SolveOptions::from(self.quality());
        SolveOptions {
            mesh: self.mesh.map_or(preset.mesh, PatchOptions::from),
            adaptive: self.refinement.map(AdaptiveOptions::from),
            form_factors: self.factors.kind(),
            solver: self.solver().unwrap_or_default(),
            tolerance: self.tolerance,
            hemicube: HemicubeOptions::default(),
            grouping: if self.by_source {
                Grouping::ByMaterial
            } else {
                Grouping::Together
            },
            ..preset
        }
    }
}

/// What somebody wants to be otherwise; the rest stays as it is.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Asked {
    /// Preset of the mesh. Default value: none.
    pub quality: Option<Quality>,
    /// Mesh in place of the preset's. Default value: none.
    pub mesh: Option<MeshSizes>,
    /// Way to the equilibrium. Default value: none.
    pub solver: Option<SolverKind>,
    /// What computes form factors. Default value: none.
    pub factors: Option<FactorsBy>,
    /// Unshot share at which the light counts as found. Default value: none.
    pub tolerance: Option<f64>,
}

impl Asked {
    /// Settings with what was asked for.
    pub fn in_settings(&self, settings: Settings) -> Settings {
        let mut asked = settings;
        if let Some(quality) = self.quality {
            asked = asked.with_quality(quality);
        }
        Settings {
            mesh: self.mesh.or(asked.mesh),
            factors: self.factors.unwrap_or(asked.factors),
            tolerance: self.tolerance.unwrap_or(asked.tolerance),
            ..asked.with_solver(self.solver.or(asked.solver()))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn damaged_settings_mean_the_usual_ones() {
        let json = r#"{"solver": 99, "quality": 77}"#;
        let settings: Settings = serde_json::from_str(json).expect("fields may be missing");
        assert_eq!(settings.solver(), None, "out of range");
        assert_eq!(settings.quality(), Quality::default(), "out of range");
        assert_eq!(settings.tolerance, 1e-4, "missing");
    }

    #[test]
    fn a_refinement_is_kept_and_a_damaged_one_is_the_usual() {
        let refinement = Refinement {
            contrast: 0.05,
            smallest: Some(0.02),
            most_elements: 7000,
        };
        let settings = Settings::default().with_refinement(refinement);
        let json = serde_json::to_string(&settings).expect("it has a text");
        let again: Settings = serde_json::from_str(&json).expect("it was written so");
        assert_eq!(again, settings, "{json}");
        let wanted = AdaptiveOptions::default()
            .with_contrast(0.05)
            .with_smallest(0.02)
            .with_most_elements(7000);
        assert_eq!(settings.solve_options().adaptive, Some(wanted), "as set");
        assert!(!settings.wants_other_mesh(&Settings::default()), "not yet");
        let damaged = Refinement {
            contrast: f32::NAN,
            smallest: Some(-1.0),
            most_elements: 0,
        };
        let options = AdaptiveOptions::from(damaged);
        options.check().expect("it is in range");
        assert_eq!(options.contrast, Refinement::default().contrast, "usual");
    }

    #[test]
    fn sizes_stand_in_for_the_preset() {
        let sizes = MeshSizes {
            element_size: Some(0.5),
            ..MeshSizes::default()
        };
        let settings = Settings::default().with_mesh(sizes);
        let mesh = settings.solve_options().mesh;
        assert_eq!(
            (mesh.element_size, mesh.elements),
            (Some(0.5), None),
            "as asked"
        );
        assert!(settings.wants_other_mesh(&Settings::default()), "finer");
        let preset = settings.with_quality(Quality::Normal);
        assert_eq!(preset, Settings::default(), "the preset takes over again");
    }

    #[test]
    fn another_solver_keeps_the_mesh() {
        let settings = Settings::default();
        let other = settings
            .with_solver(SolverKind::Gathering)
            .with_factors(FactorsBy::Gpu)
            .with_side_by_side(true);
        assert!(!settings.wants_other_mesh(&other), "the mesh is the same");
        assert!(
            settings.wants_other_mesh(&settings.with_quality(Quality::Draft)),
            "it is coarser"
        );
        assert_eq!(other.solvers(100), VARIANTS, "the figure's four");
    }

    #[test]
    fn large_scenes_are_solved_by_rays_unless_something_else_was_chosen() {
        let settings = Settings::default();
        let small = settings.solvers(4000);
        assert_eq!(small, [SolverKind::AmbientShooting], "shots are few");
        let large = settings.solvers(1_000_000);
        assert_eq!(large, [SolverKind::Stochastic], "shots are many");
        let chosen = settings.with_solver(SolverKind::Shooting);
        assert_eq!(
            chosen.solvers(1_000_000),
            [SolverKind::Shooting],
            "as chosen"
        );
        assert_eq!(chosen.with_solver(None), settings, "and back");
    }
}
