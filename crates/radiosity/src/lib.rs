//! From a scene to a radiosity solution, on the CPU.
//!
//! A [`Scene`](hemicube_scene::Scene) becomes a [`PatchMesh`]; [`FormFactors`] fill rows between its nodes; a
//! [`Solver`] spreads light by them until little is unshot; the [`Solution`] is gathered at points ([`Gatherer`]),
//! drawn ([`DrawnMesh`]) and stored ([`export::lit_glb`]). [`solve()`] does all of it.
//!
//! ```
//! use hemicube_radiosity::{Quality, solve};
//! use hemicube_scene::builtin;
//! use std::sync::Arc;
//!
//! // A closed box that reflects half: radiosity is emission over one minus reflectance.
//! let scene = Arc::new(builtin::furnace_with(0.5, 1.0));
//! let solution = solve(scene, &Quality::Draft.into(), |_, _| true)?;
//! assert!((solution.element_radiosity(0).g - 2.0).abs() < 0.02, "B = E / (1 - ρ)");
//! # Ok::<(), hemicube_radiosity::RadiosityError>(())
//! ```
//!
//! # Current state
//! Rows of form factors come from closed forms and exact shadows ([`Analytic`](form_factor::Analytic)), rays
//! ([`RayCast`], which [`solve()`] uses by default), item buffers ([`form_factor::hemicube`], of three shapes), rays
//! through equal cells ([`form_factor::hemisphere`]) or exact factors of points ([`form_factor::nusselt_rows`]);
//! [`form_factor::estimate`] gives single factors with their standard errors. [`Shooting`] and overshooting
//! need no matrix; [`solve::on_matrix`] runs the others on a [`form_factor::matrix`]; [`form_factor::surfaces`] sums one over faces or
//! objects, with covers that lie on surfaces, and finds surfaces that lie in one place; [`export::view_factors`] writes it
//! for thermal models. [`Stochastic`] stores no factor at all: rays carry the light, their noise is told and can be checked
//! ([`Stochastic::check_noise`]); elements of a patch take each other's word for reflected light where nothing is close.
//! [`Hierarchical`] links clusters,
//! faces and parts of faces, as finely as the error that it estimates wants; light that it gathered over coarse links stays
//! as it is where a stored solution is resumed, and scenes of tens of thousands of small faces take it minutes to an error
//! of some percent (the steel mill 9 s to 20 %, the theatre 8 s to 70 %). What does not fit into memory is refused by a
//! sample of pairs, before rows are computed. Radiosity is constant on an element.
//!
//! Models are mended before they are cut ([`patch::clean`]). A number of elements is met within 5 %, where faces are fewer
//! ([`PatchOptions`]). Elements are cut where faces meet ([`patch::constraints`])
//! and, if asked, along the borders of shadows ([`patch::discontinuities`]); parts smaller than a quarter of an element
//! stay uncut, faces that cross in more than 2048 segments keep the first, a cell the first 32 (a warning counts those), and
//! round lamps and windows cast no lines. [`adaptive`] cuts elements where light varies, as long as they make the error of pictures. With ray-cast factors only new
//! elements ask for light, by pairs that are drawn, and patches keep theirs; with other ways to factors each round asks for
//! the rows of all patches, with rays and links it solves anew, so those take as long as solving once for every level.
//! Between vertices light is linear; at borders of surfaces it is extrapolated ([`vertex_light`]).
//!
//! Coordinates are f32: a scene more than a hundred times its size away from the origin loses percents. Light that is
//! not emitted by surfaces (sun, points) does not get more rays for its first reflection than other reflected light.
//! Functions behind the doors ([`solve()`], [`PatchMesh::build`]) panic only on indices that are not of the mesh.
#![forbid(unsafe_code)]

pub mod adaptive;
pub mod backend;
mod band_sum;
mod cast;
pub mod compare;
pub mod drawn;
mod error;
pub mod export;
pub mod form_factor;
pub mod gather;
pub mod job;
pub mod memory;
pub mod patch;
pub mod primary;
pub mod sampling;
mod sobol;
pub mod solution;
pub mod solve;
pub mod stop;
pub mod vertex_light;
pub mod visibility;

pub use adaptive::AdaptiveOptions;
pub use drawn::DrawnMesh;
pub use error::RadiosityError;
pub use form_factor::{FormFactors, RayCast, RayCastOptions, Row};
pub use gather::{GatherOptions, Gatherer};
pub use job::{
    Quality, SolveOptions, SolverKind, Way, resume, resume_on, resume_until, solve, solve_on,
    solve_until, unlit,
};
pub use patch::edit::MaterialEdit;
pub use patch::{NodeId, PatchMesh, PatchOptions};
pub use solution::{EnergyBalance, Grouping, Solution};
pub use solve::{
    Hierarchical, HierarchicalOptions, NoiseCheck, Order, Progress, Shooting, Solver, Stage,
    Stages, Stochastic, StochasticOptions,
};
pub use visibility::Visibility;

/// Index as the 32-bit number that arrays of ids hold.
fn index32(index: usize) -> u32 {
    u32::try_from(index).expect("a mesh has fewer than 2^32 elements")
}
