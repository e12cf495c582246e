//! The mesh as it is drawn: vertices with irradiance, split where light, material or texture coordinates break.
//!
//! Elements carry constant values; a vertex takes the area-weighted mean of the elements around it whose normals are
//! within the crease angle, so light is continuous over smooth surfaces and breaks at edges. Irradiance is averaged,
//! not radiosity: textures and neighbouring materials keep their sharp borders.

use crate::patch::{NodeId, NodeKind, PatchMesh};
use crate::solution::Solution;
use glam::{Vec2, Vec3, Vec4};
use hemicube_raster::Rgb;
use rayon::prelude::*;
use std::collections::HashMap;

/// Cosine of the largest angle between normals over which light is averaged (40°).
const CREASE: f32 = 0.766;

/// Vertices and triangles to draw.
#[derive(Debug, Clone, Default)]
pub struct DrawnMesh {
    /// World positions.
    pub positions: Vec<Vec3>,
    /// Unit normals of the side that is seen: interpolated where the scene has smooth ones.
    pub normals: Vec<Vec3>,
    /// First set of texture coordinates; all zero where a mesh has none.
    pub texcoords: Vec<[Vec2; 2]>,
    /// The scene's vertex colours; white where a mesh has none.
    pub colors: Vec<Vec4>,
    /// Irradiance from all groups as dimmed: lx or W/m².
    pub irradiance: Vec<Rgb>,
    /// Triangles that share an instance and a material, in the order of the scene.
    pub parts: Vec<DrawnPart>,
    /// For each vertex that of the patch mesh and one element whose corner it is.
    origins: Vec<(u32, u32)>,
}

/// Which elements each vertex of a drawn mesh takes its light from; twin of `vertex_light.wgsl`.
///
/// They stay the same as long as the patch mesh does, so new light comes to the vertices without a new drawn mesh.
#[derive(Debug, Clone, Default)]
pub struct LightSources {
    starts: Vec<u32>,
    elements: Vec<u32>,
}

impl LightSources {
    /// Where the list of each vertex begins in [`Self::elements`], and where the last one ends.
    pub fn starts(&self) -> &[u32] {
        &self.starts
    }

    /// Lists of elements, end to end.
    pub fn elements(&self) -> &[u32] {
        &self.elements
    }

    /// The area-weighted mean at each vertex of one value for each element; 0 where all of them are covered.
    ///
    /// # Panics
    /// There are fewer values than elements.
    pub fn means(&self, mesh: &PatchMesh, values: &[Rgb]) -> Vec<Rgb> {
        let ranges = self.starts.par_windows(2);
        let mean = |range: &[u32]| {
            mean_over(
                mesh,
                values,
                &self.elements[range[0] as usize..range[1] as usize],
            )
        };
        ranges.map(mean).collect()
    }
}

/// Triangles of one instance and material.
#[derive(Debug, Clone)]
pub struct DrawnPart {
    /// Index of the scene's instance.
    pub instance: usize,
    /// Index of the scene's material.
    pub material: usize,
    /// Vertex indices, counter-clockwise seen from the lit side.
    pub triangles: Vec<[u32; 3]>,
    /// Position of each triangle's element among the mesh's elements.
    pub elements: Vec<u32>,
}

impl DrawnMesh {
    /// The drawn mesh of a solution; `extra` is added to every irradiance (an ambient estimate, or black).
    pub fn new(solution: &Solution, extra: Rgb) -> Self {
        let corners = corner_irradiance(solution);
        let mesh = solution.mesh();
        let mut drawn = Self::default();
        let mut known: HashMap<VertexKey, u32> = HashMap::new();
        let mut part_of: HashMap<(u32, u32), usize> = HashMap::new();
        for (e, &id) in mesh.elements().iter().enumerate() {
            let NodeKind::Surface { face, .. } = mesh.node(id).kind else {
                unreachable!("elements are surfaces")
            };
            let world = &mesh.faces()[face as usize];
            let part = *part_of
                .entry((world.instance, world.material))
                .or_insert_with(|| {
                    drawn.parts.push(DrawnPart {
                        instance: world.instance as usize,
                        material: world.material as usize,
                        triangles: Vec::new(),
                        elements: Vec::new(),
                    });
                    drawn.parts.len() - 1
                });
            let vertices: Vec<u32> = mesh
                .corners(id)
                .iter()
                .zip(&corners[e])
                .map(|(&vertex, &(crease, irradiance))| {
                    let corner = drawn.corner(solution, id, vertex, irradiance + extra);
                    let key = VertexKey::new(vertex, crease, part, &corner);
                    *known.entry(key).or_insert_with(|| {
                        drawn.origins.push((vertex, crate::index32(e)));
                        drawn.push(corner)
                    })
                })
                .collect();
            let part = &mut drawn.parts[part];
            for i in 1..vertices.len() - 1 {
                part.triangles
                    .push([vertices[0], vertices[i], vertices[i + 1]]);
                part.elements.push(crate::index32(e));
            }
        }
        drawn
    }

    /// The elements around each vertex over which its light is the mean; `mesh` is the one that this was made of.
    pub fn light_sources(&self, mesh: &PatchMesh) -> LightSources {
        let around = elements_around_vertices(mesh);
        let mut sources = LightSources {
            starts: vec![0],
            elements: Vec::new(),
        };
        for &(vertex, element) in &self.origins {
            let normal = element_normal(mesh, element);
            let list = around.of(vertex).iter().copied();
            let similar = list.filter(|&other| similar(element_normal(mesh, other), normal));
            sources.elements.extend(similar);
            sources.starts.push(crate::index32(sources.elements.len()));
        }
        sources
    }

    /// Everything about an element's corner.
    fn corner(&self, solution: &Solution, id: NodeId, vertex: u32, irradiance: Rgb) -> Corner {
        let mesh = solution.mesh();
        let node = mesh.node(id);
        let NodeKind::Surface { face, .. } = node.kind else {
            unreachable!("elements are surfaces")
        };
        let face = &mesh.faces()[face as usize];
        let scene = mesh.scene();
        let instance = &scene.instances[face.instance as usize];
        let source = &scene.meshes[instance.mesh];
        let position = mesh.vertices()[vertex as usize];
        let (corners, weights) = face.weights_at(position);
        let mut corner = Corner {
            position,
            normal: node.normal,
            texcoords: [Vec2::ZERO; 2],
            color: Vec4::ONE,
            irradiance,
        };
        for (to, set) in corner.texcoords.iter_mut().zip(&source.texcoords) {
            *to = (0..3).map(|i| set[corners[i] as usize] * weights[i]).sum();
        }
        if !source.colors.is_empty() {
            corner.color = (0..3)
                .map(|i| source.colors[corners[i] as usize] * weights[i])
                .sum();
        }
        if !source.normals.is_empty() {
            let smooth: Vec3 = (0..3)
                .map(|i| source.normals[corners[i] as usize] * weights[i])
                .sum();
            let normal_from_mesh = instance.world_from_mesh.matrix3.inverse().transpose();
            let smooth =
                Vec3::from(normal_from_mesh * glam::Vec3A::from(smooth)).normalize_or_zero();
            // The face decides the side; a shading normal far from it is damaged.
            let turned = if smooth.dot(node.normal) < 0.0 {
                -smooth
            } else {
                smooth
            };
            if turned.dot(node.normal) > 0.2 {
                corner.normal = turned;
            }
        }
        corner
    }

    fn push(&mut self, corner: Corner) -> u32 {
        self.positions.push(corner.position);
        self.normals.push(corner.normal);
        self.texcoords.push(corner.texcoords);
        self.colors.push(corner.color);
        self.irradiance.push(corner.irradiance);
        crate::index32(self.positions.len() - 1)
    }
}

struct Corner {
    position: Vec3,
    normal: Vec3,
    texcoords: [Vec2; 2],
    color: Vec4,
    irradiance: Rgb,
}

/// Corners that agree in all of this are one vertex.
#[derive(Debug, PartialEq, Eq, Hash)]
struct VertexKey {
    vertex: u32,
    crease: u32,
    part: usize,
    bits: [u32; 11],
}

impl VertexKey {
    fn new(vertex: u32, crease: u32, part: usize, corner: &Corner) -> Self {
        let [a, b] = corner.texcoords;
        let (n, c) = (corner.normal, corner.color);
        let values = [a.x, a.y, b.x, b.y, n.x, n.y, n.z, c.x, c.y, c.z, c.w];
        // Adding 0 makes -0 and 0 the same.
        Self {
            vertex,
            crease,
            part,
            bits: values.map(|x| (x + 0.0).to_bits()),
        }
    }
}

/// For each element and corner the crease group around that vertex and its mean irradiance.
fn corner_irradiance(solution: &Solution) -> Vec<Vec<(u32, Rgb)>> {
    let mesh = solution.mesh();
    let elements = mesh.elements();
    let values: Vec<Rgb> = (0..elements.len())
        .into_par_iter()
        .map(|e| solution.element_irradiance(e))
        .collect();
    let around = elements_around_vertices(mesh);
    elements
        .par_iter()
        .map(|&id| {
            let normal = mesh.node(id).normal;
            mesh.corners(id)
                .iter()
                .map(|&vertex| {
                    let list = around.of(vertex).iter().copied();
                    let group: Vec<u32> = list
                        .filter(|&other| similar(element_normal(mesh, other), normal))
                        .collect();
                    // The group is named by its first element, so that all its members agree on the name.
                    let first = *group
                        .first()
                        .expect("an element lies around its own corner");
                    (first, mean_over(mesh, &values, &group))
                })
                .collect()
        })
        .collect()
}

/// The area-weighted mean of some elements' values.
fn mean_over(mesh: &PatchMesh, values: &[Rgb], elements: &[u32]) -> Rgb {
    let (mut sum, mut weights) = (Rgb::BLACK, 0.0);
    for &element in elements {
        let area = mesh.exposed_area(element as usize);
        sum += values[element as usize] * area;
        weights += area;
    }
    sum / weights.max(1e-30)
}

fn element_normal(mesh: &PatchMesh, element: u32) -> Vec3 {
    mesh.node(mesh.elements()[element as usize]).normal
}

fn similar(a: Vec3, b: Vec3) -> bool {
    a.dot(b) >= CREASE
}

/// Lists of the elements around each vertex, end to end.
struct Around {
    starts: Vec<u32>,
    elements: Vec<u32>,
}

impl Around {
    fn of(&self, vertex: u32) -> &[u32] {
        let v = vertex as usize;
        &self.elements[self.starts[v] as usize..self.starts[v + 1] as usize]
    }
}

fn elements_around_vertices(mesh: &PatchMesh) -> Around {
    let mut starts = vec![0_u32; mesh.vertices().len() + 1];
    for &id in mesh.elements() {
        for &vertex in mesh.corners(id) {
            starts[vertex as usize + 1] += 1;
        }
    }
    for v in 1..starts.len() {
        starts[v] += starts[v - 1];
    }
    let mut next = starts.clone();
    let mut elements = vec![0; starts.last().copied().unwrap_or(0) as usize];
    for (e, &id) in mesh.elements().iter().enumerate() {
        for &vertex in mesh.corners(id) {
            elements[next[vertex as usize] as usize] = crate::index32(e);
            next[vertex as usize] += 1;
        }
    }
    Around { starts, elements }
}
