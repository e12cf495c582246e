//! Options that only some ways to form factors follow.

use hemicube::radiosity::form_factor::FormFactorKind as Kind;

/// A way to form factors, and which of the options of the ways were given.
#[derive(Debug, Clone, Copy)]
pub struct MethodGiven {
    /// The way in use.
    pub kind: Kind,
    /// Its name; that of a GPU's way is another than its twin's.
    pub name: &'static str,
    /// `--error`
    pub error: bool,
    /// `--rays`
    pub rays: bool,
    /// `--shot-rays`
    pub shot_rays: bool,
    /// `--hemicube-resolution`
    pub resolution: bool,
}

impl MethodGiven {
    /// What to tell of the first option that was given for another way than the one in use, which `chosen_by` chooses.
    pub fn misplaced(&self, chosen_by: &str) -> Option<String> {
        let all: [(bool, &str, &[Kind]); 4] = [
            (self.error, "--error", &[Kind::Analytic]),
            (self.rays, "--rays", &[Kind::RayCast, Kind::Nusselt]),
            (self.shot_rays, "--shot-rays", &[Kind::RayCast]),
            (
                self.resolution,
                "--hemicube-resolution",
                &[Kind::Hemicube, Kind::CubicTetrahedron, Kind::SinglePlane],
            ),
        ];
        let is_misplaced =
            |(given, _, ways): &&(bool, &str, &[Kind])| *given && !ways.contains(&self.kind);
        let (_, option, ways) = all.iter().find(is_misplaced)?;
        let names: Vec<&str> = ways.iter().map(|way| way.name()).collect();
        Some(format!(
            "{option} is for {chosen_by} {}, not {}; leave one of them out",
            names.join(" or "),
            self.name
        ))
    }
}
