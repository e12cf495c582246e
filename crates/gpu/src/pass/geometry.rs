//! A drawn mesh on the device: vertices, triangles sorted by what draws them, edges of elements.
//!
//! A triangle's element is an attribute of its first vertex. Triangles are turned until each begins with a vertex with
//! which no triangle of another element begins; in a grid of quadrilaterals nearly all find one, so that vertices are
//! shared although every element is known.

use crate::buffer::filled;
use crate::context::Context;
use crate::error::GpuError;
use crate::hemicube::count;
use crate::pass::bump::ReliefMesh;
use crate::pass::light::VertexSources;
use core::ops::Range;
use glam::{Vec3, Vec4};
use hemicube_radiosity::drawn::{DrawnMesh, DrawnPart};
use hemicube_radiosity::{PatchMesh, Solution};
use hemicube_render::{TangentFrame, Tangents};
use hemicube_scene::{AlphaMode, Material};
use hemicube_shaders::surface as twins;
use std::collections::HashMap;
use wgpu::{Buffer, BufferUsages, VertexAttribute, VertexBufferLayout, VertexFormat};

/// How a triangle's material takes part in visibility.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(crate) enum Cover {
    /// Hides what is behind.
    Solid,
    /// The same, except in holes.
    Masked,
    /// Lets light through.
    Transparent,
}

impl Cover {
    fn of(material: &Material) -> Self {
        match material.alpha_mode {
            _ if material.transmission > 0.0 => Self::Transparent,
            AlphaMode::Blend => Self::Transparent,
            AlphaMode::Mask { .. } => Self::Masked,
            AlphaMode::Opaque => Self::Solid,
        }
    }
}

/// Triangles that lie together in the index buffer and share an instance and a material.
#[derive(Debug, Clone)]
pub(crate) struct Run {
    /// Number among the drawn mesh's parts.
    pub(crate) part: usize,
    /// Index of the scene's material.
    pub(crate) material: usize,
    /// Index of the scene's instance.
    pub(crate) instance: usize,
    pub(crate) cover: Cover,
    /// Whether vertices have colours other than white.
    pub(crate) has_colors: bool,
    pub(crate) indices: Range<u32>,
}

/// A drawn mesh on the device.
#[derive(Debug)]
pub(crate) struct Geometry {
    pub(crate) vertices: Buffer,
    pub(crate) indices: Buffer,
    /// Solid ones first.
    pub(crate) runs: Vec<Run>,
    edges: Buffer,
    edge_count: u32,
    /// Positions of all vertices, for sorting and for planes.
    pub(crate) positions: Vec<Vec3>,
    /// Indices as in the buffer.
    pub(crate) order: Vec<[u32; 3]>,
}

impl Geometry {
    /// Puts a drawn mesh on the device, and tells where its vertices take their light from and which have reliefs.
    pub(crate) fn new(
        context: &Context,
        solution: &Solution,
        drawn: &DrawnMesh,
    ) -> Result<(Self, VertexSources, ReliefMesh), GpuError> {
        let mesh = solution.mesh();
        let scene = mesh.scene();
        let cover = |part: &DrawnPart| Cover::of(&scene.materials[part.material]);
        let mut parts: Vec<usize> = (0..drawn.parts.len()).collect();
        parts.sort_by_key(|&p| (cover(&drawn.parts[p]), drawn.parts[p].material));
        let mut layout = Layout::new(drawn);
        let tangents = Tangents::new(mesh, drawn);
        let firsts = first_triangles(drawn);
        let mut runs = Vec::new();
        for number in parts {
            let part = &drawn.parts[number];
            let first = 3 * layout.triangles.len();
            layout.add_part(drawn, part, (&tangents, firsts[number]));
            runs.push(Run {
                part: number,
                material: part.material,
                instance: part.instance,
                cover: cover(part),
                has_colors: has_colors(drawn, part),
                indices: count(first)..count(3 * layout.triangles.len()),
            });
        }
        let edges = edges(mesh);
        let largest = context.limits.max_buffer_size;
        let bytes = size_of_val(layout.vertices.as_slice()) as u64;
        context.allow("vertices", bytes, largest, "bytes")?;
        context.allow(
            "edges",
            size_of_val(edges.as_slice()) as u64,
            largest,
            "bytes",
        )?;
        let device = &context.device;
        let buffer = |label, data: &[u32]| filled(device, label, data, BufferUsages::INDEX);
        let geometry = Self {
            vertices: filled(
                device,
                "vertices",
                &some(&layout.vertices),
                BufferUsages::VERTEX,
            ),
            indices: buffer("triangles", some(&layout.triangles).as_flattened()),
            runs,
            edges: filled(device, "edges", &some(&edges), BufferUsages::VERTEX),
            edge_count: count(edges.len()),
            positions: layout.vertices.iter().map(|v| v.position.into()).collect(),
            order: layout.triangles,
        };
        let sources = sources(mesh, drawn, &layout.origins);
        Ok((geometry, sources, layout.reliefs))
    }

    /// Draws edges, with the pipeline and the bindings that are set.
    pub(crate) fn draw_edges(&self, pass: &mut wgpu::RenderPass<'_>) {
        pass.set_vertex_buffer(0, self.edges.slice(..));
        pass.draw(0..4, 0..self.edge_count);
    }
}

/// At least one, because empty buffers cannot be bound.
fn some<T: bytemuck::Zeroable + Copy>(items: &[T]) -> Vec<T> {
    if items.is_empty() {
        vec![T::zeroed()]
    } else {
        items.to_vec()
    }
}

/// Whether a part's vertices have colours other than white.
fn has_colors(drawn: &DrawnMesh, part: &DrawnPart) -> bool {
    let mut vertices = part.triangles.as_flattened().iter();
    vertices.any(|&v| drawn.colors[v as usize] != Vec4::ONE)
}

/// For each part the number of its first triangle among all.
fn first_triangles(drawn: &DrawnMesh) -> Vec<u32> {
    let mut next = 0;
    let first = |part: &DrawnPart| {
        let first = next;
        next += count(part.triangles.len());
        first
    };
    drawn.parts.iter().map(first).collect()
}

/// No triangle begins with a vertex yet.
const UNCLAIMED: u32 = u32::MAX;

/// Vertices and triangles as they will lie on the device.
struct Layout {
    vertices: Vec<twins::SurfaceVertex>,
    /// The drawn mesh's vertex of each.
    origins: Vec<u32>,
    triangles: Vec<[u32; 3]>,
    /// The vertex that stands for each of the drawn mesh's.
    shared: Vec<u32>,
    /// The element whose triangles begin with each vertex.
    claims: Vec<u32>,
    reliefs: ReliefMesh,
}

impl Layout {
    fn new(drawn: &DrawnMesh) -> Self {
        Self {
            vertices: Vec::new(),
            origins: Vec::new(),
            triangles: Vec::new(),
            shared: vec![UNCLAIMED; drawn.positions.len()],
            claims: Vec::new(),
            reliefs: ReliefMesh::default(),
        }
    }

    /// Adds a part whose first triangle has this number among all.
    fn add_part(
        &mut self,
        drawn: &DrawnMesh,
        part: &DrawnPart,
        (tangents, first): (&Tangents, u32),
    ) {
        let triangles = part.triangles.iter().zip(&part.elements);
        for (number, (&corners, &element)) in (first..).zip(triangles) {
            if let Some(frame) = tangents.of_triangle(number) {
                self.add_relief(drawn, (corners, element), frame);
                continue;
            }
            let vertices = corners.map(|c| self.shared_vertex(drawn, c));
            let turned = self.claimed(vertices, element);
            self.triangles.push(turned);
        }
    }

    /// Adds a triangle with a relief: it has vertices of its own, which know which corners they are.
    fn add_relief(
        &mut self,
        drawn: &DrawnMesh,
        (corners, element): ([u32; 3], u32),
        frame: &TangentFrame,
    ) {
        let triangle = self.reliefs.add(corners);
        let turned = if frame.is_turned {
            twins::CORNER_TURNED
        } else {
            0
        };
        let vertices = [0, 1, 2].map(|i| {
            let own = self.push(drawn, corners[i]);
            self.claim(own, element);
            let vertex = &mut self.vertices[own as usize];
            vertex.tangent = frame.corners[i].to_array();
            vertex.corner = count(i) | turned | triangle << twins::CORNER_TRIANGLE_SHIFT;
            own
        });
        self.triangles.push(vertices);
    }

    /// The vertex that all triangles share.
    fn shared_vertex(&mut self, drawn: &DrawnMesh, origin: u32) -> u32 {
        if self.shared[origin as usize] == UNCLAIMED {
            self.shared[origin as usize] = self.push(drawn, origin);
        }
        self.shared[origin as usize]
    }

    fn push(&mut self, drawn: &DrawnMesh, origin: u32) -> u32 {
        let v = origin as usize;
        self.vertices.push(twins::SurfaceVertex {
            position: drawn.positions[v].to_array(),
            element: 0,
            normal: drawn.normals[v].to_array(),
            corner: 0,
            texcoords: drawn.texcoords[v].map(|uv| uv.to_array()),
            color: drawn.colors[v].to_array(),
            tangent: [0.0; 4],
        });
        self.origins.push(origin);
        self.claims.push(UNCLAIMED);
        count(self.vertices.len() - 1)
    }

    /// The same triangle, beginning with a vertex of its element.
    fn claimed(&mut self, [a, b, c]: [u32; 3], element: u32) -> [u32; 3] {
        let turns = [[a, b, c], [b, c, a], [c, a, b]];
        let is = |wanted: u32| {
            let claims = &self.claims;
            turns
                .iter()
                .find(move |turn| claims[turn[0] as usize] == wanted)
        };
        if let Some(&turn) = is(element).or_else(|| is(UNCLAIMED)) {
            self.claim(turn[0], element);
            return turn;
        }
        let own = count(self.vertices.len());
        self.vertices.push(self.vertices[a as usize]);
        self.origins.push(self.origins[a as usize]);
        self.claims.push(UNCLAIMED);
        self.claim(own, element);
        [own, b, c]
    }

    fn claim(&mut self, vertex: u32, element: u32) {
        self.claims[vertex as usize] = element;
        self.vertices[vertex as usize].element = element;
    }
}

/// The drawn mesh's light sources for each vertex on the device; copies share a list.
fn sources(mesh: &PatchMesh, drawn: &DrawnMesh, origins: &[u32]) -> VertexSources {
    let all = drawn.light_sources(mesh);
    let starts = all.starts();
    let range = |&v: &u32| [starts[v as usize], starts[v as usize + 1]];
    VertexSources {
        ranges: some(&origins.iter().map(range).collect::<Vec<_>>()),
        elements: some(all.elements()),
        weights: some(all.weights()),
    }
}

/// Edges of all elements, each once for every two elements that meet there.
fn edges(mesh: &PatchMesh) -> Vec<twins::Edge> {
    let mut numbers: HashMap<[u32; 2], usize> = HashMap::new();
    let mut found: Vec<([u32; 2], Vec<Vec3>)> = Vec::new();
    for &id in mesh.elements() {
        let (corners, normal) = (mesh.corners(id), mesh.node(id).normal);
        for (i, &a) in corners.iter().enumerate() {
            let b = corners[(i + 1) % corners.len()];
            let key = [a.min(b), a.max(b)];
            let number = *numbers.entry(key).or_insert_with(|| {
                found.push((key, Vec::new()));
                found.len() - 1
            });
            let normals = &mut found[number].1;
            if !normals.contains(&normal) {
                normals.push(normal);
            }
        }
    }
    let point = |v: u32| mesh.vertices()[v as usize].to_array();
    let of_edge = |(ends, normals): &([u32; 2], Vec<Vec3>)| {
        let [start, end] = ends.map(point);
        let edge = move |pair: &[Vec3]| twins::Edge {
            start,
            first_normal: pair[0].to_array(),
            end,
            second_normal: pair[pair.len() - 1].to_array(),
        };
        normals.chunks(2).map(edge).collect::<Vec<_>>()
    };
    found.iter().flat_map(of_edge).collect()
}

/// Attributes of [`twins::SurfaceVertex`], in order.
const VERTEX: [VertexAttribute; 7] = wgpu::vertex_attr_array![
    0 => Float32x3, 1 => Uint32, 2 => Float32x3, 3 => Uint32, 4 => Float32x4, 5 => Float32x4, 6 => Float32x4
];
const LIGHT: [VertexAttribute; 1] = [VertexAttribute {
    format: VertexFormat::Float32x4,
    offset: 0,
    shader_location: 7,
}];
/// Attributes of [`twins::Edge`], in order.
const EDGE: [VertexAttribute; 4] =
    wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3, 2 => Float32x3, 3 => Float32x3];

/// Vertices and their light.
pub(crate) fn surface_buffers() -> [VertexBufferLayout<'static>; 2] {
    [
        VertexBufferLayout {
            array_stride: size_of::<twins::SurfaceVertex>() as u64,
            step_mode: wgpu::VertexStepMode::Vertex,
            attributes: &VERTEX,
        },
        VertexBufferLayout {
            array_stride: 16,
            step_mode: wgpu::VertexStepMode::Vertex,
            attributes: &LIGHT,
        },
    ]
}

/// Edges, one for each instance.
pub(crate) fn edge_buffers() -> [VertexBufferLayout<'static>; 1] {
    [VertexBufferLayout {
        array_stride: size_of::<twins::Edge>() as u64,
        step_mode: wgpu::VertexStepMode::Instance,
        attributes: &EDGE,
    }]
}
