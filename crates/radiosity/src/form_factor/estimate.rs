//! Ray-cast form factors with their standard errors: between areas, to elements, at points and vertices.
//!
//! [`fill_row`](super::FormFactors::fill_row) spends its rays where they tell most and closes its rows; what it does not say is
//! how far to trust a number. The functions here do. They take their samples in 16 independent *replicates*, so that
//! the spread of the replicates' means is an honest measure even where the samples within one depend on each other:
//!
//! ```text
//! factor = mean of the 16 means,   standard error = √(Σ (mean_r - factor)² / (16 · 15))
//! ```
//!
//! With 16 replicates the error itself is known to 18 %, and `(factor - truth) / error` follows Student's distribution of 15
//! degrees of freedom: 95 % lie within 2.1, 99.9 % within 4.1. An error of 0 means that all rays agreed. Where that is
//! because next to none hit, the factor is below some `3 / rays`.
//!
//! | function | estimator |
//! |---|---|
//! | [`RayCast::area_factor`] | exact unoccluded factor × share of rays between both that get through, weighted by `cos cos / r²` |
//! | [`RayCast::estimated_row`] | cosine-distributed rays from the area, counted where they arrive |
//! | [`RayCast::point_row`] | the same from a point |
//! | [`RayCast::point_factor`], [`RayCast::vertex_factors`] | exact factor of the point (Lambert) × weighted share of rays to the source that get through (Wallace, Elmquist, Haines 1989) |

use crate::cast::to_f32;
use crate::form_factor::RayCast;
use crate::form_factor::polygon::{FlatPolygon, facing_parts, point_to_polygon};
use crate::form_factor::raycast::{Shooter, kernel};
use crate::patch::{NodeId, NodeKind};
use crate::sampling::{cosine_direction, hash, point2, point4, stratified2, stratified4};
use glam::Vec3;
use hemicube_raster::Rgb;
use rayon::prelude::*;

/// Independent repetitions of every estimate.
const REPLICATES: u32 = 16;

/// How samples are chosen.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Sampler {
    /// One drawn at random in each cell of a grid; the error falls as `rays^(-3/4)` at a shadow's edge and as `1/rays` or
    /// faster where nothing jumps.
    Stratified,
    /// The additive recurrence of [`sampling`](crate::sampling), shifted at random for each replicate (Cranley, Patterson
    /// 1976); mostly the smaller error of the two.
    #[default]
    LowDiscrepancy,
}

impl Sampler {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Stratified, Self::LowDiscrepancy];

    /// Name in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Stratified => "stratified",
            Self::LowDiscrepancy => "low-discrepancy",
        }
    }

    fn squares(self, count: u32, seed: u64) -> Vec<[f32; 2]> {
        match self {
            Self::Stratified => stratified2(count, seed),
            Self::LowDiscrepancy => (0..count).map(|i| point2(i, seed)).collect(),
        }
    }

    fn pairs_of_squares(self, count: u32, seed: u64) -> Vec<[f32; 4]> {
        match self {
            Self::Stratified => stratified4(count, seed),
            Self::LowDiscrepancy => (0..count).map(|i| point4(i, seed)).collect(),
        }
    }
}

/// How an estimate is sampled.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Sampling {
    /// Rays of all replicates together; each takes a sixteenth, at least 1, and grids round down. Default value: 4096.
    pub rays: u32,
    /// Default value: low-discrepancy.
    pub sampler: Sampler,
    /// Default value: 0.
    pub seed: u64,
}

impl Default for Sampling {
    fn default() -> Self {
        Self {
            rays: 4096,
            sampler: Sampler::default(),
            seed: 0,
        }
    }
}

impl Sampling {
    /// Another number of rays.
    pub fn with_rays(self, rays: u32) -> Self {
        Self { rays, ..self }
    }

    /// Another way to choose them.
    pub fn with_sampler(self, sampler: Sampler) -> Self {
        Self { sampler, ..self }
    }

    /// Another seed.
    pub fn with_seed(self, seed: u64) -> Self {
        Self { seed, ..self }
    }

    fn rays_of_one(self) -> u32 {
        (self.rays / REPLICATES).max(1)
    }

    /// Runs the replicates, each with a seed of its own made of `place`; in order on any number of threads.
    fn replicates<T: Send>(self, place: u64, run: impl Fn(u64) -> T + Sync) -> Vec<T> {
        let seed = hash(place, self.seed);
        let replicate = |r: u32| run(hash(seed, u64::from(r)));
        (0..REPLICATES).into_par_iter().map(replicate).collect()
    }
}

/// A form factor in each band with its standard error.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Estimate {
    /// The factor, in [0, 1].
    pub factor: Rgb,
    /// One standard deviation of its error.
    pub standard_error: Rgb,
}

impl Estimate {
    /// From the means of the replicates; of those that are not given, 0.
    fn of(means: impl Iterator<Item = Rgb> + Clone) -> Self {
        let count = f64::from(REPLICATES);
        let band = |band: usize| {
            let values = means.clone().map(|mean| f64::from(mean[band]));
            let given = values.clone().count() as f64;
            let mean = values.clone().sum::<f64>() / count;
            let missing = (count - given) * mean * mean;
            let squares: f64 = values.map(|value| (value - mean).powi(2)).sum();
            let error = ((squares + missing) / (count * (count - 1.0))).sqrt();
            (to_f32(mean), to_f32(error))
        };
        let bands = [0, 1, 2].map(band);
        Self {
            factor: bands.map(|(mean, _)| mean).into(),
            standard_error: bands.map(|(_, error)| error).into(),
        }
    }

    fn scaled(self, factor: f64) -> Self {
        Self {
            factor: self.factor * to_f32(factor),
            standard_error: self.standard_error * to_f32(factor),
        }
    }
}

/// A row of form factors with their standard errors.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct EstimatedRow {
    /// Elements that were met, by their position in [`PatchMesh::elements`](crate::PatchMesh::elements), ascending.
    pub receivers: Vec<u32>,
    /// Of each of them.
    pub factors: Vec<Estimate>,
    /// Share that arrives at backs which do not receive.
    pub absorbed: Estimate,
    /// Share that meets no surface.
    pub escaped: Estimate,
}

impl EstimatedRow {
    /// The factor to an element; 0 with an error of 0 if it was not met.
    pub fn factor(&self, element: usize) -> Estimate {
        let wanted = crate::index32(element);
        let found = self.receivers.binary_search(&wanted);
        found.map_or_else(|_| Estimate::default(), |i| self.factors[i])
    }
}

/// What one replicate of a row met.
#[derive(Default)]
struct Tally {
    received: Vec<(u32, Rgb)>,
    absorbed: Rgb,
    escaped: Rgb,
}

/// Samples of a replicate, to which both parts of a weighted share are added.
#[derive(Default)]
struct Share {
    seen: Rgb,
    weights: f32,
}

impl Share {
    fn mean(&self) -> Rgb {
        if self.weights > 0.0 {
            self.seen / self.weights
        } else {
            Rgb::BLACK
        }
    }
}

/// Estimates with their errors; `source`, `from` and `to` are nodes that are no clusters, for which they panic.
impl RayCast {
    /// `F_{from,to}` between two areas, such as two patches.
    ///
    /// Exact, with an error of 0, where nothing is between. Where both touch *and* something partly hides one from
    /// the other near the common edge, the weights have no variance to speak of and the error is too small.
    pub fn area_factor(&self, from: NodeId, to: NodeId, sampling: Sampling) -> Estimate {
        let (a, b) = (self.flat(from), self.flat(to));
        let Some((near, far)) = facing_parts(&a, &b) else {
            return Estimate::default();
        };
        let unoccluded = self.rules.exchange_of_parts(&near, &far) / a.area().max(1e-30);
        let normals = [a.normal.as_vec3(), b.normal.as_vec3()];
        let place = hash(u64::from(from.0), u64::from(to.0));
        let shares = sampling.replicates(place, |seed| {
            let samples = sampling
                .sampler
                .pairs_of_squares(sampling.rays_of_one(), seed);
            self.count_rays(samples.len() as u64);
            let mut share = Share::default();
            for [u, v, s, t] in samples {
                let ends = [near.point([u, v]).as_vec3(), far.point([s, t]).as_vec3()];
                self.add_ray(&mut share, ends, normals);
            }
            share.mean()
        });
        Estimate::of(shares.into_iter()).scaled(unoccluded)
    }

    /// `F_{dA,source}` of a differential element at a point of a surface: what the source sends to the point, as in
    /// `H = Σ_source B F`. The unit normal points to the side that receives.
    ///
    /// Exact, with an error of 0, where nothing is between.
    pub fn point_factor(
        &self,
        point: Vec3,
        normal: Vec3,
        source: NodeId,
        sampling: Sampling,
    ) -> Estimate {
        let polygon = self.flat(source);
        let (at, up) = (point.as_dvec3(), normal.as_dvec3());
        let unoccluded = point_to_polygon(at, up, &polygon);
        let Some(above) = polygon.above_horizon(at, up).filter(|_| unoccluded > 0.0) else {
            return Estimate::default();
        };
        let normals = [normal, polygon.normal.as_vec3()];
        let place = hash(place_of(point), u64::from(source.0));
        let shares = sampling.replicates(place, |seed| {
            let samples = sampling.sampler.squares(sampling.rays_of_one(), seed);
            self.count_rays(samples.len() as u64);
            let mut share = Share::default();
            for sample in samples {
                let ends = [point, above.point(sample).as_vec3()];
                self.add_ray(&mut share, ends, normals);
            }
            share.mean()
        });
        Estimate::of(shares.into_iter()).scaled(unoccluded)
    }

    /// [`Self::point_factor`] at each corner of an element, in the order of [`PatchMesh::polygon`](crate::PatchMesh::polygon).
    ///
    /// The limit from within the element: a wall that stands on the corner counts as seen from just beside it.
    pub fn vertex_factors(
        &self,
        element: usize,
        source: NodeId,
        sampling: Sampling,
    ) -> Vec<Estimate> {
        let mesh = self.mesh_ref();
        let id = mesh.elements()[element];
        let node = mesh.node(id);
        let at_corner = |&corner: &Vec3| {
            let inwards = (node.centroid - corner).normalize_or_zero();
            let beside = corner + inwards * (4.0 * mesh.visibility().offset(corner));
            self.point_factor(beside, node.normal, source, sampling)
        };
        mesh.polygon(id).iter().map(at_corner).collect()
    }

    /// Factors from an area to all elements, by rays over its hemispheres. They sum to 1 with what is absorbed and what
    /// escapes.
    pub fn estimated_row(&self, source: NodeId, sampling: Sampling) -> EstimatedRow {
        let mesh = self.mesh_ref();
        let (from, normal) = (Shooter::new(mesh, source), mesh.node(source).normal);
        let tallies = sampling.replicates(u64::from(source.0), |seed| {
            let samples = sampling
                .sampler
                .pairs_of_squares(sampling.rays_of_one(), seed);
            let ray =
                |&[u, v, s, t]: &[f32; 4]| (from.point([u, v]), cosine_direction(normal, [s, t]));
            self.tally(normal, samples.iter().map(ray))
        });
        merged(&tallies)
    }

    /// Factors from a differential element at a point of a surface to all elements, by rays over its hemisphere; its unit
    /// normal points to the side that receives. They sum to 1 with what is absorbed and what escapes.
    pub fn point_row(&self, point: Vec3, normal: Vec3, sampling: Sampling) -> EstimatedRow {
        let tallies = sampling.replicates(place_of(point), |seed| {
            let samples = sampling.sampler.squares(sampling.rays_of_one(), seed);
            let ray = |&sample: &[f32; 2]| (point, cosine_direction(normal, sample));
            self.tally(normal, samples.iter().map(ray))
        });
        merged(&tallies)
    }

    fn flat(&self, id: NodeId) -> FlatPolygon {
        let node = self.mesh_ref().node(id);
        assert!(
            matches!(node.kind, NodeKind::Surface { .. }),
            "clusters have no factors"
        );
        FlatPolygon::new(&self.mesh_ref().polygon(id), node.normal)
    }

    /// A ray between points of two surfaces, weighted by the kernel.
    fn add_ray(&self, share: &mut Share, [x, y]: [Vec3; 2], normals: [Vec3; 2]) {
        let visibility = self.mesh_ref().visibility();
        let weight = kernel(y - x, normals);
        if weight > 0.0 {
            let from = visibility.off_surface(x, normals[0]);
            let to = visibility.off_surface(y, normals[1]);
            share.seen += visibility.transmittance(from, to) * weight;
            share.weights += weight;
        }
    }

    /// Follows rays from points of a surface with this normal.
    fn tally(&self, normal: Vec3, rays: impl ExactSizeIterator<Item = (Vec3, Vec3)>) -> Tally {
        let mesh = self.mesh_ref();
        let visibility = mesh.visibility();
        let one = 1.0 / rays.len() as f32;
        self.count_rays(rays.len() as u64);
        let mut tally = Tally::default();
        let mut met: Vec<(u32, Rgb)> = Vec::with_capacity(rays.len());
        for (point, direction) in rays {
            let origin = visibility.off_surface(point, normal);
            let escaped = visibility.follow(origin, direction, |hit, arriving, passing| {
                let taken = arriving * (Rgb::WHITE - passing) * one;
                let element = mesh
                    .element_at(hit.face, hit.side, hit.point)
                    .filter(|&e| mesh.exposed_area(e) > 0.0);
                match element {
                    Some(e) => met.push((
                        crate::index32(e),
                        arriving_at(mesh.transmittance()[e], taken),
                    )),
                    None => tally.absorbed += taken,
                }
            });
            tally.escaped += escaped * one;
        }
        met.sort_by_key(|&(element, _)| element);
        for (element, share) in met {
            match tally.received.last_mut() {
                Some((last, sum)) if *last == element => *sum += share,
                _ => tally.received.push((element, share)),
            }
        }
        tally
    }
}

/// What must have arrived at an element for it to take so much, by its mean transmittance.
fn arriving_at(through: Rgb, taken: Rgb) -> Rgb {
    let band = |band: usize| {
        let kept = 1.0 - through[band];
        if kept > 1e-6 { taken[band] / kept } else { 0.0 }
    };
    [0, 1, 2].map(band).into()
}

/// The row of all replicates.
fn merged(tallies: &[Tally]) -> EstimatedRow {
    let mut all: Vec<(u32, Rgb)> = tallies
        .iter()
        .flat_map(|t| t.received.iter().copied())
        .collect();
    all.sort_by_key(|&(element, _)| element);
    let mut row = EstimatedRow {
        absorbed: Estimate::of(tallies.iter().map(|t| t.absorbed)),
        escaped: Estimate::of(tallies.iter().map(|t| t.escaped)),
        ..EstimatedRow::default()
    };
    for same in all.chunk_by(|a, b| a.0 == b.0) {
        row.receivers.push(same[0].0);
        row.factors
            .push(Estimate::of(same.iter().map(|&(_, share)| share)));
    }
    row
}

/// A number for a point.
fn place_of(point: Vec3) -> u64 {
    let bits = |x: f32| u64::from(x.to_bits());
    hash(hash(bits(point.x), bits(point.y)), bits(point.z))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn missing_replicates_count_as_zeros() {
        let given = [0.2, 0.4].map(Rgb::splat);
        let mut all = [Rgb::BLACK; REPLICATES as usize];
        (all[3], all[7]) = (given[0], given[1]);
        let (short, long) = (
            Estimate::of(given.into_iter()),
            Estimate::of(all.into_iter()),
        );
        for band in 0..3 {
            assert!(
                (short.factor[band] - long.factor[band]).abs() < 1e-7
                    && (short.standard_error[band] - long.standard_error[band]).abs() < 1e-7,
                "{short:?} and {long:?}"
            );
        }
        let mean = 0.6 / 16.0;
        let squares: f32 = 0.2_f32.powi(2) + 0.4_f32.powi(2) - 16.0 * mean * mean;
        let error = (squares / (16.0 * 15.0)).sqrt();
        assert!(
            (long.factor.r - mean).abs() < 1e-7,
            "mean {}",
            long.factor.r
        );
        assert!(
            (long.standard_error.r - error).abs() < 1e-7,
            "error {} is not {error}",
            long.standard_error.r
        );
    }
}
