//! Options of the ways to form factors that run on a GPU.

use clap::Args;
use hemicube::radiosity::form_factor::FormFactorKind;

/// A way to form factors, by its name on the command line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FactorWay {
    /// One of the CPU's.
    Cpu(FormFactorKind),
    /// Hemicubes drawn by a GPU.
    Gpu,
    /// Rays cast by a GPU.
    GpuRayCast,
}

impl FactorWay {
    /// All of them.
    pub const ALL: [Self; FormFactorKind::ALL.len() + 2] = {
        let mut all = [Self::Gpu; FormFactorKind::ALL.len() + 2];
        let mut i = 0;
        while i < FormFactorKind::ALL.len() {
            all[i] = Self::Cpu(FormFactorKind::ALL[i]);
            i += 1;
        }
        all[i + 1] = Self::GpuRayCast;
        all
    };

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Cpu(kind) => kind.name(),
            Self::Gpu => "gpu",
            Self::GpuRayCast => "gpu-raycast",
        }
    }

    /// Which of the CPU's ways it is, or is the twin of.
    pub fn kind(self) -> FormFactorKind {
        match self {
            Self::Cpu(kind) => kind,
            Self::Gpu => FormFactorKind::Hemicube,
            Self::GpuRayCast => FormFactorKind::RayCast,
        }
    }

    /// Whether it runs on a GPU.
    pub fn uses_gpu(self) -> bool {
        !matches!(self, Self::Cpu(_))
    }

    /// The way that a solution says it was made by; what the CPU went on with is left out.
    pub fn of_solution(name: &str) -> Option<Self> {
        let first = name.split(',').next().unwrap_or_default();
        Self::ALL.into_iter().find(|way| way.name() == first)
    }
}

/// Which GPU, and whether it must be one.
#[derive(Debug, Clone, Default, Args)]
pub struct GpuArgs {
    /// GPU for gpu, gpu-raycast and --draw-on gpu, by a part of its name [default: HEMICUBE_ADAPTER, else the best]
    #[arg(long, value_name = "NAME")]
    pub adapter: Option<String>,
    /// Fail where gpu, gpu-raycast or --draw-on gpu finds no GPU or loses it, instead of going on with the CPU
    #[arg(long)]
    pub require_gpu: bool,
}

impl GpuArgs {
    /// The option that was given.
    pub fn given(&self) -> Option<&'static str> {
        match (&self.adapter, self.require_gpu) {
            (Some(_), _) => Some("--adapter"),
            (None, true) => Some("--require-gpu"),
            (None, false) => None,
        }
    }
}
