//! Anything that has a colour at each point, and its way to pixels.

use super::{Antialiasing, Supersampler};
use crate::{Image, Rgb};

/// A colour at each point of the plane: the one thing that sampling asks of a picture.
///
/// The unit is the pixel of the image to be made, x to the right and y down, the origin in its upper left corner; filters
/// that reach beyond a pixel ask for points outside of the image too. Functions and closures are pictures.
pub trait Picture: Sync {
    /// The colour at a point.
    fn color(&self, x: f64, y: f64) -> Rgb;
}

impl<F: Fn(f64, f64) -> Rgb + Sync> Picture for F {
    fn color(&self, x: f64, y: f64) -> Rgb {
        self(x, y)
    }
}

/// An image of so many pixels across and down of a picture, made by all threads; the same bits on any number of them.
pub fn render(
    picture: &(impl Picture + ?Sized),
    (width, height): (usize, usize),
    antialiasing: Antialiasing,
) -> Image<Rgb> {
    Supersampler::new(width, height, antialiasing).render(|x, y| picture.color(x, y))
}
