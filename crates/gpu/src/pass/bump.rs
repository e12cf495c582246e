//! Surfaces with normal maps and heights, and light on the normals that these turn.

use crate::buffer::{bind, filled, layout, storage};
use crate::context::Context;
use crate::hemicube::count;
use crate::pass::lit::SurfacePass;
use glam::Vec3;
use hemicube_raster::Rgb;
use hemicube_render::TiltFit;
use hemicube_shaders::surface as twins;
use std::collections::HashMap;
use wgpu::{BindGroup, BindGroupLayout, Buffer, BufferUsages, ShaderStages};

/// Surfaces with reliefs.
#[derive(Debug)]
pub(crate) struct BumpPass {
    pub(crate) pipelines: SurfacePass,
    pub(crate) layout: BindGroupLayout,
}

impl BumpPass {
    pub(crate) fn new(
        context: &Context,
        scene: &BindGroupLayout,
        textures: &BindGroupLayout,
    ) -> Self {
        let reads = storage(true);
        let types = [reads, reads, reads];
        let layout = layout(&context.device, "reliefs", ShaderStages::FRAGMENT, &types);
        let layouts = [scene, textures, &layout];
        Self {
            pipelines: SurfacePass::new("bumped surfaces", &twins::BUMP, &layouts),
            layout,
        }
    }
}

/// Triangles with reliefs, and the drawn mesh's vertices that they have.
#[derive(Debug, Default)]
pub(crate) struct ReliefMesh {
    /// Each once.
    pub(crate) vertices: Vec<u32>,
    /// Places in `vertices`; the fourth number is unused.
    triangles: Vec<[u32; 4]>,
    places: HashMap<u32, u32>,
}

impl ReliefMesh {
    /// Adds a triangle of the drawn mesh's vertices; its number.
    pub(crate) fn add(&mut self, corners: [u32; 3]) -> u32 {
        let [a, b, c] = corners.map(|vertex| {
            *self.places.entry(vertex).or_insert_with(|| {
                self.vertices.push(vertex);
                count(self.vertices.len() - 1)
            })
        });
        self.triangles.push([a, b, c, 0]);
        count(self.triangles.len() - 1)
    }
}

/// Light on tilted normals, on the device.
#[derive(Debug)]
pub(crate) struct Reliefs {
    pub(crate) mesh: ReliefMesh,
    fits: Buffer,
    pub(crate) bindings: BindGroup,
}

impl Reliefs {
    /// Lit by a uniform sky, until something better is known. `normals` are those of the drawn mesh.
    pub(crate) fn new(
        context: &Context,
        layout: &BindGroupLayout,
        mesh: ReliefMesh,
        normals: &[Vec3],
        vertex_light: &Buffer,
    ) -> Self {
        let device = &context.device;
        let fits = mesh.vertices.iter().map(|&v| uniform(normals[v as usize]));
        let fits: Vec<twins::TiltFit> = fits.collect();
        let none = [uniform(Vec3::Z)];
        let fits: &[twins::TiltFit] = if fits.is_empty() { &none } else { &fits };
        let usage = BufferUsages::STORAGE | BufferUsages::COPY_DST;
        let fits = filled(device, "tilted light", fits, usage);
        let triangles: &[[u32; 4]] = if mesh.triangles.is_empty() {
            &[[0; 4]]
        } else {
            &mesh.triangles
        };
        let triangles = filled(
            device,
            "triangles with reliefs",
            triangles.as_flattened(),
            BufferUsages::STORAGE,
        );
        let all = [&fits, &triangles, vertex_light].map(Buffer::as_entire_binding);
        Self {
            bindings: bind(device, "reliefs", layout, &all),
            fits,
            mesh,
        }
    }

    /// Takes over what was gathered at the mesh's vertices.
    pub(crate) fn set(&self, context: &Context, fits: &[TiltFit]) {
        let twins: Vec<twins::TiltFit> = fits.iter().map(twin).collect();
        let bytes = bytemuck::cast_slice(&twins);
        context.queue.write_buffer(&self.fits, 0, bytes);
    }
}

fn twin(fit: &TiltFit) -> twins::TiltFit {
    let padded = |c: Rgb| [c.r, c.g, c.b, 0.0];
    let changes: Vec<[f32; 4]> = fit
        .changes
        .as_flattened()
        .iter()
        .map(|&c| padded(c))
        .collect();
    twins::TiltFit {
        right: fit.right.to_array(),
        padding_0: 0,
        up: fit.up.to_array(),
        padding_1: 0,
        changes: changes.try_into().expect("three rings of eight"),
    }
}

/// Under a uniform sky: `E(tilted) / E(flat) = (1 + cos θ) / 2`.
fn uniform(normal: Vec3) -> twins::TiltFit {
    let (right, up) = normal.normalize_or(Vec3::Z).any_orthonormal_pair();
    let change = |slope: f32| {
        let per_cosine = (1.0 + slope * slope).sqrt();
        Rgb::splat(0.5 * (1.0 + per_cosine) - 1.0)
    };
    twin(&TiltFit {
        right,
        up,
        changes: TiltFit::RINGS.map(|slope| [change(slope); 8]),
    })
}
