//! What sides of faces absorb that do not receive: the backs of one-sided faces, and both sides of obstructions.
//!
//! No element stands for them, but the factor to a side is that to any polygon. Of up to [`FEW`] sides that face a node
//! all are computed; of more, those that rays met, and what is behind the others is the share of rays that were the only
//! one to meet theirs (Good, *The population frequencies of species*, 1953).

use super::shaft::Bounds;
use super::site::Site;
use super::unoccluded::{Facing, facing};
use super::{Analytic, End, FlatSurfaces, Scratch, exposed_area, normal_of};
use crate::form_factor::raycast::Lost;
use crate::patch::face::{Side, WorldFace};
use crate::patch::{NodeId, PatchMesh};
use glam::DVec3;
use rayon::prelude::*;

/// Sides that face a node up to which all are computed.
const FEW: usize = 64;
/// Sides of a scene up to which it is looked which face a node.
const MANY: usize = 4096;

/// The sides of a scene that only absorb.
#[derive(Debug)]
pub(super) struct Backs {
    ends: Vec<End>,
    /// For each face the positions of its front and of its back among the ends; none of sides that receive.
    of_face: Vec<[Option<u32>; 2]>,
    /// Whether light passes through any of them.
    transmit: bool,
}

impl Backs {
    fn new(mesh: &PatchMesh, surfaces: &FlatSurfaces) -> Self {
        let faces = mesh.faces();
        let is_back = |face: usize, side| !mesh.visibility().receives(face, side);
        let mut backs = Self {
            ends: Vec::new(),
            of_face: vec![[None; 2]; faces.len()],
            transmit: false,
        };
        let materials = &mesh.scene().materials;
        let mut members = vec![Vec::new(); surfaces.outlines.len()];
        for (face, &surface) in surfaces.of_face.iter().enumerate() {
            members[surface as usize].push(face);
            let has_back = is_back(face, Side::Front) || is_back(face, Side::Back);
            backs.transmit |= has_back && materials[faces[face].material as usize].may_transmit();
        }
        for (surface, members) in members.iter().enumerate() {
            for side in [Side::Front, Side::Back] {
                // A surface whose outline is known is one polygon.
                match &surfaces.outlines[surface] {
                    Some(outline) if members.iter().all(|&face| is_back(face, side)) => {
                        let end = end_of(outline, &faces[members[0]], side, surface);
                        backs.push(end, members, side);
                    }
                    _ => {
                        for &face in members.iter().filter(|&&face| is_back(face, side)) {
                            let polygon = faces[face].polygon().iter().map(|c| c.as_dvec3());
                            let polygon: Vec<DVec3> = polygon.collect();
                            let end = end_of(&polygon, &faces[face], side, surface);
                            backs.push(end, &[face], side);
                        }
                    }
                }
            }
        }
        backs
    }

    fn push(&mut self, end: End, faces: &[usize], side: Side) {
        let position = crate::index32(self.ends.len());
        self.ends.push(end);
        for &face in faces {
            self.of_face[face][side as usize] = Some(position);
        }
    }

    /// The ends whose factors are wanted, and the share of rays that says what the others take.
    fn chosen(&self, from: &End, lost: &Lost) -> (Vec<u32>, f64) {
        let faces = |end: &End| facing(&from.site, &end.site) != Facing::Not;
        if self.ends.len() <= MANY {
            let facing = (0..).zip(&self.ends).filter(|(_, end)| faces(end));
            let facing: Vec<u32> = facing.map(|(i, _)| i).collect();
            if facing.len() <= FEW {
                return (facing, 0.0);
            }
        }
        let met = lost.backs.iter();
        let mut met: Vec<u32> = met
            .filter_map(|&(face, side)| self.of_face[face][side as usize])
            .collect();
        met.sort_unstable();
        let once = met.chunk_by(u32::eq).filter(|same| same.len() == 1).count();
        met.dedup();
        (met, once as f64 / f64::from(lost.rays))
    }
}

/// `corners` are counter-clockwise seen from the front.
fn end_of(corners: &[DVec3], face: &WorldFace, side: Side, surface: usize) -> End {
    let mut corners = corners.to_vec();
    if side == Side::Back {
        corners.reverse();
    }
    End {
        key: u64::MAX,
        surface: crate::index32(surface),
        site: Site::with_normal(&corners, normal_of(face, side)),
        bounds: Bounds::around(&corners),
    }
}

impl Analytic {
    /// Share of what leaves a node that sides take which only absorb. `None` where it is not known better than from the
    /// rays: they met none or let nothing escape, something transmits or is buried, or a pair would have to be sampled.
    pub(super) fn absorbed(&self, source: NodeId, lost: &Lost) -> Option<f64> {
        let area = exposed_area(&self.mesh, source);
        let is_whole = area > 0.0 && area == f64::from(self.mesh.node(source).area);
        if lost.backs.is_empty() || lost.escaped.is_black() || !is_whole {
            return None;
        }
        let backs = self
            .backs
            .get_or_init(|| Backs::new(&self.mesh, &self.surfaces));
        if backs.transmit {
            return None;
        }
        let from = End::new(&self.mesh, &self.surfaces, source);
        let (chosen, others) = backs.chosen(&from, lost);
        let exchanges = chosen.par_iter().map_init(Scratch::default, |scratch, &i| {
            self.exchange_with_back(&from, &backs.ends[i as usize], scratch)
        });
        let exchanges: Vec<Option<f64>> = exchanges.collect();
        let sum: Option<f64> = exchanges.into_iter().sum();
        Some(sum? / area + others)
    }

    /// `A F` to a side, `None` if it would have to be sampled.
    fn exchange_with_back<'a>(
        &'a self,
        from: &End,
        to: &End,
        scratch: &mut Scratch<'a>,
    ) -> Option<f64> {
        if to.surface == from.surface {
            return Some(0.0);
        }
        self.occluders
            .between(&from.bounds, &to.bounds, &mut scratch.of_blocks);
        let candidates = core::mem::take(&mut scratch.of_blocks);
        self.towards(from, &to.bounds, &candidates, &mut scratch.of_row);
        scratch.of_blocks = candidates;
        scratch.has_sampled = false;
        let exchange = f64::from(self.pair(from, to, scratch).r);
        (!scratch.has_sampled).then_some(exchange)
    }
}
