//! Points on the edges of cells, the same ones for all cells along an edge.
//!
//! Three kinds of points lie on an edge: vertices of other faces that end there (T-vertices), places where a constraint
//! crosses it, and ends of constraints. All are gathered before any cell is cut, so that every cell along an edge gets
//! the same ones and no crack opens.

use super::box_tree::BoxTree;
use super::plane::nearest_in_space;
use crate::patch::subdivide::Vertices;
use glam::{DVec3, Vec3};
use rayon::prelude::*;
use std::collections::{HashMap, HashSet};

/// An edge: its vertices in ascending order.
pub type Edge = (u32, u32);

/// Points closer together than this share of an edge's length are one, so that no slivers arise.
pub const SNAP: f64 = 0.01;

/// Points on edges, and the edges that overlap others.
pub struct EdgePoints {
    points: HashMap<Edge, Vec<(f64, u32)>>,
    overlaps: Overlaps,
    tolerance: f64,
}

impl EdgePoints {
    /// The points that outlines of faces have from each other's vertices: `outlines` are the edges of the uncut faces.
    /// With them goes which vertices are to be replaced by others in the same place.
    pub fn new(
        outlines: &[Edge],
        vertices: &Vertices,
        tolerance: f64,
    ) -> (Self, HashMap<u32, u32>) {
        let mut overlaps = Overlaps::new(outlines, vertices, tolerance);
        let twins = overlaps.weld(&vertices.positions, tolerance);
        let mut points = Self {
            points: HashMap::new(),
            overlaps,
            tolerance,
        };
        let ends: Vec<u32> = sorted(points.overlaps.pieces.iter().flat_map(|&(a, b)| [a, b]));
        for vertex in ends {
            points.spread(vertex, &vertices.positions);
        }
        (points, twins)
    }

    /// Whether no edge has a point.
    pub fn is_empty(&self) -> bool {
        self.points.is_empty()
    }

    /// Number of points on edges.
    pub fn count(&self) -> usize {
        self.points.values().map(Vec::len).sum()
    }

    /// The points between two vertices, from the first to the second: how far along, and which vertex.
    pub fn between(&self, a: u32, b: u32) -> Vec<(f64, u32)> {
        let mut points = self.points.get(&edge(a, b)).cloned().unwrap_or_default();
        if a > b {
            points.reverse();
            for (t, _) in &mut points {
                *t = 1.0 - *t;
            }
        }
        points
    }

    /// Adds a point at a share of the way between two vertices, unless there is one nearby.
    pub fn cross(&mut self, a: u32, b: u32, t: f64, vertices: &mut Vertices) {
        let t = if a < b { t } else { 1.0 - t };
        let edge = edge(a, b);
        let mut others = self.points.get(&edge).into_iter().flatten();
        let is_taken =
            !(SNAP..=1.0 - SNAP).contains(&t) || others.any(|(other, _)| (t - other).abs() < SNAP);
        if is_taken {
            return;
        }
        let vertex = vertices.between(edge.0, edge.1, t);
        self.insert(edge, t, vertex);
        if self.overlaps.members.contains(&edge) {
            self.spread(vertex, &vertices.positions);
        }
    }

    /// Puts a vertex on all overlapping edges in which it lies.
    fn spread(&mut self, vertex: u32, positions: &[Vec3]) {
        for (edge, t) in self.overlaps.around(vertex, positions, self.tolerance) {
            self.insert(edge, t, vertex);
        }
    }

    fn insert(&mut self, edge: Edge, t: f64, vertex: u32) {
        let points = self.points.entry(edge).or_default();
        if points.iter().all(|&(_, other)| other != vertex) {
            let at = points.partition_point(|&(other, _)| other < t);
            points.insert(at, (t, vertex));
        }
    }
}

/// An edge by its vertices.
pub fn edge(a: u32, b: u32) -> Edge {
    (a.min(b), a.max(b))
}

fn sorted<T: Ord + Send>(all: impl Iterator<Item = T>) -> Vec<T> {
    let mut all: Vec<T> = all.collect();
    all.par_sort_unstable();
    all.dedup();
    all
}

/// Pieces of outlines that run along each other without being the same edge.
struct Overlaps {
    pieces: Vec<Edge>,
    members: HashSet<Edge>,
    tree: BoxTree,
}

impl Overlaps {
    fn new(outlines: &[Edge], vertices: &Vertices, tolerance: f64) -> Self {
        let whole = Self::of(outlines.to_vec(), &vertices.positions);
        let touched = whole.touched(&vertices.positions, tolerance);
        let pieces = touched.iter().flat_map(|&(a, b)| vertices.pieces(a, b));
        Self::of(sorted(pieces.map(|(a, b)| edge(a, b))), &vertices.positions)
    }

    fn of(pieces: Vec<Edge>, positions: &[Vec3]) -> Self {
        let ends: Vec<[Vec3; 2]> = pieces
            .iter()
            .map(|&(a, b)| [positions[a as usize], positions[b as usize]])
            .collect();
        Self {
            tree: BoxTree::new(ends.iter().map(|e| &e[..])),
            members: pieces.iter().copied().collect(),
            pieces,
        }
    }

    /// Makes one of vertices in the same place; gives each that is replaced with the one in its stead.
    fn weld(&mut self, positions: &[Vec3], tolerance: f64) -> HashMap<u32, u32> {
        let ends = sorted(self.pieces.iter().flat_map(|&(a, b)| [a, b]));
        let places: Vec<Vec3> = ends.iter().map(|&v| positions[v as usize]).collect();
        let tree = BoxTree::new(places.iter().map(core::slice::from_ref));
        let mut twins: HashMap<u32, u32> = HashMap::new();
        for (i, &vertex) in ends.iter().enumerate() {
            #[expect(clippy::cast_possible_truncation, reason = "a length of the scene")]
            let near = tree.near(&places[i..=i], tolerance as f32);
            let earlier = near.into_iter().map(|j| j as usize).take_while(|&j| j < i);
            let is_twin = |&j: &usize| {
                let distance = f64::from(places[i].distance(places[j]));
                let is_edge = self.members.contains(&edge(ends[j], vertex));
                distance <= tolerance && !is_edge && !twins.contains_key(&ends[j])
            };
            if let Some(j) = earlier.into_iter().find(is_twin) {
                twins.insert(vertex, ends[j]);
            }
        }
        if !twins.is_empty() {
            let kept = |v: u32| *twins.get(&v).unwrap_or(&v);
            let pieces = self.pieces.iter().map(|&(a, b)| edge(kept(a), kept(b)));
            *self = Self::of(sorted(pieces.filter(|(a, b)| a != b)), positions);
        }
        twins
    }

    /// The edges between whose ends a vertex lies, and how far along.
    fn around(&self, vertex: u32, positions: &[Vec3], tolerance: f64) -> Vec<(Edge, f64)> {
        let point = positions[vertex as usize];
        #[expect(clippy::cast_possible_truncation, reason = "a length of the scene")]
        let near = self.tree.near(&[point], tolerance as f32);
        let at = |v: u32| positions[v as usize].as_dvec3();
        near.into_iter()
            .filter_map(|i| {
                let (a, b) = self.pieces[i as usize];
                let t = inside(point.as_dvec3(), [at(a), at(b)], tolerance)?;
                (vertex != a && vertex != b).then_some(((a, b), t))
            })
            .collect()
    }

    /// The edges in which vertices of others lie, and the edges that begin at such a vertex and go on along them.
    fn touched(&self, positions: &[Vec3], tolerance: f64) -> Vec<Edge> {
        let ends = sorted(self.pieces.iter().flat_map(|&(a, b)| [a, b]));
        let meetings: Vec<(u32, Edge)> = ends
            .par_iter()
            .flat_map_iter(|&v| {
                let around = self.around(v, positions, tolerance);
                around.into_iter().map(move |(edge, _)| (v, edge))
            })
            .collect();
        if meetings.is_empty() {
            return Vec::new();
        }
        let from = self.edges_from();
        let at = |v: u32| positions[v as usize].as_dvec3();
        let beside = meetings.iter().flat_map(|&(v, (a, b))| {
            let start = from.partition_point(|&(other, _)| other < v);
            let here = from[start..]
                .iter()
                .take_while(move |&&(other, _)| other == v);
            let direction = (at(b) - at(a)).normalize_or_zero();
            here.filter(move |&&(_, far)| {
                let offset = at(far) - at(v);
                offset.cross(direction).length() <= tolerance + 1e-4 * offset.length()
            })
            .map(move |&(_, far)| edge(v, far))
        });
        sorted(meetings.iter().map(|&(_, edge)| edge).chain(beside))
    }

    /// Each edge from both of its ends.
    fn edges_from(&self) -> Vec<(u32, u32)> {
        sorted(self.pieces.iter().flat_map(|&(a, b)| [(a, b), (b, a)]))
    }
}

/// How far along a segment a point lies, if it lies in it and off its ends.
fn inside(point: DVec3, ends: [DVec3; 2], tolerance: f64) -> Option<f64> {
    let (t, distance) = nearest_in_space(point, ends);
    let length = ends[0].distance(ends[1]);
    // Where edges are short, a thousandth of them is as close as a vertex may come.
    let tolerance = tolerance.min(1e-3 * length);
    let is_off_the_ends = t * length > tolerance && (1.0 - t) * length > tolerance;
    (distance <= tolerance && is_off_the_ends).then_some(t)
}
