//! Why a picture could not be made.

use crate::options::{MAX_SIDE, RenderOptions};
use hemicube_raster::antialias::Antialiasing;
use hemicube_raster::triangle::Viewport;

/// A picture could not be made; each message is one line.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RenderError {
    /// A side is 0 or too long.
    #[error("picture of {width} x {height} pixels: each side must be from 1 to {MAX_SIDE}")]
    Size {
        /// Pixels in a row.
        width: usize,
        /// Rows.
        height: usize,
    },
    /// Both sides are long.
    #[error(
        "picture of {width} x {height} pixels: at most {max} fit, 7680 x 4320 for example; make a side smaller",
        max = RenderOptions::MAX_PIXELS
    )]
    Pixels {
        /// Pixels in a row.
        width: usize,
        /// Rows.
        height: usize,
    },
    /// The supersampled picture is larger than the rasteriser's.
    #[error(
        "{side} pixels with antialias {antialias}: a side has more than {max} samples; use fewer for each pixel or a smaller picture",
        max = Viewport::MAX_SIDE
    )]
    Samples {
        /// Pixels of the longer side.
        side: usize,
        /// Samples of a pixel.
        antialias: Antialiasing,
    },
    /// Gathering without rays.
    #[error("gather rays 0: a gathered picture needs at least 1, better 64")]
    GatherRays,
    /// Maps of mirrors too small or too large.
    #[error("maps of mirrors of {0} x {0} pixels: a side must be from 8 to 1024")]
    Resolution(usize),
    /// A name of what is to mirror that nothing has.
    #[error("no material or node is called '{0}'; `hemicube info` lists the names")]
    Mirror(String),
    /// A background that is no light.
    #[error("background {0:?} is negative or not finite")]
    Background([f32; 3]),
    /// A camera that cannot see; the text says why.
    #[error("camera '{name}': {problem}")]
    Camera {
        /// The camera's name.
        name: String,
        /// What is wrong with it.
        problem: &'static str,
    },
}
