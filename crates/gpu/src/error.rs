//! Why the GPU cannot do something.

/// Why the GPU cannot do something; one line: what, where, how to mend it. The CPU can do it instead.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum GpuError {
    /// No adapter is there, or none fits.
    #[error("no GPU: {0}")]
    NoAdapter(String),
    /// The driver gave no device.
    #[error("GPU {adapter}: no device ({why})")]
    NoDevice {
        /// The adapter's name.
        adapter: String,
        /// In the driver's words.
        why: String,
    },
    /// Something is larger than the adapter allows.
    #[error(
        "GPU {adapter}: {what} need {needed}, the adapter allows {allowed}; use fewer, or the CPU"
    )]
    Limit {
        /// The adapter's name.
        adapter: String,
        /// What does not fit.
        what: String,
        /// With its unit.
        needed: String,
        /// With its unit.
        allowed: String,
    },
    /// The device's memory is exhausted.
    #[error("GPU {adapter}: out of memory ({why})")]
    OutOfMemory {
        /// The adapter's name.
        adapter: String,
        /// In the driver's words.
        why: String,
    },
    /// The device went away while it worked.
    #[error("GPU {adapter}: lost ({why})")]
    Lost {
        /// The adapter's name.
        adapter: String,
        /// In the driver's words.
        why: String,
    },
    /// An option out of its range.
    #[error("{0}")]
    Option(String),
}
