//! The radiosity equations on patches, and what a method on their matrix is.

use crate::error::RadiosityError;
use crate::form_factor::ViewFactorMatrix;
use crate::form_factor::matrix::Entries;
use crate::solve::{
    ConjugateGradient, Gathering, Gauss, GaussSeidel, Jacobi, Overshooting, Southwell,
};
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
///
/// Channels that share a matrix are gathered in one pass over it: reading the factors is what takes the time.
#[derive(Debug)]
pub struct System<'a> {
    /// Factors: one matrix, or one for each band.
    pub matrices: &'a [Entries],
    /// Area of each patch.
    pub areas: &'a [f64],
    /// The equations.
    pub channels: &'a mut [Channel],
    /// Of each matrix: the channels that it serves.
    served: Vec<Vec<usize>>,
}

impl<'a> System<'a> {
    /// The equations of these channels.
    pub fn new(matrices: &'a [Entries], areas: &'a [f64], channels: &'a mut [Channel]) -> Self {
        let of_matrix = |m: usize| -> Vec<usize> {
            let channels = channels.iter().enumerate();
            channels
                .filter(|(_, c)| c.matrix == m)
                .map(|(i, _)| i)
                .collect()
        };
        Self {
            served: (0..matrices.len()).map(of_matrix).collect(),
            matrices,
            areas,
            channels,
        }
    }

    /// Number of patches.
    pub fn size(&self) -> usize {
        self.areas.len()
    }

    /// Factors of a channel.
    pub fn factors(&self, channel: usize) -> &Entries {
        &self.matrices[self.channels[channel].matrix]
    }

    /// `Σ_j F_ij x_j` of one patch, with a vector x and a result for each channel.
    fn gather<'v>(&self, i: usize, vector: impl Fn(usize) -> &'v [f64], sums: &mut [f64]) {
        for (matrix, served) in self.matrices.iter().zip(&self.served) {
            for some in served.chunks(3) {
                match *some {
                    [a] => [sums[a]] = matrix.dots(i, [vector(a)]),
                    [a, b] => [sums[a], sums[b]] = matrix.dots(i, [vector(a), vector(b)]),
                    [a, b, c] => {
                        let vectors = [vector(a), vector(b), vector(c)];
                        [sums[a], sums[b], sums[c]] = matrix.dots(i, vectors);
                    }
                    _ => unreachable!("chunks have one to three channels"),
                }
            }
        }
    }

    /// `ρ_i Σ_j F_ij x_j` of all patches, with a vector x and a result for each channel: the light of one reflection.
    pub fn reflected<'v>(&self, vector: impl Fn(usize) -> &'v [f64] + Sync) -> Vec<Vec<f64>> {
        let count = self.channels.len();
        let mut sums = vec![0.0; self.size() * count];
        sums.par_chunks_mut(count.max(1))
            .enumerate()
            .for_each(|(i, sums)| self.gather(i, &vector, sums));
        let of_channel = |(c, channel): (usize, &Channel)| -> Vec<f64> {
            let patches = channel.reflectance.iter().enumerate();
            patches.map(|(i, rho)| rho * sums[i * count + c]).collect()
        };
        self.channels.iter().enumerate().map(of_channel).collect()
    }

    /// What the equation of each patch lacks, by channel: `E_i + ρ_i Σ_j F_ij B_j - B_i`.
    pub fn residuals(&self) -> Vec<Vec<f64>> {
        let channels = self.channels.iter();
        if channels
            .clone()
            .flat_map(|c| &c.radiosity)
            .all(|&b| b == 0.0)
        {
            return channels.map(|c| c.emission.clone()).collect();
        }
        let mut residuals = self.reflected(|c| &self.channels[c].radiosity);
        for (channel, residuals) in channels.zip(&mut residuals) {
            for (i, r) in residuals.iter_mut().enumerate() {
                *r += channel.emission[i] - channel.radiosity[i];
            }
        }
        residuals
    }

    /// Fulfils the equation of one patch in all channels, given all other radiosities: it gathers.
    pub fn relax(&mut self, i: usize) {
        let mut sums = vec![0.0; self.channels.len()];
        self.gather(i, |c| &self.channels[c].radiosity, &mut sums);
        for (c, sum) in sums.into_iter().enumerate() {
            let own = f64::from(self.factors(c).get(i, i));
            let state = &mut self.channels[c];
            let (reflectance, radiosity) = (state.reflectance[i], &mut state.radiosity[i]);
            let residual = state.emission[i] + reflectance * sum - *radiosity;
            *radiosity += residual / (1.0 - reflectance * own);
        }
    }

    /// Sum of residual fluxes over that of emitted ones, absolute values over patches and channels.
    pub fn residual_share(&self) -> f64 {
        let flux = |values: &[f64]| -> f64 {
            let fluxes = values.iter().zip(self.areas);
            fluxes.map(|(b, a)| b.abs() * a).sum()
        };
        let residual: f64 = self.residuals().iter().map(|r| flux(r)).sum();
        let emitted: f64 = self.channels.iter().map(|c| flux(&c.emission)).sum();
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

    /// Residuals of each channel and patch as they stand, if it keeps them anyway.
    fn residuals(&self) -> Option<&[Vec<f64>]> {
        None
    }
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
    /// As Southwell, but what the patch will get back is counted in and shot ahead.
    Overshooting,
    /// Descent along directions that do not spoil one another's work.
    ConjugateGradient,
}

impl MatrixSolverKind {
    /// All of them.
    pub const ALL: [Self; 7] = [
        Self::Gauss,
        Self::Jacobi,
        Self::GaussSeidel,
        Self::Southwell,
        Self::Gathering,
        Self::Overshooting,
        Self::ConjugateGradient,
    ];

    /// Name on the command line and in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Gauss => "gauss",
            Self::Jacobi => "jacobi",
            Self::GaussSeidel => "gauss-seidel",
            Self::Southwell => "southwell",
            Self::Gathering => "gathering",
            Self::Overshooting => "overshooting",
            Self::ConjugateGradient => "conjugate-gradient",
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
            Self::Overshooting => Box::new(Overshooting::default()),
            Self::ConjugateGradient => Box::new(ConjugateGradient::default()),
        }
    }

    /// Whether it starts with B = E, as books do, or with nothing shot.
    pub(crate) fn starts_at_emission(self) -> bool {
        matches!(self, Self::Jacobi | Self::GaussSeidel | Self::Gathering)
    }

    /// Bytes that it takes besides the matrices, which take `stored`.
    fn extra_bytes(self, n: usize, stored: usize, channels: usize) -> usize {
        match self {
            Self::Gauss => n.saturating_mul(n).saturating_mul(8 * channels),
            Self::Southwell | Self::Overshooting => stored,
            Self::ConjugateGradient => n.saturating_mul(8 * 7 * channels),
            Self::Jacobi | Self::GaussSeidel | Self::Gathering => 0,
        }
    }

    /// Refuses more memory than allowed, matrices of `stored` bytes included.
    pub(crate) fn refuse_memory(
        self,
        n: usize,
        stored: usize,
        channels: usize,
        limit: usize,
    ) -> Result<(), RadiosityError> {
        let needed = stored.saturating_add(self.extra_bytes(n, stored, channels));
        if needed <= limit {
            return Ok(());
        }
        // What would be refused next is no advice.
        let advice = if stored <= limit {
            "or gauss-seidel, which needs no second matrix"
        } else {
            "or a solver that shoots, which needs no matrix"
        };
        Err(self.too_large(n, needed, limit, advice))
    }

    /// Why the matrices do not fit: if not even what the solver takes besides them does, that is what is told.
    pub(crate) fn refusal(
        self,
        matrices: RadiosityError,
        n: usize,
        channels: usize,
        limit: usize,
    ) -> RadiosityError {
        let alone = self.extra_bytes(n, 0, channels);
        if self != Self::Gauss || alone <= limit {
            // The others take next to nothing besides, or as much as the matrices.
            return matrices;
        }
        self.too_large(
            n,
            alone,
            limit,
            "or a solver that shoots, which needs no matrix",
        )
    }

    fn too_large(self, n: usize, needed: usize, limit: usize, advice: &str) -> RadiosityError {
        RadiosityError::Option(format!(
            "solver {} on {n} patches takes about {} MiB, {} MiB are allowed; use at most {} patches, {advice}",
            self.name(),
            (needed >> 20) + 1,
            limit >> 20,
            fitting(n, needed, limit),
        ))
    }
}

/// How many patches fit a memory limit if n take `needed` bytes, growing with the square.
pub(crate) fn fitting(n: usize, needed: usize, limit: usize) -> usize {
    let share = limit as f64 / needed.max(1) as f64;
    let most = n as f64 * share.sqrt();
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "between 0 and n"
    )]
    let most = most as usize;
    // Two digits: the mesh comes only near to a wanted number.
    let unit = 10_usize.pow(most.max(1).ilog10().saturating_sub(1));
    most / unit * unit
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
        kind.refuse_memory(n, matrix.entries().bytes(), 1, 2 << 30)?;
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
        let matrices = core::slice::from_ref(self.matrix.entries());
        let channels = core::slice::from_mut(&mut self.channel);
        let system = System::new(matrices, self.matrix.areas(), channels);
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
        self.system().0.residuals().remove(0)
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
