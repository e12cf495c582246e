//! The adapter's own tree, for ray queries.
//!
//! What receives in front and what absorbs behind are instances of their own, so that one query finds the nearest front
//! and another whether something that absorbs is nearer, both without help from the shader on the way.

use crate::buffer::filled;
use crate::context::Context;
use crate::error::GpuError;
use crate::hemicube::count;
use hemicube_shaders::raycast as twins;
use wgpu::{
    AccelerationStructureFlags, AccelerationStructureGeometryFlags,
    AccelerationStructureUpdateMode, BindingResource, BindingType, Blas, BlasBuildEntry,
    BlasGeometries, BlasGeometrySizeDescriptors, BlasTriangleGeometry,
    BlasTriangleGeometrySizeDescriptor, Buffer, BufferUsages, CreateBlasDescriptor,
    CreateTlasDescriptor, Device, Tlas, TlasInstance, VertexFormat,
};

/// Instances of the tree.
const INSTANCES: u32 = 2;
/// Nothing is moved.
const IDENTITY: [f32; 12] = [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0];

/// The adapter's tree, and the elements of its triangles.
#[derive(Debug)]
pub(super) struct Queries {
    tree: Tlas,
    element_of: Buffer,
}

impl Queries {
    pub(super) const TREE: BindingType = BindingType::AccelerationStructure {
        vertex_return: false,
    };

    /// Of triangles that belong to so many elements, or to obstructions.
    pub(super) fn new(
        context: &Context,
        triangles: &[twins::RayTriangle],
        elements: usize,
    ) -> Result<Self, GpuError> {
        let is_element = |t: &&twins::RayTriangle| (t.element as usize) < elements;
        let receiving = || triangles.iter().filter(is_element);
        let receives: Vec<Corners> = receiving().map(corners).collect();
        let absorbs = absorbing(triangles, elements);
        allow(context, receives.len().max(absorbs.len()))?;
        let element_of: Vec<u32> = receiving().map(|t| t.element).collect();
        let largest = context.limits.max_storage_buffer_binding_size;
        let bytes = size_of_val(&*element_of) as u64;
        context.allow("elements", bytes, largest, "bytes")?;
        Ok(Self {
            tree: tree(context, &receives, &absorbs),
            element_of: filled(
                &context.device,
                "elements of triangles",
                &element_of,
                BufferUsages::STORAGE,
            ),
        })
    }

    pub(super) fn bindings(&self) -> [BindingResource<'_>; 2] {
        [self.tree.as_binding(), self.element_of.as_entire_binding()]
    }
}

type Corners = [[f32; 3]; 3];

fn corners(triangle: &twins::RayTriangle) -> Corners {
    [triangle.a, triangle.b, triangle.c]
}

/// What absorbs behind: elements whose other side is none, and obstructions on either side.
fn absorbing(triangles: &[twins::RayTriangle], elements: usize) -> Vec<Corners> {
    let mut found = Vec::new();
    for triangle in triangles.iter().filter(|t| t.both_sides == 0) {
        let [a, b, c] = corners(triangle);
        found.push([a, b, c]);
        if triangle.element as usize == elements {
            found.push([a, c, b]);
        }
    }
    found
}

/// Refuses more triangles than the adapter's trees hold.
fn allow(context: &Context, triangles: usize) -> Result<(), GpuError> {
    let limits = &context.limits;
    let (triangles, most) = (triangles as u64, u64::from(limits.max_blas_primitive_count));
    context.allow("triangles that rays meet", triangles, most, "in a tree")?;
    let most = u64::from(limits.max_tlas_instance_count);
    context.allow(
        "instances that rays meet",
        INSTANCES.into(),
        most,
        "in a tree",
    )?;
    let largest = limits.max_buffer_size;
    let bytes = triangles * size_of::<Corners>() as u64;
    context.allow("triangles that rays meet", bytes, largest, "bytes")
}

/// Builds the tree on the device.
fn tree(context: &Context, receives: &[Corners], absorbs: &[Corners]) -> Tlas {
    let device = &context.device;
    let parts = [(receives, twins::RECEIVES), (absorbs, twins::ABSORBS)];
    let parts: Vec<(Part, u32)> = parts
        .into_iter()
        .filter(|(triangles, _)| !triangles.is_empty())
        .map(|(triangles, mask)| (Part::new(device, triangles), mask))
        .collect();
    let mut tree = device.create_tlas(&CreateTlasDescriptor {
        label: Some("what rays meet"),
        max_instances: INSTANCES,
        flags: AccelerationStructureFlags::PREFER_FAST_TRACE,
        update_mode: AccelerationStructureUpdateMode::Build,
    });
    for (i, (part, mask)) in parts.iter().enumerate() {
        let mask = u8::try_from(*mask).expect("masks have eight bits");
        tree[i] = Some(TlasInstance::new(&part.blas, IDENTITY, 0, mask));
    }
    let descriptor = wgpu::CommandEncoderDescriptor {
        label: Some("what rays meet"),
    };
    let mut encoder = device.create_command_encoder(&descriptor);
    let entries: Vec<BlasBuildEntry<'_>> = parts.iter().map(|(part, _)| part.entry()).collect();
    encoder.build_acceleration_structures(&entries, [&tree]);
    context.queue.submit([encoder.finish()]);
    tree
}

/// An instance's triangles.
struct Part {
    vertices: Buffer,
    size: BlasTriangleGeometrySizeDescriptor,
    blas: Blas,
}

impl Part {
    fn new(device: &Device, triangles: &[Corners]) -> Self {
        let vertices = triangles.as_flattened();
        let size = BlasTriangleGeometrySizeDescriptor {
            vertex_format: VertexFormat::Float32x3,
            vertex_count: count(vertices.len()),
            index_format: None,
            index_count: None,
            flags: AccelerationStructureGeometryFlags::OPAQUE,
        };
        let descriptor = CreateBlasDescriptor {
            label: Some("triangles that rays meet"),
            flags: AccelerationStructureFlags::PREFER_FAST_TRACE,
            update_mode: AccelerationStructureUpdateMode::Build,
        };
        let sizes = BlasGeometrySizeDescriptors::Triangles {
            descriptors: vec![size.clone()],
        };
        Self {
            vertices: filled(
                device,
                "corners that rays meet",
                vertices,
                BufferUsages::BLAS_INPUT,
            ),
            blas: device.create_blas(&descriptor, sizes),
            size,
        }
    }

    fn entry(&self) -> BlasBuildEntry<'_> {
        let geometry = BlasTriangleGeometry {
            size: &self.size,
            vertex_buffer: &self.vertices,
            first_vertex: 0,
            vertex_stride: size_of::<[f32; 3]>() as u64,
            index_buffer: None,
            first_index: None,
            transform_buffer: None,
            transform_buffer_offset: None,
        };
        BlasBuildEntry {
            blas: &self.blas,
            geometry: BlasGeometries::TriangleGeometries(vec![geometry]),
        }
    }
}
