//! Vertices that nearly agree become one.
//!
//! Positions come from files with six digits, or through matrices of other nodes, so that corners that should be one
//! differ in their last bits. They are sorted along a direction that is skew to everything people build, and each is
//! compared with those shortly before it: `n log n`.

use crate::patch::face::{WorldFace, newell_normal};
use glam::{DVec3, Vec3};
use rayon::prelude::*;
use std::collections::HashMap;

/// Distance of vertices that become one unless asked otherwise, as a share of the scene's diagonal.
const TOLERANCE: f32 = 2e-6;

/// Most that a vertex may move, as a share of the shortest edge at it: details stay.
const MOST_OF_EDGE: f32 = 0.05;

/// Skew to axes, diagonals and to each other's multiples, so that few vertices share a place along it.
const DIRECTION: DVec3 = DVec3::new(0.610_237, 0.551_889, 0.568_314);

/// What welding did.
pub struct Welded {
    /// Corners of faces that moved.
    pub moved: usize,
    /// Of each face its corners' vertices: those with the same number are in the same place.
    pub corners: Vec<[u32; 4]>,
}

/// Moves corners onto others that are within a distance, by default a small share of the scene's diagonal. Of vertices that become one the first in the order of the faces stays where it is. No vertex moves
/// farther than a twentieth of the shortest edge at it, and no face loses its area.
pub fn weld(faces: &mut [WorldFace], distance: Option<f32>) -> Welded {
    let places = Places::new(faces);
    let tolerance = distance.unwrap_or(TOLERANCE * places.diagonal());
    let first = places.first_within(tolerance);
    if first.iter().enumerate().all(|(i, &j)| i == j as usize) {
        return Welded {
            moved: 0,
            corners: places.of_face,
        };
    }
    let moving = faces.par_iter_mut().enumerate();
    let moved = moving.map(|(i, face)| places.move_corners(i, face, &first));
    Welded {
        moved: moved.sum(),
        corners: places
            .of_face
            .iter()
            .map(|corners| corners.map(|place| first[place as usize]))
            .collect(),
    }
}

/// The different positions of corners, in the order in which the faces name them.
struct Places {
    positions: Vec<Vec3>,
    /// Of each face its corners' positions.
    of_face: Vec<[u32; 4]>,
    /// Length of the shortest edge at each position.
    shortest: Vec<f32>,
}

impl Places {
    fn new(faces: &[WorldFace]) -> Self {
        let mut known = HashMap::with_capacity(faces.len());
        let mut places = Self {
            positions: Vec::new(),
            of_face: Vec::with_capacity(faces.len()),
            shortest: Vec::new(),
        };
        for face in faces {
            let of_face = face.corners.map(|corner| {
                // -0 and 0 are the same place.
                let key = (corner + Vec3::ZERO).to_array().map(f32::to_bits);
                *known.entry(key).or_insert_with(|| places.push(corner))
            });
            places.of_face.push(of_face);
            places.note_edges(face, of_face);
        }
        places
    }

    fn push(&mut self, position: Vec3) -> u32 {
        self.positions.push(position);
        self.shortest.push(f32::INFINITY);
        crate::index32(self.positions.len() - 1)
    }

    fn note_edges(&mut self, face: &WorldFace, of_face: [u32; 4]) {
        let n = face.polygon().len();
        for i in 0..n {
            let j = (i + 1) % n;
            let length = face.corners[i].distance(face.corners[j]);
            for end in [of_face[i], of_face[j]] {
                let shortest = &mut self.shortest[end as usize];
                *shortest = shortest.min(length);
            }
        }
    }

    fn diagonal(&self) -> f32 {
        let nothing = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        let around = |(low, high): (Vec3, Vec3), p: &Vec3| (low.min(*p), high.max(*p));
        let (low, high) = self.positions.iter().fold(nothing, around);
        low.distance(high)
    }

    /// For each position the first one that it becomes.
    fn first_within(&self, tolerance: f32) -> Vec<u32> {
        let along = |i: u32| self.positions[i as usize].as_dvec3().dot(DIRECTION);
        let count = crate::index32(self.positions.len());
        let mut order: Vec<(f64, u32)> = (0..count).map(|i| (along(i), i)).collect();
        order.par_sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let mut first: Vec<u32> = (0..count).collect();
        for (k, &(at, i)) in order.iter().enumerate() {
            // The direction's length is 1, so that distances along it are at most distances.
            let reach = 1.000_01 * f64::from(self.reach(i, tolerance));
            let close = order[..k]
                .iter()
                .rev()
                .take_while(|(before, _)| at - before <= reach);
            for &(_, j) in close {
                self.join(i, j, tolerance, &mut first);
            }
        }
        (0..count).map(|i| root(i, &first)).collect()
    }

    /// How far a vertex may move.
    fn reach(&self, i: u32, tolerance: f32) -> f32 {
        tolerance.min(MOST_OF_EDGE * self.shortest[i as usize])
    }

    /// Joins the groups of two positions if all that moves stays within what it may.
    fn join(&self, i: u32, j: u32, tolerance: f32, first: &mut [u32]) {
        let (a, b) = (root(i, first), root(j, first));
        let (stays, moves) = (a.min(b), a.max(b));
        let reach = |i: u32| self.reach(i, tolerance);
        let gap = |i: u32, j: u32| self.positions[i as usize].distance(self.positions[j as usize]);
        // Chains do not creep along: both must be near the one that stays.
        let is_near = |i: u32| gap(i, stays) <= reach(i);
        if a != b
            && gap(i, j) <= reach(i).min(reach(j))
            && is_near(i)
            && is_near(j)
            && is_near(moves)
        {
            first[moves as usize] = stays;
        }
    }

    /// Moves a face's corners to the first positions, and counts them.
    fn move_corners(&self, index: usize, face: &mut WorldFace, first: &[u32]) -> usize {
        let places = self.of_face[index];
        let targets = places.map(|place| first[place as usize]);
        if targets == places {
            return 0;
        }
        face.corners = targets.map(|place| self.positions[place as usize]);
        face.normal = newell_normal(face.polygon()).normalize_or(face.normal);
        let n = face.polygon().len();
        (0..n).filter(|&i| targets[i] != places[i]).count()
    }
}

fn root(mut i: u32, first: &[u32]) -> u32 {
    while first[i as usize] != i {
        i = first[i as usize];
    }
    i
}
