//! What the user gives: meshes, materials, lights, cameras, and the files they come from.
//!
//! A [`Scene`] is plain data in world units, right-handed, +Y up. It comes from a file ([`open()`]), from the built-in
//! collection ([`builtin`]) or is filled in by hand; [`SceneOptions`] adjust it (light, reflectance, sides, units);
//! [`Scene::check`] is the door behind which every index is in range and every number finite.
//!
//! # Current state
//! glTF 2.0, OBJ, STL and View3D's `.vs3` come in; see [`gltf`], [`obj`], [`stl`] and [`vs3`] for what of them is read. Skins, morph targets and animations
//! are not: a mesh is taken in its rest pose, which the import report says. Roughness, reliefs (normal and height maps) and
//! tangents are read for pictures; clear coat, occlusion and other layers are not.
#![forbid(unsafe_code)]

pub mod builtin;
pub mod camera;
mod error;
pub mod gltf;
pub mod light;
pub mod material;
pub mod mesh;
pub mod obj;
pub mod open;
pub mod options;
pub mod report;
pub mod scene;
pub mod stl;
pub mod surface;
pub mod texture;
pub mod vs3;

pub use camera::{Camera, FisheyeMapping, Projection};
pub use error::SceneError;
pub use light::{Light, LightKind};
pub use material::{AlphaMode, Material, Relief, ReliefKind, TextureSlot};
pub use mesh::{Face, Instance, Mesh};
pub use open::{open, open_bytes, open_path};
pub use options::{MetalsAs, SceneOptions};
pub use report::{ImportReport, Warning};
pub use scene::{Mask, Scene, Units, ViewFactorRequest};
pub use surface::SurfaceSample;
pub use texture::{Magnify, Minify, Texture, TextureImage, TextureUse, Wrap};
