//! Light at vertices by that of the elements around them; twin of `vertex_light.wgsl`.
//!
//! The elements around a vertex are a *fan*. It is cut where light may break: at creases, where neighbours' normals differ
//! by more than 40°, at the mesh's [hard edges](PatchMesh::hard_edges), and along edges on which another surface stands
//! (a wall on a floor). Each part of a fan has a value of its own at the vertex, the mean over its elements weighted by
//! their exposed areas: what is buried has no say. Irradiance is averaged, not radiosity, so textures and neighbouring
//! materials keep their borders.
//!
//! Weights are corrected so that light which is linear over a part comes out exactly, also where elements of different
//! sizes meet: `w = a (1 + λ·d)` with area `a`, offset `d` of the element's centre from the vertex, and `λ` such that
//! `Σ w d = 0`; elements whose weight were negative are left out, so values stay within those around. That needs a vertex
//! amid the centres; on a border, where corrected weights would have to extrapolate, areas weigh alone.

use crate::patch::PatchMesh;
use glam::{Mat2, Vec2, Vec3};
use hemicube_raster::Rgb;
use rayon::prelude::*;

/// Cosine of the largest angle between normals over which light is averaged (40°).
const CREASE: f32 = 0.766;

/// Share of the areas' sum below which corrected weights are too small to trust.
const LEAST_WEIGHT: f32 = 0.1;

/// Edges of more elements have no two sides that could be smooth.
const MOST_AT_EDGE: usize = 16;

/// Vertices that are looked at one after the other.
const CHUNK: u32 = 4096;

/// The parts of all fans.
#[derive(Debug, Clone, Default)]
pub(crate) struct Fans {
    lists: Lists,
    /// The part at each corner of each element, corners of an element one after the other.
    parts: Vec<u32>,
    /// First corner of each element.
    corners: Vec<u32>,
}

/// Elements of parts, end to end.
#[derive(Debug, Clone, Default)]
struct Lists {
    /// Vertex of each part.
    vertices: Vec<u32>,
    /// Where the list of each part ends in [`Self::elements`].
    ends: Vec<u32>,
    elements: Vec<u32>,
    /// Sum to 1 in each part, or are all 0 where all of it is buried.
    weights: Vec<f32>,
}

impl Lists {
    fn of_vertices(mesh: &PatchMesh, vertices: core::ops::Range<u32>, around: &Around) -> Self {
        let mut lists = Self::default();
        for vertex in vertices {
            for smooth in connected(mesh, vertex, around.of(vertex)) {
                for elements in within_crease(mesh, smooth) {
                    lists.vertices.push(vertex);
                    lists.weights.extend(weights(mesh, vertex, &elements));
                    lists.elements.extend(elements);
                    lists.ends.push(crate::index32(lists.elements.len()));
                }
            }
        }
        lists
    }

    fn append(&mut self, others: &Self) {
        let first = crate::index32(self.elements.len());
        self.vertices.extend(&others.vertices);
        self.ends.extend(others.ends.iter().map(|end| end + first));
        self.elements.extend(&others.elements);
        self.weights.extend(&others.weights);
    }

    fn of_part(&self, part: usize) -> (&[u32], &[f32]) {
        let start = part.checked_sub(1).map_or(0, |before| self.ends[before]);
        let range = start as usize..self.ends[part] as usize;
        (&self.elements[range.clone()], &self.weights[range])
    }
}

impl Fans {
    /// Around all vertices of elements.
    pub(crate) fn new(mesh: &PatchMesh) -> Self {
        let around = Around::new(mesh);
        let vertices = crate::index32(mesh.vertices().len());
        let chunks: Vec<Lists> = (0..vertices.div_ceil(CHUNK))
            .into_par_iter()
            .map(|chunk| {
                let vertices = chunk * CHUNK..((chunk + 1) * CHUNK).min(vertices);
                Lists::of_vertices(mesh, vertices, &around)
            })
            .collect();
        let mut lists = Lists::default();
        chunks.iter().for_each(|chunk| lists.append(chunk));
        let mut corners = vec![0];
        for &id in mesh.elements() {
            let last = corners[corners.len() - 1];
            corners.push(last + crate::index32(mesh.corners(id).len()));
        }
        let mut parts = vec![0; corners[corners.len() - 1] as usize];
        for (part, &vertex) in lists.vertices.iter().enumerate() {
            for &e in lists.of_part(part).0 {
                let first = corners[e as usize] as usize;
                let own = mesh.corners(mesh.elements()[e as usize]);
                for i in (0..own.len()).filter(|&i| own[i] == vertex) {
                    parts[first + i] = crate::index32(part);
                }
            }
        }
        Self {
            lists,
            parts,
            corners,
        }
    }

    /// The parts at an element's corners.
    pub(crate) fn of_element(&self, element: usize) -> &[u32] {
        &self.parts[self.corners[element] as usize..self.corners[element + 1] as usize]
    }

    /// Elements of a part and their weights.
    pub(crate) fn of_part(&self, part: u32) -> (&[u32], &[f32]) {
        self.lists.of_part(part as usize)
    }

    /// The value of each part, of one value for each element.
    pub(crate) fn means(&self, values: &[Rgb]) -> Vec<Rgb> {
        let parts = (0..self.lists.ends.len()).into_par_iter();
        parts
            .map(|part| weighted(self.lists.of_part(part), values))
            .collect()
    }
}

/// The mean of some elements' values by their weights.
fn weighted((elements, weights): (&[u32], &[f32]), values: &[Rgb]) -> Rgb {
    let pairs = elements.iter().zip(weights);
    pairs.map(|(&e, &weight)| values[e as usize] * weight).sum()
}

/// Where each vertex of a drawn mesh takes its light from.
///
/// It stays the same as long as the patch mesh does, so new light comes to the vertices without a new drawn mesh.
#[derive(Debug, Clone, Default)]
pub struct LightSources {
    starts: Vec<u32>,
    elements: Vec<u32>,
    weights: Vec<f32>,
}

impl LightSources {
    /// Of the parts of fans at some vertices.
    pub(crate) fn new(fans: &Fans, parts: &[u32]) -> Self {
        let mut sources = Self {
            starts: vec![0],
            ..Self::default()
        };
        for &part in parts {
            let (elements, weights) = fans.of_part(part);
            sources.elements.extend(elements);
            sources.weights.extend(weights);
            sources.starts.push(crate::index32(sources.elements.len()));
        }
        sources
    }

    /// Where the list of each vertex begins in [`Self::elements`], and where the last one ends.
    pub fn starts(&self) -> &[u32] {
        &self.starts
    }

    /// Lists of elements, end to end.
    pub fn elements(&self) -> &[u32] {
        &self.elements
    }

    /// Weights of those elements. They sum to 1 for each vertex, or are 0 where all around it is buried.
    pub fn weights(&self) -> &[f32] {
        &self.weights
    }

    /// The value at each vertex of one value for each element.
    ///
    /// # Panics
    /// There are fewer values than elements.
    pub fn means(&self, values: &[Rgb]) -> Vec<Rgb> {
        let mean = |range: &[u32]| {
            let range = range[0] as usize..range[1] as usize;
            weighted(
                (&self.elements[range.clone()], &self.weights[range]),
                values,
            )
        };
        self.starts.par_windows(2).map(mean).collect()
    }
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

/// Weights of a part's elements, whose sum is 1; all 0 where all of it is buried.
fn weights(mesh: &PatchMesh, vertex: u32, elements: &[u32]) -> Vec<f32> {
    let areas: Vec<f32> = elements
        .iter()
        .map(|&e| mesh.exposed_area(e as usize))
        .collect();
    let total: f32 = areas.iter().sum();
    if total <= 0.0 {
        return areas;
    }
    let mut weights = linear_weights(mesh, vertex, elements, &areas)
        .filter(|weights| weights.iter().sum::<f32>() > LEAST_WEIGHT * total)
        .unwrap_or(areas);
    let sum: f32 = weights.iter().sum();
    weights.iter_mut().for_each(|weight| *weight /= sum);
    weights
}

/// Weights with `Σ w d = 0` in the plane of the part: `a (1 + λ·d)`, without the elements whose weight were negative.
/// `None` if the vertex is not amid the others' centres.
fn linear_weights(
    mesh: &PatchMesh,
    vertex: u32,
    elements: &[u32],
    areas: &[f32],
) -> Option<Vec<f32>> {
    let at = mesh.vertices()[vertex as usize];
    let (right, up) = normal_of(mesh, elements[0]).any_orthonormal_pair();
    let offset = |&e: &u32| {
        let d = mesh.node(mesh.elements()[e as usize]).centroid - at;
        Vec2::new(d.dot(right), d.dot(up))
    };
    let offsets: Vec<Vec2> = elements.iter().map(offset).collect();
    let mut kept = areas.to_vec();
    // Each round leaves out an element at least, and three must remain.
    loop {
        let lambda = balance(&offsets, &kept)?;
        let weight = |(d, area): (&Vec2, &f32)| area * (1.0 + lambda.dot(*d));
        let weights: Vec<f32> = offsets.iter().zip(&kept).map(weight).collect();
        if weights.iter().all(|&weight| weight >= 0.0) {
            return Some(weights);
        }
        for (area, weight) in kept.iter_mut().zip(weights) {
            *area = if weight < 0.0 { 0.0 } else { *area };
        }
    }
}

/// `λ` with `Σ a (1 + λ·d) d = 0`; `None` if the offsets lie on a line.
fn balance(offsets: &[Vec2], areas: &[f32]) -> Option<Vec2> {
    let (mut first, mut second) = (Vec2::ZERO, Mat2::ZERO);
    for (&d, &area) in offsets.iter().zip(areas) {
        first += d * area;
        second += Mat2::from_cols(d * d.x, d * d.y) * area;
    }
    let spread = second.x_axis.x + second.y_axis.y;
    let is_flat = second.determinant() <= 1e-3 * spread * spread;
    (!is_flat).then(|| second.inverse() * -first)
}

fn normal_of(mesh: &PatchMesh, element: u32) -> Vec3 {
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
struct Around {
    starts: Vec<u32>,
    elements: Vec<u32>,
}

impl Around {
    fn new(mesh: &PatchMesh) -> Self {
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

    fn of(&self, vertex: u32) -> &[u32] {
        let v = vertex as usize;
        &self.elements[self.starts[v] as usize..self.starts[v + 1] as usize]
    }
}
