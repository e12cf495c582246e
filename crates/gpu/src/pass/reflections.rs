//! What mirroring objects show, taken on the device.

use crate::context::Context;
use crate::error::GpuError;
use crate::pass::cube::Cube;
use crate::pass::draw::{Picture, Samples, exposure_of};
use crate::pass::environment::Lookup;
use crate::pass::map::DeviceMap;
use crate::pass::options::{DrawOptions, Smoothing};
use crate::pass::passes::Passes;
use crate::pass::tile::Tile;
use crate::pass::tonemap::Tones;
use crate::pass::walkthrough::{Walkthrough, locked};
use hemicube_radiosity::Solution;
use hemicube_raster::environment::EnvironmentMap;
use hemicube_render::{MirrorPlan, MirrorSite, Reflections, face_camera};
use wgpu::{BindGroup, CommandEncoder};

/// Where the maps of mirrors come from.
#[derive(Debug)]
pub(crate) enum Maps {
    /// Each is taken from its object's place.
    Taken(Vec<Cube>),
    /// All show the same.
    One(DeviceMap),
}

/// Mirrors and their maps.
#[derive(Debug)]
pub(crate) struct Mirrors {
    pub(crate) plan: MirrorPlan,
    pub(crate) maps: Maps,
    pub(crate) lookup: Lookup,
}

impl Mirrors {
    /// Mirrors with a cube each.
    pub(crate) fn taken(context: &Context, plan: MirrorPlan, side: usize, lookup: Lookup) -> Self {
        let cubes = plan.sites.iter().map(|_| Cube::new(context, side));
        Self {
            maps: Maps::Taken(cubes.collect()),
            plan,
            lookup,
        }
    }

    /// Bindings of all maps; in taken ones a stored 1 is radiance `scale`.
    pub(crate) fn bind(&self, context: &Context, passes: &Passes, scale: f32) -> Vec<BindGroup> {
        let bind = |map: &DeviceMap, site: Option<&MirrorSite>| {
            passes.environment.bind(context, map, site, self.lookup)
        };
        match &self.maps {
            Maps::One(map) => self.plan.sites.iter().map(|_| bind(map, None)).collect(),
            Maps::Taken(cubes) => {
                let sites = self.plan.sites.iter().zip(cubes);
                sites
                    .map(|(site, cube)| bind(&cube.map(context, scale), Some(site)))
                    .collect()
            }
        }
    }
}

impl Walkthrough {
    /// Lets objects of the solution's scene mirror what is around them, in maps that [`Self::capture`] takes. Gives the
    /// number of these.
    ///
    /// # Errors
    /// A name that nothing has, maps of an impossible size.
    pub fn set_reflections(
        &mut self,
        solution: &Solution,
        wanted: &Reflections,
        lookup: Lookup,
    ) -> Result<usize, GpuError> {
        let plan = planned(solution, wanted)?;
        let count = plan.sites.len();
        let mirrors = Mirrors::taken(&self.context, plan, wanted.resolution, lookup);
        self.surfaces
            .set_mirrors(Vec::new(), &mirrors.plan.of_parts);
        self.mirrors = Some(mirrors);
        Ok(count)
    }

    /// Lets objects of the solution's scene mirror one map that is far away, by its levels of roughness: the first is that of
    /// a mirror, each is half as large as the one before, the last is that of roughness 1.
    ///
    /// # Errors
    /// A name that nothing has, levels of other sizes.
    pub fn set_reflected_map(
        &mut self,
        solution: &Solution,
        wanted: &Reflections,
        levels: &[EnvironmentMap],
        lookup: Lookup,
    ) -> Result<(), GpuError> {
        let mirrors = Mirrors {
            plan: planned(solution, wanted)?,
            maps: Maps::One(DeviceMap::new(&self.context, levels)?),
            lookup,
        };
        let bound = mirrors.bind(&self.context, &locked(&self.passes), 1.0);
        self.surfaces.set_mirrors(bound, &mirrors.plan.of_parts);
        self.mirrors = Some(mirrors);
        Ok(())
    }

    /// Takes the maps of all mirrors, as the scene is lit now: six pictures from the middle of each object, without the
    /// object, blurred by roughness. They are used by the next picture; nothing comes to the CPU. Light is kept in 16 bits,
    /// multiplied by `exposure`, which should be that of the pictures.
    ///
    /// # Errors
    /// The maps do not fit the adapter's limits.
    pub fn capture(&mut self, encoder: &mut CommandEncoder, exposure: f32) -> Result<(), GpuError> {
        let Some(mirrors) = self.mirrors.take() else {
            return Ok(());
        };
        let options = DrawOptions::default()
            .with_exposure(exposure)
            .with_smoothing(Smoothing::None)
            .with_reflections(false);
        let taken = self.take(encoder, &mirrors, &options);
        let scale = 1.0 / exposure_of(&options);
        let bound = mirrors.bind(&self.context, &locked(&self.passes), scale);
        self.surfaces.set_mirrors(bound, &mirrors.plan.of_parts);
        self.mirrors = Some(mirrors);
        taken
    }

    fn take(
        &mut self,
        encoder: &mut CommandEncoder,
        mirrors: &Mirrors,
        options: &DrawOptions,
    ) -> Result<(), GpuError> {
        let Maps::Taken(cubes) = &mirrors.maps else {
            return Ok(());
        };
        let passes = self.passes.clone();
        let mut passes = locked(&passes);
        self.surfaces.light.update(encoder, &passes.light);
        for (site, cube) in mirrors.plan.sites.iter().zip(cubes) {
            for face in 0..6 {
                let camera = face_camera(site.position, face);
                let size = [2 * cube.side; 2];
                let samples = Samples::new(Tile::all(size), Smoothing::None)?;
                let view = self.view(&camera, &samples, options)?;
                let at = self.frame(size, samples.pixels())?;
                let picture = Picture {
                    view,
                    camera: &camera,
                    aspect: 1.0,
                    samples: &samples,
                    options,
                    tones: Tones::Linear,
                    without: Some(site.instance),
                };
                self.draw_frame(encoder, &mut passes, at, &picture);
                let (context, seen) = (&self.context, &self.frames[at].color);
                let face = u32::try_from(face).expect("six");
                passes.cube.take_face(context, encoder, cube, face, seen);
            }
            passes.cube.blur(&self.context, encoder, cube);
        }
        Ok(())
    }
}

/// Which objects mirror.
fn planned(solution: &Solution, wanted: &Reflections) -> Result<MirrorPlan, GpuError> {
    MirrorPlan::new(solution, wanted).map_err(|e| GpuError::Option(e.to_string()))
}
