//! Tangents of the triangles whose material has a relief.

use crate::sight::SurfaceHit;
use glam::{Vec2, Vec3, Vec4};
use hemicube_radiosity::drawn::{DrawnMesh, DrawnPart};
use hemicube_radiosity::patch::face::{Side, WorldFace};
use hemicube_radiosity::patch::{NodeKind, PatchMesh};
use hemicube_raster::bump::tangents::{IndexedTriangles, corner_tangents};
use hemicube_scene::{Mesh, TextureSlot};
use std::collections::HashMap;

/// The tangents of a triangle's corners in the world.
#[derive(Debug, Clone, Copy)]
pub struct TangentFrame {
    /// Towards growing u, of unit length, and the sign of the bitangent `w N × T`, where `N` is the normal of the side
    /// that the relief was made for.
    pub corners: [Vec4; 3],
    /// Whether the triangle shows the other side.
    pub is_turned: bool,
}

/// Tangents of all triangles whose material has a relief, by their number among those of the drawn mesh's parts, one part
/// after the other.
#[derive(Debug, Default)]
pub struct Tangents(HashMap<u32, TangentFrame>);

impl Tangents {
    /// The file's tangents, or those of MikkTSpace, which each mesh gets once; `drawn` is a drawn mesh of `mesh`.
    pub fn new(mesh: &PatchMesh, drawn: &DrawnMesh) -> Self {
        let scene = mesh.scene();
        let mut of_meshes = HashMap::new();
        let (mut frames, mut number) = (HashMap::new(), 0);
        for part in &drawn.parts {
            if let Some(relief) = scene.materials[part.material].relief {
                let source = scene.instances[part.instance].mesh;
                let tangents = of_meshes
                    .entry(source)
                    .or_insert_with(|| MeshTangents::of(&scene.meshes[source], relief.slot));
                for (numbered, frame) in (number..).zip(of_part(mesh, drawn, part, tangents)) {
                    frames.insert(numbered, frame);
                }
            }
            number += u32::try_from(part.triangles.len()).expect("fewer than 2^32 triangles");
        }
        Self(frames)
    }

    /// The frame of a triangle; none without a relief.
    pub fn of_triangle(&self, number: u32) -> Option<&TangentFrame> {
        self.0.get(&number)
    }

    /// The frame at a hit.
    pub(crate) fn of(&self, hit: &SurfaceHit) -> Option<&TangentFrame> {
        self.of_triangle(hit.triangle)
    }
}

/// The frames of a part's triangles.
fn of_part<'t>(
    mesh: &'t PatchMesh,
    drawn: &'t DrawnMesh,
    part: &'t DrawnPart,
    tangents: &'t MeshTangents,
) -> impl Iterator<Item = TangentFrame> + 't {
    let instance = &mesh.scene().instances[part.instance];
    let matrix = instance.world_from_mesh.matrix3;
    let mirror = if matrix.determinant() < 0.0 {
        -1.0
    } else {
        1.0
    };
    let triangles = part.triangles.iter().zip(&part.elements);
    triangles.map(move |(corners, &element)| {
        let NodeKind::Surface { face, side } = mesh.node(mesh.elements()[element as usize]).kind
        else {
            unreachable!("elements are surfaces")
        };
        let world = &mesh.faces()[face as usize];
        let corner = |c: u32| {
            let tangent = tangents.at(world, drawn.positions[c as usize]);
            let along = Vec3::from(matrix * glam::Vec3A::from(tangent.truncate()));
            along.normalize_or_zero().extend(tangent.w * mirror)
        };
        TangentFrame {
            corners: corners.map(corner),
            is_turned: (side == Side::Back) != instance.flipped,
        }
    })
}

/// Tangents of a mesh in its own space.
#[derive(Debug)]
enum MeshTangents {
    /// Of each vertex.
    Vertices(Vec<Vec4>),
    /// Of each corner of the triangles that each face is cut into, with those corners' vertices.
    Corners {
        /// First triangle of each face, and the number of all.
        starts: Vec<usize>,
        triangles: Vec<[u32; 3]>,
        tangents: Vec<[Vec4; 3]>,
    },
}

impl MeshTangents {
    fn of(mesh: &Mesh, slot: TextureSlot) -> Self {
        if !mesh.tangents.is_empty() {
            return Self::Vertices(mesh.tangents.clone());
        }
        let (mut starts, mut triangles) = (vec![0], Vec::new());
        for face in &mesh.faces {
            let c = face.corners();
            triangles.extend((1..c.len() - 1).map(|i| [c[0], c[i], c[i + 1]]));
            starts.push(triangles.len());
        }
        Self::Corners {
            tangents: computed(mesh, slot, &triangles),
            starts,
            triangles,
        }
    }

    /// The tangent at a point of a face.
    fn at(&self, face: &WorldFace, point: Vec3) -> Vec4 {
        let (corners, weights) = face.weights_at(point);
        let tangents = match self {
            Self::Vertices(tangents) => corners.map(|c| tangents[c as usize]),
            Self::Corners {
                starts,
                triangles,
                tangents,
            } => {
                // Two faces may have been merged into one.
                let first = face.face as usize;
                let range = starts[first]..starts[(first + 2).min(starts.len() - 1)];
                corners.map(|c| {
                    of_corner(
                        c,
                        corners,
                        &triangles[range.clone()],
                        &tangents[range.clone()],
                    )
                })
            }
        };
        let sum: Vec3 = (0..3).map(|i| tangents[i].truncate() * weights[i]).sum();
        sum.extend(tangents[0].w)
    }
}

/// The tangent of a vertex in the triangle that shares most corners with these three.
fn of_corner(
    vertex: u32,
    corners: [u32; 3],
    triangles: &[[u32; 3]],
    tangents: &[[Vec4; 3]],
) -> Vec4 {
    let shared = |t: &[u32; 3]| t.iter().filter(|c| corners.contains(c)).count();
    let holds = triangles.iter().zip(tangents).filter_map(|(t, tangents)| {
        let place = t.iter().position(|&c| c == vertex)?;
        Some((shared(t), tangents[place]))
    });
    // The first of equals.
    let best = holds.reduce(|best, next| if next.0 > best.0 { next } else { best });
    best.map_or(Vec4::new(1.0, 0.0, 0.0, 1.0), |(_, tangent)| tangent)
}

/// MikkTSpace's tangents over the relief's coordinates; a mesh without normals is faceted, as glTF asks.
fn computed(mesh: &Mesh, slot: TextureSlot, triangles: &[[u32; 3]]) -> Vec<[Vec4; 3]> {
    let texcoords: Vec<Vec2> = match mesh.texcoords.get(slot.texcoord_set) {
        Some(set) => set.iter().map(|&uv| slot.coordinates(uv)).collect(),
        None => vec![Vec2::ZERO; mesh.positions.len()],
    };
    if !mesh.normals.is_empty() {
        let whole = IndexedTriangles {
            positions: &mesh.positions,
            normals: &mesh.normals,
            texcoords: &texcoords,
            triangles,
        };
        return tangents_of(&whole);
    }
    let corners = || triangles.iter().flatten().map(|&c| c as usize);
    let positions: Vec<Vec3> = corners().map(|c| mesh.positions[c]).collect();
    let texcoords: Vec<Vec2> = corners().map(|c| texcoords[c]).collect();
    let flat = |t: &[Vec3]| [(t[1] - t[0]).cross(t[2] - t[0]).normalize_or_zero(); 3];
    let normals: Vec<Vec3> = positions.chunks_exact(3).flat_map(flat).collect();
    let numbers: Vec<u32> = (0..).take(positions.len()).collect();
    let apart: Vec<[u32; 3]> = numbers
        .chunks_exact(3)
        .map(|t| [t[0], t[1], t[2]])
        .collect();
    tangents_of(&IndexedTriangles {
        positions: &positions,
        normals: &normals,
        texcoords: &texcoords,
        triangles: &apart,
    })
}

fn tangents_of(triangles: &IndexedTriangles<'_>) -> Vec<[Vec4; 3]> {
    corner_tangents(triangles).expect("a scene's indices and arrays were checked")
}
