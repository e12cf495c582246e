//! Patches that emit, by their elements.

use super::lights::{Lamp, Place};
use super::source::Source;
use crate::patch::exposure::ExposedArea;
use crate::patch::{NodeId, PatchMesh};
use glam::Vec3;

/// Emitters nearer than so many radii of both nearly touch.
pub(super) const NEAR: f32 = 2.0;

/// A patch that emits.
pub(super) struct Emitter {
    pub(super) patch: usize,
    pub(super) id: NodeId,
    pub(super) place: Place,
    pub(super) source: Source,
    /// By channel.
    pub(super) flux: Vec<f64>,
}

/// The elements of all emitters, side by side: rays take them in no order.
pub(super) struct Elements {
    /// The first of each emitter.
    pub(super) firsts: Vec<u32>,
    /// With their normals.
    pub(super) areas: Vec<(ExposedArea, Vec3)>,
    /// `[element][channel]`.
    pub(super) exitance: Vec<f32>,
}

impl Elements {
    /// Of emitters by their exitance, `[channel][element]`.
    pub(super) fn of(mesh: &PatchMesh, emitters: &[Emitter], exitance: &[f32]) -> Self {
        let mut elements = Self {
            firsts: vec![0],
            areas: Vec::new(),
            exitance: Vec::new(),
        };
        let count = mesh.elements().len();
        for emitter in emitters {
            for e in mesh.elements_of_patch(emitter.patch) {
                let normal = mesh.node(mesh.elements()[e]).normal;
                elements.areas.push((mesh.exposed(e), normal));
                elements
                    .exitance
                    .extend(exitance[e..].iter().step_by(count));
            }
            elements.firsts.push(crate::index32(elements.areas.len()));
        }
        elements
    }

    /// By channel.
    pub(super) fn exitance_of(&self, element: u32, channels: usize) -> &[f32] {
        let start = element as usize * channels;
        &self.exitance[start..start + channels]
    }
}

impl Emitter {
    /// None if the patch emits nothing.
    pub(super) fn new(
        mesh: &PatchMesh,
        patch: usize,
        exitance: &[f32],
        channels: usize,
    ) -> Option<Self> {
        let count = mesh.elements().len();
        let exitance = |e: usize, channel: usize| exitance[channel * count + e];
        let source = Source::new(mesh, patch, |e| {
            let sum: f32 = (0..channels).map(|channel| exitance(e, channel)).sum();
            f64::from(sum * mesh.exposed_area(e))
        });
        if source.total() <= 0.0 {
            return None;
        }
        let id = mesh.patches()[patch];
        let elements = mesh.elements_of_patch(patch);
        let flux = |channel: usize| {
            let of = |e: usize| f64::from(exitance(e, channel)) * f64::from(mesh.exposed_area(e));
            elements.clone().map(of).sum()
        };
        Some(Self {
            patch,
            id,
            place: place_of(mesh, id),
            source,
            flux: (0..channels).map(flux).collect(),
        })
    }

    pub(super) fn is_near(&self, receiver: &Place) -> bool {
        let reach = NEAR * (self.place.radius + receiver.radius);
        self.place.centroid.distance_squared(receiver.centroid) < reach * reach
    }

    pub(super) fn lamp(&self) -> Lamp {
        Lamp {
            centroid: self.place.centroid,
            normal: self.place.normal,
            radius: self.place.radius,
            flux: self.flux.iter().map(|&flux| super::to_f32(flux)).collect(),
        }
    }
}

/// Where a patch is.
pub(super) fn place_of(mesh: &PatchMesh, id: NodeId) -> Place {
    let node = mesh.node(id);
    let corners = mesh.polygon(id);
    let distances = corners.iter().map(|c| c.distance(node.centroid));
    Place::disc(node.centroid, node.normal, distances.fold(0.0, f32::max))
}
