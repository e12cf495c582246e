//! What every mesh must keep, however it was cut: no cracks, no hanging vertices, the areas of its faces.

use glam::{DVec3, Vec3};
use hemicube::radiosity::patch::NodeKind;
use hemicube::radiosity::{NodeId, PatchMesh};
use std::collections::HashMap;

/// What is wrong with a mesh, as many times.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Flaws {
    /// Edges inside a face that do not belong to two elements, once in each direction.
    pub cracks: usize,
    /// Vertices on the outlines of faces that lie inside edges of elements on outlines that run along theirs.
    pub hanging: usize,
    /// Largest relative difference between the area of a face and that of its elements.
    pub area: f64,
}

impl Flaws {
    /// Of a mesh. A vertex lies in an edge if it is this close to it, and farther from its ends.
    pub fn of(mesh: &PatchMesh, tolerance: f64) -> Self {
        let mut elements_of: HashMap<NodeId, Vec<NodeId>> = HashMap::new();
        for &element in mesh.elements() {
            elements_of
                .entry(surface_over(mesh, element))
                .or_default()
                .push(element);
        }
        let mut flaws = Self::default();
        let mut outlines = Vec::new();
        for (&surface, elements) in &elements_of {
            let whole = f64::from(mesh.node(surface).area);
            let sum: f64 = elements.iter().map(|&e| f64::from(mesh.node(e).area)).sum();
            flaws.area = flaws.area.max((sum / whole - 1.0).abs());
            let unpaired = unpaired(mesh, elements);
            let is_crack = |&&edge: &&[u32; 2]| !is_on_outline(mesh, surface, edge, tolerance);
            flaws.cracks += unpaired.iter().filter(is_crack).count();
            outlines.extend(unpaired);
        }
        flaws.hanging = hanging(mesh.vertices(), &outlines, tolerance);
        flaws
    }
}

/// The lit side of a face over an element.
fn surface_over(mesh: &PatchMesh, element: NodeId) -> NodeId {
    let mut id = element;
    while let Some(parent) = mesh.node(id).parent {
        if matches!(mesh.node(parent).kind, NodeKind::Cluster { .. }) {
            break;
        }
        id = parent;
    }
    id
}

/// The directed edges of some elements whose reverse is no edge of them, or that occur twice.
fn unpaired(mesh: &PatchMesh, elements: &[NodeId]) -> Vec<[u32; 2]> {
    let mut counts: HashMap<[u32; 2], i32> = HashMap::new();
    for &element in elements {
        let corners = mesh.corners(element);
        for i in 0..corners.len() {
            let edge = [corners[i], corners[(i + 1) % corners.len()]];
            *counts.entry(edge).or_default() += 1;
        }
    }
    let reverse = |[a, b]: [u32; 2]| counts.get(&[b, a]).copied().unwrap_or(0);
    let all = counts
        .iter()
        .filter(|&(&edge, &count)| count != 1 || reverse(edge) != 1);
    all.map(|(&edge, _)| edge).collect()
}

fn is_on_outline(mesh: &PatchMesh, surface: NodeId, edge: [u32; 2], tolerance: f64) -> bool {
    let polygon = mesh.polygon(surface);
    let at = |v: u32| mesh.vertices()[v as usize].as_dvec3();
    (0..polygon.len()).any(|i| {
        let (a, b) = (
            polygon[i].as_dvec3(),
            polygon[(i + 1) % polygon.len()].as_dvec3(),
        );
        // Vertices of other faces may lie a little beside the edge, and welded ones beside its ends.
        edge.iter()
            .all(|&v| distance(at(v), a, b) <= 110.0 * tolerance)
    })
}

/// How many vertices of edges lie inside others.
fn hanging(vertices: &[Vec3], edges: &[[u32; 2]], tolerance: f64) -> usize {
    let mut ends: Vec<u32> = edges.iter().flatten().copied().collect();
    ends.sort_unstable();
    ends.dedup();
    // Along each axis, so that each edge looks where it is shortest.
    let sorted = [0, 1, 2].map(|axis| {
        let mut sorted: Vec<(f32, u32)> = ends
            .iter()
            .map(|&v| (vertices[v as usize][axis], v))
            .collect();
        sorted.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
        sorted
    });
    let mut far_ends: HashMap<u32, Vec<u32>> = HashMap::new();
    for &[a, b] in edges {
        far_ends.entry(a).or_default().push(b);
        far_ends.entry(b).or_default().push(a);
    }
    let at = |v: u32| vertices[v as usize].as_dvec3();
    let mut count = 0;
    for &[a, b] in edges {
        let (pa, pb) = (at(a), at(b));
        let (low, high) = (pa.min(pb) - tolerance, pa.max(pb) + tolerance);
        let window = [0, 1, 2].map(|axis| {
            let start = sorted[axis].partition_point(|p| f64::from(p.0) < low[axis]);
            let end = sorted[axis].partition_point(|p| f64::from(p.0) <= high[axis]);
            &sorted[axis][start..end]
        });
        let fewest = window
            .into_iter()
            .min_by_key(|w| w.len())
            .unwrap_or_default();
        let is_inside = |&&(_, v): &&(f32, u32)| {
            let p = at(v);
            v != a
                && v != b
                && distance(p, pa, pb) <= tolerance.min(5e-4 * pa.distance(pb))
                && p.distance(pa) > 11.0 * tolerance
                && p.distance(pb) > 11.0 * tolerance
                && far_ends[&v].iter().any(|&far| {
                    let offset = at(far) - p;
                    offset.cross((pb - pa).normalize()).length() < 1e-4 * offset.length()
                })
        };
        count += fewest.iter().filter(is_inside).count();
    }
    count
}

/// Distance of a point from a segment.
fn distance(p: DVec3, a: DVec3, b: DVec3) -> f64 {
    let t = ((p - a).dot(b - a) / a.distance_squared(b).max(1e-300)).clamp(0.0, 1.0);
    p.distance(a.lerp(b, t))
}
