//! Constructive solid geometry: solids combined by set operations, and a ray tracer that shows them.
//!
//! [`Solid`] is a primitive (sphere, cuboid, cylinder, cone, torus, half-space) or the union `a | b`, intersection
//! `a & b`, difference `a - b` or complement `!a` of others. A ray meets it in spans, which combine as the solids do;
//! [`Scene`] and [`View`] draw what is seen, with shadows, highlights, mirrors and procedural [`Pattern`]s.
//!
//! ```
//! use glam::DVec3;
//! use hemicube_csg::{Camera, Light, Material, Pattern, Scene, Solid, View};
//! use hemicube_raster::Rgb;
//! use hemicube_raster::antialias::Antialiasing;
//!
//! # fn main() -> Result<(), hemicube_csg::CsgError> {
//! let red = Material::matte(Pattern::plain(Rgb::new(0.7, 0.1, 0.1))?).with_highlight(0.1, 80.0)?;
//! let die = Solid::cuboid(DVec3::splat(-1.0), DVec3::splat(1.0))? & Solid::sphere(DVec3::ZERO, 1.4)?;
//! let sun = Light::distant(DVec3::new(1.0, 2.0, 3.0), Rgb::splat(2.0))?;
//! let scene = Scene::new([die.with_material(red)]).with_lights([sun]);
//! let camera = Camera::new(DVec3::new(3.0, 2.0, 4.0), DVec3::ZERO, 40.0)?;
//! let image = View { scene: &scene, camera: &camera, size: (64, 48) }.render(Antialiasing::NONE);
//! assert!(image.pixel(32, 24).r > image.pixel(32, 24).g, "red in the middle");
//! # Ok(())
//! # }
//! ```
//!
//! # Current state
//! Whatever cannot be is refused by the constructors ([`CsgError`]); behind them nothing panics. Solids thinner than
//! 1e-9 (relative to `1 +` the distance from the eye) vanish; see [`Solid::spans`]. Lamps have no extent and the sky's
//! light no shadows. Nothing is refracted. Set operations are walked by recursion: chains of many thousand operators
//! exhaust the stack, [`Solid::union`] does not.
#![forbid(unsafe_code)]

mod bounds;
mod camera;
mod error;
mod leaf;
mod light;
mod material;
mod noise;
mod pattern;
mod primitive;
mod ray;
mod root;
mod scene;
mod shapes;
mod solid;
mod span;
mod view;

pub use bounds::Bounds;
pub use camera::Camera;
pub use error::CsgError;
pub use light::{Light, Sky};
pub use material::Material;
pub use pattern::Pattern;
pub use ray::Ray;
pub use scene::{Hit, Scene};
pub use solid::Solid;
pub use view::View;

/// The smallest length that a constructor takes.
pub const SMALLEST: f64 = 1e-6;

/// The largest length and coordinate that a constructor takes.
pub const LARGEST: f64 = 1e9;
