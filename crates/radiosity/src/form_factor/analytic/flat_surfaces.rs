//! Faces that make one flat surface together.
//!
//! A wall that comes as a thousand quads is one wall: nothing of it sees another part of it, and as an occluder it is
//! one rectangle. Faces belong together that share an edge, lie in one plane and look the same way.

use crate::patch::face::WorldFace;
use glam::{DVec3, Vec3};
use std::collections::HashMap;

/// Corners of the outline up to which a surface counts as one convex polygon.
pub const MOST_CORNERS: usize = 6;
/// Cosines of normals and heights over the plane, as a share of the size, that count as flat.
const FLAT: f64 = 1e-6;

/// Which faces make which surface.
#[derive(Debug, Clone)]
pub struct FlatSurfaces {
    /// Of each face.
    pub of_face: Vec<u32>,
    /// Of each surface the convex polygon that it fills, if it does.
    pub outlines: Vec<Option<Vec<DVec3>>>,
}

impl FlatSurfaces {
    /// Of the faces of a scene; faces are only joined where `joins` says that both may be.
    pub fn new(faces: &[WorldFace], joins: impl Fn(&WorldFace, &WorldFace) -> bool) -> Self {
        let mut vertices = Numbered::default();
        let corners: Vec<Vec<u32>> = faces
            .iter()
            .map(|face| face.polygon().iter().map(|&c| vertices.number(c)).collect())
            .collect();
        let mut faces_of_edge: HashMap<(u32, u32), u32> = HashMap::new();
        for (face, corners) in corners.iter().enumerate() {
            for edge in edges(corners) {
                faces_of_edge.insert(edge, crate::index32(face));
            }
        }
        let mut groups = Groups::new(faces.len());
        for (face, corners) in corners.iter().enumerate() {
            for (a, b) in edges(corners) {
                let Some(&other) = faces_of_edge.get(&(b, a)) else {
                    continue;
                };
                let (one, two) = (&faces[face], &faces[other as usize]);
                if are_coplanar(one, two) && joins(one, two) {
                    groups.join(face, other as usize);
                }
            }
        }
        let (of_face, members) = groups.numbered();
        let outlines = members.iter().map(|members| {
            // Only flat as a whole: many small bends could make a curve.
            let first = &faces[members[0]];
            if !members
                .iter()
                .all(|&face| are_coplanar(first, &faces[face]))
            {
                return None;
            }
            let boundary = boundary(members.iter().map(|&face| corners[face].as_slice()))?;
            let outline: Vec<DVec3> = boundary
                .iter()
                .map(|&v| vertices.positions[v as usize].as_dvec3())
                .collect();
            convex_corners(&outline, first.normal.as_dvec3())
        });
        let outlines: Vec<Option<Vec<DVec3>>> = outlines.collect();
        Self::split_bent(of_face, members, outlines, faces)
    }

    /// Surfaces that are not flat as a whole are taken apart again.
    fn split_bent(
        mut of_face: Vec<u32>,
        members: Vec<Vec<usize>>,
        mut outlines: Vec<Option<Vec<DVec3>>>,
        faces: &[WorldFace],
    ) -> Self {
        for members in members {
            let first = &faces[members[0]];
            if members
                .iter()
                .all(|&face| are_coplanar(first, &faces[face]))
            {
                continue;
            }
            for &face in &members[1..] {
                of_face[face] = crate::index32(outlines.len());
                outlines.push(None);
            }
        }
        Self { of_face, outlines }
    }
}

/// Vertices by their exact position.
#[derive(Default)]
struct Numbered {
    numbers: HashMap<[u32; 3], u32>,
    positions: Vec<Vec3>,
}

impl Numbered {
    fn number(&mut self, position: Vec3) -> u32 {
        // -0 and 0 are the same place.
        let key = (position + Vec3::ZERO).to_array().map(f32::to_bits);
        *self.numbers.entry(key).or_insert_with(|| {
            self.positions.push(position);
            crate::index32(self.positions.len() - 1)
        })
    }
}

/// Sets of faces that grow together (union-find with path halving).
struct Groups(Vec<usize>);

impl Groups {
    fn new(count: usize) -> Self {
        Self((0..count).collect())
    }

    fn root(&mut self, mut i: usize) -> usize {
        while self.0[i] != i {
            self.0[i] = self.0[self.0[i]];
            i = self.0[i];
        }
        i
    }

    fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.root(a), self.root(b));
        // The smaller number stays, so that the order of joining does not matter.
        self.0[a.max(b)] = a.min(b);
    }

    /// The group of each face, numbered in the order of their first faces, and the faces of each group.
    fn numbered(mut self) -> (Vec<u32>, Vec<Vec<usize>>) {
        let mut of_face = Vec::with_capacity(self.0.len());
        let mut members: Vec<Vec<usize>> = Vec::new();
        for face in 0..self.0.len() {
            let root = self.root(face);
            let group = if root == face {
                members.push(Vec::new());
                crate::index32(members.len() - 1)
            } else {
                of_face[root]
            };
            of_face.push(group);
            members[group as usize].push(face);
        }
        (of_face, members)
    }
}

fn edges(corners: &[u32]) -> impl Iterator<Item = (u32, u32)> + '_ {
    (0..corners.len()).map(|i| (corners[i], corners[(i + 1) % corners.len()]))
}

fn are_coplanar(a: &WorldFace, b: &WorldFace) -> bool {
    let (normal, other) = (a.normal.as_dvec3(), b.normal.as_dvec3());
    let origin = a.corners[0].as_dvec3();
    let size = b
        .polygon()
        .iter()
        .map(|c| c.as_dvec3().distance(origin))
        .fold(0.0, f64::max);
    let is_in_plane = |c: &Vec3| (c.as_dvec3() - origin).dot(normal).abs() <= FLAT * size;
    1.0 - normal.dot(other) <= FLAT && b.polygon().iter().all(is_in_plane)
}

/// The only loop of edges that have a face on one side; `None` if there is more than one, or a vertex comes up twice.
fn boundary<'a>(faces: impl Iterator<Item = &'a [u32]> + Clone) -> Option<Vec<u32>> {
    let mut next: HashMap<u32, u32> = HashMap::new();
    let inner: std::collections::HashSet<(u32, u32)> = faces.clone().flat_map(edges).collect();
    let mut start = u32::MAX;
    for (a, b) in faces.flat_map(edges) {
        if !inner.contains(&(b, a)) {
            if next.insert(a, b).is_some() {
                return None;
            }
            start = start.min(a);
        }
    }
    let mut outline = vec![start];
    let mut at = *next.get(&start)?;
    while at != start {
        outline.push(at);
        at = *next.get(&at)?;
        if outline.len() > next.len() {
            return None;
        }
    }
    (outline.len() == next.len()).then_some(outline)
}

/// The outline without corners that lie on a straight edge, if it is convex and has few corners.
fn convex_corners(outline: &[DVec3], normal: DVec3) -> Option<Vec<DVec3>> {
    let n = outline.len();
    let mut corners = Vec::new();
    for i in 0..n {
        let (before, here, after) = (outline[(i + n - 1) % n], outline[i], outline[(i + 1) % n]);
        let (to, from) = (here - before, after - here);
        let turn = to.cross(from).dot(normal) / (to.length() * from.length());
        if turn < -FLAT {
            return None;
        }
        if turn > FLAT || to.dot(from) < 0.0 {
            corners.push(here);
        }
    }
    (3..=MOST_CORNERS)
        .contains(&corners.len())
        .then_some(corners)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Quads of a grid over the unit square at a height given for each vertex; the cells that `keeps` says.
    fn grid(
        n: u16,
        height: impl Fn(f32, f32) -> f32,
        keeps: impl Fn(u16, u16) -> bool,
    ) -> Vec<WorldFace> {
        let at = |i: u16, j: u16| {
            let (x, y) = (f32::from(i) / f32::from(n), f32::from(j) / f32::from(n));
            Vec3::new(x, y, height(x, y))
        };
        let mut faces = Vec::new();
        for i in 0..n {
            for j in (0..n).filter(|&j| keeps(i, j)) {
                let corners = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
                let normal = crate::patch::face::newell_normal(&corners).normalize();
                faces.push(WorldFace {
                    corners,
                    mesh_corners: [0; 4],
                    corner_count: 4,
                    normal,
                    instance: 0,
                    face: 0,
                    material: 0,
                });
            }
        }
        faces
    }

    #[test]
    fn a_grid_is_one_square() {
        let surfaces = FlatSurfaces::new(&grid(7, |_, _| 0.0, |_, _| true), |_, _| true);
        assert_eq!(surfaces.of_face, [0; 49], "all are of one");
        let outline = surfaces.outlines[0].as_ref().expect("it is convex");
        assert_eq!(outline.len(), 4, "its corners: {outline:?}");
    }

    #[test]
    fn a_grid_with_a_hole_or_a_notch_is_one_surface_without_outline() {
        for hole in [(3, 3), (0, 3), (0, 0)] {
            let faces = grid(7, |_, _| 0.0, |i, j| (i, j) != hole);
            let surfaces = FlatSurfaces::new(&faces, |_, _| true);
            assert_eq!(surfaces.of_face, [0; 48], "all are of one");
            assert!(surfaces.outlines[0].is_none(), "without {hole:?}");
        }
    }

    #[test]
    fn a_roof_is_two_surfaces_and_a_curve_none() {
        let roof = FlatSurfaces::new(
            &grid(4, |x, _| 0.5 - (x - 0.5).abs(), |_, _| true),
            |_, _| true,
        );
        assert_eq!(roof.of_face, [[0; 8], [1; 8]].concat(), "left and right");
        // Each fold is within the tolerance of its neighbour, the whole is not.
        let curve = FlatSurfaces::new(&grid(64, |x, _| 1e-2 * x * x, |_, j| j == 0), |_, _| true);
        let distinct: std::collections::BTreeSet<u32> = curve.of_face.iter().copied().collect();
        assert!(
            distinct.len() > 32,
            "a curve is not one flat surface: {}",
            distinct.len()
        );
    }

    #[test]
    fn faces_that_may_not_be_joined_stay_apart() {
        let surfaces = FlatSurfaces::new(&grid(2, |_, _| 0.0, |_, _| true), |_, _| false);
        assert_eq!(surfaces.of_face, [0, 1, 2, 3], "each is one");
        assert!(
            surfaces.outlines.iter().all(Option::is_some),
            "each is convex"
        );
    }
}
