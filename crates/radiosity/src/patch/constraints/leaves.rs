//! The cells that lines cross, and what each becomes.

use super::arrangement::{Arrangement, MOST_SEGMENTS};
use super::edges::{EdgePoints, SNAP};
use super::plane::{Line, Plane, clip, nearest_on, stored};
use super::triangulate::{self, Corners};
use crate::patch::subdivide::Vertices;
use crate::patch::{NodeId, PatchMesh};
use glam::{DVec2, Vec3};

/// What a cell is cut into.
#[derive(Debug, Default)]
pub struct Cut {
    /// Vertices along its outline, counter-clockwise.
    pub outline: Vec<u32>,
    /// Places of new vertices inside, numbered on from those.
    pub inner: Vec<Vec3>,
    /// Corners of each part; none if the cell stays as it is.
    pub cells: Vec<Corners>,
    /// Edges along which light may jump, between those vertices.
    pub jumps: Vec<[usize; 2]>,
}

/// A cell in its own plane.
struct Flat {
    plane: Plane,
    corners: Vec<DVec2>,
}

impl Flat {
    fn new(mesh: &PatchMesh, id: NodeId, positions: &[Vec3]) -> Self {
        let polygon: Vec<Vec3> = mesh
            .corners(id)
            .iter()
            .map(|&c| positions[c as usize])
            .collect();
        let plane = Plane::new(polygon[0], mesh.node(id).normal);
        Self {
            corners: plane.flat_polygon(&polygon),
            plane,
        }
    }

    fn edge(&self, i: usize) -> [DVec2; 2] {
        [self.corners[i], self.corners[(i + 1) % self.corners.len()]]
    }

    /// Distance within which things snap together.
    fn snap(&self) -> f64 {
        let lengths = (0..self.corners.len()).map(|i| {
            let [a, b] = self.edge(i);
            a.distance(b)
        });
        SNAP * lengths.fold(0.0, f64::max)
    }

    /// Whether a segment comes within the snapping distance, by the separating lines along the edges and the segment.
    fn is_near(&self, [from, to]: [DVec2; 2], snap: f64) -> bool {
        let beyond = |i: usize| {
            let [a, b] = self.edge(i);
            let limit = -snap * a.distance(b);
            [from, to].iter().all(|&p| (b - a).perp_dot(p - a) < limit)
        };
        let along = to - from;
        let limit = snap * along.length();
        let heights = || self.corners.iter().map(|&c| along.perp_dot(c - from));
        let is_beside = heights().all(|h| h > limit) || heights().all(|h| h < -limit);
        !is_beside && !(0..self.corners.len()).any(beyond)
    }
}

/// Puts points on the edges that lines cross or end in. Gives the cells that lines come near, with those lines, and of how
/// many cells some were left out.
pub fn crossed(
    mesh: &PatchMesh,
    lines: &[Vec<Line>],
    edges: &mut EdgePoints,
    vertices: &mut Vertices,
) -> (Vec<(NodeId, Vec<Line>)>, usize) {
    let (mut crossed, mut crowded) = (Vec::new(), 0);
    for (roots, lines) in mesh.roots.iter().zip(lines) {
        let roots = roots.iter().flatten().filter(|_| !lines.is_empty());
        let mut stack: Vec<(NodeId, Vec<Line>)> = roots.map(|&r| (r, lines.clone())).collect();
        while let Some((id, lines)) = stack.pop() {
            let flat = Flat::new(mesh, id, &vertices.positions);
            let snap = flat.snap();
            let is_near = |line: &Line| flat.is_near(flat.plane.flat_segment(line.ends), snap);
            let mut near: Vec<Line> = lines.into_iter().filter(is_near).collect();
            if near.is_empty() {
                continue;
            }
            if mesh.node(id).child_count > 0 {
                stack.extend(mesh.children(id).map(|child| (child, near.clone())));
                continue;
            }
            crowded += usize::from(near.len() > MOST_SEGMENTS);
            near.truncate(MOST_SEGMENTS);
            for line in &near {
                cross_edges(mesh.corners(id), &flat, line, edges, vertices);
            }
            crossed.push((id, near));
        }
    }
    (crossed, crowded)
}

/// Puts points on a cell's edges where a line crosses them or ends in them.
fn cross_edges(
    corners: &[u32],
    flat: &Flat,
    line: &Line,
    edges: &mut EdgePoints,
    vertices: &mut Vertices,
) {
    let n = corners.len();
    let mut cross = |i: usize, at: DVec2, within: f64| {
        let (t, distance) = nearest_on(at, flat.edge(i));
        if distance <= within {
            edges.cross(corners[i], corners[(i + 1) % n], t, vertices);
        }
    };
    let segment = flat.plane.flat_segment(line.ends);
    for end in segment {
        (0..n).for_each(|i| cross(i, end, flat.snap()));
    }
    let Some(inside) = clip(segment, &flat.corners) else {
        return;
    };
    for (end, edge) in inside.ends.into_iter().zip(inside.edges) {
        if let Some(i) = edge {
            cross(i, end, f64::INFINITY);
        }
    }
}

/// Cuts a cell along lines and in the points on its edges.
pub fn cut(
    mesh: &PatchMesh,
    id: NodeId,
    lines: &[Line],
    edges: &EdgePoints,
    positions: &[Vec3],
) -> Cut {
    let flat = Flat::new(mesh, id, positions);
    let corners = mesh.corners(id);
    let n = corners.len();
    let on_edges: Vec<Vec<(f64, u32)>> = (0..n)
        .map(|i| edges.between(corners[i], corners[(i + 1) % n]))
        .collect();
    let mut outline = Vec::new();
    for (&corner, points) in corners.iter().zip(&on_edges) {
        outline.push(corner);
        outline.extend(points.iter().map(|&(_, vertex)| vertex));
    }
    let shares: Vec<Vec<f64>> = on_edges
        .iter()
        .map(|points| points.iter().map(|&(t, _)| t).collect())
        .collect();
    let mut arrangement = Arrangement::new(&flat.corners, &shares, flat.snap());
    let segments: Vec<[DVec2; 2]> = lines
        .iter()
        .map(|line| flat.plane.flat_segment(line.ends))
        .collect();
    arrangement.add(&flat.corners, &segments);
    let jumps = jumps(&flat, &arrangement, lines);
    if arrangement.segments.is_empty() && outline.len() == n {
        let (inner, cells) = Default::default();
        return Cut {
            outline,
            inner,
            cells,
            jumps,
        };
    }
    let Some(cells) = triangulate::cells(&arrangement) else {
        return fan(&flat, outline, jumps);
    };
    let inner = &arrangement.points[outline.len()..];
    Cut {
        inner: inner
            .iter()
            .map(|&p| stored(flat.plane.lifted(p)))
            .collect(),
        outline,
        cells,
        jumps,
    }
}

/// Edges of the outline and inside it that lie on lines along which light may jump.
fn jumps(flat: &Flat, cell: &Arrangement, lines: &[Line]) -> Vec<[usize; 2]> {
    let jumping: Vec<[DVec2; 2]> = lines
        .iter()
        .filter(|line| line.jumps)
        .map(|line| flat.plane.flat_segment(line.ends))
        .collect();
    let count = cell.sides.len();
    let outline = (0..count).map(|i| [i, (i + 1) % count]);
    let all = outline.chain(cell.segments.iter().copied());
    let within = 2.0 * flat.snap();
    all.filter(|edge| {
        let lies_on = |line: &[DVec2; 2]| {
            let is_near = |&i: &usize| nearest_on(cell.points[i], *line).1 <= within;
            edge.iter().all(is_near)
        };
        let is_long = cell.points[edge[0]].distance(cell.points[edge[1]]) > 2.0 * within;
        is_long && jumping.iter().any(lies_on)
    })
    .collect()
}

/// The triangles around the centre of a cell: what always works.
fn fan(flat: &Flat, outline: Vec<u32>, mut jumps: Vec<[usize; 2]>) -> Cut {
    let centre = flat.corners.iter().sum::<DVec2>() / flat.corners.len() as f64;
    let count = outline.len();
    jumps.retain(|edge| edge.iter().all(|&i| i < count));
    Cut {
        outline,
        jumps,
        inner: vec![stored(flat.plane.lifted(centre))],
        cells: (0..count)
            .map(|i| vec![i, (i + 1) % count, count])
            .collect(),
    }
}
