//! What links carry: how much of the light of one node arrives at another.
//!
//! | receiver, source | carried |
//! |---|---|
//! | cell, cell | exact factor between the polygons, times the share of rays that get through |
//! | one or two clusters, apart | `E = V f(ω) / π d²` from centre to centre, where `f(ω) = Σ A B max(0, n·ω)` is what the source sends that way, by nine [`harmonics`](super::harmonics); a cluster takes it as light from direction `-ω` and its faces take of it by their cosines |
//! | with a cluster, spheres overlap | the same, isotropic (Sillion 1995): `f = A B / 4`, a quarter of it to each face |
//!
//! Self-links, which every hierarchy begins with, are of the third kind; they stay only where nothing arrives that
//! counts. Cells with a cluster stand for four points and their centre, clusters for their centre.

mod kernels;
mod visibility;

use self::kernels::{Kernels, Points};
use self::visibility::{Evidence, Sight};
use super::cluster::{Hierarchy, Node, Shape};
use super::link::{Link, Seen, Spread};
use crate::form_factor::analytic::unoccluded::Rules;
use crate::form_factor::polygon::{FlatPolygon, facing_parts};
use crate::patch::PatchMesh;
use core::f32::consts::PI;
use glam::Vec3;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// Relative error of factors between polygons.
const FACTOR_ERROR: f64 = 1e-3;
/// Part of its area that a cluster shows in some direction, of convex bodies a quarter.
const SHOWN: f32 = 0.35;
/// Root mean square of `max(0, n·ω)` over directions.
const COSINE: f32 = 0.41;
/// Root mean square error of nine harmonics for a clamped cosine.
const HARMONIC_ERROR: f32 = 0.036;
/// Share of a linear change over a receiver that its slope may miss, beside what four points and the centre show.
const SLOPE_ERROR: f32 = 0.1;

/// Makes links.
#[derive(Debug)]
pub(super) struct Transport {
    mesh: Arc<PatchMesh>,
    tree: Hierarchy,
    rules: Rules,
    seed: u64,
    /// Most rays of a link.
    most_rays: u32,
    rays: AtomicU64,
}

impl Transport {
    pub(super) fn new(mesh: Arc<PatchMesh>, tree: Hierarchy, most_rays: u32, seed: u64) -> Self {
        Self {
            rules: Rules::new(FACTOR_ERROR),
            mesh,
            tree,
            seed,
            most_rays,
            rays: AtomicU64::new(0),
        }
    }

    pub(super) fn tree(&self) -> &Hierarchy {
        &self.tree
    }

    /// Rays that were cast.
    pub(super) fn rays(&self) -> u64 {
        self.rays.load(Ordering::Relaxed)
    }

    /// Most rays that a link takes.
    pub(super) fn most_rays(&self) -> u32 {
        self.most_rays
    }

    /// Whether a link between two nodes is isotropic.
    pub(super) fn is_near(&self, receiver: u32, source: u32) -> bool {
        let (r, s) = (self.tree.node(receiver), self.tree.node(source));
        let reach = r.radius + s.radius;
        (r.is_cluster() || s.is_cluster()) && r.centre.distance_squared(s.centre) < reach * reach
    }

    /// The link between two nodes; `None` if they do not face each other. `known` is what the link above saw, and `rays`
    /// how many are wanted at least.
    pub(super) fn link(
        &self,
        receiver: u32,
        source: u32,
        known: Option<(Seen, u32)>,
        rays: u32,
    ) -> Option<Link> {
        let (r, s) = (self.tree.node(receiver), self.tree.node(source));
        if is_behind(r, s) || is_behind(s, r) {
            return None;
        }
        if self.is_near(receiver, source) {
            return Some(isotropic(r, s, source));
        }
        let (pair, ends) = match (r.shape, s.shape) {
            (Shape::Cell(_), Shape::Cell(_)) => self.cells(r, s)?,
            _ => (clusters(&self.mesh, r, s), None),
        };
        let sight = Sight {
            mesh: &self.mesh,
            tree: &self.tree,
            nodes: [receiver, source],
            ends,
            seed: self.seed,
        };
        let evidence = sight.look(known, rays.min(self.most_rays));
        self.rays
            .fetch_add(u64::from(evidence.cast), Ordering::Relaxed);
        Some(pair.link(source, &evidence))
    }

    /// Two cells, as if nothing were between them, and the ends of rays where they are not the whole cells.
    fn cells(&self, r: &Node, s: &Node) -> Option<(Pair, Option<[FlatPolygon; 2]>)> {
        let [receiver, source] = [r, s].map(|node| polygon_of(&self.mesh, node));
        if lies_behind(&receiver, &source) || lies_behind(&source, &receiver) {
            return None;
        }
        let (near, far) = facing_parts(&receiver, &source)?;
        let exchange = self.rules.exchange_of_parts(&near, &far);
        // Of parts in front, what is exposed exchanges; where a part is no larger than that, it is taken to be it.
        let open = |part: &FlatPolygon, node: &Node| (f64::from(node.area) / part.area()).min(1.0);
        let opened = exchange * open(&near, r) * open(&far, s);
        let factor = super::to_f32(opened / f64::from(r.area));
        if factor <= 0.0 {
            return None;
        }
        let kernels = Kernels::between(&points_of(&self.mesh, r), &points_of(&self.mesh, s));
        let [over_receiver, over_source] = kernels.spreads(SLOPE_ERROR);
        // Buried parts count more than parts behind the other's plane, for those bring nothing.
        let is_cut = (near != receiver || far != source) && r.is_whole && s.is_whole;
        let pair = Pair {
            factor,
            scale: factor,
            slope: kernels.slope(r.radius),
            over_receiver,
            over_source,
        };
        Some((pair, is_cut.then_some([near, far])))
    }
}

/// A pair without what stands between.
struct Pair {
    factor: f32,
    /// Irradiance for a radiosity of 1.
    scale: f32,
    slope: [f32; 2],
    /// Relative to the scale.
    over_receiver: f32,
    over_source: f32,
}

impl Pair {
    fn link(&self, source: u32, evidence: &Evidence) -> Link {
        let share = evidence.share();
        let variance = evidence.variance();
        let deviation = |relative: f32| {
            let relative = relative * share;
            self.scale * (relative * relative + variance).sqrt()
        };
        let spread = Spread {
            over_receiver: deviation(self.over_receiver),
            over_source: deviation(self.over_source),
            noise: self.scale * evidence.error(),
        };
        Link::new(source, self.factor * share, self.slope, spread)
            .with_seen(evidence.seen(), evidence.rays())
            .with_tint(evidence.tint())
    }
}

/// A pair with a cluster, from centre to centre.
fn clusters(mesh: &PatchMesh, r: &Node, s: &Node) -> Pair {
    let kernels = Kernels::between(&points_of(mesh, r), &points_of(mesh, s));
    let distance = r.centre.distance(s.centre);
    let (near, far) = (r.deviation / distance, s.deviation / distance);
    let sent = if s.is_cluster() {
        SHOWN * s.area
    } else {
        s.area
    };
    let taken = if r.is_cluster() { COSINE } else { 1.0 };
    let factor = kernels.mean() * if s.is_cluster() { 1.0 } else { s.area };
    // What would come from a source that faces a receiver that faces it.
    let scale = sent * taken / (PI * distance * distance);
    let [over_receiver, over_source] = kernels.spreads(SLOPE_ERROR);
    let relative = factor * sent * taken / (scale * if s.is_cluster() { 1.0 } else { s.area });
    Pair {
        factor,
        scale,
        slope: kernels.slope(r.radius),
        over_receiver: if r.is_cluster() {
            HARMONIC_ERROR / COSINE + 3.0 * near
        } else {
            over_receiver * relative
        },
        over_source: if s.is_cluster() {
            HARMONIC_ERROR / SHOWN + far
        } else {
            over_source * relative
        },
    }
}

/// Nodes that overlap: what one sends goes evenly into all directions.
fn isotropic(r: &Node, s: &Node, source: u32) -> Link {
    let reach = 0.5 * (r.radius + s.radius);
    let squared = r.centre.distance_squared(s.centre).max(reach * reach);
    let quarter = |node: &Node| if node.is_cluster() { 1.0 } else { 0.25 };
    let sent = if s.is_cluster() { 1.0 } else { s.area };
    let factor = quarter(r) * quarter(s) * sent / (PI * squared);
    let bound = (s.area / (PI * squared)).min(1.0);
    let spread = Spread {
        over_receiver: bound,
        over_source: bound,
        noise: 0.0,
    };
    Link::new(source, factor, [0.0; 2], spread)
}

/// Whether a node lies wholly behind a cell, by the sphere around it.
fn is_behind(cell: &Node, node: &Node) -> bool {
    !cell.is_cluster() && (node.centre - cell.centre).dot(cell.normal) <= -node.radius
}

/// Whether a polygon lies wholly behind another's plane, up to rounding.
fn lies_behind(polygon: &FlatPolygon, of: &FlatPolygon) -> bool {
    let origin = of.corners()[0];
    let size = origin
        .abs()
        .max_element()
        .max(polygon.corners()[0].abs().max_element());
    let corners = polygon.corners().iter();
    corners
        .into_iter()
        .all(|&c| (c - origin).dot(of.normal) <= 2e-6 * size)
}

fn polygon_of(mesh: &PatchMesh, node: &Node) -> FlatPolygon {
    let Shape::Cell(id) = node.shape else {
        unreachable!("a cell")
    };
    FlatPolygon::new(&mesh.polygon(id), node.normal)
}

/// The points that stand for a node.
fn points_of(mesh: &PatchMesh, node: &Node) -> Points {
    match node.shape {
        Shape::Cell(id) => Points::of_polygon(&mesh.polygon(id), node.normal),
        Shape::Cluster(_) => Points::one(node.centre),
    }
}

/// Two tangents of a cell, the same for all cells of a face.
pub(super) fn tangents(normal: Vec3) -> [Vec3; 2] {
    let (u, v) = normal.any_orthonormal_pair();
    [u, v]
}
