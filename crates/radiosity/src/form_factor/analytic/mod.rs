//! Form factors without sampling: exact where possible, to a stated error where that is cheaper.
//!
//! *Without obstruction* the factor of two polygons has a closed form or converges exponentially, and a bound says
//! which is the cheapest rule that will do: [`unoccluded`]. *Visibility* is geometry, too: a pair whose shaft no face
//! reaches is wholly visible, one whose shaft a face cuts off is hidden ([`shaft`]), and for the rest the shadows that
//! faces throw from points of one polygon on the other are cut out exactly ([`occlusion`]). Only panes, alpha masks and
//! pairs behind very many small faces are sampled with rays.
//!
//! [`Analytic`] fills rows; for all patches at once it computes each pair but once (`A_a F_ab = A_b F_ba`), in blocks
//! of neighbours that share their shaft's occluders.
//!
//! What no element receives is lost: to the sky, or to sides of faces that only absorb. Where both take of it, the sides
//! are faced like elements and the sky gets the rest.
//!
//! Two faces in one plane that overlap and look the same way, such as a rug drawn on its floor, both count as seen.
//!
//! [`exchange`](fn@exchange) and [`occluded_exchange`] are the same for polygons that belong to no scene.

mod backs;
pub mod exchange;
pub mod flat_surfaces;
mod matrix;
pub mod occluders;
pub mod occlusion;
pub mod shaft;
pub mod site;
pub mod unoccluded;

use crate::cast::to_f32;
pub(crate) use exchange::in_front;
pub use exchange::{Exchange, area, exchange, exchange_area, form_factor, reciprocal, vector_area};
pub use occlusion::occluded_exchange;

use crate::error::RadiosityError;
use crate::form_factor::matrix::DenseRows;
use crate::form_factor::polygon::{FlatPolygon, facing_parts, point_to_polygon};
use crate::form_factor::raycast::close;
use crate::form_factor::{FormFactors, RayCast, RayCastOptions, Row};
use crate::patch::face::{Side, WorldFace};
use crate::patch::{NodeId, NodeKind, PatchMesh};
use crate::sampling::{hash, point2};
use crate::stop::Stop;
use backs::Backs;
use flat_surfaces::FlatSurfaces;
use glam::DVec3;
use hemicube_raster::Rgb;
use occluders::{Obstacle, Occluders};
use occlusion::{Shadows, cubature};
use rayon::prelude::*;
use shaft::{Blocks, Bounds, Occluder};
use site::Site;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, OnceLock};
use unoccluded::{Facing, Rules, facing};

/// Consecutive elements that share the search for occluders.
const BLOCK: usize = 16;
/// Occluders in the shaft of one pair above which it is sampled with rays, because cutting all their shadows takes long.
const MANY_OCCLUDERS: usize = 24;
/// Elements up to which there is time to cut more of them, where a pair matters.
const FEW_ELEMENTS: usize = 1000;

/// [`MANY_OCCLUDERS`] of a mesh of few elements, by the factor from the smaller of both.
fn most_occluders(factor: f64) -> usize {
    match factor {
        f if f > 0.01 => 1000,
        f if f > 0.001 => 200,
        _ => MANY_OCCLUDERS,
    }
}

/// Rays from each point of the smaller polygon of a pair that is sampled.
/// Few would make the mean over them biased: what is near weighs more and is hidden less.
const RAYS_PER_POINT: u32 = 16;

/// How exact analytic factors are.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AnalyticOptions {
    /// Wanted error: of factors without obstruction, relative, RMS where the rules change (rows sum to 1 within it);
    /// of obstructed ones, the estimated absolute error of the factor from the smaller of both, as far as 4096 cells of
    /// its cubature reach. From 1e-9 to 0.1.
    /// Default value: 1e-5.
    pub error: f64,
    /// Shifts the sequences of rays, where they are needed. Default value: 0.
    pub seed: u64,
}

impl Default for AnalyticOptions {
    fn default() -> Self {
        Self {
            error: 1e-5,
            seed: 0,
        }
    }
}

impl AnalyticOptions {
    /// Another wanted error.
    pub fn with_error(self, error: f64) -> Self {
        Self { error, ..self }
    }
}

/// Analytic form factors between the nodes of a mesh. Rows of clusters panic.
///
/// Pairs through panes and alpha masks, and pairs with more than 24 surfaces in their shaft (in meshes of up to 1000
/// elements 200 if the factor is above 0.001, 1000 if above 0.01), get the exact factor without
/// obstruction times the share of rays that arrives: 1024 where the factor from the smaller of both is above 0.05, down
/// to 48 where it is below 0.001, for a standard error of some 2 % to 9 % of the factor.
#[derive(Debug)]
pub struct Analytic {
    mesh: Arc<PatchMesh>,
    options: AnalyticOptions,
    rules: Rules,
    bands: usize,
    /// Of each element.
    ends: Vec<End>,
    blocks: Vec<Block>,
    surfaces: FlatSurfaces,
    occluders: Occluders,
    /// Tells what backs absorb and what escapes, roughly.
    rays: RayCast,
    /// Sides that only absorb; made when they are first asked for.
    backs: OnceLock<Backs>,
    sampled_pairs: AtomicU64,
}

/// One side of a pair.
#[derive(Debug, Clone, Copy)]
struct End {
    /// Tells its random numbers from those of others.
    key: u64,
    /// Which flat surface it is of: parts of one do not see each other.
    surface: u32,
    site: Site,
    bounds: Bounds,
}

/// Consecutive elements, near each other if the mesh is sensible.
#[derive(Debug, Clone)]
struct Block {
    elements: core::ops::Range<usize>,
    bounds: Bounds,
}

/// Memory for pairs, used again and again.
#[derive(Default)]
struct Scratch<'a> {
    /// In the shaft of two blocks, then of an element and a block, then of a pair.
    of_blocks: Vec<&'a Obstacle>,
    of_row: Vec<&'a Obstacle>,
    of_pair: Vec<&'a Occluder>,
    shadows: Shadows,
    /// Whether a pair was sampled with rays.
    has_sampled: bool,
}

impl Analytic {
    /// Factors between the nodes of a mesh.
    ///
    /// # Errors
    /// An error out of its range.
    pub fn new(mesh: Arc<PatchMesh>, options: AnalyticOptions) -> Result<Self, RadiosityError> {
        if !(1e-9..=0.1).contains(&options.error) {
            return Err(RadiosityError::Option(format!(
                "error {} of form factors is not between 1e-9 and 0.1",
                options.error
            )));
        }
        let materials = &mesh.scene().materials;
        let is_opaque = |face: &WorldFace| !materials[face.material as usize].may_transmit();
        let surfaces = FlatSurfaces::new(mesh.faces(), |a, b| is_opaque(a) && is_opaque(b));
        let ends: Vec<End> = mesh
            .elements()
            .par_iter()
            .map(|&id| End::new(&mesh, &surfaces, id))
            .collect();
        let ray_options = RayCastOptions {
            rays: 256,
            seed: options.seed,
            ..RayCastOptions::default()
        };
        Ok(Self {
            rules: Rules::new(options.error),
            bands: if mesh.visibility().is_tinted() { 3 } else { 1 },
            blocks: blocks(&ends),
            occluders: Occluders::new(&mesh, &surfaces),
            surfaces,
            rays: RayCast::new(mesh.clone(), ray_options),
            backs: OnceLock::new(),
            sampled_pairs: AtomicU64::new(0),
            ends,
            options,
            mesh,
        })
    }

    /// The options it was made with.
    pub fn options(&self) -> AnalyticOptions {
        self.options
    }

    /// Those of the occluders that rise above the horizon of `from` in the shaft towards a box.
    fn towards<'a>(
        &self,
        from: &End,
        to: &Bounds,
        candidates: &[&'a Obstacle],
        found: &mut Vec<&'a Obstacle>,
    ) {
        found.clear();
        found.extend(candidates.iter().copied().filter(|obstacle| {
            obstacle.surface != from.surface
                && obstacle.occluder.bounds.meets_shaft(&from.bounds, to)
                && self.rises_above(obstacle, from)
        }));
    }

    fn rises_above(&self, obstacle: &Obstacle, end: &End) -> bool {
        let (origin, normal) = (end.site.centre, end.site.polygon.normal);
        obstacle
            .occluder
            .rises_above(origin, normal, self.occluders.rounding())
    }

    /// `A_a F_ab` in each band; `scratch.of_row` holds the occluders that may be between.
    fn pair(&self, a: &End, b: &End, scratch: &mut Scratch<'_>) -> Rgb {
        let how = facing(&a.site, &b.site);
        if how == Facing::Not {
            return Rgb::BLACK;
        }
        if scratch.of_row.is_empty() {
            return Rgb::splat(to_f32(self.rules.exchange(&a.site, &b.site)));
        }
        let parts;
        let (part_a, part_b) = if how == Facing::Whole {
            (&a.site.polygon, &b.site.polygon)
        } else {
            parts = facing_parts(&a.site.polygon, &b.site.polygon);
            match &parts {
                Some((part_a, part_b)) => (part_a, part_b),
                None => return Rgb::BLACK,
            }
        };
        let whole = self.rules.exchange(&a.site, &b.site);
        let factor = whole / a.site.area.min(b.site.area);
        let most_occluders = if self.ends.len() <= FEW_ELEMENTS {
            most_occluders(factor)
        } else {
            MANY_OCCLUDERS
        };
        let rounding = self.occluders.rounding();
        let mut is_sampled = false;
        scratch.of_pair.clear();
        for obstacle in &scratch.of_row {
            // Rays will tell, and black is black whether a surface hides all or many do.
            if scratch.of_pair.len() > most_occluders {
                break;
            }
            let occluder = &obstacle.occluder;
            let is_beside = obstacle.surface == b.surface
                || !occluder.bounds.meets_shaft(&a.bounds, &b.bounds)
                || !self.rises_above(obstacle, b);
            if is_beside {
                continue;
            }
            match occluder.blocks(part_a.corners(), part_b.corners(), rounding) {
                Blocks::Nothing => continue,
                Blocks::All if !obstacle.transmits => return Rgb::BLACK,
                Blocks::All | Blocks::Part => scratch.of_pair.push(occluder),
            }
            is_sampled |= obstacle.transmits;
        }
        if scratch.of_pair.is_empty() {
            return Rgb::splat(to_f32(whole));
        }
        if is_sampled || scratch.of_pair.len() > most_occluders {
            scratch.has_sampled = true;
            let points = sampled_points(factor);
            self.sampled_pairs.fetch_add(1, Ordering::Relaxed);
            return self.sampled(a, b, (part_a, part_b), points) * to_f32(whole);
        }
        let tolerance = self.options.error * a.site.area.min(b.site.area);
        let found = cubature(
            part_a,
            part_b,
            &scratch.of_pair,
            tolerance,
            rounding,
            &mut scratch.shadows,
        );
        Rgb::splat(to_f32(found.of_whole(whole)))
    }

    /// Sky and absorbed share of a row; rays are asked only where more is missing than the error of factors explains.
    fn lost(&self, source: NodeId, received: f64) -> (f64, f64) {
        if (1.0 - received).abs() <= 10.0 * self.options.error {
            return (0.0, 0.0);
        }
        let lost = self.rays.lost(source);
        let rest = lost.beside(received);
        let absorbed = lost.to_backs(rest, self.absorbed(source, &lost));
        (rest - absorbed, absorbed)
    }

    /// Share of light that gets from one polygon to the other, by rays from points of the smaller one. Points count by
    /// their exact factor, rays of one point by the kernel `cos cos / r²`.
    fn sampled(&self, a: &End, b: &End, parts: (&FlatPolygon, &FlatPolygon), points: u32) -> Rgb {
        let seed = hash(hash(a.key, self.options.seed), b.key);
        let (from, to) = if a.site.radius <= b.site.radius {
            parts
        } else {
            (parts.1, parts.0)
        };
        let (mut sum, mut weights) = (Rgb::BLACK, 0.0);
        for i in 0..points {
            let x = from.point(point2(i, seed));
            let weight = to_f32(point_to_polygon(x, from.normal, to));
            if weight > 0.0 {
                let samples = (0..RAYS_PER_POINT).map(|k| i * RAYS_PER_POINT + k);
                sum += self.seen_from(x, from, to, samples, seed) * weight;
                weights += weight;
            }
        }
        if weights > 0.0 {
            sum / weights
        } else {
            Rgb::BLACK
        }
    }

    /// Share of light that gets from a point to a polygon.
    fn seen_from(
        &self,
        x: DVec3,
        from: &FlatPolygon,
        to: &FlatPolygon,
        samples: impl Iterator<Item = u32>,
        seed: u64,
    ) -> Rgb {
        let visibility = self.mesh.visibility();
        let origin = visibility.off_surface(x.as_vec3(), from.normal.as_vec3());
        let (mut sum, mut weights) = (Rgb::BLACK, 0.0);
        for sample in samples {
            let y = to.point(point2(sample, !seed));
            let offset = y - x;
            let squared = offset.length_squared().max(1e-30);
            let kernel = offset.dot(from.normal) * -offset.dot(to.normal) / (squared * squared);
            if kernel > 0.0 {
                let end = visibility.off_surface(y.as_vec3(), to.normal.as_vec3());
                sum += visibility.transmittance(origin, end) * to_f32(kernel);
                weights += to_f32(kernel);
            }
        }
        if weights > 0.0 {
            sum / weights
        } else {
            Rgb::BLACK
        }
    }
}

impl End {
    fn new(mesh: &PatchMesh, surfaces: &FlatSurfaces, id: NodeId) -> Self {
        let NodeKind::Surface { face, side } = mesh.node(id).kind else {
            panic!("a row of a cluster: only surfaces have one");
        };
        let corners: Vec<DVec3> = mesh.polygon(id).iter().map(|c| c.as_dvec3()).collect();
        // That of the whole face: small parts, far from the origin, would have one of their own by rounding.
        let normal = normal_of(&mesh.faces()[face as usize], side);
        Self {
            key: u64::from(id.0),
            surface: surfaces.of_face[face as usize],
            site: Site::with_normal(&corners, normal),
            bounds: Bounds::around(&corners),
        }
    }
}

/// Of a side of a face, of unit length.
fn normal_of(face: &WorldFace, side: Side) -> DVec3 {
    let corners: Vec<DVec3> = face.polygon().iter().map(|c| c.as_dvec3()).collect();
    let front = vector_area(&corners).normalize_or_zero();
    if side == Side::Front { front } else { -front }
}

/// Cuts the elements into runs of at most [`BLOCK`]; large faces keep theirs for themselves.
fn blocks(ends: &[End]) -> Vec<Block> {
    let mut blocks = Vec::new();
    let mut start = 0;
    while start < ends.len() {
        let most = (start + BLOCK).min(ends.len());
        let same = ends[start..most]
            .iter()
            .take_while(|e| e.surface == ends[start].surface)
            .count();
        // Faces of one or two elements share a block with their neighbours in the file.
        let end = if same > 2 { start + same } else { most };
        let bounds = ends[start..end]
            .iter()
            .fold(Bounds::EMPTY, |b, e| b.union(e.bounds));
        blocks.push(Block {
            elements: start..end,
            bounds,
        });
        start = end;
    }
    blocks
}

impl FormFactors for Analytic {
    fn mesh(&self) -> &Arc<PatchMesh> {
        &self.mesh
    }

    fn fill_row(&self, source: NodeId, row: &mut Row) {
        row.clear(self.bands);
        let mesh = &*self.mesh;
        let from = End::new(mesh, &self.surfaces, source);
        let area = exposed_area(mesh, source);
        // Of a buried part rays know the outline roughly.
        let mut is_exact = area == f64::from(mesh.node(source).area);
        if area > 0.0 {
            let blocks = self.blocks.par_iter().with_min_len(8);
            let found: Vec<(Vec<(u32, Rgb)>, bool)> = blocks
                .map_init(Scratch::default, |scratch, block| {
                    scratch.has_sampled = false;
                    let found = self.block_of_row(&from, block, scratch);
                    (found, scratch.has_sampled)
                })
                .collect();
            is_exact &= found.iter().all(|(_, has_sampled)| !has_sampled);
            let found: Vec<(u32, Rgb)> = found.into_iter().flat_map(|(found, _)| found).collect();
            row.receivers.extend(found.iter().map(|&(e, _)| e));
            for band in 0..self.bands {
                let factor = |&(_, exchange): &(u32, Rgb)| to_f32(f64::from(exchange[band]) / area);
                row.fractions.extend(found.iter().map(factor));
            }
        }
        let lost = self.rays.lost(source);
        close(mesh, row, is_exact, &lost);
        if is_exact && self.bands == 1 {
            let rest = f64::from(row.absorbed[0] + row.escaped[0]);
            let absorbed = lost.to_backs(rest, self.absorbed(source, &lost));
            row.absorbed = [to_f32(absorbed); 3];
            row.escaped = [to_f32(rest - absorbed); 3];
        }
    }

    fn rays(&self) -> u64 {
        self.rays.rays()
    }

    fn sampled_pairs(&self) -> u64 {
        self.sampled_pairs.load(Ordering::Relaxed)
    }

    fn dense_rows(&self, stop: Stop<'_>) -> Option<DenseRows> {
        let is_one_to_one = self.mesh.patches() == self.mesh.elements();
        let transmits = self.mesh.transmittance().iter().any(|t| !t.is_black());
        (is_one_to_one && self.bands == 1 && !transmits).then(|| matrix::dense_rows(self, stop))
    }
}

impl Analytic {
    /// Elements of a block that receive something from a node, with `A F`.
    fn block_of_row<'a>(
        &'a self,
        from: &End,
        block: &Block,
        scratch: &mut Scratch<'a>,
    ) -> Vec<(u32, Rgb)> {
        self.occluders
            .between(&from.bounds, &block.bounds, &mut scratch.of_blocks);
        let candidates = core::mem::take(&mut scratch.of_blocks);
        self.towards(from, &block.bounds, &candidates, &mut scratch.of_row);
        scratch.of_blocks = candidates;
        let mut found = Vec::new();
        for e in block.elements.clone() {
            let to = &self.ends[e];
            if to.surface == from.surface || self.mesh.exposed_area(e) == 0.0 {
                continue;
            }
            let exchange = self.pair(from, to, scratch);
            if !exchange.is_black() {
                found.push((crate::index32(e), exchange));
            }
        }
        found
    }
}

/// Points of a pair that is sampled: the more it matters, by the factor from the smaller of both.
fn sampled_points(factor: f64) -> u32 {
    match factor {
        f if f > 0.05 => 64,
        f if f > 0.01 => 16,
        f if f > 0.001 => 6,
        _ => 3,
    }
}

/// Exposed area of a patch or, of other nodes, their whole area.
fn exposed_area(mesh: &PatchMesh, id: NodeId) -> f64 {
    mesh.patch_of_node(id).map_or_else(
        || f64::from(mesh.node(id).area),
        |patch| crate::form_factor::matrix::patch_area(mesh, patch),
    )
}
