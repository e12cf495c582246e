//! The mesh as it is drawn: vertices with irradiance, split where light, material or texture coordinates break.
//!
//! Elements carry constant values; a vertex takes [what those around it tell](crate::vertex_light), so light is
//! continuous over smooth surfaces and breaks at edges.

use crate::patch::{NodeId, NodeKind, PatchMesh};
use crate::solution::Solution;
use crate::vertex_light::Fans;
pub use crate::vertex_light::LightSources;
use glam::{Vec2, Vec3, Vec4};
use hemicube_raster::Rgb;
use rayon::prelude::*;
use std::collections::HashMap;

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
    /// For each vertex the part of a fan that lights it.
    fan_parts: Vec<u32>,
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
        let mesh = solution.mesh();
        let fans = Fans::new(mesh);
        let light = fans.means(&element_irradiance(solution));
        let mut drawn = Self::with_capacity(light.len());
        let mut known = Known::new(light.len());
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
                .zip(fans.of_element(e))
                .map(|(&vertex, &fan_part)| {
                    let irradiance = light[fan_part as usize] + extra;
                    let corner = drawn.corner(solution, id, vertex, irradiance);
                    known.vertex(&mut drawn, fan_part, part, corner)
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

    /// Where the light of each vertex comes from; `mesh` is the one that this was made of.
    pub fn light_sources(&self, mesh: &PatchMesh) -> LightSources {
        LightSources::new(&Fans::new(mesh), &self.fan_parts)
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

    /// Room for so many vertices; there are more where one part of a fan has corners of several kinds.
    fn with_capacity(vertices: usize) -> Self {
        Self {
            positions: Vec::with_capacity(vertices),
            normals: Vec::with_capacity(vertices),
            texcoords: Vec::with_capacity(vertices),
            colors: Vec::with_capacity(vertices),
            irradiance: Vec::with_capacity(vertices),
            parts: Vec::new(),
            fan_parts: Vec::with_capacity(vertices),
        }
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

#[derive(Debug, Clone, Copy)]
struct Corner {
    position: Vec3,
    normal: Vec3,
    texcoords: [Vec2; 2],
    color: Vec4,
    irradiance: Rgb,
}

/// Vertices that a corner is compared with at most.
const MOST_LOOKS: usize = 64;

/// Vertices that were pushed, by the part of a fan: most have one. A table with a key for each would be the largest thing
/// in memory while a file is written.
///
/// A part of a fan has few kinds of corners; beyond [`MOST_LOOKS`] a vertex that is there twice does no harm.
struct Known {
    /// For each part of a fan the last vertex, or [`Self::NONE`].
    last: Vec<u32>,
    /// For each vertex the one before it of the same part of a fan, and its drawn part.
    before: Vec<(u32, u32)>,
}

impl Known {
    const NONE: u32 = u32::MAX;

    fn new(fan_parts: usize) -> Self {
        Self {
            last: vec![Self::NONE; fan_parts],
            before: Vec::with_capacity(fan_parts),
        }
    }

    /// The vertex of a corner, pushed if there is none like it.
    fn vertex(&mut self, drawn: &mut DrawnMesh, fan_part: u32, part: usize, corner: Corner) -> u32 {
        let part = crate::index32(part);
        let last = self.last[fan_part as usize];
        let mut vertex = last;
        for _ in 0..MOST_LOOKS {
            let Some(&(before, of_part)) = self.before.get(vertex as usize) else {
                break;
            };
            if of_part == part && corner.is_vertex(drawn, vertex as usize) {
                return vertex;
            }
            vertex = before;
        }
        self.before.push((last, part));
        drawn.fan_parts.push(fan_part);
        let vertex = drawn.push(corner);
        self.last[fan_part as usize] = vertex;
        vertex
    }
}

impl Corner {
    /// Whether it agrees with a vertex in all that a file or a picture takes from it. Light is that of the part of the fan.
    fn is_vertex(&self, drawn: &DrawnMesh, vertex: usize) -> bool {
        self.texcoords == drawn.texcoords[vertex]
            && self.normal == drawn.normals[vertex]
            && self.color == drawn.colors[vertex]
    }
}

/// Irradiance of all elements from all groups as dimmed.
pub(crate) fn element_irradiance(solution: &Solution) -> Vec<Rgb> {
    let elements = 0..solution.mesh().elements().len();
    elements
        .into_par_iter()
        .map(|e| solution.element_irradiance(e))
        .collect()
}
