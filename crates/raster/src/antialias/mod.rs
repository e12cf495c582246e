//! Antialiasing: pictures without stairs, moiré and parts that come and go.
//!
//! A picture `(x, y) -> colour` ([`Picture`]) becomes pixels in one of two ways.
//!
//! * *Postfiltering*: it is sampled more finely than it is shown, on a regular or a jittered grid ([`Pattern`]), and the
//!   samples are weighted ([`Filter`]). [`render`] does this for any picture; a [`Supersampler`] says which samples a band
//!   of rows needs and combines them, for programs that find their samples in another way.
//! * *Prefiltering*: what is drawn is known as an outline, and the area of it in each pixel is computed.
//!
//! An [`Antialiasing`] is a pattern, a factor and a filter, and has a name: `4x4`, `4x4:bartlett`,
//! `3x3-jittered:mitchell`.
//!
//! ```
//! use hemicube_raster::Rgb;
//! use hemicube_raster::antialias::{Antialiasing, render};
//!
//! let disc = |x: f64, y: f64| match (x - 8.0).hypot(y - 8.0) < 6.0 {
//!     true => Rgb::WHITE,
//!     false => Rgb::BLACK,
//! };
//! let antialiasing: Antialiasing = "4x4:bartlett".parse()?;
//! let image = render(&disc, (16, 16), antialiasing);
//! assert_eq!(*image.pixel(8, 8), Rgb::WHITE);
//! # Ok::<(), hemicube_raster::antialias::AntialiasingError>(())
//! ```

mod filter;
mod name;
mod pattern;
mod picture;
mod supersample;

pub use filter::Filter;
pub use name::AntialiasingError;
pub use pattern::Pattern;
pub use picture::{Picture, render};
pub use supersample::{Supersampler, Value};

/// Samples per pixel in each direction, from 1 to [`Factor::MAX`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Factor(usize);

impl Factor {
    /// The largest factor: 1024 samples in a pixel.
    pub const MAX: usize = 32;

    /// One sample per pixel.
    pub const ONE: Self = Self(1);

    /// A factor; `None` if it is 0 or above [`Self::MAX`].
    pub const fn new(factor: usize) -> Option<Self> {
        if 1 <= factor && factor <= Self::MAX {
            Some(Self(factor))
        } else {
            None
        }
    }

    /// The number.
    pub const fn get(self) -> usize {
        self.0
    }
}

/// How a picture is sampled and filtered.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Antialiasing {
    /// Where the samples lie. Default value: `Pattern::Regular`.
    pub pattern: Pattern,
    /// Samples per pixel in each direction. Default value: 4.
    pub factor: Factor,
    /// How they are weighted. Default value: `Filter::for_factor`, 7x7 taps.
    pub filter: Filter,
}

impl Default for Antialiasing {
    fn default() -> Self {
        let factor = Factor(4);
        Self::regular(factor).with_filter(Filter::for_factor(factor))
    }
}

impl Antialiasing {
    /// One sample in the middle of each pixel.
    pub const NONE: Self = Self::regular(Factor::ONE);

    /// A regular grid of samples, all of the same weight.
    pub const fn regular(factor: Factor) -> Self {
        Self {
            pattern: Pattern::Regular,
            factor,
            filter: Filter::Box,
        }
    }

    /// The same with another filter.
    #[must_use]
    pub const fn with_filter(mut self, filter: Filter) -> Self {
        self.filter = filter;
        self
    }

    /// The same with another pattern.
    #[must_use]
    pub const fn with_pattern(mut self, pattern: Pattern) -> Self {
        self.pattern = pattern;
        self
    }
}
