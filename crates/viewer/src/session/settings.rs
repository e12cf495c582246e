//! How the light is found.

use hemicube_radiosity::form_factor::FormFactorKind;
use hemicube_radiosity::form_factor::hemicube::HemicubeOptions;
use hemicube_radiosity::{Grouping, Quality, SolveOptions, SolverKind};
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

/// How the light is found.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Settings {
    /// Position of the way to the equilibrium in [`SolverKind::ALL`].
    solver: usize,
    /// Whether the four [`VARIANTS`] run side by side instead. Default value: no.
    pub side_by_side: bool,
    /// What computes form factors. Default value: rays.
    pub factors: FactorsBy,
    /// Position of the preset in [`Quality::ALL`].
    quality: usize,
    /// Unshot share of the emitted flux at which the light counts as found. Default value: 1e-4.
    pub tolerance: f64,
    /// Whether emitters are solved each on their own, so that they can be dimmed. Default value: yes.
    pub by_source: bool,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            solver: 0,
            side_by_side: false,
            factors: FactorsBy::default(),
            quality: 1,
            tolerance: 1e-4,
            by_source: true,
        }
        .with_solver(SolverKind::AmbientShooting)
    }
}

impl Settings {
    /// Another way to the equilibrium. Default value: sorted shooting with the ambient estimate.
    pub fn with_solver(self, solver: SolverKind) -> Self {
        let place = SolverKind::ALL.iter().position(|&kind| kind == solver);
        Self {
            solver: place.unwrap_or(0),
            ..self
        }
    }

    /// Another preset for the mesh. Default value: normal.
    pub fn with_quality(self, quality: Quality) -> Self {
        let place = Quality::ALL.iter().position(|&other| other == quality);
        Self {
            quality: place.unwrap_or(0),
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

    /// The way to the equilibrium.
    pub fn solver(&self) -> SolverKind {
        SolverKind::ALL
            .get(self.solver)
            .copied()
            .unwrap_or_default()
    }

    /// The preset for the mesh.
    pub fn quality(&self) -> Quality {
        Quality::ALL.get(self.quality).copied().unwrap_or_default()
    }

    /// What runs: one way, or the four variants.
    pub fn solvers(&self) -> Vec<SolverKind> {
        if self.side_by_side {
            VARIANTS.to_vec()
        } else {
            vec![self.solver()]
        }
    }

    /// Whether other settings ask for another mesh or other groups.
    pub fn wants_other_mesh(&self, other: &Self) -> bool {
        (self.quality(), self.by_source) != (other.quality(), other.by_source)
    }

    /// As the solver's options.
    pub fn solve_options(&self) -> SolveOptions {
        SolveOptions {
            form_factors: self.factors.kind(),
            solver: self.solver(),
            tolerance: self.tolerance,
            hemicube: HemicubeOptions::default(),
            grouping: if self.by_source {
                Grouping::ByMaterial
            } else {
                Grouping::Together
            },
            ..self.quality().into()
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
        assert_eq!(settings.solver(), SolverKind::default(), "out of range");
        assert_eq!(settings.quality(), Quality::default(), "out of range");
        assert_eq!(settings.tolerance, 1e-4, "missing");
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
        assert_eq!(other.solvers(), VARIANTS, "the figure's four");
    }
}
