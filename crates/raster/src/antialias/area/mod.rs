//! Prefiltering: the exact area of an outline in each pixel.
//!
//! The area is that of the winding rule ([`FillRule`]), also where contours cross, overlap or run twice. It is found row
//! by row without looking at any pixel that no edge touches:
//!
//! 1. Contours are cut into *chains* that run down.
//! 2. Of each row, the chains in it are put in order from left to right. Where they do not overlap in x, the winding number
//!    on both sides of each is known; where they do, the row is cut at corners and crossings until they are in order.
//!    An edge with the same side of the rule to its left and right is dropped, all others count up or down by 1. Of rows in
//!    which no edge begins, ends or crosses another one this is done once for all of them.
//! 3. The coverage of a pixel is the sum of what the remaining edges have to their right in it (signed areas, as in the
//!    rasterisers of fonts), eight pixels at once.
//! 4. Runs of pixels leave as spans ([`Spans`]): single values where edges are, one value for all pixels between them.
//!
//! Coordinates and edges are `f64`, sums are `f32`: coverage is exact to about 1e-6, up to a hundred thousand pixels
//! from the origin. A row in which very many corners or edges lie (more than 2^18 of one times the other) is too
//! much to order; there, coverage is the winding number's mean folded by the rule, which is exact but for pixels in which
//! areas of different winding numbers meet.
//!
//! ```
//! use glam::DVec2;
//! use hemicube_raster::antialias::area::{FillRule, Outline, Rasterizer};
//! use hemicube_raster::{Image, Rgb};
//!
//! let mut image = Image::filled(64, 64, Rgb::BLACK);
//! let disc = Outline::circle(DVec2::new(32.0, 32.0), 20.0);
//! Rasterizer::new(64, 64).fill(&disc, FillRule::NonZero, &mut image, Rgb::WHITE, 1.0);
//! let light: f32 = image.pixels().iter().map(|pixel| pixel.r).sum();
//! assert!((light - core::f32::consts::PI * 400.0).abs() < 0.01);
//! ```

mod accumulate;
mod blend;
mod chain;
mod outline;
mod paint;
mod rasterizer;
mod winding;

pub use blend::{Blend, Pixel, mask, mask8};
pub use outline::Outline;
pub use paint::{Area, paint};
pub use rasterizer::{Rasterizer, Spans};

/// Which points lie inside of contours.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum FillRule {
    /// Those around which the contours turn at least once, counted with sign.
    #[default]
    NonZero,
    /// Those from which a ray crosses the contours an odd number of times.
    EvenOdd,
}

impl FillRule {
    /// Whether a point of a winding number lies inside.
    fn is_inside(self, winding: i32) -> bool {
        match self {
            Self::NonZero => winding != 0,
            Self::EvenOdd => winding & 1 != 0,
        }
    }

    /// Coverage from the mean winding number of a pixel: right where the number is the same all over the pixel, and where
    /// only two numbers meet of which one is 0 and the other one 1 or -1.
    fn fold(self, mean: f32) -> f32 {
        match self {
            Self::NonZero => mean.abs().min(1.0),
            Self::EvenOdd => {
                let rest = mean.abs() % 2.0;
                rest.min(2.0 - rest)
            }
        }
    }
}
