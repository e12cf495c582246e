//! The mesh on the device, as hemicubes need it.

use crate::buffer::filled;
use crate::context::Context;
use crate::error::GpuError;
use hemicube_radiosity::form_factor::FormFactors;
use hemicube_radiosity::form_factor::hemicube::Hemicube;
use hemicube_radiosity::patch::face::Side;
use hemicube_radiosity::patch::subdivide::Cell;
use hemicube_radiosity::patch::{NodeId, NodeKind, PatchMesh};
use hemicube_shaders::hemicube as twins;
use hemicube_shaders::memory::SceneSize;
use wgpu::{Buffer, BufferUsages};

/// What all the light of a hemicube is in whole numbers.
pub(super) const ALL: f64 = 2_147_483_648.0;

/// The mesh on the device.
#[derive(Debug)]
pub(crate) struct Geometry {
    pub(crate) params: twins::HemicubeParams,
    /// Layers that have to be drawn: 1 where nothing lets light through.
    pub(crate) layers: u32,
    pub(crate) size: SceneSize,
    pub(super) params_buffer: Buffer,
    pub(super) vertices: Buffer,
    pub(super) corners: Buffer,
    pub(super) receivers: Buffer,
    /// One or two triangles for each receiver.
    pub(super) indices: Buffer,
    /// Running sums of delta form factors, see [`hemicube_shaders::hemicube::SUM`].
    pub(super) deltas: Buffer,
    /// Of each element by band; empty where nothing lets light through.
    pub(super) transmittance: Buffer,
}

impl Geometry {
    pub(crate) fn new(context: &Context, cpu: &Hemicube) -> Result<Self, GpuError> {
        let mesh = cpu.mesh();
        let vertices: Vec<[f32; 4]> = mesh
            .vertices()
            .iter()
            .map(|v| v.extend(0.0).to_array())
            .collect();
        let (corners, receivers) = (corners(mesh), receivers(cpu));
        let layers = layers(mesh);
        let has_quads = corners.iter().any(|c| c[2] != c[3]);
        let params = Self::params(context, cpu, receivers.len(), has_quads)?;
        let largest = context.limits.max_storage_buffer_binding_size;
        for (what, bytes) in [
            ("elements", size_of_val(&*receivers)),
            ("vertices", size_of_val(&*vertices)),
        ] {
            context.allow(what, bytes as u64, largest, "bytes")?;
        }
        let indices: &[u32] = if has_quads {
            &[0, 1, 2, 0, 2, 3]
        } else {
            &[0, 1, 2]
        };
        let index_bytes = receivers.len() * size_of_val(indices);
        context.allow(
            "indices",
            index_bytes as u64,
            context.limits.max_buffer_size,
            "bytes",
        )?;
        let indices: Vec<u32> = (0..params.receivers)
            .flat_map(|r| indices.iter().map(move |k| 4 * r + k))
            .collect();
        let transmittance = if layers > 1 {
            transmittance(mesh)
        } else {
            vec![[0.0; 4]]
        };
        let device = &context.device;
        let storage = |label, data: &[u8]| filled(device, label, data, BufferUsages::STORAGE);
        Ok(Self {
            params_buffer: filled(device, "parameters", &[params], BufferUsages::UNIFORM),
            vertices: storage("vertices", bytemuck::cast_slice(&vertices)),
            corners: storage("corners", bytemuck::cast_slice(&corners)),
            receivers: storage("receivers", bytemuck::cast_slice(&receivers)),
            indices: filled(device, "indices", &indices, BufferUsages::INDEX),
            deltas: storage("delta factors", bytemuck::cast_slice(&whole_sums(cpu))),
            transmittance: storage("transmittance", bytemuck::cast_slice(&transmittance)),
            size: SceneSize {
                elements: params.elements.into(),
                receivers: params.receivers.into(),
                vertices: params.vertices.into(),
                indices: params.indices.into(),
                layers: layers.into(),
                resolution: params.resolution.into(),
            },
            params,
            layers,
        })
    }

    fn params(
        context: &Context,
        cpu: &Hemicube,
        receivers: usize,
        has_quads: bool,
    ) -> Result<twins::HemicubeParams, GpuError> {
        // Items are numbers of 31 bits, indices four times as large.
        context.allow("elements", receivers as u64, (1 << 30) - 1, "places")?;
        let resolution = cpu.options().resolution;
        context.allow(
            "hemicubes of this resolution",
            u64::from(2 * resolution),
            u64::from(context.limits.max_texture_dimension_2d),
            "pixels a side",
        )?;
        let mesh = cpu.mesh();
        Ok(twins::HemicubeParams {
            receivers: count(receivers),
            vertices: count(mesh.vertices().len()),
            elements: count(mesh.elements().len()),
            resolution,
            groups: count(receivers.div_ceil(64)),
            indices: if has_quads { 6 } else { 3 },
            padding_0: 0,
            padding_1: 0,
        })
    }

    /// Bytes on the device.
    pub(crate) fn bytes(&self) -> u64 {
        [
            &self.params_buffer,
            &self.vertices,
            &self.corners,
            &self.receivers,
            &self.indices,
            &self.deltas,
            &self.transmittance,
        ]
        .iter()
        .map(|buffer| buffer.size())
        .sum()
    }
}

pub(crate) fn count(n: usize) -> u32 {
    u32::try_from(n).expect("checked against the adapter's limits")
}

/// Layers that a ray can cross: it meets each pane once, and then what lies behind.
fn layers(mesh: &PatchMesh) -> u32 {
    let passes = mesh.elements().iter().zip(mesh.transmittance());
    let mut panes: Vec<u32> = passes
        .filter(|(_, t)| !t.is_black())
        .map(|(&id, _)| face_of(mesh, id))
        .collect();
    panes.sort_unstable();
    panes.dedup();
    count(panes.len() + 1).min(twins::MAX_LAYERS)
}

fn face_of(mesh: &PatchMesh, element: NodeId) -> u32 {
    let NodeKind::Surface { face, .. } = mesh.node(element).kind else {
        unreachable!("elements are surfaces")
    };
    face
}

/// Vertices of elements, then of obstructions; the fourth repeats the third of a triangle.
fn corners(mesh: &PatchMesh) -> Vec<[u32; 4]> {
    let four = |corners: &[u32]| [0, 1, 2, 3].map(|k: usize| corners[k.min(corners.len() - 1)]);
    let elements = mesh.elements().iter().map(|&id| four(mesh.corners(id)));
    let obstructions = mesh.obstructions().iter();
    elements
        .chain(obstructions.map(|(_, cell)| four(cell.corners())))
        .collect()
}

/// Elements, then obstructions.
fn receivers(cpu: &Hemicube) -> Vec<twins::Receiver> {
    let mesh = cpu.mesh();
    let element = |(element, &id): (usize, &NodeId)| {
        let node = mesh.node(id);
        let both = mesh
            .visibility()
            .receives(face_of(mesh, id) as usize, Side::Back);
        let exposed = mesh.exposed_area(element) > 0.0;
        twins::Receiver {
            normal: node.normal.to_array(),
            flags: if both { twins::RECEIVER_BOTH_SIDES } else { 0 }
                | if exposed { twins::RECEIVER_EXPOSED } else { 0 },
            centroid: node.centroid.to_array(),
            radius: cpu.radius(element),
        }
    };
    let obstruction = |(face, cell): &(u32, Cell)| {
        let places = cell.corners().iter().map(|&c| mesh.vertices()[c as usize]);
        let centroid = places.clone().sum::<glam::Vec3>() / f32::from(cell.count);
        twins::Receiver {
            normal: mesh.faces()[*face as usize].normal.to_array(),
            flags: twins::RECEIVER_OBSTRUCTION,
            centroid: centroid.to_array(),
            radius: places.map(|p| p.distance(centroid)).fold(0.0, f32::max),
        }
    };
    let elements = mesh.elements().iter().enumerate().map(element);
    elements
        .chain(mesh.obstructions().iter().map(obstruction))
        .collect()
}

/// Share of light that passes each element, by band.
fn transmittance(mesh: &PatchMesh) -> Vec<[f32; 4]> {
    let bands = mesh.transmittance().iter().map(|t| t.to_array());
    bands.map(|[r, g, b]| [r, g, b, 0.0]).collect()
}

/// Running sums of delta form factors as whole numbers.
fn whole_sums(cpu: &Hemicube) -> Vec<u32> {
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a share of 1 times 2^31"
    )]
    cpu.delta_factors()
        .running_sums()
        .map(|sum| (sum * ALL).round() as u32)
        .collect()
}
