//! The radiosity equations on patches, and what a method on their matrix is.

use crate::error::RadiosityError;
use crate::form_factor::ViewFactorMatrix;
use crate::form_factor::matrix::Entries;
use crate::solve::{Gathering, Gauss, GaussSeidel, Jacobi, Southwell};
use rayon::prelude::*;

/// One colour band of one light group: `B_i = E_i + ρ_i Σ_j F_ij B_j`.
#[derive(Debug, Clone, PartialEq)]
pub struct Channel {
    /// Which of the matrices holds its factors.
    pub matrix: usize,
    /// ρ of each patch.
    pub reflectance: Vec<f64>,
    /// E of each patch, the right side.
    pub emission: Vec<f64>,
    /// B of each patch as it stands.
    pub radiosity: Vec<f64>,
}

/// Equations of all channels over the same patches.
#[derive(Debug)]
pub struct System<'a> {
    /// Factors: one matrix, or one for each band.
    pub matrices: &'a [Entries],
    /// Area of each patch.
    pub areas: &'a [f64],
    /// The equations.
    pub channels: &'a mut [Channel],
}

impl System<'_> {
    /// Number of patches.
    pub fn size(&self) -> usize {
        self.areas.len()
    }

    /// Factors of a channel.
    pub fn factors(&self, channel: usize) -> &Entries {
        &self.matrices[self.channels[channel].matrix]
    }

    /// What the equation of a patch lacks: `E_i + ρ_i Σ_j F_ij B_j - B_i`.
    pub fn residual(&self, channel: usize, i: usize) -> f64 {
        let Channel {
            reflectance,
            emission,
            radiosity,
            ..
        } = &self.channels[channel];
        emission[i] + reflectance[i] * self.factors(channel).dot(i, radiosity) - radiosity[i]
    }

    /// Residuals of all patches of a channel.
    pub fn residuals(&self, channel: usize) -> Vec<f64> {
        let state = &self.channels[channel];
        if state.radiosity.iter().all(|&b| b == 0.0) {
            return state.emission.clone();
        }
        let patches = (0..self.size()).into_par_iter();
        patches.map(|i| self.residual(channel, i)).collect()
    }

    /// Fulfils the equation of one patch in all channels, given all other radiosities: it gathers.
    pub fn relax(&mut self, i: usize) {
        for channel in 0..self.channels.len() {
            let own = f64::from(self.factors(channel).get(i, i));
            let residual = self.residual(channel, i);
            let state = &mut self.channels[channel];
            state.radiosity[i] += residual / (1.0 - state.reflectance[i] * own);
        }
    }

    /// Sum of residual fluxes over that of emitted ones, absolute values over patches and channels.
    pub fn residual_share(&self) -> f64 {
        let flux = |values: &[f64]| -> f64 {
            let fluxes = values.iter().zip(self.areas);
            fluxes.map(|(b, a)| b.abs() * a).sum()
        };
        let (mut residual, mut emitted) = (0.0, 0.0);
        for channel in 0..self.channels.len() {
            residual += flux(&self.residuals(channel));
            emitted += flux(&self.channels[channel].emission);
        }
        if emitted > 0.0 {
            residual / emitted
        } else {
            0.0
        }
    }
}

/// A way to solve the equations step by step.
pub trait MatrixMethod: core::fmt::Debug + Send {
    /// Does one step on the radiosities; says whether it ended a sweep: each patch had its turn.
    fn step(&mut self, system: &mut System<'_>) -> bool;

    /// Forgets what it knows of right sides and radiosities, which have changed; matrices and reflectances have not.
    fn restart(&mut self);
}

/// Ways to solve the equations on a matrix.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MatrixSolverKind {
    /// Elimination.
    Gauss,
    /// All patches gather at once.
    Jacobi,
    /// All patches gather one after the other.
    GaussSeidel,
    /// The patch with the largest residual flux is relaxed.
    Southwell,
    /// One patch gathers.
    Gathering,
}

impl MatrixSolverKind {
    /// All of them.
    pub const ALL: [Self; 5] = [
        Self::Gauss,
        Self::Jacobi,
        Self::GaussSeidel,
        Self::Southwell,
        Self::Gathering,
    ];

    /// Name on the command line and in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Gauss => "gauss",
            Self::Jacobi => "jacobi",
            Self::GaussSeidel => "gauss-seidel",
            Self::Southwell => "southwell",
            Self::Gathering => "gathering",
        }
    }

    /// The method, before its first step.
    pub fn method(self) -> Box<dyn MatrixMethod> {
        match self {
            Self::Gauss => Box::new(Gauss::default()),
            Self::Jacobi => Box::new(Jacobi),
            Self::GaussSeidel => Box::new(GaussSeidel),
            Self::Southwell => Box::new(Southwell::default()),
            Self::Gathering => Box::new(Gathering::default()),
        }
    }

    /// Whether it starts with B = E, as books do, or with nothing shot.
    pub(crate) fn starts_at_emission(self) -> bool {
        matches!(self, Self::Jacobi | Self::GaussSeidel | Self::Gathering)
    }

    /// Bytes that it takes besides the matrices.
    pub(crate) fn extra_bytes(self, matrices: &[Entries], channels: usize) -> usize {
        let n = matrices.first().map_or(0, Entries::size);
        match self {
            Self::Gauss => n.saturating_mul(n).saturating_mul(8 * channels),
            Self::Southwell => matrices.iter().map(Entries::bytes).sum(),
            Self::Jacobi | Self::GaussSeidel | Self::Gathering => 0,
        }
    }

    /// Refuses more memory than allowed, matrices included.
    pub(crate) fn refuse_memory(
        self,
        matrices: &[Entries],
        channels: usize,
        limit: usize,
    ) -> Result<(), RadiosityError> {
        let stored: usize = matrices.iter().map(Entries::bytes).sum();
        let needed = stored.saturating_add(self.extra_bytes(matrices, channels));
        if needed <= limit {
            return Ok(());
        }
        Err(RadiosityError::Option(format!(
            "solver {} on {} patches takes {} MiB, {} MiB are allowed; use fewer patches, or gauss-seidel, which \
             needs no second matrix",
            self.name(),
            matrices.first().map_or(0, Entries::size),
            (needed >> 20) + 1,
            limit >> 20
        )))
    }
}

/// One channel solved on a matrix, step by step: for enclosures that are no scene.
#[derive(Debug)]
pub struct MatrixRun<'a> {
    matrix: &'a ViewFactorMatrix,
    channel: Channel,
    method: Box<dyn MatrixMethod>,
}

impl<'a> MatrixRun<'a> {
    /// Before the first step.
    ///
    /// # Errors
    /// Numbers of values that do not fit the matrix, values that are not finite, reflectances outside [0, 1), more
    /// than 2 GiB.
    pub fn new(
        matrix: &'a ViewFactorMatrix,
        emission: &[f64],
        reflectance: &[f64],
        kind: MatrixSolverKind,
    ) -> Result<Self, RadiosityError> {
        let n = matrix.size();
        let fail = |message| Err(RadiosityError::Option(message));
        if emission.len() != n || reflectance.len() != n {
            return fail(format!(
                "{} emissions and {} reflectances for {n} patches",
                emission.len(),
                reflectance.len()
            ));
        }
        for (i, (e, rho)) in emission.iter().zip(reflectance).enumerate() {
            if !e.is_finite() {
                return fail(format!("patch {i}: emission {e} is not finite"));
            }
            if !(0.0..1.0).contains(rho) {
                return fail(format!(
                    "patch {i}: reflectance {rho} is not in [0, 1), the solution would not converge"
                ));
            }
        }
        let matrices = core::slice::from_ref(matrix.entries());
        kind.refuse_memory(matrices, 1, 2 << 30)?;
        let radiosity = if kind.starts_at_emission() {
            emission.to_vec()
        } else {
            vec![0.0; n]
        };
        Ok(Self {
            matrix,
            channel: Channel {
                matrix: 0,
                reflectance: reflectance.to_vec(),
                emission: emission.to_vec(),
                radiosity,
            },
            method: kind.method(),
        })
    }

    fn system(&mut self) -> (System<'_>, &mut dyn MatrixMethod) {
        let system = System {
            matrices: core::slice::from_ref(self.matrix.entries()),
            areas: self.matrix.areas(),
            channels: core::slice::from_mut(&mut self.channel),
        };
        (system, &mut *self.method)
    }

    /// Does one step; says whether it ended a sweep.
    pub fn step(&mut self) -> bool {
        let (mut system, method) = self.system();
        method.step(&mut system)
    }

    /// B of each patch as it stands.
    pub fn radiosity(&self) -> &[f64] {
        &self.channel.radiosity
    }

    /// `E + ρ F B - B` of each patch: of shooting methods what is unshot.
    pub fn residuals(&mut self) -> Vec<f64> {
        self.system().0.residuals(0)
    }

    /// Absolute residual flux over emitted flux.
    pub fn residual_share(&mut self) -> f64 {
        self.system().0.residual_share()
    }
}

/// A solution on a matrix, and how it was reached.
#[derive(Debug, Clone, PartialEq)]
pub struct MatrixSolution {
    /// B of each patch.
    pub radiosity: Vec<f64>,
    /// Residual share before the first sweep and after each.
    pub history: Vec<f64>,
}

/// Solves one channel on a matrix until the residual share is at most `tolerance` or `sweeps` are over.
///
/// # Errors
/// What [`MatrixRun::new`] refuses.
pub fn solve_matrix(
    matrix: &ViewFactorMatrix,
    emission: &[f64],
    reflectance: &[f64],
    kind: MatrixSolverKind,
    tolerance: f64,
    sweeps: usize,
) -> Result<MatrixSolution, RadiosityError> {
    let mut run = MatrixRun::new(matrix, emission, reflectance, kind)?;
    let mut history = vec![run.residual_share()];
    for _ in 0..sweeps {
        if history.last().is_some_and(|&share| share <= tolerance) {
            break;
        }
        while !run.step() {}
        history.push(run.residual_share());
    }
    Ok(MatrixSolution {
        radiosity: run.channel.radiosity,
        history,
    })
}
