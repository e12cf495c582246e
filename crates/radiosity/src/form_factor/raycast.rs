//! Form factors with visibility by casting rays, two ways.
//!
//! *Pairs* (after Wallace, Elmquist, Haines 1989): the unoccluded factor to every element in front, computed by
//! [`Rules`], times the share of rays between points of both that get through.
//! Unoccluded light is free of noise; the error is that of visibility, at most about `1/(2√k)` of the factor where `k`
//! rays meet a shadow edge, and that geometry and visibility are taken as independent within one pair.
//!
//! *Shots*: rays leave the patch in cosine-distributed directions and count where they arrive. The cost does not depend
//! on the number of elements; each factor `F` has a standard error below `√(F/N)`.
//!
//! Either way the row closes exactly: rays over the hemisphere tell what backs absorb and what escapes, and the factors
//! are scaled to the rest where they differ from it by more than its error; by much more, where nothing hides anything,
//! because then the factors of pairs are the better judge.

use crate::cast::to_f32;
use crate::form_factor::analytic::unoccluded::Rules;
use crate::form_factor::polygon::{FlatPolygon, facing_parts, point_to_polygon};
use crate::form_factor::{FormFactors, Row};
use crate::patch::exposure::ExposedParts;
use crate::patch::face::Side;
use crate::patch::{NodeId, NodeKind, PatchMesh, Polygon};
use crate::sampling::{cosine_direction, hash, point4, polygon_point};
use crate::visibility::{Hit, Visibility};
use glam::Vec3;
use hemicube_raster::Rgb;
use rayon::prelude::*;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// A pair costs about as much as this many rays of a shot; pairs are taken where they are not dearer than a shot would
/// be, because they are free of noise.
const RAYS_PER_PAIR: f64 = 1.0 / 16.0;
/// Most rays of one pair and of one shot.
const MAX_PAIR_RAYS: u32 = 64;
/// How many times more rays go from emitters to elements that were cut a posteriori.
const REFINED_BOOST: f64 = 8.0;
/// Most rays that tell how much of a row of pairs is lost.
const MAX_PROBE_RAYS: u32 = 1024;
const MAX_SHOT_RAYS: f64 = 262_144.0;
const MIN_SHOT_RAYS: f64 = 64.0;
/// Most rays that a shot is asked for.
const MAX_ASKED_RAYS: u32 = 1 << 20;

/// Of the rule of Gauss with two points along each side of the unit square.
const GAUSS_POINTS: [[f32; 2]; 4] = {
    let [low, high] = [0.211_324_87, 0.788_675_1];
    [[low, low], [high, low], [low, high], [high, high]]
};

/// How the rays are spent.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RayCastOptions {
    /// Rays that an element's hemisphere gets, shared among the patches by their form factors; a shot casts as many per
    /// element of average area and average emission. At most 64 go to one pair and 262,144 to one shot.
    /// Default value: 512.
    pub rays: u32,
    /// Rays of every shot, whatever its patch, at most 2^20; pairs are then left to [`Strategy::Pairs`]. So a step has a price
    /// that is known beforehand, and bright patches more noise than with the share that they get otherwise.
    /// Default value: none, by [`Self::rays`].
    pub shot_rays: Option<u32>,
    /// Way to the factors. Default value: chosen by the size of the scene.
    pub strategy: Strategy,
    /// Shifts the low-discrepancy sequences. Default value: 0.
    pub seed: u64,
}

/// Way to the factors of a row.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Strategy {
    /// Pairs for patches so large or bright that a shot would cost as much, shots for the others.
    Automatic,
    /// Always pairs.
    Pairs,
    /// Always shots.
    Shots,
}

impl Default for RayCastOptions {
    fn default() -> Self {
        Self {
            rays: 512,
            shot_rays: None,
            strategy: Strategy::Automatic,
            seed: 0,
        }
    }
}

/// Ray-cast form factors.
#[derive(Debug)]
pub struct RayCast {
    mesh: Arc<PatchMesh>,
    options: RayCastOptions,
    pub(super) rules: Rules,
    bands: usize,
    /// Of each patch: its share of rays beyond that of its area.
    brightness: Vec<f64>,
    mean_element_area: f64,
    rays: AtomicU64,
}

impl RayCast {
    /// Factors between the nodes of a mesh.
    pub fn new(mesh: Arc<PatchMesh>, options: RayCastOptions) -> Self {
        let elements = mesh.elements().len();
        let total: f64 = mesh
            .elements()
            .iter()
            .map(|&e| f64::from(mesh.node(e).area))
            .sum();
        Self {
            bands: if mesh.visibility().is_tinted() { 3 } else { 1 },
            rules: Rules::default(),
            mean_element_area: total / elements.max(1) as f64,
            brightness: brightness(&mesh, total),
            rays: AtomicU64::new(0),
            options: RayCastOptions {
                rays: options.rays.max(1),
                shot_rays: options.shot_rays.map(|rays| rays.clamp(1, MAX_ASKED_RAYS)),
                ..options
            },
            mesh,
        }
    }

    pub(crate) fn mesh_ref(&self) -> &PatchMesh {
        &self.mesh
    }

    /// Rays that [`Self::fill_row`] casts from a node where it shoots.
    pub fn rays_of_shot(&self, source: NodeId) -> u32 {
        self.options
            .shot_rays
            .unwrap_or_else(|| ray_count(self.shot_rays(source), MIN_SHOT_RAYS, MAX_SHOT_RAYS))
    }

    /// Books rays that were cast elsewhere.
    pub fn count_rays(&self, rays: u64) {
        self.rays.fetch_add(rays, Ordering::Relaxed);
    }

    /// Rays that a shot of this patch would take: rays from emitters carry about the same flux as
    /// rays of reflected light.
    fn shot_rays(&self, source: NodeId) -> f64 {
        let brightness = self
            .mesh
            .patch_of_node(source)
            .map_or(1.0, |patch| self.brightness[patch]);
        let area = f64::from(self.mesh.node(source).area);
        f64::from(self.options.rays) * brightness * area / self.mean_element_area
    }
    fn takes_pairs(&self, source: NodeId) -> bool {
        match self.options.strategy {
            Strategy::Pairs => true,
            Strategy::Shots => false,
            Strategy::Automatic if self.options.shot_rays.is_some() => false,
            Strategy::Automatic => {
                let pairs = self.mesh.elements().len() as f64;
                pairs * RAYS_PER_PAIR <= self.shot_rays(source)
            }
        }
    }

    fn pairs(&self, source: NodeId, row: &mut Row) {
        let mesh = &*self.mesh;
        let from = Shooter::new(mesh, source);
        let is_emitter = emits(mesh, source);
        let boost = if is_emitter { 4.0 } else { 1.0 };
        let found: Vec<(u32, PairFactor)> = mesh
            .elements()
            .par_iter()
            .enumerate()
            .with_min_len(256)
            .filter_map(|(e, &id)| {
                // Where a mesh was refined there are shadows of emitters: their noise would look like contrast.
                let more = if is_emitter && mesh.is_refined(id) {
                    REFINED_BOOST
                } else {
                    1.0
                };
                let factor = self.pair(&from, e, id, boost * more);
                factor.is_some().then(|| (crate::index32(e), factor))
            })
            .collect();
        self.write_pairs(&found, &from, row);
    }

    /// Fills a row of factors of pairs and makes it account for everything, by rays over the hemisphere.
    pub(super) fn write_pairs(&self, found: &[(u32, PairFactor)], from: &Shooter, row: &mut Row) {
        row.clear(self.bands);
        let seen = || found.iter().filter(|(_, pair)| !pair.visible.is_black());
        row.receivers.extend(seen().map(|&(e, _)| e));
        for band in 0..self.bands {
            let fractions = seen().map(|(_, pair)| to_f32(pair.unoccluded) * pair.visible[band]);
            row.fractions.extend(fractions);
        }
        let nothing_between = found.iter().all(|(_, pair)| pair.visible == Rgb::WHITE);
        let is_exact = nothing_between && from.exposed.is_none();
        close(&self.mesh, row, is_exact, &self.probe(from));
    }

    /// `F_Pe` in each band.
    pub(crate) fn pair(&self, from: &Shooter, e: usize, element: NodeId, boost: f64) -> PairFactor {
        let exchange =
            |near: &FlatPolygon, far: &FlatPolygon| self.rules.exchange_of_parts(near, far);
        self.pair_by(from, e, element, boost, exchange)
    }

    /// As [`Self::pair`], a tenth as long for near pairs: the exact factor is taken at four points of the element, which
    /// should be small beside its distance; a square in the corner below another of its size is off by some percent.
    pub(crate) fn pair_at_points(
        &self,
        from: &Shooter,
        e: usize,
        element: NodeId,
        boost: f64,
    ) -> PairFactor {
        let normal = self.mesh.node(element).normal.as_dvec3();
        let exchange = |near: &FlatPolygon, far: &FlatPolygon| {
            let factors = GAUSS_POINTS.map(|at| point_to_polygon(far.point(at), normal, near));
            far.area() * factors.iter().sum::<f64>() / factors.len() as f64
        };
        self.pair_by(from, e, element, boost, exchange)
    }

    fn pair_by(
        &self,
        from: &Shooter,
        e: usize,
        element: NodeId,
        boost: f64,
        exchange: impl Fn(&FlatPolygon, &FlatPolygon) -> f64,
    ) -> PairFactor {
        let mesh = &*self.mesh;
        let node = mesh.node(element);
        let polygon = mesh.polygon(element);
        if from.is_apart(node.normal, &polygon) {
            return PairFactor::default();
        }
        let exposed = mesh.exposed(e);
        let flat = FlatPolygon::new(&polygon, node.normal);
        let Some((near, far)) = facing_parts(&from.flat, &flat).filter(|_| exposed.area() > 0.0)
        else {
            return PairFactor::default();
        };
        let exchange = exchange(&near, &far);
        let share = exchange / f64::from(node.area) * boost;
        let rays = ray_count(
            share * f64::from(self.options.rays),
            1.0,
            f64::from(MAX_PAIR_RAYS),
        );
        let seed = hash(
            hash(u64::from(from.id.0), self.options.seed),
            u64::from(element.0),
        );
        // Points are taken where both sides see each other; of whole polygons, only where they are not buried.
        let whole = near == from.flat && far == flat;
        self.rays.fetch_add(u64::from(rays), Ordering::Relaxed);
        let visible = mean_transmittance(
            mesh.visibility(),
            [from.normal, node.normal],
            from.kernel_floor,
            (0..rays).map(|i| point4(i, seed)),
            |[u, v, s, t]| {
                if whole {
                    (from.point([u, v]), exposed.point([s, t]))
                } else {
                    (near.point([u, v]).as_vec3(), far.point([s, t]).as_vec3())
                }
            },
        );
        let unoccluded = exchange / from.area * f64::from(exposed.area() / node.area);
        PairFactor {
            unoccluded,
            visible,
        }
    }

    fn probe(&self, from: &Shooter) -> Lost {
        let rays = self.options.rays.clamp(64, MAX_PROBE_RAYS);
        let visibility = self.mesh.visibility();
        let tallies = self.cast(
            from,
            rays,
            |backs: &mut Vec<(usize, Side, Rgb)>, hit, taken| {
                if !visibility.receives(hit.face, hit.side) {
                    backs.push((hit.face, hit.side, taken));
                }
            },
        );
        let mut lost = Lost {
            absorbed: Rgb::BLACK,
            escaped: Rgb::BLACK,
            rays,
            backs: Vec::new(),
        };
        for (backs, escaped) in tallies {
            lost.escaped += escaped;
            lost.absorbed += backs.iter().map(|&(_, _, taken)| taken).sum();
            lost.backs
                .extend(backs.iter().map(|&(face, side, _)| (face, side)));
        }
        lost
    }

    /// What probing rays tell of a node.
    pub(super) fn lost(&self, source: NodeId) -> Lost {
        self.probe(&Shooter::new(&self.mesh, source))
    }

    /// Casts cosine-distributed rays from a patch; `meet` adds what a surface keeps of a ray to the chunk's tally.
    /// Returns the tally and the escaped share of each chunk of rays, in order.
    fn cast<T: Default + Send>(
        &self,
        from: &Shooter,
        rays: u32,
        meet: impl Fn(&mut T, &Hit, Rgb) + Sync,
    ) -> Vec<(T, Rgb)> {
        const CHUNK: u32 = 1024;
        let visibility = self.mesh.visibility();
        let seed = hash(hash(u64::from(from.id.0), self.options.seed), 0x5E11);
        let share = 1.0 / rays as f32;
        self.rays.fetch_add(u64::from(rays), Ordering::Relaxed);
        (0..rays.div_ceil(CHUNK))
            .into_par_iter()
            .map(|chunk| {
                let mut tally = T::default();
                let mut escaped = Rgb::BLACK;
                for i in chunk * CHUNK..((chunk + 1) * CHUNK).min(rays) {
                    let [u, v, s, t] = point4(i, seed);
                    let x = from.point([u, v]);
                    let direction = cosine_direction(from.normal, [s, t]);
                    let origin = visibility.off_surface(x, from.normal);
                    escaped += visibility.follow(origin, direction, |hit, arriving, passing| {
                        meet(&mut tally, hit, arriving * (Rgb::WHITE - passing) * share);
                    }) * share;
                }
                (tally, escaped)
            })
            .collect()
    }

    fn shots(&self, source: NodeId, row: &mut Row) {
        let mesh = &*self.mesh;
        let from = Shooter::new(mesh, source);
        let rays = self.rays_of_shot(source);
        let tallies = self.cast(&from, rays, |arrivals: &mut Vec<(u32, Rgb)>, hit, taken| {
            let element = mesh
                .element_at(hit.face, hit.side, hit.point)
                .filter(|&e| mesh.exposed_area(e) > 0.0)
                .map_or(u32::MAX, crate::index32);
            arrivals.push((element, taken));
        });
        let mut arrivals = Vec::with_capacity(rays as usize);
        let mut escaped = Rgb::BLACK;
        for (tally, out) in tallies {
            arrivals.extend(tally);
            escaped += out;
        }
        arrivals.sort_by_key(|&(element, _)| element);
        let (mut received, mut absorbed) = (Vec::<(u32, Rgb)>::new(), Rgb::BLACK);
        for (element, taken) in arrivals {
            match received.last_mut() {
                _ if element == u32::MAX => absorbed += taken,
                Some((last, sum)) if *last == element => *sum += taken,
                _ => received.push((element, taken)),
            }
        }
        for &(element, _) in &received {
            row.receivers.push(element);
        }
        for band in 0..self.bands {
            row.fractions
                .extend(received.iter().map(|&(element, taken)| {
                    let kept = 1.0 - mesh.transmittance()[element as usize][band];
                    if kept > 1e-6 { taken[band] / kept } else { 0.0 }
                }));
        }
        let lost = Lost {
            absorbed,
            escaped,
            rays,
            backs: Vec::new(),
        };
        close(mesh, row, false, &lost);
    }
}

/// The factor of a pair.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct PairFactor {
    /// As if nothing were between.
    pub(crate) unoccluded: f64,
    /// The share that rays saw.
    pub(crate) visible: Rgb,
}

impl PairFactor {
    /// Whether anything could arrive.
    pub(super) fn is_some(&self) -> bool {
        self.unoccluded > 0.0
    }
}

impl FormFactors for RayCast {
    fn mesh(&self) -> &Arc<PatchMesh> {
        &self.mesh
    }

    fn fill_row(&self, source: NodeId, row: &mut Row) {
        row.clear(self.bands);
        if self.takes_pairs(source) {
            self.pairs(source, row);
        } else {
            self.shots(source, row);
        }
    }

    fn most_receivers(&self, source: NodeId) -> usize {
        if self.takes_pairs(source) {
            return usize::MAX;
        }
        // A ray arrives at each pane that it passes; few pass more than one or two.
        self.rays_of_shot(source) as usize * 2
    }

    fn rays(&self) -> u64 {
        self.rays.load(Ordering::Relaxed)
    }
}

/// Shares of what leaves a node that no element receives, as rays saw them.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Lost {
    /// Arrives at sides that only absorb.
    pub absorbed: Rgb,
    /// Meets nothing.
    pub escaped: Rgb,
    /// Rays that tell so.
    pub rays: u32,
    /// The sides that only absorb which rays met, one for each ray; not of shots.
    pub backs: Vec<(usize, Side)>,
}

impl Lost {
    /// What is lost of one band of a row of which `received` is known far better than from these rays: the rest, as far as
    /// it is what they saw within five standard errors and a fiftieth, because of buried parts; nothing if they saw
    /// nothing lost.
    pub fn beside(&self, received: f64) -> f64 {
        let lost = f64::from(self.absorbed[0] + self.escaped[0]);
        if lost <= 0.0 {
            return 0.0;
        }
        let reach = self.reach(lost);
        (1.0 - received)
            .clamp(lost - reach, lost + reach)
            .clamp(0.0, 1.0)
    }

    /// Of that rest what sides that only absorb take: `exact` if it is known and the rays do not speak against it, else as
    /// much of the rest as of the lost rays; all of it if no ray escaped.
    pub fn to_backs(&self, rest: f64, exact: Option<f64>) -> f64 {
        let (absorbed, escaped) = (f64::from(self.absorbed[0]), f64::from(self.escaped[0]));
        let by_rays = rest * absorbed / (absorbed + escaped).max(1e-30);
        match exact {
            Some(exact) if escaped > 0.0 && (exact - absorbed).abs() <= self.reach(absorbed) => {
                exact.min(rest)
            }
            _ => by_rays,
        }
    }

    /// How far a share may be from the one that rays saw.
    fn reach(&self, share: f64) -> f64 {
        let one_ray = 1.0 / f64::from(self.rays);
        let error = (share.max(one_ray) * (1.0 - share).max(one_ray) * one_ray).sqrt();
        5.0 * error + 0.02
    }
}

/// Mean transmittance over pairs of points on surfaces with these normals, weighted by the kernel `cos cos / r²`, which
/// `kernel_floor`, an area over π, keeps finite where both meet.
fn mean_transmittance(
    visibility: &Visibility,
    normals: [Vec3; 2],
    kernel_floor: f32,
    samples: impl Iterator<Item = [f32; 4]>,
    pair: impl Fn([f32; 4]) -> (Vec3, Vec3),
) -> Rgb {
    let (mut sum, mut weights) = (Rgb::BLACK, 0.0);
    for sample in samples {
        let (x, y) = pair(sample);
        let offset = y - x;
        let squared = offset.length_squared();
        let weight = (offset.dot(normals[0]) * -offset.dot(normals[1])).max(0.0)
            / (squared * (squared + kernel_floor)).max(f32::MIN_POSITIVE);
        if weight > 0.0 {
            let x = visibility.off_surface(x, normals[0]);
            let y = visibility.off_surface(y, normals[1]);
            sum += visibility.transmittance(x, y) * weight;
            weights += weight;
        }
    }
    if weights > 0.0 {
        sum / weights
    } else {
        Rgb::BLACK
    }
}

/// What a row needs to know of the node that shoots.
pub(crate) struct Shooter {
    id: NodeId,
    polygon: Polygon,
    flat: FlatPolygon,
    normal: Vec3,
    area: f64,
    /// Keeps the kernel finite where both points meet: the area over π, as in the disk approximation.
    kernel_floor: f32,
    /// What of it is exposed, if a part of it is buried.
    exposed: Option<ExposedParts>,
}

impl Shooter {
    pub(crate) fn new(mesh: &PatchMesh, id: NodeId) -> Self {
        let node = mesh.node(id);
        let polygon = mesh.polygon(id);
        let flat = FlatPolygon::new(&polygon, node.normal);
        let area = flat.area().max(1e-30);
        let exposed = ExposedParts::of(mesh, id);
        Self {
            id,
            polygon,
            flat,
            normal: node.normal,
            area,
            kernel_floor: node.area / core::f32::consts::PI,
            exposed,
        }
    }

    /// A point of the exposed part for one of the unit square.
    pub(super) fn point(&self, [u, v]: [f32; 2]) -> Vec3 {
        let Some(exposed) = &self.exposed else {
            return polygon_point(&self.polygon, [u, v]);
        };
        let (part, within) = exposed.at(u);
        part.point([within, v])
    }

    /// Whether one polygon lies wholly behind the other's plane, up to rounding.
    fn is_apart(&self, normal: Vec3, polygon: &[Vec3]) -> bool {
        let behind = |corners: &[Vec3], origin: Vec3, normal: Vec3| {
            let tolerance = 2e-6
                * origin
                    .abs()
                    .max_element()
                    .max(corners[0].abs().max_element());
            corners
                .iter()
                .all(|&c| (c - origin).dot(normal) <= tolerance)
        };
        behind(polygon, self.polygon[0], self.normal) || behind(&self.polygon, polygon[0], normal)
    }
}

/// `cos cos / r²` of two points by the unit normals of their surfaces; 0 where one is behind the other.
pub(crate) fn kernel(offset: Vec3, [from, to]: [Vec3; 2]) -> f32 {
    let squared = offset.length_squared();
    let cosines = (offset.dot(from) * -offset.dot(to)).max(0.0);
    cosines / (squared * squared).max(f32::MIN_POSITIVE)
}

/// `1 + E / B̄` of each patch, where `B̄ = Σ E A / (1 - ρ̄) Σ A` is what the mean radiosity of a closed scene would be.
fn brightness(mesh: &PatchMesh, total_area: f64) -> Vec<f64> {
    let area = |e: usize| f64::from(mesh.exposed_area(e));
    let exitance = |e: usize| f64::from(mesh.emission()[e].max_band());
    let elements = 0..mesh.elements().len();
    let flux: f64 = elements.clone().map(|e| exitance(e) * area(e)).sum();
    let reflected: f64 = elements
        .map(|e| f64::from(mesh.reflectance()[e].max_band()) * area(e))
        .sum();
    let mean = flux
        / (total_area - reflected)
            .max(1e-6 * total_area)
            .max(f64::MIN_POSITIVE);
    let of_patch = |patch| {
        let elements = mesh.elements_of_patch(patch);
        let flux: f64 = elements.clone().map(|e| exitance(e) * area(e)).sum();
        let exposed: f64 = elements.map(area).sum();
        if flux > 0.0 {
            1.0 + flux / exposed / mean
        } else {
            1.0
        }
    };
    (0..mesh.patches().len()).map(of_patch).collect()
}

/// Makes a row account for everything. What is not received goes to backs and outside in proportion to what rays
/// saw there; where it differs from that by more than a standard error, or where they saw nothing lost, the
/// factors are scaled.
///
/// By more than one standard error, if that is large beside what the factors of occluded pairs may be off by: a few rays that
/// meet a far receiver would spoil its factor.
///
/// Factors between which there is nothing (`is_exact`) say better what is lost than the rays: they may differ by five
/// standard errors, and have their gap even where no ray found it, unless it is a narrow one.
pub(super) fn close(mesh: &PatchMesh, row: &mut Row, is_exact: bool, seen: &Lost) {
    let n = row.receivers.len();
    let one_ray = 1.0 / f64::from(seen.rays);
    for band in 0..row.bands {
        let received = row.sum(mesh, band);
        let (back, out) = (
            f64::from(seen.absorbed[band]),
            f64::from(seen.escaped[band]),
        );
        let lost = (back + out).min(1.0);
        let error = (lost.max(one_ray) * (1.0 - lost).max(one_ray) * one_ray).sqrt();
        let gap = 1.0 - received;
        let reach = if is_exact {
            5.0
        } else {
            1.0 + error / (OCCLUDED * received).max(1e-30)
        };
        let has_gap = lost > 0.0 || (is_exact && gap > CERTAIN_GAP);
        let rest = match (received > 0.0, has_gap) {
            (false, _) => 1.0,
            (true, false) => 0.0,
            (true, true) => gap
                .clamp(lost - reach * error, lost + reach * error)
                .clamp(0.0, 1.0),
        };
        if received > 0.0 {
            let scale = to_f32((1.0 - rest) / received);
            let factors = &mut row.fractions[band * n..(band + 1) * n];
            factors.iter_mut().for_each(|f| *f *= scale);
        }
        let to_backs = match (received > 0.0, lost > 0.0) {
            (_, true) => back / (back + out),
            (true, false) => 0.0,
            (false, false) => 1.0,
        };
        row.absorbed[band] = to_f32(rest * to_backs);
        row.escaped[band] = to_f32(rest * (1.0 - to_backs));
    }
    if row.bands == 1 {
        row.absorbed = [row.absorbed[0]; 3];
        row.escaped = [row.escaped[0]; 3];
    }
}

/// Relative error that the sum of a row of occluded factors may have.
const OCCLUDED: f64 = 0.1;
/// Gap that unoccluded factors are believed against rays that found none. Factors of pairs with a small gap or angle are
/// good to 1e-3 only, and a closed scene that leaks is worse than a chink that is stopped.
const CERTAIN_GAP: f64 = 5e-3;

fn emits(mesh: &PatchMesh, id: NodeId) -> bool {
    match mesh.node(id).kind {
        NodeKind::Surface { face, .. } => {
            mesh.scene().materials[mesh.faces()[face as usize].material as usize].emits()
        }
        NodeKind::Cluster { .. } => false,
    }
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "clamped to a range of u32"
)]
fn ray_count(wanted: f64, least: f64, most: f64) -> u32 {
    wanted.ceil().clamp(least, most) as u32
}
