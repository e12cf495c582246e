//! Parts of fans: elements around a vertex over which light is smooth.

use crate::patch::PatchMesh;
use glam::Vec3;

/// Cosine of the largest angle between normals over which light is averaged (40°).
const CREASE: f32 = 0.766;

/// Edges of more elements have no two sides that could be smooth.
const MOST_AT_EDGE: usize = 16;

/// The parts of the fan of a vertex.
pub(super) fn parts(mesh: &PatchMesh, vertex: u32, fan: &[u32]) -> Vec<Vec<u32>> {
    let smooth = connected(mesh, vertex, fan).into_iter();
    smooth
        .flat_map(|elements| within_crease(mesh, elements))
        .collect()
}

/// Elements of a fan that are connected through edges over which light is smooth, in order of their first ones.
fn connected(mesh: &PatchMesh, vertex: u32, fan: &[u32]) -> Vec<Vec<u32>> {
    // Each element has two edges at the vertex: the other ends, with the element's place in the fan.
    let mut ends: Vec<(u32, usize)> = Vec::with_capacity(2 * fan.len());
    for (i, &e) in fan.iter().enumerate() {
        let corners = mesh.corners(mesh.elements()[e as usize]);
        let n = corners.len();
        for (k, _) in corners
            .iter()
            .enumerate()
            .filter(|&(_, &corner)| corner == vertex)
        {
            ends.extend([(corners[(k + 1) % n], i), (corners[(k + n - 1) % n], i)]);
        }
    }
    ends.sort_unstable();
    let mut sets = Sets::new(fan.len());
    for edge in ends.chunk_by(|a, b| a.0 == b.0) {
        let is_hard = mesh.is_hard_edge(vertex, edge[0].0);
        let normals: Vec<Vec3> = edge.iter().map(|&(_, i)| normal_of(mesh, fan[i])).collect();
        if is_hard || edge.len() > MOST_AT_EDGE || carries_another(&normals) {
            continue;
        }
        for (k, pair) in edge.windows(2).enumerate() {
            // Sides of one sheet lie at the same edge; neighbours in the order may be its two sides.
            let others = (k + 1..edge.len()).filter(|&j| similar(normals[k], normals[j]));
            others.for_each(|j| sets.join(pair[0].1, edge[j].1));
        }
    }
    sets.lists()
        .into_iter()
        .map(|list| list.into_iter().map(|i| fan[i]).collect())
        .collect()
}

/// Whether another surface stands on the edge between smooth neighbours: some normals agree, another is across.
fn carries_another(normals: &[Vec3]) -> bool {
    let across = |a: Vec3, b: Vec3| a.dot(b).abs() < CREASE;
    normals.iter().enumerate().any(|(i, &a)| {
        let pair = normals[i + 1..].iter().any(|&b| similar(a, b));
        pair && normals.iter().any(|&b| across(a, b))
    })
}

/// Cuts a smooth part of a fan that turns by more than the crease angle in all: around the tip of a cone, for example.
fn within_crease(mesh: &PatchMesh, elements: Vec<u32>) -> Vec<Vec<u32>> {
    let mut parts: Vec<(Vec3, Vec<u32>)> = Vec::new();
    for e in elements {
        let normal = normal_of(mesh, e);
        match parts.iter_mut().find(|(first, _)| similar(*first, normal)) {
            Some((_, part)) => part.push(e),
            None => parts.push((normal, vec![e])),
        }
    }
    parts.into_iter().map(|(_, part)| part).collect()
}

pub(super) fn normal_of(mesh: &PatchMesh, element: u32) -> Vec3 {
    mesh.node(mesh.elements()[element as usize]).normal
}

fn similar(a: Vec3, b: Vec3) -> bool {
    a.dot(b) >= CREASE
}

/// Disjoint sets (Tarjan 1975, with path halving).
struct Sets(Vec<usize>);

impl Sets {
    fn new(count: usize) -> Self {
        Self((0..count).collect())
    }

    fn find(&mut self, mut i: usize) -> usize {
        while self.0[i] != i {
            self.0[i] = self.0[self.0[i]];
            i = self.0[i];
        }
        i
    }

    /// The smaller number stands for both.
    fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.find(a), self.find(b));
        self.0[a.max(b)] = a.min(b);
    }

    /// Members of each set, in order.
    fn lists(mut self) -> Vec<Vec<usize>> {
        let mut lists: Vec<Vec<usize>> = Vec::new();
        let mut of_root = vec![usize::MAX; self.0.len()];
        for i in 0..self.0.len() {
            let root = self.find(i);
            if of_root[root] == usize::MAX {
                of_root[root] = lists.len();
                lists.push(Vec::new());
            }
            lists[of_root[root]].push(i);
        }
        lists
    }
}

/// Lists of the elements around each vertex, end to end.
pub(super) struct Around {
    starts: Vec<u32>,
    elements: Vec<u32>,
}

impl Around {
    pub(super) fn new(mesh: &PatchMesh) -> Self {
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
        Self { starts, elements }
    }

    pub(super) fn of(&self, vertex: u32) -> &[u32] {
        let v = vertex as usize;
        &self.elements[self.starts[v] as usize..self.starts[v + 1] as usize]
    }
}
