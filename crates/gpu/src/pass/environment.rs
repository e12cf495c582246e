//! Surfaces that mirror what is around them, by environment maps.

use crate::buffer::{bind, filled, layout, storage, uniform};
use crate::context::Context;
use crate::pass::lit::SurfacePass;
use crate::pass::map::DeviceMap;
use glam::Vec3;
use hemicube_render::{MirrorSite, split_sum_table};
use hemicube_shaders::surface as twins;
use wgpu::{BindGroup, BindGroupLayout, BindingResource, Buffer, BufferUsages, ShaderStages};

/// How a mirror's map is looked up.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Lookup {
    /// By the direction from which a mirror shows light to the eye (Blinn and Newell 1976).
    #[default]
    Reflection,
    /// By the surface's normal: what lies before each point, the same from everywhere.
    Normal,
}

/// Surfaces that mirror.
#[derive(Debug)]
pub(crate) struct EnvironmentPass {
    pub(crate) pipelines: SurfacePass,
    layout: BindGroupLayout,
    /// How much of a uniform environment rough surfaces mirror.
    split_sums: Buffer,
}

impl EnvironmentPass {
    pub(crate) fn new(
        context: &Context,
        scene: &BindGroupLayout,
        textures: &BindGroupLayout,
        reliefs: &BindGroupLayout,
    ) -> Self {
        let [cube, flat, sampler] = DeviceMap::types();
        let types = [uniform(false), cube, flat, sampler, storage(true)];
        let device = &context.device;
        let layout = layout(device, "mirror", ShaderStages::FRAGMENT, &types);
        let layouts = [scene, textures, reliefs, &layout];
        let table = split_sum_table().as_flattened();
        Self {
            pipelines: SurfacePass::new("mirroring surfaces", &twins::ENVIRONMENT, &layouts),
            split_sums: filled(device, "mirrored shares", table, BufferUsages::STORAGE),
            layout,
        }
    }

    /// A mirror whose map was taken at a site; without one everything is far away.
    pub(crate) fn bind(
        &self,
        context: &Context,
        map: &DeviceMap,
        site: Option<&MirrorSite>,
        lookup: Lookup,
    ) -> BindGroup {
        let device = &context.device;
        let params = params(map, site, lookup);
        let params = filled(device, "mirror", &[params], BufferUsages::UNIFORM);
        let resources = [
            params.as_entire_binding(),
            BindingResource::TextureView(&map.cube),
            BindingResource::TextureView(&map.flat),
            BindingResource::Sampler(&map.sampler),
            self.split_sums.as_entire_binding(),
        ];
        bind(device, "mirror", &self.layout, &resources)
    }
}

fn params(map: &DeviceMap, site: Option<&MirrorSite>, lookup: Lookup) -> twins::Mirror {
    let room = site.and_then(|site| site.room);
    let (low, high) = room.unwrap_or((Vec3::ZERO, Vec3::ZERO));
    twins::Mirror {
        position: site.map_or(Vec3::ZERO, |site| site.position).to_array(),
        scale: map.scale,
        low: low.to_array(),
        has_room: u32::from(room.is_some()),
        high: high.to_array(),
        projection: map.projection,
        levels: map.levels,
        by_normal: u32::from(lookup == Lookup::Normal),
        padding_0: 0,
        padding_1: 0,
    }
}
