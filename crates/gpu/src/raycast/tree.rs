//! The tree that a shader walks.

use crate::buffer::filled;
use crate::context::Context;
use crate::error::GpuError;
use glam::Vec3A;
use hemicube_shaders::raycast as twins;
use obvhs::BvhBuildParams;
use obvhs::cwbvh::builder::build_cwbvh;
use obvhs::triangle::Triangle;
use std::time::Duration;
use wgpu::{BindingResource, Buffer, BufferUsages};

/// An eight-wide compressed tree and its triangles, in its order.
#[derive(Debug)]
pub(super) struct Tree {
    nodes: Buffer,
    triangles: Buffer,
}

impl Tree {
    pub(super) fn new(
        context: &Context,
        triangles: &[twins::RayTriangle],
    ) -> Result<Self, GpuError> {
        let largest = context.limits.max_storage_buffer_binding_size;
        let bytes = size_of_val(triangles) as u64;
        context.allow("elements", bytes, largest, "bytes")?;
        let boxes: Vec<Triangle> = triangles
            .iter()
            .map(|t| {
                let [v0, v1, v2] = [t.a, t.b, t.c].map(Vec3A::from);
                Triangle { v0, v1, v2 }
            })
            .collect();
        let params = BvhBuildParams::medium_build();
        let tree = build_cwbvh(&boxes, params, &mut Duration::default());
        let order = tree.primitive_indices.iter();
        let sorted: Vec<twins::RayTriangle> = order.map(|&i| triangles[i as usize]).collect();
        let words: &[u8] = bytemuck::cast_slice(&tree.nodes);
        let device = &context.device;
        Ok(Self {
            nodes: filled(device, "tree", words, BufferUsages::STORAGE),
            triangles: filled(device, "triangles", &sorted, BufferUsages::STORAGE),
        })
    }

    pub(super) fn bindings(&self) -> [BindingResource<'_>; 2] {
        [&self.nodes, &self.triangles].map(Buffer::as_entire_binding)
    }
}
