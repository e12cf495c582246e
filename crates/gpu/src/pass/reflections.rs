//! What mirroring objects show, taken on the device.

use crate::context::Context;
use crate::pass::cube::Cube;
use crate::pass::environment::Lookup;
use crate::pass::map::DeviceMap;
use crate::pass::passes::Passes;
use hemicube_render::{MirrorPlan, MirrorSite};
use wgpu::BindGroup;

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
