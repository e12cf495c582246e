//! A scene through a camera, as a picture.

use crate::camera::Camera;
use crate::scene::Scene;
use hemicube_raster::antialias::{Antialiasing, Picture, render};
use hemicube_raster::{Image, Rgb};

/// What a scene looks like through a camera: a picture that is known at each of its points.
#[derive(Debug, Clone, Copy)]
pub struct View<'a> {
    /// What is seen.
    pub scene: &'a Scene,
    /// From where.
    pub camera: &'a Camera,
    /// Width and height in pixels.
    pub size: (usize, usize),
}

impl View<'_> {
    /// The picture in pixels, made by all threads; the same bits on any number of them.
    pub fn render(&self, antialiasing: Antialiasing) -> Image<Rgb> {
        render(self, self.size, antialiasing)
    }
}

/// Radiance at a point.
impl Picture for View<'_> {
    fn color(&self, x: f64, y: f64) -> Rgb {
        let (width, height) = self.size;
        self.scene.radiance(&self.camera.ray(x, y, width, height))
    }
}
