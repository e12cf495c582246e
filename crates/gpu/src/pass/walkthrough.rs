//! A lit scene on the device, drawn from any camera.

use crate::context::Context;
use crate::error::GpuError;
use crate::pass::map::DeviceMap;
use crate::pass::passes::Passes;
use crate::pass::reflections::Mirrors;
use crate::pass::surfaces::Surfaces;
use crate::pass::target::Frame;
use crate::shooting::DeviceLight;
use core::fmt;
use hemicube_radiosity::solve::ambient::ambient_irradiance;
use hemicube_radiosity::{Solution, SolverKind};
use hemicube_raster::Rgb;
use hemicube_raster::environment::{EnvironmentMap, EnvironmentPyramid};
use hemicube_render::tilt_fits;
use hemicube_scene::Scene;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// A lit scene on the device, drawn from any camera as often as one likes.
///
/// Geometry and materials stay; light can be replaced before every picture, by that of a [`Solution`] or by that which
/// [`GpuShooting`](crate::GpuShooting) keeps on the device.
pub struct Walkthrough {
    pub(super) context: Arc<Context>,
    pub(super) passes: Arc<Mutex<Passes>>,
    pub(super) surfaces: Surfaces,
    /// Radiance of the sky as dimmed.
    pub(super) sky: Rgb,
    /// What is behind everything, in place of the sky.
    pub(super) surroundings: Option<DeviceMap>,
    pub(super) mirrors: Option<Mirrors>,
    pub(super) frames: Vec<Frame>,
}

impl fmt::Debug for Walkthrough {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Walkthrough")
            .field("context", &self.context)
            .field("triangles", &(self.surfaces.index_count() / 3))
            .finish_non_exhaustive()
    }
}

impl Walkthrough {
    /// Puts a solution on the device.
    ///
    /// # Errors
    /// A mesh that does not fit the adapter's limits or its memory.
    pub fn new(context: Arc<Context>, solution: &Solution) -> Result<Self, GpuError> {
        let passes = Arc::new(Mutex::new(Passes::new(&context)));
        Self::with_passes(context, passes, solution)
    }

    /// Another scene on the same device, with the same pipelines.
    ///
    /// # Errors
    /// A mesh that does not fit the adapter's limits.
    pub fn another(&self, solution: &Solution) -> Result<Self, GpuError> {
        Self::with_passes(self.context.clone(), self.passes.clone(), solution)
    }

    fn with_passes(
        context: Arc<Context>,
        passes: Arc<Mutex<Passes>>,
        solution: &Solution,
    ) -> Result<Self, GpuError> {
        let surfaces = context.guard(|| Surfaces::new(&context, &locked(&passes), solution))?;
        let mut walkthrough = Self {
            sky: Rgb::BLACK,
            surroundings: None,
            mirrors: None,
            frames: Vec::new(),
            context,
            passes,
            surfaces,
        };
        walkthrough.set_light(solution)?;
        Ok(walkthrough)
    }

    /// The device that it lives on.
    pub fn context(&self) -> &Arc<Context> {
        &self.context
    }

    /// Shows the light of a solution from now on, with its dims; solutions of ambient shooting with their estimate of light
    /// still to come.
    ///
    /// # Errors
    /// The solution has other elements or groups than the one that this was made of.
    pub fn set_light(&mut self, solution: &Solution) -> Result<(), GpuError> {
        let light = &mut self.surfaces.light;
        light.upload(&self.context, &locked(&self.passes).light, solution)?;
        let is_ambient = solution.provenance.solver == SolverKind::AmbientShooting.name();
        self.set_ambient(if is_ambient {
            ambient_irradiance(solution)
        } else {
            Rgb::BLACK
        });
        self.sky = sky(solution);
        Ok(())
    }

    /// Irradiance that is added everywhere: an estimate of light still to come.
    pub fn set_ambient(&mut self, irradiance: Rgb) {
        self.surfaces.light.set_extra(&self.context, irradiance);
    }

    /// Shows the light that a solver keeps on this device, without a way over the CPU: as it is when the next picture is
    /// drawn. To be called again after each of the solver's steps. Dims stay as they were ([`Self::set_dims`]).
    ///
    /// # Errors
    /// It is the light of another mesh, or on another device.
    pub fn set_light_of(&mut self, light: &DeviceLight) -> Result<(), GpuError> {
        let buffer = light.buffer_on(&self.context)?;
        let shown = &mut self.surfaces.light;
        shown.check(light.size())?;
        shown.read_from(&self.context, &locked(&self.passes).light, buffer);
        Ok(())
    }

    /// Dims groups of luminaires, and what they light, as a solution does, whatever its light is.
    ///
    /// # Errors
    /// The solution has other elements or groups than the one that this was made of.
    pub fn set_dims(&mut self, solution: &Solution) -> Result<(), GpuError> {
        self.surfaces.light.upload_dims(&self.context, solution)?;
        self.sky = sky(solution);
        Ok(())
    }

    /// Takes over the materials of a scene that has the same ones, with other colours or other light.
    ///
    /// # Errors
    /// The scene has another number of materials.
    pub fn set_materials(&mut self, scene: &Scene) -> Result<(), GpuError> {
        self.surfaces.set_materials(&self.context, scene)
    }

    /// Gathers light for the normals that reliefs turn, as it is in a solution; it takes seconds where much is bumpy. Until
    /// then bumps are lit as if by a uniform sky.
    pub fn gather_reliefs(&mut self, solution: &Solution) {
        let reliefs = &self.surfaces.reliefs;
        if !reliefs.mesh.vertices.is_empty() {
            reliefs.set(&self.context, &tilt_fits(solution, &reliefs.mesh.vertices));
        }
    }

    /// Shows a picture of the surroundings behind everything, in place of a uniform sky or background; none takes it away.
    ///
    /// # Errors
    /// A map that is larger than the adapter allows.
    pub fn set_surroundings(&mut self, map: Option<EnvironmentMap>) -> Result<(), GpuError> {
        let pyramid = map.map(EnvironmentPyramid::new);
        let levels = pyramid.as_ref().map(EnvironmentPyramid::levels);
        let map = levels.map(|levels| DeviceMap::new(&self.context, levels));
        self.surroundings = map.transpose()?;
        Ok(())
    }
}

/// The sky, dimmed with its group.
fn sky(solution: &Solution) -> Rgb {
    let dim = solution
        .groups()
        .last()
        .map_or(Rgb::WHITE, |group| group.dim);
    solution.mesh().scene().sky * dim
}

pub(super) fn locked(passes: &Mutex<Passes>) -> MutexGuard<'_, Passes> {
    // Pipelines are whole or not there at all.
    passes.lock().unwrap_or_else(PoisonError::into_inner)
}
