//! Form factors by casting rays in compute shaders: twin of the shots of `radiosity/src/form_factor/raycast.rs`.
//!
//! Where the adapter has ray queries and the [`Context`] uses them, they find what rays meet; else the shader walks the
//! eight-wide compressed tree that `obvhs` builds over the elements.

mod met;
mod query;
mod tree;

use crate::backend::Report;
use crate::buffer::{bind, compute, empty, filled, layout, module, read, storage, uniform};
use crate::context::Context;
use crate::error::GpuError;
use crate::hemicube::{compute_pass, count};
use core::fmt;
use hemicube_radiosity::form_factor::{FormFactors, RayCast, RayCastOptions, Row};
use hemicube_radiosity::patch::{NodeId, PatchMesh};
use hemicube_radiosity::sampling::hash;
use hemicube_shaders::Shader;
use hemicube_shaders::raycast as twins;
use met::triangles;
use query::Queries;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};
use tree::Tree;
use wgpu::{
    BindGroupLayout, BindingResource, BindingType, Buffer, BufferUsages, ComputePipeline,
    ShaderStages,
};

/// Rays of one dispatch, a multiple of a workgroup's 64: more would take some drivers too long.
const DISPATCH: u32 = 1 << 18;

/// Form factors by casting rays on the GPU.
///
/// Always shots, never pairs. When the device is lost or its memory runs out, rows go on with the CPU's rays;
/// [`GpuRayCast::failure`] says so. Meshes with panes are left to the CPU, too.
pub struct GpuRayCast {
    context: Arc<Context>,
    cpu: RayCast,
    is_layered: bool,
    seed: u64,
    layout: BindGroupLayout,
    shoot: ComputePipeline,
    obstacles: Obstacles,
    /// One row at a time.
    counts: Mutex<Counts>,
    failure: OnceLock<GpuError>,
    report: Option<Report>,
}

impl fmt::Debug for GpuRayCast {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("GpuRayCast")
            .field("context", &self.context)
            .field("failure", &self.failure)
            .finish_non_exhaustive()
    }
}

/// What rays meet, for one of the shaders.
#[derive(Debug)]
enum Obstacles {
    Tree(Tree),
    Queries(Queries),
}

impl Obstacles {
    fn new(context: &Context, mesh: &PatchMesh) -> Result<Self, GpuError> {
        let triangles = triangles(mesh);
        if context.has_ray_queries() {
            return Queries::new(context, &triangles, mesh.elements().len()).map(Self::Queries);
        }
        Tree::new(context, &triangles).map(Self::Tree)
    }

    fn shader(&self) -> &'static Shader {
        match self {
            Self::Tree(_) => &twins::RAYCAST,
            Self::Queries(_) => &twins::RAY_QUERY,
        }
    }

    /// What is bound in the middle of what both shaders share.
    fn types(&self) -> [BindingType; 2] {
        match self {
            Self::Tree(_) => [storage(true), storage(true)],
            Self::Queries(_) => [Queries::TREE, storage(true)],
        }
    }

    fn bindings(&self) -> [BindingResource<'_>; 2] {
        match self {
            Self::Tree(tree) => tree.bindings(),
            Self::Queries(queries) => queries.bindings(),
        }
    }
}

/// Where hits are counted, and where the CPU reads them.
#[derive(Debug)]
struct Counts {
    counts: Buffer,
    read: Buffer,
}

impl GpuRayCast {
    /// Factors between the nodes of a mesh.
    ///
    /// # Errors
    /// A mesh that does not fit the adapter's limits or its memory.
    pub fn new(
        context: Arc<Context>,
        mesh: Arc<PatchMesh>,
        options: RayCastOptions,
    ) -> Result<Self, GpuError> {
        let device = &context.device;
        let obstacles = context.guard(|| Obstacles::new(&context, &mesh))?;
        let [first, second] = obstacles.types();
        let types = [uniform(false), storage(true), first, second, storage(false)];
        let layout = layout(device, "ray casting", ShaderStages::COMPUTE, &types);
        let bytes = (mesh.elements().len() as u64 + 2) * 4;
        let copied = BufferUsages::COPY_SRC | BufferUsages::COPY_DST;
        let counts = Counts {
            counts: empty(device, "hits", bytes, BufferUsages::STORAGE | copied),
            read: empty(
                device,
                "hits to read",
                bytes,
                BufferUsages::MAP_READ | BufferUsages::COPY_DST,
            ),
        };
        let shader = module(device, obstacles.shader());
        let new = Self {
            shoot: compute(device, &shader, "shoot", &[&layout]),
            obstacles,
            is_layered: mesh.transmittance().iter().any(|t| !t.is_black()),
            seed: options.seed,
            cpu: RayCast::new(mesh, options),
            counts: Mutex::new(counts),
            failure: OnceLock::new(),
            report: None,
            layout,
            context,
        };
        new.context.wait()?;
        Ok(new)
    }

    /// `report` hears why rows come from the CPU.
    pub(crate) fn with_report(self, report: Report) -> Self {
        Self {
            report: Some(report),
            ..self
        }
    }

    /// Why rows come from the CPU since then, if they do.
    pub fn failure(&self) -> Option<&GpuError> {
        self.failure.get()
    }

    /// Hits of each element, of what only absorbs, and of nothing.
    fn hits(&self, source: NodeId, rays: u32) -> Result<Vec<u32>, GpuError> {
        self.context.check()?;
        let device = &self.context.device;
        let parts = self.parts(source);
        let part_buffer = filled(device, "parts", &parts, BufferUsages::STORAGE);
        let Counts {
            counts,
            read: to_read,
        } = &*self.counts.lock().unwrap_or_else(PoisonError::into_inner);
        let descriptor = wgpu::CommandEncoderDescriptor {
            label: Some("ray casting"),
        };
        let mut encoder = device.create_command_encoder(&descriptor);
        encoder.clear_buffer(counts, 0, None);
        for first_ray in (0..rays).step_by(DISPATCH as usize) {
            let params = self.params(source, rays, first_ray, parts.len());
            let params = filled(device, "rays", &[params], BufferUsages::UNIFORM);
            let [first, second] = self.obstacles.bindings();
            let resources = [
                params.as_entire_binding(),
                part_buffer.as_entire_binding(),
                first,
                second,
                counts.as_entire_binding(),
            ];
            let group = bind(device, "rays", &self.layout, &resources);
            let mut pass = compute_pass(&mut encoder, "rays");
            pass.set_pipeline(&self.shoot);
            pass.set_bind_group(0, &group, &[]);
            pass.dispatch_workgroups((rays - first_ray).min(DISPATCH).div_ceil(64), 1, 1);
        }
        let bytes = (self.mesh().elements().len() as u64 + 2) * 4;
        encoder.copy_buffer_to_buffer(counts, 0, to_read, 0, bytes);
        let submission = self.context.queue.submit([encoder.finish()]);
        read(&self.context, to_read, bytes, submission)
    }

    fn params(&self, source: NodeId, rays: u32, first_ray: u32, parts: usize) -> twins::RayParams {
        let mesh = self.mesh();
        let node = mesh.node(source);
        let (tangent, bitangent) = node.normal.any_orthonormal_pair();
        let visibility = mesh.visibility();
        let seed = hash(u64::from(source.0), self.seed);
        #[expect(
            clippy::cast_possible_truncation,
            reason = "half of the bits, then the other half"
        )]
        let halves = |bits: u64| [bits as u32, (bits >> 32) as u32];
        let ([a, b], [c, d]) = (halves(hash(seed, 0)), halves(hash(seed, 1)));
        let offset = visibility.offset(node.centroid);
        twins::RayParams {
            rays,
            parts: count(parts),
            elements: count(mesh.elements().len()),
            first_ray,
            shift: [a, b, c, d],
            tangent: tangent.to_array(),
            offset,
            bitangent: bitangent.to_array(),
            farthest: 2.0 * visibility.diameter(),
            normal: node.normal.to_array(),
            lag: offset,
        }
    }

    /// The polygons from which the rays of a node start: its own, or its exposed elements where some of it is buried.
    fn parts(&self, source: NodeId) -> Vec<twins::RayPart> {
        let mesh = self.mesh();
        let whole = [(source, 1.0)];
        let exposed: Vec<(NodeId, f32)> = mesh.patch_of_node(source).map_or(Vec::new(), |patch| {
            let elements = mesh.elements_of_patch(patch);
            elements
                .map(|e| (mesh.elements()[e], mesh.exposed_area(e)))
                .collect()
        });
        let is_whole = exposed.iter().all(|&(id, area)| area == mesh.node(id).area);
        let total: f32 = exposed.iter().map(|&(_, area)| area).sum();
        let nodes = if is_whole || total == 0.0 {
            &whole[..]
        } else {
            &exposed
        };
        let total: f32 = nodes.iter().map(|&(_, area)| area).sum();
        let mut sum = 0.0;
        let part = |&(id, area): &(NodeId, f32)| {
            sum += area;
            let polygon = mesh.polygon(id);
            let corner = |k: usize| polygon[k.min(polygon.len() - 1)].extend(0.0).to_array();
            twins::RayPart {
                corners: [0, 1, 2, 3].map(corner),
                share: sum / total,
                count: count(polygon.len()),
                padding_0: 0,
                padding_1: 0,
            }
        };
        nodes
            .iter()
            .filter(|&&(_, area)| area > 0.0)
            .map(part)
            .collect()
    }
}

impl FormFactors for GpuRayCast {
    fn mesh(&self) -> &Arc<PatchMesh> {
        self.cpu.mesh()
    }

    fn fill_row(&self, source: NodeId, row: &mut Row) {
        if self.is_layered || self.failure.get().is_some() {
            return self.cpu.fill_row(source, row);
        }
        let rays = self.cpu.rays_of_shot(source);
        match self.hits(source, rays) {
            Ok(hits) => self.write(&hits, rays, row),
            Err(failure) => {
                // Another thread may have been first; either reason is true.
                if let (Ok(()), Some(report)) = (self.failure.set(failure.clone()), &self.report) {
                    report(&failure);
                }
                self.cpu.fill_row(source, row);
            }
        }
    }

    fn rays(&self) -> u64 {
        self.cpu.rays()
    }
}

impl GpuRayCast {
    /// Hits as a row; what elements that are wholly buried get counts as absorbed.
    fn write(&self, hits: &[u32], rays: u32, row: &mut Row) {
        let mesh = self.mesh();
        self.cpu.count_rays(u64::from(rays));
        let elements = mesh.elements().len();
        #[expect(clippy::cast_possible_truncation, reason = "factors are kept in f32")]
        let share = |hits: u32| (f64::from(hits) / f64::from(rays)) as f32;
        row.clear(1);
        let mut absorbed = hits[elements];
        for (e, &hits) in hits[..elements]
            .iter()
            .enumerate()
            .filter(|(_, hits)| **hits > 0)
        {
            if mesh.exposed_area(e) > 0.0 {
                row.receivers.push(count(e));
                row.fractions.push(share(hits));
            } else {
                absorbed += hits;
            }
        }
        row.absorbed = [share(absorbed); 3];
        row.escaped = [share(hits[elements + 1]); 3];
    }
}
