//! What stands between two nodes, by rays.
//!
//! Rays join points of both, which follow a sequence that is even in all four dimensions; pairs of points that do not
//! face each other are passed over. A few rays are enough at first: what they leave open is an error of the link, and where
//! it counts more are asked for. Rays that agree leave a suspicion, too: there may be something that none of them met (an
//! estimate with pseudo-counts, as Laplace's), which is the less the more links above have seen the same.

use super::super::cluster::{Hierarchy, Node, Shape};
use super::super::link::Seen;
use crate::form_factor::polygon::FlatPolygon;
use crate::form_factor::raycast::kernel;
use crate::patch::PatchMesh;
use crate::sampling::{hash, point4, polygon_point};
use core::f32::consts::PI;
use glam::Vec3;
use hemicube_raster::Rgb;

/// Rays at first.
const FEW: u32 = 4;
/// Pairs of points that are tried for each ray.
const TRIES: u32 = 4;
/// Rays of each kind that one might have missed.
const SUSPICION: f32 = 0.05;

/// Two nodes that look at each other.
pub(super) struct Sight<'a> {
    pub(super) mesh: &'a PatchMesh,
    pub(super) tree: &'a Hierarchy,
    /// Receiver and source.
    pub(super) nodes: [u32; 2],
    /// The parts of two cells that are in front of each other, where that is not all of them.
    pub(super) ends: Option<[FlatPolygon; 2]>,
    pub(super) seed: u64,
}

/// What rays saw.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Evidence {
    /// Sums over rays of weights, their squares, and what got through.
    weights: f32,
    squares: f32,
    passed: Rgb,
    /// Rays that were cast here.
    pub(super) cast: u32,
    /// Rays that were asked for here, and those of links above that say the same.
    asked: u32,
    before: u32,
}

impl Sight<'_> {
    /// Casts so many rays, or a few. `known` is what links above saw, and by how many.
    pub(super) fn look(&self, known: Option<(Seen, u32)>, rays: u32) -> Evidence {
        let mut evidence = self.cast(rays.max(FEW));
        let is_confirmed = |seen| seen == evidence.seen() && seen != Seen::Mixed;
        if let Some((_, rays)) = known.filter(|&(seen, _)| is_confirmed(seen)) {
            evidence.before = rays / 2;
        }
        evidence
    }

    fn cast(&self, rays: u32) -> Evidence {
        let mut evidence = Evidence {
            asked: rays,
            ..Evidence::default()
        };
        let [receiver, source] = self.nodes.map(|node| self.tree.node(node));
        let visibility = self.mesh.visibility();
        let seed = hash(
            hash(u64::from(self.nodes[0]), self.seed),
            u64::from(self.nodes[1]),
        );
        // Keeps the weight finite where both ends meet.
        let floor = receiver.area.min(source.area) / PI;
        for pair in 0..rays.saturating_mul(TRIES) {
            let [u, v, s, t] = point4(pair, seed);
            let (x, x_normal) = self.point(0, receiver, [u, v]);
            let (y, y_normal) = self.point(1, source, [s, t]);
            let squared = (y - x).length_squared();
            let weight = kernel(y - x, [x_normal, y_normal]) * squared / (squared + floor);
            if weight <= 0.0 {
                continue;
            }
            let passed = visibility.transmittance(
                visibility.off_surface(y, y_normal),
                visibility.off_surface(x, x_normal),
            );
            evidence.weights += weight;
            evidence.squares += weight * weight;
            evidence.passed += passed * weight;
            evidence.cast += 1;
            if evidence.cast == rays {
                break;
            }
        }
        evidence
    }

    /// A point of an end for one of the unit square, and the normal there.
    fn point(&self, end: usize, node: &Node, sample: [f32; 2]) -> (Vec3, Vec3) {
        if let Some(ends) = &self.ends {
            return (ends[end].point(sample).as_vec3(), node.normal);
        }
        if let (Shape::Cell(id), true) = (node.shape, node.is_whole) {
            return (polygon_point(&self.mesh.polygon(id), sample), node.normal);
        }
        let (element, within) = self.tree.element_at(self.nodes[end], sample[0]);
        let normal = self.mesh.node(self.mesh.elements()[element]).normal;
        (
            self.mesh.exposed(element).point([within, sample[1]]),
            normal,
        )
    }
}

impl Evidence {
    /// What all rays saw. Ends that never faced each other count as blocked.
    pub(super) fn seen(&self) -> Seen {
        let rounding = 1e-4 * self.weights;
        let [r, g, b] = self.passed.to_array();
        if self.passed.max_band() <= rounding {
            Seen::Blocked
        } else if r.min(g).min(b) >= self.weights - rounding {
            Seen::Clear
        } else {
            Seen::Mixed
        }
    }

    /// Rays that say so.
    pub(super) fn rays(&self) -> u32 {
        self.asked + self.before
    }

    /// Share of light that gets through, in the band that gets most.
    pub(super) fn share(&self) -> f32 {
        match self.seen() {
            Seen::Blocked => 0.0,
            Seen::Clear => 1.0,
            Seen::Mixed => (self.passed.max_band() / self.weights).min(1.0),
        }
    }

    /// Share of each band, relative to that.
    pub(super) fn tint(&self) -> Rgb {
        let most = self.passed.max_band();
        match self.seen() {
            Seen::Mixed if most > 0.0 => self.passed / most,
            _ => Rgb::WHITE,
        }
    }

    /// Variance of visibility from ray to ray, what no ray has met yet included.
    pub(super) fn variance(&self) -> f32 {
        let rays = self.rays() as f32;
        let share = (self.share() * rays + SUSPICION) / (rays + 2.0 * SUSPICION);
        share * (1.0 - share)
    }

    /// Standard error of the share.
    pub(super) fn error(&self) -> f32 {
        if self.weights <= 0.0 {
            return self.variance().sqrt();
        }
        let effective = self.weights * self.weights / self.squares.max(f32::MIN_POSITIVE);
        (self.variance() / effective.max(1.0)).sqrt()
    }
}
