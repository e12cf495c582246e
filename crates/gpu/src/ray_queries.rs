//! Whether rays are cast by an adapter's own ray queries.

use crate::error::GpuError;
use wgpu::{Adapter, DeviceType, ExperimentalFeatures, Features};

/// Name of the environment variable that says when ray queries are used, where no option does: `never`, `auto` or
/// `always`.
pub const RAY_QUERY_VARIABLE: &str = "HEMICUBE_RAY_QUERIES";

/// When rays are cast by an adapter's own ray queries.
///
/// wgpu calls them an experiment: a bug in wgpu or in a driver may show there that its other checks would have caught. Rays
/// are the same with them and without, but for those that meet an edge.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum RayQueries {
    /// Never; a shader walks a tree.
    Never,
    /// Where the adapter has them and is no software: cards have circuits for them.
    #[default]
    Auto,
    /// Where the adapter has them.
    Always,
}

impl RayQueries {
    /// By its name: `never`, `auto` or `always`.
    ///
    /// # Errors
    /// It is none of these.
    pub fn named(name: &str) -> Result<Self, GpuError> {
        match name {
            "never" => Ok(Self::Never),
            "auto" => Ok(Self::Auto),
            "always" => Ok(Self::Always),
            other => Err(GpuError::Option(format!(
                "{RAY_QUERY_VARIABLE} is '{other}'; it can be never, auto or always"
            ))),
        }
    }

    /// As the environment says; [`Self::Auto`] where it says nothing.
    ///
    /// # Errors
    /// It says something else.
    pub fn of_environment() -> Result<Self, GpuError> {
        match std::env::var(RAY_QUERY_VARIABLE) {
            Ok(name) if !name.is_empty() => Self::named(&name),
            _ => Ok(Self::Auto),
        }
    }

    /// Whether they are used on an adapter.
    pub(crate) fn are_used(self, adapter: &Adapter) -> bool {
        let has = adapter
            .features()
            .contains(Features::EXPERIMENTAL_RAY_QUERY);
        let is_software = adapter.get_info().device_type == DeviceType::Cpu;
        match self {
            Self::Never => false,
            Self::Auto => has && !is_software,
            Self::Always => has,
        }
    }
}

/// What a device is asked for so that it has ray queries.
#[expect(
    unsafe_code,
    reason = "the only way to ask for them; the unsafe function says that somebody knows of the experiment"
)]
pub(crate) fn with_ray_queries(
    descriptor: wgpu::DeviceDescriptor<'static>,
) -> wgpu::DeviceDescriptor<'static> {
    wgpu::DeviceDescriptor {
        required_features: descriptor.required_features | Features::EXPERIMENTAL_RAY_QUERY,
        // SAFETY: nothing of the experiment is used but triangles that are built once from buffers of their size, and
        // queries of them; callers can turn it off, and wgpu hears of bugs.
        experimental_features: unsafe { ExperimentalFeatures::enabled() },
        ..descriptor
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_known_and_others_refused_in_words() {
        assert_eq!(RayQueries::named("never"), Ok(RayQueries::Never), "never");
        assert_eq!(RayQueries::named("auto"), Ok(RayQueries::Auto), "auto");
        assert_eq!(
            RayQueries::named("always"),
            Ok(RayQueries::Always),
            "always"
        );
        let error = RayQueries::named("on").expect_err("no such name");
        let told = error.to_string();
        assert!(told.contains("'on'") && told.contains("always"), "{told}");
    }
}
