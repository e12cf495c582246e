//! The shaders of Hemicube in plain WGSL, with the memory layouts that they share with Rust.
//!
//! A [`Shader`] is one file followed by the parts that it shares with others; WGSL does not mind the order, and line
//! numbers in messages stay right. [`all`] lists them for whoever wants to look at them, translate them or check them:
//! naga parses and validates every one in this crate's tests, without a GPU, and compares its structs and constants with
//! their Rust twins. [`memory`] says what a scene takes on a device.
#![forbid(unsafe_code)]

pub mod hemicube;
pub mod memory;
pub mod raycast;
pub mod shooting;
pub mod surface;
pub mod window;

/// A shader: name and source.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shader {
    /// Name of its file without the ending.
    pub name: &'static str,
    /// WGSL.
    pub source: &'static str,
}

/// A file of `wgsl/` followed by its shared parts.
macro_rules! shader {
    ($name:literal $(, $part:literal)*) => {
        $crate::Shader {
            name: $name,
            source: concat!(
                include_str!(concat!("../wgsl/", $name, ".wgsl"))
                $(, "\n", include_str!(concat!("../wgsl/", $part, ".wgsl")))*
            ),
        }
    };
}
pub(crate) use shader;

/// All shaders.
pub fn all() -> impl Iterator<Item = &'static Shader> {
    hemicube::SHADERS
        .iter()
        .chain(&shooting::SHADERS)
        .chain(&raycast::SHADERS)
        .chain(&surface::SHADERS)
        .chain(&window::SHADERS)
}
