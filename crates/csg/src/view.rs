//! A scene through a camera, as a picture.

use crate::camera::Camera;
use crate::scene::Scene;
use hemicube_raster::{Image, Rgb};
use rayon::prelude::*;

/// A picture that is known at each of its points: what a scene looks like through a camera.
#[derive(Debug, Clone, Copy)]
pub struct View<'a> {
    /// What is seen.
    pub scene: &'a Scene,
    /// From where.
    pub camera: &'a Camera,
    /// Pixels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
}

impl View<'_> {
    /// Radiance at a point of the picture: x to the right, y down, pixel centres at halves.
    pub fn color(&self, x: f64, y: f64) -> Rgb {
        self.scene
            .radiance(&self.camera.ray(x, y, self.width, self.height))
    }

    /// The picture with one ray through the centre of each pixel, rows in parallel: edges are jagged, fine patterns alias.
    pub fn render(&self) -> Image<Rgb> {
        let row =
            |y: usize| (0..self.width).map(move |x| self.color(x as f64 + 0.5, y as f64 + 0.5));
        let pixels: Vec<Rgb> = (0..self.height)
            .into_par_iter()
            .flat_map_iter(row)
            .collect();
        Image::from_pixels(self.width, self.height, pixels).expect("one colour for each pixel")
    }
}
