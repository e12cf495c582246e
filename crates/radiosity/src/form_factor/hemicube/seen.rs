//! What a hemicube may see: everything above its plane, in its own frame, with the faces it may appear on.

use super::{Hemicube, Item, LAG};
use crate::form_factor::delta_factors::{CubeFace, Projection};
use crate::form_factor::viewpoints::Viewpoint;
use crate::patch::face::Side;
use crate::patch::{NodeKind, PatchMesh};
use glam::{Vec3, Vec4};

/// What hemicubes ask of an element, side by side in memory.
#[derive(Debug, Clone, Copy)]
pub(super) struct Receiver {
    /// Vertices; the fourth repeats the third for triangles.
    corners: [u32; 4],
    is_quad: bool,
    /// Whether its other side is an element too.
    both_receive: bool,
    is_exposed: bool,
    centroid: Vec3,
    normal: Vec3,
}

impl Receiver {
    pub(super) fn new(mesh: &PatchMesh, element: usize) -> Self {
        let id = mesh.elements()[element];
        let node = mesh.node(id);
        let NodeKind::Surface { face, side } = node.kind else {
            unreachable!("elements are surfaces")
        };
        let both_receive = mesh.visibility().receives(face as usize, Side::Back);
        debug_assert!(
            both_receive || side == Side::Front,
            "backs of one-sided faces are no elements"
        );
        Self {
            corners: four(mesh.corners(id)),
            is_quad: mesh.corners(id).len() == 4,
            both_receive,
            is_exposed: mesh.exposed_area(element) > 0.0,
            centroid: node.centroid,
            normal: node.normal,
        }
    }
}

/// Vertices of an element; the fourth repeats the third of a triangle.
fn four(corners: &[u32]) -> [u32; 4] {
    [0, 1, 2, 3].map(|k: usize| corners[k.min(corners.len() - 1)])
}

/// What may be seen from a hemicube.
#[derive(Debug)]
pub(super) struct Seen {
    /// The mesh's vertices in the hemicube's frame.
    vertices: Vec<Vec3>,
    /// Elements and obstructions above the plane. Of equal depths the first drawn stays: fronts come before backs.
    items: Vec<SeenItem>,
    /// Distance of the near planes.
    near: f32,
}

#[derive(Debug, Clone, Copy)]
struct SeenItem {
    corners: [u32; 4],
    is_quad: bool,
    /// One bit for each face that it may appear on, in the order of [`Projection::faces`].
    faces: u8,
    /// Packed.
    item: u32,
    is_back: bool,
}

/// Corners in clip space, as many as the element has.
#[derive(Debug, Clone, Copy)]
pub(super) enum Corners {
    Triangle([Vec4; 3]),
    Quad([Vec4; 4]),
}

impl Corners {
    /// The one or two triangles.
    pub(super) fn triangles(&self) -> impl Iterator<Item = [Vec4; 3]> {
        let (first, second) = match *self {
            Self::Triangle(corners) => (corners, None),
            Self::Quad([a, b, c, d]) => ([a, b, c], Some([a, c, d])),
        };
        core::iter::once(first).chain(second)
    }
}

impl Seen {
    pub(super) fn new(hemicube: &Hemicube, view: &Viewpoint) -> Self {
        let (mesh, viewpoints) = (&*hemicube.mesh, &hemicube.viewpoints);
        let [t, b, n] = view.axes;
        let in_frame = |&v: &Vec3| {
            let d = v - view.origin;
            Vec3::new(d.dot(t), d.dot(b), d.dot(n))
        };
        let vertices: Vec<Vec3> = mesh.vertices().iter().map(in_frame).collect();
        let beyond: Vec<u16> = vertices.iter().map(|&v| planes_beyond(v)).collect();
        let common = |corners: &[u32; 4]| {
            let planes = corners.iter().map(|&c| beyond[c as usize]);
            planes.fold(u16::MAX, |common, beyond| common & beyond)
        };
        let projection = hemicube.options.projection;
        let faces = |common: u16| match projection {
            Projection::Hemicube => faces_within(common),
            Projection::CubicTetrahedron | Projection::SinglePlane => u8::MAX,
        };
        let (mut items, mut backs) = (Vec::with_capacity(hemicube.receivers.len()), Vec::new());
        let mut nearest = mesh.visibility().diameter();
        for (element, receiver) in hemicube.receivers.iter().enumerate() {
            let common = common(&receiver.corners);
            let from_behind = (view.origin - receiver.centroid).dot(receiver.normal) <= 0.0;
            // The other side of a double-sided face is an element of its own.
            if common & NOT_ABOVE != 0 || from_behind && receiver.both_receive {
                continue;
            }
            nearest = viewpoints.nearer(view.origin, element, nearest);
            let is_back = from_behind || !receiver.is_exposed;
            let list = if is_back { &mut backs } else { &mut items };
            list.push(SeenItem {
                corners: receiver.corners,
                is_quad: receiver.is_quad,
                faces: faces(common),
                item: Item { element, is_back }.pack(),
                is_back,
            });
        }
        for (_, cell) in mesh.obstructions() {
            let corners = four(cell.corners());
            let common = common(&corners);
            if common & NOT_ABOVE == 0 {
                backs.push(SeenItem {
                    corners,
                    is_quad: cell.corners().len() == 4,
                    faces: faces(common),
                    item: hemicube.obstruction(),
                    is_back: true,
                });
            }
        }
        items.append(&mut backs);
        let nearest = viewpoints.nearer_obstruction(view.origin, nearest);
        // The depth buffer is the finer the farther its near plane.
        let near = (projection.least_depth() * nearest).max(mesh.visibility().offset(view.origin));
        Self {
            vertices,
            items,
            near,
        }
    }

    /// Calls `draw` with each element that may be in the picture of a face, and its packed item.
    pub(super) fn for_each_element(&self, face: CubeFace, mut draw: impl FnMut(&Corners, u32)) {
        let bit = 1 << face.number();
        for seen in self.items.iter().filter(|seen| seen.faces & bit != 0) {
            let lag = if seen.is_back { LAG * self.near } else { 0.0 };
            let [a, b, c, d] = seen.corners.map(|i| {
                let mut corner = face.clip(self.vertices[i as usize], self.near);
                corner.z += lag;
                corner
            });
            let corners = if seen.is_quad {
                Corners::Quad([a, b, c, d])
            } else {
                Corners::Triangle([a, b, c])
            };
            draw(&corners, seen.item);
        }
    }
}

/// Set where a point is not above the hemicube's plane.
const NOT_ABOVE: u16 = 1 << 12;

/// On which sides of the planes between the five pyramids, and of the hemicube's own, a point lies.
fn planes_beyond(p: Vec3) -> u16 {
    let Vec3 { x, y, z } = p;
    let beyond = [
        x > z,
        -x > z,
        y > z,
        -y > z,
        z > x,
        z > -x,
        z > y,
        z > -y,
        y > x,
        x > y,
        -y > x,
        x > -y,
        z <= 0.0,
    ];
    (0..)
        .zip(beyond)
        .fold(0, |bits, (bit, is)| bits | u16::from(is) << bit)
}

/// Planes beyond which nothing is seen on a face, in the order of [`CubeFace::ALL`].
const OUTSIDE: [u16; 5] = [
    1 | 1 << 1 | 1 << 2 | 1 << 3,
    1 << 4 | 1 << 8 | 1 << 10,
    1 << 6 | 1 << 9 | 1 << 10,
    1 << 5 | 1 << 9 | 1 << 11,
    1 << 7 | 1 << 8 | 1 << 11,
];

/// The faces on which something may be seen, all of whose corners are beyond the planes `common`.
fn faces_within(common: u16) -> u8 {
    (0..).zip(OUTSIDE).fold(0, |faces, (face, outside)| {
        faces | u8::from(common & outside == 0) << face
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::hash;

    #[test]
    fn a_point_within_a_face_is_not_said_to_be_outside_of_it() {
        let number = |i: u64| (hash(3, i) >> 40) as f32 / (1 << 23) as f32 - 1.0;
        for i in 0..10_000 {
            let p = Vec3::new(
                number(3 * i),
                number(3 * i + 1),
                number(3 * i + 2).abs() + 1e-6,
            );
            let faces = faces_within(planes_beyond(p));
            for face in CubeFace::ALL {
                let c = face.clip(p, 1e-9);
                let is_inside = c.w > 0.0 && c.x.abs() <= c.w && c.y.abs() <= c.w;
                let may_be = faces >> face.number() & 1 == 1;
                assert_eq!(may_be, is_inside, "{p} on {face:?}");
            }
        }
    }
}
