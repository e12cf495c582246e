//! Meshes to put on the stage.

use core::f32::consts::{PI, TAU};
use glam::{Vec2, Vec3, Vec4};
use hemicube_raster::bump::tangents::{IndexedTriangles, corner_tangents, split_vertices};

/// A corner of triangles.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Vertex {
    /// Place in the world.
    pub position: Vec3,
    /// Outward normal of length 1.
    pub normal: Vec3,
    /// Origin in the upper left corner, u right, v down.
    pub texcoord: Vec2,
    /// Tangent towards growing u, and the bitangent's sign as in glTF.
    pub tangent: Vec4,
}

impl Vertex {
    /// A corner whose tangent will be found.
    pub fn new(position: Vec3, normal: Vec3, texcoord: Vec2) -> Self {
        Self {
            position,
            normal,
            texcoord,
            tangent: Vec4::ZERO,
        }
    }
}

/// Triangles, counter-clockwise from outside.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Mesh {
    /// Corners.
    pub vertices: Vec<Vertex>,
    /// Three corners each.
    pub triangles: Vec<[u32; 3]>,
}

impl Mesh {
    /// Triangles with the tangents of their texture.
    pub fn new(vertices: Vec<Vertex>, triangles: Vec<[u32; 3]>) -> Self {
        Self {
            vertices,
            triangles,
        }
        .with_tangents()
    }

    fn with_tangents(self) -> Self {
        let positions: Vec<Vec3> = self.vertices.iter().map(|v| v.position).collect();
        let normals: Vec<Vec3> = self.vertices.iter().map(|v| v.normal).collect();
        let texcoords: Vec<Vec2> = self.vertices.iter().map(|v| v.texcoord).collect();
        let tangents = corner_tangents(&IndexedTriangles {
            positions: &positions,
            normals: &normals,
            texcoords: &texcoords,
            triangles: &self.triangles,
        });
        let tangents = tangents.expect("meshes of the stage have their vertices");
        let split = split_vertices(positions.len(), &self.triangles, &tangents);
        let vertex = |(&source, &tangent): (&u32, &Vec4)| Vertex {
            tangent,
            ..self.vertices[source as usize]
        };
        Self {
            vertices: split
                .sources
                .iter()
                .zip(&split.tangents)
                .map(vertex)
                .collect(),
            triangles: split.triangles,
        }
    }

    /// A surface over `(u, v)` in the unit square, in `columns` by `rows` quads; seen from outside u goes right, v down.
    /// `surface` gives place and outward normal.
    pub fn parametric(columns: u16, rows: u16, surface: impl Fn(f32, f32) -> (Vec3, Vec3)) -> Self {
        let mut vertices = Vec::new();
        for j in 0..=rows {
            for i in 0..=columns {
                let (u, v) = (
                    f32::from(i) / f32::from(columns),
                    f32::from(j) / f32::from(rows),
                );
                let (position, normal) = surface(u, v);
                vertices.push(Vertex::new(position, normal, Vec2::new(u, v)));
            }
        }
        let stride = u32::from(columns) + 1;
        let mut triangles = Vec::new();
        for j in 0..u32::from(rows) {
            for i in 0..u32::from(columns) {
                let a = j * stride + i;
                triangles.push([a, a + stride, a + 1]);
                triangles.push([a + 1, a + stride, a + stride + 1]);
            }
        }
        triangles.retain(|triangle| has_area(triangle.map(|i| vertices[i as usize].position)));
        Self::new(vertices, triangles)
    }

    /// A square of such a side in the plane y = 0, facing +Y; u along +X, v along +Z.
    pub fn plane(side: f32, quads: u16) -> Self {
        Self::parametric(quads, quads, |u, v| {
            (Vec3::new(u - 0.5, 0.0, v - 0.5) * side, Vec3::Y)
        })
    }

    /// A sphere around the origin; u runs around +Y from -Z over -X and +Z, v from the pole at +Y to that at -Y.
    pub fn sphere(radius: f32, columns: u16) -> Self {
        Self::parametric(columns, columns / 2, |u, v| {
            let (sin, cos) = (PI * v).sin_cos();
            let normal = around(u) * sin + Vec3::Y * cos;
            (normal * radius, normal)
        })
    }

    /// A torus around +Y; v runs around the tube, from inside over the upper half.
    pub fn torus(major: f32, minor: f32, columns: u16) -> Self {
        Self::parametric(columns, columns / 2, |u, v| {
            let (sin, cos) = (TAU * v).sin_cos();
            let normal = around(u) * -cos + Vec3::Y * sin;
            (around(u) * major + normal * minor, normal)
        })
    }

    /// The surface that a profile makes as it turns around +Y. The profile is a Catmull-Rom spline through points
    /// `(radius, height)` from top to bottom.
    pub fn revolution(profile: &[Vec2], columns: u16, rows: u16) -> Self {
        Self::parametric(columns, rows, |u, v| {
            let (point, slope) = catmull_rom(profile, v);
            // The profile goes down, so its outer side is on the left.
            let outward = Vec2::new(-slope.y, slope.x).normalize_or(Vec2::X);
            let direction = around(u);
            (
                direction * point.x + Vec3::Y * point.y,
                direction * outward.x + Vec3::Y * outward.y,
            )
        })
    }

    /// A vase of height 2 around the origin.
    pub fn vase(columns: u16) -> Self {
        const PROFILE: [[f32; 2]; 9] = [
            [0.52, 1.0],
            [0.40, 0.86],
            [0.32, 0.62],
            [0.46, 0.30],
            [0.72, -0.05],
            [0.74, -0.40],
            [0.52, -0.75],
            [0.40, -0.90],
            [0.46, -1.0],
        ];
        Self::revolution(&PROFILE.map(Vec2::from), columns, columns)
    }

    /// A cube of such a side around the origin, each face with the whole texture.
    pub fn cube(side: f32) -> Self {
        let faces = [
            (Vec3::X, Vec3::NEG_Z),
            (Vec3::NEG_X, Vec3::Z),
            (Vec3::Y, Vec3::X),
            (Vec3::NEG_Y, Vec3::X),
            (Vec3::Z, Vec3::X),
            (Vec3::NEG_Z, Vec3::NEG_X),
        ];
        let mut cube = Self::default();
        for (normal, right) in faces {
            let down = right.cross(normal);
            let mut face = Self::parametric(1, 1, |u, v| {
                let place = normal * 0.5 + right * (u - 0.5) + down * (v - 0.5);
                (place * side, normal)
            });
            let first = cube.vertices.len();
            let shift = |t: [u32; 3]| t.map(|i| i + u32::try_from(first).expect("24 vertices"));
            cube.vertices.append(&mut face.vertices);
            cube.triangles.extend(face.triangles.into_iter().map(shift));
        }
        cube
    }

    /// The mesh with its vertices moved along their normals by `height` of them, and new normals: means of the
    /// triangles', weighted by area, over all vertices of one place.
    pub fn displaced(&self, height: impl Fn(&Vertex) -> f32) -> Self {
        let mut mesh = self.clone();
        for vertex in &mut mesh.vertices {
            vertex.position += vertex.normal * height(vertex);
        }
        let mut sums = std::collections::HashMap::<[u32; 3], Vec3>::new();
        // Both ends of a seam count as one place although rounding moves them apart.
        let place = |p: Vec3| p.to_array().map(|c| ((c * 1e4).round() + 0.0).to_bits());
        for triangle in &mesh.triangles {
            let [a, b, c] = triangle.map(|i| mesh.vertices[i as usize].position);
            let area = (b - a).cross(c - a);
            for corner in [a, b, c] {
                *sums.entry(place(corner)).or_default() += area;
            }
        }
        for vertex in &mut mesh.vertices {
            let sum = sums
                .get(&place(vertex.position))
                .copied()
                .unwrap_or(Vec3::ZERO);
            vertex.normal = sum.normalize_or(vertex.normal);
        }
        mesh.with_tangents()
    }

    /// The mesh turned by `rotation` and moved by `offset`.
    pub fn moved(&self, rotation: glam::Quat, offset: Vec3) -> Self {
        let vertices = self.vertices.iter().map(|v| Vertex {
            position: rotation * v.position + offset,
            normal: rotation * v.normal,
            tangent: (rotation * v.tangent.truncate()).extend(v.tangent.w),
            ..*v
        });
        Self {
            vertices: vertices.collect(),
            triangles: self.triangles.clone(),
        }
    }
}

/// Whether no two corners are the same up to rounding, as two at a pole are.
fn has_area([a, b, c]: [Vec3; 3]) -> bool {
    let size = a.abs().max(b.abs()).max(c.abs()).max_element();
    let apart = |p: Vec3, q: Vec3| p.distance(q) > 1e-6 * size;
    apart(a, b) && apart(b, c) && apart(c, a)
}

/// Horizontal direction at a share of a turn; u = 1/2 faces +Z, and seen from outside it goes right.
fn around(u: f32) -> Vec3 {
    let (sin, cos) = (TAU * u).sin_cos();
    Vec3::new(-sin, 0.0, -cos)
}

/// Point and derivative of a Catmull-Rom spline through points, at a share of its way; its ends go straight on.
fn catmull_rom(points: &[Vec2], share: f32) -> (Vec2, Vec2) {
    let spans = points.len().saturating_sub(1).max(1);
    let at = share.clamp(0.0, 1.0) * spans as f32;
    let span = (0..spans)
        .take_while(|&i| i as f32 <= at)
        .last()
        .unwrap_or(0);
    let get = |i: usize| points.get(i).copied().unwrap_or(Vec2::ZERO);
    let (p1, p2) = (get(span), get(span + 1));
    let p0 = if span == 0 {
        p1 * 2.0 - p2
    } else {
        get(span - 1)
    };
    let p3 = points.get(span + 2).copied().unwrap_or(p2 * 2.0 - p1);
    let t = at - span as f32;
    let (m1, m2) = ((p2 - p0) * 0.5, (p3 - p1) * 0.5);
    let (c, d) = ((p2 - p1) * 3.0 - m1 * 2.0 - m2, (p1 - p2) * 2.0 + m1 + m2);
    (
        p1 + (m1 + (c + d * t) * t) * t,
        m1 + (c * 2.0 + d * (3.0 * t)) * t,
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Meshes with the largest angle (its cosine) between a vertex's normal and a triangle's.
    fn meshes() -> [(&'static str, Mesh, f32); 5] {
        [
            ("plane", Mesh::plane(1.0, 3), 0.999),
            ("sphere", Mesh::sphere(1.0, 64), 0.99),
            ("torus", Mesh::torus(1.0, 0.4, 64), 0.98),
            ("vase", Mesh::vase(64), 0.9),
            ("cube", Mesh::cube(1.0), 0.999),
        ]
    }

    #[test]
    fn triangles_face_along_their_normals() {
        for (name, mesh, cosine) in meshes() {
            for triangle in &mesh.triangles {
                let [a, b, c] = triangle.map(|i| mesh.vertices[i as usize]);
                let area = (b.position - a.position).cross(c.position - a.position);
                let Some(facing) = area.try_normalize() else {
                    continue;
                };
                for corner in [a, b, c] {
                    let dot = facing.dot(corner.normal);
                    assert!(dot > cosine, "{name}: {dot} at {}", corner.position);
                }
            }
        }
    }

    #[test]
    fn textures_are_not_mirrored() {
        for (name, mesh, _) in meshes() {
            for triangle in &mesh.triangles {
                let [a, b, c] = triangle.map(|i| mesh.vertices[i as usize].texcoord);
                let area = (b - a).perp_dot(c - a);
                assert!(area < 0.0, "{name}: v points down, so {area} is below 0");
            }
        }
    }

    #[test]
    fn displacing_by_nothing_changes_nothing() {
        let sphere = Mesh::sphere(1.0, 64);
        let same = sphere.displaced(|_| 0.0);
        for (a, b) in sphere.vertices.iter().zip(&same.vertices) {
            assert_eq!(a.position, b.position);
            assert!(a.normal.dot(b.normal) > 0.999, "{} {}", a.normal, b.normal);
        }
    }
}
