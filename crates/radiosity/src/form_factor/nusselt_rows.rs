//! Rows by Nusselt's analog: the exact factors of points, times the share that is seen.
//!
//! ```text
//! for each element in front of the patch
//!     for each point of the patch: factor of the point, exact (Lambert's contour sum)
//!     rays from the points to the element, by their factors: share that gets through
//!     fraction[element] = mean factor × share
//! ```
//!
//! Unoccluded light is free of noise. As with pairs of [rays](super::raycast) the row then closes: rays over the hemisphere
//! tell what backs absorb and what escapes.
//!
//! # Error
//! Of taking the patch for its points: Gauss quadrature of 16 points gives unit squares at distance 1 their factor but for
//! 1.6e-6, and squares that share an edge but for 4e-7; see [`NusseltOptions::max_points`]. Of occlusion: at most about
//! `1/(2√k)` of a factor where `k` rays meet a shadow edge.

use crate::cast::to_f32;
use crate::error::RadiosityError;
use crate::form_factor::polygon::{FlatPolygon, point_to_polygon};
use crate::form_factor::raycast::{PairFactor, Shooter, kernel};
use crate::form_factor::viewpoints::{Viewpoint, Viewpoints};
use crate::form_factor::{FormFactors, RayCast, RayCastOptions, Row};
use crate::patch::{NodeId, PatchMesh};
use crate::sampling::{hash, point2};
use hemicube_raster::Rgb;
use rayon::prelude::*;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// Most rays of one patch.
const MAX_RAYS: u32 = 1 << 20;

/// How many points and rays a patch may get.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct NusseltOptions {
    /// Rays of a patch, from 1 to 1,048,576, shared among the elements by their form factors; each gets at least one.
    /// Default value: 512.
    pub rays: u32,
    /// Most points of one patch: 1, 4 or 16, chosen as for the hemicube, see
    /// [`HemicubeOptions::max_points`](super::hemicube::HemicubeOptions::max_points). Default value: 16.
    pub max_points: u32,
    /// Shifts the low-discrepancy sequences. Default value: 0.
    pub seed: u64,
}

impl Default for NusseltOptions {
    fn default() -> Self {
        Self {
            rays: 512,
            max_points: 16,
            seed: 0,
        }
    }
}

impl NusseltOptions {
    /// Another number of rays.
    pub fn with_rays(self, rays: u32) -> Self {
        Self { rays, ..self }
    }

    /// Another bound on the points of a patch.
    pub fn with_max_points(self, max_points: u32) -> Self {
        Self { max_points, ..self }
    }

    /// Another seed.
    pub fn with_seed(self, seed: u64) -> Self {
        Self { seed, ..self }
    }
}

/// Form factors by Nusselt's analog.
#[derive(Debug)]
pub struct Nusselt {
    mesh: Arc<PatchMesh>,
    options: NusseltOptions,
    viewpoints: Viewpoints,
    /// Closes the rows.
    probe: RayCast,
    rays: AtomicU64,
}

impl Nusselt {
    /// Factors between the nodes of a mesh.
    ///
    /// # Errors
    /// Options out of their range.
    pub fn new(mesh: Arc<PatchMesh>, options: NusseltOptions) -> Result<Self, RadiosityError> {
        if !(1..=MAX_RAYS).contains(&options.rays) {
            let message = format!(
                "{} rays of a patch are not from 1 to {MAX_RAYS}",
                options.rays
            );
            return Err(RadiosityError::Option(message));
        }
        let rays = RayCastOptions {
            rays: options.rays,
            seed: options.seed,
            ..RayCastOptions::default()
        };
        Ok(Self {
            viewpoints: Viewpoints::new(mesh.clone(), options.max_points, "points")?,
            probe: RayCast::new(mesh.clone(), rays),
            rays: AtomicU64::new(0),
            options,
            mesh,
        })
    }

    /// The options it was made with.
    pub fn options(&self) -> NusseltOptions {
        self.options
    }

    /// Number of points over which the row of a node is averaged.
    pub fn points(&self, source: NodeId) -> usize {
        self.viewpoints.of(source).len()
    }

    /// `F_Pe` in each band.
    fn factor(&self, source: NodeId, points: &[Viewpoint], element: usize) -> PairFactor {
        let id = self.mesh.elements()[element];
        let node = self.mesh.node(id);
        if self.mesh.exposed_area(element) == 0.0 {
            return PairFactor::default();
        }
        let polygon = FlatPolygon::new(&self.mesh.polygon(id), node.normal);
        // Running sums, to find the point of each ray.
        let mut sum = 0.0;
        let sums: Vec<f64> = points
            .iter()
            .map(|from| {
                let normal = from.axes[2].as_dvec3();
                sum += from.weight * point_to_polygon(from.point.as_dvec3(), normal, &polygon);
                sum
            })
            .collect();
        if sum <= 0.0 {
            return PairFactor::default();
        }
        let seed = hash(
            hash(u64::from(source.0), self.options.seed),
            u64::from(id.0),
        );
        let rays = ray_count(sum * f64::from(self.options.rays));
        let visible = self.visible_share(points, &sums, &polygon, rays, seed);
        PairFactor {
            unoccluded: sum,
            visible,
        }
    }

    /// Mean transmittance of rays from points of the patch to points of an element. `sums` are the running sums of what the
    /// points' unoccluded factors add up to.
    fn visible_share(
        &self,
        points: &[Viewpoint],
        sums: &[f64],
        element: &FlatPolygon,
        rays: u32,
        seed: u64,
    ) -> Rgb {
        let visibility = self.mesh.visibility();
        let total = sums.last().copied().unwrap_or(0.0);
        let normal = element.normal.as_vec3();
        let start = f64::from(point2(0, hash(seed, 1))[0]);
        let (mut sum, mut weights) = (Rgb::BLACK, 0.0);
        for i in 0..rays {
            // Points take turns by their factors; each has an equal share of the light within its own.
            let wanted = total * (f64::from(i) + start) / f64::from(rays);
            let at = sums.partition_point(|&s| s <= wanted).min(sums.len() - 1);
            let from = &points[at];
            let own = sums[at] - if at == 0 { 0.0 } else { sums[at - 1] };
            let Some(part) = element.above_horizon(from.point.as_dvec3(), from.axes[2].as_dvec3())
            else {
                continue;
            };
            let to = part.point(point2(i, seed)).as_vec3();
            let share = to_f32(from.weight * part.area() / own.max(1e-30));
            let weight = share * kernel(to - from.point, [from.axes[2], normal]);
            if weight > 0.0 {
                let to = visibility.off_surface(to, normal);
                sum += visibility.transmittance(from.origin, to) * weight;
                weights += weight;
            }
        }
        self.rays.fetch_add(u64::from(rays), Ordering::Relaxed);
        if weights > 0.0 {
            sum / weights
        } else {
            Rgb::BLACK
        }
    }
}

impl FormFactors for Nusselt {
    fn mesh(&self) -> &Arc<PatchMesh> {
        &self.mesh
    }

    fn fill_row(&self, source: NodeId, row: &mut Row) {
        let points = self.viewpoints.of(source);
        let found: Vec<(u32, PairFactor)> = (0..self.mesh.elements().len())
            .into_par_iter()
            .with_min_len(64)
            .filter_map(|e| {
                let factor = self.factor(source, &points, e);
                factor.is_some().then(|| (crate::index32(e), factor))
            })
            .collect();
        let from = Shooter::new(&self.mesh, source);
        self.probe.write_pairs(&found, &from, row);
    }

    fn rays(&self) -> u64 {
        self.rays.load(Ordering::Relaxed) + self.probe.rays()
    }
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "clamped to a range of u32"
)]
fn ray_count(wanted: f64) -> u32 {
    wanted.ceil().clamp(1.0, f64::from(MAX_RAYS)) as u32
}
