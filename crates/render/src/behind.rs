//! What is behind everything: one radiance, or a picture of the surroundings.

use crate::lens::CameraRay;
use hemicube_raster::Rgb;
use hemicube_raster::environment::EnvironmentPyramid;

/// Radiance where no surface is.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Behind<'a> {
    /// The same everywhere.
    Uniform(Rgb),
    /// From a map, filtered over what the sample sees of it.
    Map(&'a EnvironmentPyramid),
}

impl Behind<'_> {
    /// Along a ray, for samples of this distance in pixels.
    pub fn radiance(&self, ray: Option<CameraRay>, spacing: f64) -> Rgb {
        match (self, ray) {
            (Self::Uniform(radiance), _) => *radiance,
            (Self::Map(_), None) => Rgb::BLACK,
            (Self::Map(map), Some(ray)) => {
                let length = ray.direction.length();
                let step = |k: usize| (ray.direction_steps[k] * (spacing / length)).as_vec3();
                let direction = (ray.direction / length).as_vec3();
                map.radiance_by_derivatives(direction, step(0), step(1))
            }
        }
    }
}
